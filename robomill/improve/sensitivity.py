"""What stiffer joints would buy: at a point, or along a path.

Compliance is linear in the joint compliances, so a stiffer joint scales its own share and leaves the rest: nothing has
to be computed again, and the answers are exact, not estimates.
"""

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, as_floats
from robomill.errors import KinematicsError
from robomill.provenance import GIVEN, MADE_UP, Provenance
from robomill.robot.arm import COMPLIANCE
from robomill.robot.model import Robot
from robomill.robot.sources import block_in_force

STIFFER = 1.1  # the usual question: 10 % stiffer
MADE_STIFFER = "; joints made stiffer"


def stiffened(robot: Robot, factors: ArrayLike) -> Robot:
    """The robot with each free joint's stiffness multiplied by ``factors`` (n,) > 0; one number serves all.

    What was assumed stays so.
    """
    C_theta = robot.C_theta / np.broadcast_to(_above_zero(factors, ()), (robot.n,))
    found = robot.provenance.get(block_in_force(robot), GIVEN)
    source = f"{found.source.removesuffix(MADE_STIFFER)}{MADE_STIFFER}"
    said = Provenance(found.kind if found.kind in MADE_UP else "user", source)
    return robot.replace(C_theta=C_theta, provenance={COMPLIANCE: said})


def scaled_shares(shares: ArrayLike, factors: ArrayLike, axis: int) -> FloatArray:
    """Joint shares of anything linear in C_theta (C_joint, delta_joint, a field's shares) with stiffer joints.

    ``axis`` is the joint axis of ``shares``; factors (n,) multiply the stiffness.
    """
    shares = np.asarray(shares, dtype=np.float64)
    shape = [1] * shares.ndim
    shape[axis] = -1
    return shares / _above_zero(factors, (shares.shape[axis],)).reshape(shape)


def gain(parts: FloatArray) -> FloatArray:
    """(..., n) m: how much shorter the sum of ``parts`` (..., n, 3) m, of which each goes with the compliance of one
    joint, becomes with that joint alone ``STIFFER`` times as stiff (positive is better)."""
    whole = parts.sum(axis=-2)
    after = np.linalg.norm(whole[..., None, :] - (1.0 - 1.0 / STIFFER) * parts, axis=-1)
    return np.asarray(np.linalg.norm(whole, axis=-1)[..., None] - after)


def _above_zero(factors: ArrayLike, shape: tuple[int, ...]) -> FloatArray:
    checked = as_floats(factors, "stiffness factors", shape, error=KinematicsError)
    if (checked <= 0).any():
        raise KinematicsError("stiffness factors: expected numbers above zero (1.1 is 10 % stiffer).")
    return checked
