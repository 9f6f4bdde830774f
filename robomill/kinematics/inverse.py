"""Where the joints must stand: inverse kinematics, checked by forward kinematics before anyone uses it."""

from __future__ import annotations

from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, IntArray, as_floats
from robomill.errors import KinematicsError
from robomill.kinematics.choice import SPIN_STEPS, Score, every, join_path, nearest, path_score, rules, spun
from robomill.kinematics.decoupled import Decoupled, branch_names, decoupled
from robomill.kinematics.numeric import bent_home, solve_numerically
from robomill.kinematics.result import IKResult, Mode, misfit, task_mode, within_residual
from robomill.robot.model import Robot

Spin = float | Literal["least motion", "fixed"]
Found = tuple[FloatArray, IntArray, FloatArray | None]  # theta (m, n), branch (m,), spin (m,)


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
    if arm is None:
        if branch is not None:
            raise KinematicsError(f"{robot.name}: this arm has no named branches; leave branch out.")
        start = bent_home(robot)[None] if near is None or along_path else goal
        theta, index, turn = _numerical(robot, flat, start, mode, lead, along_path)
    elif along_path:
        theta, index, turn = _along_path(robot, arm, flat, lead[-1], branch_mask(branch), free_spin)
    else:
        theta, index, fit = nearest(
            robot, arm, flat, goal, rules(robot, arm, branch_mask(branch), near is None, free_spin)
        )
        turn, residual, angle = (fit[:, 0] if free_spin else None), fit[:, 1], fit[:, 2]
    if arm is None or along_path:
        residual, angle = misfit(robot, theta, flat, mode)
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


def _along_path(
    robot: Robot, arm: Decoupled, flat: FloatArray, length: int, wanted: BoolArray, free_spin: bool
) -> Found:
    """Each run of ``length`` poses joined; with a free spin, one spin a run: most poses reached, then least motion."""
    theta = np.empty((len(flat), robot.n))
    index = np.empty(len(flat), dtype=np.int64)
    turn = np.zeros(len(flat)) if free_spin else None

    def solutions(T_MT: FloatArray, angle: float) -> tuple[FloatArray, BoolArray]:
        found, sound = every(robot, arm, spun(T_MT, angle))
        if free_spin and arm.spindle_on_last_axis:
            found[..., 5] = robot.home[5]
        return found, sound & wanted

    def score(T_MT: FloatArray, angle: float) -> Score:
        return path_score(robot, *solutions(T_MT, angle), robot.home)

    choose_it = free_spin and not arm.spindle_on_last_axis
    for start in range(0, len(flat), max(length, 1)):
        run = slice(start, start + length)
        best = 0.0
        if choose_it:
            angles = (2 * np.pi / SPIN_STEPS * np.arange(SPIN_STEPS)).tolist()
            best = min(angles, key=partial(score, flat[run]))
        theta[run], index[run] = join_path(robot, *solutions(flat[run], best), robot.home)
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
