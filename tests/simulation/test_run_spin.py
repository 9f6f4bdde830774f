"""The free spin of six-axis arms in a set-up: each spin run by itself, the least of them taken, said in the file."""

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.errors import ProjectError, SetupError
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup, setup_from_toml, setup_to_toml
from robomill.kinematics.transforms import translation
from robomill.simulation.reach import path_reach
from robomill.simulation.run import chooses_spin, configurations, deviation_over_spin, spin_along, spin_of
from robomill.simulation.samples import sampled

PAPER = load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(step=5e-3)
FANUC = PAPER.replace(robot=rm.load_robot("fanuc_r2000ic"), T_MW=translation(np.array([1.7, 0.3, 0.5])))
KUKA = PAPER.replace(robot=rm.load_robot("kuka_kr500"), T_MW=translation(np.array([1.8, 0.3, 0.6])))
ANGLES = np.radians(np.arange(0, 360, 15))


@pytest.fixture(scope="module")
def each():
    """Largest deviation of the FANUC's run at each spin, by whole runs; NaN where a point is missed."""
    runs = [rm.simulate(FANUC.replace(spin=float(angle))) for angle in ANGLES]
    return np.array([np.nan if not run.reached.all() else run.deviation[run.path.cutting].max() for run in runs])


def test_a_given_spin_turns_the_tool_about_its_axis():
    """Off by the angle about z_T from the pose that R_x(A) R_y(B) gives, at every sample."""
    run = rm.simulate(FANUC.replace(spin=0.7))
    assert run.reached.all()
    found = rm.tool_pose(FANUC.robot, run.theta)
    np.testing.assert_allclose(found[:, :3, 2], np.broadcast_to([0, 0, 1], (len(found), 3)), atol=1e-9)
    np.testing.assert_allclose(np.arctan2(found[:, 1, 0], found[:, 0, 0]), 0.7, atol=1e-9)


def test_least_deviation_is_the_least_of_all_runs(each):
    best = rm.simulate(FANUC.replace(spin="least_deviation"))
    assert best.deviation[best.path.cutting].max() == pytest.approx(np.nanmin(each), rel=1e-9)
    assert best.ik.spin[0] == pytest.approx(ANGLES[np.nanargmin(each)])
    assert np.ptp(best.ik.spin) == 0


@pytest.mark.parametrize("spin", [0.7, -1.2, "least_deviation"])
def test_held_at_the_one_spin_of_its_configurations_an_arm_stands_the_same(spin):
    ik = rm.simulate(FANUC.replace(spin=spin)).ik
    held = configurations(FANUC, sampled(FANUC.toolpath, FANUC.step), spin_of(ik))
    np.testing.assert_allclose(held.theta, ik.theta, atol=1e-9)
    assert isinstance(spin_of(ik), float)
    assert spin_of(replace(ik, spin=ik.spin[:1])) == spin_of(ik)


def test_where_the_spin_changes_or_is_none_there_is_no_one_spin():
    """The arm is left to move as little as it can; so is one of five axes, and one without a path."""
    ik = rm.simulate(FANUC.replace(spin=0.7)).ik
    turning = [ik.spin + np.linspace(0.0, far, len(ik.spin)) for far in (1.0, 1e-3)]
    for spins in (*turning, ik.spin[:0], None):
        assert spin_of(replace(ik, spin=spins)) == "least_motion"
    assert spin_of(rm.simulate(PAPER).ik) == "least_motion"


def test_how_much_the_spin_matters_here(each):
    over = deviation_over_spin(FANUC, sampled(FANUC.toolpath, FANUC.step))
    np.testing.assert_allclose(over.angle, ANGLES, atol=1e-12)
    np.testing.assert_array_equal(over.missed > 0, np.isnan(each))
    seen = ~np.isnan(each)
    np.testing.assert_allclose(over.value[seen], each[seen], rtol=1e-9)
    assert over.range == pytest.approx((np.nanmin(each), np.nanmax(each)))
    assert over.range[1] > 1.1 * over.range[0]


def test_a_spindle_on_axis_6_does_not_care_about_its_spin():
    over = deviation_over_spin(KUKA, sampled(KUKA.toolpath, KUKA.step))
    assert (over.missed == 0).all()
    np.testing.assert_allclose(over.value, over.value[0], rtol=1e-9)


def test_five_axes_have_no_spin():
    over = deviation_over_spin(PAPER, sampled(PAPER.toolpath, PAPER.step))
    assert over.angle.tolist() == [0.0]
    for spin in ("least_deviation", 0.4):
        run = rm.simulate(PAPER.replace(spin=spin))
        assert run.max_deviation == pytest.approx(rm.simulate(PAPER).max_deviation)


def test_an_arm_chooses_its_spin_where_it_is_free_to_and_it_matters():
    """Not where one is given, nor with five axes, nor with the tool on axis 6: there is none that a path would keep."""
    path = sampled(FANUC.toolpath, FANUC.step)
    assert chooses_spin(FANUC)
    stiff = FANUC.replace(spin="least_deviation")
    assert chooses_spin(stiff)
    assert spin_along(stiff, path) == rm.simulate(stiff).ik.spin[0]
    for setup in (FANUC.replace(spin=0.7), PAPER, KUKA):
        assert not chooses_spin(setup)
        assert spin_along(setup, path) is None


@pytest.mark.parametrize("spin", ["least_motion", "least_deviation", 0.123456789012345, -1.0])
def test_the_spin_is_kept_in_the_file(spin):
    again = setup_from_toml(setup_to_toml(FANUC.replace(spin=spin)))
    assert again.spin == spin
    assert setup_from_toml(setup_to_toml(again)).digest() == again.digest()


def test_a_spin_in_degrees_and_what_is_none():
    text = setup_to_toml(FANUC)
    assert setup_from_toml("spin_deg = 30\n" + text).spin == pytest.approx(np.pi / 6)
    with pytest.raises(ProjectError, match="least_motion, least_deviation.*'fast'"):
        setup_from_toml('spin = "fast"\n' + text)
    with pytest.raises(ProjectError, match="given twice"):
        setup_from_toml('spin = "least_motion"\nspin_deg = 30\n' + text)
    with pytest.raises(SetupError, match="Spin"):
        FANUC.replace(spin=float("nan"))


@pytest.mark.parametrize("setup", [FANUC, KUKA, FANUC.replace(spin="least_deviation")], ids=["fanuc", "kuka", "stiff"])
def test_the_toolpath_pages_reach_is_that_of_the_run(setup):
    """Room to the joints' limits along the path as a share of half their range, by the run's own configurations."""
    run, reach = rm.simulate(setup), path_reach(setup)
    np.testing.assert_array_equal(reach.reached, run.reached)
    low, high = setup.robot.limits.T
    np.testing.assert_allclose(
        reach.room, (1 - np.abs(2 * run.theta - low - high) / (high - low)).min(axis=1), atol=1e-12
    )
    np.testing.assert_array_equal(configurations(setup, run.path).theta, run.theta)


def test_held_at_a_spin_that_changes_the_tool_is_turned_by_it_at_every_sample():
    """About its own axis: the tip and that axis stay."""
    path = sampled(FANUC.toolpath, FANUC.step)
    held = np.linspace(0.5, 0.7, len(path))
    found = rm.tool_pose(FANUC.robot, configurations(FANUC, path, held).theta)
    np.testing.assert_allclose(np.arctan2(found[:, 1, 0], found[:, 0, 0]), held, atol=1e-9)
    np.testing.assert_allclose(found[:, :3, 2], np.broadcast_to([0.0, 0.0, 1.0], (len(path), 3)), atol=1e-9)
    np.testing.assert_allclose(found[:, :3, 3], path.p + FANUC.T_MW[:3, 3], atol=1e-9)
