"""Where to measure next: poses and directions that make the compliances, one joint, or one path most certain.

A test at a candidate adds A^T A / sigma^2 to the information; the next one is the candidate that gains most, chosen
one after another. Goals: "all" grows the determinant (D-optimal: the volume of the joint uncertainty), a joint
number shrinks that joint's variance (c-optimal), a path shrinks the mean variance of its predicted deviation.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from robomill.arrays import FloatArray, frozen
from robomill.errors import LoadTestError
from robomill.identification.configurations import sliding_joints
from robomill.identification.fit.balance import balanced
from robomill.identification.fit.confidence import half_width
from robomill.identification.fit.models import Parameter
from robomill.identification.fit.system import build_system
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.result import IdentificationResult
from robomill.identification.synthesis import three_directions
from robomill.kinematics.forward import tool_pose
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import pose_from_world, world_from_pose
from robomill.provenance import Provenance
from robomill.robot.model import Robot
from robomill.units import format_percent, format_si

POSES = 300  # among which those of a plan are chosen
MARGIN = 0.15  # m: how far beyond the measured tips poses are looked for
PRIOR = 1e-10  # information, scaled, that stands in where the tests have none


class Loads(NamedTuple):
    """Tests one could do, or a machining path to be certain of: theta (m, n) and forces F (m, 3) N in {M}."""

    theta: FloatArray
    F: FloatArray


@dataclass(frozen=True, eq=False)
class Plan:
    """The tests to do next, best first: theta (k, n), x_M (k, 5), F (k, 3) N.

    before, after (p,): standard errors as they are and as they should become; half_before, half_after (p,): half
    widths of the 95 % intervals; path_before, path_after: rms standard deviation (m) of the path's deviation. sliding:
    numbers of the joints that slide, whose coordinates are lengths.
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
    sliding: tuple[int, ...] | None = None

    def as_tests(self) -> LoadTests:
        """The plan as a measuring sheet: displacements zero, to be filled in."""
        made = Provenance("computed", f"plan: {self.goal}")
        return LoadTests(self.F, np.zeros_like(self.F), theta=self.theta, sliding=self.sliding, provenance=made)

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
        interval = f"the interval of {self.labels[k].label} by {format_percent(gain[k])}"
        text = f"{len(self.F)} more tests should narrow {interval}"
        if np.isfinite(self.path_before):
            was, now = format_si(self.path_before, "um"), format_si(self.path_after, "um")
            text += f", and the path's predicted deviation from ±{was} to ±{now} (one standard deviation)"
        return text + "."


def box_candidates(
    robot: Robot,
    lower: FloatArray,
    upper: FloatArray,
    *,
    tilt: float = np.pi / 6,
    load: float = 250.0,
    poses: int = POSES,
    seed: int = 1,
) -> Loads:
    """Poses spread over a box in {M} (corners in m) with the tool tilted by up to ``tilt`` rad, within the limits.

    Each is loaded by ``load`` N along +X, +Y and +Z. Raises LoadTestError where nothing in the box is reached.
    """
    span = np.array([tilt, tilt])
    low = np.concatenate([np.asarray(lower, dtype=np.float64), -span])
    high = np.concatenate([np.asarray(upper, dtype=np.float64), span])
    if (high < low).any():
        raise LoadTestError("Plan: the upper corner of the box lies below its lower corner.")
    from scipy.stats import qmc  # takes a second, in which no other page runs

    points = low + (high - low) * qmc.Halton(5, seed=seed).random(poses)
    solved = inverse_kinematics(robot, pose_from_world(points))
    theta = solved.theta[solved.reached]
    if len(theta) == 0:
        raise LoadTestError("Plan: no pose in the box is reached within the joint limits; move the box or tilt less.")
    return Loads(*three_directions(theta, load))


def candidates_around(robot: Robot, tests: LoadTests, *, tilt: float = np.pi / 6, load: float = 250.0) -> Loads:
    """Poses within ``MARGIN`` of those that were measured."""
    tips = tests.with_joints(robot).tool_poses(robot)[:, :3, 3]
    return box_candidates(robot, tips.min(axis=0) - MARGIN, tips.max(axis=0) + MARGIN, tilt=tilt, load=load)


class _Aim(NamedTuple):
    """What a plan is for: in words, and the weight (p, p) of the covariance it makes small (None: the determinant)."""

    words: str
    weight: FloatArray | None
    path: bool = False


def next_best(
    robot: Robot,
    tests: LoadTests | JointTests,
    result: IdentificationResult,
    candidates: Loads | None = None,
    *,
    count: int = 3,
    goal: str | int | Loads = "all",
) -> Plan:
    """The ``count`` candidates to measure next for a goal: "all", a joint number, or a Loads.

    ``candidates`` are those around what was measured unless given. Where points of the tool were fitted, what is known
    before is what the fit knows of the compliances with them. A reading is taken to be as noisy as the residuals
    say. Raises LoadTestError where there are none to judge by.
    """
    if tests.single:
        raise LoadTestError("Plan: one joint at a time needs none; load the joint that is known least once more.")
    if not (np.isfinite(result.noise) and result.noise > 0):
        raise LoadTestError("Plan: the noise is not known (no residuals to judge by); state it in mm.")
    aim = _aim(robot, result, goal)
    candidates = candidates or candidates_around(robot, tests)
    by_size = result.treatment.weights == "size"
    system = balanced(build_system(robot, tests.without(result.excluded), result.choice, by_size=by_size))
    D = result.choice.tip_regressor(robot, candidates.theta, candidates.F)
    scale = np.sqrt((system.A**2).sum(axis=0) + (D**2).mean(axis=(0, 1)))  # above zero wherever either sees anything
    scale[scale == 0] = 1.0  # a spring that neither can see
    A = system.A / scale / (result.noise * system.noise / np.median(system.noise))[:, None]
    M = A.T @ A if not result.points else _known(result, scale)
    before = P = np.linalg.inv(M + PRIOR * float(np.trace(M)) * np.eye(len(M)))
    live = np.array([parameter.label not in result.lumped for parameter in system.parameters])
    blocks = D / scale / result.noise * live
    weight = None if aim.weight is None else aim.weight / np.outer(scale, scale)
    picked: list[int] = []
    for _ in range(count):
        best = _best(P, blocks, weight, picked)
        picked.append(best)
        W = blocks[best] @ P
        P = P - W.T @ np.linalg.solve(np.eye(3) + W @ blocks[best].T, W)
    path = [float(np.sqrt(np.trace(weight @ Q))) if aim.path and weight is not None else np.nan for Q in (before, P)]
    errors = [np.sqrt(np.diag(Q)) / scale for Q in (before, P)]
    errors[0][~np.isfinite(result.parameter_stderr)] = np.inf
    told = np.sqrt(np.nan_to_num(np.diag(result.covariance)))  # loads that err make a fit less sure than its noise does
    known = (told > 0.0) & np.isfinite(errors[0]) & (errors[0] > 0.0)
    errors = [error * np.divide(told, errors[0], out=np.ones_like(told), where=known) for error in errors]
    half = [half_width(error, result.dof + 3 * added) for added, error in zip((0, count), errors, strict=True)]
    theta = candidates.theta[picked]
    return Plan(
        theta=frozen(theta),
        x_M=frozen(world_from_pose(tool_pose(robot, theta))),
        F=frozen(candidates.F[picked]),
        labels=result.labels,
        before=frozen(errors[0]),
        after=frozen(errors[1]),
        half_before=frozen(half[0]),
        half_after=frozen(half[1]),
        goal=aim.words,
        path_before=path[0],
        path_after=path[1],
        sliding=sliding_joints(robot),
    )


def _known(result: IdentificationResult, scale: FloatArray) -> FloatArray:
    """(p, p) what a fit that found points of the tool, too, knows of its compliances times ``scale`` (p,), whatever the
    points are: the inverse of their covariance; zero of those that no test has seen."""
    M = np.zeros_like(result.covariance)
    seen = np.ix_(*2 * (np.isfinite(np.diag(result.covariance)) & (np.diag(result.covariance) > 0.0),))
    M[seen] = np.linalg.pinv((result.covariance * np.outer(scale, scale))[seen], hermitian=True)
    return M


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


def _aim(robot: Robot, result: IdentificationResult, goal: str | int | Loads) -> _Aim:
    if isinstance(goal, Loads):
        D = result.choice.tip_regressor(robot, goal.theta, goal.F)
        D = D[np.isfinite(D).all(axis=(-1, -2))]
        if len(D) == 0:
            raise LoadTestError("Plan: no point of the path is reached.")
        return _Aim("this path's deviation", np.einsum("mci,mcj->ij", D, D) / len(D), path=True)
    if goal == "all":
        return _Aim("all compliances", None)
    chosen = np.array([parameter.joint == goal for parameter in result.labels])
    if not isinstance(goal, int):
        raise LoadTestError(f"Plan: goal {goal!r}; expected 'all', a joint number or a path.")
    if not chosen.any():
        raise LoadTestError(f"Plan: joint {goal} is not among the fitted joints.")
    return _Aim(f"joint {goal}", np.diag(chosen.astype(np.float64)))
