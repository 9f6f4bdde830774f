"""Deflection and cut found together, against root finding with a force and a compliance of their own.

Every pass is straight and long, so in its middle the deflected tip stands where delta = C F(delta): F by brute force
in what the earlier, deflected passes left, C from the paper's Denavit-Hartenberg table and numeric derivatives.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.optimize import least_squares

import robomill as rm
from robomill.cutting.unjudged import Unjudged
from robomill.simulation.run import kept_to_path
from tests.cutting.brute_force import UPRIGHT, Cut, Floats, Move
from tests.simulation.cuts import AL7075, BALL, FEED, FLAT, MM, CutCase, along_x, shoulder

#: Table 2 of the paper, rad/(N m); the lengths a_2, d_4, a_5 are the reconstruction's, m.
C_THETA = np.array([7.14, 10.12, 12.30, 17.32, 91.35]) * 1e-7
A_2, D_4, A_5 = 1.220, 1.100, 0.300
QUARTER = 0.5 * np.pi


def _link(theta: float, d: float, a: float, alpha: float) -> Floats:
    c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    return np.array([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]])


def _tip(theta: Floats) -> Floats:
    """Tip, and the axis x_5 that points down the tool, (6,)."""
    T = (
        _link(theta[0] - QUARTER, 0, 0, QUARTER)
        @ _link(theta[1] + QUARTER, 0, A_2, 0)
        @ _link(theta[2], 0, 0, QUARTER)
        @ _link(-theta[3], D_4, 0, -QUARTER)
        @ _link(theta[4] + np.pi, 0, A_5, 0)
    )
    return np.concatenate([T[:3, 3], T[:3, 0]])


@cache
def compliance(x: float, y: float, z: float) -> Floats:
    wanted = np.array([x, y, z, 0.0, 0.0, -1.0])
    theta = least_squares(lambda t: _tip(t) - wanted, np.deg2rad([0, -26, -20, 0, 46]), xtol=1e-15, gtol=1e-15).x
    J = np.array([(_tip(theta + e)[:3] - _tip(theta - e)[:3]) / 2e-6 for e in 1e-6 * np.eye(5)]).T
    return J @ np.diag(C_THETA) @ J.T


def marched(case: CutCase) -> Floats:
    """Deflection (3,) m in the middle of the last pass, pass after pass."""
    before: tuple[Move, ...] = ()
    for each in case.passes:
        a, b = (np.array(p) * MM for p in each.points)
        tip = np.array([0.0, a[1], a[2]])
        C = compliance(*(tip + np.array([0.0, -1.3, 0.0])))
        cut = Cut(case.block(), before, reach=1.5 * abs(a[2]) + MM, points=60_000)
        feed = FEED * (b - a) / np.linalg.norm(b - a)
        delta = np.zeros(3)
        for _ in range(40):  # halved steps: a climbing cut swings about its root
            delta = 0.5 * (delta + C @ cut.mean_force(case.cutter, AL7075, tip + delta, feed))
        before += (Move(case.cutter, a + delta, b + delta, UPRIGHT),)
    return delta


CLIMB, CONVENTIONAL = shoulder(5.0), shoulder(5.0, climb=False)
COUPLED = (
    CLIMB,
    CONVENTIONAL,
    shoulder(0.5, climb=False),
    CutCase("slot", FLAT, (along_x(0, -2, 30),)),
    CutCase("step-over to the left", FLAT, (along_x(0, -2, 30), along_x(5, -2, 30))),
    CutCase("step-over to the right", FLAT, (along_x(0, -2, 30), along_x(-5, -2, 30))),
    CutCase("own slot again", FLAT, (along_x(0, -2, 30), along_x(0, -2, 30))),
    CutCase("second depth", FLAT, (along_x(0, -1, 30), along_x(0, -2, 30))),
    CutCase("ball beside its own pass", BALL, (along_x(0, -1, 30), along_x(1, -1, 30))),
)


@pytest.mark.parametrize("case", COUPLED, ids=lambda case: case.name)
def test_coupled_pass(case: CutCase) -> None:
    result = rm.simulate(case.setup(1.0).replace(coupling=True))
    path = result.path
    middle = np.flatnonzero(path.cutting & (np.abs(path.p[:, 0]) < 0.6 * MM))[-1]
    np.testing.assert_allclose(result.delta[middle], marched(case), atol=1e-6)


def test_kept_to_its_path_a_coupled_run_has_the_force_of_what_is_told_and_what_did_not_agree_is_known() -> None:
    """A level slot: the force of a run without coupling; what nobody has a force for stays unknown."""
    setup = rm.load_setup("paper_flute/setup_process").replace(step=10e-3, coupling=True)
    run, plain = rm.simulate(setup), rm.simulate(setup.replace(coupling=False))
    cut = np.flatnonzero(run.path.cutting)
    where = np.zeros((2, len(run.path)), dtype=bool)
    where[0, cut[2:4]] = where[1, cut[5]] = True
    unjudged = (Unjudged("coupling", where[0], "open"), Unjudged("layers", where[1], "not known"))
    kept = kept_to_path(replace(run, unjudged=unjudged, delta=np.where(where.any(axis=0)[:, None], np.nan, run.delta)))
    assert [each.code for each in kept.unjudged] == ["layers"]
    assert np.flatnonzero(~np.isfinite(kept.delta[:, 0]) & run.path.cutting).tolist() == [cut[5]]
    np.testing.assert_allclose(kept.F, plain.F, rtol=1e-12)
    known = run.path.cutting & ~where[1]
    np.testing.assert_allclose(kept.delta[known], plain.delta[known], rtol=1e-12)
    assert np.abs(run.F - plain.F).max() > 1.0
