"""The best place of a part: against a loop over full simulations, and against what must not change it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from random_arms import seven

import robomill as rm
from robomill.errors import SetupError
from robomill.improve.area import area
from robomill.improve.placed import FINE, FINEST, KEPT_OUT, NO_ROOM, UNREACHED, Place, Placement
from robomill.improve.placement import _Search, place
from robomill.io.samples import samples_dir
from robomill.kinematics.transforms import rotation_z, transform
from robomill.simulation.given import part_frame

SLOT = samples_dir() / "paper_flute"


def slot(**changes: object) -> rm.SimulationSetup:
    return rm.load_setup("paper_flute").replace(**changes)


def brute(setup: rm.SimulationSetup, found: Placement, counts: tuple[int, int, int]) -> np.ndarray:
    """Shares (nx, ny, nyaw) by a loop over ``simulate``; infinite where not all is reached."""
    low, high = (np.array([axis[end] for axis in found.axes]) for end in (0, -1))
    axes = [np.linspace(low[i], high[i], n) for i, n in zip((0, 1, 3), counts)]
    shares = np.full(counts, np.inf)
    for i, j, k in np.ndindex(counts):
        T_MW = part_frame([axes[0][i], axes[1][j], low[2]], axes[2][k])
        result = rm.simulate(setup.replace(T_MW=T_MW))
        if not result.missed.any():
            shares[i, j, k] = result.verdict.share
    return shares


@pytest.mark.parametrize("name", ["paper_flute", "two_tools"])
def test_a_loop_over_simulations_finds_no_better_place(name: str) -> None:
    setup = rm.load_setup(name).replace(cell_mm=0.5)
    found = place(setup, x_mm=(-300, 200), y_mm=(-1500, -1150), yaw_deg=(-60, 75), candidates=150)
    assert found.best.share <= brute(setup, found, (3, 3, 2)).min() + 1e-3


def test_the_best_place_of_a_pocket_is_as_good_as_any_beside_it() -> None:
    """Around the best place no full simulation at the last steps of the refinement is better by more than 1 %."""
    setup = rm.load_setup("pocket_arcs").replace(step_mm=3, cell_mm=0.5)
    found = place(setup, x_mm=(-200, 200), y_mm=(-1400, -1200), candidates=60)
    for dx, dy in ((2, 0), (-2, 0), (0, 2), (0, -2)):
        at = np.append(found.best.zero[:2] + np.array([dx, dy]) * FINEST[:2], found.best.zero[2])
        beside = rm.simulate(setup.replace(part_zero=np.clip(at, [-0.2, -1.4, -9], [0.2, -1.2, 9])))
        assert found.best.share <= beside.verdict.share * 1.01


class Bowl(_Search):
    """Full runs say a bowl about (0.08, -1.28), with no room left beyond x = 0.05; the screen knows nothing."""

    def simulated(self, at: np.ndarray) -> tuple[Place, Any]:
        share = 0.2 + ((at[:2] - [0.08, -1.28]) ** 2).sum()
        room = 0.2 if at[0] <= 0.05 else 0.0
        return Place(at[:3], at[3], share, 0.0, 0.0, 0.0, 0.0, "ok", "", room, 1.0), None

    def _look(self, looking: Any, places: np.ndarray) -> tuple[Any, np.ndarray]:
        return SimpleNamespace(share=lambda *_: np.zeros(len(places))), np.zeros(len(places))


def test_where_the_screen_is_no_measure_full_runs_lead_to_the_best_place_that_is_allowed() -> None:
    """The foot of the bowl lies beyond; of the half-plane that is allowed (0.05, -1.28) is nearest to it."""
    here = area(slot(), {"x_mm": (-100, 100), "y_mm": (-1400, -1200)})
    search, start = Bowl(slot(), here, "verdict", 0.1), np.array([0.02, -1.31, 0.002, 0.0])
    axes = [np.linspace(-0.1, 0.1, 6), np.linspace(-1.4, -1.2, 6), np.array([0.002]), np.array([0.0])]
    looking = SimpleNamespace(reference=SimpleNamespace(path=range(50)))
    found = search._polished(search.simulated(start)[0], start, looking, axes)
    np.testing.assert_allclose(found.zero[:2], [0.05, -1.28], atol=3e-3)
    assert found.room >= 0.1


def test_what_is_said_of_a_place_is_its_full_simulation() -> None:
    setup = slot()
    found = place(setup, x_mm=(-200, 200), y_mm=(-1400, -1200), yaw_deg=(-90, 90), candidates=80)
    full = rm.simulate(found.moved)
    best = found.best
    assert (best.share, best.max_deviation) == (full.verdict.share, full.max_deviation)
    assert (best.wall, best.floor, best.level) == (
        full.verdict.wall.value,
        full.verdict.floor.value,
        full.verdict.level,
    )
    now = rm.simulate(setup)
    assert (found.now.share, found.now.sentence) == (now.verdict.share, now.verdict.sentence)
    for each in (found.median, found.worst):
        there = rm.simulate(setup.replace(T_MW=part_frame(each.zero, each.yaw)))
        assert each.max_deviation == pytest.approx(there.max_deviation, rel=1e-12)
    assert best.share <= found.median.share <= found.worst.share


def test_the_map_is_what_a_full_simulation_says_of_its_points() -> None:
    setup = slot()
    found = place(setup, x_mm=(-200, 100), y_mm=(-1400, -1200), candidates=9)
    for i, j in np.ndindex(found.plane.shape):
        there = rm.simulate(setup.replace(part_zero=[found.axes[0][i], found.axes[1][j], found.axes[2][0]]))
        assert found.plane[i, j] == pytest.approx(there.verdict.share, rel=2e-3)
    frame = found.to_dataframe()
    assert len(frame) == found.tried == found.share.size
    assert frame["share"].min() == np.nanmin(found.plane)
    shares = np.sort(found.plane[np.isfinite(found.plane)])
    assert found.worst.share == pytest.approx(shares[-1], rel=5e-4)
    assert found.median.share == pytest.approx(shares[(len(shares) - 1) // 2], rel=2e-3)
    assert shares[-1] > 1.001 * shares[-2], "one place is the worst"


def test_moving_robot_and_part_together_changes_nothing() -> None:
    setup = slot()
    T = transform(rotation_z(0.7), [0.4, -0.3, 0.2])
    robot = setup.robot.replace(T_base=T @ setup.robot.T_base)
    moved = setup.replace(robot=robot, T_MW=T @ setup.T_MW)
    box = {"yaw": (-0.5, 0.5), "candidates": 50}
    ends = np.array([[-0.2, -1.4], [0.2, -1.2]])
    there = place(setup, x=ends[:, 0], y=ends[:, 1], **box)
    # The box turns with the robot; one point wide it is the same box.
    at = setup.replace(part_zero=there.best.zero, part_rotation_z=there.best.yaw)
    again = place(
        moved,
        x=np.repeat((T @ at.T_MW)[0, 3], 2),
        y=np.repeat((T @ at.T_MW)[1, 3], 2),
        z=np.repeat((T @ at.T_MW)[2, 3], 2),
        yaw=np.repeat(there.best.yaw + 0.7, 2),
        candidates=1,
    )
    assert again.best.share == pytest.approx(there.best.share, rel=1e-9)
    assert again.now.share == pytest.approx(there.now.share, rel=1e-9)


def test_a_full_turn_more_changes_nothing() -> None:
    box = {"x_mm": (-100, 100), "y_mm": (-1400, -1300), "candidates": 50}
    one, other = (place(slot(), yaw_deg=yaw, **box) for yaw in ((-30, 60), (330, 420)))
    assert one.best.share == pytest.approx(other.best.share, abs=1e-9)
    assert other.best.yaw == pytest.approx(one.best.yaw + 2 * np.pi, abs=1e-6)
    beside = place(slot(), yaw_deg=(20, 60), **box)  # which 0 is no yaw of, however it is counted
    assert (one.now.yaw, other.now.yaw, beside.now.yaw) == pytest.approx((0.0, 2 * np.pi, 0.0), abs=1e-9)
    np.testing.assert_allclose(one.share, other.share, rtol=1e-9)


def test_a_place_can_be_no_worse_than_today_where_today_is_in_the_box() -> None:
    setup = slot()
    alone = place(setup, x=(0.0, 0.0), y=(-1.3, -1.3), candidates=1)
    assert alone.best.share == alone.now.share == alone.median.share == alone.worst.share
    assert alone.tried == alone.reached == alone.allowed == 1


@pytest.mark.parametrize(
    ("measure", "name"), [("tip", "max_deviation"), ("wall", "wall"), ("floor", "floor"), ("feed", "feed")]
)
def test_what_is_asked_for_is_minimised(measure: str, name: str) -> None:
    box = {"x_mm": (-300, 300), "y_mm": (-1500, -1100), "candidates": 60}
    asked, usual = place(slot(), measure=measure, **box), place(slot(), **box)
    assert abs(getattr(asked.best, name)) <= abs(getattr(usual.best, name)) + 1e-7
    assert asked.best.share == pytest.approx(abs(getattr(asked.best, name)) / slot().tolerance)


def test_the_stock_keeps_out_of_boxes() -> None:
    box = {"x_mm": (-300, 300), "y_mm": (-1500, -1100), "candidates": 100}
    free = place(slot(), **box)
    x, y, z = free.best.zero
    keep_out = [[[x - 0.02, y - 0.02, z - 0.1], [x + 0.02, y + 0.02, z + 0.1]]]
    kept = place(slot(), keep_out=keep_out, **box)
    assert (kept.why == KEPT_OUT).any()
    assert kept.best.share > free.best.share
    stock = slot().stock_block
    low, high = kept.best.zero + stock.lower, kept.best.zero + stock.upper
    assert ((high <= keep_out[0][0]) | (low >= keep_out[0][1])).any()


def test_every_joint_keeps_the_room_that_is_asked_for() -> None:
    box = {"x_mm": (-900, 900), "y_mm": (-2200, -800), "candidates": 100}
    wide, kept = place(slot(), room=0.0, **box), place(slot(), room=0.6, **box)
    assert (kept.why == NO_ROOM).any()
    assert (kept.why == UNREACHED).sum() == (wide.why == UNREACHED).sum() > 0
    assert kept.best.room >= 0.6
    assert kept.allowed < wide.allowed <= wide.reached < wide.tried
    assert np.isnan(kept.share[kept.why != FINE]).all()


def test_what_is_not_reached_today_is_placed() -> None:
    setup = slot(part_zero_mm=(0, -2300, 0))
    found = place(setup, x_mm=(-200, 200), y_mm=(-1400, -1200), candidates=60)
    assert not found.now.known
    assert np.isnan(found.now.max_deviation)
    assert "beyond reach" in found.now.reason
    there = place(slot(), x_mm=(-200, 200), y_mm=(-1400, -1200), z_mm=(0, 0), candidates=60)
    assert found.best.share == pytest.approx(there.best.share, rel=1e-3)


def test_a_part_that_fits_nowhere_is_told_with_the_nearest_reason() -> None:
    with pytest.raises(
        SetupError, match=r"fits nowhere in the box; of 18 places tried 18 not reached\. Nearest is .*: line"
    ):
        place(slot(), x_mm=(3000, 3200), y_mm=(0, 100), candidates=20)
    with pytest.raises(SetupError, match=r"18 too close to a joint limit\. Nearest is .* of its half range"):
        place(slot(), x_mm=(-10, 10), y_mm=(-1310, -1300), room=0.99, candidates=20)
    with pytest.raises(SetupError, match="18 meets a keep-out box"):
        place(slot(), x_mm=(-10, 10), y_mm=(-1310, -1300), keep_out=[[[-1, -2, -1], [1, 0, 1]]], candidates=20)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"measure": "speed"}, "measure: found 'speed'; expected verdict, wall, floor, tip, feed"),
        ({"room": 1.0}, "room: found 1.0; expected a share"),
        ({"room": float("nan")}, "room: found nan"),
        ({"candidates": 0}, "candidates: found 0"),
        ({"rooms": 0.1}, "there is no 'rooms'; did you mean room"),
    ],
)
def test_what_makes_no_sense_is_refused(given: dict, said: str) -> None:
    with pytest.raises(rm.RobomillError, match=said):
        place(slot(), **given)


@pytest.mark.parametrize(("measure", "to"), [("verdict", 40), ("tip", 40), ("verdict", 5000)])
def test_a_cut_of_which_nothing_is_judged_is_refused(measure: Any, to: float) -> None:
    """However far the tip goes aside there, above the stock, and though it may be out of reach where it is now."""
    above = rm.Toolpath.from_points(p_mm=[[0, 0, 50], [40, 0, 50], [to, 0, 50]], feed_mm_min=600)
    with pytest.raises(SetupError, match="nothing is judged that places could be compared by"):
        place(slot(source=above, step_mm=100), measure=measure, candidates=4)


def test_a_force_in_the_robots_axes_is_told_where_the_part_may_turn() -> None:
    setup = slot(force=rm.ConstantForce((0.0, 100.0, 0.0)))
    found = place(setup, x=(0.0, 0.0), y=(-1.3, -1.3), yaw_deg=(0, 90), candidates=4)
    assert "force-in-robot" in {each.code for each in found.findings}
    assert "force-in-robot" not in {each.code for each in place(setup, candidates=4).findings}


def test_of_seven_axes_the_map_is_what_full_simulations_say() -> None:
    """At each place the arm brings its elbow along from home."""
    path = rm.Toolpath.from_points(p_mm=[[-30, 0, 5], [-30, 0, -2], [30, 0, -2]], feed_mm_min=[0, 0, 1800])
    setup = slot(source=path, stock=None, robot=seven(), force=rm.PathForce(-20.0, 80.0, -30.0), step_mm=10, cell_mm=1)
    T_MW = rm.tool_pose(setup.robot, np.array([0.3, -0.7, 0.6, -1.1, 0.8, 0.9, 0.2]))
    x, y = T_MW[:2, 3, None] + [-0.1, 0.1]
    found = place(setup.replace(T_MW=T_MW, spin=0.3), x=x, y=y, measure="tip", candidates=9)
    for i, j in np.ndindex(found.share.shape[:2]):
        there = T_MW.copy()
        there[:2, 3] = found.axes[0][i], found.axes[1][j]
        run = rm.simulate(found.setup.replace(T_MW=there))
        C = rm.cartesian_compliance(run.setup.robot, run.theta[run.judged])
        size = np.linalg.norm(np.einsum("sij,sj->si", C, run.F[run.judged]), axis=1).max()
        assert found.share[i, j, 0, 0] == pytest.approx(size / setup.tolerance, rel=1e-6)


def test_a_yaw_turns_the_walls_against_a_force_in_the_robots_axes() -> None:
    """The tip goes one way at every yaw: the walls of a slot are off by what of C F stands across it."""
    F = np.array([60.0, 20.0, 0.0])
    setup = slot(force=rm.ConstantForce(F), step_mm=20, cell_mm=0.5)
    at = setup.T_MW[:3, 3] + [0.0, 0.0, -0.002]  # the middle of the slot's floor
    T_MT = transform(np.eye(3), at)
    delta = rm.cartesian_compliance(setup.robot, rm.inverse_kinematics(setup.robot, T_MT).theta) @ F
    for yaw in np.radians([0.0, 40.0, 90.0]):
        across = np.array([-np.sin(yaw), np.cos(yaw), 0.0]) @ delta
        found = place(setup, x=(0.0, 0.0), y=(-1.3, -1.3), yaw=(yaw, yaw), candidates=1)
        assert found.best.wall == pytest.approx(across, abs=0.05 * float(np.linalg.norm(delta)))


def test_a_coupled_run_is_compared_coupled() -> None:
    setup = rm.load_setup(SLOT / "setup_process.toml").replace(step_mm=4, cell_mm=0.5, engagement=True, coupling=True)
    found = place(setup, x_mm=(-100, 100), y_mm=(-1350, -1250), candidates=9)
    assert found.now.share == rm.simulate(setup).verdict.share
    assert found.best.share == rm.simulate(found.moved).verdict.share
    assert "places-coupled" in {each.code for each in found.findings}


@pytest.mark.parametrize(
    "lines", ["G0 X-50 Y0 Z-2\nG1 X50 F1800\nX3000\n", "G0 X3000 Y0 Z-2\nG1 X50 F1800\n"], ids=["end", "begin"]
)
def test_a_path_of_which_one_end_is_out_of_reach_is_not_reached(lines: str) -> None:
    setup = slot(source=rm.GCodeSource(f"G21 G90 S12000 M3\n{lines}"), step_mm=3000)
    with pytest.raises(SetupError, match=r"of 12 places tried 12 not reached\. Nearest .* beyond reach"):
        place(setup, x_mm=(-100, 100), y_mm=(-1400, -1250), candidates=12)


def test_a_placement_is_a_value() -> None:
    box = {"x_mm": (-100, 100), "y_mm": (-1350, -1250), "candidates": 9}
    one, other = place(slot(), **box), place(slot(), **box)
    assert one == other
    assert one.digest() == other.digest()
    assert "mm here" in repr(one)
    assert "Median" in one._repr_html_()
    with pytest.raises(ValueError, match="read-only"):
        one.share[0, 0, 0, 0] = 0.0


def test_places_outside_a_measured_map_are_not_allowed() -> None:
    setup = rm.load_setup(SLOT / "setup_measured_map.toml")
    found = place(setup, x_mm=(-900, 900), y_mm=(-2000, -1100), candidates=60)
    assert found.allowed < found.reached
    assert found.best.known


def test_places_of_a_measured_map_say_that_it_holds_for_one_turn_of_the_tool() -> None:
    setup = rm.load_setup(SLOT / "setup_measured_map.toml").replace(robot=rm.load_robot("fanuc_r2000ic"), step_mm=10)
    found = place(setup, x_mm=(-20, 20), y_mm=(-1320, -1280), yaw_deg=(0, 30), candidates=20)
    assert [each.code for each in found.findings].count("map-spin") == 1
    assert "map-spin" not in [each.code for each in place(slot(), x_mm=(-20, 20), candidates=9).findings]
