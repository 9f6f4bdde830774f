"""Programs whose moves are led elsewhere: what is written, read by the interpreter, goes there, whatever its words."""

import re
from collections.abc import Iterator

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.fitting import Piece
from robomill.toolpath.gcode.program import ARC, Program
from robomill.toolpath.gcode.reading import interpret
from robomill.toolpath.gcode.rewriting import Rewriter, Rewritten
from robomill.toolpath.gcode.trace import trace
from robomill.toolpath.text import split_lines
from robomill.toolpath.tools import Tool

SHIFT = np.array([0.2e-3, -0.3e-3, 0.1e-3])
PLAIN = {
    "steps": "G21 G91\nG0 X0 Y0 Z-2\nG1 X20 F600\nG1 Y10\nX-20\nG90\nG0 Z20\nM30\n",
    "inches": "%\nO100\nG20 G90 G94\nG0 X0 Y0 Z.5\nG1 Z-.1 F20.\nX1. Y.5\nG3 X1.5 Y1. I0. J.5\nG0 Z1.\nM30\n%\n",
    "other planes": "G21 G90 G18\nG0 X0 Y0 Z5\nG1 Z0 F500\nG2 X20 Z0 R10\nG19\nG3 Y10 Z-10 J0 K-10\nG17\nG1 X40\nM2\n",
    "origins": "G21 G90\nG10 L2 P2 X5 Y7 Z1\nG55\nG0 X0 Y0 Z5\nG1 Z-2 F500\nG1 X20\nG54\nG1 X40\nG0 Z20\nM2\n",
    "a turned origin": "G21 G90\nG10 L2 P1 R30\nG54 G0 X0 Y0 Z5\nG1 Z-2 F500\nX20\nG3 X20 Y10 I0 J5\nG0 Z20\nM2\n",
    "G68": "G21 G90\nG68 X0 Y0 R45\nG0 X0 Y0 Z5\nG1 Z-2 F500\nX20\nG3 X20 Y10 I0 J5\nG69\nG0 Z20\nM30\n",
    "G92": "G21 G90\nG0 X0 Y0 Z5\nG92 X10 Y10\nG1 Z-2 F500\nG1 X20\nG92.1\nG1 X40\nG0 Z20\nM2\n",
    "radii": "G21 G90\nG0 X0 Y0 Z5\nG1 Z-2 F500\nG2 X20 Y0 R12\nG2 X0 Y0 R12\nG3 X5 Y5 R-20\nG0 Z20\nM2\n",
    "full circles": "G21 G90\nG0 X10 Y0 Z5\nG1 Z-2 F500\nG2 I-10 J0\nG3 X10 Y0 I-10\nG0 Z20\nM2\n",
    "absolute centres": "G21 G90 G90.1\nG0 X10 Y0 Z5\nG1 Z-2 F500\nG2 X-10 Y0 I0 J0\nG0 Z20\nM2\n",
    "five axes": "G21 G90\nG0 X0 Y0 Z5 A0 B0\nG1 Z-2 F500\nG1 X40 A10 B5\nG1 X60 A0 B0\nG0 Z20\nM2\n",
    "inverse time": "G21 G90\nG0 X0 Y0 Z5\nG93\nG1 Z-2 F10\nG1 X40 F5\nG3 X40 Y10 I0 J5 F20\nG94\nG1 X0 F500\nM2\n",
    "feed a turn": "G21 G90 S1000 M3\nG0 X0 Y0 Z5\nG95 G1 Z-2 F.1\nG1 X40\nG0 Z20\nM2\n",
    "home": "G21 G90\nG0 X0 Y0 Z5\nG1 Z-2 F500\nG1 X40\nG0 Z5\nG91 G28 Z0\nG90\nT2 M6\nG0 X0 Y9 Z5\nG1 Z-2\nX10\nM2\n",
    "no spaces": "G21G90\nG0X0Y0Z5\nN10G01Z-2.F500\nN20X40.\nN30G02X50.Y-10.I0.J-10.\nN40G00Z20.M09\nN50M30\n",
    "all words": "G21 G90\nG0 X0 Y0 Z5\n/N10 G1 Z-2 F500 ; down\nN20 G1 X40 (across) M8\nN30 X50 Y2 S500 M3 M30\n",
}
UNROLLED = {
    "subprogram": (
        "fanuc",
        "O1000\nG21 G90\nG0 X0 Y0 Z5\nM98 P200 L2\nG0 Z20\nM30\nO200\nG91\nG1 Z-2 F300\nG1 X10\nG1 Z2\nG90\nM99\n",
    ),
    "words beside calls": (
        "fanuc",
        "O1000\nG21 G90\nG0 X0 Y0 Z5\nG0 X5 M98 P200 L2\nG91 M98 P300\nX1\nG90 G0 Z20\nM30\nO200\nG91\nG1 Z-2 F300\n"
        "G1 X10\nG1 Z2\nG90\nM99\nO300\nG0 Z-6\nG1 X4\nX4 M99\n",
    ),
    "loop": (
        "auto",
        "G21 G90\n#1=0\nG0 X0 Y0 Z5\nG1 Z-2 F300\no1 while [#1 LT 3]\n#1=[#1+1]\nG1 X[#1*9] Y#1\no1 endwhile\nM2\n",
    ),
    "cycles": (
        "auto",
        "G21 G90\nG0 X0 Y0 Z10\nG98 G83 X10 Y10 Z-6 R2 Q2 F100\nX20\nG82 X30 Z-3 R1 P0.5\nG80\nM2\n",
    ),
    "a cycle fed by the turn": (
        "auto",
        "G21 G90 S500 M3\nG0 X0 Y0 Z10\nG95 G98 G81 X10 Y10 Z-6 R2 F.2\nX20\nG80\nM2\n",
    ),
    "corners": (
        "fanuc",
        "O1000\nG21 G90\nG0 X0. Y0. Z5.\nG1 Z-2. F500.\nG1 X20.,R3.\nG1 Y20.,C2.\nX0.\nG0 Z20.\nM30\n",
    ),
    "Sinumerik": (
        "sinumerik",
        "G71 G90 G17\nG0 X0 Y0 Z5\nG1 Z-2 F500\nG1 X20 RND=3\nG1 Y20\nG3 X10 Y30 CR=10\nG1 X=IC(-5) Y30\nM30\n",
    ),
    "scaling": (
        "fanuc",
        "O1\nG21 G90\nG51 X0 Y0 Z0 P2000\nG0 X0 Y0 Z5\nG1 Z-2 F500\nX20\nG3 X20 Y10 I0 J5\nG50\nG0 Z20\nM30\n",
    ),
    "mirrored": (
        "sinumerik",
        "G71 G90 G17\nG0 X0 Y0 Z5\nTRANS X5\nG1 Z-2 F500\nN7 MIRROR X0\nG1 X20 Y3\nG3 X10 Y13 CR=10\nMIRROR\nG1 X0 Y0\n"
        "TRANS Y9\nASCALE X2\nX3\nSCALE\nX0\nG0 Z20\nM30\n",
    ),
    "scaled along Z": (
        "sinumerik",
        "G71 G90 G17\nG0 X0 Y0 Z5\nSCALE X2 Y2 Z3\nG1 Z-2 F500\nX20\nG3 X20 Y10 CR=5\nSCALE\nG1 X1\nG0 Z20\nM30\n",
    ),
    "polar": (
        "fanuc",
        "O1\nG21 G90\nG0 X20 Y0 Z5\nG1 Z-2 F500\nG16\nG1 X20 Y30\nX20 Y60\nG15\nG1 X0 Y0\nG0 Z20\nM30\n",
    ),
    "G41": (
        "auto",
        "G21 G90\nT1 M6\nG0 X-9 Y-9\nG1 Z-2 F99\nG41 D1 X0 Y0\nY20\nX20\nG2 X30 Y10 J-10\nG1 Y0\nX0\nG40 X-9 Y-9\nM2\n",
    ),
}
TOOLS = {1: Tool(1, diameter=8e-3), 2: Tool(2, diameter=6e-3)}


def halves(program: Program, j: int, shift: np.ndarray, pieces: int) -> Iterator[Piece]:
    """Move ``j`` in equal pieces, each shifted."""
    for n in range(pieces):
        f = (n + 1) / pieces
        if program.kind[j] != ARC:
            end = program.start[j] + f * (program.end[j] - program.start[j])
            yield Piece(n / pieces, f, end + program.lift[j] + shift)
            continue
        centre = program.centre[j] + program.lift[j] + shift
        end = program.arcs_of(np.array([j])).at(np.zeros(1, dtype=int), np.array([f]))[0]
        end = end if n + 1 < pieces else program.end[j] + program.lift[j]
        yield Piece(n / pieces, f, end + shift, centre, program.sweep[j] / pieces)


def rewritten(text: str, dialect: str, shift: np.ndarray, pieces: int = 1) -> tuple[Rewritten, Program]:
    program, executed, name = trace(text, dialect, TOOLS)
    feed = np.broadcast_to(program.at_feed, len(program))
    made = {int(j): list(halves(program, int(j), shift, pieces)) for j in np.flatnonzero(feed)}
    ends = program.end + program.lift
    return Rewriter(program, name, made, ends).write(split_lines(text), executed), program


def cuts(program: Program) -> np.ndarray:
    """(k, 3) m where moves at feed end that go anywhere."""
    feed = np.broadcast_to(program.at_feed, len(program))
    return np.asarray((program.end + program.lift)[feed & (program.length > 1e-9)])


@pytest.mark.parametrize("name", PLAIN)
def test_nothing_moved_is_nothing_changed(name: str) -> None:
    found, _ = rewritten(PLAIN[name], "fanuc" if name == "G68" else "auto", np.zeros(3))
    assert found.text == PLAIN[name]
    assert found.unrolled == ()


@pytest.mark.parametrize("pieces", [1, 3])
@pytest.mark.parametrize("name", PLAIN)
def test_every_cut_is_led_aside_whatever_its_words(name: str, pieces: int) -> None:
    dialect = "fanuc" if name == "G68" else "auto"
    found, program = rewritten(PLAIN[name], dialect, SHIFT, pieces)
    again = interpret(found.text.encode(), dialect=dialect, tools=TOOLS)
    expected = [np.array([piece.end for piece in halves(program, j, SHIFT, pieces)]) for j in range(len(program))]
    feed = np.flatnonzero(np.broadcast_to(program.at_feed, len(program)) & (program.length > 1e-9))
    led = np.vstack([expected[j] for j in feed])
    np.testing.assert_allclose(cuts(again), led, atol=0.3e-6)
    v_f = np.repeat(program.v_f[feed], pieces)
    back = np.broadcast_to(again.at_feed, len(again)) & (again.length > 1e-9)
    np.testing.assert_allclose(again.v_f[back], v_f, rtol=1e-4)
    assert again.ok
    middles = [[p.centre for p in halves(program, j, SHIFT, pieces)] for j in feed if program.kind[j] == ARC]
    round_again = again.kind == ARC
    np.testing.assert_allclose(
        (again.centre + again.lift)[round_again][:, :2],
        np.array([c for each in middles for c in each]).reshape(-1, 3)[:, :2],
        atol=5e-6,
    )


@pytest.mark.parametrize("name", UNROLLED)
def test_what_is_no_plain_move_is_written_out_and_goes_where_it_went(name: str) -> None:
    dialect, text = UNROLLED[name]
    for shift in (np.zeros(3), SHIFT):
        found, program = rewritten(text, dialect, shift)
        again = interpret(found.text.encode(), dialect=dialect, tools=TOOLS)
        np.testing.assert_allclose(cuts(again), cuts(program) + shift, atol=0.3e-6)
        np.testing.assert_allclose(again.dwell_time, program.dwell_time)
        feeds, expected = (each.v_f[each.at_feed & (each.length > 1e-9)] for each in (again, program))
        np.testing.assert_allclose(feeds, expected, rtol=1e-5)
        assert found.unrolled


def test_numbers_comments_feeds_and_stops_stay_on_their_lines() -> None:
    found, _ = rewritten(PLAIN["all words"], "auto", SHIFT, 2)
    lines = found.text.splitlines()
    assert lines[2].startswith("/N10 G1 X")
    assert lines[2].endswith("F500 ; down")
    assert lines[4] == "N20 G1 X20.2 (across) M8"
    assert lines[5] == "X40.2"
    assert lines[6].startswith("N30 X")
    assert lines[6].endswith("S500 M3")
    assert lines[7].endswith(" M30")
    assert not lines[7].startswith("N")


def test_fanuc_numbers_keep_their_point() -> None:
    found, _ = rewritten(UNROLLED["corners"][1], "fanuc", np.array([1e-3, 0.0, 0.0]))
    numbers = [word for line in found.text.splitlines()[3:] for word in line.split() if word[0] in "XYZIJ"]
    assert numbers
    assert all("." in number for number in numbers)


def test_a_line_that_computes_what_is_no_place_is_refused_by_its_line() -> None:
    with pytest.raises(GCodeError, match=r"Line 5: 'S#1' is computed"):
        rewritten("G21 G90\n#1=500\nG0 X0 Y0 Z5\nG1 Z-2 F500\nG1 X#1 S#1\nM2\n", "auto", SHIFT)


def grown(program: Program, j: int) -> list[Piece]:
    """Move ``j`` in one piece, twice a thousandth farther from the origin: arcs change their size."""
    scale = np.array([1.002, 1.002, 1.002])
    centre = None if program.kind[j] != ARC else (program.centre[j] + program.lift[j]) * scale
    return [Piece(0.0, 1.0, (program.end[j] + program.lift[j]) * scale, centre, program.sweep[j])]


def chorded(program: Program, j: int) -> list[Piece]:
    """Move ``j`` in two straight pieces, whatever it was."""
    pieces = list(halves(program, j, SHIFT, 2))
    return [Piece(each.f0, each.f1, each.end) for each in pieces]


@pytest.mark.parametrize("name", PLAIN)
@pytest.mark.parametrize("lead", [grown, chorded])
def test_cuts_that_change_their_form_are_told_in_full(name: str, lead) -> None:
    """Ends, kinds, centres and turnings as they were asked for, read again; feeds too, but for inverse time."""
    dialect = "fanuc" if name == "G68" else "auto"
    program, executed, known = trace(PLAIN[name], dialect, TOOLS)
    feed = np.flatnonzero(np.broadcast_to(program.at_feed, len(program)))
    made = {int(j): lead(program, int(j)) for j in feed}
    ends = (program.end + program.lift) * (1.002 if lead is grown else 1.0)
    if name == "home":
        ends = program.end + program.lift
    found = Rewriter(program, known, made, ends).write(split_lines(PLAIN[name]), executed)
    again = interpret(found.text.encode(), dialect=dialect, tools=TOOLS)
    pieces = [piece for j in feed if program.length[j] > 1e-9 for piece in made[int(j)]]
    kept = np.broadcast_to(again.at_feed, len(again)) & (again.length > 1e-9)
    np.testing.assert_allclose((again.end + again.lift)[kept], [each.end for each in pieces], atol=0.3e-6)
    assert (again.kind[kept] == ARC).tolist() == [each.centre is not None for each in pieces]
    round_again, asked = kept & (again.kind == ARC), [each for each in pieces if each.centre is not None]
    if asked:
        np.testing.assert_allclose(again.sweep[round_again], [each.sweep for each in asked], atol=2e-4)
        third = 19 - again.plane[round_again]
        off = (again.centre + again.lift)[round_again] - [each.centre for each in asked]
        off[np.arange(len(off)), third] = 0.0  # along the axis of the arc it says nothing
        np.testing.assert_allclose(off, 0.0, atol=6e-6)
    if lead is grown:
        before, after = (
            [k for k, line in enumerate(text.splitlines()) if "R" in line] for text in (PLAIN[name], found.text)
        )
        wide = [k - 1 for k in program.line[np.abs(program.sweep) > np.radians(170.0)]]
        assert after == [k for k in before if k not in wide], "but for those of about half a turn or more"


@pytest.mark.parametrize("code", [73, 81, 82, 83, 85, 86, 89])
@pytest.mark.parametrize("back", ["G98", "G99"])
def test_every_cycle_is_written_out_as_its_moves(code: int, back: str) -> None:
    more = {73: " Q2", 82: " P.5", 83: " Q2", 89: " P.5", 86: " P.5"}.get(code, "")
    text = f"G21 G90 S900 M3\nG0 X0 Y0 Z10\n{back} G{code} X10 Y10 Z-6 R2{more} F100 (holes)\nX20\nG80\nG0 X0\nM2\n"
    found, program = rewritten(text, "auto", SHIFT)
    again = interpret(found.text.encode(), tools=TOOLS)
    np.testing.assert_allclose(cuts(again), cuts(program) + SHIFT, atol=0.3e-6)
    np.testing.assert_allclose(again.dwell_time, program.dwell_time)
    np.testing.assert_allclose(again.v_f[again.kind == 1], 0.1 / 60)
    assert found.unrolled == ("canned cycles",)
    assert f"G{code}" not in found.text
    assert found.text.count("(holes)") == 1
    goes = program.length > 1e-9
    np.testing.assert_allclose(again.end[again.kind == 0][-1], program.end[goes & (program.kind == 0)][-1], atol=0.3e-6)


LOOPED = {
    "frames": (
        "sinumerik",
        "G71 G90 G17\nG0 X0 Y0 Z5\nFOR R1=1 TO 3\nATRANS X10 Y2\nG1 X1 Y0 Z-1 F300\nG1 Y9\n"
        "G0 Z5\nENDFOR\n"
        "TRANS\nG1 X0 Y0\nM30\n",
    ),
    "origins": (
        "auto",
        "G21 G90\nG0 X0 Y0 Z5\nG1 X2 F300\no1 repeat [3]\nG10 L2 P2 X30 Y5 R10\nG55\n"
        "G1 X1 Y2 Z-1 F300\nG91\nG1 X2\nG90\nG54\no1 endrepeat\nG1 X9\nM2\n",
    ),
    "dwells": ("auto", "G21 G90\nG0 X0 Y0 Z5\no1 repeat [3]\nG91 G1 X1 F300\nG90 G4 P[1/2]\no1 endrepeat\nM2\n"),
    "units": (
        "auto",
        "G21 G90 F300\no1 sub\nG20\nG1 X1 Y.5\nG21\nG1 X1 Y9\no1 endsub\nG0 Z5\no1 call\nG1 X50\no1 call\nM2\n",
    ),
    "planes": (
        "auto",
        "G21 G90 F300\nG0 X0 Y0 Z0\no1 sub\nG1 X1\nG18\n"
        "G2 X11 Z0 R6\nG17\nG3 X1 Y0 R6\no1 endsub\no1 call\nG1 X0\no1 call\nM2\n",
    ),
}


@pytest.mark.parametrize("name", LOOPED)
def test_loops_keep_what_says_how_their_words_count(name: str) -> None:
    dialect, text = LOOPED[name]
    found, program = rewritten(text, dialect, SHIFT)
    again = interpret(found.text.encode(), dialect=dialect, tools=TOOLS)
    np.testing.assert_allclose(cuts(again), cuts(program) + SHIFT, atol=0.3e-6)
    assert again.dwell_time == pytest.approx(program.dwell_time)
    assert found.unrolled[0] == "loops and subprograms"


def test_a_program_with_calls_keeps_its_number_and_the_ends_of_its_tape() -> None:
    """Controls store a program by its O number and read a tape from % to %; those of what it calls are written out."""
    text = (
        "%\nO0100 (MAIN)\nN1 G21 G90\nN2 G0 X0 Y0 Z5\nN3 M98 P200 L2\nN4 G0 Z9\nN5 M30\n"
        "O0200 (PASS)\nG91 G1 Z-6 F300\nX20\nG0 Z6\nG90\nM99\n%\n"
    )
    found, program = rewritten(text, "auto", SHIFT)
    lines = found.text.splitlines()
    assert (lines[:3], lines[-2:]) == (["%", "O0100 (MAIN)", "N1 G21 G90"], ["N5 M30", "%"])
    assert not any("200" in line for line in lines)
    np.testing.assert_allclose(cuts(interpret(found.text.encode(), tools=TOOLS)), cuts(program) + SHIFT, atol=0.3e-6)


REMARKS = {
    "auto": (
        "O0100 (MAIN)\nG21 G90\nG0 X0 Y0 Z5\nM98 P200 L2 (THE POCKET)\n#1=2 (TWO)\n"
        "WHILE [#1 GT 0] DO1 (DOWN)\n#1=#1-1 (ONE)\n"
        "G91 G1 X1. (CUT)\nEND1 (UP)\nG90 G0 Z9\nM30\nO0200\nG91 G1 Z-6 F300\nG0 Z6\nG90\nM99 (BACK)\n",
        ["(MAIN)", "(THE POCKET)", "(BACK)", "(TWO)", "(DOWN)", "(ONE)", "(CUT)", "(UP)", "(CUT)"],
    ),
    "sinumerik": (
        "G71 G90\nG0 X0 Y0 Z5\nL100 P2 ; pocket\nM30\n%_N_L100_SPF\nG91 G1 Z-1 F100\nG90\nM17 ; back (home)\n",
        ["; pocket", "; back (home)"],
    ),
}


@pytest.mark.parametrize("dialect", REMARKS)
def test_what_a_line_says_to_people_is_kept_where_the_line_is_written_out(dialect: str) -> None:
    text, said = REMARKS[dialect]
    found, _ = rewritten(text, dialect, SHIFT)
    assert re.findall(r";.*|\([A-Z ]+\)", found.text) == said


@pytest.mark.parametrize("length", [0.0, 30e-3])
def test_what_only_the_machine_knows_is_kept_where_nothing_is_led_aside_and_else_refused(length: float) -> None:
    """G53 and G28 lead where they led, with a tool length on too; a cut by G53 that is to be led aside is refused."""
    tools = {1: Tool(1, 8e-3, (0.0, 0.0, length))}
    text = "G21 G90\nT1 M6\nG43 H1\nG0 X0 Y0 Z5\nG1 X20 Z-2 F300\nG53 G0 Z90\nG0 X30\nG1 Z-3\n{}G1 X40\nM2\n"
    for line, refused in (("", False), ("", True), ("G91 G28 Z0\nG90\n", False)):
        program, executed, name = trace(text.format(line), "auto", tools)
        feed = np.flatnonzero(np.broadcast_to(program.at_feed, len(program)))
        made = {int(j): list(halves(program, int(j), SHIFT, 1)) for j in feed}
        ends = program.end + program.lift + (SHIFT if refused else 0.0)
        writer = Rewriter(program, name, made, ends)
        if refused:
            with pytest.raises(GCodeError, match=r"^Line 6: 'G53 G0 Z90' cannot be led elsewhere; write its moves"):
                writer.write(split_lines(text.format(line)), executed)
            continue
        found = writer.write(split_lines(text.format(line)), executed)
        again = interpret(found.text.encode(), tools=tools)
        np.testing.assert_allclose(cuts(again), cuts(program) + SHIFT, atol=0.3e-6)
        assert "G53 G0 Z90" in found.text.splitlines()


@pytest.mark.parametrize(
    ("dialect", "line"),
    [
        ("auto", "G4 P[#1/2]"),
        ("auto", "G4 P#1"),
        ("auto", "G10 L2 P1 X[#1*30]"),
        ("fanuc", "G4 P#1"),
        ("sinumerik", "ATRANS X=R1*30"),
    ],
)
def test_a_kept_line_of_a_loop_that_counts_by_a_parameter_is_refused(dialect: str, line: str) -> None:
    """What sets the parameter is run, not written: the line would count by 0, or by what nobody has set."""
    loops = {
        "auto": ("#1=0\no1 while [#1 LT 3]\n#1=[#1+1]", "o1 endwhile"),
        "fanuc": ("#1=0\nWHILE[#1LT3]DO1\n#1=#1+1", "END1"),
        "sinumerik": ("R1=0\nWHILE R1<3\nR1=R1+1", "ENDWHILE"),
    }
    begin, end = loops[dialect]
    first = {"auto": "G21 G90", "fanuc": "O1\nG21 G90", "sinumerik": "G71 G90"}[dialect]
    text = f"{first}\nG0 X0 Y0 Z5\nG1 Z-2 F300\n{begin}\nG91 G1 X1\n{line}\n{end}\nM30\n"
    number = text.splitlines().index(line) + 1
    with pytest.raises(GCodeError, match=rf"^Line {number}: .* is computed, and cannot be written back"):
        rewritten(text, dialect, SHIFT)


@pytest.mark.parametrize(("axis", "kept"), [(0, True), (1, True), (2, False)])
def test_a_line_that_goes_home_is_kept_where_nothing_is_corrected_that_it_moves(axis: int, kept: bool) -> None:
    """G28 Z0 leads along z alone: from a corrected x or y it goes home all the same."""
    program, executed, name = trace(PLAIN["home"], "auto", TOOLS)
    ends = program.end + program.lift
    home = np.flatnonzero(program.line == split_lines(PLAIN["home"]).index("G91 G28 Z0") + 1)
    assert len(home)
    ends[home, axis] += 1e-4
    lines = split_lines(PLAIN["home"])
    if kept:
        assert "G91 G28 Z0" in Rewriter(program, name, {}, ends).write(lines, executed).text
    else:
        with pytest.raises(GCodeError, match="cannot be led elsewhere"):
            Rewriter(program, name, {}, ends).write(lines, executed)


@pytest.mark.parametrize(("plane", "words"), [("G17", "XYIJ"), ("G18", "XZIK"), ("G19", "YZJK")])
def test_a_further_piece_of_an_arc_says_the_places_of_its_plane_and_the_height_where_it_climbs(plane, words) -> None:
    """Half circles in four pieces; every second piece ends where one of its two places stays."""
    first, second, i, _ = words
    third = next(letter for letter in "XYZ" if letter not in words)
    text = f"G21 G90 {plane} F500\nG0 X0 Y0 Z0\nG1 X1 Y1 Z1\nG2 {first}21 {second}1 {i}10{{}}\nM2\n"
    for climb, said in (("", words), (f" {third}9", "".join(sorted(f"{words[:2]}{third}")) + words[2:])):
        found, _ = rewritten(text.format(climb), "auto", SHIFT, 4)
        lines = found.text.splitlines()[-4:-1]
        assert [re.sub(r"[^A-Z]", "", line) for line in lines] == [said] * 3
