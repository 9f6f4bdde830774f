"""The free rotation about the tool axis of arms with six axes or more: what a path costs at each spin."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray, IntArray, frozen
from robomill.kinematics.choice import SPIN_STEPS, spins
from robomill.kinematics.decoupled import decoupled
from robomill.kinematics.inverse import LEAST_MOTION, inverse_kinematics
from robomill.lazy import cached_property
from robomill.robot.model import Robot

LEAST_DEVIATION = "least_deviation"
RULES = (LEAST_MOTION, LEAST_DEVIATION)


def spin_matters(robot: Robot) -> bool:
    """Whether the turn about the tool axis moves more than one joint about that axis."""
    arm = decoupled(robot)
    return robot.n >= 6 and not (arm is not None and arm.spindle_on_last_axis)


@dataclass(frozen=True, eq=False)
class OverSpin:
    """A path followed at k spins: angle (k,) rad about z_T, poses missed (k,), and what was asked of it: value (k,).

    value is NaN where no pose that counts is reached.
    """

    angle: FloatArray
    missed: IntArray
    value: FloatArray

    @cached_property
    def best(self) -> int:
        """Index of the spin that misses the fewest poses and, of these, has the least value."""
        order = np.lexsort((np.where(np.isnan(self.value), np.inf, self.value), self.missed))
        return int(order[0])

    @property
    def range(self) -> tuple[float, float]:
        """Least and largest value over the spins that miss no more poses than the best one."""
        among = self.value[self.missed == self.missed[self.best]]
        return (float(np.nanmin(among)), float(np.nanmax(among))) if np.isfinite(among).any() else (np.nan, np.nan)


def over_spins(
    robot: Robot, T_MT: FloatArray, value: Callable[[FloatArray], float], count: int = SPIN_STEPS
) -> OverSpin:
    """``value`` of the configurations theta (m, n) along the poses T_MT (m, 4, 4) at ``count`` spins round the tool.

    Arms of fewer than six axes have no free spin: one angle, 0.
    """
    angles = frozen(spins(count if robot.n >= 6 else 1))
    missed, values = np.empty(len(angles), dtype=np.int64), np.empty(len(angles))
    for i, angle in enumerate(angles):
        ik = inverse_kinematics(robot, T_MT, near="path", spin=float(angle))
        missed[i], values[i] = (~ik.reached).sum(), value(ik.theta)
    return OverSpin(angles, missed, values)
