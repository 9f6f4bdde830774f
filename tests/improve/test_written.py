"""What is written back is read again before it is given to anybody."""

import numpy as np
import pytest

import robomill as rm
from robomill.errors import CompensationError
from robomill.improve import written
from robomill.improve.written import writing
from robomill.io.gcode_out import toolpath_to_gcode
from robomill.io.samples import samples_dir
from robomill.toolpath.gcode import interpret
from robomill.toolpath.gcode.rewriting import Rewriter, Rewritten

SLOT = rm.load_setup(samples_dir() / "paper_flute")


def test_nothing_corrected_is_the_program_as_it_was_with_its_line_ends() -> None:
    for ends in ("\n", "\r\n"):
        text = ends.join([*SLOT.source.block_texts(), ""])
        back = writing(SLOT.replace(source=rm.GCodeSource(text, "x.nc")), toolpath_to_gcode)
        found = back.write(np.zeros_like(back.moves.wanted.p), 2e-6)
        lines = found.text.splitlines(keepends=True)
        assert "".join(line for line in lines if "robomill" not in line) == text
        assert [line.endswith(ends) for line in lines] == [True] * len(lines)
        assert lines[0].startswith("(corrected by robomill for x.nc, ")
        np.testing.assert_allclose(found.q, back.moves.wanted.p, atol=1e-12)
        assert found.lines_in == 10


def test_a_program_that_would_not_lead_where_it_should_is_never_given_out(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = Rewriter.write

    def wrong(self: Rewriter, *given: object) -> Rewritten:
        found = honest(self, *given)  # type: ignore[arg-type]
        return Rewritten(found.text.replace("X50", "X49.999"), found.made, found.unrolled)

    monkeypatch.setattr(written.Rewriter, "write", wrong)
    back = writing(SLOT, toolpath_to_gcode)
    with pytest.raises(CompensationError, match=r"Line 7: written back"):
        back.write(np.zeros_like(back.moves.wanted.p), 2e-6)


@pytest.mark.parametrize(("was", "now"), [("N60 G0 Z20\n", ""), ("N60 G0 Z20\n", "N60 G0 Z20\nG0 X0\n")])
def test_a_move_that_is_missing_or_too_many_at_the_end_is_told_by_the_last_line(
    monkeypatch: pytest.MonkeyPatch, was: str, now: str
) -> None:
    honest = Rewriter.write

    def wrong(self: Rewriter, *given: object) -> Rewritten:
        found = honest(self, *given)  # type: ignore[arg-type]
        assert was in found.text
        return Rewritten(found.text.replace(was, now), found.made, found.unrolled)

    monkeypatch.setattr(written.Rewriter, "write", wrong)
    back = writing(SLOT, toolpath_to_gcode)
    with pytest.raises(CompensationError, match=r"^Line 8: written back"):
        back.write(np.zeros_like(back.moves.wanted.p), 2e-6)


@pytest.mark.parametrize(
    ("text", "table", "words"),
    [
        ("BEGIN PGM X MM\n1 L X+0 Y+0 Z-2 R0 FMAX M3\n2 L X+40 F500\nEND PGM X MM\n", "", "Heidenhain"),
        ("G21 G90\nG0 X0 Y0 Z5 A0\nG1 X10 A90 F500\nM2\n", "A", "a table turns the part"),
        ("G21 G90\nG68.2 I0 J30. K0\nG53.1\nG0 X0 Y0 Z5.\nG1 Z0 F500\nX9.\nM30\n", "", "tilts its working"),
    ],
)
def test_what_is_not_written_is_refused_by_name(text: str, table: str, words: str) -> None:
    with pytest.raises(CompensationError, match=words):
        writing(SLOT.replace(source=rm.GCodeSource(text, "x.nc", table=table)), toolpath_to_gcode)


def test_a_location_file_is_written_as_g_code() -> None:
    text = "PARTNO/X\nUNITS/MM\nFEDRAT/600,MMPM\nGOTO/0,0,-2,0,0,1\nGOTO/20,0,-2,0,0,1\nFINI\n"
    back = writing(SLOT.replace(source=rm.GCodeSource(text, "x.apt")), toolpath_to_gcode)
    c = np.where(back.moves.wanted.cutting[:, None], [0.0, 1e-4, 0.0], 0.0)
    found = back.write(c, 2e-6)
    path = rm.read_gcode(found.text)
    np.testing.assert_allclose(path.p[-1], [20e-3, 0.1e-3, -2e-3], atol=1e-9)
    np.testing.assert_allclose(found.q, back.moves.wanted.p + c, atol=2e-6)


def test_waits_of_a_location_file_are_written_once_however_many_pieces_a_move_becomes() -> None:
    """Before the first move, too."""
    moves = "DELAY/3\nGOTO/0,0,-2,0,0,1\nDELAY/2\nGOTO/20,0,-2,0,0,1\nDELAY/0.5\nGOTO/20,10,-2\n"
    text = f"PARTNO/X\nUNITS/MM\nFEDRAT/600,MMPM\n{moves}FINI\n"
    back = writing(SLOT.replace(source=rm.GCodeSource(text, "x.apt")), toolpath_to_gcode)
    wanted = back.moves.wanted
    bowed = np.outer(3e-4 * np.sin(300.0 * wanted.p[:, 0]), [0.0, 1.0, 0.0])
    program = interpret(back.write(np.where(wanted.cutting[:, None], bowed, 0.0), 2e-6).text)
    assert len(program) > 12
    waits = program.dwell > 0.0
    assert program.dwell[waits].tolist() == [3.0, 2.0, 0.5]
    np.testing.assert_allclose(program.start[waits][1:, 0], [0.0, 20e-3], atol=1e-6)


def test_a_tip_that_stands_while_its_number_changes_has_not_moved() -> None:
    """Under the length of another tool, 10 mm more than its own, Z5 is where the tip stood at Z15."""
    table = rm.ToolTable(tuple(rm.TableTool(n, SLOT.cutter, length=(10 + 10 * n) * 1e-3) for n in (1, 2)))
    start = "G21 G90\nT1 M6\nS12000 M3\nG0 X-50 Y0 Z15\nG43 H2\nG0 Z5\nG43 H1\nG0 Z3\n"
    text = f"{start}G1 Z-2 F500\nX40\nG0 Z20\nM2\n"
    back = writing(SLOT.replace(tools=table, source=rm.GCodeSource(text, "x.nc")), toolpath_to_gcode)
    found = back.write(np.zeros_like(back.moves.wanted.p), 2e-6).text
    assert "".join(line for line in found.splitlines(keepends=True) if "robomill" not in line) == text


@pytest.mark.parametrize("cycle", ["G84 X5 Y0 Z-3 R1 F1000", "G33.1 Z-3 K1"])
def test_a_thread_is_not_corrected(cycle: str) -> None:
    """Its feed is that of the spindle; the line is told."""
    text = f"G21 G90\nS1000 M3\nG0 X5 Y0 Z5\n{cycle}\nG80\nG0 Z5\nM2\n"
    back = writing(SLOT.replace(source=rm.GCodeSource(text, "x.nc")), toolpath_to_gcode)
    with pytest.raises(CompensationError, match=r"^Line 4: a thread is cut in step with the spindle"):
        back.write(np.zeros_like(back.moves.wanted.p), 2e-6)


def test_a_program_of_one_cutting_speed_whose_revolutions_nobody_knows_is_written() -> None:
    """They are the same in both: none."""
    text = "G21 G90\nG96 S100 M3\nG0 X0 Y0 Z5\nG0 Z-2\nG1 X20 F600\nG0 Z5\nM2\n"
    back = writing(SLOT.replace(source=rm.GCodeSource(text, "x.nc")), toolpath_to_gcode)
    assert np.isnan(interpret(text).n_s).any()
    c = np.where(back.moves.wanted.cutting[:, None], [0.0, 1e-4, 0.0], 0.0)
    found = back.write(c, 2e-6)
    np.testing.assert_allclose(found.q[back.moves.wanted.cutting], (back.moves.wanted.p + c)[back.moves.wanted.cutting])


def test_where_points_are_told_to_be_is_where_their_text_leads_to_the_last_digit() -> None:
    """Corrected by what no text can say: both are rounded alike."""
    p = np.array([[0.0, 0.0, 20.0], [0.0, 0.0, -2.0], [20.0, 0.0, -2.0], [20.0, 10.0, -2.0]]) * 1e-3
    path = rm.Toolpath.from_points(p, 0.01, cutting=[False, False, True, True])
    back = writing(SLOT.replace(source=path, step=5e-3), toolpath_to_gcode)
    wanted = back.moves.wanted
    c = np.where(wanted.cutting[:, None], np.pi * np.array([1e-5, -2e-5, 3e-5]), 0.0)
    found = back.write(c, 2e-6)
    read = rm.read_gcode(found.text).p
    for q in found.q[wanted.cutting & np.append(np.diff(back.moves.owner) > 0, True)]:
        assert np.abs(read - q).max(axis=1).min() < 1e-13
    np.testing.assert_allclose(found.q, wanted.p + c, atol=1e-9)
