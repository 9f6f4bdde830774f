"""Our own programs against the moves that LinuxCNC 2.9's interpreter made of them when they were written.

``data/programs/NAME.moves.jsonl`` has a move a line: kind, line, end (mm), for arcs plane, centre and signed turns.
Every tool T has 3 mm diameter and (T mod 7) * 1.5 mm length.
"""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from robomill.io.gcode_out import toolpath_to_gcode
from robomill.toolpath.gcode import Tool, interpret, read_gcode
from robomill.toolpath.gcode.program import KINDS, PLANES
from robomill.toolpath.plane import axes

FILES = sorted((Path(__file__).parent / "data" / "programs").glob("*.ngc"))
TOOLS = {n: Tool(n, 3e-3, (0.0, 0.0, n % 7 * 1.5e-3)) for n in range(1, 100)}


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.stem)
def test_moves_agree_with_the_reference(file: Path) -> None:
    program = interpret(file, tools=TOOLS)
    rows = [json.loads(line) for line in file.with_suffix(".moves.jsonl").read_text().splitlines()]
    assert [KINDS[k] for k in program.kind] == [row["kind"] for row in rows]
    assert program.line.tolist() == [row["line"] for row in rows]
    for i, row in enumerate(rows):
        assert math.dist(program.end[i] * 1e3, row["end"]) < 1e-6, row
        if row["kind"] == "arc":
            plane = int(program.plane[i])
            assert PLANES[plane] == row["plane"]
            assert math.dist(program.centre[i][list(axes(plane)[:2])] * 1e3, row["centre"]) < 1e-6, row
            assert int(program.turns[i]) * (-1 if program.clockwise[i] else 1) == row["turn"]


@pytest.mark.parametrize("units", ["mm", "in"])
@pytest.mark.parametrize("file", FILES, ids=lambda f: f.stem)
def test_written_programs_read_back_to_the_same_path(file: Path, units: str) -> None:
    path = read_gcode(file, tools=TOOLS, chord_error=1e-4)
    again = read_gcode(toolpath_to_gcode(path, units=units, title=file.stem))
    assert len(again) == len(path)
    assert abs(again.p - path.p).max() < 2e-9
    assert abs(again.k - path.k).max() < 1e-7
    assert (again.cutting == path.cutting).all()
    assert again.v_f == pytest.approx(path.v_f, rel=1e-4, abs=1e-9)
    assert again.n_s == pytest.approx(path.n_s)
