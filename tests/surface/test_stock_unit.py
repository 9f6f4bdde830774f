"""A stock in another unit than its program is suspected; one that fits, or that nothing would make fit, is not."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import trimesh

from robomill.surface.stock import Stock
from robomill.surface.stock_unit import unit_doubt

#: 90 x 60 mm of pocket in a block of 101.6 x 76.2 x 25.4 mm
POCKET = np.array([[0.005, 0.008, -2e-3], [0.095, 0.008, -2e-3], [0.095, 0.068, -2e-3], [0.005, 0.068, -2e-3]])
CUTTING = np.array([False, True, True, True])
TRUE = np.array([0.1016, 0.0762, 0.0254])


def block(times: float) -> Stock:
    """Said in mm, as a file does: a plain number of this size would be taken for a slip of the unit. A block below half
    a millimetre is refused, and a mesh of that size is not."""
    width, depth, height = 1e3 * TRUE * times
    corners = {"lower_mm": (0.0, 0.0, -height), "upper_mm": (width, depth, 0.0)}
    if max(width, depth, height) >= 0.5:
        return Stock(**corners)
    mesh = trimesh.creation.box(bounds=1e-3 * np.array(list(corners.values())))
    return Stock(**corners, triangles=np.asarray(mesh.triangles))


@pytest.mark.parametrize(
    ("times", "said"),
    [
        (1.0, ""),
        (1 / 25.4, "inches read as millimetres"),
        (0.1, "centimetres read as millimetres"),
        (1e-3, "metres read as millimetres"),
        (25.4, "millimetres read as inches"),
        (1000.0, "millimetres read as"),
    ],
)
def test_the_unit_that_would_fit_is_named_with_both_extents(times: float, said: str) -> None:
    doubt = "".join(finding.message for finding in unit_doubt(block(times), POCKET, CUTTING))
    assert said in doubt
    assert bool(doubt) == bool(said)
    if said and times != 1000.0:
        assert "101.6 x 76.2 x 25.4 mm" in doubt


def test_a_path_that_overruns_the_block_is_enough_where_hardly_any_of_it_meets_the_block_as_it_is() -> None:
    """A slot from -200 to 200 mm through 300 x 200 x 40 mm, said in inches: three quarters of it would be held."""
    size = np.array([0.3, 0.2, 0.04])
    across = np.array([[-0.2, 0.0, -2e-3], [0.2, 0.0, -2e-3]])
    for times, said in ((1 / 25.4, "inches read as millimetres"), (1.0, "")):
        half = 0.5 * times * size
        found = unit_doubt(Stock((-half[0], -half[1], -2 * half[2]), (half[0], half[1], 0.0)), across, CUTTING[:2])
        assert said in "".join(finding.message for finding in found)
        assert bool(found) == bool(said)
        assert not found or "hold most of the path" in found[0].message


def test_a_block_beside_the_path_is_not_a_matter_of_units() -> None:
    away = Stock((-0.3, -0.3, -0.01), (-0.2, -0.2, 0.0))
    assert unit_doubt(away, POCKET, CUTTING) == ()
    assert unit_doubt(block(0.7), POCKET, CUTTING) == ()
    assert unit_doubt(block(1 / 25.4), POCKET, np.zeros(4, bool)) == ()


def slots(*spans: tuple[float, float], along: tuple[float, float] = (1.0, 0.0)) -> tuple[np.ndarray, np.ndarray]:
    """Cuts from one place to another along a line in plan (mm), with rapids between them."""
    places = np.array(spans).ravel()[:, None] * 1e-3
    return np.hstack([places * along, 0.0 * places - 2e-3]), np.arange(len(places)) % 2 == 1


SMALL = Stock((0.0, -0.005, -0.01), (0.01, 0.005, 0.0))  # 10 mm, where 100 mm was meant


@pytest.mark.parametrize(
    ("spans", "doubted"),
    [
        (((0, 10), (30, 40)), False),  # half of it is held
        (((0, 10), (30, 40.1)), True),
        (((0, 10), (15, 26)), True),
        (((0, 10), (10, 19.9)), False),  # no wider than a fifth of what the block would be: 20 mm were enough
        (((0, 10), (30, 99)), True),
    ],
)
def test_half_of_the_path_is_a_part_that_is_cut(spans: tuple[tuple[float, float], ...], doubted: bool) -> None:
    found = unit_doubt(SMALL, *slots(*spans))
    assert [(each.code, each.line) for each in found] == [("stock-outside", 0)] * doubted
    for each in found:
        assert "most of the path lies outside of it" in each.message
        assert "hold all of the path" in each.message


def test_a_path_across_the_plan_is_as_wide_as_its_wider_side() -> None:
    """Along the diagonal X and Y are alike at every place."""
    stock = Stock((0.0, 0.0, -0.01), (0.01, 0.01, 0.0))
    for along in ((1.0, 1.0), (0.2, 1.0), (1.0, 0.2)):
        (found,) = unit_doubt(stock, *slots((0, 10), (30, 90), along=along))
        assert "centimetres read as millimetres" in found.message


@pytest.mark.parametrize(("width", "doubted"), [(199.0, False), (201.0, True), (401.0, True)])
def test_a_block_twenty_times_as_wide_as_the_path_was_hardly_meant(width: float, doubted: bool) -> None:
    half = 0.5e-3 * width
    path, cutting = slots((-5, 5))
    found = unit_doubt(Stock((-half, -half, -0.01), (half, half, 0.0)), path, cutting)
    assert len(found) == doubted
    if doubted:
        assert "the path needs a small part of it" in found[0].message
    beside = unit_doubt(Stock((-half, -half, -0.01), (half, half, 0.0)), *slots((-5, 4), (1e4, 1e4 + 1.2)))
    assert beside == ()  # less than nine tenths of it are held


def test_places_are_even_along_the_cut_and_rapids_have_none() -> None:
    """A third of the way is outside the block: long or short moves, many or few."""
    for moves in ((0, 5, 10), (0, 10), (0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10)):
        spans = [*pairwise(moves), (200, 205), (-700, -700)]
        assert unit_doubt(SMALL, *slots(*spans)) == ()
        assert unit_doubt(SMALL, *slots((0, 4), (30, 35), (40, 40))) != ()


@pytest.mark.parametrize(("wide", "doubted"), [(0.04, True), (0.049, True), (0.051, False), (0.4, False)])
@pytest.mark.parametrize("turned", [False, True])
def test_a_block_that_would_be_five_times_as_wide_as_the_path_was_not_meant_either(wide, doubted, turned) -> None:
    """Meant in centimetres: ``wide`` (m) one way and 0.03 m the other, then 10 times as much; its wider side counts."""
    path, cutting = slots((12, 112), along=(0.0, 1.0) if turned else (1.0, 0.0))
    size = np.array([0.03, wide] if turned else [wide, 0.03])
    lower = [-0.5 * size[0], 0.0] if turned else [0.0, -0.5 * size[1]]
    stock = Stock((*lower, -0.01), (lower[0] + size[0], lower[1] + size[1], 0.0))
    assert bool(unit_doubt(stock, path, cutting)) == doubted
