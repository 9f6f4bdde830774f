"""Inverse kinematics of any arm: damped least squares on whole batches, from several starts, within the limits.

The damping follows the error (Sugihara, IEEE T-RO 27 (2011) 984: half the squared error plus a small bias), so steps
are careful far away and Newton's near the solution.
"""

from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.kinematics.choice import turn
from robomill.kinematics.decoupled import RESIDUAL
from robomill.kinematics.extent import drawn, stretch
from robomill.kinematics.forward import BLOCK, tool_pose
from robomill.kinematics.jacobian import pose_and_jacobian
from robomill.kinematics.result import Mode
from robomill.progress import checkpoint
from robomill.robot.model import Robot

STARTS = 64  # starts a pose is given before it counts as not found
LIBRARY = 8192  # random configurations from which the nearest serve as starts
COMPARED = 8  # starts of which small arms take the solution nearest to the reference
NEAREST = 32  # starts of which any arm takes it where the nearest solution is asked for
TOGETHER = 512  # descents at once where poses are few: starts beside each other cost hardly more than one
STEPS = 40
TASKS = {"position": 3, "axis": 5, "pose": 6}  # what is asked of a pose
SAME = 1e-7  # rad (or m): two descents that differ by no more have found one solution
TIGHT = 1e-11  # m and rad: where iteration stops, well inside the residual that counts
PATIENCE = 6  # steps in which the error must have halved
OTHER_SIDE = 1e3  # rad^2: far above any joint motion
BEND = 0.6  # rad (or m)
LONGEST_STEP = 0.6  # rad (or m) a joint may move in one step


def solve_numerically(
    robot: Robot, T_MT: FloatArray, near: FloatArray, mode: Mode, nearest: bool = False
) -> tuple[FloatArray, BoolArray]:
    """(theta (m, n), found (m,)) for poses T_MT (m, 4, 4), started from ``near`` (1 or m, n) and then from near misses.

    ``mode`` says what of the pose counts, as in ``result.task_mode``; ``nearest`` asks for the solution with the least
    joint motion from ``near``, over branches and whole turns. Deterministic: the starts have a fixed seed.
    """
    m = len(T_MT)
    theta = np.empty((m, robot.n))
    found = np.empty(m, dtype=bool)
    for start in range(0, m, BLOCK):
        block = slice(start, start + BLOCK)
        reference = near if len(near) == 1 else near[block]
        theta[block], found[block] = _solve_block(robot, T_MT[block], reference, mode, nearest)
    return theta, found


def followed(robot: Robot, T_MT: FloatArray, near: FloatArray, mode: Mode) -> FloatArray:
    """(k, n) the joints of the first k of the poses T_MT (m, 4, 4): each as it is found from the one before, the first
    from ``near`` (1, n), as far as that leads.

    Where a pose has no other solution nearby they are all sought at once, from ``near``, and then each from what was
    found before it: what stays is what one after the other would find. Else they are taken one by one.
    """
    m = len(T_MT) if robot.n == TASKS[mode] else 1
    first, error = descend(robot, T_MT[:m], np.repeat(near, m, axis=0), mode)
    if m == 1:
        return first[error <= TIGHT]
    theta, error = descend(robot, T_MT, np.concatenate([near, first[:-1]]), mode)
    leads = np.append(True, np.abs(theta - first).max(axis=1)[:-1] <= SAME) & (error <= TIGHT)
    return theta[: m if leads.all() else int(np.argmin(leads))]


def bent_home(robot: Robot) -> FloatArray:
    """(n,) home with every joint after the first turned a little: a straight arm is singular and has no elbow side.

    Starting there, neighbouring poses mostly end on the same side.
    """
    bend = np.where(np.arange(robot.n) > 0, BEND, 0.0)
    return np.clip(robot.home + bend, robot.limits[:, 0], robot.limits[:, 1])


def _solve_block(
    robot: Robot, T_MT: FloatArray, near: FloatArray, mode: Mode, nearest: bool
) -> tuple[FloatArray, BoolArray]:
    m = len(T_MT)
    reference = np.array(np.broadcast_to(near, (m, robot.n)))
    theta, error = descend(robot, T_MT, reference, mode)
    theta = turn(robot, theta, reference) if nearest else theta
    compared = NEAREST if nearest else COMPARED if mode == "position" else 0
    remote = _motion if nearest else _remoteness
    starts: FloatArray | None = None
    possible = _within_stretch(robot, T_MT)
    attempt, many = 0, 1
    while attempt < STARTS:
        compare = attempt < compared
        open_ = np.flatnonzero(possible if compare else (error > TIGHT) & possible)
        if not open_.size:
            break
        if starts is None:
            starts, first = _starts(robot, T_MT[open_], mode), open_
            if nearest:
                starts = _in_order(robot, starts, reference[open_])
        rows, past = np.searchsorted(first, open_), min(attempt + many, compared if compare else STARTS)
        for trial, remains in _descents(robot, T_MT[open_], starts[rows, attempt:past], mode):
            trial = turn(robot, trial, reference[open_]) if nearest else trial
            better = np.where(error[open_] > TIGHT, remains < error[open_], False)
            if compare:
                nearer = remote(trial, reference[open_]) < remote(theta[open_], reference[open_])
                better |= (remains <= TIGHT) & (error[open_] <= TIGHT) & nearer
            theta[open_[better]], error[open_[better]] = trial[better], remains[better]
        attempt, many = past, max(TOGETHER // len(open_), 1)
    return theta, error <= TIGHT


def _descents(
    robot: Robot, T_MT: FloatArray, starts: FloatArray, mode: Mode
) -> Iterator[tuple[FloatArray, FloatArray]]:
    """(theta (m, n), error (m,)) from each of the starts (m, k, n), one after the other."""
    m, k, n = starts.shape
    theta, error = descend(robot, np.tile(T_MT, (k, 1, 1)), starts.swapaxes(0, 1).reshape(-1, n), mode)
    return zip(theta.reshape(k, m, n), error.reshape(k, m), strict=True)


def _in_order(robot: Robot, starts: FloatArray, reference: FloatArray) -> FloatArray:
    """Starts (m, STARTS, n) with those first from which the joints have the least way to the reference (m, n)."""
    order = np.argsort(_motion(turn(robot, starts, reference[:, None]), reference[:, None]), axis=1)
    return np.take_along_axis(starts, order[..., None], axis=1)


def _motion(theta: FloatArray, reference: FloatArray) -> FloatArray:
    """(...) joint motion from the reference (..., n), squared."""
    return np.asarray(((theta - reference) ** 2).sum(axis=-1))


def _remoteness(theta: FloatArray, reference: FloatArray) -> FloatArray:
    """(m,) joint motion from the reference (m, n), after how many joints past the first bend to its other side.

    The side comes first, so that over a map a planar arm keeps its elbow where the limits allow.
    """
    other_side = (theta[:, 1:] * reference[:, 1:] < 0).sum(axis=1)
    return OTHER_SIDE * other_side + _motion(theta, reference)


def _within_stretch(robot: Robot, T_MT: FloatArray) -> BoolArray:
    """(m,) False where the tip is further out than all links in a line, or off the plane of a planar arm."""
    near = np.linalg.norm(T_MT[:, :3, 3] - robot.chain.T_0[:3, 3], axis=1) <= stretch(robot) + RESIDUAL
    normal, offset = _plane(robot)
    return near & (np.abs(T_MT[:, :3, 3] @ normal - offset) <= RESIDUAL).all(axis=1)


@lru_cache(maxsize=16)
def _plane(robot: Robot) -> tuple[FloatArray, FloatArray]:
    """(normals (3, k), offsets (k,)): directions in which the tip cannot move; k is 1 for a planar arm, else 0."""
    pose, J = pose_and_jacobian(robot, drawn(robot, 32))
    u, size, _ = np.linalg.svd(J[:, :3].transpose(1, 0, 2).reshape(3, -1))
    normal = u[:, size < 1e-9]
    return normal, pose[0, :3, 3] @ normal


def descend(robot: Robot, T_MT: FloatArray, theta: FloatArray, mode: Mode) -> tuple[FloatArray, FloatArray]:
    """(theta (m, n), error (m,)) after damped least squares from theta (m, n); coordinates stay within the limits."""
    theta = np.clip(theta, robot.limits[:, 0], robot.limits[:, 1])
    error = np.full(len(theta), np.inf)
    before = error.copy()
    active = np.arange(len(theta))
    for step in range(STEPS + 1):
        checkpoint()
        pose, J = pose_and_jacobian(robot, theta[active])
        e, J = _task(pose, J, T_MT[active], mode)
        size = np.abs(e).max(axis=1)
        error[active] = size
        going = size > TIGHT
        if step % PATIENCE == 0:
            # A descent that is stuck at a limit or in a dip does not get better by waiting.
            going &= size < 0.5 * before[active]
            before[active] = size
        if step == STEPS or not going.any():
            break
        active, e, J = active[going], e[going], J[going]
        move = _damped_step(J, e)
        at = theta[active]
        stuck = ((at <= robot.limits[:, 0]) & (move < 0)) | ((at >= robot.limits[:, 1]) & (move > 0))
        again = np.flatnonzero(stuck.any(axis=1))
        if again.size:
            # Joints pressed against a limit cannot help: let the others do the work.
            move[again] = _damped_step(np.where(stuck[again, None, :], 0.0, J[again]), e[again])
        move *= np.minimum(1.0, LONGEST_STEP / np.maximum(np.abs(move).max(axis=1), 1e-300))[:, None]
        theta[active] = np.clip(theta[active] + move, robot.limits[:, 0], robot.limits[:, 1])
    return theta, error


def _damped_step(J: FloatArray, e: FloatArray) -> FloatArray:
    """Joint motions (m, n) that reduce the errors e (m, k): J^T (J J^T + damping)^-1 e."""
    damping = 0.5 * (e**2).sum(axis=1) + 1e-13
    JJt = J @ np.swapaxes(J, 1, 2) + damping[:, None, None] * np.eye(J.shape[1])
    return np.einsum("mkn,mk->mn", J, np.linalg.solve(JJt, e[..., None])[..., 0])


def _task(pose: FloatArray, J: FloatArray, T_MT: FloatArray, mode: Mode) -> tuple[FloatArray, FloatArray]:
    """(error (m, k), Jacobian (m, k, n)) of what counts; angles as the tangent-plane components of the turn left."""
    e_v = T_MT[:, :3, 3] - pose[:, :3, 3]
    if mode == "position":
        return e_v, J[:, :3]
    if mode == "axis":
        # x and y of the tool span the tangent plane of its axis; the sine would fold a half turn, the angle does not.
        R = pose[:, :3, :3]
        aim = np.einsum("mji,mj->mi", R, T_MT[:, :3, 2])
        sine = np.hypot(aim[:, 0], aim[:, 1])
        scale = np.where(sine > 1e-12, np.arctan2(sine, aim[:, 2]) / np.maximum(sine, 1e-12), 1.0)
        e_w = np.stack([-aim[:, 1] * scale, aim[:, 0] * scale], axis=1)
        return np.concatenate([e_v, e_w], axis=1), np.concatenate(
            [J[:, :3], np.einsum("mji,mjn->min", R[:, :, :2], J[:, 3:])], axis=1
        )
    turn = T_MT[:, :3, :3] @ np.swapaxes(pose[:, :3, :3], 1, 2)
    w = 0.5 * np.stack(
        [turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]], axis=1
    )
    sine, cosine = np.linalg.norm(w, axis=1), 0.5 * (np.trace(turn, axis1=1, axis2=2) - 1.0)
    scale = np.where(sine > 1e-12, np.arctan2(sine, cosine) / np.maximum(sine, 1e-12), 1.0)
    return np.concatenate([e_v, w * scale[:, None]], axis=1), J


def _features(T: FloatArray, mode: Mode) -> FloatArray:
    """What makes two poses near: position (m), and directions of the tool's axes weighed at half a metre a radian."""
    if mode == "position":
        return T[:, :3, 3]
    axes = T[:, :3, 2] if mode == "axis" else T[:, :3, :3].reshape(len(T), 9)
    return np.concatenate([T[:, :3, 3], 0.5 * axes], axis=1)


@lru_cache(maxsize=16)
def _library(robot: Robot, mode: Mode) -> tuple[Any, FloatArray]:
    from scipy.spatial import cKDTree

    theta = drawn(robot, LIBRARY, seed=20130401)
    return cKDTree(_features(tool_pose(robot, theta), mode)), theta


def _starts(robot: Robot, T_MT: FloatArray, mode: Mode) -> FloatArray:
    """(m, STARTS, n): the library's configurations whose poses are nearest to the wanted ones."""
    tree, theta = _library(robot, mode)
    _, nearest = tree.query(_features(T_MT, mode), k=STARTS)
    return theta[nearest]
