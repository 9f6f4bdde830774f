"""What each joint alone, made stiffer, would leave of a cut's errors: ranked by what the verdict judges."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from robomill.arrays import FloatArray, IntArray, frozen
from robomill.improve.sensitivity import stiffened
from robomill.progress import step
from robomill.robot.model import Robot
from robomill.simulation.judging.verdict_words import Verdict
from robomill.simulation.run import Simulate, simulate
from robomill.simulation.setup import SimulationSetup

TWICE = 2.0


@dataclass(frozen=True, eq=False)
class Stiffening:
    """before: the verdict as the robot is; after: the n verdicts with joint i alone ``TWICE`` as stiff.

    tip (1+n,) m: the largest deviation of the tip, as it is and with each joint.
    together: where no joint alone brings an error within tolerance, the best joints (0-based, in the order of the
    ranking) that do when all of them are ``TWICE`` as stiff, or all that save something where not even these
    do; ``with_together`` is the verdict then, None where one joint is enough or nothing is out of tolerance.
    """

    before: Verdict
    after: tuple[Verdict, ...]
    tip: FloatArray
    together: tuple[int, ...] = ()
    with_together: Verdict | None = None

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


def some_stiffer(robot: Robot, joints: Iterable[int]) -> Robot:
    """``robot`` with the free ``joints`` (0-based) ``TWICE`` as stiff."""
    factors = np.ones(robot.n)
    factors[list(joints)] = TWICE
    return stiffened(robot, factors)


def stiffer_joints(setup: SimulationSetup, run: Simulate = simulate) -> Stiffening:
    """Every joint in turn, each by a run of the same simulation: exact for what it computes, coupling and sag included;
    then the best of them together, as many as it takes.

    ``run`` may keep results. Raises the refusal of the simulation.
    """
    robots = [setup.robot, *(some_stiffer(setup.robot, [joint]) for joint in range(setup.robot.n))]
    results = []
    for k, robot in enumerate(robots):
        with step(k, len(robots), "Each joint alone twice as stiff"):
            results.append(run(setup.replace(robot=robot)))
            _ = results[-1].verdict
    before, *after = (result.verdict for result in results)
    found = Stiffening(before, tuple(after), frozen([result.max_deviation for result in results]))
    return _together(found, setup, run)


def _together(found: Stiffening, setup: SimulationSetup, run: Simulate) -> Stiffening:
    """``found`` with the joints that have to be stiffer together."""
    if found.before.level != "out" or any(verdict.level != "out" for verdict in found.after):
        return found
    useful = [int(joint) for joint in found.ranking if found.saved[joint] > 0.0]
    for count in range(2, len(useful) + 1):
        joints = tuple(useful[:count])
        with step(count - 2, len(useful) - 1, "The best joints together twice as stiff"):
            verdict = run(setup.replace(robot=some_stiffer(setup.robot, joints))).verdict
        found = replace(found, together=joints, with_together=verdict)
        if verdict.level != "out":
            break
    return found
