"""Whether the joints follow a path steadily: where one must turn much faster than the tool, or the arm is singular."""

from dataclasses import dataclass

import numpy as np

from robomill.arrays import IntArray, stretches
from robomill.kinematics import dexterity
from robomill.kinematics.inverse import IKResult
from robomill.kinematics.joining import easy_turn
from robomill.kinematics.result import task_mode
from robomill.units import format_si

SLACK = 1e-6  # rad: rounding of inverse kinematics near a singular configuration


@dataclass(frozen=True)
class Haste:
    """Steps ``first`` .. ``last`` of a path (each named by the pose it ends at) in which a joint turns in haste.

    joint: its number in the robot's table; turn rad and way m over these steps; worst: the step in which it turns most
    for its length; rate rad/m there, infinite where the tip stands still.
    """

    first: int
    last: int
    joint: int
    turn: float
    way: float
    worst: int
    rate: float

    def sentence(self, v_f: float = 0.0) -> str:
        """In words; with the joint's speed where the feed there, v_f m/s, is known."""
        words = f"joint {self.joint} turns {format_si(self.turn, 'deg', 1)} within {format_si(self.way, 'mm', 1)}"
        if np.isfinite(self.rate):
            words += f", up to {format_si(self.rate, 'deg/mm')}"
            if v_f > 0.0:
                words += f" ({format_si(self.rate * v_f, 'deg/s')} at the feed there)"
        return f"{words}: close to a singular configuration the joints run while the tool hardly moves."


@dataclass(frozen=True)
class Passage:
    """Step ``at`` of a path (named by the pose it ends at) in which the arm passes a singular configuration."""

    at: int
    before: str
    after: str

    def sentence(self) -> str:
        """In words."""
        words = "det(J) changes its sign, so the arm passes a singular configuration"
        if self.before != self.after:
            words += f", from {self.before!r} to {self.after!r}"
        return f"{words}: there the tool cannot be moved in every direction."


def hasty_turns(ik: IKResult) -> list[Haste]:
    """Where a joint turns more than the tool's own motion asks for (``joining.easy_turn``), along one path (m, 4, 4).

    In the order of the path. Across poses that are not reached nothing is said.
    """
    robot = ik.robot
    T_MT = ik.T_MT.reshape(-1, 4, 4)
    easy = easy_turn(T_MT, whole=task_mode(robot) == "pose" and not ik.free_spin)[1:]
    way = np.linalg.norm(np.diff(T_MT[:, :3, 3], axis=0), axis=1)
    turn = np.abs(np.diff(ik.theta.reshape(-1, robot.n), axis=0))  # NaN beside what is not reached
    found = []
    for j in np.flatnonzero(~robot.chain.prismatic):
        for first, past in stretches(turn[:, j] > easy + SLACK).tolist():
            steps = slice(first, past)
            with np.errstate(divide="ignore"):
                rate = turn[steps, j] / way[steps]
            worst = int(np.argmax(rate))
            found.append(
                Haste(
                    first + 1,
                    past,
                    robot.joint_numbers[j],
                    float(turn[steps, j].sum()),
                    float(way[steps].sum()),
                    first + worst + 1,
                    float(rate[worst]),
                )
            )
    return sorted(found, key=lambda haste: (haste.first, haste.joint))


def passages(ik: IKResult) -> list[Passage]:
    """Where det(J) of the arm's task changes its sign between two poses of a path: a singular configuration between."""
    robot = ik.robot
    if robot.n > 6:
        return []
    theta = ik.theta.reshape(-1, robot.n)
    det = dexterity.determinant(robot, theta)
    names = np.atleast_1d(ik.branch).reshape(-1)
    det = np.where(np.abs(det) > dexterity.ROUNDING, det, 0.0)
    steps: IntArray = np.flatnonzero(det[1:] * det[:-1] < 0.0) + 1
    return [Passage(int(i), str(names[i - 1]), str(names[i])) for i in steps]
