"""Where the joints must stand: inverse kinematics, checked by forward kinematics before anyone uses it."""

from __future__ import annotations

from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, IntArray, as_floats
from robomill.errors import KinematicsError
from robomill.kinematics.choice import SPIN_STEPS, Score, choose, choose_spin, join_path, path_score, spun
from robomill.kinematics.decoupled import Decoupled, branch_names, decoupled
from robomill.kinematics.forward import BLOCK
from robomill.kinematics.numeric import bent_home, solve_numerically
from robomill.kinematics.result import RESIDUAL, IKResult, Mode, check, task_mode, within_residual
from robomill.kinematics.solutions import compiled_solutions, nearest_solutions, solutions
from robomill.robot.model import Robot

Spin = float | Literal["least motion", "fixed"]
Found = tuple[FloatArray, IntArray, FloatArray | None]
Fit = tuple[FloatArray, FloatArray]


def inverse_kinematics(
    robot: Robot,
    T_MT: ArrayLike,
    *,
    branch: str | None = None,
    near: ArrayLike | Literal["path"] | None = None,
    spin: Spin = "least motion",
) -> IKResult:
    """Configurations theta (..., n) that bring the tool to T_MT (..., 4, 4), within the joint limits.

    What of the pose counts: up to four joints the tip only (a planar arm reaches points of its plane); five joints the
    tip and the tool axis z_T; six and seven joints the same, and the spin about the tool axis, which is free in
    milling, follows ``spin``: "least motion" (the turn that moves the joints least from ``near`` or from home; along a
    path one turn for the whole path), "fixed" (the pose as given, all six coordinates) or an angle in rad by which the
    given pose is turned about z_T.

    Which solution: ``branch`` keeps those whose name contains every part given ("elbow down", "front, wrist -").
    ``near`` (..., n) takes the one nearest to a configuration; "path" joins the poses of the last batch axis with the
    least joint motion. Otherwise shoulder and elbow stand as at home where the limits allow, the wrist nearest to home.

    Decoupled arms are solved in closed form, others numerically. A pose is reached when forward kinematics meets it to
    1e-9 m and 1e-9 rad; otherwise theta is NaN and ``reason`` says why. Raises KinematicsError for poses that are not
    numbers, an unknown branch, or a branch asked of an arm without named ones.
    """
    T_MT = as_floats(T_MT, "T_MT", (4, 4), error=KinematicsError)
    lead = T_MT.shape[:-2]
    flat = T_MT.reshape(-1, 4, 4)
    along_path = isinstance(near, str)
    if along_path and (near != "path" or not lead):
        raise KinematicsError(f"near: expected a configuration, or 'path' for a batch of poses; found {near!r}.")
    goal = robot.home[None] if near is None or along_path else _reference(robot, near, lead)
    free_spin = robot.n >= 6 and spin == "least motion"
    mode: Mode = "axis" if free_spin else task_mode(robot)
    if robot.n >= 6 and not isinstance(spin, str):
        flat = spun(flat, float(spin))
    elif isinstance(spin, str) and spin not in ("least motion", "fixed"):
        raise KinematicsError(f"spin: expected 'least motion', 'fixed' or an angle in rad, found {spin!r}.")
    arm = decoupled(robot)
    names = ("numerical",) if arm is None else branch_names()
    fit: Fit | None = None
    if arm is None:
        if branch is not None:
            raise KinematicsError(f"{robot.name}: this arm has no named branches; leave branch out.")
        start = bent_home(robot)[None] if near is None or along_path else goal
        theta, index, turn = _numerical(robot, flat, start, mode, lead, along_path)
    elif along_path:
        theta, index, turn = _along_path(robot, arm, flat, lead[-1], branch_mask(branch), free_spin)
    else:
        theta, index, turn, fit = _closed(robot, arm, flat, goal, branch_mask(branch), near is None, free_spin)
    residual, angle = fit or check(robot, theta, flat, mode)[1:]
    reached = (index >= 0) & within_residual(residual, angle, mode)
    return IKResult(
        robot=robot,
        T_MT=flat.reshape(*lead, 4, 4),
        theta=np.where(reached[:, None], theta, np.nan).reshape(*lead, robot.n),
        reached=reached.reshape(lead),
        residual=residual.reshape(lead),
        residual_angle=angle.reshape(lead),
        branch_index=np.where(reached, index, -1).reshape(lead),
        branch_names=names,
        asked_branch=branch,
        free_spin=free_spin,
        spin=None if turn is None else turn.reshape(lead),
    )


def all_branches(robot: Robot, T_MT: ArrayLike) -> tuple[FloatArray, BoolArray]:
    """(theta (..., 8, n), sound (..., 8)): every closed-form solution, without limits, ordered as ``branch_names()``.

    ``sound`` says which meet the pose by forward kinematics to 1e-9 m and rad; angles are in (-pi, pi]. Six axes: the
    whole pose. Raises KinematicsError where the arm has no closed form.
    """
    T_MT = as_floats(T_MT, "T_MT", (4, 4), error=KinematicsError)
    arm = decoupled(robot)
    if arm is None:
        raise KinematicsError(
            f"{robot.name}: its wrist axes do not cross as a closed form needs; use inverse_kinematics."
        )
    flat = T_MT.reshape(-1, 4, 4)
    lead = T_MT.shape[:-2]
    found = compiled_solutions(robot, arm, flat, RESIDUAL)
    if found is not None:
        return found[0].reshape(*lead, 8, robot.n), found[1].reshape(*lead, 8)
    theta = np.empty((len(flat), 8, robot.n))
    sound = np.empty((len(flat), 8), dtype=bool)
    for start in range(0, len(flat), BLOCK):
        block = slice(start, start + BLOCK)
        theta[block], possible = solutions(robot, arm, flat[block])
        sound[block] = possible & check(robot, theta[block], flat[block, None], task_mode(robot))[0]
    return theta.reshape(*lead, 8, robot.n), sound.reshape(*lead, 8)


def branch_mask(branch: str | None) -> BoolArray:
    """(8,) which solutions a branch name or part of one asks for."""
    names = branch_names()
    if branch is None:
        return np.ones(len(names), dtype=bool)
    parts = [part.strip() for part in branch.split(",") if part.strip()]
    mask = np.array([all(part in name.split(", ") for part in parts) for name in names])
    if not parts or not mask.any():
        raise KinematicsError(
            f"branch {branch!r}: expected some of front, back, elbow up, elbow down, wrist +, wrist -."
        )
    return mask


def _reference(robot: Robot, near: object, lead: tuple[int, ...]) -> FloatArray:
    value = as_floats(near, "near", (robot.n,), error=KinematicsError)  # type: ignore[arg-type]
    return np.broadcast_to(value, (*lead, robot.n)).reshape(-1, robot.n)


def _closed(
    robot: Robot,
    arm: Decoupled,
    flat: FloatArray,
    goal: FloatArray,
    wanted: BoolArray,
    arm_first: bool,
    free_spin: bool,
) -> tuple[FloatArray, IntArray, FloatArray | None, Fit | None]:
    """(theta, index, spin, (residual, residual angle) where the kernel has found them already)."""
    compiled = nearest_solutions(robot, arm, flat, goal, wanted, arm_first, SPIN_STEPS if free_spin else 0)
    if compiled is None:
        return (*_pose_by_pose(robot, arm, flat, goal, wanted, arm_first, free_spin), None)
    theta, index, fit = compiled
    return theta, index, fit[:, 0] if free_spin else None, (fit[:, 1], fit[:, 2])


def _pose_by_pose(
    robot: Robot,
    arm: Decoupled,
    flat: FloatArray,
    goal: FloatArray,
    wanted: BoolArray,
    arm_first: bool,
    free_spin: bool,
) -> Found:
    theta = np.empty((len(flat), robot.n))
    index = np.empty(len(flat), dtype=np.int64)
    turn = np.zeros(len(flat)) if free_spin else None
    for start in range(0, len(flat), BLOCK):
        block = slice(start, start + BLOCK)
        target = (goal if len(goal) == 1 else goal[block])[:, None, :]
        if free_spin and not arm.spindle_on_last_axis:
            found = choose_spin(robot, partial(solutions, robot, arm), flat[block], target, wanted, arm_first)
            theta[block], index[block], turn[block] = found  # type: ignore[index]
            continue
        every, possible = solutions(robot, arm, flat[block])
        if free_spin:
            every[..., 5] = target[..., 5]
        theta[block], index[block], _ = choose(robot, every, possible & wanted, target, arm_first)
    return theta, index, turn


def _along_path(
    robot: Robot, arm: Decoupled, flat: FloatArray, length: int, wanted: BoolArray, free_spin: bool
) -> Found:
    """Each run of ``length`` poses joined; with a free spin, one spin a run: most poses reached, then least motion."""
    theta = np.empty((len(flat), robot.n))
    index = np.empty(len(flat), dtype=np.int64)
    turn = np.zeros(len(flat)) if free_spin else None

    def every(T_MT: FloatArray, angle: float) -> tuple[FloatArray, BoolArray]:
        found, possible = solutions(robot, arm, spun(T_MT, angle))
        if free_spin and arm.spindle_on_last_axis:
            found[..., 5] = robot.home[5]
        return found, possible & wanted

    def score(T_MT: FloatArray, angle: float) -> Score:
        return path_score(robot, *every(T_MT, angle), robot.home)

    choose_it = free_spin and not arm.spindle_on_last_axis
    for start in range(0, len(flat), max(length, 1)):
        run = slice(start, start + length)
        best = 0.0
        if choose_it:
            angles = (2 * np.pi / SPIN_STEPS * np.arange(SPIN_STEPS)).tolist()
            best = min(angles, key=partial(score, flat[run]))
        theta[run], index[run] = join_path(robot, *every(flat[run], best), robot.home)
        if turn is not None:
            turn[run] = best
    return theta, index, turn


def _numerical(
    robot: Robot, flat: FloatArray, goal: FloatArray, mode: Mode, lead: tuple[int, ...], along_path: bool
) -> Found:
    if not along_path:
        theta, found = solve_numerically(robot, flat, goal, mode)
        return theta, np.where(found, 0, -1), None
    theta = np.empty((len(flat), robot.n))
    found = np.empty(len(flat), dtype=bool)
    length = lead[-1]
    for start in range(0, len(flat), max(length, 1)):
        near = goal
        for i in range(start, start + length):
            theta[i : i + 1], found[i : i + 1] = solve_numerically(robot, flat[i : i + 1], near, mode)
            near = theta[i : i + 1] if found[i] else near
    return theta, np.where(found, 0, -1), None
