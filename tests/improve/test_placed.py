"""Places compared, as values: counted and laid out by loops, and what a reader must know of the best one."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import robomill as rm
from robomill.improve.area import area
from robomill.improve.placed import (
    COUPLED,
    EDGE,
    FINE,
    IN_ROBOT,
    KEPT_OUT,
    NO_ROOM,
    PARTLY,
    SCREENED,
    SINGULAR,
    TIP,
    UNKNOWN,
    UNREACHED,
    WHY,
    Placement,
    findings,
    place_of,
)
from robomill.provenance import Finding
from robomill.simulation.mapped import MAP_SPIN

SETUP = rm.load_setup("paper_flute").replace(step_mm=20)
AXES = (np.array([-0.1, 0.2]), np.array([-1.4, -1.3, -1.2]), np.array([0.01, 0.02]), np.radians([0.0, 90.0]))


def mapped() -> Placement:
    rng, shape = np.random.default_rng(6), tuple(map(len, AXES))
    why = rng.integers(0, 6, shape)
    why[0, 0] = UNREACHED
    share = np.where(why == FINE, rng.uniform(0.2, 2.0, shape), np.nan)
    return Placement(SETUP, "verdict", *[None] * 4, AXES, np.zeros((0, 2, 3)), share, why, (5, 5))  # type: ignore[arg-type]


def test_places_are_counted_by_why_and_laid_out_one_a_row() -> None:
    found = mapped()
    table, row = found.columns(), 0
    reached = allowed = 0
    for i, x in enumerate(AXES[0]):
        for j, y in enumerate(AXES[1]):
            best = np.inf
            for k, z in enumerate(AXES[2]):
                for m, yaw in enumerate((0.0, 90.0)):
                    code, share = found.why[i, j, k, m], found.share[i, j, k, m]
                    assert [table[f"{name}_mm"][row] for name in "xyz"] == pytest.approx([1e3 * x, 1e3 * y, 1e3 * z])
                    assert table["yaw_deg"][row] == pytest.approx(yaw)
                    assert table["share"][row] == pytest.approx(share, nan_ok=True)
                    assert table["why"][row] == WHY[code]
                    reached += code in (FINE, NO_ROOM, SINGULAR, UNKNOWN)
                    allowed += code == FINE
                    best = share if share < best else best
                    row += 1
            assert found.plane[i, j] == pytest.approx(best if np.isfinite(best) else np.nan, nan_ok=True)
    assert (found.tried, found.reached, found.allowed) == (row, reached, allowed)
    assert {UNREACHED, KEPT_OUT} <= set(found.why.ravel().tolist())


@pytest.mark.parametrize("measure", ["verdict", "wall", "floor", "feed", "tip"])
def test_a_place_has_what_its_run_says(measure: str) -> None:
    run = rm.simulate(SETUP)
    found = place_of(run, np.array([0.1, -1.3, 0.02, 0.4]), measure)  # type: ignore[arg-type]
    verdict = run.verdict
    assert (found.zero.tolist(), found.yaw) == ([0.1, -1.3, 0.02], 0.4)
    assert (found.wall, found.floor, found.feed) == (verdict.wall.value, verdict.floor.value, verdict.feed.value)
    assert (found.max_deviation, found.level, found.sentence) == (run.max_deviation, verdict.level, verdict.sentence)
    size = {
        "verdict": max(abs(verdict.wall.value), abs(verdict.floor.value)),
        "wall": abs(verdict.wall.value),
        "floor": abs(verdict.floor.value),
        "feed": abs(verdict.feed.value),
        "tip": run.max_deviation,
    }[measure]
    assert found.share == pytest.approx(size / 0.3e-3)
    assert (found.known, found.reason) == (True, "")
    room = 1.0 - np.abs(2.0 * run.theta - SETUP.robot.limits.sum(axis=1)) / np.ptp(SETUP.robot.limits, axis=1)
    assert found.room == pytest.approx(room.min(), abs=1e-9)


def test_of_a_place_out_of_reach_nothing_is_known_but_where_it_is_lost() -> None:
    run = rm.simulate(SETUP.replace(part_zero=(0.0, -2.4, 0.002)))
    found = place_of(run, np.array([0.0, -2.4, 0.002, 0.0]), "verdict")
    assert np.isnan([found.share, found.max_deviation, found.wall, found.floor, found.feed]).all()
    assert not found.known
    assert found.reason.startswith(f"line {run.path.block[np.flatnonzero(~run.reached)[0]]}: ")


def codes(at: tuple[float, ...], box: dict[str, tuple[float, float]], **given: object) -> tuple[set[str], str]:
    """What is said of a best place (x, y, z mm and yaw degrees) in a box."""
    setup = given.get("setup", SETUP)
    best = SimpleNamespace(zero=np.array(at[:3]) * 1e-3, yaw=np.radians(at[3]), max_deviation=given.get("then", 0.2e-3))
    found = SimpleNamespace(
        setup=setup,
        best=best,
        now=SimpleNamespace(max_deviation=0.2e-3),
        measure=given.get("measure", "verdict"),
        screened=given.get("screened", (5, 5)),
    )
    notes = (Finding("warning", "The map was measured at one spin.", code=given.get("noted", "")),)
    run = SimpleNamespace(not_judged=np.array([False, bool(given.get("partly"))]), notes=notes)
    said = findings(found, area(setup, box), run)  # type: ignore[arg-type]
    return {each.code for each in said}, " ".join(each.message for each in said)


BOX = {"x": (-0.2, 0.2), "y": (-1.5, -1.1), "yaw_deg": (-90.0, 90.0)}


@pytest.mark.parametrize(
    ("at", "names"),
    [
        ((0.0, -1300.0, 2.0, 0.0), ""),
        ((198.9, -1300.0, 2.0, 0.0), ""),
        ((199.1, -1300.0, 2.0, 0.0), "in x:"),
        ((-199.1, -1499.5, 2.0, 0.0), "in x and y:"),
        ((0.0, -1100.0, 2.0, 89.8), "in y and yaw:"),
        ((0.0, -1300.0, 2.0, -89.7), ""),
    ],
)
def test_a_best_place_at_an_edge_of_the_box_is_said_with_the_axes(at: tuple[float, ...], names: str) -> None:
    """Within a millimetre, or a quarter of a degree; the height is not free."""
    found, words = codes(at, BOX)
    assert (EDGE in found) == bool(names)
    assert names in words


def test_all_around_there_is_no_edge() -> None:
    assert EDGE not in codes((0.0, -1300.0, 2.0, 180.0), BOX | {"yaw_deg": (-180.0, 180.0)})[0]


@pytest.mark.parametrize(
    ("given", "code"),
    [
        ({"then": 0.2101e-3}, TIP),
        ({"then": 0.2099e-3}, None),
        ({"then": 0.4e-3, "measure": "tip"}, None),
        ({"setup": SETUP.replace(force=rm.ConstantForce((30.0, 100.0, -20.0)))}, IN_ROBOT),
        ({"setup": rm.load_setup("paper_flute/setup_process").replace(coupling=True)}, COUPLED),
        ({"screened": (4, 5)}, SCREENED),
        ({"partly": True}, PARTLY),
        ({"noted": MAP_SPIN}, MAP_SPIN),
        ({}, None),
    ],
)
def test_what_a_reader_must_know_of_a_best_place(given: dict, code: str | None) -> None:
    found, _ = codes((0.0, -1300.0, 2.0, 0.0), BOX, **given)
    assert found & {EDGE, TIP, IN_ROBOT, COUPLED, SCREENED, PARTLY, MAP_SPIN} == ({code} if code else set())


def test_a_force_fixed_in_the_robot_matters_only_where_the_part_may_turn() -> None:
    fixed = SETUP.replace(force=rm.ConstantForce((30.0, 100.0, -20.0)))
    box = {name: BOX[name] for name in ("x", "y")}
    assert IN_ROBOT not in codes((0.0, -1300.0, 2.0, 0.0), box, setup=fixed)[0]
