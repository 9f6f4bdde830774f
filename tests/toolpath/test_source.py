"""Sources of a path: what a number of a block counts, what stands there; what stays the same is read once."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError, ToolpathError
from robomill.toolpath.corrected import Mark, key_of, marked
from robomill.toolpath.gcode import Tool
from robomill.toolpath.path import Toolpath
from robomill.toolpath.sketch import Sketch
from robomill.toolpath.sketch_presets import PRESETS, preset
from robomill.toolpath.source import (
    MAX_KEPT,
    GCodeSource,
    LinesSource,
    PointsSource,
    SketchSource,
    finely,
    meant_by,
    wanted_of,
)
from robomill.toolpath.tools import Tools

TEXT = "G21 G90 S600 M3\nT1 M6\nG0 X0 Y0 Z5\nG43 H1\nG1 Z-1 F600\nX10\nG0 Z5\nM2\n"


def test_a_program_is_read_once_for_each_table_of_tools() -> None:
    source = GCodeSource(TEXT)
    first = source.read()
    assert source.read() is first
    assert GCodeSource(TEXT).read() is first
    assert GCodeSource(TEXT.replace("X10", "X11")).read() is not first
    assert source.read({}) is first
    tools: Tools = {1: Tool(1, 8e-3, (0.0, 0.0, 0.05))}
    other = source.read(tools)
    assert other is not first
    assert source.read(tools) is other


def test_a_refused_program_stays_refused() -> None:
    """In the same words, each time as a refusal of its own, to which its reader may add where it was."""
    source, refusals = GCodeSource(TEXT.replace("X10", "G2 X10")), []
    for _ in range(3):
        with pytest.raises(GCodeError, match=r"^Line 6: ") as refused:
            source.read()
        refusals.append(refused.value)
    assert len({str(each) for each in refusals}) == 1
    assert len({id(each) for each in refusals}) == 3


def test_the_last_few_programs_are_kept() -> None:
    """Whoever was asked for last stays longest."""
    sources = [GCodeSource(TEXT.replace("X10", f"X{10 + i}"), "kept.nc") for i in range(MAX_KEPT + 1)]
    paths = [source.read() for source in sources[:-1]]
    assert sources[0].read() is paths[0]
    sources[-1].read()
    assert sources[0].read() is paths[0]
    assert sources[1].read() is not paths[1]


def test_apt_is_told_from_g_code_by_its_text() -> None:
    path = GCodeSource("PARTNO/X\nUNITS/MM\nFEDRAT/600\nFROM/0,0,10\nGOTO/10,0,0\nFINI\n").read()
    np.testing.assert_allclose(path.p[-1], [0.01, 0, 0])


def test_blocks_are_lines_rows_and_shapes() -> None:
    program = GCodeSource("G21\r\nG1 X1 F1\rM2")
    assert (program.kind, program.block_name) == ("program", "line")
    assert program.block_texts() == ["G21", "G1 X1 F1", "M2"]
    table = LinesSource([[0, 0, 0], [0.01, 0, 0]], [[0.01, 0, 0], [0.01, 0.0255, -1e-3]], [0.01, 0.03], 200.0)
    assert (table.kind, table.block_name) == ("lines", "row")
    assert table.block_texts() == ["(0, 0, 0) → (10, 0, 0)  600 mm/min", "(10, 0, 0) → (10, 25.5, −1)  1800 mm/min"]
    path = table.read()
    assert path.n_s.tolist() == [200.0] * len(path)
    np.testing.assert_allclose(path.v_f[path.cutting], [0.01, 0.03])
    sketch = SketchSource(preset(next(iter(PRESETS)), Sketch(), 8e-3))
    assert (sketch.kind, sketch.block_name) == ("sketch", "shape")
    assert len(sketch.block_texts()) == len(sketch.sketch.elements)
    assert sketch.read().digest() == sketch.sketch.toolpath().digest()


def test_names_do_not_tell_sources_apart() -> None:
    drawn = Sketch()
    assert SketchSource(drawn, "one") == SketchSource(drawn, "two")
    assert GCodeSource(TEXT, "one") != GCodeSource(TEXT, "two")


@pytest.mark.parametrize("values", [{"start": [[0.0, 0]]}, {"v_f": [np.nan]}, {"end": [0.0, 0, 0]}])
def test_tables_that_are_none_are_refused(values: dict[str, object]) -> None:
    given = {"start": [[0.0, 0, 0]], "end": [[0.1, 0, 0]], "v_f": [0.01]}
    with pytest.raises(ToolpathError):
        LinesSource(**{**given, **values}).read()


SILENT = TEXT.replace(" S600 M3", "")
SAID = SILENT.replace("G1 ", "S600 M3\nG1 ")  # a change of tools stops the spindle


def test_a_program_that_never_turns_its_spindle_cuts_with_the_speed_that_is_said() -> None:
    """As if the words stood in it: 600 a minute are 10 a second."""
    told, bare = GCodeSource(SILENT, n_s=10.0).read(), GCodeSource(SILENT).read()
    written = GCodeSource(SAID).read()
    assert not bare.turns
    assert told.turns
    np.testing.assert_array_equal(told.n_s[told.cutting], written.n_s[written.cutting])
    np.testing.assert_array_equal(told.p, bare.p)
    assert not told.n_s[~told.cutting].any()
    assert {f.code for f in bare.findings} ^ {f.code for f in told.findings} == {"no-spindle", "spindle-stated"}
    assert "600 min⁻¹" in told.findings[-1].message


def test_a_program_that_says_its_speed_keeps_it() -> None:
    assert GCodeSource(SAID, n_s=99.0).read() is GCodeSource(SAID).read()


def test_a_speed_is_no_less_than_nothing() -> None:
    with pytest.raises(ToolpathError, match="Spindle speed: found −60"):
        GCodeSource(TEXT, n_s=-1.0)


LEANING = "G21 G90 S600 M3\nG0 X0 Y0 Z5 A0\nG1 Z-1 F600\nX10 A120\nG0 Z5\nM2\n"


def test_a_rotary_axis_that_nobody_has_explained_is_asked_for_until_it_is() -> None:
    """It turns the part, or it leans the tool: then the path is that of the bare program, and nothing is asked."""
    bare, tool, part = (GCodeSource(LEANING, table=name).read() for name in ("", "tool", "A"))
    assert [f.code for f in bare.findings].count("rotary-asked") == 1
    assert [f.code for f in tool.findings] == [f.code for f in bare.findings if f.code != "rotary-asked"]
    np.testing.assert_array_equal(tool.k, bare.k)
    np.testing.assert_array_equal(tool.p, bare.p)
    assert "rotary-asked" not in [f.code for f in part.findings]
    assert not np.allclose(part.p[-1], bare.p[-1])
    with pytest.raises(ToolpathError, match="rotary axis 'D'; expected one of A, -A, B, -B, C, -C, tool"):
        GCodeSource(LEANING, table="D")


def test_what_was_meant_is_a_path_or_its_source() -> None:
    path = GCodeSource(TEXT).read()
    source = GCodeSource(TEXT, wanted=PointsSource(path))
    assert GCodeSource(TEXT, wanted=path).wanted == source.wanted
    assert wanted_of(source) == PointsSource(path)
    assert wanted_of(GCodeSource(TEXT)) is None
    assert wanted_of(PointsSource(path)) is None
    with pytest.raises(ToolpathError, match="Program, wanted: found 7; expected the path that was meant"):
        GCodeSource(TEXT, wanted=7)  # type: ignore[arg-type]


@pytest.mark.parametrize("dialect", ["auto", "sinumerik"])
def test_a_corrected_program_finds_what_it_was_corrected_for(dialect: str) -> None:
    """By the lines of that, or of what that was corrected for in its turn; anything else stays as it is."""
    meant, other = GCodeSource(TEXT, "meant.nc"), GCodeSource(TEXT.replace("X10", "X11"), "meant.nc")
    head = marked(TEXT.replace("X10", "X10.1").splitlines(), Mark("meant.nc", key_of(meant.block_texts())), dialect)
    corrected = GCodeSource("\n".join(head), "new.nc", dialect)
    again = GCodeSource("\n".join(head).replace("X10.1", "X10.2"), "newer.nc", dialect)
    assert corrected.mark is not None
    assert wanted_of(meant_by(corrected, meant)) == meant
    assert wanted_of(meant_by(again, meant_by(corrected, meant))) == meant
    assert meant_by(corrected, other) is corrected
    assert meant_by(other, meant) is other
    known = meant_by(corrected, meant)
    assert meant_by(known, other) is known
    points = PointsSource(meant.read())
    assert meant_by(points, meant) is points


def test_points_are_told_by_their_last_move() -> None:
    path = Toolpath.from_points(p_mm=[[0, 0, 5], [0, 0, -2], [50, 0.25, -2]], feed_mm_min=1800)
    source = PointsSource(path)
    assert (source.kind, source.block_name, source.read()) == ("points", "point", path)
    texts = source.block_texts()
    assert len(texts) == path.block.max()
    assert texts[-1] == "(50, 0.25, −2)  1800 mm/min"
    program = GCodeSource("G20 G90 S600 M3\nG0 X0 Y0 Z1\n\nG1 X1 F10\nM2\n").read()
    assert program.units == "in"
    lines = PointsSource(program)
    assert lines.path.units == "mm"
    assert lines.block_texts() == ["", "(0, 0, 25.4)  rapid", "", "(25.4, 0, 25.4)  254 mm/min"]


def test_sources_say_what_they_are() -> None:
    assert repr(GCodeSource(TEXT, "a.nc")) == "<GCodeSource a.nc, 8 lines>"
    assert repr(LinesSource([[0, 0, 0]], [[0.01, 0, 0]], [0.01])) == "<LinesSource table of lines, 1 row>"
    assert repr(SketchSource(Sketch())) == "<SketchSource sketch, 0 shapes>"


def test_arcs_that_errors_are_told_from_are_finer_than_those_that_are_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """The middle of a chord is a sagitta nearer to the centre of a circle of 9 mm."""
    source = GCodeSource("G21 G90 S600 M3\nG0 X9\nG2 X9 Y0 I-9 J0 F600\nM2\n")

    def sagitta(path: Toolpath) -> float:
        p = path.p[path.block == 3]
        return float(9e-3 - np.linalg.norm((p[1:] + p[:-1]) / 2, axis=1).min())

    assert 0.6e-6 < sagitta(source.read()) < 1e-6
    assert 0.2e-6 < sagitta(finely(source, {})) < 0.3e-6
    points = PointsSource(source.read())
    assert finely(points, {}) is points.path
    monkeypatch.setattr("robomill.toolpath.source.VERY_LONG", 100)
    assert finely(source, {}) is source.read()
