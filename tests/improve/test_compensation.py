"""The corrected program against runs that know nothing of it: its text, read and simulated as any other program."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import robomill as rm
from robomill.errors import CompensationError
from robomill.improve import correction
from robomill.improve.compensation import Compensation, beside, checked_components, reversals
from robomill.improve.errors import errors_of
from robomill.io.samples import samples_dir

SLOT = samples_dir() / "paper_flute"


@pytest.fixture(scope="module")
def slot() -> Compensation:
    return rm.compensate(rm.load_setup(SLOT))


@pytest.fixture(scope="module")
def process() -> Compensation:
    return rm.compensate(rm.load_setup(SLOT / "setup_process.toml"))


@pytest.fixture(scope="module")
def pocket() -> Compensation:
    return rm.compensate(rm.load_setup("pocket_arcs"))


def silent(text: str) -> str:
    """The program without what it says of itself."""
    return "".join(line for line in text.splitlines(keepends=True) if "robomill" not in line)


def tip_of(setup: rm.SimulationSetup, text: str) -> tuple[np.ndarray, rm.SimulationResult]:
    """(m, 3) m in {W}: where the tool really goes with a program that is simulated as it stands, and says nothing of
    what it was made of."""
    run = rm.simulate(setup.replace(source=rm.GCodeSource(silent(text), "corrected.nc")))
    assert run.ahead is None
    return np.asarray(run.path.p + run.delta @ setup.T_MW[:3, :3]), run


def beside_slot(found: Compensation, setup: rm.SimulationSetup | None = None) -> np.ndarray:
    """(k, 2) m: how far the tip is off the slot's line (Y 0, Z -2 mm) while it cuts, by an ordinary run of the text."""
    tip, run = tip_of(found.setup if setup is None else setup, found.text)
    return np.abs(tip[run.path.cutting] - [0.0, 0.0, -2e-3])[:, 1:]


def test_the_slots_tip_runs_along_its_line_within_a_hundredth_of_what_it_was_off(slot: Compensation) -> None:
    before = rm.simulate(slot.setup).max_deviation
    assert beside_slot(slot).max() < 0.01 * before
    assert slot.after.max < 0.01 * slot.before.max


def test_the_same_holds_of_a_force_that_follows_the_cut(process: Compensation) -> None:
    """Its engagement is that of the corrected path: 2 mm deep no more, so a mirror image would miss by a tenth."""
    off = beside_slot(process)
    assert off.max() < 0.03 * process.before.max  # where the mill has just touched
    assert off[8:].max() < 0.01 * process.before.max
    mirrored = -process.wanted.delta_in_cut[:, 1][process.wanted.path.cutting]
    assert np.abs(mirrored[-5] - process.c[-5, 1]) > 0.02e-3


def test_a_notebook_shows_what_stays_if_stiffness_or_force_is_a_fifth_off(slot: Compensation) -> None:
    page = slot._repr_html_()
    for name, left in (("Before", slot.before), ("After", slot.after), ("Compliances 20 % wrong", slot.softer)):
        assert name in page
        assert f"{left.max * 1e3:.4f}"[:5] in page
    assert "Force 20 % wrong" in page


def test_a_fifth_stays_where_every_joint_gives_a_fifth_more(slot: Compensation) -> None:
    arm = slot.setup.robot
    softer = slot.setup.replace(robot=arm.replace(C_theta=1.2 * arm.C_theta))
    off = beside_slot(slot, softer)
    assert off.max() == pytest.approx(0.2 * slot.before.max, rel=0.02)
    assert slot.softer.max == pytest.approx(off.max(), rel=0.01)
    assert slot.stronger.max == pytest.approx(slot.softer.max)


def test_a_fifth_stays_of_a_pocket_too_and_inside_the_model_less_than_a_hundredth(pocket: Compensation) -> None:
    assert pocket.after.max < 0.01 * pocket.before.max
    assert pocket.after.rms < 0.01 * pocket.before.rms
    assert 0.15 < pocket.softer.max / pocket.before.max < 0.25


def test_a_pockets_text_runs_as_an_ordinary_program_along_the_path_that_was_meant(pocket: Compensation) -> None:
    """Where it goes down as the arm is pushed up, no end of the tool cuts. At sharp corners the tip goes round in the
    links between two corrections, some tenths of a millimetre long."""
    tip, run = tip_of(pocket.setup, pocket.text)
    path = pocket.wanted.path
    begin, way = path.p[:-1][path.cutting[1:]], np.diff(path.p, axis=0)[path.cutting[1:]]
    square = np.maximum(np.einsum("ni,ni->n", way, way), 1e-30)
    x = tip[run.path.cutting & (run.path.p[:, 2] < -1e-3)]
    share = np.clip(np.einsum("mni,ni->mn", x[:, None] - begin, way) / square, 0.0, 1.0)
    off = np.linalg.norm(x[:, None] - begin - share[..., None] * way, axis=2).min(axis=1) / pocket.before.max
    assert np.median(off) < 0.01
    assert np.percentile(off, 95) < 0.05
    assert (off > 0.1).mean() < 0.03


def test_a_coupled_run_of_the_text_finds_it_on_its_line() -> None:
    setup = rm.load_setup(SLOT / "setup_process.toml").replace(coupling=True)
    found = rm.compensate(setup)
    inside = beside_slot(found)[6:-1]  # the mill enters over 4 mm, in steps of 1 mm
    assert inside.max() < 0.01 * found.before.max
    assert 0.1 < found.softer.max / found.before.max < 0.25


def test_its_text_simulated_is_told_from_the_path_that_was_meant(process: Compensation, pocket: Compensation) -> None:
    """As a file that somebody brings: nothing but its head says what it was made of. The tip of a run that knows
    nothing of that lies where this one says, on the slot's line."""
    for found in (process, pocket):
        run = rm.simulate(found.setup.replace(source=rm.GCodeSource(found.text, "brought.nc")))
        assert max(abs(run.verdict.wall.value), abs(run.verdict.floor.value)) < 0.01 * found.before.max
        assert run.setup.source.wanted == found.setup.source
        assert any("told from the path of" in note.sentence for note in run.notes)
    run = rm.simulate(process.setup.replace(source=process.source))
    tip, alone = tip_of(process.setup, process.text)
    there = np.asarray(run.path.p + run.delta @ process.setup.T_MW[:3, :3])[run.path.cutting]
    np.testing.assert_allclose(there[8:], tip[alone.path.cutting][-len(there) :][8:], atol=2e-6)
    sizes = np.linalg.norm(run.delta - run.ahead - run.delta_joint.sum(axis=1), axis=1)[run.path.cutting]
    assert sizes.max() < 1e-12


@pytest.mark.parametrize("way", ["G0 Z10", "G1 Z10", "G1 Z10 F2000", "G4 P1\nG1 Z10", "G85"])
def test_a_hole_is_corrected_however_the_tool_is_drawn_out_of_it(way: str) -> None:
    """Pushed as it comes down, the tip ends on the hole's bottom. Drawn out at feed it goes back there first, while
    only the floor can push it, and then up on the hole's axis."""
    bored = "G85 X3 Y2 Z-5 R1 F100\nG80" if way == "G85" else f"G1 Z-5 F100\n{way}"
    text = f"G21 G90\nS12000 M3\nG0 X3 Y2 Z10\n{bored}\nG0 Z20\nM2\n"
    setup = rm.load_setup(SLOT / "setup_process.toml").replace(source=rm.GCodeSource(text))
    found = rm.compensate(setup)
    before = rm.simulate(setup).verdict
    assert found.before.max == pytest.approx(max(abs(before.wall.value), abs(before.floor.value)), rel=0.01)
    assert found.after.max < 0.01 * found.before.max
    tip, run = tip_of(setup, found.text)
    end = int(np.flatnonzero(run.conditions.plunges & run.conditions.engaged)[-1])
    bottom = -5e-3 + (float(run.C[end, 2] @ run.F[end]) if "G4" in way else 0.0)  # waiting, it cuts to depth
    np.testing.assert_allclose(tip[end], [3e-3, 2e-3, bottom], atol=3e-6)
    if way != "G0 Z10":
        after = run.path.p[end + 1 :][run.path.cutting[end + 1 :]]
        at = int(np.argmax(np.linalg.norm(after - [3e-3, 2e-3, -5e-3], axis=1) < 1e-6))
        np.testing.assert_allclose(after[at], [3e-3, 2e-3, -5e-3], atol=1e-6)
        np.testing.assert_allclose(after[at:, :2], np.broadcast_to([3e-3, 2e-3], after[at:, :2].shape), atol=1e-6)
        assert np.linalg.norm(after[:at] - tip[end], axis=1).max(initial=0.0) < 1.01 * run.deviation[end]
    if "G4" in way:
        lines = found.text.splitlines()
        assert {"X3", "Y2"} <= set(lines[lines.index("G4 P1") - 1].split())


def test_a_slot_left_at_feed_goes_back_to_its_end_and_then_straight_up() -> None:
    text = "G21 G90\nS12000 M3\nG0 X-40 Y0 Z10\nG0 Z-2\nG1 X8 F1000\nG1 Z10\nG0 Z20\nM2\n"
    found = rm.compensate(rm.load_setup(SLOT).replace(source=rm.GCodeSource(text)))
    tip, run = tip_of(found.setup, found.text)
    assert found.after.max < 0.01 * found.before.max
    up = run.path.cutting & (np.diff(run.path.p[:, 2], prepend=0.0) > 0.02e-3) & (run.path.p[:, 0] > 0.0)
    np.testing.assert_allclose(run.path.p[up, :2], np.broadcast_to([8e-3, 0.0], (up.sum(), 2)), atol=1e-6)


def test_a_ramp_into_a_level_cut_is_cut_to_its_depth_up_to_its_end() -> None:
    """Its end teeth push the tool up by 0.7 mm to the last; only then does the level cut let it down."""
    text = "G21 G90\nS12000 M3\nG0 X-20 Y0 Z1\nG1 X0 Z-3 F600\nX20\nG0 Z20\nM2\n"
    found = rm.compensate(rm.load_setup(SLOT / "setup_process.toml").replace(source=rm.GCodeSource(text)))
    assert found.after.max < 0.01 * found.before.max
    tip, run = tip_of(found.setup.replace(coupling=True), found.text)  # it meets the part where it is pushed to
    x, y, z = tip[run.path.cutting & run.conditions.engaged].T
    on_ramp, on_level = (x > -9e-3) & (x < -0.5e-3), x > 1e-3
    assert np.abs(z[on_ramp] - (1e-3 - 0.2 * (x[on_ramp] + 20e-3))).max() < 0.02 * found.before.max
    assert np.abs(z[on_level] + 3e-3).max() < 0.02 * found.before.max
    assert np.abs(y[on_ramp | on_level]).max() < 0.02 * found.before.max


@pytest.mark.parametrize(("begin", "short"), [(-20.0, 0.1), (-20.0, 0.02), (-12.0, 0.02), (-5.0, 0.05)])
def test_a_ramp_is_corrected_where_the_level_cut_begins_with_a_short_step(begin: float, short: float) -> None:
    """Shorter than the tool is pushed along it, as on a circle at the end of a helix: correcting that there, too, sent
    the tool back, and on its next step down by as much as the ramp pushes it up: 1.06 mm too deep, and refused.
    Steep ramps ask for it by what is across them alone, which leads along the cut that goes on."""
    text = f"G21 G90\nS12000 M3\nG0 X{begin} Y0 Z1\nG1 X0 Z-3 F600\nX{short}\nX20\nG0 Z20\nM2\n"
    found = rm.compensate(rm.load_setup(SLOT / "setup_process.toml").replace(source=rm.GCodeSource(text)))
    assert found.after.max < 0.012 * found.before.max
    level = found.led.path.cutting & (found.led.path.p[:, 0] > 0.0)
    tip, run = tip_of(found.setup, found.text)
    assert np.abs(found.led.delta[level][:, 2]).max() < 10e-6
    assert tip[run.path.cutting & (run.path.p[:, 0] > 0.5e-3), 2] == pytest.approx(-3e-3, abs=10e-6)


def test_at_the_corners_of_a_zigzag_nothing_is_cut_deeper_than_elsewhere() -> None:
    """Where the tool just leaves a wall, the push ends at once: it is not sent down against it there."""
    text = "G0 X-20 Y-8 Z10\nG0 Z-2\nG1 X20 F600\nY-4\nX-20\nY0\nX20\nG0 Z20\nM2\n"
    setup = rm.load_setup(SLOT / "setup_process.toml").replace(source=rm.GCodeSource(f"G21 G90\nS12000 M3\n{text}"))
    found = rm.compensate(setup)
    tip, run = tip_of(setup, found.text)
    assert found.before.floor[0] > 0.09e-3
    assert tip[run.path.cutting, 2].min() > -2.02e-3


def test_a_softer_arm_leaves_a_fifth_of_a_program_that_is_simulated_too(slot: Compensation) -> None:
    arm = slot.setup.robot
    softer = slot.setup.replace(robot=arm.replace(C_theta=1.2 * arm.C_theta))
    run = rm.simulate(softer.replace(source=rm.GCodeSource(slot.text)))
    assert abs(run.verdict.wall.value) == pytest.approx(0.2 * slot.before.max, rel=0.02)


def test_beside_another_path_it_says_that_it_is_told_from_its_own_lines(slot: Compensation) -> None:
    other = rm.load_setup("heart").replace(source=rm.GCodeSource(slot.text), robot=slot.setup.robot)
    assert other.wanted_path is None
    run = rm.simulate(slot.setup.replace(source=rm.GCodeSource(slot.text.replace("X50", "X49"), "c.nc")))
    assert run.ahead is not None  # the one it names is there: what was changed by hand is told
    alone = rm.simulate(slot.setup.replace(source=other.source))
    assert alone.ahead is not None
    told = [note for note in rm.simulate(other).notes if note.code == "wanted-path"]
    assert [note.level for note in told] == ["warning"]
    assert "open path.nc before it" in told[0].sentence


def test_what_is_corrected_is_not_corrected_again(slot: Compensation) -> None:
    for source in (slot.source, rm.GCodeSource(slot.text)):
        with pytest.raises(rm.RobomillError, match=r"corrected already: ask this of the program .* path\.nc"):
            rm.compensate(slot.setup.replace(source=source))


@pytest.mark.parametrize(
    ("tolerance_mm", "components", "code"), [(0.002, "normal", "not-met"), (0.03, "normal,axial", "met-if-right")]
)
def test_a_tolerance_that_is_not_kept_or_only_by_right_numbers_is_said(
    tolerance_mm: float, components: str, code: str
) -> None:
    """Where the wall alone is corrected the floor stays 0.1 mm too deep; where both are, 0.046 mm of wall stay if the
    arm gives a fifth more; of 0.3 mm none of both is worth a word."""
    setup = rm.load_setup(SLOT)
    found = rm.compensate(setup.replace(tolerance_mm=tolerance_mm), components)
    assert [each.code for each in found.findings if each.level == "warning"] == [code]
    assert not [each for each in rm.compensate(setup).findings if each.level == "warning"]


def test_what_the_tip_springs_by_at_corners_is_told_apart_as_a_run_of_the_text_alone_has_it(
    pocket: Compensation,
) -> None:
    """Feed moves of under 0.6 mm that turn off sharply between two cuts: there the tip is nowhere else as far off."""
    link, touch = pocket.sprung
    assert (link.kind, touch.kind, touch.count) == ("link", "touch", 1)
    tip, run = tip_of(pocket.setup, pocket.text)
    worst = off_lines(tip, pocket.wanted.path)[run.path.cutting & run.conditions.engaged]
    assert link.size == pytest.approx(worst.max(), rel=1e-6)
    jump = np.linalg.norm(np.diff(pocket.c, axis=0), axis=1)
    path = pocket.wanted.path
    there = (np.diff(path.p, axis=0) == 0.0).all(axis=1) & path.cutting[1:] & path.cutting[:-1] & (jump > 20e-6)
    assert abs(there.sum() - link.count) <= 1  # one is as short as a step of its own
    sentences = [each.sentence for each in pocket.findings if each.code.startswith("springs")]
    assert f"at {link.count} corners" in sentences[0]
    assert f"by up to {1e3 * link.size:.3f} mm" in sentences[0]
    assert "no program can take that away" in sentences[1]


def off_lines(x: np.ndarray, path: rm.Toolpath) -> np.ndarray:
    """(m,) m: how far points x (m, 3) m are off the feed moves of a path."""
    begin, way = path.p[:-1][path.cutting[1:]], np.diff(path.p, axis=0)[path.cutting[1:]]
    square = np.maximum(np.einsum("ni,ni->n", way, way), 1e-30)
    share = np.clip(np.einsum("mni,ni->mn", x[:, None] - begin, way) / square, 0.0, 1.0)
    return np.linalg.norm(x[:, None] - begin - share[..., None] * way, axis=2).min(axis=1)


DRILL = "G21 G90\nS6000 M3\nG0 X10 Y10 Z5\nG1 Z-4 F200\nG0 Z5\nG0 X-10 Y5\nG1 Z-4\nG0 Z5\nM2\n"
ARCS = """G21 G90 G17\nS12000 M3\nG0 X-15 Y0 Z5\nG1 Z-1.5 F300\nG91\nG2 X15 Y15 I15 J0 F1200
G2 X15 Y-15 I0 J-15\nG1 Y-10\nG90\nG0 Z5\nM2\n"""


def own(text: str) -> rm.SimulationSetup:
    block = rm.Stock(lower_mm=(-40, -40, -15), upper_mm=(40, 40, 0))
    return rm.load_setup("pocket_arcs").replace(source=rm.GCodeSource(text, "own.nc"), stock=block)


PROMISED: dict[str, Callable[[], rm.SimulationSetup]] = {
    "constant force": lambda: rm.load_setup(SLOT),
    "process force": lambda: rm.load_setup(SLOT / "setup_process.toml"),
    "heart": lambda: rm.load_setup("heart"),
    "drilling": lambda: own(DRILL),
    "incremental arcs": lambda: own(ARCS),
}


@pytest.mark.parametrize("name", PROMISED)
def test_what_is_told_to_remain_is_what_a_simulation_of_the_text_gives_at_any_step(name: str) -> None:
    """Within 5 um; at the same step to the last digit."""
    setup = PROMISED[name]()
    found = rm.compensate(setup)
    for step_mm in (None, 0.5, 0.2):
        asked = setup if step_mm is None else setup.replace(step_mm=step_mm)
        given = errors_of(rm.simulate(asked.replace(source=rm.GCodeSource(found.text, "brought.nc"))))
        for name in ("wall", "floor"):
            there, told = np.nan_to_num([getattr(given, name), getattr(found.after, name)])
            np.testing.assert_allclose(there, told, atol=1e-12 if step_mm is None else 5e-6)


def test_a_plunge_is_led_straight_down_beside_its_hole() -> None:
    """As it first touches the force is there at once: what undoes it is there before, in the air; and along a way that
    leans by a thousandth the tool would cut with its side."""
    found = rm.compensate(own(DRILL))
    tip, run = tip_of(found.setup, found.text)
    cut = run.path.cutting & run.conditions.engaged
    holes = np.array([[0.010, 0.010], [-0.010, 0.005]])
    off = np.linalg.norm(tip[cut, None, :2] - holes, axis=2).min(axis=1)
    assert off.max() < 5e-6 < 0.3e-3 < found.before.wall[0]
    moves = np.diff(run.path.p[:, :2], axis=0)[run.path.cutting[1:]]
    assert np.abs(moves).max() < 1e-9


def test_each_iteration_says_how_much_still_changed_and_the_last_one_little(process: Compensation) -> None:
    assert process.iterations == len(process.change) >= 3
    assert process.change[0] > 0.2e-3
    assert process.change[-1] < 0.5e-6


def test_lines_keep_numbers_comments_feeds_and_words_and_only_places_change(slot: Compensation) -> None:
    before, after = slot.source.name, silent(slot.text).splitlines()
    given = rm.read_program(SLOT / "path.nc").text.splitlines()
    assert before == "path_corrected.nc"
    assert slot.lines_in == slot.lines_out - 2 == len(given)
    changed = [(a, b) for a, b in zip(given, after, strict=True) if a != b]
    assert [a for a, _ in changed] == ["N30 G0 X-50 Y0 Z20", "N40 G0 Z-2"]
    assert [b.split(" ")[:2] for _, b in changed] == [["N30", "G0"], ["N40", "G0"]]


def test_a_retract_goes_straight_up_from_where_the_cut_ended(slot: Compensation) -> None:
    path = slot.source.read()
    up = np.flatnonzero(~path.cutting)[-1]
    np.testing.assert_allclose(path.p[up, :2], path.p[up - 1, :2], atol=1e-9)


def test_only_what_is_chosen_is_corrected() -> None:
    setup = rm.load_setup(SLOT)
    normal, axial, every = (rm.compensate(setup, which) for which in ("normal", "axial", "normal, axial,feed"))
    assert np.abs(normal.c[:, 2]).max() < 0.1e-6 < np.abs(normal.c[:, 1]).max()
    assert np.abs(axial.c[:, 1]).max() < 0.1e-6 < np.abs(axial.c[:, 2]).max()
    assert np.abs(every.c[:, 0]).max() > 1e-6
    ends = [tip[run.path.cutting][-1, 0] - 0.05 for tip, run in (tip_of(setup, each.text) for each in (axial, every))]
    assert abs(ends[1]) < 0.5e-6 < abs(ends[0])
    assert normal.after.wall[0] < 0.5e-6
    assert normal.after.floor[0] == pytest.approx(normal.before.floor[0], rel=0.01)


def test_feed_is_left_alone_unless_asked(slot: Compensation) -> None:
    assert np.abs(slot.c[:, 0]).max() < 1e-12


def test_a_finer_bound_takes_more_lines_and_each_keeps_it(process: Compensation) -> None:
    coarse = rm.compensate(process.setup, bound_um=20)
    assert coarse.lines_out <= process.lines_out
    assert process.after.max < 2e-6
    assert coarse.after.max < 20e-6


def test_arcs_stay_arcs_where_their_correction_is_even() -> None:
    """Around a circle about joint 1's axis a push along the tool is the same everywhere."""
    setup = rm.load_setup(SLOT)
    text = "G21 G90 G17\nG0 X-20 Y0 Z5\nG0 Z-2\nG2 X20 Y0 I20 J0 F600\nG0 Z5\nM2\n"
    force = rm.PathForce(axial=-20.0)
    found = rm.compensate(setup.replace(source=rm.GCodeSource(text, "arc.nc"), force=force), "axial", bound_um=20)
    assert sum(line.startswith("G2 ") for line in found.text.splitlines()) == 1
    assert found.lines_out < 12


def test_a_full_circle_becomes_some_arcs_that_lie_where_they_are_meant() -> None:
    """Its axial correction rises and falls by 0.25 mm on the way round, so one arc cannot do; read again, the arcs lie
    on the corrected places."""
    lines = ("G21 G90", "S12000 M3", "G0 X20 Y0 Z10", "G1 Z-2 F600", "G3 X20 Y0 I-20 J0 F1800", "G0 Z10", "M2")
    found = rm.compensate(rm.load_setup("pocket_arcs").replace(source=rm.GCodeSource("\n".join(lines) + "\n", "c.nc")))
    assert found.after.max < 0.01 * found.before.max
    assert found.lines_out < 40
    assert sum("I" in line for line in found.text.splitlines()) > 10
    read = rm.read_gcode(found.text, chord_error=1e-7).p
    meant = (found.wanted.path.p + found.c)[found.wanted.path.cutting]
    way = np.diff(read, axis=0)
    share = np.einsum("mni,ni->mn", meant[:, None] - read[:-1], way) / np.maximum((way**2).sum(axis=1), 1e-30)
    nearest = read[:-1] + np.clip(share, 0.0, 1.0)[..., None] * way
    assert np.linalg.norm(meant[:, None] - nearest, axis=2).min(axis=1).max() < 0.5e-6


def test_an_arc_that_ends_steeply_is_corrected_along_its_curve() -> None:
    """In the plane of the tool, 75 degrees up and down at its ends: its last third was measured against the chord."""
    radius, half, low = 10e-3, 9.659e-3, -4.588e-3
    lines = ("G21 G90", "S12000 M3", "G0 X-60 Y0 Z5", "G0 Z-2", "G1 X-9.659 F1200", "G18 G3 X9.659 Z-2 I9.659 K-2.588")
    text = "\n".join([*lines, "G17 G1 X80", "G0 Z5", "M2", ""])
    setup = rm.load_setup(SLOT).replace(source=rm.GCodeSource(text), force=rm.PathForce(feed=-40, feed_normal=120))
    found = rm.compensate(setup)
    p = found.led.path.p
    on_arc = (np.abs(p[:, 0]) < half - 1e-5) & found.led.path.cutting
    assert np.hypot(p[on_arc, 0], p[on_arc, 2] - low) == pytest.approx(radius, abs=3e-6)
    tip, run = tip_of(setup, found.text)
    curve = run.path.cutting & (np.abs(tip[:, 0]) < half) & (tip[:, 2] > -1.5e-3)
    assert np.abs(np.hypot(tip[curve, 0], tip[curve, 2] - low) - radius).max() < 6e-6
    assert np.abs(tip[curve, 1]).max() < 6e-6
    assert found.after.max < 6e-6


def test_paths_that_are_no_program_are_written_as_one() -> None:
    setup = rm.load_setup(SLOT)
    path = rm.Toolpath.from_points(p_mm=[[-50, 0, -2], [50, 0, -2]], feed_mm_min=1800)
    lines = rm.LinesSource(start_mm=[[-50, 0, -2]], end_mm=[[50, 0, -2]], feed_mm_min=[1800])
    for source in (path, lines):
        found = rm.compensate(setup.replace(source=source))
        assert found.name == "corrected.nc"
        assert beside_slot(found).max() < 0.01 * found.before.max


def test_it_is_a_value_and_a_table(slot: Compensation) -> None:
    again = rm.compensate(slot.setup)
    assert again == slot
    assert again.digest() == slot.digest()
    assert rm.compensate(slot.setup, "normal").digest() != slot.digest()
    columns = slot.columns()
    assert np.abs(columns["after_normal_mm"]).max() < 1e-3 < np.abs(columns["before_normal_mm"]).max()
    assert "0.2295 mm before" in repr(slot)


def test_the_band_of_what_remains_is_that_of_the_deflection() -> None:
    """1 % of every compliance, all independent: by brute force over each."""
    from robomill.identification.fit.models import Model
    from robomill.identification.knowledge import Knowledge

    setup = rm.load_setup(SLOT)
    arm = setup.robot
    known = Knowledge(Model("joints"), arm.C_theta, np.diag((0.01 * arm.C_theta) ** 2))
    found = rm.compensate(setup, known=known)
    each = []
    for joint in range(arm.n):
        C = np.array(arm.C_theta)
        C[joint] *= 1.01
        moved = tip_of(setup.replace(robot=arm.replace(C_theta=C)), found.text)[0] - tip_of(setup, found.text)[0]
        each.append(moved)
    half = 1.959964 * np.sqrt((np.array(each) ** 2).sum(axis=0))[5:, 1:].max()
    assert found.half == pytest.approx(half, rel=0.02)
    assert np.isnan(rm.compensate(setup).half)


def far(setup: rm.SimulationSetup) -> rm.SimulationSetup:
    return setup.replace(part_zero_mm=(0, -2600, 2))


def unknown(setup: rm.SimulationSetup) -> rm.SimulationSetup:
    text = setup.source.block_texts()
    return setup.replace(source=rm.GCodeSource("\n".join(text).replace("S12000 M3", "G96 S100 M3"), "path.nc"))


REFUSED: dict[str, tuple[Callable[[rm.SimulationSetup], rm.SimulationSetup], Path, str]] = {
    "not reached": (far, SLOT, "reached"),
    "no speed, so no force is known": (unknown, SLOT / "setup_process.toml", "not judged"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_predicted_is_not_corrected(name: str) -> None:
    change, file, words = REFUSED[name]
    with pytest.raises(CompensationError, match=words):
        rm.compensate(change(rm.load_setup(file)))


def test_an_arm_that_gives_too_much_is_refused_by_name() -> None:
    setup = rm.load_setup(SLOT / "setup_process.toml")
    arm = setup.robot
    with pytest.raises(rm.RobomillError, match=r"^The path is not corrected"):
        rm.compensate(setup.replace(robot=arm.replace(C_theta=60.0 * arm.C_theta)))


def test_what_does_not_settle_is_refused_by_its_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(correction, "MOST", 2)
    with pytest.raises(CompensationError, match=r"does not settle \(line 7\): after 2 runs it still changes by 0\.02"):
        rm.compensate(rm.load_setup(SLOT / "setup_process.toml"))


@pytest.mark.parametrize("given", ["", "sideways", ["normal", "up"], []])
def test_components_are_named(given: str | list[str]) -> None:
    with pytest.raises(CompensationError, match=r"expected some of normal, axial, feed"):
        checked_components(given)


@pytest.mark.parametrize("bound_um", [0.0, -1.0, float("nan"), 5000.0])
def test_a_bound_that_no_program_keeps_is_refused(bound_um: float) -> None:
    with pytest.raises(CompensationError, match="Bound"):
        rm.compensate(rm.load_setup(SLOT), bound_um=bound_um)


def test_joints_that_turn_back_are_counted(slot: Compensation) -> None:
    """Along a straight slot in front of the arm only joints that see its middle turn back, once each."""
    assert 0 < reversals(slot.wanted) <= slot.setup.robot.n


def test_a_path_on_which_force_and_deflection_do_not_agree_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """An arm twelve times softer, where nothing is sought beside going round: at some places that does not settle."""
    monkeypatch.setattr("robomill.simulation.coupling.TURNS", 0)
    setup = rm.load_setup(SLOT / "setup_process.toml")
    soft = setup.robot.replace(C_theta=12.0 * setup.robot.C_theta)
    with pytest.raises(CompensationError, match=r"at line \d.* force and deflection do not agree: .* remain"):
        rm.compensate(setup.replace(robot=soft, coupling=True, step_mm=5.0, cell_mm=0.4))


def test_a_plunge_into_what_is_open_already_meets_nothing_where_the_deflected_tool_has_left_the_floor() -> None:
    """In the word a stroke begins where an earlier one has been cut. A coupled run, which cuts where the tool really
    stands and is solved step by step, found a gouge of 0.170 mm beside that place when the plunge was corrected as if
    it cut; the worst that it finds now is elsewhere, and half of that."""
    setup = rm.load_setup("word")
    found = rm.compensate(setup)
    run = rm.simulate(setup.replace(coupling=True, source=found.source))
    crossing = np.linalg.norm(run.path.p[run.gauge.walls.sample][:, :2] - [0.032, 0.008], axis=1) < 1e-3
    assert crossing.any()
    assert np.abs(run.gauge.walls.error[crossing]).max() < 0.02e-3
    assert np.abs(run.gauge.walls.error).max() < 0.1e-3


@pytest.mark.parametrize("name", ["two_tools", "word", "paper_flute"])
def test_what_a_closer_look_finds_is_what_is_told_or_it_is_said(name: str) -> None:
    found = rm.compensate(rm.load_setup(name))
    run = rm.simulate(found.setup.replace(step_mm=0.25, source=found.source))
    more = max(np.nan_to_num(getattr(errors_of(run), of)[0] - getattr(found.after, of)[0]) for of in ("wall", "floor"))
    said = [each.sentence for each in found.findings if each.code == "between-samples"]
    assert bool(said) == (more > 5e-6)
    for each in said:
        assert "every 0.25 mm instead of every 1.0 mm" in each


RECTANGLE = [(-66, -30), (30, -30), (30, 20), (-30, 20), (-30, -30), (-10, -30)]


def around(places: list[tuple[float, float, float]]) -> rm.GCodeSource:
    """A program through places, mm."""
    (x, y, z), *others = places
    lines = [
        f"G0 X{x:.4f} Y{y:.4f} Z5",
        f"G0 Z{z:.4f}",
        *(f"G1 X{x:.4f} Y{y:.4f} Z{z:.4f} F1800" for x, y, z in others),
    ]
    return rm.GCodeSource("\n".join(["G21 G90 G17", "S12000 M3", *lines, "G0 Z20", "M2"]), "rectangle.nc")


@pytest.mark.parametrize("step_mm", [0.25, 1.0])
def test_a_rectangle_is_corrected_at_its_corners_as_by_hand(step_mm: float) -> None:
    """By hand: each leg is moved by what undoes the deflection in its middle, with straight lines across at corners."""
    stock = rm.Stock(lower_mm=(-60, -60, -20), upper_mm=(60, 60, 0))
    setup = rm.load_setup("paper_flute").replace(
        source=around([(x, y, -2.0) for x, y in RECTANGLE]), stock=stock, step_mm=step_mm
    )
    run, places = rm.simulate(setup), []
    for (x0, y0), (x1, y1) in pairwise(RECTANGLE):
        middle = np.array([x0 + x1, y0 + y1]) / 2.0
        i = int(np.argmin(np.linalg.norm(run.path.p[:, :2] * 1e3 - middle, axis=1)))
        d = run.delta[i] @ setup.T_MW[:3, :3] * 1e3
        d[0 if x0 != x1 else 1] = 0.0  # not along the feed
        places += [(x0 - d[0], y0 - d[1], -2.0 - d[2]), (x1 - d[0], y1 - d[1], -2.0 - d[2])]
    by_hand = rm.simulate(setup.replace(source=replace(around(places), wanted=setup.source)))
    found = rm.compensate(setup)
    assert abs(run.verdict.wall.value) > 0.2e-3
    assert abs(by_hand.verdict.wall.value) < 0.012e-3
    assert found.after.max < 0.001e-3
    tip, plain = tip_of(setup, found.text)
    legs = plain.path.cutting & (plain.path.step_length > 0.5e-3 * min(step_mm, 1.0))
    legs &= np.abs(plain.R_MF[:, :2, 0]).max(axis=1) > 1.0 - 1e-3  # not on the links across
    x, y, z = tip[legs].T * 1e3
    off = np.min([np.abs(y + 30), np.abs(x - 30), np.abs(y - 20), np.abs(x + 30)], axis=0)
    assert off.max() < 0.002
    assert np.median(np.abs(z + 2.0)) < 0.001


def test_rectangles_one_in_another_are_corrected_with_a_force_that_follows_the_cut() -> None:
    """A pocket: the way out to each larger rectangle goes on in the direction in which it came."""
    lines = ["G21 G90 G17", "S12000 M3", "G0 X0 Y0 Z5", "G1 Z-2 F200"]
    for x, y in ((2.0, 1.4), (7.0, 4.9), (12.0, 8.4)):
        lines += [f"G1 X{x} Y{-y} F1500", f"Y{y}", f"X{-x}", f"Y{-y}", f"X{x}"]
    source = rm.GCodeSource("\n".join([*lines, "G0 Z20", "M2"]), "pocket.nc")
    flute = rm.load_setup("paper_flute")
    setup = flute.replace(
        source=source,
        stock=rm.Stock(lower_mm=(-60, -60, -20), upper_mm=(60, 60, 0)),
        force=rm.process_force("al7075_t6_carbide_ref190", flute.cutter),
        engagement=True,
        step_mm=1.0,
    )
    found = rm.compensate(setup)
    assert found.before.max > 0.2e-3
    assert found.after.max < 0.005e-3
    tip, plain = tip_of(setup, found.text)
    legs = plain.path.cutting & (plain.path.step_length > 0.4e-3) & (np.abs(plain.R_MF[:, :2, 0]).max(axis=1) > 0.999)
    x, y, _ = np.abs(tip[legs & (np.abs(tip[:, :2]) > [6e-3, 4e-3]).any(axis=1)].T) * 1e3
    off = np.min([np.abs(x - 7.0), np.abs(x - 12.0), np.abs(y - 4.9), np.abs(y - 8.4)], axis=0)
    assert np.median(off) < 0.002


def test_what_was_at_samples_of_a_path_is_found_beside_it_by_the_share_of_each_cut_that_is_gone() -> None:
    """Two cuts of 10 and 20 mm; on the other path the first is twice as long and the second half."""
    feed = [0, *[600] * 5, 0, *[600] * 5]
    x = np.linspace(0.0, 1.0, 6)
    path, other = (
        rm.Toolpath.from_points(
            p_mm=np.column_stack([np.append(a * x**power, 50 + b * x**power), np.zeros(12), np.full(12, -2.0)]),
            feed_mm_min=feed,
        )
        for a, b, power in ((10, 20, 1), (20, 10, 2))
    )
    values = np.append(3.0 * x**2, 7.0 - 2.0 * x**2)[:, None] * [1.0, -2.0]
    truth = np.append(3.0 * x, 7.0 - 2.0 * x)[:, None] * [1.0, -2.0]
    found = beside(path, other, values)
    np.testing.assert_allclose(found[path.cutting], truth[path.cutting], atol=1e-12)
    assert not found[~path.cutting].any()


@pytest.mark.parametrize("rule", ["least_motion", "least_deviation"])
def test_an_arm_that_may_choose_its_spin_keeps_the_one_it_has_along_points(rule: str) -> None:
    """What is written begins elsewhere than the points, and the arm would turn the tool otherwise from there."""
    x = np.linspace(-40.0, 40.0, 41)
    wave = rm.Toolpath.from_points(
        p_mm=np.column_stack([x, 10.0 * np.sin(x / 15.0), np.full(41, -2.0)]), feed_mm_min=[0] + [1500] * 40
    )
    setup = rm.SimulationSetup(
        robot=rm.load_robot("fanuc_r2000ic"),
        source=wave,
        cutter=rm.Cutter("ball", diameter_mm=8, flutes=2),
        force=rm.PathForce(feed_normal_N=100, axial_N=-30),
        stock=rm.Stock(lower_mm=(-60, -40, -20), upper_mm=(60, 40, 0)),
        part_zero_mm=(1300, 0, 500),
        spin=rule,
    )
    spin = float(rm.simulate(setup).ik.spin[0])
    found = rm.compensate(setup)
    for run in (found.wanted, found.led, rm.simulate(setup.replace(source=found.source))):
        np.testing.assert_array_equal(run.ik.spin, spin)
    held = rm.compensate(setup.replace(spin=spin))
    assert found.after.max == pytest.approx(held.after.max, abs=1e-6)
    assert found.after.max < 0.02 * found.before.max
