"""Rims of tools noted in the cells they pass through, against lines and circles laid over the plan."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.surface.contact.march_kernels import note_rim
from robomill.surface.contact.material_kernels import NOBODY, see_move
from tests.surface.contact.test_march_kernels import BALL, FLAT, MM, UP, world_of


def noted(world):
    return world.dexels.names[..., 0]


@pytest.mark.parametrize("axis", [UP, (0.0, 0.28, 0.96), (-0.28, 0.0, 0.96)])
@pytest.mark.parametrize("cutter", [FLAT, BALL], ids=lambda c: c.kind)
def test_sides_are_noted_in_the_cells_they_pass_through(cutter, axis):
    """Where a line on either side of the body at the height of its full radius passes over the plan."""
    start, end = np.array([6.0, 6.0, -5.0]), np.array([17.0, 9.0, -5.5])
    world = world_of([(cutter, start, end, axis)])
    note_rim(world, cutter.solid, 1, False)
    way = end - start
    side = np.cross(axis, way) / np.linalg.norm(np.cross(axis, way))
    share = np.linspace(0.0, 1.0, 4001)[:, None]
    line = start + share * way + cutter.corner_radius / MM * np.array(axis)
    dexels, expected = world.dexels, np.zeros(world.dexels.names.shape[:2], dtype=int)
    for sense in (-1.0, 1.0):
        at = (line + sense * cutter.radius / MM * side)[:, :2] * MM
        i, j = np.floor(at / [dexels.dx, dexels.dy]).astype(int).T
        np.add.at(expected, (i, j), 1)
    found = noted(world) == 1
    length = np.linalg.norm(way) * MM / 4000
    assert not found[expected == 0].any()
    assert found[expected * length > 0.5 * min(dexels.dx, dexels.dy)].all()


@pytest.mark.parametrize("axis", [UP, (0.0, 0.28, 0.96), (-0.28, 0.0, 0.96)])
@pytest.mark.parametrize("way", [(11.0, 4.0, -0.5), (-9.0, 6.0, -0.5)])
def test_where_a_run_stops_its_front_is_noted_too(axis, way):
    """The half of the rim that lies ahead of the end, seen from above; nothing that lies behind it or off the rim."""
    end = np.array([12.0, 8.0, -5.0])
    found = []
    for stops in (False, True):
        world = world_of([(FLAT, end - way, end, axis)])
        note_rim(world, FLAT.solid, 1, stops)
        found.append(noted(world) == 1)
    dexels, k = world.dexels, np.array(axis)
    side = np.cross(k, way) / np.linalg.norm(np.cross(k, way))
    ahead = np.cross(side, k)
    phi = np.linspace(0.0, np.pi, 4001)[:, None]
    rim = (end + FLAT.radius / MM * (np.cos(phi) * side + np.sin(phi) * ahead))[:, :2] * MM
    cells, counts = np.unique(np.floor(rim / [dexels.dx, dexels.dy]).astype(int), axis=0, return_counts=True)
    passed = np.zeros_like(found[0])
    passed[tuple(cells.T)] = True
    np.testing.assert_array_equal(found[1] & ~found[0] & ~passed, False)
    step = np.pi * FLAT.radius / 4000
    clear = counts * step > 0.7 * min(dexels.dx, dexels.dy)
    assert clear.sum() > 8
    assert found[1][tuple(cells[clear].T)].all()


@pytest.mark.parametrize("axis", [(0.0, 0.28, 0.96), (-0.28, 0.0, 0.96), (0.6, 0.0, 0.8), (0.36, -0.48, 0.8)])
@pytest.mark.parametrize("way", [(11.0, 4.0, -0.1), (-9.0, 6.0, -0.1)])
def test_what_of_a_front_stands_above_the_stock_is_not_noted(axis, way):
    """A leaning tool stops 0.3 mm under the top: half of its rim or so is out of the material."""
    end, k = np.array([12.0, 8.0, -0.3]), np.array(axis)
    found = []
    for stops in (False, True):
        world = world_of([(FLAT, end - way, end, axis)])
        note_rim(world, FLAT.solid, 1, stops)
        found.append(noted(world) == 1)
    side = np.cross(k, way) / np.linalg.norm(np.cross(k, way))
    phi = np.linspace(0.0, np.pi, 4001)[:, None]
    rim = end + FLAT.radius / MM * (np.cos(phi) * side + np.sin(phi) * np.cross(side, k))
    i, j = np.floor(rim[:, :2].T * MM / np.array([[world.dexels.dx], [world.dexels.dy]])).astype(int)
    under, length = np.zeros(found[0].shape), np.pi * FLAT.radius / 4000
    np.add.at(under, (i[rim[:, 2] < 0.0], j[rim[:, 2] < 0.0]), length)
    assert not found[1][(under == 0.0) & ~found[0]].any()
    clear = under > 0.7 * min(world.dexels.dx, world.dexels.dy)
    assert clear.any()
    assert found[1][clear].all()
    assert (rim[:, 2] > 0.0).any()


def test_the_side_that_reaches_further_is_noted():
    """A slot by 8 mm and one by 6 mm on its middle, either first, in cells of 2 mm that both sides pass through."""
    narrow = Cutter("flat", 6 * MM)
    wide_move, narrow_move = (FLAT, (2, 8, -2), (22, 8, -2), UP), (narrow, (2, 8, -2), (22, 8, -2), UP)
    for moves in ((wide_move, narrow_move), (narrow_move, wide_move)):
        world = world_of(moves, cells=(12, 8))
        for r in (1, 2):
            see_move(world.runs[r])
            note_rim(world, moves[r - 1][0].solid, r, False)
        names = noted(world)
        np.testing.assert_array_equal(np.flatnonzero(names[6] != NOBODY), [2, 5])
        np.testing.assert_array_equal(names[2:10, [2, 5]], 1 + moves.index(wide_move))


def test_nothing_is_noted_above_the_stock_or_of_a_plunge():
    for start, end in (((5, 8, 1), (15, 8, 1)), ((5, 8, 0), (5, 8, -5))):
        world = world_of([(FLAT, start, end, UP)])
        note_rim(world, FLAT.solid, 1, False)
        assert (noted(world) == NOBODY).all()
