"""Where the joints must stand: inverse kinematics, checked by forward kinematics before anyone uses it."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, IntArray, as_floats
from robomill.errors import KinematicsError
from robomill.kinematics.decoupled import Decoupled, branch_names, decoupled, solutions
from robomill.kinematics.forward import BLOCK, tool_pose
from robomill.kinematics.result import LIMIT_SLACK, RESIDUAL, IKResult, overshoot, wrap
from robomill.robot.model import Robot

# Order in which shoulder and elbow are tried: as at home, other elbow, other shoulder, both.
ARM_ORDER = np.array([0, 0, 1, 1, 2, 2, 3, 3])


def inverse_kinematics(
    robot: Robot,
    T_MT: ArrayLike,
    *,
    branch: str | None = None,
    near: ArrayLike | Literal["path"] | None = None,
) -> IKResult:
    """Configurations theta (..., n) that bring the tool to T_MT (..., 4, 4), within the joint limits.

    Five axes: the tip and the tool axis z_T count, the spin about the tool axis is free. ``branch`` keeps the solutions
    whose name contains every word given ("elbow down", "front, wrist -"). ``near`` (..., n) takes the solution nearest
    to a configuration; "path" joins the poses of the last batch axis with the least joint motion. Otherwise shoulder
    and elbow stand as at home where that is within limits, and the wrist nearest to home.

    A pose is reached when forward kinematics meets it to 1e-9 m and 1e-9 rad; otherwise theta is NaN and
    ``reason`` says why. Raises KinematicsError for poses that are not numbers or an unknown branch.
    """
    T_MT = as_floats(T_MT, "T_MT", (4, 4), error=KinematicsError)
    lead = T_MT.shape[:-2]
    flat = T_MT.reshape(-1, 4, 4)
    arm = decoupled(robot)
    if arm is None:
        raise KinematicsError(f"{robot.name}: no closed-form inverse kinematics for this arm.")
    wanted = branch_mask(branch)
    theta = np.empty((len(flat), robot.n))
    index = np.empty(len(flat), dtype=np.int64)
    if isinstance(near, str):
        if near != "path":
            raise KinematicsError(f"near: expected a configuration or 'path', found {near!r}.")
        reference: FloatArray | None = None
    else:
        reference = None if near is None else _reference(robot, near, lead)
    for start in range(0, len(flat), BLOCK):
        block = slice(start, start + BLOCK)
        every = solutions(arm, flat[block]).transpose(2, 0, 1)
        goal = robot.home if reference is None else reference[block, None, :]
        theta[block], index[block] = choose(robot, every, goal, wanted, reference is None)
    sound, residual, angle = check(robot, theta, flat)
    reached = sound & (index >= 0)
    theta[~reached] = np.nan
    index[~reached] = -1
    return IKResult(
        robot=robot,
        T_MT=T_MT,
        theta=theta.reshape(*lead, robot.n),
        reached=reached.reshape(lead),
        residual=residual.reshape(lead),
        residual_angle=angle.reshape(lead),
        branch_index=index.reshape(lead),
        branch_names=branch_names(),
        asked_branch=branch,
    )


def _reference(robot: Robot, near: ArrayLike, lead: tuple[int, ...]) -> FloatArray:
    value = as_floats(near, "near", (robot.n,), error=KinematicsError)
    return np.broadcast_to(value, (*lead, robot.n)).reshape(-1, robot.n)


def branch_mask(branch: str | None) -> BoolArray:
    """(8,) which solutions a branch name or part of one asks for."""
    names = branch_names()
    if branch is None:
        return np.ones(len(names), dtype=bool)
    parts = [part.strip() for part in branch.split(",") if part.strip()]
    mask = np.array([all(part in name.split(", ") for part in parts) for name in names])
    if not parts or not mask.any():
        raise KinematicsError(f"branch {branch!r}: expected some of 'front', 'back', 'elbow up', 'elbow down', 'wrist +', 'wrist -', joined by commas.")
    return mask


def choose(
    robot: Robot, every: FloatArray, goal: FloatArray, wanted: BoolArray, arm_first: bool
) -> tuple[FloatArray, IntArray]:
    """(theta (m, n), index (m,)) of the solutions every (m, 8, n) within limits that is nearest ``goal``; index -1: none.

    With ``arm_first`` the order of shoulder and elbow goes before nearness.
    """
    turned = wrap(every, robot.limits, goal)
    within = (np.abs(overshoot(robot, turned)) <= LIMIT_SLACK).all(axis=-1)
    cost = ((turned - goal) ** 2).sum(axis=-1)
    if arm_first:
        cost = cost + 1e6 * ARM_ORDER
    cost = np.where(within & wanted, cost, np.inf)
    index = np.argmin(cost, axis=-1)
    best = np.take_along_axis(turned, index[:, None, None], axis=1)[:, 0]
    found = np.isfinite(np.take_along_axis(cost, index[:, None], axis=1)[:, 0])
    return np.clip(best, robot.limits[:, 0], robot.limits[:, 1]), np.where(found, index, -1)


def check(robot: Robot, theta: FloatArray, T_MT: FloatArray) -> tuple[BoolArray, FloatArray, FloatArray]:
    """(sound, residual m, residual_angle rad), each (...,): forward kinematics of theta (..., n) against T_MT (..., 4, 4).

    Up to five axes only the tool axis is compared.
    """
    found = tool_pose(robot, theta)
    residual = np.linalg.norm(found[..., :3, 3] - T_MT[..., :3, 3], axis=-1)
    angle = np.linalg.norm(found[..., :3, 2] - T_MT[..., :3, 2], axis=-1)
    return (residual <= RESIDUAL) & (angle <= RESIDUAL), residual, angle


def structure(robot: Robot) -> Decoupled | None:
    """The closed-form structure of the arm, None where the numeric solver is used."""
    return decoupled(robot)
