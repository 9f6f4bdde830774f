"""Turning the spindle along a path: against full simulations, and within the bound on its rate."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from random_arms import seven

import robomill as rm
from robomill.errors import SetupError
from robomill.improve.placed import Place, place_of
from robomill.improve.turning import Turning, _Turned, turn
from robomill.kinematics.choice import every
from robomill.kinematics.decoupled import decoupled
from robomill.units import to_si


def circle(**changes: object) -> rm.SimulationSetup:
    """A groove around a circle of 120 mm, of an arm whose tool stands across its last axis."""
    a = np.linspace(0.0, 2.0 * np.pi, 61)
    path = rm.Toolpath.from_points(
        p_mm=np.column_stack([60 * np.cos(a), 60 * np.sin(a), np.full(61, -2.0)]), feed_mm_min=1800
    )
    arm = rm.load_robot("fanuc_r2000ic")
    setup = rm.load_setup("paper_flute").replace(source=path, stock=None, robot=arm, part_zero=(1.2, 0.0, 0.3))
    return setup.replace(step_mm=7, cell_mm=0.5, **changes)


def straight() -> rm.SimulationSetup:
    path = rm.Toolpath.from_points(p_mm=[[-20, 0, 5], [-20, 0, -2], [20, 0, -2]], feed_mm_min=[0, 0, 1800])
    return circle().replace(source=path, step_mm=10)


@pytest.fixture(scope="module")
def found() -> Turning:
    return turn(circle())


def test_the_map_is_what_runs_at_a_constant_spin_say(found: Turning) -> None:
    for k in (0, 13, 50):
        run = rm.simulate(circle(spin=float(found.angle[k])))
        assert np.nanmax(found.share[:, k]) == pytest.approx(run.verdict.share, rel=5e-3)
        judged = run.judged
        assert found.deviation[judged, k] == pytest.approx(run.deviation[judged], rel=1e-6)


def test_a_measured_map_says_nothing_of_another_turn_of_the_tool() -> None:
    """It gives one number at every spin, where the joints of this arm give others: no spin is the best by it."""
    setup = rm.load_setup("paper_flute/setup_measured_map").replace(robot=rm.load_robot("fanuc_r2000ic"), step_mm=10)
    mapped, joints = setup, setup.replace(measured_map=None)
    for cut, differs in ((mapped, False), (joints, True)):
        runs = [rm.simulate(cut.replace(spin=spin)) for spin in (0.0, 1.0)]
        assert all(run.reached.all() for run in runs)
        assert (abs(runs[0].max_deviation / runs[1].max_deviation - 1.0) > 0.05) is differs
    with pytest.raises(SetupError, match="measured map"):
        turn(setup)


def test_no_constant_spin_is_better_than_the_best(found: Turning) -> None:
    shares = [rm.simulate(circle(spin=float(angle))).verdict.share for angle in found.angle[::6]]
    assert found.constant.share <= min(shares) + 1e-9
    assert rm.simulate(found.turned).verdict.share == pytest.approx(found.constant.share, rel=1e-12)
    assert found.now.share == rm.simulate(circle()).verdict.share


def test_the_best_spin_of_a_path_with_corners_is_found_by_runs() -> None:
    """The map moves each reading as the tip moves; at a corner the next pass cleans up what the tip left, or not."""
    cutter = rm.Cutter("flat", diameter_mm=10, flutes=3)
    setup = circle().replace(
        source=rm.GCodeSource("G21 G90\nS9000 M3\nG0 X-30 Y-20 Z9\nG0 Z-2\nG1 X30 F1500\nG1 Y20\nG1 X-30\nG0 Z9\nM2\n"),
        cutter=cutter,
        force=rm.process_force("al7075_t6_carbide_ref190", cutter),
        stock=rm.Stock(lower_mm=(-45, -40, -10), upper_mm=(45, 40, 0)),
        engagement=True,
        step=4e-3,
    )
    angle, found = np.arange(0.0, 2 * np.pi, np.pi / 12), rm.turn(setup)
    runs = [rm.simulate(setup.replace(spin=float(each))) for each in angle]
    best = min(run.verdict.share for run in runs if run.reached.all() and run.verdict.level in ("ok", "tight", "out"))
    assert found.constant.share <= best + 1e-9


def test_a_course_is_better_than_any_constant_spin_and_no_better_than_its_bound(found: Turning) -> None:
    assert found.course.share < found.constant.share < found.now.share
    assert found.course.share >= np.nanmin(found.share, axis=1).max() * 0.99


@pytest.mark.parametrize("rate", [0.2, 1.0])
def test_the_spin_changes_no_faster_than_it_may(rate: float) -> None:
    one = turn(circle(), rate_deg_mm=rate)
    moved = np.diff(one.way) > 0.0
    assert (np.abs(np.diff(one.turn))[moved] <= one.rate * np.diff(one.way)[moved] * (1 + 1e-9) + 1e-12).all()
    assert one.rate == pytest.approx(to_si(rate, "deg/mm"))
    assert one.course.share <= one.constant.share


def test_the_deviation_along_the_course_is_that_of_the_arm_there(found: Turning) -> None:
    """Each sample by its own inverse kinematics and compliance, one after the other."""
    setup = circle()
    run = rm.simulate(found.turned)
    sizes = []
    for i in np.flatnonzero(run.judged):
        T = np.eye(4)
        c, s = np.cos(found.turn[i] - found.spin), np.sin(found.turn[i] - found.spin)
        T[:2, :2] = [[c, -s], [s, c]]
        ik = rm.inverse_kinematics(setup.robot, run.ik.T_MT[i] @ T, near=run.theta[i], spin="fixed")
        sizes.append(np.linalg.norm(rm.cartesian_compliance(setup.robot, ik.theta) @ run.F[i]))
    assert found.course.max_deviation == pytest.approx(max(sizes), rel=1e-6)


def test_of_seven_axes_too_the_map_is_what_runs_at_a_constant_spin_say_and_none_is_better() -> None:
    """Each of them brings its elbow along from home; it is not where another spin has left it."""
    theta = np.array([0.3, -0.7, 0.6, -1.1, 0.8, 0.9, 0.2])
    path = rm.Toolpath.from_points(p_mm=[[-60, 0, 5], [-60, 0, -2], [60, 0, -2]], feed_mm_min=[0, 0, 1800])
    setup = rm.load_setup("paper_flute").replace(source=path, stock=None, robot=seven(), step_mm=20, cell_mm=1)
    setup = setup.replace(T_MW=rm.tool_pose(setup.robot, theta))
    found = turn(setup, measure="tip")
    largest = []
    for k in range(0, 72, 8):
        run = rm.simulate(setup.replace(spin=float(found.angle[k])))
        i = run.judged
        C = rm.cartesian_compliance(setup.robot, run.theta[i])
        size = np.linalg.norm(np.einsum("sij,sj->si", C, run.F[i]), axis=1)
        assert found.deviation[i, k] == pytest.approx(size, rel=1e-6)
        largest.append(size.max())
    assert found.constant.max_deviation <= min(largest) * (1 + 1e-9)


def bounded(share: np.ndarray, station: np.ndarray, rate: float) -> float:
    """The least largest share of all courses on a map (s, a), by going on from every angle to those within reach."""
    angles = share.shape[1]
    apart = np.abs((np.arange(angles)[:, None] - np.arange(angles) + angles // 2) % angles - angles // 2)
    best = share[0]
    for way, here in zip(np.diff(station), share[1:]):
        near = apart * 2.0 * np.pi / angles <= rate * way * (1.0 + 1e-9)
        best = np.maximum(here, np.where(near, best, np.inf).min(axis=1))
    return float(best.min())


def test_that_no_course_is_better_is_said_only_where_the_map_has_none() -> None:
    """Round a sharp corner the map holds both cuts at one spin: what looks better there does not hold in full."""
    path = rm.Toolpath.from_points(
        p_mm=[[-150, 0, 5], [-150, 0, -2], [150, 0, -2], [150, 200, -2]], feed_mm_min=[0, 0, 1800, 1800]
    )
    setup = rm.load_setup("paper_flute").replace(
        source=path,
        stock=rm.Stock(lower_mm=[-145, -20, -10], upper_mm=[180, 230, 0]),
        robot=rm.load_robot("fanuc_r2000ic"),
        force=rm.PathForce(-20.0, 80.0, -30.0),
        part_zero=(1.3, 0.2, 0.4),
        part_rotation_z=1.3,
    )
    found = turn(setup.replace(step_mm=10, cell_mm=1))
    assert found.course.share == found.constant.share
    assert bounded(np.where(np.isnan(found.share), np.inf, found.share), found.station, found.rate) < found.course.share
    assert "spin-course" not in {each.code for each in found.findings}


def test_where_nothing_is_left_to_turn_is_said() -> None:
    slot = rm.load_setup("paper_flute")
    with pytest.raises(SetupError, match="an arm of 5 joints holds the tool in one way; nothing is left to turn"):
        turn(slot)
    with pytest.raises(SetupError, match="lies along the last axis, which turns it and moves nothing else"):
        turn(slot.replace(robot=rm.load_robot("kuka_kr500"), part_zero=(1.2, 0.0, 0.3)))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"measure": "speed"}, "measure: found 'speed'"),
        ({"rate_deg_mm": 0}, "rate: found 0 °/mm; expected more than 0"),
        ({"rate": 1.0, "rate_deg_mm": 1.0}, "are the same; give one of them"),
    ],
)
def test_what_makes_no_sense_is_refused(given: dict, said: str) -> None:
    with pytest.raises(rm.RobomillError, match=said):
        turn(circle(), **given)


@pytest.mark.parametrize(("marked", "taken"), [("now", True), ("another", False)])
def test_near_singular_only_the_spin_of_today_may_stay(
    monkeypatch: pytest.MonkeyPatch, marked: str, taken: bool
) -> None:
    """The one that is marked is best by far, and close to a singular configuration: no other is advised there."""
    setup, today = straight().replace(spin=0.2), 0.2
    told = turn(setup, measure="tip")
    far = (3 * round(np.argmin(np.abs(told.angle - told.spin)) / 3) + 36) % 72
    least = today if marked == "now" else float(told.angle[far])
    asked = set()

    def marking(result: rm.SimulationResult, *given: object) -> Place:
        found = place_of(result, *given)
        asked.add(result.setup.spin)
        return replace(found, share=1e-6, det=0.0) if result.setup.spin == least else found

    monkeypatch.setattr("robomill.improve.turning.place_of", marking)
    monkeypatch.setattr("robomill.improve.turning.agrees", lambda *given: False)  # every third spin is simulated
    found = turn(setup, measure="tip")
    assert least in asked
    assert (found.spin == pytest.approx(least)) == taken
    assert (found.constant.share == 1e-6) == taken


def test_a_path_out_of_reach_at_every_spin_is_refused() -> None:
    with pytest.raises(SetupError, match="no spin reaches all of the path"):
        turn(circle(part_zero=(9.0, 0.0, 0.3)))


def test_a_turning_is_a_value_with_a_table(found: Turning) -> None:
    frame = found.to_dataframe()
    assert list(frame.columns) == ["way_mm", "spin_deg"]
    assert "turning" in repr(found)
    assert found == turn(circle())


@pytest.mark.parametrize("branch", range(8))
def test_shoulder_and_elbow_stand_as_in_the_run_and_the_wrist_on_both_sides(branch: int) -> None:
    """Of all eight ways to stand at a pose: the run's own, and the one whose first three joints are the same."""
    setup = circle()
    robot, arm = setup.robot, decoupled(setup.robot)
    T = rm.tool_pose(robot, np.array([[0.3, 0.2, -0.4, 0.5, 0.7, -0.2]]))
    all_, _ = every(robot, arm, T)
    run = SimpleNamespace(ik=SimpleNamespace(branch_index=np.array([branch, -1, branch])))
    theta, _ = _Turned(setup, "tip", 1.0)._standings(SimpleNamespace(reference=run), T)  # type: ignore[arg-type]
    turned = np.exp(1j * theta[:, 0])
    assert np.abs(turned - np.exp(1j * all_[0, branch])).max(axis=1).min() < 1e-9
    assert len(turned) == 2
    np.testing.assert_allclose(turned[0, :3], turned[1, :3], atol=1e-9)
    assert np.abs(turned[0] - turned[1]).max() > 0.1


def test_the_map_has_a_number_where_the_arm_can_stand_in_one_of_its_ways() -> None:
    """Joint 4 goes 60 degrees to either side of where it stands: the other way of the wrist is half a turn off."""
    setup = straight().replace(spin=0.2)
    middle = rm.simulate(setup).theta[:, 3].mean()
    limits = np.array(setup.robot.limits_all)
    limits[3] = middle - np.pi / 3.0, middle + np.pi / 3.0
    setup = setup.replace(robot=setup.robot.replace(limits_all=limits))
    found = turn(setup, measure="tip")
    k = int(np.argmin(np.abs(found.angle - 0.2)))
    run = rm.simulate(setup.replace(spin=float(found.angle[k])))
    assert np.nanmax(found.share[:, k]) == pytest.approx(run.max_deviation / setup.tolerance, rel=1e-6)
    assert np.isfinite(found.share[:, k]).all()
    assert not np.isfinite(found.share).all()
