"""Moved lines and arcs as pieces, against circles and lines that are known."""

from itertools import pairwise

import numpy as np
import pytest

from robomill.toolpath.fitting import Piece, along_piece, arc_pieces, straight_pieces


def circle(count: int, sweep: float, radius: float = 10e-3, start: float = 0.3) -> tuple[np.ndarray, np.ndarray]:
    f = np.linspace(0.0, 1.0, count)
    angle = start + f * sweep
    return f, np.column_stack([radius * np.cos(angle), radius * np.sin(angle), 1e-3 * f])


def test_a_straight_line_is_one_piece_and_a_bend_two() -> None:
    f = np.linspace(0.0, 1.0, 21)
    line = np.column_stack([f, 2.0 * f, 0.0 * f]) * 1e-2
    assert [(piece.f0, piece.f1) for piece in straight_pieces(f, line, 1e-9)] == [(0.0, 1.0)]
    bent = line + np.maximum(f - 0.5, 0.0)[:, None] * [0.0, 0.0, 1e-4]
    assert [(piece.f0, piece.f1) for piece in straight_pieces(f, bent, 1e-9)] == [(0.0, 0.5), (0.5, 1.0)]
    assert len(straight_pieces(f, bent, 1e-3)) == 1


def test_a_polyline_ends_its_chords_at_its_own_corners_wherever_its_points_stand() -> None:
    """Corners at uneven shares, points between them at uneven shares of their chords: no more pieces than chords."""
    corners = np.array([[0, 0, 0], [10, 0, 0], [10, 25, 0], [-5, 25, 4], [-5, 3, 4]]) * 1e-3
    shares, per = np.array([0.0, 0.13, 0.5, 0.55, 1.0]), np.array([0.07, 0.2, 0.65, 0.9])
    f, q = [0.0], [corners[0]]
    for k in range(4):
        for part in (*per, 1.0):
            f.append(shares[k] + part * (shares[k + 1] - shares[k]))
            q.append(corners[k] + part * (corners[k + 1] - corners[k]))
    for bound in (1e-9, 1e-6):
        pieces = straight_pieces(np.array(f), np.array(q), bound)
        np.testing.assert_allclose([(each.f0, each.f1) for each in pieces], list(pairwise(shares)))
        np.testing.assert_allclose([each.end for each in pieces], corners[1:])


def test_a_point_that_runs_ahead_on_its_line_is_kept() -> None:
    """Where a move is at a share of it counts, not its shape alone: 4 mm at half of 10 mm is 1 mm off."""
    f, q = np.array([0.0, 0.5, 1.0]), np.array([[0, 0, 0], [4, 0, 0], [10, 0, 0]]) * 1e-3
    assert len(straight_pieces(f, q, 0.99e-3)) == 2
    assert len(straight_pieces(f, q, 1.01e-3)) == 1


def test_points_that_are_reached_at_one_share_are_measured_from_the_first_of_them() -> None:
    late = np.array([0.0, 0.5, 0.5, 0.5]), np.array([[0, 50, 0], [0, 0, 0], [3, 0, 0], [9, 0, 0]]) * 1e-3
    assert [each.end[0] * 1e3 for each in straight_pieces(*late, 2e-3)] == pytest.approx([0, 3, 9])
    f, q = np.array([0.5, 0.5, 0.5, 0.5]), np.array([[0, 0, 0], [3, 0, 0], [0, 0, 0], [9, 0, 0]]) * 1e-3
    assert [each.end[0] * 1e3 for each in straight_pieces(f, q, 2e-3)] == pytest.approx([3, 0, 9])
    assert [each.end[0] * 1e3 for each in straight_pieces(f, q, 4e-3)] == pytest.approx([9])


@pytest.mark.parametrize("count", [3, 4, 5, 7, 8, 9, 16, 17, 33])
def test_two_arcs_that_meet_are_found_wherever_they_meet(count: int) -> None:
    """Of 10 and of 25 mm, tangential, each a part of one turning: as few arcs as were drawn, ends at their meeting."""
    share = (count - 1) / 40
    f = np.linspace(0.0, 1.0, 41)
    first, second = 1.2 * f[:count], 1.2 * (f[count - 1 :] - share)
    meet = 1.2 * share
    q = np.zeros((41, 3))
    q[:count, :2] = 10e-3 * np.column_stack([np.cos(first), np.sin(first)])
    centre = -15e-3 * np.array([np.cos(meet), np.sin(meet)])
    q[count - 1 :, :2] = centre + 25e-3 * np.column_stack([np.cos(meet + second), np.sin(meet + second)])
    one, two = arc_pieces(f, q, 17, 1.2, 1e-8)
    assert (one.f0, one.f1, two.f0, two.f1) == pytest.approx((0.0, share, share, 1.0))
    assert one.centre is not None
    assert two.centre is not None
    np.testing.assert_allclose(one.centre, [0, 0, 0], atol=1e-7)
    np.testing.assert_allclose(two.centre[:2], centre, atol=1e-7)
    assert (one.sweep, two.sweep) == pytest.approx((meet, 1.2 - meet))


@pytest.mark.parametrize("bound", [1e-7, 1e-6])
def test_a_line_an_arc_and_a_line_stay_within_their_bound_and_in_order(bound: float) -> None:
    """A crooked way that no arc holds, then one that does, then a crooked one again; each point on its piece."""
    f = np.linspace(0.0, 1.0, 61)
    _, q = circle(61, 1.5)
    q[:15, 0] += 3e-5 * (np.arange(15) % 2)
    q[46:, 1] += 3e-5 * (np.arange(15) % 2)
    pieces = arc_pieces(f, q, 17, 1.5, bound)
    assert [a.f1 for a in pieces[:-1]] == [b.f0 for b in pieces[1:]]
    assert (pieces[0].f0, pieces[-1].f1) == (0.0, 1.0)
    round_ones = [each for each in pieces if each.centre is not None]
    assert max(each.f1 - each.f0 for each in round_ones) > 0.45
    at = q[0]
    for each in pieces:
        some = (f >= each.f0) & (f <= each.f1)
        if each.centre is None:
            off = np.linalg.norm(along_piece(at, each, f[some]) - q[some], axis=1)
        else:
            spokes = np.linalg.norm((q[some] - each.centre)[:, :2], axis=1)
            off = np.abs(spokes - np.linalg.norm((at - each.centre)[:2]))
        assert off.max() <= bound
        at = each.end


def test_what_is_no_arc_becomes_chords() -> None:
    """Turning the other way, by more than 0.5 rad less than the move (in one), nearly flat, or at one place."""
    f, q = circle(40, 1.2)
    assert all(each.centre is None for each in arc_pieces(f, q, 17, -1.2, 1e-7))
    assert len(arc_pieces(f, q, 17, 1.8, 1e-7)) > 1
    assert len(arc_pieces(f, q, 17, 1.65, 1e-7)) == 1
    f, q = circle(40, 5e-5)
    assert all(each.centre is None for each in arc_pieces(f, q, 17, 5e-5, 1e-9))
    still = np.zeros((5, 3))
    assert all(each.centre is None for each in arc_pieces(np.linspace(0, 1, 5), still, 17, 1.0, 1e-7))


def test_an_arc_that_is_nearly_closed_is_fitted_in_parts() -> None:
    """Of 340 degrees: its chord is too short to hold its centre."""
    f, q = circle(201, np.radians(340.0))
    pieces = arc_pieces(f, q, 17, np.radians(340.0), 1e-8)
    assert len(pieces) > 1
    assert all(each.centre is not None and abs(each.sweep) <= np.radians(330.0) for each in pieces)
    f, q = circle(201, np.radians(320.0))
    assert len(arc_pieces(f, q, 17, np.radians(320.0), 1e-8)) == 1


@pytest.mark.parametrize("bound", [1e-7, 1e-6, 1e-5])
def test_chords_stay_within_their_bound_at_every_point(bound: float) -> None:
    f = np.linspace(0.0, 1.0, 301)
    q = np.column_stack([f * 0.1, 1e-4 * np.sin(9.0 * f), 1e-4 * np.cos(5.0 * f)])
    pieces = straight_pieces(f, q, bound)
    starts = [q[0], *(piece.end for piece in pieces)]
    for start, piece in zip(starts, pieces, strict=False):
        some = (f >= piece.f0) & (f <= piece.f1)
        assert np.linalg.norm(along_piece(start, piece, f[some]) - q[some], axis=1).max() <= bound
    assert pieces[-1].f1 == 1.0


@pytest.mark.parametrize("sweep", [0.4, -1.5, 3.0, -5.5])
@pytest.mark.parametrize("radius", [2e-3, 0.3])
def test_a_shifted_helix_is_one_arc_about_its_own_centre(sweep: float, radius: float) -> None:
    f, q = circle(60, sweep, radius)
    shift = np.array([1e-3, -2e-3, 3e-3])
    (piece,) = arc_pieces(f, q + shift, 17, sweep, 1e-9)
    np.testing.assert_allclose(piece.centre, shift, atol=1e-10)
    assert piece.sweep == pytest.approx(sweep)
    np.testing.assert_allclose(along_piece(q[0] + shift, piece, f), q + shift, atol=1e-9)


def test_a_full_circle_stays_one_and_what_is_pushed_unevenly_is_cut_in_several() -> None:
    f, q = circle(201, 2.0 * np.pi)
    q[:, 2] = 0.0
    (piece,) = arc_pieces(f, q, 17, 2.0 * np.pi, 1e-9)
    assert piece.sweep == pytest.approx(2.0 * np.pi)
    oval = q * [1.01, 1.0, 1.0]
    pieces = arc_pieces(f, oval, 17, 2.0 * np.pi, 2e-6)
    assert 2 < len(pieces) < len(straight_pieces(f, oval, 2e-6))
    starts = [oval[0], *(each.end for each in pieces)]
    for start, each in zip(starts, pieces, strict=False):
        assert each.centre is not None
        ends = np.linalg.norm(start[:2] - each.centre[:2]), np.linalg.norm(each.end[:2] - each.centre[:2])
        assert ends[0] == pytest.approx(ends[1], abs=1e-12)  # it ends on its circle
        some = (f >= each.f0) & (f <= each.f1)
        assert np.abs(np.linalg.norm(oval[some, :2] - each.centre[:2], axis=1) - ends[0]).max() <= 2e-6


def test_a_crooked_arc_becomes_chords() -> None:
    f, q = circle(9, 0.5)
    q[:, 0] += 1e-4 * np.array([0, 1, 0, 1, 0, 1, 0, 1, 0])
    assert all(piece.centre is None for piece in arc_pieces(f, q, 17, 0.5, 1e-6))


@pytest.mark.parametrize(("plane", "columns"), [(18, [2, 0, 1]), (19, [1, 2, 0])])
def test_arcs_of_the_other_planes_turn_about_their_own_axes(plane: int, columns: list[int]) -> None:
    f, q = circle(40, 1.2)
    turned = np.empty_like(q)
    turned[:, columns] = q
    (piece,) = arc_pieces(f, turned, plane, 1.2, 1e-9)
    np.testing.assert_allclose(along_piece(turned[0], piece, f, plane), turned, atol=1e-9)


def test_a_link_is_all_at_its_end() -> None:
    link = Piece(0.0, 0.0, np.array([1.0, 2.0, 3.0]))
    np.testing.assert_array_equal(along_piece(np.zeros(3), link, np.zeros(1)), [[1.0, 2.0, 3.0]])
