"""Sag of the tip under the arm's own weight and its payload: a constant offset, joint by joint.

Parts are usually zeroed with the arm sagged, so this is shown and not added to the deviation unless asked for.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, as_floats
from robomill.errors import RobotError
from robomill.kinematics.forward import joint_frames
from robomill.kinematics.jacobian import twists
from robomill.provenance import BY_HAND, Provenance
from robomill.quantities import quantity, settle
from robomill.robot.model import Robot
from robomill.spelled import in_units
from robomill.units import format_count, format_short
from robomill.values import Said, Value

#: Standard gravity in a {M} whose z axis points up, m/s^2.
GRAVITY = (0.0, 0.0, -9.80665)
HEAVIEST = 2e4  # kg: no arm weighs as much: was it meant in g?


@in_units(RobotError, "Weight of the arm")
@dataclass(frozen=True, eq=False, repr=False)
class LinkMasses(Said, Value):
    """mass (n,) kg and centre (n, 3) m of what moves with each free joint, in the frame after it.

    That is the frame of the next joint, and {T} for the last; spindle and tool belong to the last entry.
    Raises RobotError for negative masses or shapes that differ.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.LinkMasses([30.0, 12.0], [[0.2, 0.0, 0.0], [0.1, 0.0, 0.0]]).mass.sum()
    np.float64(42.0)
    """

    mass: FloatArray = quantity("Mass", "kg", shape=(None,), least=0.0, most=HEAVIEST)
    centre: FloatArray = quantity("Centre of mass", "mm", shape=(None, 3), axes="xyz", slip=20.0, tiny=1e-3)
    provenance: Provenance = BY_HAND

    if TYPE_CHECKING:

        def __init__(
            self,
            mass: ArrayLike = ...,
            centre: ArrayLike = ...,
            provenance: Provenance = ...,
            *,
            mass_kg: ArrayLike = ...,
            centre_mm: ArrayLike = ...,
        ) -> None: ...

    def _said(self) -> str:
        return f"{format_short(float(self.mass.sum()), 'kg')} on {format_count(len(self.mass), 'joint')}"

    def __post_init__(self) -> None:
        settle(self, RobotError, "Weight of the arm")
        if len(self.mass) != len(self.centre):
            raise RobotError(
                f"Weight of the arm: found {len(self.mass)} masses and {len(self.centre)} centres of mass; "
                "expected one of each for every joint.",
                where="centre",
            )

    def behind(self, longer: float) -> LinkMasses:
        """The same masses seen from the tip of a tool ``longer`` (m) along z_T: what the last joint carries stays."""
        if longer == 0.0:
            return self
        centre = self.centre.copy()
        centre[-1, 2] += longer
        return replace(self, centre=centre)


def gravity_torques(robot: Robot, theta: ArrayLike, links: LinkMasses, gravity: ArrayLike = GRAVITY) -> FloatArray:
    """tau (..., n) N m (N where prismatic): what the weight of the links does about each joint, in theta's sense."""
    frames = joint_frames(robot, theta)
    columns = _columns(robot, frames, _centres(robot, frames, links))
    weight = links.mass[:, None] * as_floats(gravity, "gravity (m/s^2)", (3,), error=RobotError)
    return np.einsum("...jlk,lk->...j", columns, weight)


def gravity_sag(robot: Robot, theta: ArrayLike, links: LinkMasses) -> FloatArray:
    """Sag of the tip, each joint's share (..., n, 3) m in {M}: J_i C_theta,i tau_i; their sum is the sag."""
    frames = joint_frames(robot, theta)
    tau = gravity_torques(robot, theta, links)
    tip = _columns(robot, frames, frames[..., -1:, :3, 3])[..., 0, :]
    return tip * (robot.C_theta * tau)[..., None]


def _centres(robot: Robot, frames: FloatArray, links: LinkMasses) -> FloatArray:
    """Centres of mass (..., n, 3) in {M}."""
    if len(links.mass) != robot.n:
        raise RobotError(
            f"Link masses: found {len(links.mass)}, expected {robot.n}, one for each free joint of {robot.name!r}.",
            where="mass",
        )
    after = frames[..., 1:, :, :]
    return np.einsum("...lij,lj->...li", after[..., :3, :3], links.centre) + after[..., :3, 3]


def _columns(robot: Robot, frames: FloatArray, points: FloatArray) -> FloatArray:
    """How joint j moves point l, (..., n, l, 3); a joint does not move the points of the links before it.

    With a single point it is the tip, which every joint moves.
    """
    axis = robot.chain.sign[:, None] * frames[..., :-1, :3, 2]
    arm = points[..., None, :, :] - frames[..., :-1, None, :3, 3]
    moved = twists(axis[..., None, :], arm, robot.chain.prismatic[:, None])[..., :3]
    if points.shape[-2] == 1:
        return moved
    carried = np.arange(robot.n)[:, None] <= np.arange(points.shape[-2])
    return np.where(carried[..., None], moved, 0.0)
