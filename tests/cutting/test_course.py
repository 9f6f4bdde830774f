"""The force over a pitch: its mean, its peak, and what the helix does to both."""

import math

import numpy as np
import pytest

from robomill.cutting.conditions import CutConditions
from robomill.cutting.course import Course
from robomill.cutting.course import force_over_pitch as over_pitch
from robomill.cutting.edge import mean_force
from robomill.cutting.forces.mechanistic import MechanisticForce
from tests.cutting.cutters import CHIP, CUTTERS, MILL, REF190, SLOT


def force_over_pitch(terms, cutter, c, a_p, arc, instants=120):
    """The course of one arc over the whole depth, (instants, 3) N."""
    course = Course(np.array([c]), np.array([[1.0, 0.0]]), np.array([arc]), np.array([[[a_p, 0.0, a_p, 0.0]]]))
    return over_pitch(terms, cutter, course, instants)[0]


@pytest.mark.parametrize("cutter", CUTTERS, ids=lambda c: c.kind)
def test_mean_over_a_pitch_is_the_mean_force(cutter):
    turns = force_over_pitch(REF190.terms, cutter, CHIP, 2e-3, (0.3, 2.2), instants=720)
    exact = mean_force(REF190.terms, cutter, CHIP, 2e-3, 0.3, 2.2)
    assert np.linalg.norm(turns.mean(0) - exact) < 2e-3 * np.linalg.norm(exact)


def test_peak_of_one_straight_tooth_in_a_slot():
    """One straight tooth: F_y = a (Ktc c sin^2 + Kte sin - Krc c sin cos - Kre cos), searched on a fine grid."""
    mill = MILL.replace(flutes=1, helix_angle=0.0)
    conditions = CutConditions.steady(0.01, 200.0, 2e-3)
    peak = MechanisticForce(mill, REF190).peak(conditions)
    phi = np.linspace(0, np.pi, 20001)
    F_t = 2e-3 * (REF190.Ktc * CHIP * np.sin(phi) + REF190.Kte)
    F_r = 2e-3 * (REF190.Krc * CHIP * np.sin(phi) + REF190.Kre)
    F_y = F_t * np.sin(phi) - F_r * np.cos(phi)
    assert peak.high[0, 1] == pytest.approx(F_y.max(), rel=2e-3)
    assert np.linalg.norm(peak.at_peak[0]) == pytest.approx(np.hypot(F_t, F_r).max(), rel=2e-3)


def test_peak_is_at_least_the_mean_and_helix_smooths_it():
    force = MechanisticForce(MILL, REF190)
    mean, peak = force.components(SLOT), force.peak(SLOT)
    assert (peak.high >= mean).all()
    assert (peak.low <= mean).all()
    steep = MechanisticForce(MILL.replace(helix_angle=math.radians(60)), REF190).peak(SLOT)
    assert steep.high[0, 1] < peak.high[0, 1]


@pytest.mark.parametrize(("helix", "first", "last"), [("right", 1.0, 1.1 + 0.5774), ("left", 1.0 - 0.5774, 1.1)])
def test_the_upper_edge_lags_on_a_pulling_helix_and_leads_on_a_pushing_one(helix, first, last):
    mill = MILL.replace(flutes=1, helix=helix)  # 30 deg: the edge turns by tan(30 deg) over 4 mm
    force = force_over_pitch(REF190.terms, mill, CHIP, 4e-3, (1.0, 1.1), instants=1440)
    turn = (np.arange(1440) + 0.5) * 2 * np.pi / 1440
    cuts = turn[np.abs(force).sum(1) > 0]
    assert (cuts.min(), cuts.max()) == pytest.approx((first, last), abs=0.02)


def test_left_hand_cutter_is_the_mirror_image_at_every_instant():
    arc = (0.2, 1.7)
    mirrored = (np.pi - arc[1], np.pi - arc[0])
    left = MILL.replace(hand="left", helix="left")
    turns = [force_over_pitch(REF190.terms, *case) for case in ((MILL, CHIP, 2e-3, arc), (left, CHIP, 2e-3, mirrored))]
    np.testing.assert_allclose(turns[1], turns[0] * [1, -1, 1], atol=1e-12)
