"""Boxes for the part zero, and blocks that keep out of boxes: against sampled points, and what is refused."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import robomill as rm
from robomill.errors import SetupError
from robomill.improve.area import Area, area, grid, today
from robomill.simulation.given import part_frame

LEANING = rm.frame_from_points([0, -1.3, 0], [1, -1.3, 0.2], [0, -0.3, 0.1]).T_MW


def setup(**changes: object) -> rm.SimulationSetup:
    return rm.load_setup("paper_flute").replace(**changes)


def test_blocks_meet_where_points_of_one_lie_in_the_other() -> None:
    """Two solids that share a point of a fine grid meet; two that are apart share none."""
    rng = np.random.default_rng(3)
    stock = rm.Stock(lower_mm=(-40, -20, -10), upper_mm=(60, 30, 0))
    box = np.array([[[0.1, -1.4, -0.05], [0.2, -1.2, 0.02]]])
    here = Area(np.zeros(4), np.zeros(4), LEANING[:3, :3], stock, box)
    places = np.column_stack([rng.uniform([-0.05, -1.5, -0.1], [0.35, -1.1, 0.1], (300, 3)), rng.uniform(-3, 3, 300)])
    fine = np.stack(
        np.meshgrid(*(np.linspace(a, b, 25) for a, b in zip(stock.lower, stock.upper)), indexing="ij"), -1
    ).reshape(-1, 3)
    shared = np.array([_inside(fine, T, box[0]) for T in here.T_MW(places)])
    meets = here.meets(places)
    assert 30 < shared.sum() < 270
    assert not (shared & ~meets).any()
    grown = box + np.array([[-0.005], [0.005]])  # by the spacing of the points
    assert all(_inside(fine, T, grown[0]) for T in here.T_MW(places[meets]))


def _inside(fine: np.ndarray, T: np.ndarray, box: np.ndarray) -> bool:
    """Whether a point (q, 3) of the part lies in a box (2, 3) of {M}."""
    p = fine @ T[:3, :3].T + T[:3, 3]
    return bool(((p >= box[0]) & (p <= box[1])).all(axis=1).any())


def test_a_place_is_the_part_zero_and_the_turn_of_a_set_up() -> None:
    one = setup(part_zero_mm=(100, -1200, 5), part_rotation_z_deg=30)
    where = area(one, {"yaw_deg": (-90, 90)})
    np.testing.assert_allclose(today(one), [0.1, -1.2, 0.005, np.radians(30)])
    np.testing.assert_allclose(where.T_MW(today(one)), one.T_MW, atol=1e-15)
    there = where.T_MW(np.array([0.2, -1.3, 0.0, np.radians(-50)]))
    np.testing.assert_allclose(there, part_frame([0.2, -1.3, 0.0], np.radians(-50)), atol=1e-15)


def test_a_leaning_part_keeps_its_lean() -> None:
    one = setup(T_MW=LEANING)
    where = area(one, {"yaw_deg": (-180, 180)})
    np.testing.assert_allclose(where.T_MW(today(one)), one.T_MW, atol=1e-12)
    np.testing.assert_allclose(where.T_MW(np.array([0.0, -1.0, 0.0, 1.0]))[2, :3], one.T_MW[2, :3], atol=1e-12)


def test_left_out_x_and_y_are_todays_and_z_and_yaw_stay() -> None:
    where = area(setup(), {})
    np.testing.assert_allclose(where.upper - where.lower, [0.78, 0.78, 0.0, 0.0])
    np.testing.assert_allclose((where.upper + where.lower) / 2.0, today(setup()), atol=1e-15)


@pytest.mark.parametrize(
    ("given", "count"),
    [
        ({}, (32, 31)),
        ({"x_mm": (0, 0)}, (1, 1000)),
        ({"yaw_deg": (-180, 180)}, (11, 11)),
        ({"z_mm": (0, 100), "yaw_deg": (0, 90)}, (11, 10)),
    ],
)
def test_a_grid_has_about_as_many_places_as_asked_for(given: dict, count: tuple[int, int]) -> None:
    axes = area(setup(), given).axes(1000)
    assert (len(axes[0]), len(axes[1])) == count
    places = grid(axes)
    assert len(places) == np.prod([len(axis) for axis in axes])
    assert 850 < len(places) <= 1000
    assert places.tolist() == [list(each) for each in itertools.product(*axes)]


@pytest.mark.parametrize("degrees", [5, 20, 60, 100, 200, 350])
def test_a_part_of_a_turn_is_looked_at_from_end_to_end(degrees: int) -> None:
    turns = np.degrees(area(setup(), {"yaw_deg": (30, 30 + degrees)}).axes(1000)[3])
    np.testing.assert_allclose(turns[[0, -1]], [30, 30 + degrees])
    assert np.diff(turns).max() <= 67.5  # never further apart than one and a half of 45 degrees
    np.testing.assert_allclose(np.diff(turns), np.diff(turns)[0])


@pytest.mark.parametrize(
    "box",
    [
        {"x_mm": (-200, 200), "y_mm": (-1300, -1300)},
        {"x_mm": (50, 50), "y_mm": (-1400, -1200)},
        {"x_mm": (-200, 200), "y_mm": (-1400, -1200)},
        {"x_mm": (-20, 20), "y_mm": (-1900, -1200), "yaw_deg": (-90, 90)},
        {"x_mm": (0, 0), "y_mm": (-1300, -1300), "z_mm": (0, 100)},
    ],
)
def test_about_as_many_places_are_looked_at_as_are_asked_for_whichever_ways_are_free(box: dict) -> None:
    """Along what is free from end to end; one place of what is not."""
    where = area(setup(), box)
    axes, span = where.axes(300), where.upper - where.lower
    for axis, low, high in zip(axes, where.lower, where.upper, strict=True):
        assert (len(axis) > 1) == (high > low)
        assert (axis[0], axis[-1]) == (pytest.approx(low), pytest.approx(high))
    count = np.prod([len(axis) for axis in axes])
    assert count <= 300
    assert count > 200 or not span[:2].any()


@pytest.mark.parametrize("given", [{}, {"keep_out_mm": []}])
def test_where_nothing_is_kept_out_of_no_place_is_met_not_even_the_robots_foot(given: dict) -> None:
    found = area(setup(), given)
    assert found.keep_out.shape == (0, 2, 3)
    assert not found.meets(np.zeros((1, 4))).any()


def test_a_full_turn_has_no_place_twice() -> None:
    turns = area(setup(), {"yaw_deg": (-180, 180)}).axes(1000)[3]
    np.testing.assert_allclose(np.diff(turns), np.radians(45))
    assert len(turns) == 8


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (
            {"x_mm": (300, -300)},
            "Placement, x: the bounds contradict each other, 300.00 to −300.00 mm",
        ),
        ({"x_mm": [1, 0]}, "Placement, x: the bounds contradict each other, 1.00 to 0.00 mm"),
        ({"x": np.array([0.3, -0.3])}, "Placement, x: the bounds contradict each other, 0.30 to −0.30 m; give the"),
        ({"y_mm": (1, 2, 3)}, "the least and the largest, or one to hold it there; found (1, 2, 3)."),
        ({"x": (-100, 100)}, "Placement, x: found -100 m, expected at most 20: a name alone is in m"),
        ({"x_mm": (-0.3, 0.3)}, "x_mm is in mm. If 0.3 m is meant"),
        ({"x_mm": (-1e9, 1e9)}, "Placement, x"),
        ({"x": (-0.3, 0.3), "x_mm": (-300, 300)}, "x and x_mm are the same; give one of them"),
        ({"yaw": (-180, 180)}, "Placement, yaw: found -180 rad"),
        ({"yaw_deg": (0, float("nan"))}, "Placement, yaw: expected finite numbers, found NaN"),
        ({"keep_out_mm": [[[0, 0, 0], [10, 10, 0]]]}, "Placement, keep_out: box 1 has no volume"),
        ({"keep_out_mm": [[0, 0, 0, 10, 10, 0]]}, "Placement, keep_out: expected shape (..., 2, 3)"),
        ({"keep_out_mm": 3}, "Placement, keep_out: expected shape (..., 2, 3)"),
    ],
)
def test_what_is_no_area_is_refused(given: dict, said: str) -> None:
    with pytest.raises(SetupError) as refusal:
        area(setup(), given)
    assert said in str(refusal.value)


def test_one_number_holds_a_coordinate_there() -> None:
    held = area(setup(), {"y_mm": -1250, "yaw": 0.5})
    assert held.lower[[1, 3]].tolist() == held.upper[[1, 3]].tolist() == [-1.25, 0.5]


@pytest.mark.parametrize(
    ("given", "doubted"),
    [
        ({"yaw_deg": (-1, 1)}, "1°: yaw is in degrees. Was 1 rad, 57°, meant?"),
        ({"yaw_deg": (0, 2.5)}, "2.5°: yaw is in degrees. Was 2.5 rad, 143°, meant?"),
        *(({"yaw_deg": given}, "") for given in ((-5, 5), (-90, 90), 2, (2, 2))),
        ({"yaw": (-0.02, 0.02)}, ""),
    ],
)
def test_a_range_of_yaw_that_hardly_turns_the_part_is_doubted(given: dict, doubted: str) -> None:
    """57.3 degrees are a radian: a range within half a turn in radians may be one; whoever gives rad means it."""
    said = [each.message for each in area(setup(), given).doubts]
    assert [words.endswith(doubted) for words in said] == [True] * bool(doubted)


@pytest.mark.parametrize("candidates", [8, 50, 400])
@pytest.mark.parametrize("high", [1e-6, 1e-3, 0.05, 1.0, 30.0, 1e4])
def test_a_grid_has_about_as_many_places_as_were_asked_for_however_long_its_box(high: float, candidates: int) -> None:
    """Never more than asked for, at least half of them, and both ends of both sides."""
    upper = np.array([0.5, 0.5 * high, 0.0, 0.0])
    here = Area(-upper, upper, np.eye(3), setup().stock_block, np.empty((0, 2, 3)))
    axes = here.axes(candidates)
    assert 0.5 * candidates <= np.prod([len(each) for each in axes]) <= candidates
    for axis, half in zip(axes, (0.5, 0.5 * high)):
        assert (axis[0], axis[-1]) == pytest.approx((-half, half))


@pytest.mark.parametrize("degrees", [(-180, 300), (0, 361), (-350, 350)])
def test_more_than_a_full_turn_is_one(degrees: tuple[float, float]) -> None:
    found = area(setup(), {"yaw_deg": degrees})
    np.testing.assert_allclose(np.degrees([found.lower[3], found.upper[3]]), [degrees[0], degrees[0] + 360.0])


@pytest.mark.parametrize("turns", range(1, 5))
def test_degrees_that_are_quarter_turns_in_radians_to_two_digits_are_refused(turns: int) -> None:
    """1.57, 3.14, 4.71 and 6.28 are radians; a hundredth beside them is a number of degrees."""
    radians = round(turns * np.pi / 2.0, 2)
    with pytest.raises(SetupError, match=r"yaw_deg is in °"):
        area(setup(), {"yaw_deg": (0.0, radians)})
    beside = area(setup(), {"yaw_deg": (0.0, radians + 0.01)})
    assert beside.upper[3] == pytest.approx(np.radians(radians + 0.01))
