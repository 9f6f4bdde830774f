"""Engagement against geometry: air, entry, slot, half immersion, earlier passes, exit."""

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.surface.engagement import engage
from robomill.surface.stock import Stock

R = 0.004
FLAT = Cutter("flat", 2 * R)
CELL = 1e-4
STOCK = Stock((0.0, -0.02, -0.01), (0.04, 0.02, 0.0))


def line(a, b, step=5e-4):
    a, b = np.asarray(a, float), np.asarray(b, float)
    n = int(np.ceil(np.linalg.norm(b - a) / step))
    return a + np.linspace(0, 1, n + 1)[:, None] * (b - a)


def degrees(found, x, p, at):
    """phi_st, phi_ex in degrees of the step whose middle is nearest to x = at."""
    middle = 0.5 * (x[1:] + x[:-1])
    n = int(np.argmin(np.abs(middle - at))) + 1
    return np.degrees(found.phi_st[n]), np.degrees(found.phi_ex[n]), found.a_p[n], found.a_e[n]


def run(p, stock=STOCK, cutter=FLAT, k=None, cutting=None):
    return engage(stock, CELL, cutter, p, k, cutting)


def test_air_entry_slot_and_exit():
    p = line([-0.01, 0, -0.002], [0.05, 0, -0.002])
    found = run(p)
    middle = 0.5 * (p[1:, 0] + p[:-1, 0])
    air = np.append(False, (middle < -R - 2e-4) | (middle > 0.04))
    assert (found.phi_st[air] == 0).all()
    assert (found.phi_ex[air] == 0).all()
    assert (found.a_p[air] == 0).all()
    assert degrees(found, p[:, 0], p, 0.02) == pytest.approx((0.0, 180.0, 0.002, 0.008))
    # entering, the arc ahead of the stock's face x = 0 is open: half angle acos(distance / R) about 90 degrees
    # (near 0 and 180 degrees, where the chip has no thickness, material is seen a little early)
    for at, tolerance in ((-0.00325, 6.0), (-0.00225, 6.0), (-0.00125, 12.0)):
        half = np.degrees(np.arccos(-at / R))
        st, ex, a_p, _ = degrees(found, p[:, 0], p, at)
        assert (st, ex) == pytest.approx((90 - half, 90 + half), abs=tolerance)
        assert a_p == pytest.approx(0.002)
    rising = found.a_e[(np.append(0, middle) > -R) & (np.append(0, middle) < 0)]
    assert (np.diff(rising) >= 0).all()


@pytest.mark.parametrize("angle", [0.0, 90.0, 37.0])
def test_half_and_quarter_immersion(angle):
    """A block edge along the feed: material only on the right (or left) of a line."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    stock = Stock((-0.03, -0.03, -0.01), (0.03, 0.03, 0.0))
    first = line([-0.05, 0.0, -0.002], [0.05, 0.0, -0.002]) @ turn.T
    for offset, st, ex in ((-R, 90.0, 180.0), (R, 0.0, 90.0), (-R / 2, 120.0, 180.0)):
        # an earlier pass has cleared y > -R .. R about y = 0; the second runs beside it
        second = line([-0.05, offset, -0.002], [0.05, offset, -0.002]) @ turn.T
        p = np.vstack([first, second])
        cutting = np.ones(len(p), bool)
        cutting[len(first)] = False
        found = run(p, stock, cutting=cutting)
        middle = len(first) + len(second) // 2
        expected_st, expected_ex = (st, ex) if abs(offset) == R else (120.0, 180.0)
        assert np.degrees(found.phi_st[middle]) == pytest.approx(expected_st, abs=3.0)
        assert np.degrees(found.phi_ex[middle]) == pytest.approx(expected_ex, abs=3.0)
        width = R if abs(offset) == R else R / 2
        assert found.a_e[middle] == pytest.approx(width, abs=2 * CELL)


def test_a_second_pass_in_the_same_slot_is_air():
    first = line([-0.01, 0, -0.002], [0.05, 0, -0.002])
    found = run(np.vstack([first, first[::-1]]))
    back = slice(len(first) + 1, None)
    assert found.a_p[: len(first)].max() == pytest.approx(0.002)
    assert (found.a_p[back] == 0).all()
    assert (found.phi_ex[back] == 0).all()


def test_second_depth_meets_only_what_is_left():
    first = line([-0.01, 0, -0.002], [0.05, 0, -0.002])
    second = first[::-1] - np.array([0, 0, 0.001])
    found = run(np.vstack([first, second]), cutting=np.arange(2 * len(first)) != len(first))
    n = len(first) + len(first) // 2
    assert found.a_p[n] == pytest.approx(0.001)
    assert np.degrees(found.phi_ex[n]) == 180.0


def test_stepped_stock_gives_the_mean_depth():
    """Right half 2 mm deep, left half cleared to 1 mm: an arc of 180 degrees with 1.5 mm on average."""
    clear = line([-0.02, R, -0.001], [0.06, R, -0.001])
    clear2 = line([0.06, R + 2e-3, -0.001], [-0.02, R + 2e-3, -0.001])
    slot = line([-0.02, 0, -0.002], [0.06, 0, -0.002])
    p = np.vstack([clear, clear2, slot])
    found = run(p)
    n = len(clear) + len(clear2) + len(slot) // 2
    assert np.degrees([found.phi_st[n], found.phi_ex[n]]) == pytest.approx([0.0, 180.0])
    assert found.a_p[n] == pytest.approx(0.0015, abs=3e-5)


def test_plunge_has_no_arc():
    found = run(line([0.02, 0, 0.003], [0.02, 0, -0.003]))
    assert (found.phi_ex == 0).all()
    assert (found.a_p == 0).all()


def test_ball_engages_at_its_effective_radius():
    p = line([-0.01, 0, -0.001], [0.05, 0, -0.001])
    found = run(p, cutter=Cutter("ball", 2 * R))
    n = len(p) // 2
    assert np.degrees([found.phi_st[n], found.phi_ex[n]]) == pytest.approx([0.0, 180.0])
    assert found.a_p[n] == pytest.approx(0.001, rel=1e-6)
    assert found.a_e[n] == pytest.approx(2 * np.sqrt(2 * R * 1e-3 - 1e-6), rel=0.02)


def test_unreached_steps_do_not_engage():
    p = line([-0.01, 0, -0.002], [0.05, 0, -0.002])
    p[40] = np.nan
    found = run(p)
    assert found.a_p[40] == found.a_p[41] == 0
    assert found.a_p[39] > 0
