"""What stiffer joints would buy: at a point, or along a path.

Compliance is linear in the joint compliances, so a stiffer joint scales its own share and leaves the rest: nothing has
to be computed again, and the answers are exact, not estimates.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, IntArray, as_floats
from robomill.errors import KinematicsError
from robomill.provenance import GIVEN, MADE_UP, Provenance
from robomill.robot.model import Robot
from robomill.robot.sources import COMPLIANCE, block_in_force

STIFFER = 1.1  # the usual question: 10 % stiffer
MADE_STIFFER = "; joints made stiffer"


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """What ``STIFFER`` times the stiffness of each joint alone buys.

    before (...,): the measure as it is (SI); gain (..., n): how much smaller it becomes with joint i stiffer (positive
    is better); ranking (n,): joints, 0-based, by their mean gain, best first; joint_numbers
    names them as the robot does.
    """

    before: FloatArray
    gain: FloatArray
    ranking: IntArray
    joint_numbers: tuple[int, ...]

    @property
    def mean(self) -> FloatArray:
        """(n,) mean gain over what is known; NaN where nothing is."""
        return mean_known(self.gain)


def mean_known(gain: FloatArray) -> FloatArray:
    """(n,) mean of ``gain`` (..., n) over the places where every joint's is known; NaN where there is none."""
    flat = gain.reshape(-1, gain.shape[-1])
    known = np.isfinite(flat).all(axis=1)
    return np.asarray(flat[known].mean(axis=0)) if known.any() else np.full(gain.shape[-1], np.nan)


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


def deflection_sensitivity(delta_joint: ArrayLike, joint_numbers: tuple[int, ...] = ()) -> Sensitivity:
    """What a stiffer joint takes off the deviation's size, for delta_joint (..., n, 3) m at a point or on a path."""
    delta_joint = as_floats(delta_joint, "delta_joint", (None, 3), error=KinematicsError, finite=False)
    return _sensitivity(delta_joint, joint_numbers)


def _sensitivity(parts: FloatArray, joint_numbers: tuple[int, ...]) -> Sensitivity:
    """From vectors parts (..., n, d) whose sum over joints is the vector the measure is the length of."""
    whole = parts.sum(axis=-2)
    before = np.linalg.norm(whole, axis=-1)
    after = np.linalg.norm(whole[..., None, :] - (1.0 - 1.0 / STIFFER) * parts, axis=-1)
    gain = before[..., None] - after
    ranking = np.argsort(-mean_known(gain), kind="stable")
    return Sensitivity(before, gain, ranking, joint_numbers or tuple(range(1, gain.shape[-1] + 1)))


def _above_zero(factors: ArrayLike, shape: tuple[int, ...]) -> FloatArray:
    checked = as_floats(factors, "stiffness factors", shape, error=KinematicsError)
    if (checked <= 0).any():
        raise KinematicsError("stiffness factors: expected numbers above zero (1.1 is 10 % stiffer).")
    return checked
