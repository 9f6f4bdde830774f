"""Canned cycles as Fanuc counts them, with the holes that they make."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, interpret
from robomill.toolpath.gcode.chords import to_toolpath


def read(body: str) -> Program:
    return interpret(f"G21 G90 S100 M3 F100\nG0 X0 Y0 Z10\n{body}G80\nM30\n", dialect="fanuc")


def holes(body: str) -> list[tuple[float, ...]]:
    program = read(body)
    return [tuple(row) for row in (np.round(program.end[program.kind == 1] * 1e3, 9) + 0.0).tolist()]


@pytest.mark.parametrize("word", ["K3", "L3"])
def test_k_repeats_as_l_does(word: str) -> None:
    assert holes(f"G91 G99 G81 X10 Z-5 R-8 {word}\n") == [(10, 0, -3), (20, 0, -3), (30, 0, -3)]


@pytest.mark.parametrize("word", ["K0", "L0"])
def test_no_time_at_all_keeps_the_cycle_for_the_next_line(word: str) -> None:
    assert holes(f"G99 G81 X10 Z-5 R2 {word}\nX20\nY5\n") == [(20, 0, -5), (20, 5, -5)]


def test_a_dwell_may_be_left_out() -> None:
    assert holes("G99 G82 X10 Z-5 R2\nG89 X20 Z-4 R2\n") == [(10, 0, -5), (20, 0, -4), (20, 0, 2)]
    assert read("G99 G82 X10 Z-5 R2 P500\nX20\n").dwell_time == pytest.approx(1.0)


def test_fine_boring_goes_down_at_feed_and_out_at_rapid() -> None:
    program = read("G99 G76 X10 Z-5 R2 Q0.2 P500\nX20\n")
    assert [f.line for f in program.findings if f.code == "fine-boring"] == [3]
    assert holes("G99 G76 X10 Z-5 R2 Q0.2 P500\nX20\n") == [(10, 0, -5), (20, 0, -5)]


def test_back_boring_is_refused_by_name() -> None:
    with pytest.raises(GCodeError, match="Line 3: G87 bores from below on a Fanuc control, which is not read"):
        read("G87 X10 Z-5 R-20 Q1\n")


GRID = [(0, 0, -5), (10, 0, -5), (20, 0, -5), (20, 10, -5), (10, 10, -5)]


@pytest.mark.parametrize("dialect", ["fanuc", "auto"])
@pytest.mark.parametrize("back", ["G98", "G99"])
def test_holes_in_g91_are_as_deep_as_was_said_in_g90(dialect: str, back: str) -> None:
    """The grid of the control's manuals: one hole in G90, and from there by steps, at the same height and depth."""
    body = f"{back} G81 Z-5. R2.\nG91 X10. L2\nG90 Y10.\nG91 X-10. K1\n"
    program = interpret(f"G21 G90 S100 M3 F100\nG0 X0. Y0. Z10.\n{body}G80\nM30\n", dialect=dialect)
    cuts = program.end[program.kind == 1] * 1e3
    np.testing.assert_allclose(cuts, GRID, atol=1e-9)
    assert program.end[-1, 2] * 1e3 == pytest.approx(10 if back == "G98" else 2)
    said = [f.line for f in program.findings if f.code == "cycle-heights"]
    assert said == ([4] if dialect == "auto" else [])


def test_holes_given_in_g91_go_on_as_they_were_given() -> None:
    """R counts from the initial level, Z from R; the height of the first hole is kept where G90 comes after it."""
    assert holes("G91 G98 G81 X10 Z-8 R-6\nX10\nG90 X50\n") == [(10, 0, -4), (20, 0, -4), (50, 0, -4)]
    program = interpret("G21 G90 S9 M3 F9\nG0 X0 Y0 Z10\nG91 G81 X10 Z-8 R-6\nX10\nM2\n")
    assert not [f for f in program.findings if f.code == "cycle-heights"]


def test_a_depth_given_anew_in_g90_is_that_of_holes_in_g91_too() -> None:
    program = interpret("G21 G90 S9 M3 F9\nG0 X0 Y0 Z10\nG91 G81 X10 Z-8 R-6\nG90 X20 Z-5\nG91 X10\nM2\n")
    np.testing.assert_allclose(program.end[program.kind == 1, 2] * 1e3, [-4, -5, -5], atol=1e-9)
    assert [f.line for f in program.findings if f.code == "cycle-heights"] == [5]


def test_linuxcnc_adds_r_and_z_anew_where_it_is_stated() -> None:
    program = interpret("G21 G90 S9 M3 F9\nG0 Z10\nG98 G81 X0 Z-5 R2\nG91 X10\nM2\n", dialect="linuxcnc")
    np.testing.assert_allclose(program.end[program.kind == 1, 2] * 1e3, [-5, 7], atol=1e-9)


def test_a_cycle_made_no_time_keeps_the_feed_and_modes_of_its_line() -> None:
    program = read("G99 G81 X10 Z-5 R2 F250 L0\nX20\n")
    np.testing.assert_allclose(program.end[1:] * 1e3, [[20, 0, 10], [20, 0, 2], [20, 0, -5], [20, 0, 2]], atol=1e-9)
    assert program.v_f[program.kind == 1] * 60e3 == pytest.approx([250])


def test_words_of_fanuc_cycles_are_read_where_nothing_says_the_control() -> None:
    head = "G21 G90 S100 M3 F100\nG0 X0 Y0 Z10\n"
    for cycle in ("G99 G82 X10 Z-5 R2\n", "G91 G99 G81 X10 Z-7 R-8 K1\n", "G99 G76 X10 Z-5 R2 Q0.2\n"):
        program = interpret(f"{head}{cycle}G80\nM30\n")
        np.testing.assert_allclose(program.end[program.kind == 1] * 1e3, [[10, 0, -5]], atol=1e-9)


def test_who_gives_r_anew_in_g91_counts_as_linuxcnc_does() -> None:
    """The test of cycles in the report on RS274/NGC: bottoms are added to each R, where nobody says another control."""
    text = "G21 G90 S9 M3 F9\nG0 Z10\nG81 X0 Y0 R2 Z-5\nX1 R0 G91 L2\nX1 R1\nM2\n"
    stated, guessed = (interpret(text, dialect=dialect) for dialect in ("linuxcnc", "auto"))
    np.testing.assert_allclose(guessed.end, stated.end, atol=1e-12)
    np.testing.assert_allclose(guessed.end[guessed.kind == 1, 2] * 1e3, [-5, 5, 5, 6], atol=1e-9)


def test_a_control_of_fanuc_begins_with_g98() -> None:
    """Holes end at the initial level until G99 is said; LinuxCNC begins at the R plane."""
    assert [z for _, _, z in ends("G81 X10 Z-5 R2\n")][-2:] == [-5, 10]
    assert [z for _, _, z in ends("G99 G81 X10 Z-5 R2\n")][-2:] == [-5, 2]


def ends(body: str) -> list[tuple[float, ...]]:
    return [tuple(row) for row in (np.round(read(body).end * 1e3, 9) + 0.0).tolist()]


@pytest.mark.parametrize("cycle", ["G84 X10 Z-5 R2", "G89 X10 Z-5 R2", "G85 X10 Z-5 R2"])
def test_taps_and_borers_leave_at_feed_up_to_r_and_at_rapid_from_there(cycle: str) -> None:
    program = read(f"{cycle}\n")
    out = [(int(k), round(float(z) * 1e3, 9)) for k, z in zip(program.kind, program.end[:, 2])]
    assert out[-3:] == [(1, -5), (1, 2), (0, 10)]


@pytest.mark.parametrize("dialect", ["fanuc", "auto"])
def test_a_depth_per_peck_without_a_point_counts_in_steps_of_the_control(dialect: str) -> None:
    """Fanuc: Q takes no decimal point; Q2000 is 2 mm, and 0.2 in where the program counts in inches."""
    for unit, mm in (("G21", 1.0), ("G20", 25.4)):
        hole = "G99 G83 X0 Y0 Z-5. R1. Q{} F9\n".format(2000 if unit == "G21" else 20000)
        program = interpret(f"{unit} G90 S9 M3\nG0 Z9.\n{hole}G80\nM30\n", dialect=dialect)
        np.testing.assert_allclose(program.end[program.kind == 1, 2] * 1e3 / mm, [-1, -3, -5], atol=1e-9)
        assert "peck-thousandths" in {f.code for f in program.findings}


def test_holes_on_a_circle_about_where_the_tool_is_or_the_line_says() -> None:
    """Haas Mill Operator's Manual, G70 and G71: radius, first angle, holes and, of an arc, the angle between them."""
    around = [(60, 0, -5), (50, 10, -5), (40, 0, -5), (50, -10, -5)]
    assert holes("G99 G81 Z-5 R2 L0\nG70 X50 Y0 I10 J0 L4\n") == around
    assert holes("G0 X50\nG99 G81 Z-5 R2 L0\nG70 I10 J0 L4\n") == around
    assert holes("G99 G81 Z-5 R2 L0\nG71 X5 Y5 I10 J90 K-90 L2\n") == [(5, 15, -5), (15, 5, -5)]
    # on the line that begins the cycle: none is drilled where the tool stands, and the cycle goes on
    assert holes("G0 X50\nG99 G81 Z-5 R2 G70 I10 J0 L4\nX1 Y1\n") == [*around, (1, 1, -5)]
    assert holes("G91 X1\nG90 G99 G81 X5 Y5 Z-5 R2 G71 I10 J90 K-90 L2\n") == [(5, 15, -5), (15, 5, -5)]
    auto = interpret("G21 G90 F100\nM97 P5\nG0 X9. Z9.\nG99 G81 Z-5. R2. L0\nG70 I1. J0. L2\nM30\nN5 M99\n")
    assert (auto.end[auto.kind == 1, 0] * 1e3).round(9).tolist() == [10, 8]
    for line, says in (("G91 G70 I1 J0 L2", "G70 is read in G17 and G90"), ("G70 I1 J0 L0", "for 1 to 10000 holes")):
        with pytest.raises(GCodeError, match=f"Line 4: .*{says}"):
            read(f"G99 G81 Z-5 R2 L0\n{line}\n")
    with pytest.raises(GCodeError, match="Line 3: G70 makes holes on a circle .Haas. or is a lathe"):
        read("G70 I1 J0 L2\n")


def test_holes_in_a_row_begin_where_the_line_says_and_a_negative_radius_goes_round_the_other_way() -> None:
    """YASNAC PC NC, G72: L places, I apart, on a line at J that begins at X, Y; a negative I goes to the other side."""
    cycle = "G99 G81 Z-5 R2 L0\n"
    assert holes(f"{cycle}G72 X5 Y1 I10 J0 L3\n") == [(5, 1, -5), (15, 1, -5), (25, 1, -5)]
    assert holes(f"G0 X5\n{cycle}G72 I-10 J90 L2\n") == [(5, 0, -5), (5, -10, -5)]
    assert holes("G0 X5\nG99 G81 Z-5 R2 G72 I10 J90 L2\n") == [(5, 0, -5), (5, 10, -5)]
    # a circle of I-10 is that of I10, clockwise from its first angle
    assert holes(f"{cycle}G71 I-10 J0 K90 L2\n") == [(10, 0, -5), (0, -10, -5)]
    assert holes(f"{cycle}G70 I-10 J0 L4\n") == [(10, 0, -5), (0, -10, -5), (-10, 0, -5), (0, 10, -5)]
    with pytest.raises(GCodeError, match=r"Line 4: G71 has I and K below 0"):
        read(f"{cycle}G71 I-10 J0 K-90 L2\n")
    with pytest.raises(GCodeError, match=r"Line 3: G72 makes holes on a line .Haas. or is a lathe"):
        read("G72 I10 J0 L2\n")


def test_the_next_place_is_gone_to_at_the_height_where_the_tool_is() -> None:
    program = read("G99 G81 X1 Z-5 R2\nG98 X3\n")
    heights = [(round(x * 1e3, 9), round(z * 1e3, 9)) for x, _, z in program.end.tolist()]
    assert heights[-3:] == [(3, 2), (3, -5), (3, 10)]


def test_what_a_cycle_says_holds_for_the_next_ones_until_g80() -> None:
    assert holes("G99 G82 X1 Z-5 R2 P500\nG81 X2\nG83 X3 Q4\n") == [(1, 0, -5), (2, 0, -5), (3, 0, -2), (3, 0, -5)]
    assert read("G99 G82 X1 Z-5 R2 P500\nG81 X2\nG82 X3\n").dwell_time == pytest.approx(1.0)
    with pytest.raises(GCodeError, match="Line 5: G81 needs R"):
        read("G99 G82 X1 Z-5 R2 P500\nG80\nG81 X2\n")


def pecked(first: float, fall: float, least: float, depth: float) -> list[float]:
    """Heights of the pecks of a hole of a depth below R, by the rule of the manual, one peck at a time."""
    done, peck, out = 0.0, first, []
    while done < depth:
        done = min(done + peck, depth)
        out.append(-done)
        peck = max(peck - fall, least)
    return out


@pytest.mark.parametrize("dialect", ["fanuc", "auto"])
@pytest.mark.parametrize(("cycle", "back"), [("G83", 1), ("G73", 0)])
def test_pecks_of_haas_fall(dialect: str, cycle: str, back: int) -> None:
    """I is the first peck, each is J less than the one before, none less than K; the next hole is pecked likewise."""
    body = f"G99 {cycle} X10 Z-20 R1 I8 J2.5 K3\nX20 Z-30\n{cycle} X30 Q10\n"
    program = interpret(f"G21 G90 S100 M3 F100\nG0 X0 Y0 Z10\n{body}G80\nM30\n", dialect=dialect)
    downs = program.end[program.kind == 1] * 1e3
    for x, depth, rule in ((10, 21, (8, 2.5, 3)), (20, 31, (8, 2.5, 3)), (30, 31, (10, 0, 10))):
        np.testing.assert_allclose(downs[downs[:, 0] == x, 2], 1 + np.array(pecked(*rule, depth)), atol=1e-9)
    first = program.end[(program.start[:, 0] * 1e3 == 10) & (program.kind == 0) & (program.end[:, 0] * 1e3 == 10), 2]
    assert (np.isclose(first * 1e3, 1.0).sum() > 2) == bool(back)
    assert program.kind[-1] == 0


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("G83 Z-9 R1 I3 J1\n", "Line 3: I has no use here"),
        ("G83 Z-9 R1 I3 J1 K0\n", "Line 3: G83 has I3 J1 K0; the depth per peck must be above 0"),
        ("G81 Z-9 R1 I3 J1 K1\n", "Line 3: I has no use here"),
        ("G83 Z-9 R1 I3 J1 K1 Q2\n", "Line 3: I has no use here"),
    ],
)
def test_pecks_that_do_not_fall_so_are_refused(body: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        read(body)


@pytest.mark.parametrize("line", ["G92 S3000", "G50 S3000.", "G92S3000 M8"])
def test_the_fastest_speed_of_the_spindle_is_not_its_speed(line: str) -> None:
    text = f"O1\nG21 G90\nS600 M3\n{line}\nG0 X1. Y2.\nG1 X5. F100.\nM30\n"
    program = interpret(text, dialect="fanuc")
    assert program.n_s[-1] == pytest.approx(10.0)
    assert (program.end * 1e3).tolist() == [pytest.approx([1, 2, 0]), pytest.approx([5, 2, 0])]


def test_a_fetched_tool_comes_from_above() -> None:
    """G100 T of a Brother changes to the tool and goes to X, Y and Z; what it left at depth is not dragged there."""
    text = (
        "O1\nG21 G90\nG100 T1 X50. Y40. G43 Z20. L2 H1 S800 M3\nG1 Z-1. F300\nX60.\nG100 T2 X10. Y9. G43 Z20. L1 H2\n"
    )
    program = interpret(f"%\n{text}G1 Z-2. F200\nY20.\nM30\n%\n", dialect="fanuc")
    cuts = program.at_feed
    np.testing.assert_allclose(program.end[cuts] * 1e3, [[50, 40, -1], [60, 40, -1], [10, 9, -2], [10, 20, -2]])
    assert program.tool[cuts].tolist() == [1, 1, 2, 2]
    path = to_toolpath(program)
    low = path.p[:, 2] < 0.0
    assert (np.diff(path.p[:, :2], axis=0)[low[:-1] & low[1:] & ~path.cutting[1:]] == 0.0).all(), "no rapid in the part"
    leaves = np.flatnonzero(program.line == 7)[0]
    assert program.away[leaves].tolist() == [False, False, True]


@pytest.mark.parametrize(
    ("word", "bottom", "depths"),
    [
        ("Q99", -199, [-98, -197, -199]),
        ("Q100", 0.75, [0.9, 0.8, 0.75]),
        ("Q100.5", -199, [-99.5, -199]),
        ("Q60000", -100, [-59, -100]),
    ],
)
def test_a_depth_per_peck_counts_in_thousandths_from_a_hundred_on(word: str, bottom: float, depths: list) -> None:
    """From 1 mm down: whole numbers from 100 on are steps of the control, others are lengths."""
    program = read(f"G99 G83 X0 Y0 Z{bottom} R1 {word}\n")
    np.testing.assert_allclose(program.end[program.kind == 1, 2] * 1e3, depths, atol=1e-9)


@pytest.mark.parametrize("line", ["G70 X50 Y0 I10 J0 L{}", "G71 X50 Y0 I10 J0 K5 L{}"])
def test_a_circle_has_one_hole_to_as_many_as_are_said(monkeypatch: pytest.MonkeyPatch, line: str) -> None:
    """The last count that fits, the first that does not."""
    monkeypatch.setattr("robomill.toolpath.gcode.fanuc.cycles.MOST_BOLTS", 6)
    for count in (1, 6):
        assert len(holes(f"G99 G81 Z-5 R2 L0\n{line.format(count)}\n")) == count
    for count in (0, 7):
        with pytest.raises(GCodeError, match="for 1 to 6 holes"):
            read(f"G99 G81 Z-5 R2 L0\n{line.format(count)}\n")


def test_fine_boring_takes_up_what_the_cycle_before_has_said() -> None:
    """Fanuc: R, Z and P of drilling cycles are modal data; Haas: I and J are the step aside, in place of Q."""
    assert holes("G82 X5 Z-3 R2 P500\nG76 X10 Q.5\nZ-4\n") == [(5, 0, -3), (10, 0, -3), (10, 0, -4)]
    assert holes("G76 X5 Z-3 R2 I.5 J0 P500\n") == [(5, 0, -3)]


def test_every_hole_that_is_left_by_hand_is_said_also_where_its_dwell_is_that_of_the_cycle_before() -> None:
    """What one cycle says holds for the next until G80: the second G88 and the one behind G82 say no P."""
    for first, said in (("G88", (3, 2)), ("G82", (4, 1))):
        findings = read(f"{first} X1 Z-1 R1 P500\nG88 X2\n").findings
        assert [(each.line, each.count) for each in findings if each.code == "manual-retract"] == [said]


@pytest.mark.parametrize(("plane", "axis", "r", "z"), [("G18", 1, "R-2.", "Y-9."), ("G19", 0, "R-2.", "X-9.")])
def test_a_tap_of_a_fanuc_goes_along_the_axis_of_its_plane(plane: str, axis: int, r: str, z: str) -> None:
    """G18 taps along Y, G19 along X; LinuxCNC's permuted axes are its own."""
    program = read(f"{plane} G99 G84 {r} {z}\n")
    tapped = program.end[program.thread] * 1e3
    np.testing.assert_allclose(tapped, np.insert([[0, 10]] * 2, axis, [-9, -2], axis=1), atol=1e-9)
    assert not [f for f in program.findings if f.code == "tap-axes"]


def test_j_of_haas_beside_a_tap_changes_no_place() -> None:
    """J2 comes out twice as fast; what it is read as is said."""
    program = read("G99 G84 X10. Z-5. R2. J2\nX20. J1\n")
    assert [f.line for f in program.findings if f.code == "tap-out"] == [3, 4]
    assert holes("G99 G84 X10. Z-5. R2. J2\n") == [(10, 0, -5), (10, 0, 2)]
    with pytest.raises(GCodeError, match="J has no use here"):
        read("G99 G84 X10. Z-5. R2. J20\n")
