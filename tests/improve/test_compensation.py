"""The corrected program against runs that know nothing of it: its text, read and simulated as any other program."""

from collections.abc import Callable

import numpy as np
import pytest

import robomill as rm
from robomill.improve.compensation import Compensation, beside, reversals
from robomill.improve.errors import errors_of
from tests.improve.corrected import DRILL, SLOT, beside_slot, own, tip_of


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


def test_a_coupled_run_of_the_text_finds_it_on_its_line() -> None:
    setup = rm.load_setup(SLOT / "setup_process.toml").replace(coupling=True)
    found = rm.compensate(setup)
    inside = beside_slot(found)[6:-1]  # the mill enters over 4 mm, in steps of 1 mm
    assert inside.max() < 0.01 * found.before.max
    assert 0.1 < found.softer.max / found.before.max < 0.25


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


ARCS = """G21 G90 G17\nS12000 M3\nG0 X-15 Y0 Z5\nG1 Z-1.5 F300\nG91\nG2 X15 Y15 I15 J0 F1200
G2 X15 Y-15 I0 J-15\nG1 Y-10\nG90\nG0 Z5\nM2\n"""


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


def test_each_iteration_says_how_much_still_changed_and_the_last_one_little(process: Compensation) -> None:
    assert process.iterations == len(process.change) >= 3
    assert process.change[0] > 0.2e-3
    assert process.change[-1] < 0.5e-6


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


def test_joints_that_turn_back_are_counted(slot: Compensation) -> None:
    """Along a straight slot in front of the arm only joints that see its middle turn back, once each."""
    assert 0 < reversals(slot.wanted) <= slot.setup.robot.n


@pytest.mark.parametrize("name", ["two_tools", "word", "paper_flute"])
def test_what_a_closer_look_finds_is_what_is_told_or_it_is_said(name: str) -> None:
    found = rm.compensate(rm.load_setup(name))
    run = rm.simulate(found.setup.replace(step_mm=0.25, source=found.source))
    more = max(np.nan_to_num(getattr(errors_of(run), of)[0] - getattr(found.after, of)[0]) for of in ("wall", "floor"))
    said = [each.sentence for each in found.findings if each.code == "between-samples"]
    assert bool(said) == (more > 5e-6)
    for each in said:
        assert "every 0.25 mm instead of every 1.0 mm" in each


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
