"""Sources, encodings, findings, dialects, tools and reports."""

from __future__ import annotations

import gc
import json
import math
import re
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from robomill.errors import ArgumentError, GCodeError
from robomill.files import PROGRAM as LIMIT
from robomill.progress import Cancelled, Progress, watched
from robomill.toolpath.gcode import Tool, gcode_report, interpret, read_gcode, write_moves_jsonl
from robomill.toolpath.gcode.chords import to_toolpath
from robomill.toolpath.text import as_plain_bytes
from tests.telling import told

PROGRAM = "G21 G90\nG0 X1\nG1 Y2 F60\nM2\n"


@pytest.mark.parametrize(
    "data",
    [
        PROGRAM.encode(),
        PROGRAM.encode("utf-8-sig"),
        PROGRAM.encode("utf-16"),
        PROGRAM.encode("utf-32"),
        PROGRAM.replace("\n", "\r\n").encode(),
        PROGRAM.replace("\n", "\r").encode(),
        PROGRAM.upper().encode(),
        PROGRAM.lower().encode(),
        ("(größe)\n" + PROGRAM).encode("latin-1"),
        ("\n\n" + PROGRAM).encode(),
    ],
)
def test_encodings_and_line_ends(data: bytes) -> None:
    path = read_gcode(data)
    assert path.p[-1] * 1e3 == pytest.approx((1, 2, 0))
    assert path.v_f[-1] == pytest.approx(1e-3)


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"", "empty"),
        (b"  \n \n", "empty"),
        (b"G21\nG0 X1\0\x02\n", "NUL"),
        (bytes(range(1, 32)) * 50, "binary"),
        (b"\x7fELF\x02\x01\x01" + b"\0" * 20, "NUL"),
        (b"\xff\xfeG\x00\x00\xd8", "UTF-16"),
    ],
)
def test_what_is_no_program(data: bytes, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        interpret(data)


def test_a_string_is_a_file_if_it_looks_like_one(tmp_path: Path) -> None:
    file = tmp_path / "part.NC"
    file.write_text(PROGRAM)
    assert len(read_gcode(str(file))) == len(read_gcode(file)) == len(read_gcode(PROGRAM)) == 3
    with pytest.raises(GCodeError, match="cannot be opened"):
        read_gcode(str(tmp_path / "missing.nc"))
    with pytest.raises(GCodeError, match="cannot be opened"):
        read_gcode(tmp_path)
    with pytest.raises(GCodeError, match="no motion"):
        read_gcode("M2")
    with pytest.raises(GCodeError, match="expected text, bytes or a path"):
        read_gcode(42)  # type: ignore[arg-type]


def test_too_large_is_refused() -> None:
    class Huge(bytes):
        def __len__(self) -> int:
            return LIMIT.most + 1

    with pytest.raises(GCodeError, match="at most 200 MB"):
        as_plain_bytes(Huge(b"G0"))


def test_one_enormous_line_is_refused_quickly() -> None:
    with pytest.raises(GCodeError, match="characters long"):
        interpret("G0 X1" + "0" * 10_000_000 + "\n")


def levels(text: str, **more: object) -> dict[str, list[str]]:
    out: dict[str, list[str]] = {}
    for finding in interpret(text, **more).findings:  # type: ignore[arg-type]
        out.setdefault(finding.level, []).append(finding.message)
    return out


def test_findings() -> None:
    assert "warning" not in levels(PROGRAM)
    assert "no G20 or G21: lengths are taken as mm" in levels("G0 X1\nM2\n")["suspicious"]
    assert "the program ends without M2, M30 or %" in levels("G21 G0 X1\n")["warning"]
    assert any("inches" in m for m in levels("G0 X0\nG1 X3.25 F1\nM2\n")["suspicious"])
    assert any("wrongly" in m for m in levels("G20 G0 X0\nG1 X300 F1\nM2\n")["suspicious"])
    assert any("one line" in m for m in levels("G20 F5 G1 X1\nM2\n")["suspicious"])
    counted = [f for f in interpret("G21\nM36 G0 X1\nM36\nM36\nM2\n").findings if f.level == "ignored"]
    assert (counted[0].count, counted[0].line) == (3, 2)


def test_percent_signs() -> None:
    assert len(interpret("%\nG21 G0 X1\n%\nthis is no G-code\n")) == 1
    assert not [f for f in interpret("%\nG21 G0 X1\n%\n").findings if f.level == "warning"]


def test_dialects_are_guessed_and_shown() -> None:
    fanuc = interpret("%\nO1234 (PART)\nG21 G0 X1\nM98 P20100\nG4 X1.\nM30\nO0100\nG91 G1 X1 F60\nM99\n%\n")
    assert (fanuc.dialect, len(fanuc), fanuc.dwells) == ("fanuc", 3, 1)
    assert any("guess" in f.message for f in fanuc.findings)
    assert interpret("O<a> sub\nO<a> endsub\nG0 X1\nM2\n").dialect == "linuxcnc"
    assert interpret('G71\nMSG("hello")\nG0 X=5\nM30\n').messages == ((2, "hello"),)
    assert interpret("G0 X1\nM2\n", dialect="fanuc").dialect == "fanuc"
    assert interpret("(TOOL S=800 X=1)\nG0 X1 ; G71\nM2\n").dialect == "linuxcnc"
    with pytest.raises(GCodeError, match="G71 .* or is a lathe's cycle"):
        interpret("G71 Q100 X5 Z5 D1\n")
    with pytest.raises(GCodeError, match="Dialect 'klingon'"):
        interpret(PROGRAM, dialect="klingon")


def test_messages_show_parameters() -> None:
    program = interpret("#1=2.5\n(MSG, hello)\n(DEBUG, #1 and #<nope> and #5420)\n(just a comment)\nM2\n")
    assert program.messages == ((2, " hello"), (3, " 2.500000 and ###### and 0.000000"))


def test_a_tool_that_the_table_lacks_is_said() -> None:
    """It may cut nothing that matters; where it cuts, a simulation asks for it. LinuxCNC stops, and G41 has to know."""
    text = "G21 G90 F100\nT9 M6\nG43 H9\nG1 X1\nM2\n"
    program = interpret(text, tools={1: Tool(1)})
    assert [(f.level, f.line, f.count) for f in program.findings if f.code == "tool-unknown"] == [("warning", 2, 3)]
    assert program.tool[-1] == 9
    with pytest.raises(GCodeError, match="Line 2: tool 9 is not in the tool table; add it"):
        interpret(text, tools={1: Tool(1)}, dialect="linuxcnc")
    with pytest.raises(GCodeError, match="Line 4: tool 9 is not in the tool table; add it"):
        interpret(text.replace("G1 X1", "G41 D9"), tools={1: Tool(1)})


def test_report_and_moves(tmp_path: Path) -> None:
    program = interpret("G21 G18 F120\nG0 X10\nG2 X0 Z10 I-10 K0 Y5\nG1 Y0\nG33.1 Z12 K1 S60 M3\nM2\n")
    report = gcode_report(program)
    assert report["moves"] == {"traverse": 1, "feed": 1, "arc": 1, "tap": 1}
    assert report["length_mm"]["arc"] == pytest.approx(math.hypot(5 * math.pi, 5))
    assert report["extents_mm"][0] == pytest.approx([0, 0, 0], abs=1e-12)
    assert (report["units"], report["ok"]) == ("mm", True)
    json.dumps(report)
    write_moves_jsonl(program, tmp_path / "moves.jsonl")
    rows = [json.loads(line) for line in (tmp_path / "moves.jsonl").read_text().splitlines()]
    assert [row["kind"] for row in rows] == ["traverse", "arc", "feed", "tap"]
    arc = rows[1]
    assert (arc["plane"], arc["turns"], arc["clockwise"], arc["line"]) == ("XZ", 1, True, 3)
    assert arc["centre"] == pytest.approx([0, 0])
    assert arc["sweep_deg"] == pytest.approx(-90)
    assert rows[2]["start"] == pytest.approx(arc["end"])
    assert rows[2]["feed_mm_min"] == pytest.approx(120)


def test_progress_and_cancel() -> None:
    text = "G21 F100\n" + "G1 X1\nX2\n" * 100_000
    shares = told(lambda: interpret(text))["Reading the program"]
    lines = np.array(shares) * (text.count("\n") + 1)
    np.testing.assert_allclose(np.diff(lines)[:-1], lines[0], rtol=0.01)  # as often, all the way
    assert len(shares) > 2
    assert shares[0] < 0.5 < shares[-1]
    with pytest.raises(Cancelled), watched(Progress(stop=lambda: True)):
        interpret(text)


def test_subroutines_in_files_beside_the_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "hole.ngc").write_text("O<hole> sub\nG0 X#1\nO<hole> endsub\nM2\n")
    main = tmp_path / "main.ngc"
    main.write_text("G21\nO<hole> call [5]\nG0 Y1\nM2\n")
    for source in (main, str(main)):
        assert interpret(source).end[-1] * 1e3 == pytest.approx((5, 1, 0))
    monkeypatch.chdir(tmp_path)  # a text lies beside nothing
    with pytest.raises(GCodeError, match="no Ohole sub"):
        interpret(main.read_text())


def test_toolpath_marks_cuts_feeds_tools_and_lines() -> None:
    tools = {2: Tool(2, 8e-3)}
    path = read_gcode("G21 F600\nT2 M6\nS3000 M3\nG0 X1\nG1 X2\nG20\nG1 X1\nM5\nG0 X0\nM2\n", tools=tools)
    assert path.cutting.tolist() == [False, False, True, True, False]
    assert path.v_f * 60e3 == pytest.approx([0, 0, 600, 600, 0])
    assert path.block.tolist()[1:] == [4, 5, 7, 9]
    assert path.n_s == pytest.approx([50, 50, 50, 50, 0])
    assert set(path.tool.tolist()) == {2}
    assert path.p[3] * 1e3 == pytest.approx((25.4, 0, 0))
    assert np.array_equal(path.k, np.broadcast_to([0, 0, 1.0], path.k.shape))


def test_a_partial_reading_keeps_the_moves_before_the_refusal() -> None:
    program = interpret("G21 F60\nG1 X1\nX2\nG2 X3\nX4\n", partial=True)
    assert len(program) == 2
    assert not program.ok
    assert gcode_report(program)["ok"] is False
    assert (program.findings[0].level, program.findings[0].line) == ("error", 4)
    assert len(to_toolpath(program)) == 3


def test_words_of_other_controls_that_move_nothing_are_noted() -> None:
    five_axis = interpret("%\nO1000 (BLADE)\nG21 G0 X1\nG43.4 H1\nG1 X2 A5 F60\nM30\n%\n")
    assert any("tip points" in f.message for f in five_axis.findings)
    siemens = interpret("G71\nTRAORI\nCYCLE832(0.01)\nG0 X=1\nM30\n")
    assert {f.message.split()[0] for f in siemens.findings if f.level == "ignored"} == {"TRAORI", "CYCLE832"}
    with pytest.raises(GCodeError, match="Line 2: [$]H") as caught:
        interpret("G21\n$H\n")
    assert caught.value.line == 2


def test_turned_axes_are_written_where_one_turns(tmp_path: Path) -> None:
    """Of a program that turns an axis anywhere, every move says where its axes stand; of others none does."""
    for words, turned in (("X1 A30", True), ("X1 Y2", False)):
        program = interpret(f"G21 G90 F100\nG0 Z5\nG1 {words}\nG0 Z9\nM2\n")
        write_moves_jsonl(program, tmp_path / "moves.jsonl")
        rows = [json.loads(line) for line in (tmp_path / "moves.jsonl").read_text().splitlines()]
        told = [row["rotary_deg"] for row in rows if "rotary_deg" in row]
        assert told == ([pytest.approx([a, 0, 0]) for a in (0, 30, 30)] if turned else [])


@pytest.mark.parametrize(("radius", "doubted"), [(2, True), (5, False), (1400, False), (1600, True)])
def test_a_part_is_as_large_as_its_arcs(radius, doubted):
    """A full circle ends where it starts; from 8 mm to 3 m across a part is not doubted."""
    program = interpret(f"S900 M3 F100\nG0 X3 Y4\nG2 I{radius}\nM2\n")
    np.testing.assert_allclose(np.subtract(*program.extents[::-1]), [2e-3 * radius, 2e-3 * radius, 0], atol=1e-12)
    assert ("size-doubt" in {f.code for f in program.findings}) is doubted


def test_turned_axes_are_written_where_one_of_them_turns(tmp_path: Path) -> None:
    write_moves_jsonl(interpret("G21 G0 X1\nB30\nM2\n"), tmp_path / "moves.jsonl")
    rows = [json.loads(row) for row in (tmp_path / "moves.jsonl").read_text().splitlines()]
    np.testing.assert_allclose([row["rotary_deg"] for row in rows], [[0, 0, 0], [0, 30, 0]], atol=1e-12)


@pytest.mark.parametrize(
    ("line", "level"),
    [("G1 X5 C90", "info"), ("G1 X5 B10 C90", "warning"), ("G1 X5 B10", None), ("G0 X5 C90", None)],
)
def test_how_c_is_read_is_said_where_a_cut_has_one(line, level):
    found = [f for f in interpret(f"G21 G90 F100\n{line}\nM2\n").findings if f.code == "c-spins"]
    assert [(f.level, f.line) for f in found] == ([] if level is None else [(level, 2)])


@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        ("hole", "O<other> sub\nO<other> endsub\nM2\n", "Ohole is called, but hole.ngc does not define it"),
        ("hole", None, "Ohole is called, but there is no Ohole sub; define it in the program"),
        ("deep_hole-2", "O<deep_hole-2> sub\nG0 X7\nO<deep_hole-2> endsub\nM2\n", ""),
        ("../hole", "O<../hole> sub\nG0 X7\nO<../hole> endsub\nM2\n", "there is no O../hole sub"),
    ],
)
def test_a_file_beside_the_program_is_read_by_its_plain_name_and_has_to_define_it(
    name: str, text: str | None, says: str, tmp_path: Path
) -> None:
    (tmp_path / "in").mkdir()
    main = tmp_path / "in" / "main.ngc"
    main.write_text(f"G21\nO<{name}> call\nM2\n")
    if text is not None:
        (main.parent / f"{name}.ngc").write_text(text)
    if says:
        with pytest.raises(GCodeError, match=f"^Line 2: .*{re.escape(says)}"):
            interpret(main)
    else:
        program = interpret(main)
        assert program.end[-1] * 1e3 == pytest.approx((7, 0, 0))
        assert [f.code for f in program.findings if f.code == "sub-file"] == ["sub-file"]


RINGS = [
    ("linuxcnc", "G21 G90 F100\n#1=3\nG1 X#1 Y#<_x>\n"),
    ("fanuc", "G21 G90 F100\n#1=3\nWHILE[#1LT5]DO1\n#1=#1+1\nG1 X#1\nEND1\n"),
    ("sinumerik", "G71 G90 F100\nR1=2\nG1 X=R1\n"),
    ("heidenhain", "BEGIN PGM A MM\nTOOL CALL 1 Z S1 F9\nL X+1 F9\n"),
]


@pytest.mark.parametrize("slip", ["", "Q\n"])
@pytest.mark.parametrize(("dialect", "text"), RINGS)
def test_what_was_read_is_given_back_at_once(dialect: str, text: str, slip: str) -> None:
    """Without rings that only the garbage collector undoes: a server reads many programs between two of its rounds.

    A ring of the reader's is there each time; what a thread of an earlier test leaves meanwhile is not.
    """

    def left() -> int:
        gc.collect()
        with suppress(GCodeError):
            read_gcode(f"{text}{slip}", dialect=dialect)
        return gc.collect()

    gc.disable()
    try:
        assert min(left() for _ in range(5)) == 0
    finally:
        gc.enable()


def test_what_is_no_tool_of_a_table_is_told() -> None:
    with pytest.raises(ArgumentError, match=r"Tool 3: found a float, expected a tool of a table, as in rm.ToolTable"):
        read_gcode(PROGRAM, tools={3: 8.0})  # type: ignore[dict-item]


@pytest.mark.parametrize("text", ["G21\nG0 X1\nM2\n", "G21\nG0 X1\nM2", "\nG21\n\nG0 X1\n\n", "G0 X1"])
def test_a_program_has_as_many_lines_as_it_has_ends_of_lines_or_one_more(text: str) -> None:
    assert interpret(text).lines == len(text.splitlines())
