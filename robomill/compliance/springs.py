"""What gives beside the joints: tool, spindle, bending of bearings and links. Each spring is a line of its own.

Every spring turns the joint frames of a configuration into its own translational compliance of the tip in {M}.
They act in series with the joints, so contributions and deflections simply add.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, as_floats
from robomill.errors import RobotError
from robomill.kinematics.forward import joint_frames
from robomill.provenance import Provenance
from robomill.robot.model import Robot
from robomill.units import format_si

#: Young's modulus of solid carbide, Pa.
E_CARBIDE = 600e9
#: Bending diameter of a fluted cutter over its outer diameter.
FLUTED_CORE = 0.8
CARBIDE = Provenance("assumed", "cantilever of solid carbide, E = 600 GPa, bending diameter 0.8 of the cutter's")
ASSUMED = Provenance("assumed", "entered without a source")


class Spring:
    """Something in series with the joints; its children say how it gives (``contribution``)."""

    @property
    def name(self) -> str:
        """What the result calls its line."""
        raise NotImplementedError

    @property
    def provenance(self) -> Provenance:
        """Where its stiffness comes from."""
        raise NotImplementedError

    def contribution(self, frames: ArrayLike) -> FloatArray:
        """C (..., 3, 3) m/N in {M} from joint frames (..., n + 1, 4, 4) in {M}; the last frame is {T}."""
        raise NotImplementedError

    def compliance(self, robot: Robot, theta: ArrayLike) -> FloatArray:
        """C (..., 3, 3) m/N in {M} at the configurations theta (..., n)."""
        return self.contribution(joint_frames(robot, theta))


@dataclass(frozen=True)
class ToolBending(Spring):
    """The cutter as a cantilever: delta = F L^3 / (3 E I) across its axis, rigid along it.

    diameter m, stick_out L m, E Pa; the bending diameter is ``core`` times the diameter (flutes weaken it).
    Raises RobotError unless all are greater than 0 (and core at most 1).
    """

    diameter: float
    stick_out: float
    E: float = E_CARBIDE
    core: float = FLUTED_CORE
    name: str = "tool bending"
    provenance: Provenance = CARBIDE

    def __post_init__(self) -> None:
        for field, unit in (("diameter", "mm"), ("stick_out", "mm"), ("E", "N/mm2"), ("core", "1")):
            _positive(self, field, unit)
        if self.core > 1.0:
            raise RobotError(f"Tool bending: core is {self.core:g}; it is a share of the diameter, at most 1.")
        if self.provenance == CARBIDE and (self.E, self.core) != (E_CARBIDE, FLUTED_CORE):
            words = f"cantilever, E = {self.E:.4g} N/m^2, bending diameter {self.core:g} of the cutter's"
            object.__setattr__(self, "provenance", Provenance("user", words))

    @property
    def lateral(self) -> float:
        """Compliance across the axis, m/N: L^3 / (3 E I)."""
        second_moment = math.pi / 64.0 * (self.core * self.diameter) ** 4
        return self.stick_out**3 / (3.0 * self.E * second_moment)

    def contribution(self, frames: ArrayLike) -> FloatArray:
        """C (..., 3, 3) m/N in {M}."""
        return _about_tool(frames, self.lateral, 0.0)


@dataclass(frozen=True)
class SpindleSpring(Spring):
    """Spindle, holder and their bearings as springs at the tip: ``lateral`` and ``axial`` compliance, m/N."""

    lateral: float
    axial: float = 0.0
    name: str = "spindle and holder"
    provenance: Provenance = ASSUMED

    def __post_init__(self) -> None:
        for field in ("lateral", "axial"):
            _not_negative(self, field, "um/N")

    def contribution(self, frames: ArrayLike) -> FloatArray:
        """C (..., 3, 3) m/N in {M}."""
        return _about_tool(frames, self.lateral, self.axial)


@dataclass(frozen=True)
class JointBending(Spring):
    """Tilting of joint ``joint`` (1-based among the free joints) about the x and y axes of its frame, rad/(N m).

    The frame is the one before the joint turns, so the axes stay with the link that carries the bearing.
    The joint's own z axis is the robot's C_theta.
    """

    joint: int
    C_x: float = 0.0
    C_y: float = 0.0
    provenance: Provenance = ASSUMED

    def __post_init__(self) -> None:
        if isinstance(self.joint, bool) or not isinstance(self.joint, int) or self.joint < 1:
            raise RobotError(f"Joint bending: joint is {self.joint!r}; expected a number from 1.", where="joint")
        for field in ("C_x", "C_y"):
            _not_negative(self, field, "1e-7 rad/(N m)")

    @property
    def name(self) -> str:
        """E.g. ``"joint 2 bending"``."""
        return f"joint {self.joint} bending"

    def contribution(self, frames: ArrayLike) -> FloatArray:
        """C (..., 3, 3) m/N in {M}: the sum over both axes of C_axis J J^T with J = axis x (tip - origin)."""
        frames = _frames(frames)
        n = frames.shape[-3] - 1
        if self.joint > n:
            raise RobotError(f"Joint bending: there is no joint {self.joint}; the robot has {n}.", where="joint")
        frame = frames[..., self.joint - 1, :, :]
        reach = frames[..., -1, :3, 3] - frame[..., :3, 3]
        C = np.zeros((*frames.shape[:-3], 3, 3))
        for axis, compliance in ((0, self.C_x), (1, self.C_y)):
            column = np.cross(frame[..., :3, axis], reach)
            C += compliance * column[..., :, None] * column[..., None, :]
        return C


def extra_contributions(springs: Sequence[Spring], frames: ArrayLike) -> FloatArray:
    """C_extra (..., k, 3, 3) m/N in {M}, one a spring in their order; k may be 0.

    ``frames`` (..., n + 1, 4, 4) as ``joint_frames`` gives them (NaN where not reached stays NaN). The result goes
    through ``deflection`` as the joints' C_joint does, so every spring has its own line.
    """
    frames = _frames(frames)
    if not springs:
        return np.zeros((*frames.shape[:-3], 0, 3, 3))
    return np.stack([spring.contribution(frames) for spring in springs], axis=-3)


def _about_tool(frames: ArrayLike, lateral: float, axial: float) -> FloatArray:
    """lateral (1 - z z^T) + axial z z^T with the tool axis z_T of the last frame."""
    z = _frames(frames)[..., -1, :3, 2]
    along = z[..., :, None] * z[..., None, :]
    return lateral * (np.eye(3) - along) + axial * along


def _frames(frames: ArrayLike) -> FloatArray:
    return as_floats(frames, "joint frames", (None, 4, 4), error=RobotError, finite=False)


def _number(spring: Spring, field: str) -> float:
    value = getattr(spring, field)
    try:
        number = float(value)
    except (TypeError, ValueError) as exc:
        message = f"{spring.name.capitalize()}: {field} should be a number, found {value!r:.40}."
        raise RobotError(message, where=field) from exc
    if not math.isfinite(number):
        raise RobotError(f"{spring.name.capitalize()}: {field} should be finite, found {number}.", where=field)
    object.__setattr__(spring, field, number)
    return number


def _positive(spring: Spring, field: str, unit: str) -> None:
    number = _number(spring, field)
    if number <= 0.0:
        shown = format_si(number, unit)
        message = f"{spring.name.capitalize()}: {field} is {shown}; it must be greater than 0."
        raise RobotError(message, where=field)


def _not_negative(spring: Spring, field: str, unit: str) -> None:
    number = _number(spring, field)
    if number < 0.0:
        shown = format_si(number, unit)
        message = f"{spring.name.capitalize()}: {field} is {shown}; it cannot be negative (0 is rigid)."
        raise RobotError(message, where=field)
