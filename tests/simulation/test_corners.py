"""Which samples of a corrected program belong to the corners of the path that was meant, however few stand there."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.simulation.corners import FARTHEST, LINKED, STEEP, UPRIGHT, Ways, _aside, at_corners


def staircase(step: float) -> tuple[np.ndarray, np.ndarray]:
    """A cut (m, 3) m of three legs of 20 mm, each turned left or right by 90 degrees, and the leg that each step is
    of."""
    ways, n = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]), round(20e-3 / step)
    steps = np.repeat(ways, n, axis=0) * step
    return np.vstack([np.zeros(3), np.cumsum(steps, axis=0)]), np.append(0, np.repeat(np.arange(3), n))


@pytest.mark.parametrize("step", [10e-3, 5e-3, 1e-3, 0.5e-3])
@pytest.mark.parametrize("off", [(0.3e-3, -0.2e-3, 0.0), (-0.15e-3, -0.1e-3, 0.05e-3), (0.0, 0.0, 0.0)])
def test_where_a_leg_ends_it_belongs_to_the_corner(step: float, off: tuple[float, float, float]) -> None:
    """Moved as a whole, its samples lie before or behind the corner by what it goes aside."""
    p, leg = staircase(step)
    k = np.tile([0.0, 0.0, 1.0], (len(p), 1))
    q, s = p + np.array(off), np.arange(len(p)) * step
    near = s + off[0] * (leg != 1) + off[1] * (leg == 1)
    found, meets = at_corners(q, k, leg, np.clip(near, 0.0, s[-1]), Ways.of(p, k))
    corners = (20e-3, 40e-3)
    assert np.flatnonzero(meets).tolist() == [int(np.argmin(np.abs(s - corner))) for corner in corners]
    for corner in corners:
        at = int(np.argmin(np.abs(s - corner)))
        assert found[at] == pytest.approx(corner, abs=1e-12)
        assert (found[:at] <= corner + 1e-12).all()
        assert (found[at:] >= corner - 1e-12).all()
    ends = [int(np.argmin(np.abs(s - corner))) for corner in corners]
    low = np.repeat([0.0, *corners], np.diff([0, *ends, len(s)]))
    high = np.repeat([*corners, s[-1]], np.diff([0, ends[0] + 1, ends[1] + 1, len(s)]))
    np.testing.assert_allclose(found, np.clip(near, low, high), atol=1e-12)


def test_steps_that_go_nowhere_are_no_steps_and_corners_turn_by_ten_degrees_at_least() -> None:
    """Level legs that turn by 9 and 11 degrees, each with a stop behind it; a plunge, and one that goes on down."""
    turns, legs, p = [0.0, 9.0, 11.0, -9.0, -11.0], [], [np.zeros(3)]
    for angle in np.radians(np.cumsum(turns)):
        legs.append(2e-3 * np.array([np.cos(angle), np.sin(angle), 0.0]))
        p += [p[-1] + legs[-1], p[-1] + legs[-1]]
    for leg in ([0.0, 0.0, -1e-3], [0.1e-3, 0.0, -1e-3], [1e-3, 0.0, -0.2e-3]):
        legs.append(np.array(leg))
        p.append(p[-1] + legs[-1])
    found = Ways.of(np.array(p), np.tile([0.0, 0.0, 1.0], (len(p), 1)))
    np.testing.assert_allclose(found.s, np.cumsum([np.linalg.norm(leg) for leg in legs]))
    np.testing.assert_allclose(found.p, np.cumsum(legs, axis=0), atol=1e-15)
    expected = [leg * [1, 1, 0] / np.hypot(*leg[:2]) if np.hypot(*leg[:2]) > STEEP * 1e-3 else leg * 0 for leg in legs]
    np.testing.assert_allclose(found.way, expected, atol=1e-12)
    # behind the second leg, the fourth, the fifth, where it plunges, and the plunge, where it goes on across
    assert found.corners.tolist() == [1, 3, 4, 6]


@pytest.mark.parametrize("lean", [0.0, 0.3])
def test_a_step_costs_what_it_leads_aside_of_its_way_or_all_of_it_against_it(lean: float) -> None:
    rng, n = np.random.default_rng(3), 40
    u, v = np.array([np.cos(lean), 0.0, -np.sin(lean)]), np.array([0.0, 1.0, 0.0])
    angle, size, to = rng.uniform(-np.pi, np.pi, n), rng.uniform(0.1e-3, 1e-3, n), rng.uniform(-np.pi, np.pi, n)
    across = size[:, None] * (np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v)
    way = np.cos(to)[:, None] * u + np.sin(to)[:, None] * v
    way[:5] = 0.0  # straight down: whatever leads across is aside, but as little as in a link where that is little
    up = rng.uniform(0.0, 20e-3, n)
    found = _aside(across, up, way)
    for i in range(n):
        between = angle[i] - to[i]
        cost = size[i] * abs(np.sin(between)) if np.cos(between) > 0.0 and i >= 5 else size[i]
        if size[i] < 0.1 * up[i]:
            cost = cost + UPRIGHT * up[i] if i >= 5 else LINKED * size[i]
        assert found[i] == pytest.approx(cost, abs=1e-15)


@pytest.mark.parametrize("beyond", [0.15e-3, 0.05e-3])
def test_a_cut_that_runs_straight_on_beyond_its_corner_is_linked_by_the_line_that_leads_back_across(
    beyond: float,
) -> None:
    """Deflected backwards it is sent further; what leads on costs little, what leads across to the next cut more."""
    cut = np.array([[0, 0, 0], [10, 0, 0], [20, 0, 0], [20, 10, 0], [20, 20, 0]]) * 1e-3
    q = np.vstack([cut[:3], [20e-3 + beyond, 0.0, 0.0], [20e-3, beyond + 0.05e-3, 0.0], cut[3:]])
    up = np.tile([0.0, 0.0, 1.0], (len(q), 1))
    nearest = np.array([0.0, 10e-3, 20e-3, 20e-3, 20e-3 + q[4, 1], 30e-3, 40e-3])
    s, meets = at_corners(q, up, np.array([0, 1, 1, 2, 3, 4, 4]), nearest, Ways.of(cut, up[:5]))
    assert np.flatnonzero(meets).tolist() == [3, 4]
    np.testing.assert_allclose(s, [0.0, 10e-3, 20e-3, 20e-3, 20e-3, 30e-3, 40e-3])


def stepped(up: float, *ends: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Along X for 20 mm, straight up, and along X for as far again, every 0.1 mm: where a path in lines that end so far
    along it, m, keeps to it, and which samples belong to its corners."""
    z = np.round(1e4 * up)
    n = np.arange(401 + z)
    p = np.column_stack([np.minimum(n, 200) + np.maximum(n - 200 - z, 0), 0 * n, np.clip(n - 200, 0, z)]) * 1e-4
    s, k = n * 1e-4, np.tile([0.0, 0.0, 1.0], (len(n), 1))
    line = np.searchsorted(np.array(ends) + 1e-6, s)
    return s, *at_corners(p, k, line, s, Ways.of(p, k))


@pytest.mark.parametrize("up", [20e-3, 6e-3, 5e-3])
@pytest.mark.parametrize("share", [0.05, 0.19, 0.21, 0.35, 0.46, 0.54, 0.65, 0.79, 0.81, 0.95])
def test_a_line_ends_at_the_nearer_corner_and_at_none_that_is_further_along_than_twice_the_farthest(
    up: float, share: float
) -> None:
    """In the way up, where it lies above both corners or below them, no way aside of either."""
    at = np.round(20e-3 + share * up, 4)
    s, found, meets = stepped(up, at)
    within = [abs(at - corner) <= min(2.0 * FARTHEST, 0.5 * up) + 1e-9 for corner in (20e-3, 20e-3 + up)]
    end, expected = int(np.argmin(np.abs(s - at))), s.copy()
    assert np.flatnonzero(meets).tolist() == [end] * any(within)
    if within[0]:
        expected[: end + 1] = np.minimum(expected[: end + 1], 20e-3)
    if within[1]:
        expected[end:] = np.maximum(expected[end:], 20e-3 + up)
    np.testing.assert_allclose(found, expected, atol=1e-12)


@pytest.mark.parametrize("behind", [True, False])
def test_a_line_that_ends_nearer_to_a_corner_that_has_its_own_is_of_none(behind: bool) -> None:
    """Up by 6 mm, lines end at one of the corners and 2.8 mm from it."""
    corner, other = (20e-3, 22.8e-3) if behind else (26e-3, 23.2e-3)
    s, found, meets = stepped(6e-3, *sorted((corner, other)))
    assert np.flatnonzero(meets).tolist() == [int(np.argmin(np.abs(s - corner)))]
    np.testing.assert_allclose(found, s, atol=1e-12)
