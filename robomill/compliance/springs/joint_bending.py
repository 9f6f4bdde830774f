"""Tilting of a joint's bearing and link."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray
from robomill.compliance.cartesian import joint_contributions
from robomill.compliance.spring import ASSUMED, Spring, checked_frames
from robomill.errors import RobotError
from robomill.kinematics.jacobian import twists
from robomill.provenance import Provenance
from robomill.quantities import quantity, switch, whole
from robomill.robot.arm import UNIT_SLIP
from robomill.spelled import in_units

STIFFEST = 1e-12  # rad/(N m): nothing gives as little without being called rigid
UNIT = "1e-7 rad/(N m)"


def bending_axes(frames: FloatArray, i: int, turned: bool) -> tuple[FloatArray, FloatArray]:
    """Unit axes x and y (..., 3) about which joint ``i`` (from 0) tilts, from the joint frames (..., n + 1, 4, 4)."""
    if not turned:
        return frames[..., i, :3, 0], frames[..., i, :3, 1]
    z, x = frames[..., i, :3, 2], frames[..., i + 1, :3, 0]
    x = x - np.einsum("...i,...i->...", x, z)[..., None] * z
    size = np.linalg.norm(x, axis=-1, keepdims=True)
    x = np.where(size > 1e-9, x / np.maximum(size, 1e-9), frames[..., i + 1, :3, 1])  # next x along z: its y is across
    return x, np.cross(z, x)


def _bending(axis: str) -> Any:
    key = f"C_{axis}_1e-7_rad_per_Nm"
    return quantity(f"about {axis}", UNIT, default=0.0, least=0.0, key=key, slip=UNIT_SLIP, tiny=STIFFEST)


@in_units(RobotError, "Bending of a joint")
@dataclass(frozen=True, repr=False)
class JointBending(Spring):
    """Tilting of joint ``joint`` (1-based among the free joints) about the x and y axes of its frame, rad/(N m).

    The frame is the one before the joint turns, so the axes stay with the link that carries the bearing; ``turned``,
    they stay with the link that the joint moves, x being that of the next frame, seen along the joint's axis.
    The joint's own z axis is the robot's C_theta.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.JointBending(2, C_x=3e-7).name
    'joint 2 bending'
    """

    kind: ClassVar[str] = "joint_bending"
    title: ClassVar[str] = "Bending of joints"
    hint: ClassVar[str | None] = "Tilting of a joint's bearing and link about the x and y axes of its frame."
    rank: ClassVar[int] = 3
    each_joint: ClassVar[bool] = True

    joint: int = whole("Joint", least=1)
    C_x: float = _bending("x")
    C_y: float = _bending("y")
    provenance: Provenance = ASSUMED
    turned: bool = switch("Axes turn with the joint", default=False)

    if TYPE_CHECKING:

        def __init__(
            self,
            joint: int,
            C_x: float = ...,
            C_y: float = ...,
            provenance: Provenance = ...,
            turned: bool = ...,
            *,
            C_x_1e_7_rad_per_Nm: float = ...,
            C_y_1e_7_rad_per_Nm: float = ...,
        ) -> None: ...

    @property
    def name(self) -> str:
        """E.g. ``"joint 2 bending"``."""
        return f"joint {self.joint} bending"

    def contribution(self, frames: ArrayLike) -> FloatArray:
        """C (..., 3, 3) m/N in {M}: the sum over both axes of C_axis J J^T with J = axis x (tip - origin)."""
        frames = checked_frames(frames)
        n = frames.shape[-3] - 1
        if self.joint > n:
            raise RobotError(f"Joint bending: there is no joint {self.joint}; the robot has {n}.", where="joint")
        frame = frames[..., self.joint - 1, :, :]
        reach = frames[..., -1, :3, 3] - frame[..., :3, 3]
        J = np.stack([twists(axis, reach) for axis in bending_axes(frames, self.joint - 1, self.turned)], axis=-1)
        return joint_contributions(J[..., :3, :], [self.C_x, self.C_y]).sum(axis=-3)
