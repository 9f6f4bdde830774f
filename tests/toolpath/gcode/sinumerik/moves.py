"""Moves of short Sinumerik programs."""

from __future__ import annotations

from robomill.toolpath.gcode import interpret

HEAD = "G71 G90 G17 F100 S500 M3\n"


def ends(body: str) -> list[tuple[str, float, float, float]]:
    program = interpret(f"{HEAD}{body}M30\n", dialect="sinumerik")
    return [("RFAT"[k], *(round(float(v) * 1e3, 6) for v in p)) for k, p in zip(program.kind, program.end)]


def places(body: str) -> list[tuple[float, float, float]]:
    return [each[1:] for each in ends(body)]
