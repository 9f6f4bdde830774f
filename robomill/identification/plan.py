"""Where to measure next: poses and directions that make the compliances, one joint, or one path most certain.

A test at a candidate adds A^T A / sigma^2 to the information; the next one is the candidate that gains most, chosen
one after another. Goals: "all" grows the determinant (D-optimal: the volume of the joint uncertainty), a joint
number shrinks that joint's variance (c-optimal), a path shrinks the mean variance of its predicted deviation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import stdtrit
from scipy.stats import qmc

from robomill.arrays import FloatArray, frozen
from robomill.errors import LoadTestError
from robomill.identification.load_test import LoadTests
from robomill.identification.models import Parameter
from robomill.identification.result import IdentificationResult
from robomill.identification.system import build_system
from robomill.kinematics.forward import tool_pose
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import pose_from_world, world_from_pose
from robomill.robot.model import Robot
from robomill.units import format_si

PRIOR = 1e-10  # information, scaled, that stands in where the tests have none


class PathLoad(NamedTuple):
    """A machining path to be certain of: configurations theta (m, n) and forces F (m, 3) N in {M}."""

    theta: FloatArray
    F: FloatArray


@dataclass(frozen=True, eq=False)
class Plan:
    """The tests to do next, best first: theta (k, n), x_M (k, 5), F (k, 3) N.

    before, after (p,): standard errors as they are and as they should become; half_before, half_after (p,): half
    widths of the 95 % intervals; path_before, path_after: rms standard deviation (m) of the path's deviation.
    """

    theta: FloatArray
    x_M: FloatArray
    F: FloatArray
    labels: tuple[Parameter, ...]
    before: FloatArray
    after: FloatArray
    half_before: FloatArray
    half_after: FloatArray
    goal: str
    path_before: float = float("nan")
    path_after: float = float("nan")

    def as_tests(self) -> LoadTests:
        """The plan as a measuring sheet: displacements zero, to be filled in."""
        return LoadTests(self.F, np.zeros_like(self.F), theta=self.theta, source=f"plan: {self.goal}")

    def rows(self) -> list[dict[str, object]]:
        """One row a parameter: standard error and half 95 % interval before and after, SI, and the gain as a share."""
        return [
            {
                "parameter": parameter.label,
                "stderr_before": float(self.before[k]),
                "stderr_after": float(self.after[k]),
                "half_before": float(self.half_before[k]),
                "half_after": float(self.half_after[k]),
                "gain": 1.0 - float(self.half_after[k] / self.half_before[k]) if self.half_before[k] > 0 else 0.0,
            }
            for k, parameter in enumerate(self.labels)
        ]

    def sentence(self) -> str:
        """What the plan promises, in words."""
        with np.errstate(invalid="ignore", divide="ignore"):
            gain = np.where(np.isfinite(self.half_before), 1.0 - self.half_after / self.half_before, 1.0)
        k = int(np.nanargmax(np.where(self.half_before > 0, gain, -1.0)))
        text = f"{len(self.F)} more tests should narrow the interval of {self.labels[k].label} by {100 * gain[k]:.0f} %"
        if np.isfinite(self.path_before):
            was, now = format_si(self.path_before, "um"), format_si(self.path_after, "um")
            text += f", and the path's predicted deviation from ±{was} to ±{now} (one standard deviation)"
        return text + "."


@dataclass(frozen=True, eq=False)
class Candidates:
    """Tests one could do: theta (k, n), F (k, 3) N."""

    theta: FloatArray
    F: FloatArray


def box_candidates(
    robot: Robot,
    lower: FloatArray,
    upper: FloatArray,
    *,
    tilt: float = np.pi / 6,
    load: float = 250.0,
    poses: int = 300,
    seed: int = 1,
    directions: FloatArray | None = None,
) -> Candidates:
    """Poses spread over a box in {M} (corners in m) with the tool tilted by up to ``tilt`` rad, within the limits.

    directions (q, 3): unit forces tried at each pose (+X, +Y, +Z unless given). Raises LoadTestError where nothing in
    the box is reached.
    """
    span = np.array([tilt, tilt])
    low = np.concatenate([np.asarray(lower, dtype=np.float64), -span])
    high = np.concatenate([np.asarray(upper, dtype=np.float64), span])
    if (high < low).any():
        raise LoadTestError("Plan: the upper corner of the box lies below its lower corner.")
    points = low + (high - low) * qmc.Halton(5, seed=seed).random(poses)
    solved = inverse_kinematics(robot, pose_from_world(points))
    theta = solved.theta[solved.reached]
    if len(theta) == 0:
        raise LoadTestError("Plan: no pose in the box is reached within the joint limits; move the box or tilt less.")
    axes = np.eye(3) if directions is None else np.asarray(directions, dtype=np.float64)
    F = np.tile(load * axes, (len(theta), 1))
    return Candidates(np.repeat(theta, len(axes), axis=0), F)


def next_best(
    robot: Robot,
    tests: LoadTests,
    result: IdentificationResult,
    candidates: Candidates,
    *,
    count: int = 3,
    goal: str | int | PathLoad = "all",
    noise: float | None = None,
) -> Plan:
    """The ``count`` candidates to measure next for a goal: "all", a joint number, or a PathLoad.

    noise: standard deviation of a reading (m); as estimated from the residuals unless given.
    """
    sigma = result.noise if noise is None else noise
    if not (np.isfinite(sigma) and sigma > 0):
        raise LoadTestError("Plan: the noise is not known (no residuals to judge by); state it in mm.")
    system = build_system(robot, tests.without(result.excluded), result.choice)
    D = result.choice.tip_regressor(robot, candidates.theta, candidates.F)
    scale = np.sqrt((system.A**2).sum(axis=0) + (D**2).mean(axis=(0, 1)))  # above zero wherever either sees anything
    scale[scale == 0] = max(float(scale.max()), 1e-300)
    relative = system.noise / np.median(system.noise)
    A = system.A / scale / (sigma * relative)[:, None]
    M = A.T @ A
    prior = PRIOR * float(np.trace(M)) * np.eye(len(M))
    P = np.linalg.inv(M + prior)
    blocks = D / scale / sigma
    live = np.array([parameter.label not in result.lumped for parameter in system.parameters])
    blocks = blocks * live
    weight, words = _goal(robot, result, goal, scale)
    before = P
    picked: list[int] = []
    for _ in range(count):
        best = _best(P, blocks, weight, picked)
        picked.append(best)
        W = blocks[best] @ P
        P = P - W.T @ np.linalg.solve(np.eye(3) + W @ blocks[best].T, W)
    return _plan(robot, result, candidates, picked, (before, P), scale, goal, words)


def _best(P: FloatArray, blocks: FloatArray, weight: FloatArray | None, picked: list[int]) -> int:
    """Index of the candidate that gains most; ``weight`` None: determinant, else mean variance under it."""
    W = blocks @ P  # (k, 3, p)
    S = np.eye(3) + W @ np.swapaxes(blocks, -1, -2)
    if weight is None:
        gain = np.linalg.slogdet(S)[1]
    else:
        gain = np.trace(np.linalg.solve(S, W @ weight @ np.swapaxes(W, -1, -2)), axis1=-2, axis2=-1)
    gain[picked] = -np.inf  # a repeated test would average noise but learn nothing new of the arm
    return int(np.argmax(gain))


def _goal(
    robot: Robot, result: IdentificationResult, goal: str | int | PathLoad, scale: FloatArray
) -> tuple[FloatArray | None, str]:
    if isinstance(goal, PathLoad):
        D = _path_regressor(robot, result, goal) / scale
        return np.einsum("mci,mcj->ij", D, D) / len(D), "this path's deviation"
    if isinstance(goal, int):
        found = [k for k, parameter in enumerate(result.labels) if parameter.joint == goal]
        if not found:
            raise LoadTestError(f"Plan: joint {goal} is not among the fitted joints.")
        weight = np.zeros((len(scale), len(scale)))
        weight[found[0], found[0]] = 1.0
        return weight, f"joint {goal}"
    if goal != "all":
        raise LoadTestError(f"Plan: goal {goal!r}; expected 'all', a joint number or a path.")
    return None, "all compliances"


def _path_regressor(robot: Robot, result: IdentificationResult, path: PathLoad) -> FloatArray:
    """(m, 3, p) at the points of the path that are reached."""
    D = result.choice.tip_regressor(robot, path.theta, path.F)
    usable = np.isfinite(D).all(axis=(-1, -2))
    if not usable.any():
        raise LoadTestError("Plan: no point of the path is reached.")
    return D[usable]


def _plan(
    robot: Robot,
    result: IdentificationResult,
    candidates: Candidates,
    picked: list[int],
    covariances: tuple[FloatArray, FloatArray],
    scale: FloatArray,
    goal: str | int | PathLoad,
    words: str,
) -> Plan:
    errors = [np.sqrt(np.diag(P)) / scale for P in covariances]
    unknown = ~np.isfinite(result.parameter_stderr)
    errors[0] = np.where(unknown, np.inf, errors[0])
    dofs = (result.dof, result.dof + 3 * len(picked))
    t = [float(stdtrit(dof, 0.975)) if dof > 0 else np.inf for dof in dofs]
    path = [float("nan")] * 2
    if isinstance(goal, PathLoad):
        D = _path_regressor(robot, result, goal) / scale
        path = [float(np.sqrt(np.einsum("mci,ij,mcj->", D, P, D) / len(D))) for P in covariances]
    theta = candidates.theta[picked]
    return Plan(
        theta=frozen(theta),
        x_M=frozen(world_from_pose(tool_pose(robot, theta))),
        F=frozen(candidates.F[picked]),
        labels=result.labels,
        before=frozen(errors[0]),
        after=frozen(errors[1]),
        half_before=frozen(t[0] * errors[0]),
        half_after=frozen(t[1] * errors[1]),
        goal=words,
        path_before=path[0],
        path_after=path[1],
    )
