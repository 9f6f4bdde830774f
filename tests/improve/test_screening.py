"""What is screened at many places at once, against a full simulation at each of them."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from random_arms import seven

import robomill as rm
from robomill.improve import screening as module
from robomill.improve.area import area
from robomill.improve.screening import MOST_SAMPLES, SLOW_SAMPLES, screen, share_of, standing
from robomill.kinematics.dexterity import determinant, largest_determinant, limit_distance
from tests.improve.shoulder import shoulder

PLACES = np.array([[0.1, -1.25, 0.0, 0.3], [-0.2, -1.5, 0.05, -0.8], [0.3, -1.1, -0.05, 2.0], [0.0, -1.4, 0.002, 0.0]])


def slot() -> rm.SimulationSetup:
    return rm.load_setup("paper_flute")


def in_robot() -> rm.SimulationSetup:
    return slot().replace(force=rm.ConstantForce((30.0, 100.0, -20.0)))


def on_part() -> rm.SimulationSetup:
    s = np.linspace(0.0, 0.2, 50)
    F = np.column_stack([40.0 + 100.0 * s, 90.0 - 50.0 * s, -30.0 + 0.0 * s])
    return slot().replace(force=rm.MeasuredForce.along_path(s, F, frame="W"))


def bending() -> rm.SimulationSetup:
    return slot().replace(springs=(rm.ToolBending(stick_out_mm=40, diameter_mm=8), rm.SpindleSpring(lateral_um_N=0.05)))


def sagging() -> rm.SimulationSetup:
    links = rm.LinkMasses(mass=np.full(5, 40.0), centre=np.zeros((5, 3)))
    return slot().replace(links=links, add_sag=True)


def balanced() -> rm.SimulationSetup:
    return sagging().replace(add_sag=False)


def stated_feed() -> rm.SimulationSetup:
    return slot().replace(tolerance_mm=(0.3, 0.2, 0.1))


def tools() -> rm.SimulationSetup:
    return rm.load_setup("two_tools")


def arcs() -> rm.SimulationSetup:
    return rm.load_setup("pocket_arcs").replace(step_mm=3)


def screened_and_simulated(setup: rm.SimulationSetup) -> tuple[dict, list[rm.SimulationResult]]:
    where = area(setup, {"z": (-0.1, 0.1), "yaw_deg": (-180, 180)})
    T_MW = where.T_MW(PLACES)
    found = screen(rm.simulate(setup)).over(T_MW)
    return found, [rm.simulate(setup.replace(T_MW=T)) for T in T_MW]


@pytest.mark.parametrize("make", [slot, in_robot, on_part, bending, sagging, balanced, stated_feed, tools, arcs])
def test_the_tip_is_where_a_full_simulation_has_it(make: Callable[[], rm.SimulationSetup]) -> None:
    found, full = screened_and_simulated(make())
    whole = len(full[0].path) <= 400
    for name, values in (
        ("tip", [result.max_deviation for result in full]),
        ("feed", [np.abs(result.delta_in_cut[result.judged, 0]).max() for result in full]),
    ):
        np.testing.assert_allclose(found.errors[name], values, rtol=1e-9 if whole else 0.1)


@pytest.mark.parametrize("make", [slot, in_robot, on_part, bending, stated_feed, arcs])
def test_walls_and_floors_are_as_a_gauge_reads_them(make: Callable[[], rm.SimulationSetup]) -> None:
    setup = make()
    found, full = screened_and_simulated(setup)
    for name in ("wall", "floor"):
        read = np.abs([getattr(result.verdict, name).value for result in full])
        np.testing.assert_allclose(found.errors[name], read, rtol=5e-3, atol=3e-6)
    share = [result.verdict.share for result in full]
    np.testing.assert_allclose(found.share("verdict", setup), share, rtol=5e-3)


def test_the_share_is_the_verdicts() -> None:
    for setup in (slot(), stated_feed(), slot().replace(floor_tolerance_mm=0.05)):
        verdict = rm.simulate(setup).verdict
        errors = {name: np.abs([getattr(verdict, name).value]) for name in ("wall", "floor", "feed", "end")}
        assert share_of("verdict", setup, errors | {"tip": np.array([1.0])})[0] == pytest.approx(
            verdict.share, rel=1e-12
        )


def test_where_nothing_can_be_measured_the_tip_decides() -> None:
    none = {name: np.array([np.nan]) for name in ("wall", "floor", "feed", "end")}
    assert share_of("verdict", slot(), none | {"tip": np.array([0.6e-3])})[0] == pytest.approx(2.0)


def test_how_the_arm_stands_is_that_of_every_sample() -> None:
    setup = slot()
    found, full = screened_and_simulated(setup)
    largest = largest_determinant(setup.robot)
    for k, result in enumerate(full):
        assert found.standing.missed[k] == (~result.reached).sum() == 0
        room = min(float(limit_distance(setup.robot, theta)) for theta in result.theta)
        assert found.standing.room[k] == pytest.approx(room, abs=1e-9)
        det = min(abs(float(determinant(setup.robot, theta))) for theta in result.theta) / largest
        assert found.standing.det[k] == pytest.approx(det, rel=1e-6)


def test_a_path_through_a_singular_configuration_has_a_negative_determinant() -> None:
    robot = rm.load_robot("slavkovic_5r")
    theta = np.array([[0.1, -0.3, 0.4, 0.0, B] for B in (1.4, 1.8)])
    assert np.prod(np.sign(determinant(robot, theta))) < 0.0
    ik = rm.inverse_kinematics(robot, rm.tool_pose(robot, theta), near=theta)
    assert ik.reached.all()
    assert standing(ik).det < 0.0


def test_a_place_out_of_reach_is_told_by_the_samples_missed() -> None:
    setup = slot()
    T = np.array(setup.T_MW)
    T[:3, 3] = [0.0, -2.4, 0.002]
    found = screen(rm.simulate(setup)).over(T[None])
    assert found.standing.missed[0] == (~rm.simulate(setup.replace(T_MW=T)).reached).sum() > 0
    assert np.isnan(found.share("verdict", setup)[0])


def test_many_places_are_as_one_by_one() -> None:
    setup = slot()
    where = area(setup, {"yaw_deg": (-180, 180)})
    looking = screen(rm.simulate(setup))
    T_MW = where.T_MW(np.random.default_rng(1).uniform([-0.3, -1.5, 0.0, -3.0], [0.3, -1.1, 0.0, 3.0], (230, 4)))
    together = looking.over(T_MW).share("verdict", setup)
    np.testing.assert_array_equal(together, [looking.over(T[None]).share("verdict", setup)[0] for T in T_MW])


@pytest.mark.parametrize("make", [slot, stated_feed, tools, arcs, shoulder])
def test_where_it_was_made_the_screen_says_what_the_run_does(make: Callable[[], rm.SimulationSetup]) -> None:
    """At the place of the reference nothing is expanded: each reading is what the gauge found."""
    setup = make()
    run = rm.simulate(setup)
    looking = screen(run)
    found = looking.errors(run.delta_in_cut[looking.at][None])
    for name in ("wall", "floor"):
        assert found[name][0] == pytest.approx(abs(getattr(run.verdict, name).value), abs=2e-6)


def test_walls_made_between_two_samples_go_with_both() -> None:
    """A wall that its own sample alone says nothing of decides here: beside the place it was found at, in full runs."""
    setup = shoulder()
    run = rm.simulate(setup)
    assert np.abs(run.gauge.walls.error).max() > 30e-6
    places = np.array([[0.02, -1.31, 0.002, 0.0], [-0.03, -1.28, 0.01, 0.1], [0.0, -1.35, 0.0, -0.1]])
    T_MW = area(setup, {"z": (-0.1, 0.1), "yaw_deg": (-180, 180)}).T_MW(places)
    found = screen(run).over(T_MW)
    for k, T in enumerate(T_MW):
        verdict = rm.simulate(setup.replace(T_MW=T)).verdict
        assert found.errors["wall"][k] == pytest.approx(abs(verdict.wall.value), abs=2e-6)
        assert found.errors["floor"][k] == pytest.approx(abs(verdict.floor.value), abs=2e-6)


def test_the_largest_readings_of_every_direction_of_the_feed_are_looked_at() -> None:
    """Each eighth of a turn of the feed, by the angle of its direction, keeps what goes furthest either way."""
    run = rm.simulate(arcs())
    at = set(screen(run, most=40).at.tolist())
    assert len(at) < len(run.path) // 2
    feed = run.R_MF[:, 0, 0] + 1j * run.R_MF[:, 1, 0]
    eighth = ((np.degrees(np.angle(feed)) + 180.0) // 45.0) % 8
    assert len(np.unique(eighth)) == 8
    for read in (run.gauge.walls, run.gauge.floors):
        for k in range(8):
            some = eighth[read.sample] == k
            sample, error = read.sample[some], read.error[some]
            kept = error[np.isin(sample, list(at))]
            assert kept.max() == error.max()
            assert kept.min() == error.min()


def test_the_ends_of_a_path_in_every_direction_are_looked_at() -> None:
    """A star with one tip in each direction of a compass, in complex numbers, and the highest and the lowest, on
    the ways back; and where it begins and ends."""
    tips = 1e-3 * np.exp(1j * np.pi / 4.0 * np.arange(8)) * [31, 33, 30, 32, 34, 29, 35, 36]
    corners = np.column_stack([tips, 0.6 * tips, np.zeros(8)]).ravel()
    z = np.full(24, -2e-3)
    z[7], z[13] = -1e-3, -3e-3
    p = np.column_stack([corners.real, corners.imag, z])
    below = rm.Stock((-0.05, -0.05, -0.03), (0.05, 0.05, -0.02))  # nothing is cut, so that no reading is looked at
    run = rm.simulate(slot().replace(source=rm.Toolpath.from_points(p, v_f=0.02), stock=below))
    p, at = run.path.p, screen(run, most=40).at
    assert len(at) < len(p) // 4
    flat = p[:, 0] + 1j * p[:, 1]
    for k in range(8):
        along = (flat * np.exp(-1j * np.pi / 4.0 * k)).real
        assert along[at].max() == along.max()
    assert p[at, 2].min() == p[:, 2].min()
    assert p[at, 2].max() == p[:, 2].max()
    assert {0, len(p) - 1} <= set(at.tolist())


def test_the_first_sample_and_the_first_cut_of_every_tool_are_looked_at() -> None:
    """And every sample of a path that has no more than are asked for."""
    run = rm.simulate(tools())
    path, at = run.path, screen(run, most=24).at.tolist()
    assert len(at) < len(path) // 4
    for number in (1, 2):
        own = [i for i in range(len(path)) if path.tool[i] == number]
        assert own[0] in at
        assert next(i for i in own if path.cutting[i]) in at
    np.testing.assert_array_equal(screen(run, most=len(path)).at, np.arange(len(path)))


@pytest.mark.parametrize(
    ("robot", "spin", "count"),
    [
        ("slavkovic_5r", "least_motion", MOST_SAMPLES),
        ("kuka_kr500", "least_motion", MOST_SAMPLES),
        ("fanuc_r2000ic", 0.3, MOST_SAMPLES),
        ("fanuc_r2000ic", "least_motion", SLOW_SAMPLES),
        ("fanuc_r2000ic", "least_deviation", SLOW_SAMPLES),
        ("seven", 0.3, SLOW_SAMPLES),
        ("seven", "least_motion", SLOW_SAMPLES),
    ],
)
def test_few_samples_are_looked_at_where_each_pose_is_searched_for(
    monkeypatch: pytest.MonkeyPatch, robot: str, spin: float | str, count: int
) -> None:
    """By an arm that has no closed form, or that may turn about its tool; as many as are asked for in any case."""
    told: list[tuple[int, list[int]]] = []

    def few(result: object, most: int, also: np.ndarray) -> np.ndarray:
        told.append((most, also.tolist()))
        raise StopIteration

    monkeypatch.setattr(module, "_few", few)
    arm = seven() if robot == "seven" else rm.load_robot(robot)
    run: Any = SimpleNamespace(setup=SimpleNamespace(robot=arm, spin=spin), path=range(5))
    for given in ({}, {"most": 7}, {"also": np.array([3, 1])}):
        with pytest.raises(StopIteration):
            screen(run, **given)
    assert told == [(count, []), (7, []), (count, [3, 1])]


def test_each_sample_uses_what_its_own_deviation_does_and_none_where_nothing_is_judged() -> None:
    setup = slot()
    run = rm.simulate(setup)
    looking = screen(run)
    d = np.random.default_rng(3).normal(scale=1e-4, size=(2, len(looking.at), 3))
    d[1, 5, 2] = np.nan
    for measure, size in (("tip", np.sqrt((d**2).sum(axis=2))), ("feed", np.abs(d[..., 0]))):
        told = np.where(run.judged[looking.at], size / setup.limits[measure], 0.0)
        told[1, 5] = np.nan
        np.testing.assert_allclose(looking.shares(measure, d), told, rtol=1e-12)
    assert not run.judged[looking.at].all()
