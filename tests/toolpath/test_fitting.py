"""Moved lines and arcs as pieces, against circles and lines that are known."""

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
