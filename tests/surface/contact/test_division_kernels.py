"""A turn divided into pieces: they cover it once, add up to known integrals; jumps are followed to a 512th of a gap.

What is engaged at an angle is a function written out here, put in place of the material that is measured.
"""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from robomill.surface.contact import division_kernels as division
from robomill.surface.contact.engagement_kernels import FACE, HEIGHT, HIGHEST, LENGTH, LOWEST, WIDEST
from robomill.surface.contact.turn_kernels import ANGLES, HALF, aim, half_turn, panel_end


def divided(monkeypatch, engaged, halves=1, between=()):
    """The pieces (row, middle, width, sector) of a turn at whose angles ``engaged`` is so long, and its room; told
    also ``between`` the angles."""
    room = SimpleNamespace(
        rows=np.zeros((division.ROWS, 9)),
        gaps=np.zeros((division.GAPS, 7)),
        pieces=np.zeros((10 * division.ROWS, 4)),
        sectors=np.zeros((8 * HALF // 3, 5)),
        fine=np.zeros(1),
        exponents=np.zeros(0),
    )

    def measure(room, world, shape, step, first, last):
        for row in room.rows[first:last]:
            row[LENGTH] = engaged(row[0])
            row[HEIGHT], row[LOWEST], row[HIGHEST] = 2.0 * row[LENGTH], 0.5, 0.5 + row[LENGTH]
            row[WIDEST], row[FACE] = 3.0, 0.25

    monkeypatch.setattr(division, "measure", measure)
    angles = [*half_turn(), *(math.pi + half_turn())][: ANGLES * halves]
    for row, phi in zip(room.rows, angles):
        aim(row, phi)
    for row, phi in zip(room.rows[2 * ANGLES :], between):
        aim(row, phi)
    measure(room, None, None, None, 0, 2 * ANGLES + len(between))
    counts = division.divide(room, None, None, None, (HALF * halves, len(between)))
    return room, division.follow_jumps(room, None, None, None, counts)


def in_their_sectors(pieces):
    """Each in the quarter of its panel in which its middle lies."""
    for middle, sector in pieces[:, [1, 3]]:
        panel, quarter = divmod(int(sector), 4)
        start, end = panel_end(panel), panel_end(panel + 1)
        assert (
            start + quarter * (end - start) / 4 - 1e-12 <= middle <= start + (quarter + 1) * (end - start) / 4 + 1e-12
        )


@pytest.mark.parametrize("halves", [1, 2])
def test_where_nothing_jumps_two_nodes_of_gauss_a_panel_take_half_of_it_each(monkeypatch, halves):
    room, count = divided(monkeypatch, lambda phi: 2.0 + math.cos(phi), halves)
    pieces = room.pieces[:count]
    assert count == 2 * HALF // 3 * halves
    np.testing.assert_array_equal(pieces[:, 1], room.rows[pieces[:, 0].astype(int), 0])
    assert pieces[:, 2].sum() == pytest.approx(math.pi * halves)
    assert pieces[:, 2] @ (2.0 + np.cos(pieces[:, 1])) == pytest.approx(2.0 * math.pi * halves, rel=1e-5)
    in_their_sectors(pieces)


@pytest.mark.parametrize("at", [0.03, 0.7, 1.5, 2.9, 4.1])
@pytest.mark.parametrize(("before", "behind"), [(0.0, 3.0), (3.0, 0.0), (3.0, 2.0)])
def test_a_jump_is_followed_to_a_small_share_of_the_gap_in_which_it_lies(monkeypatch, at, before, behind):
    room, count = divided(monkeypatch, lambda phi: before if phi < at else behind, 2)
    pieces = room.pieces[:count]
    in_their_sectors(pieces)
    assert pieces[:, 2].sum() == pytest.approx(2.0 * math.pi)
    panel = next(n for n in range(HALF) if panel_end(n + 1) > at)
    here = pieces[pieces[:, 3] // 4 == panel]
    here = here[np.argsort(here[:, 1])]
    starts, ends = here[:, 1] - here[:, 2] / 2, here[:, 1] + here[:, 2] / 2
    np.testing.assert_allclose([*starts, panel_end(panel + 1)], [panel_end(panel), *ends], atol=1e-12)
    length = room.rows[pieces[:, 0].astype(int), LENGTH]
    gap = (panel_end(panel + 1) - panel_end(panel)) * 0.6
    exact = before * at + behind * (2.0 * math.pi - at)
    assert pieces[:, 2] @ length == pytest.approx(exact, abs=abs(behind - before) * gap / 512)


def test_a_rib_between_two_angles_is_as_wide_as_it_is_where_it_has_an_angle_of_its_own(monkeypatch):
    """From 1.42 to 1.47 rad, between two nodes; nothing else is engaged."""
    low, high = 1.42, 1.47
    assert not ((half_turn() > low) & (half_turn() < high)).any()
    engaged = lambda phi: 1.0 if low < phi < high else 0.0  # noqa: E731
    for between, width in (((), 0.0), ((1.45,), high - low), ((1.43, 1.45), high - low)):
        room, count = divided(monkeypatch, engaged, 1, between)
        length = room.rows[room.pieces[:count, 0].astype(int), LENGTH]
        assert room.pieces[:count, 2] @ length == pytest.approx(width, abs=2 * 0.2 / 512)


def test_pieces_add_up_to_the_hull_the_depth_and_the_width_of_what_is_engaged(monkeypatch):
    """A third of a length from 0.5 to 2.0 rad, 0.2 deep: heights, the place of each, and the face of the end."""
    room, count = divided(monkeypatch, lambda phi: 0.1 if 0.5 < phi < 2.0 else 0.0)
    total = np.zeros(7)
    rest = total
    rest[division.PHI_ST], rest[division.PHI_EX] = math.inf, -math.inf
    division.add_pieces(room, count, total)
    near = 0.4 / 512
    assert rest[division.PHI_ST] == pytest.approx(0.5, abs=near)
    assert rest[division.PHI_EX] == pytest.approx(2.0, abs=near)
    assert rest[division.SIZE] == pytest.approx(0.1 * 1.5, abs=near)
    assert rest[division.DEPTH] == pytest.approx(0.2 * 1.5, abs=near)
    assert rest[division.WIDTH] == pytest.approx(3.0 * (math.cos(0.5) - math.cos(2.0)), abs=5e-3)
    assert rest[division.REACH] == 0.6
    width, height, low, high, face = room.sectors[: 4 * HALF // 3].sum(axis=0)
    assert width == pytest.approx(math.pi)
    assert height == pytest.approx(0.2 * 1.5, abs=near)
    assert (low, high, face) == pytest.approx((0.5 * height, 0.6 * height, 0.25 * height / 0.2))
