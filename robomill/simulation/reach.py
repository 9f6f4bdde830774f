"""Whether the arm can follow a path, and which points of a plane it reaches: the questions asked before a cut."""

from dataclasses import dataclass

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.kinematics.dexterity import limit_distance
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import translation
from robomill.lazy import cached_property
from robomill.robot.model import Robot
from robomill.simulation.run import configurations
from robomill.simulation.samples import sampled
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath
from robomill.toolpath.summary import distinct

MAX_SAMPLES = 400_000


@dataclass(frozen=True, eq=False)
class PathReach:
    """The sampled path, which samples (m,) are reached, and the room (m,) to the joint limits: ``limit_distance``."""

    path: Toolpath
    reached: BoolArray
    room: FloatArray
    reason: str

    @cached_property
    def missed(self) -> BoolArray:
        """(m,) samples at feed that cannot be reached."""
        return np.asarray(self.path.cutting & ~self.reached)

    @property
    def share(self) -> float:
        """Of the samples at feed that are reached; 1 where there are none."""
        return 1.0 - float(self.missed.sum()) / max(int(self.path.cutting.sum()), 1)

    @cached_property
    def missed_length(self) -> float:
        """m: the length that these stand for."""
        return float(self.path.step_length[self.missed].sum())

    @cached_property
    def missed_blocks(self) -> IntArray:
        """Their source lines, each once."""
        return distinct(self.path.block[self.missed])


def path_reach(setup: SimulationSetup) -> PathReach:
    """The configurations of a run along the path; raises the refusal of reading it."""
    whole = setup.toolpath
    path = sampled(whole, max(setup.step, float(whole.s[-1]) / MAX_SAMPLES, 1e-6))
    ik = configurations(setup, path)
    room = limit_distance(setup.robot, ik.theta)
    lost = np.flatnonzero(path.cutting & ~ik.reached)
    return PathReach(path, ik.reached, room, str(ik.reason(int(lost[0]))) if len(lost) else "")


def plane_reach(robot: Robot, T_MW: FloatArray, x: FloatArray, y: FloatArray, z: float) -> BoolArray:
    """(ny, nx) whether the upright tool gets to the points x (nx,), y (ny,) of the plane z of {W}, m."""
    X, Y = np.meshgrid(x, y)
    T_WT = translation(np.stack([X, Y, np.full_like(X, z)], axis=-1))
    return np.asarray(inverse_kinematics(robot, T_MW @ T_WT).reached)
