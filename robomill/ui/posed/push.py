"""What pushes the tool on the pages that look at the arm, and what gives: the force of the cut where its verdict is
decided, or 100 N along an axis where a person asks for that or the cut has no answer."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.at_pose import PoseReport, at_pose
from robomill.compliance.deflection import deflection, shares_along
from robomill.improve.sensitivity import scaled_shares
from robomill.learn.push import ASIDE, FORCE
from robomill.robot.model import Robot
from robomill.simulation.result import SimulationResult
from robomill.ui import session
from robomill.ui.entry import declared, inputs
from robomill.ui.posed.cut import middle_of_cut
from robomill.ui.posed.point import InHand, default_point, holds, in_hand
from robomill.ui.project import MapView, View
from robomill.units import format_si, unit_label
from robomill.wording import listed
from robomill.workspace.fields import ComplianceMap
from robomill.workspace.reach import ReachBox

STILL = 1e-9  # m: a displacement that is no more than this is none
NAMED = 0.08  # a joint with a smaller share is not named


@dataclass(frozen=True, eq=False)
class Push:
    """The force F (3,) N on the tool in {M}; ``axis`` is "x", "y" or "z" for 100 N along it, "" for that of a cut."""

    F: FloatArray
    axis: str = ""

    @classmethod
    def along(cls, axis: str) -> Push:
        """100 N along an axis of the robot's frame."""
        return cls(FORCE * np.eye(3)["xyz".index(axis)], axis)

    @property
    def size(self) -> str:
        """ "330 N"."""
        return format_si(float(np.linalg.norm(self.F)), "N", 0)

    @property
    def words(self) -> str:
        """ "330 N on the tool" or "100 N along Y"."""
        return f"{self.size} along {self.axis.upper()}" if self.axis else f"{self.size} on the tool"


@dataclass(frozen=True, eq=False)
class Moved:
    """What a push does: the tip moves by delta (3,) m, of which each joint gives delta_joint (n, 3)."""

    push: Push
    delta: FloatArray
    delta_joint: FloatArray
    joints: tuple[int, ...]

    @classmethod
    def at(cls, pose: PoseReport, push: Push) -> Moved:
        """By the joints of an arm at a pose."""
        shares = deflection(pose.C_joint, push.F)
        return cls(push, shares.sum(axis=0), shares, pose.robot.joint_numbers)

    @property
    def size(self) -> float:
        """m."""
        return float(np.linalg.norm(self.delta))

    @property
    def shares(self) -> FloatArray:
        """(n,) of the displacement, along it."""
        return shares_along(self.delta_joint, self.delta) * self.moves

    @property
    def moves(self) -> bool:
        """Whether the tip is displaced by more than the rounding of a sum."""
        return self.size > STILL

    def stiffer(self, factors: FloatArray) -> Moved:
        """The same push with the stiffness of each joint multiplied by ``factors`` (n,)."""
        scaled = scaled_shares(self.delta_joint, factors, -2)
        return replace(self, delta=self.delta + (scaled - self.delta_joint).sum(axis=0), delta_joint=scaled)

    def components(self, unit: str) -> str:
        """ "+0.230 mm along Y, −0.102 mm along Z"."""
        return ", ".join(f"{far} {unit_label(unit)} along {axis}" for axis, far in by_axis(self.delta, unit))

    def sentence(self, unit: str) -> str:
        """What pushes, and where the tip goes."""
        if not self.moves:
            return f"{self.push.words} does not move the tip."
        return f"{self.push.words} moves the tip by {self.components(unit)}."

    def blame(self, unit: str) -> str:
        """Which joints give, with their shares of the displacement; "" where nothing moves."""
        share = self.shares
        main = [j for j in np.argsort(-share, kind="stable") if share[j] > NAMED][:3]
        if not main:
            return ""
        per_cent = whole([float(share[j]) for j in main])
        named = [f"from joint {self.joints[j]}" for j in main]
        (most, *others), (first, *rest) = per_cent, named
        told = [f"{most} % come {first}", *(f"{each} % {where}" for each, where in zip(others, rest, strict=True))]
        return f"Of these {format_si(self.size, unit)}, {listed(told)}."


@dataclass(frozen=True, eq=False)
class Decided:
    """Where the verdict of a run is decided: sample ``i`` of it."""

    result: SimulationResult
    i: int

    @property
    def line(self) -> int:
        """Of the program."""
        return int(self.result.path.block[self.i])

    @property
    def theta(self) -> FloatArray:
        """(n,) as the arm stands there."""
        return np.array(self.result.theta[self.i])

    @property
    def upright(self) -> bool:
        """Whether the tool stands along the vertical of the robot's frame there."""
        return bool(self.result.ik.T_MT[self.i, 2, 2] > 1.0 - 1e-9)

    @property
    def moved(self) -> Moved:
        """By the force of the cut, with all that gives there."""
        found = self.result
        robot = found.setup.robot
        return Moved(Push(found.F[self.i]), found.delta[self.i], found.delta_joint[self.i], robot.joint_numbers)

    def in_hand(self, robot: Robot | None = None) -> InHand:
        """The arm (or another of its kind) as it stands there, and the point, to a hundredth of a millimetre."""
        x, y, z = np.round(self.result.setup.in_base(self.result.path.p[self.i]), 5) + 0.0
        return InHand((float(x), float(y), float(z)), at_pose(robot or self.result.setup.robot, self.theta), "")


def by_axis(delta: FloatArray, unit: str, every: bool = False) -> list[tuple[str, str]]:
    """X, Y or Z and how far a displacement (3,) m goes along it, in ``unit`` without its name; axes along which nothing
    of it is to be seen are left out unless ``every`` is asked for."""
    least = ASIDE * float(np.linalg.norm(delta))
    told = [(axis, float(v)) for axis, v in zip("XYZ", delta, strict=True) if every or abs(v) > least]
    return [(axis, format_si(v, unit, sign=True, with_unit=False)) for axis, v in told]


def whole(shares: Sequence[float]) -> list[int]:
    """Shares (of 1) in whole per cent whose sum is that of the shares: what is cut off most is rounded up first."""
    floors = [math.floor(100.0 * share) for share in shares]
    short = round(100.0 * sum(shares)) - sum(floors)
    order = sorted(range(len(shares)), key=lambda k: floors[k] - 100.0 * shares[k])
    return [floors[k] + (k in order[:short]) for k in range(len(shares))]


def decided(result: SimulationResult | None) -> Decided | None:
    """Where the verdict of ``result`` is decided; None where nothing of the cut has an answer."""
    if result is None:
        return None
    i = result.decided.sample
    if i < 0 or not (np.isfinite(result.delta[i]).all() and np.isfinite(result.F[i]).all()):
        return None
    return Decided(result, i)


def in_force(view: View, cut: Decided | None) -> Push:
    """What pushes: as the person chose; along Y where the cut is to push and has no answer."""
    if view.push == "cut":
        return Push.along("y") if cut is None else cut.moved.push
    return Push.along(view.push)


def selected(view: MapView, box: ReachBox, known: ComplianceMap, cut: Decided | None) -> tuple[InHand, bool]:
    """The selected point, and whether it is where the verdict is decided, with the arm as it stands there: so where
    nobody has chosen another one, the region holds it and the maps are not tilted."""
    untouched = view.point is None and view.A == view.B == 0
    if cut is not None and untouched and holds(box, cut.in_hand().point):
        return cut.in_hand(known.robot), True
    middle = middle_of_cut(session.project().setup) if cut is None else cut.in_hand().point
    return in_hand(known.robot, default_point(view, box, known, middle), view.A, view.B), False


def choice() -> None:
    """Whose force it is that the page speaks of."""
    declared.seen("view.push", inputs.LISTED)
