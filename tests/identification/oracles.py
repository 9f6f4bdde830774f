"""Answers computed another way, for the tests of identification and of what is built on it."""

from __future__ import annotations

import numpy as np

from robomill.identification.fit.models import Model
from robomill.identification.knowledge import Knowledge
from robomill.kinematics.jacobian import geometric_jacobian


def guessed(robot, compliance=0.0, force=0.0, length=0.0):
    """Independent uncertainties by hand: a share of each joint compliance, N of each force component, m."""
    covariance = np.diag((np.broadcast_to(compliance, (robot.n,)) * robot.C_theta) ** 2)
    F = np.diag(np.broadcast_to(np.asarray(force, dtype=float), (3,)) ** 2)
    return Knowledge(Model(), robot.C_theta, covariance, F=F, lengths=np.full(2 * robot.rows, length))


def monte_carlo(robot, theta, F, known, draws, seed):
    """delta (draws, ..., 3) m of the joint model with everything unsure drawn at random, compliances not below zero."""
    rng = np.random.default_rng(seed)
    theta, F = np.asarray(theta, dtype=float), np.asarray(F, dtype=float)
    C_theta = np.clip(known.parameters + normal(rng, known.covariance, draws), 0.0, None)
    push = np.zeros((draws, 3)) if known.F is None else normal(rng, known.F, draws)
    lengths = np.zeros(2 * robot.rows) if known.lengths is None else known.lengths
    drawn = np.empty((draws, *np.broadcast_shapes(theta.shape[:-1], F.shape[:-1]), 3))
    J_v = geometric_jacobian(robot, theta)[..., :3, :]
    for k in range(draws):
        if lengths.any():
            change = lengths * rng.standard_normal(2 * robot.rows)
            arm = robot.replace(a=robot.a + change[: robot.rows], d=robot.d + change[robot.rows :])
            J_v = geometric_jacobian(arm, theta)[..., :3, :]
        torque = np.einsum("...ij,...i->...j", J_v, F + push[k])
        drawn[k] = np.einsum("...ij,...j->...i", J_v, C_theta[k] * torque)
    return drawn


def normal(rng, covariance, draws):
    """(draws, k) from a covariance that may be singular."""
    values, vectors = np.linalg.eigh(covariance)
    return rng.standard_normal((draws, len(values))) @ (vectors * np.sqrt(np.clip(values, 0.0, None))).T
