"""What could be giving way: springs whose compliances are fitted, as one linear law ``delta = D @ parameters``.

Each spring has one direction of motion. With ``a`` the motion of a point when the spring yields by one
(``a = u x (p - o)`` for a turn about ``u`` through ``o``, ``a = u`` for a shift along ``u``) and ``c`` its
compliance, a wrench does the work ``a_F . W`` on it and the measuring point moves by ``c a_D (a_F . W)``:
eqs. (13)-(16) when the springs are the joints. So every model is linear in its compliances.

models: ``joints``; ``+bending`` adds turns about the x and y axes of the frame whose z is the joint's axis, at
the shoulder and elbow (joints 2 and 3) unless joints are named, fixed in the link before the joint, or (``turned``) in
the link after it; ``+tool`` adds a spindle and tool spring at the tip, one compliance across the tool axis and one
along it; ``constant`` is one symmetric 3 x 3 for every pose, the naive baseline.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.cartesian import joint_contributions
from robomill.compliance.components import COLUMN, COMPONENTS, ROW
from robomill.compliance.deflection import deflection
from robomill.compliance.springs.joint_bending import bending_axes
from robomill.errors import LoadTestError
from robomill.identification.configurations import ways
from robomill.identification.load_test import LoadTests
from robomill.identification.pull.points import Point
from robomill.kinematics.forward import joint_frames
from robomill.kinematics.jacobian import twists
from robomill.robot.model import Robot

Kind = Literal["joint", "bending", "tool", "entry"]
SPARE = 2  # readings a parameter from which springs that may not be there are asked for slips


@dataclass(frozen=True)
class Family:
    """What a model is called, and the kinds of springs it has."""

    title: str
    kinds: frozenset[Kind]


MODELS: dict[str, Family] = {
    "joints": Family("Joint springs", frozenset({"joint"})),
    "joints+bending": Family("Joints and bending links", frozenset({"joint", "bending"})),
    "joints+tool": Family("Joints and tool", frozenset({"joint", "tool"})),
    "joints+bending+tool": Family("Joints, bending and tool", frozenset({"joint", "bending", "tool"})),
    "constant": Family("One constant matrix", frozenset({"entry"})),
}


@dataclass(frozen=True)
class Parameter:
    """One fitted compliance: a joint, the bending of joint ``at`` about ``axis``, the tool, or an entry of a matrix.

    at: the robot's number of the joint (1-based), 0 where there is none; slides: that joint shifts rather than turns;
    axis: "x" or "y" of the joint's frame (turned: of the link it moves), "across" or "along" the tool, or an entry such
    as "xy".
    """

    kind: Kind
    at: int = 0
    axis: str = ""
    slides: bool = False
    turned: bool = False

    @property
    def joint(self) -> int | None:
        """The joint whose own compliance this is, else None."""
        return self.at if self.kind == "joint" else None

    @property
    def signed(self) -> bool:
        """Whether it may be negative: an entry off the diagonal."""
        return self.kind == "entry" and self.axis[0] != self.axis[1]

    @property
    def turns(self) -> bool:
        """Whether it is a turn under a moment, rad/(N m), rather than a shift under a force, m/N."""
        return self.kind == "bending" or (self.kind == "joint" and not self.slides)

    @property
    def unit(self) -> str:
        """What it is told in, a key of ``UNITS``."""
        if self.turns:
            return "1e-7 rad/(N m)"
        return "um/N" if self.joint is None else "1e-9 m/N"

    @property
    def label(self) -> str:
        """Its name in tables and sentences; no two parameters of a model share it."""
        side = "after" if self.turned else "at"
        names = {"joint": f"joint {self.at}", "bending": f"bending {self.axis} {side} joint {self.at}"}
        return names.get(self.kind, f"C_{self.axis}" if self.kind == "entry" else f"tool {self.axis}")


@dataclass(frozen=True)
class Model:
    """A choice of springs. ``bending_joints`` are 1-based; ``turned``: those axes turn with the joint."""

    name: str = "joints"
    bending_joints: tuple[int, ...] = (2, 3)
    turned: bool = False

    def __post_init__(self) -> None:
        if self.name not in MODELS:
            raise LoadTestError(f"Model {self.name!r}: expected one of {', '.join(MODELS)}.")

    @property
    def title(self) -> str:
        """What people call it."""
        return MODELS[self.name].title

    @classmethod
    def asked_of_slips(cls, robot: Robot, equations: int) -> Iterator[Model]:
        """Springs beside which slips are sought: the joints, then links that bend at every joint as well.

        A slip shows only beside springs that are there: what strong bending leaves over of the joints hides it. Bending
        takes up what it likes of few readings, and is asked only where each parameter has ``SPARE`` of them.
        """
        yield cls()
        bending = cls("joints+bending", robot.joint_numbers)
        if equations >= SPARE * len(bending.parameters(robot)):
            yield bending

    def has(self, kind: Kind) -> bool:
        """Whether springs of that kind are in it."""
        return kind in MODELS[self.name].kinds

    def bending_at(self, joints: tuple[int, ...], turned: bool) -> Model:
        """The same springs with links that bend at these joints, or at none."""
        kinds = (MODELS[self.name].kinds - {"bending"}) | ({"bending"} if joints else set())
        name = next(name for name, family in MODELS.items() if family.kinds == kinds)
        return Model(name, joints, turned)

    def parameters(self, robot: Robot) -> tuple[Parameter, ...]:
        """What is fitted, in the order of the equations' columns."""
        if self.has("entry"):
            return tuple(Parameter("entry", axis=name) for name in COMPONENTS)
        slides = robot.chain.prismatic
        listed = [Parameter("joint", number, slides=bool(slides[i])) for i, number in enumerate(robot.joint_numbers)]
        if self.has("bending"):
            for joint in self._bending(robot):
                number = robot.joint_numbers[joint]
                listed += [Parameter("bending", number, axis, turned=self.turned) for axis in "xy"]
        if self.has("tool"):
            listed += [Parameter("tool", axis=axis) for axis in ("across", "along")]
        return tuple(listed)

    def _bending(self, robot: Robot) -> tuple[int, ...]:
        """Indices (from 0) among the free joints of those that bend."""
        numbers = robot.joint_numbers
        for joint in self.bending_joints:
            if joint not in numbers:
                listed = ", ".join(map(str, numbers))
                raise LoadTestError(f"Bending at joint {joint}: expected one of the free joints {listed}.")
        return tuple(numbers.index(joint) for joint in dict.fromkeys(self.bending_joints))

    def columns(self, robot: Robot, theta: FloatArray, offset: FloatArray | None = None) -> FloatArray:
        """(..., 6, s) motion in {M} (m, rad) of a point at ``offset`` (..., 3) m in {T} as each spring yields by one.

        The tool counts as three springs (x, y and z of {T}); ``_collect`` adds the first two into one parameter.
        """
        frames = joint_frames(robot, theta)
        p = frames[..., -1, :3, 3]
        if offset is not None:
            p = p + np.einsum("...ij,...j->...i", frames[..., -1, :3, :3], offset)
        shafts = [
            (frames[..., i, :3, 3], frames[..., i, :3, 2], bool(robot.chain.prismatic[i])) for i in range(robot.n)
        ]
        if self.has("bending"):
            for joint in self._bending(robot):
                shafts += [
                    (frames[..., joint, :3, 3], axis, False) for axis in bending_axes(frames, joint, self.turned)
                ]
        if self.has("tool"):
            shafts += [(p, frames[..., -1, :3, k], True) for k in range(3)]
        return np.stack([twists(axis, p - origin, slides) for origin, axis, slides in shafts], axis=-1)

    def _collect(self, each: FloatArray) -> FloatArray:
        """Spring by spring -> parameter by parameter: the two springs across the tool share a compliance."""
        if not self.has("tool"):
            return each
        return np.concatenate([each[..., :-3], each[..., -3:-1].sum(-1, keepdims=True), each[..., -1:]], axis=-1)

    def terms(self, robot: Robot, tests: LoadTests, freed: Sequence[Point] = ()) -> FloatArray:
        """(m, 6, k, p): displacement and rotation of the measuring point per unit of each parameter.

        As a sum over the k products of the shifts of the points that are ``freed`` (``points``), k = 1 where none is.
        """
        if tests.theta is None:
            raise LoadTestError("Load tests: the poses are given in the world; call with_joints(robot) first.")
        if self.has("entry"):
            if freed:
                raise LoadTestError("One constant matrix knows no points of the tool; fit points with a joint model.")
            D = np.full((len(tests), 6, 1, len(COMPONENTS)), np.nan)
            D[:, :3, 0] = _constant(tests.wrench[:, :3])
            return D
        at_force = self._affine(robot, tests.theta, tests.force_point, "force" in freed)
        same = "force" in freed or "gauge" not in freed
        same = same and np.array_equal(tests.force_point, tests.measuring_point)
        at_gauge = at_force if same else self._affine(robot, tests.theta, tests.measuring_point, "gauge" in freed)
        if "gauge" not in freed:
            at_gauge = at_gauge[:, :1]
        load = np.einsum("mfcs,mc->mfs", at_force, tests.wrench)
        if "force" in freed and tests.aimed.any():
            load[tests.aimed] = self._aimed(robot, tests.select(tests.aimed))
        each = np.einsum("mgcs,mfs->mcfgs", at_gauge, load)
        return self._collect(each.reshape(*each.shape[:2], -1, each.shape[-1]))

    def _affine(self, robot: Robot, theta: FloatArray, offset: FloatArray, free: bool) -> FloatArray:
        """(m, 1 or 4, 6, s): ``columns`` at the offset and, if it is free, its change per m along x, y and z of {T}."""
        here = self.columns(robot, theta, offset)[:, None]
        if not free:
            return here
        moved = self.columns(robot, theta[:, None, :], offset[:, None, :] + np.eye(3))
        return np.concatenate([here, moved - here], axis=1)

    def _aimed(self, robot: Robot, tests: LoadTests) -> FloatArray:
        """(m, 4, s) the work that cables do on each spring, and its change per m of the force point along {T}.

        A cable's line always runs through its pulley, so its force may act there: it only turns when the point moves.
        """
        assert tests.theta is not None
        T, F = tests.tool_poses(robot), tests.wrench[:, :3]
        way = ways(T, tests.force_point, tests.pulley)
        far, u = np.linalg.norm(way, axis=1), F / np.linalg.norm(F, axis=1, keepdims=True)
        across = np.eye(3) - u[:, :, None] * u[:, None, :]
        turned = -np.einsum("m,mij,mjk->mki", np.linalg.norm(F, axis=1) / far, across, T[:, :3, :3])
        W = np.zeros((len(tests), 4, 6))
        W[:, 0], W[:, 1:, :3] = tests.wrench, turned
        at_pulley = tests.force_point + np.einsum("mji,mj->mi", T[:, :3, :3], way)
        return np.asarray(np.einsum("mcs,mfc->mfs", self.columns(robot, tests.theta, at_pulley), W))

    def tip_regressor(self, robot: Robot, theta: FloatArray, F: FloatArray) -> FloatArray:
        """(..., 3, p) D with delta = D @ parameters, for a force F (..., 3) N in {M} at the tool tip."""
        theta, F = np.asarray(theta, dtype=np.float64), np.asarray(F, dtype=np.float64)
        if self.has("entry"):
            return np.broadcast_to(_constant(F), (*np.broadcast_shapes(theta.shape[:-1], F.shape[:-1]), 3, 6))
        a = self.columns(robot, theta)[..., :3, :]
        shares = deflection(joint_contributions(a, np.ones(a.shape[-1])), F)
        return self._collect(np.swapaxes(shares, -1, -2))

    def compliance(self, robot: Robot, theta: FloatArray, parameters: Sequence[float] | FloatArray) -> FloatArray:
        """C (..., 3, 3) m/N at the tool tip in {M}, for given parameters (p,)."""
        theta = np.asarray(theta, dtype=np.float64)
        D = self.tip_regressor(robot, theta[..., None, :], np.eye(3))  # (..., force, component, p)
        return np.swapaxes(D @ np.asarray(parameters, dtype=np.float64), -1, -2)


def _constant(F: FloatArray) -> FloatArray:
    """(..., 3, 6): displacement per unit of C_xx, C_yy, C_zz, C_xy, C_xz, C_yz."""
    D = np.zeros((*F.shape[:-1], 3, len(COMPONENTS)))
    for k, (i, j) in enumerate(zip(ROW, COLUMN, strict=True)):
        D[..., i, k] += F[..., j]
        if i != j:
            D[..., j, k] += F[..., i]
    return D
