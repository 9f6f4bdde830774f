"""A measured map against the joint model, at the measured points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.cartesian import cartesian_compliance
from robomill.identification.measured_field import MeasuredField
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import pose_from_world
from robomill.lazy import cached_property
from robomill.robot.model import Robot


@dataclass(frozen=True, eq=False)
class MapCheck:
    """Measured C and the joint model's (k, 3, 3) m/N at the measured poses, the latter NaN where not reached."""

    measured: FloatArray
    model: FloatArray

    @classmethod
    def of(cls, field: MeasuredField, robot: Robot) -> MapCheck:
        """The map at its own points beside the model of ``robot``."""
        solved = inverse_kinematics(robot, pose_from_world(np.concatenate([field.p, field.AB], axis=1)))
        return cls(field.C, cartesian_compliance(robot, solved.theta))

    @cached_property
    def gap(self) -> FloatArray:
        """(k,) |C measured - C model| / |C measured|, Frobenius; NaN where the model does not reach."""
        return _sizes(self.measured - self.model) / _sizes(self.measured)

    @property
    def seen(self) -> bool:
        """Whether the model reaches any of the points."""
        return bool(np.isfinite(self.gap).any())

    @property
    def mean(self) -> float:
        """Mean gap; NaN where none is known."""
        return float(np.nanmean(self.gap)) if self.seen else float("nan")

    @property
    def worst(self) -> int:
        """Index of the point with the largest gap."""
        return int(np.nanargmax(self.gap)) if self.seen else 0

    @property
    def softer(self) -> bool:
        """Whether the measured arm gives more than the model, on average."""
        return bool(np.nanmean(_sizes(self.measured) - _sizes(self.model)) > 0)


def _sizes(C: FloatArray) -> FloatArray:
    return np.linalg.norm(C, axis=(-1, -2))
