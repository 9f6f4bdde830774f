"""What each joint alone, made stiffer, would leave of a cut's errors: ranked by what the verdict judges."""

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
    """before: the verdict as the robot is; after: the n verdicts with joint i alone ``factor`` times as stiff.

    tip (1+n,) m: the largest deviation of the tip, as it is and with each joint.
    """

    before: Verdict
    after: tuple[Verdict, ...]
    tip: FloatArray
    factor: float = TWICE

    @property
    def used(self) -> FloatArray:
        """(n,) share of the tolerance that is used then; NaN where nothing is known."""
        return np.array([verdict.share for verdict in self.after])

    @property
    def saved(self) -> FloatArray:
        """(n,) how much less of the tolerance is used then."""
        return self.before.share - self.used

    @property
    def ranking(self) -> IntArray:
        """(n,) joints, 0-based, the one that leaves the smallest share first."""
        return np.argsort(self.used, kind="stable")


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
    robots = [setup.robot, *(one_stiffer(setup.robot, joint, factor) for joint in range(setup.robot.n))]
    results = [run(setup.replace(robot=robot)) for robot in robots]
    before, *after = (result.verdict for result in results)
    return Stiffening(before, tuple(after), frozen([result.max_deviation for result in results]), factor)
