"""Programs that others wrote, against the moves that LinuxCNC's interpreter makes of them, end point by end point.

The programs are not ours to pass on. ``ROBOMILL_GCODE_ORACLE`` names the folder that holds them: ``index.json`` with
a row a file and, beside each accepted file, ``FILE.moves.jsonl``. Without it these tests are skipped.
"""

from __future__ import annotations

import json
import math
import os
from dataclasses import replace
from pathlib import Path

import pytest

from robomill.errors import GCodeError
from robomill.io.setups.tool_tables import read_tool_table
from robomill.toolpath.gcode import gcode_report, interpret, read_gcode
from robomill.toolpath.gcode.program import ARC, KINDS, PLANES
from robomill.toolpath.plane import axes

FOLDER = os.environ.get("ROBOMILL_GCODE_ORACLE", "")
INDEX = json.loads((Path(FOLDER) / "index.json").read_text()) if FOLDER else []
TOLERANCE = 1e-6

pytestmark = pytest.mark.skipif(not FOLDER, reason="ROBOMILL_GCODE_ORACLE is not set")


def files(tier: str) -> list:
    return [pytest.param(row, id=row["file"]) for row in INDEX if row["tier"] == tier]


def reference(row: dict) -> list[dict]:
    lines = (Path(FOLDER) / (row["file"] + ".moves.jsonl")).read_text().splitlines()
    kinds = {"traverse": "traverse", "feed": "feed", "arc": "arc", "rigid_tap": "tap", "probe": "probe"}
    return [{**e, "k": kinds[e["k"]]} for e in map(json.loads, lines) if e["k"] in kinds]


def read(row: dict):
    return interpret(Path(FOLDER) / row["file"], tools=read_tool_table(Path(FOLDER) / "tools_mm.tbl"))


@pytest.mark.parametrize("row", files("accept"))
def test_every_move_ends_where_linuxcnc_ends_it(row: dict) -> None:
    program, expected = read(row), reference(row)
    kinds = [KINDS[k] for k in program.kind]
    for i, (ours, theirs) in enumerate(zip(kinds, expected)):
        where = f"move {i}, line {program.line[i]} (theirs: {theirs})"
        assert ours == theirs["k"], where
        assert int(program.line[i]) == theirs["line"], where
        end = program.end[i] * 1e3
        assert math.dist(end, theirs["to"]) < TOLERANCE, f"{where}: ends at {end}"
        if ours == "arc":
            plane = int(program.plane[i])
            assert PLANES[plane] == theirs["plane"], where
            centre = program.centre[i][list(axes(plane)[:2])] * 1e3
            assert math.dist(centre, theirs["centre"]) < TOLERANCE, f"{where}: centre {centre}"
            assert int(program.turns[i]) == abs(theirs["turn"]), where
            assert bool(program.clockwise[i]) == (theirs["turn"] < 0), where
            assert math.dist(program.start[i] * 1e3, theirs["frm"]) < TOLERANCE, where
            assert program.sweep[i] == pytest.approx(theirs["sweep"], abs=1e-6), where
    assert len(kinds) == len(expected)


@pytest.mark.parametrize("row", files("accept"))
def test_totals_agree_with_the_index(row: dict) -> None:
    program = read(row)
    report = gcode_report(replace(program, lift=0.0 * program.lift))  # theirs are points that are told, not tips
    for kind in ("traverse", "feed", "arc"):
        assert report["moves"][kind] == row["moves"][kind]
        assert report["length_mm"][kind] == pytest.approx(row["length_mm"][kind], rel=1e-6, abs=2e-4)
    if row["feed_extents_mm"] is None:
        assert report["extents_mm"] is None
    else:
        lower, upper = report["extents_mm"]  # theirs come from sampled arcs, so ours may reach a little farther
        for i in range(3):
            assert -1e-6 < row["feed_extents_mm"][0][i] - lower[i] < 0.05
            assert -1e-6 < upper[i] - row["feed_extents_mm"][1][i] < 0.05


@pytest.mark.parametrize("row", files("no motion"))
def test_programs_without_motion_run(row: dict) -> None:
    program = read(row)
    assert len(program) == 0
    assert program.dwells == row["moves"]["dwell"]
    with pytest.raises(GCodeError, match="no motion"):
        read_gcode(Path(FOLDER) / row["file"], tools=read_tool_table(Path(FOLDER) / "tools_mm.tbl"))


@pytest.mark.parametrize("row", files("reject"))
def test_what_linuxcnc_refuses_is_refused(row: dict) -> None:
    with pytest.raises(GCodeError) as caught:
        read(row)
    text = (Path(FOLDER) / row["file"]).read_text().splitlines()
    assert text[caught.value.line - 1].strip()


def test_arcs_are_there() -> None:
    assert sum(int((read(row.values[0]).kind == ARC).sum()) for row in files("accept")) > 1000
