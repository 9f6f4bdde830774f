"""Where a force that depends on the deflection leaves the tool: laws whose roots are known; brackets, jumps, floors."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.optimize import brentq

from robomill.simulation.coupling import (
    AROUND,
    CLOSE,
    LONGEST,
    MOST,
    NARROW,
    TOLERANCE,
    TURNS,
    _between,
    _bounds,
    _by_bracket,
    _by_broyden,
    _by_height,
    _by_shares,
    settle,
)

UP = np.array([0.0, 0.0, 1.0])


@pytest.mark.parametrize("q", [0.0, 0.5, -0.6, -1.0, -3.0, 0.99, -50.0])
def test_a_straight_law_is_solved_whatever_its_slope(q):
    """Going round and round closes in only for |q| < 1."""
    goal = np.array([1e-4, -2e-4, 0.5e-4])
    found = settle(lambda x: goal + q * (x - goal), np.zeros(3), np.zeros(3), UP)
    assert found.agreed
    np.testing.assert_allclose(found.x, goal, atol=TOLERANCE / abs(1 - q) * 1.01)
    assert found.evaluations < 12
    assert found.gain == pytest.approx(abs(q), rel=1e-6, abs=1e-9)
    ((place, weight),) = found.mix
    assert weight == 1.0
    np.testing.assert_array_equal(place, found.x)


@pytest.mark.parametrize("q", [0.0, -0.6, -3.0])
def test_a_place_that_is_told_beforehand_is_taken_and_one_beside_it_is_left_at_once(q):
    """The first step from anywhere goes to where the force bends the tool from there."""
    goal, asked = np.array([1e-4, -2e-4, 0.5e-4]), []

    def bends(x):
        asked.append(x)
        return goal + q * (x - goal)

    there = settle(bends, goal, np.zeros(3), UP)
    assert (there.agreed, there.evaluations, len(asked)) == (True, 1, 1)
    np.testing.assert_array_equal(there.x, goal)
    assert np.isnan(there.gain)
    beside = goal + np.array([0.0, 0.6e-4, -0.2e-4])
    assert settle(bends, beside, np.zeros(3), UP).agreed
    np.testing.assert_allclose(asked[1:3], [beside, goal + q * (beside - goal)], atol=1e-15)


@pytest.mark.parametrize("seed", range(4))
def test_a_law_of_three_slopes_is_closed_in_upon_in_short_steps(seed):
    """g(x) = goal + A (x - goal) with A of any slopes but 1, the goal some millimetres away."""
    rng = np.random.default_rng(seed)
    goal, axes = rng.normal(size=3) * 2e-3, np.linalg.qr(rng.normal(size=(3, 3)))[0]
    A = axes @ np.diag(rng.uniform(-2.0, 0.7, 3)) @ axes.T
    asked = []

    def bends(x):
        asked.append(x)
        return goal + A @ (x - goal)

    found = settle(bends, np.zeros(3), np.zeros(3), UP)
    assert found.agreed
    np.testing.assert_allclose(found.x, goal, atol=3 * TOLERANCE / 0.3)
    assert found.rest == pytest.approx(np.abs(bends(found.x) - found.x).max(), abs=1e-15)
    assert found.evaluations == len(asked) - 1
    assert np.linalg.norm(np.diff(asked[:-1], axis=0), axis=1).max() <= LONGEST * (1 + 1e-9)


def test_a_force_that_is_no_number_ends_the_bracket_where_it_is_seen():
    """At the tool's own place, or where it is bent to from there: nothing is asked any more."""
    for g in (lambda x: x * np.nan, lambda x: x + 1e-5 if x[0] < 1e-5 else x * np.nan):
        asked = []
        found = _by_bracket(lambda x, g=g, asked=asked: asked.append(x) or g(x), np.zeros(3))
        assert (found.evaluations, len(asked), np.isnan(found.rest), found.agreed) == (2, 2, True, False)
        assert not found.x.any()


def test_a_force_that_jumps_is_held_at_the_jump():
    """A wall at 30 um that pushes back 200 um as soon as it is touched: the tool rests on it with a part of that."""

    def bends(x):
        return np.array([50e-6, 10e-6, 0.0]) - (np.array([200e-6, 0.0, 0.0]) if x[0] > 30e-6 else 0.0)

    found = settle(bends, np.zeros(3), np.zeros(3), UP)
    assert found.agreed
    assert found.x[0] == pytest.approx(30e-6, abs=TOLERANCE)
    pushed = sum(weight * bends(place) for place, weight in found.mix)
    np.testing.assert_allclose(pushed, found.x, atol=TOLERANCE)
    assert len(found.mix) == 2


def remains(bends, found):
    """How far the force that acts at the place, of one side or of both by their weights, bends the tool from it."""
    return np.abs(sum(weight * bends(place) for place, weight in found.mix) - found.x).max()


@pytest.mark.parametrize("seed", range(12))
def test_a_wall_that_pushes_sideways_too_holds_the_tool(seed):
    """Free push a, a plane n . x = at, and behind it a + b: so much w of b acts that n . (a + w b) = at."""
    rng = np.random.default_rng(seed)
    a, b, n, at = np.array([50e-6, 10e-6, -20e-6]), np.array([-200e-6, 30e-6, -15e-6]), np.array([1.0, 0.0, 0.0]), 30e-6
    if seed:
        n, across = np.linalg.qr(rng.normal(size=(3, 3)))[0][:2]
        a = rng.uniform(30e-6, 200e-6) * n + rng.normal(size=3) * 50e-6
        at = rng.uniform(0.2, 0.9) * (a @ n)
        b = rng.uniform(1.2, 6.0) * (a @ n - at) * (-n + rng.uniform(0.0, 0.6) * across)
    root = a + (at - a @ n) / (b @ n) * b

    def bends(x):
        return a + (b if x @ n > at else 0.0)

    found = settle(bends, np.zeros(3), np.zeros(3), UP)
    assert found.agreed
    assert found.rest == pytest.approx(remains(bends, found), abs=1e-12)
    np.testing.assert_allclose(found.x, root, atol=2 * TOLERANCE)


@pytest.mark.parametrize("seed", range(30))
def test_what_remains_between_force_and_deflection_is_told_agreed_or_not(seed):
    """Two walls at once, each with a push of its own: a place between four forces, which two cannot always hold."""
    rng = np.random.default_rng(seed)
    a, (n, m) = rng.uniform(50e-6, 300e-6, 3), np.linalg.qr(rng.normal(size=(3, 3)))[0][:2]
    walls = [
        (u * np.sign(a @ u), rng.uniform(0.2, 0.9) * abs(a @ u), rng.uniform(1.5, 4.0) * abs(a @ u)) for u in (n, m)
    ]

    def bends(x):
        return a - sum((u * back * (1.0 + 0.3 * (n + m)) for u, at, back in walls if x @ u > at), np.zeros(3))

    found = settle(bends, np.zeros(3), np.zeros(3), UP)
    assert found.rest == pytest.approx(remains(bends, found), abs=1e-12)
    assert found.agreed == (remains(bends, found) <= TOLERANCE)


@pytest.mark.parametrize("stiff", [1.0, 3.0, 8.0])
@pytest.mark.parametrize("seed", range(6))
def test_a_bracket_follows_a_push_that_turns_as_it_grows(seed, stiff):
    """Behind a plane the tool is pushed back as far as it has gone in, times ``stiff``, and aside by the root of that:
    how far it goes in is one number's equation."""
    rng = np.random.default_rng(seed)
    n, u, v = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    reach = rng.uniform(50e-6, 300e-6)
    free, at = reach * n + rng.normal(size=3) * 30e-6, rng.uniform(0.2, 0.7) * reach

    def bends(x):
        into = max(x @ n - at, 0.0)
        return free - stiff * into * n + 0.3 * stiff * np.sqrt(into * reach) * (u + 0.5 * v)

    into = brentq(lambda into: free @ n - stiff * into - at - into, 0.0, 1.0, xtol=1e-15)
    found = _by_bracket(bends, np.zeros(3))
    assert found.agreed
    np.testing.assert_allclose(found.x, bends((at + into) * n), atol=2 * TOLERANCE)


@pytest.mark.parametrize("seed", range(20))
def test_an_end_that_rests_on_its_floor_holds_the_tool(seed):
    """Free push a, and b more as soon as the tool is below a floor; just above it some of b comes within 0.7 um. Aside
    the push changes slowly (L). How much of b acts, w, is one number's equation; the rest is linear."""
    rng = np.random.default_rng(seed)
    axis, u, v = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    P, near, touch = np.outer(u, u) + np.outer(v, v), 0.7e-6, 0.4
    a = rng.uniform(-400e-6, -20e-6) * axis + rng.normal(size=3) * 50e-6
    b = rng.uniform(500e-6, 900e-6) * axis + rng.uniform(-400e-6, 400e-6, 2) @ (u, v)
    L, at = rng.uniform(-0.2, 0.2, (3, 3)), a @ axis + rng.uniform(0.05, 0.95) * (b @ axis)

    def bends(x):
        above = x @ axis - at
        acts = 1.0 if above < 0.0 else touch * max(1.0 - above / near, 0.0)
        return a + L @ (P @ x) + acts * b

    def aside(w):
        return np.linalg.solve(np.eye(3) - P @ L, P @ (a + w * b))

    def over(w):
        return (a + L @ aside(w) + w * b) @ axis - at - near * max(1.0 - w / touch, 0.0)

    w = brentq(over, 0.0, 1.0, xtol=1e-15)
    root = aside(w) + (at + near * max(1.0 - w / touch, 0.0)) * axis
    for found in (settle(bends, np.zeros(3), np.zeros(3), axis), _by_height(bends, np.zeros(3), axis)):
        assert found.agreed
        np.testing.assert_allclose(found.x, root, atol=2 * TOLERANCE)
        assert found.rest == pytest.approx(remains(bends, found), abs=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_an_edge_of_a_floor_between_three_pushes_holds_the_tool(seed):
    """Above a floor one push, below it another on each side of a line: a share of each holds the tool on the floor's
    edge at x, which is chosen here first, with the shares. Each alone sends it hundreds of micrometres away."""
    rng = np.random.default_rng(seed)
    up, aside, along = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    x, share = rng.uniform(100e-6, 300e-6) * up + rng.normal(size=3) * 50e-6, rng.dirichlet([2, 2, 2])
    lift, turn = rng.uniform(100e-6, 600e-6) * np.array([1.0, rng.uniform(0.5, 1.0)]), rng.uniform(20e-6, 200e-6, 2)
    left, right = (
        lift[i] * up + way * turn[i] * aside + rng.normal() * 100e-6 * along for i, way in enumerate((1.0, -1.0))
    )
    above = -(share[1] * left + share[2] * right) / share[0]

    def bends(y):
        if (y - x) @ up > 0.0:
            return x + above
        return x + (left if (y - x) @ aside < 0.0 else right)

    found = settle(bends, np.zeros(3), np.zeros(3), up)
    assert found.agreed
    assert found.rest == pytest.approx(remains(bends, found), abs=1e-12)
    assert max(np.abs(place - found.x).max() for place, _ in found.mix) <= TOLERANCE * (1 + 1e-9)
    np.testing.assert_allclose([up @ found.x, aside @ found.x], [up @ x, aside @ x], atol=2 * TOLERANCE)


def test_one_looks_around_a_place_as_far_to_every_side():
    """The places are the same, seen in a mirror along any axis or with axes exchanged; none of them is asked twice."""
    places = {tuple(place) for place in AROUND.tolist()}
    assert len(places) == len(AROUND)
    for axes in itertools.permutations(range(3)):
        for signs in itertools.product((1.0, -1.0), repeat=3):
            assert {tuple(place) for place in (AROUND[:, axes] * signs + 0.0).tolist()} == places
    assert max(map(max, places)) == 1.0


def test_what_pushes_away_from_everywhere_is_told_as_open():
    """Wherever the tool stands it is pushed on by 10 um more: nothing holds it, and what acts there is told."""
    found = settle(lambda x: x + np.array([0.0, 10e-6, 0.0]), np.zeros(3), np.zeros(3), UP)
    assert not found.agreed
    assert found.rest == pytest.approx(10e-6, rel=0.1)
    assert sum(weight for _, weight in found.mix) == pytest.approx(1.0)


def test_what_is_not_a_number_ends_it():
    found = settle(lambda x: np.full(3, np.nan), np.zeros(3), np.zeros(3), UP)
    assert not found.agreed
    assert np.isnan(found.rest)
    assert found.evaluations <= MOST


@pytest.mark.parametrize("seed", range(6))
def test_how_often_the_force_was_asked_for_is_counted(seed):
    """A wall at a random place along the push, and one that is only pushed at: halving the way between until
    it is narrow takes the logarithm of its length, after what going round takes at most."""
    rng = np.random.default_rng(seed)
    push, wall, back = rng.uniform(50e-6, 900e-6), rng.uniform(0.1, 0.9), rng.uniform(1.5, 4.0)
    along = np.linalg.qr(rng.normal(size=(3, 3)))[0][0]
    asked = []

    def bends(x):
        asked.append(x)
        return push * along * (1.0 if x @ along < wall * push else 1.0 - back)

    found = settle(bends, np.zeros(3), np.zeros(3), UP)
    assert found.agreed
    np.testing.assert_allclose(found.x, wall * push * along, atol=TOLERANCE)
    assert found.evaluations == len(asked)
    halvings = np.ceil(np.log2(back * push / NARROW))
    floor = 2 * np.ceil(np.log2(LONGEST / TOLERANCE)) + 2 + halvings  # looked for twice: does the tool rest on one?
    assert found.evaluations <= MOST + 2 * floor + 2 + 2 + halvings
    ((there, low), (here, high)) = found.mix
    assert low + high == pytest.approx(1.0)
    both = (low * bends(there) + high * bends(here)) @ along / push
    assert both == pytest.approx(wall, abs=2e-3)


@pytest.mark.parametrize("seed", range(12))
def test_bounds_of_a_height_lie_on_either_side_of_it(seed):
    """A push along an axis that falls with the height, or jumps there: from ends beside it or around it."""
    rng = np.random.default_rng(seed)
    axis, at = np.linalg.qr(rng.normal(size=(3, 3)))[0][0], rng.uniform(-400e-6, 400e-6)
    aside = rng.normal(size=3) * 50e-6
    aside -= (aside @ axis) * axis
    asked = []

    def over(height):
        return 300e-6 * (1.0 if height < at else -1.0) if seed % 2 else 0.7 * (at - height)

    def g(x):
        asked.append(float(x @ axis))
        return rng.normal(size=3) @ (np.eye(3) - np.outer(axis, axis)) * 1e-6 + (x @ axis + over(x @ axis)) * axis

    ends = tuple(np.sort(at + rng.uniform(-200e-6, 200e-6, 2)))
    low, high, count = _bounds(g, aside, axis, ends)
    assert low < at <= high
    assert over(low) > 0.0 > over(high)
    assert count == len(asked)
    assert max(np.abs(np.subtract([low, high], ends))) <= 2.0 * max(np.abs(at - np.array(ends)).max(), TOLERANCE)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_there_are_no_bounds_where_a_height_is_further_than_a_tool_is_corrected_at_once(way):
    for far, found in ((0.4 * LONGEST, True), (4.0 * LONGEST, False)):
        low, high, _ = _bounds(lambda x, far=far: way * far * UP, np.zeros(3), UP, (-1e-6, 1e-6))
        assert bool(low < high) == found


def test_begun_anew_it_goes_half_of_the_way_that_the_force_leads_then_a_third_and_a_quarter():
    """From the best place so far, where a force that knows no place leads anywhere and nothing closes in."""
    rng, asked, led = np.random.default_rng(3), [], []

    def bends(x):
        asked.append(np.array(x))
        led.append(rng.normal(size=3) * 20e-6)
        return x + led[-1]

    assert not _by_broyden(bends, np.zeros(3)).agreed
    for times, begun in enumerate((12, 24, 36), start=1):
        best = int(np.argmin([np.abs(each).max() for each in led[:begun]]))
        np.testing.assert_allclose(asked[begun] - asked[best], led[best] / (1 + times), atol=1e-12)
    assert len(asked) == MOST


@pytest.mark.parametrize("seed", range(40))
def test_between_two_ends_it_is_looked_where_interpolation_truncation_and_projection_say(seed):
    """As Oliveira and Takahashi have it (2020): with kappa_1 = 0.2 / (b - a) of the first bracket, kappa_2 = 2."""
    rng = np.random.default_rng(seed)
    length = 1e-3
    a, b = np.sort(rng.uniform(0.0, length, 2))
    over, under = rng.uniform(0.01, 1.0) * 1e-3, -rng.uniform(0.01, 1.0) * 1e-3
    room = (b - a) * rng.uniform(0.5, 2.0)
    half = 0.5 * (a + b)
    straight = (over * b - under * a) / (over - under)
    sign, delta = np.sign(half - straight), 0.2 / length * (b - a) ** 2
    truncated = straight + sign * delta if delta <= abs(half - straight) else half
    radius = max(room - 0.5 * (b - a), 0.0)
    truth = truncated if abs(truncated - half) <= radius else half - sign * radius
    assert _between((a, over), (b, under), room, length) == pytest.approx(truth, abs=1e-15)
    for wrong in ((a, -over), (a, 0.0)):
        assert _between(wrong, (b, under), room, length) == half
    assert _between((a, over), (b, 0.0), room, length) == half


def test_shares_that_hold_the_tool_at_once_are_taken_from_one_look_around():
    """The force jumps in all three directions at ``goal``: places around it to all sides hold the tool between them."""
    goal, asked = np.array([3e-6, -2e-6, 1e-6]), []

    def bends(x):
        asked.append(x)
        return x - 1e-4 * np.sign(x - goal)

    found = _by_shares(bends, goal + 0.1e-6, CLOSE, TURNS)
    assert found.agreed
    assert len(asked) == found.evaluations == len(AROUND)
    held = sum((weight * (bends(place) - place) for place, weight in found.mix), start=np.zeros(3))
    np.testing.assert_allclose(held, 0.0, atol=TOLERANCE)
    assert np.abs(found.x - goal).max() <= CLOSE + 0.1e-6
