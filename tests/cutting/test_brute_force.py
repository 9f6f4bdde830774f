"""The brute force of forces held against closed forms, a quadrature of its own, energy, mirrors and turns.

The numbers of the second half were found by others with other code: where theirs are rounded or coarse, it is said.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.spatial.transform import Rotation
from scipy.stats import qmc

from robomill.cutting.edge import EdgeTerm
from robomill.cutting.tool import Cutter
from tests.cutting.brute_force import UPRIGHT, Cut, Floats, Move, Solid, axis, box, in_tool_axes

MM = 1e-3
#: Al 7075-T6, carbide, dry: N/mm^2 and N/mm (the paper's table, its ref. 190).
KTC, KTE, KRC, KRE, KAC, KAE = 767.01, 27.7, 168.8, 26.6, 222.0, 0.7
AL7075 = (EdgeTerm(1.0, KTC * 1e6, KRC * 1e6, KAC * 1e6), EdgeTerm(0.0, KTE * 1e3, KRE * 1e3, KAE * 1e3))
BLOCK = box((-0.1, -0.1, -0.1), (0.1, 0.1, 0.0))
FEED = np.array([0.05, 0.0, 0.0]) * MM
CUTTERS = {
    "flat": Cutter("flat", 8 * MM, flutes=3),
    "ball": Cutter("ball", 8 * MM, flutes=3),
    "bull": Cutter("bull", 8 * MM, corner_radius=1.5 * MM, flutes=3),
    "chamfer": Cutter("chamfer", 8 * MM, tip_angle=math.radians(90.0), tip_diameter=2 * MM, flutes=3),
}


def at(x: float, y: float, z: float) -> Floats:
    """A point given in mm."""
    return np.array([x, y, z]) * MM


def without(solid: Solid, hole: Solid) -> Solid:
    return lambda x: solid(x) & ~hole(x)


def force(
    cutter: Cutter, depth: float, stock: Solid = BLOCK, before: tuple[Move, ...] = (), k: Floats = UPRIGHT
) -> Floats:
    """Feed along +x, tip ``depth`` mm below the top, in the tool's axes."""
    cut = Cut(stock, before, reach=(depth + 4.0) * MM)
    return in_tool_axes(cut.mean_force(cutter, AL7075, at(0, 0, -depth), FEED, k), FEED, k)


# -- closed forms ------------------------------------------------------------------------------------------------------


def test_slot_of_a_flat_mill() -> None:
    N, a, c = 3, 2.0, 0.05
    expected = [
        -N * a * (KRC * c / 4 + KRE / np.pi),
        N * a * (KTC * c / 4 + KTE / np.pi),
        -N * a * (KAC * c / np.pi + KAE / 2),
    ]
    np.testing.assert_allclose(force(CUTTERS["flat"], 2.0), expected, atol=0.05)


@pytest.mark.parametrize("side", ["climb", "conventional"])
def test_half_immersion(side: str) -> None:
    """Integrals of sin, cos, sin^2, sin cos over a quarter turn, by hand; climb has the part on the right."""
    N, a, c = 3, 2.0, 0.05
    low, high = ((-0.1, -0.1, -0.1), (0.1, 0.0, 0.0)) if side == "climb" else ((-0.1, 0.0, -0.1), (0.1, 0.1, 0.0))
    s = 1.0 if side == "climb" else -1.0
    both, square = 0.5, np.pi / 4
    x = s * (KTC * c * both + KTE) - (KRC * c * square + KRE)
    y = KTC * c * square + KTE + s * (KRC * c * both + KRE)
    z = -(KAC * c + KAE * np.pi / 2)
    np.testing.assert_allclose(
        force(CUTTERS["flat"], 2.0, box(low, high)), N * a / (2 * np.pi) * np.array([x, y, z]), atol=0.05
    )


@pytest.mark.parametrize("depth", [0.5, 2.0, 4.0])
def test_slot_of_a_ball_nose(depth: float) -> None:
    """Over the polar angle kappa of the sphere; the front half of every circle cuts."""
    R, N, c = 4.0, 3, 0.05
    top = math.acos(1.0 - depth / R)

    def over(f: Callable[[float], float]) -> float:
        return float(quad(f, 0.0, top)[0])

    tangential = over(lambda k: KTC * c * math.sin(k) * np.pi / 2 + 2 * KTE)
    inwards = over(lambda k: (KRC * math.sin(k) + KAC * math.cos(k)) * c * math.sin(k) * np.pi / 2) + 2 * over(
        lambda k: KRE * math.sin(k) + KAE * math.cos(k)
    )
    upwards = over(lambda k: 2 * c * math.sin(k) * (KRC * math.cos(k) - KAC * math.sin(k))) + np.pi * over(
        lambda k: KRE * math.cos(k) - KAE * math.sin(k)
    )
    expected = N * R / (2 * np.pi) * np.array([-inwards, tangential, upwards])
    np.testing.assert_allclose(force(CUTTERS["ball"], depth), expected, rtol=1e-3, atol=0.1)


@pytest.mark.parametrize("kind", CUTTERS)
def test_thrust_of_a_plunge(kind: str) -> None:
    """Every length of the profile cuts all round: h = c cos(kappa), and only what stands along the axis is left."""
    cutter, N, c = CUTTERS[kind], 3, 0.05
    feed = np.array([0.0, 0.0, -c]) * MM
    got = Cut(BLOCK, reach=10 * MM).mean_force(cutter, AL7075, at(0, 0, -5), feed)
    face, rho = (1.0, 0.0) if kind == "chamfer" else (4.0 - cutter.corner_radius / MM, cutter.corner_radius / MM)
    thrust = face * (KRC * c + KRE)
    thrust += rho * (KRC * c * np.pi / 4 + KRE - KAC * c / 2 - KAE)
    if kind == "chamfer":
        cosine = math.cos(math.radians(45.0))
        thrust += 3.0 / cosine * cosine * (KRC * c * cosine + KRE - KAC * c * cosine - KAE)
    np.testing.assert_allclose(got, [0.0, 0.0, N * thrust], atol=0.3)


@pytest.mark.parametrize("kind", CUTTERS)
@pytest.mark.parametrize(("A", "B"), [(0, 0), (12, 0), (0, -8), (0, 8), (5, 7)])
def test_chips_are_the_volume_removed(kind: str, A: float, B: float) -> None:
    """h r db dphi over what is engaged is the volume swept anew (with Kt alone: torque x speed = Kt x rate)."""
    cutter, k, way = CUTTERS[kind], axis(A, B), at(5, 0, 0)
    tip = at(0, 0, -3)
    chips = sum(float(b.h @ b.r) * b.share for b in Cut(BLOCK).engaged(cutter, tip, FEED, k))
    low, high = at(-7, -6, -5), at(12, 6, 0)
    x = low + qmc.Sobol(3, rng=1).random_base2(16) * (high - low)
    fresh = Move(cutter, tip, tip + way, k).sweeps(x) & ~Move(cutter, tip - 4 * way, tip, k).sweeps(x)
    removed = np.mean(fresh) * np.prod(high - low) / 5 * 0.05
    assert chips == pytest.approx(removed, rel=0.02)


def test_feed_along_the_axis_is_part_of_the_chip() -> None:
    """Ball nose at B = 10, the axis leaning into the feed: with the feed across the axis alone, h = c sin(phi)
    sin(kappa), a quarter more chip than metal. Such sums give (-89, 177, 93) N, the volume's own law (-81, 153, 85)."""
    cutter, k = CUTTERS["ball"], axis(0.0, 10.0)
    volume = across = 0.0
    for bite in Cut(BLOCK, points=100_000).engaged(cutter, at(0, 0, -2), FEED, k):
        volume += float(bite.h @ bite.r) * bite.share
        across += float((bite.h - bite.normal @ k * (FEED @ k)) @ bite.r) * bite.share
    half = math.acos((4.0 * math.cos(math.radians(10.0)) - 2.0) / 4.0)
    section = 4.0**2 * (half - math.sin(half) * math.cos(half))  # the trail of a sphere is a cylinder
    assert volume == pytest.approx(section * 0.05 * MM**3, rel=2e-3)
    assert across == pytest.approx(1.29 * volume, rel=0.01)
    np.testing.assert_allclose(force(cutter, 2.0, k=k), [-80.8, 153.2, 84.9], atol=0.4)


# -- mirrors and turns -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", CUTTERS)
def test_mirror(kind: str) -> None:
    """A left-hand cutter on mirrored stock feels the mirrored force."""
    right = CUTTERS[kind]
    left = right.replace(hand="left", helix="left")
    low, high = (-0.1, 1 * MM, -0.1), (0.1, 0.1, 0.0)
    mirrored = (-0.1, -0.1, -0.1), (0.1, -1 * MM, 0.0)
    there = force(right, 2.0, box(low, high), k=axis(6.0, 4.0))
    here = force(left, 2.0, box(*mirrored), k=axis(-6.0, 4.0))
    np.testing.assert_allclose(here, there * [1, -1, 1], rtol=2e-3, atol=0.1)
    assert np.abs(there).min() > 0.5


def test_helix_of_the_other_hand_turns_the_pull_alone() -> None:
    flat = CUTTERS["flat"]
    pulled, pushed = force(flat, 2.0), force(flat.replace(helix="left"), 2.0)
    np.testing.assert_allclose(pushed, pulled * [1, 1, -1], atol=1e-9)
    assert pulled[2] < 0.0


@pytest.mark.parametrize("kind", CUTTERS)
def test_turned_in_space(kind: str) -> None:
    """Stock, earlier moves, feed and axis turned together turn the force."""
    cutter, turn = CUTTERS[kind], Rotation.from_rotvec([0.3, -0.5, 1.1])
    k, tip, feed = axis(5.0, 3.0), at(0, 0, -3), 0.05 * MM * np.array([0.9, 0.1, -0.2])
    earlier = at(-30, -2.5, -2), at(30, -1.5, -3)
    here = Cut(BLOCK, (Move(cutter, *earlier, k),)).mean_force(cutter, AL7075, tip, feed, k)
    there = Cut(lambda x: BLOCK(turn.inv().apply(x)), (Move(cutter, *turn.apply(earlier), turn.apply(k)),)).mean_force(
        cutter, AL7075, turn.apply(tip), turn.apply(feed), turn.apply(k)
    )
    np.testing.assert_allclose(turn.inv().apply(there), here, rtol=3e-3, atol=0.2)


def test_own_way_back_is_air() -> None:
    """What lies behind the cutter never counts: n . v > 0 has left the body's own trail."""
    ball, k = CUTTERS["ball"], axis(7.0, -9.0)
    trail = Move(ball, at(-30, 0, -2), at(0, 0, -2), k)
    np.testing.assert_allclose(force(ball, 2.0, BLOCK, (trail,), k), force(ball, 2.0, k=k), rtol=1e-4)
    again = Move(ball, at(-30, 0, -2), at(30, 0, -2), k)
    np.testing.assert_allclose(force(ball, 2.0, BLOCK, (again,), k), 0.0, atol=0.1)


def test_sweep_of_a_ball_is_a_capsule() -> None:
    """Below the centres: distance to the segment; beside them the cylinder, upwards without end."""
    ball, rng = CUTTERS["ball"], np.random.default_rng(2)
    start, end = at(-5, 1, -2), at(6, -3, -1)
    x = at(-12, -10, -8) + rng.random((4_000, 3)) * at(24, 20, 20)
    centre, way = start + at(0, 0, 4), end - start
    s = np.linspace(0.0, 1.0, 301)[:, None, None]
    w = x - (centre + s * way)
    below = np.min(np.where(w[..., 2] <= 0, np.linalg.norm(w, axis=-1), np.inf), axis=0)
    above = np.min(np.where(w[..., 2] > 0, np.hypot(w[..., 0], w[..., 1]), np.inf), axis=0)
    gap = np.minimum(below, above) - 4 * MM
    clear = np.abs(gap) > 5e-5
    np.testing.assert_array_equal(Move(ball, start, end, UPRIGHT).sweeps(x)[clear], gap[clear] <= 0.0)


# -- numbers found by others -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("a_e", "left"), [(0.05, 4.5), (0.1, 6.6), (0.2, 10.0), (0.5, 18.0)])
def test_finishing_shoulder(a_e: float, left: float) -> None:
    """Climb (part on the right), a_p 2 mm, three flutes, 0.05 mm a tooth."""
    part = box((-0.1, -0.1, -0.1), (0.1, (a_e - 4) * MM, 0.0))
    assert force(CUTTERS["flat"], 2.0, part)[1] == pytest.approx(left, abs=0.07)


def test_slot_with_a_half_cut_to_half_depth() -> None:
    """The right half opened 1 mm deep; the other's number: (-70, 68, -18) N."""
    stock = without(BLOCK, box((-0.1, -0.1, -1 * MM), (0.1, 0.0, 0.0)))
    np.testing.assert_allclose(force(CUTTERS["flat"], 2.0, stock), [-70, 68, -18], atol=0.6)


def test_ball_nose_beside_its_own_pass() -> None:
    """1 mm deep, step-over 0.5 mm, climb; the other's (25, 37, 40) N is coarser by 1 N."""
    pass_before = Move(CUTTERS["ball"], at(-50, 0.5, -1), at(50, 0.5, -1), UPRIGHT)
    np.testing.assert_allclose(force(CUTTERS["ball"], 1.0, BLOCK, (pass_before,)), [25, 37.5, 40.5], atol=0.8)


def test_ball_nose_on_a_wall() -> None:
    """a_e 0.5, a_p 6 mm, climb."""
    wall = box((-0.1, -0.1, -0.1), (0.1, -3.5 * MM, 0.0))
    np.testing.assert_allclose(force(CUTTERS["ball"], 6.0, wall), [25, 32, -1], atol=0.6)


@pytest.mark.parametrize(
    ("A", "B", "expected"), [(10, 0, (-41, 128, -24)), (-10, 0, (-88, 96, -24)), (0, 10, (-82.1, 142.9, -29.6))]
)
def test_tilted_flat_mill(A: float, B: float, expected: tuple[float, float, float]) -> None:
    """The tip 2 mm deep; of B = 10 the others give the left force, 142.9 N."""
    np.testing.assert_allclose(force(CUTTERS["flat"], 2.0, k=axis(A, B)), expected, atol=0.6)


def test_tilted_ball_nose() -> None:
    """The other's (-53, 181, 128) N lacks the nose's last 2.3 deg, where db = dz / sin(kappa) is slow to sum over z."""
    np.testing.assert_allclose(force(CUTTERS["ball"], 2.0, k=axis(10, 0)), [-53.1, 185.6, 134.6], atol=0.5)
    np.testing.assert_allclose(force(CUTTERS["ball"], 2.0, k=axis(10, 0)), [-53, 181, 128], atol=8.0)


def test_stock_that_is_not_solid() -> None:
    """A plate of 40 x 2 mm on a stem of 4 mm, slot 6 mm deep; a cavity from 1 mm below the top, slot 2 mm deep."""
    plate = box((-0.1, -20 * MM, -2 * MM), (0.1, 20 * MM, 0.0))
    stem = box((-0.1, -2 * MM, -0.1), (0.1, 2 * MM, 0.0))
    profile = force(CUTTERS["flat"], 6.0, lambda x: plate(x) | stem(x))
    np.testing.assert_allclose(profile, [-130, 233, -46], atol=0.6)
    cavity = box((-0.05, -20 * MM, -5 * MM), (0.05, 20 * MM, -1 * MM))
    assert force(CUTTERS["flat"], 2.0, without(BLOCK, cavity))[1] == pytest.approx(55.2, abs=0.1)
