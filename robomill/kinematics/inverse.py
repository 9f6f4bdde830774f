"""Where the joints must stand: inverse kinematics, checked by forward kinematics before anyone uses it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, IntArray, as_floats
from robomill.errors import KinematicsError
from robomill.kinematics.choice import every, nearest, rules, spins, spun
from robomill.kinematics.decoupled import Decoupled, branch_names, decoupled
from robomill.kinematics.forward import tool_pose
from robomill.kinematics.joining import Joined, join
from robomill.kinematics.numeric import bent_home, followed, solve_numerically
from robomill.kinematics.result import IKResult, Mode, misfit, task_mode, within_residual
from robomill.progress import checkpoint
from robomill.robot.model import Robot

Spin = float | Literal["least_motion", "fixed"]
LEAST_MOTION: Literal["least_motion"] = "least_motion"
SPINS = (LEAST_MOTION, "fixed")
THINNED = 200  # poses of a path by which its spins are compared
AHEAD = 256  # poses at most that are tried at once


@dataclass(frozen=True, eq=False)
class Wish:
    """What is asked of inverse kinematics: poses (m, 4, 4) in runs of ``length``, what of them counts, which solution.

    goal (1 or m, n) is what an answer is near to; None joins each run as a path. ``at_home``: shoulder and elbow as at
    home before all motion. given_spin: the turn about the tool axis that was asked for; None where it is free.
    """

    T_MT: FloatArray
    length: int
    mode: Mode
    goal: FloatArray | None
    at_home: bool
    branch: str | None
    free_spin: bool
    given_spin: float | None


class Chosen(NamedTuple):
    """theta (m, n), branch (m,), -1 where none is within limits, how far from the poses (m,) m and rad, and the turn
    (m,) about the tool axis that was chosen."""

    theta: FloatArray
    branch: IntArray
    residual: FloatArray
    angle: FloatArray
    turn: FloatArray | None


def inverse_kinematics(
    robot: Robot,
    T_MT: ArrayLike,
    *,
    branch: str | None = None,
    near: ArrayLike | Literal["path"] | None = None,
    spin: Spin = LEAST_MOTION,
) -> IKResult:
    """Configurations that bring the tool to poses, within the joint limits.

    Parameters
    ----------
    robot : Robot
        The arm, with n free joints.
    T_MT : array_like, (..., 4, 4)
        Poses of {T} in {M}, m. Up to four joints meet the tip only; five the tip and the tool axis z_T; six and seven
        these and the spin about z_T, which is free in milling.
    branch : str, optional
        Only solutions whose name contains every part given ("elbow down", "front, wrist -").
    near : array_like, (..., n), or "path", optional
        The solution nearest to a configuration; "path" joins the poses of the last batch axis with the least joint
        motion. Left out: shoulder and elbow stand as at home where the limits allow, the wrist nearest to home.
    spin : "least_motion", "fixed" or float
        Of arms with six joints or more: the turn that moves the joints least (along a path one for all), the pose as
        given, or an angle in rad by which it is turned about z_T.

    Returns
    -------
    IKResult
        theta (..., n), NaN where a pose is not reached; ``reason`` says why. Decoupled arms are solved in closed form,
        others numerically; a pose is reached when forward kinematics meets it to 1e-9 m and 1e-9 rad.

    Raises
    ------
    KinematicsError
        For poses that are not numbers, an unknown branch, or a branch asked of an arm without named ones.

    Examples
    --------
    >>> import robomill as rm
    >>> robot = rm.load_robot("slavkovic_5r")
    >>> found = rm.inverse_kinematics(robot, rm.pose_from_world([0.0, -1.3, 0.0, 0.0, 0.0]))
    >>> found.branch
    'front, elbow up, wrist +'
    """
    T_MT = as_floats(T_MT, "T_MT", (4, 4), error=KinematicsError)
    lead = T_MT.shape[:-2]
    wish = _wish(robot, T_MT, branch, near, spin)
    arm = decoupled(robot)
    if arm is not None:
        names, found = branch_names(), _closed(robot, arm, wish)
    elif branch is None:
        names, found = ("numerical",), _numerical(robot, wish)
    else:
        raise KinematicsError(f"{robot.name}: this arm has no named branches; leave branch out.")
    reached = (found.branch >= 0) & within_residual(found.residual, found.angle, wish.mode)
    return IKResult(
        robot=robot,
        T_MT=wish.T_MT.reshape(*lead, 4, 4),
        theta=np.where(reached[:, None], found.theta, np.nan).reshape(*lead, robot.n),
        reached=reached.reshape(lead),
        residual=found.residual.reshape(lead),
        branch_index=np.where(reached, found.branch, -1).reshape(lead),
        branch_names=names,
        asked_branch=branch,
        free_spin=wish.free_spin,
        spin=_spins(wish, found, lead),
    )


def _spins(wish: Wish, found: Chosen, lead: tuple[int, ...]) -> FloatArray | None:
    """The turn about the tool axis (...,), as given or found."""
    if wish.given_spin is not None:
        return np.full(lead, wish.given_spin)
    return None if found.turn is None else found.turn.reshape(lead)


def _wish(
    robot: Robot, T_MT: FloatArray, branch: str | None, near: ArrayLike | Literal["path"] | None, spin: Spin
) -> Wish:
    """The question checked; poses turned by the angle that is asked for."""
    lead, flat = T_MT.shape[:-2], T_MT.reshape(-1, 4, 4)
    along_path = isinstance(near, str)
    if along_path and (near != "path" or not lead):
        raise KinematicsError(f"near: expected a configuration, or 'path' for a batch of poses; found {near!r}.")
    if isinstance(spin, str) and spin not in SPINS:
        raise KinematicsError(f"spin: expected 'least_motion', 'fixed' or an angle in rad, found {spin!r}.")
    if robot.n >= 6 and not isinstance(spin, str):
        flat = spun(flat, float(spin))
    free_spin = robot.n >= 6 and spin == LEAST_MOTION
    given = None if robot.n < 6 or free_spin else 0.0 if isinstance(spin, str) else float(spin)
    mode: Mode = "axis" if free_spin else task_mode(robot)
    goal = None if along_path else robot.home[None] if near is None else _reference(robot, near, lead)
    length = max(lead[-1], 1) if along_path else 1
    return Wish(flat, length, mode, goal, near is None, branch, free_spin, given)


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


def _closed(robot: Robot, arm: Decoupled, wish: Wish) -> Chosen:
    """By closed form: pose by pose nearest to the goal, or run by run joined."""
    wanted = branch_mask(wish.branch)
    if wish.goal is None:
        return _along_path(robot, arm, wish, wanted)
    choice = rules(robot, arm, wanted, wish.at_home, wish.free_spin)
    theta, index, fit = nearest(robot, arm, wish.T_MT, wish.goal, choice)
    return Chosen(theta, index, fit[:, 1], fit[:, 2], fit[:, 0] if choice.spins else None)


def _along_path(robot: Robot, arm: Decoupled, wish: Wish, wanted: BoolArray) -> Chosen:
    """Each run of poses joined; with a free spin, one spin a run: most poses reached, then the least cost."""
    theta, index = np.empty((len(wish.T_MT), robot.n)), np.empty(len(wish.T_MT), dtype=np.int64)
    held = wish.free_spin and arm.spindle_on_last_axis
    turn = np.zeros(len(wish.T_MT)) if wish.free_spin and not held else None

    def joined(T_MT: FloatArray, angle: float) -> Joined:
        checkpoint()
        found, sound = every(robot, arm, spun(T_MT, angle))
        if held:
            found[..., 5] = robot.home[5]
        return join(robot, found, sound & wanted, T_MT, robot.n == 6 and not held)

    for start in range(0, len(wish.T_MT), wish.length):
        run = slice(start, start + wish.length)
        best = 0.0
        if turn is not None:
            few = wish.T_MT[run][:: max(wish.length // THINNED, 1)]
            ranks = {angle: (way.missed, way.cost) for angle in spins().tolist() if (way := joined(few, angle))}
            best = min(ranks, key=ranks.__getitem__)
        way = joined(wish.T_MT[run], best)
        theta[run], index[run] = way.theta, way.branch
        if turn is not None:
            turn[run] = best
    return Chosen(theta, index, *misfit(robot, theta, wish.T_MT, wish.mode), turn)


def _numerical(robot: Robot, wish: Wish) -> Chosen:
    """Pose by pose from the goal, or along each run from the pose before, with one spin a run where that is free and
    the spin of its beginning reaches all of it."""
    turned: FloatArray | None = None
    if wish.goal is not None:
        start = bent_home(robot)[None] if wish.at_home else wish.goal
        theta, _ = solve_numerically(robot, wish.T_MT, start, wish.mode, nearest=not wish.at_home)
    else:
        theta = np.empty((len(wish.T_MT), robot.n))
        turn = np.full(len(wish.T_MT), np.nan)
        for first in range(0, len(wish.T_MT), wish.length):
            run = slice(first, first + wish.length)
            held = _held(robot, wish.T_MT[run]) if wish.free_spin else None
            if held is not None:
                theta[run], turn[run] = held
            else:
                theta[run], _ = _walked(robot, wish.T_MT[run], wish.mode, bent_home(robot)[None])
        turned = None if np.isnan(turn).any() else turn
    index = np.zeros(len(theta), dtype=np.int64)  # what is near enough is told by forward kinematics
    return Chosen(theta, index, *misfit(robot, theta, wish.T_MT, wish.mode), turned)


def _held(robot: Robot, T_MT: FloatArray) -> tuple[FloatArray, float] | None:
    """(theta (m, n), rad): a run of poses all followed at the turn about the tool axis with which the first is reached
    from home; None where that leads past a pose."""
    start, found = solve_numerically(robot, T_MT[:1], bent_home(robot)[None], "axis")
    if not found[0]:
        return None
    x = T_MT[0, :3, :3].T @ tool_pose(robot, start[0])[:3, 0]
    angle = float(np.arctan2(x[1], x[0]))
    theta, reached = _walked(robot, spun(T_MT, angle), task_mode(robot), start, whole=True)
    return (theta, angle) if reached.all() else None


def _walked(
    robot: Robot, T_MT: FloatArray, mode: Mode, near: FloatArray, whole: bool = False
) -> tuple[FloatArray, BoolArray]:
    """(theta (m, n), found (m,)) of a run of poses, each from the one before; ``whole`` ends at the first not found."""
    theta, found = np.empty((len(T_MT), robot.n)), np.zeros(len(T_MT), dtype=bool)
    begin, ahead, lost = 0, 1, mode == "position"  # of a small arm's solutions the nearest is taken
    while begin < len(T_MT):
        checkpoint(begin / len(T_MT))
        if not lost:
            way = followed(robot, T_MT[begin : begin + ahead], near, mode)
            some = slice(begin, begin + len(way))
            theta[some], found[some] = way, True
            begin, ahead = some.stop, min(2 * ahead, AHEAD) if len(way) == ahead else 1
            if len(way):
                near = way[-1:]
                continue
        some = slice(begin, begin + ahead)  # several where none was found: the same one comes before all of them
        theta[some], found[some] = solve_numerically(robot, T_MT[some], near, mode)
        hits = np.flatnonzero(found[some])
        if hits.size:
            begin, ahead, lost = begin + int(hits[0]) + 1, 1, mode == "position"
            near = theta[begin - 1 : begin]
        elif whole:
            break
        else:
            begin, ahead, lost = begin + ahead, min(2 * ahead, AHEAD), True
    return theta, found
