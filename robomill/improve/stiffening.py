"""What each joint alone, made stiffer, would leave of a cut's deviation."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray, IntArray, frozen
from robomill.improve.sensitivity import stiffened
from robomill.robot.model import Robot
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import simulate
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.verdict_words import Verdict

TWICE = 2.0


@dataclass(frozen=True, eq=False)
class Stiffening:
    """before: largest deviation m as the robot is; after (n,) m with joint i alone ``factor`` times as stiff;
    ``verdict`` of the part with the first of ``ranking``."""

    before: float
    after: FloatArray
    verdict: Verdict
    factor: float = TWICE

    @property
    def saved(self) -> FloatArray:
        """(n,) m: how much smaller the largest deviation becomes."""
        return self.before - self.after

    @property
    def ranking(self) -> IntArray:
        """(n,) joints, 0-based, the one that saves most first."""
        return np.argsort(self.after, kind="stable")


def one_stiffer(robot: Robot, joint: int, factor: float = TWICE) -> Robot:
    """``robot`` with the free joint ``joint`` (0-based) ``factor`` times as stiff."""
    factors = np.ones(robot.n)
    factors[joint] = factor
    return stiffened(robot, factors)


def stiffer_joints(
    setup: SimulationSetup,
    run: Callable[[SimulationSetup], SimulationResult] = simulate,
    factor: float = TWICE,
) -> Stiffening:
    """Every joint in turn, each by a run of the same simulation: exact for what it computes, coupling and sag included.

    ``run`` may keep results. Raises the refusal of the simulation.
    """
    robots = [one_stiffer(setup.robot, joint, factor) for joint in range(setup.robot.n)]
    results = [run(setup.replace(robot=robot)) for robot in robots]
    after = frozen([result.max_deviation for result in results])
    return Stiffening(run(setup).max_deviation, after, results[int(np.argmin(after))].verdict, factor)
