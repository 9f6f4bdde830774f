"""Exercises about one configuration of the arm: where the tip goes, which torque, which share, how soft, how regular.

Every slip is computed by the model as the answer is: with one joint left out, with J and its transpose exchanged,
without the lever arms, with C in place of its inverse.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.at_pose import PoseReport, at_pose
from robomill.compliance.cartesian import joint_contributions
from robomill.errors import LearnError
from robomill.kinematics.dexterity import task_matrix
from robomill.learn.draws import Draws
from robomill.learn.exercise import Slip
from robomill.learn.made import Made
from robomill.robot.model import Robot
from robomill.units import format_many, format_si, from_si, to_si

SWING = 35  # degrees to each side of the reference configuration
TRIES = 400
ASIDE = 0.15  # share of the whole that a number asked for has at least
SINGULAR = 1e-9  # of its largest principal compliance a C has more than, where it is inverted


def stood(robot: Robot, draws: Draws) -> PoseReport:
    """A configuration in whole degrees near the robot's reference one, 2 degrees inside the limits."""
    low, high = (from_si(robot.limits[:, side], "deg") for side in (0, 1))
    middle = from_si(robot.home, "deg")
    lowest, highest = (np.clip(middle + swing, low + 2.0, high - 2.0) for swing in (-SWING, SWING))
    degrees = [draws.whole(int(np.ceil(a)), int(np.floor(b))) for a, b in zip(lowest, highest)]
    return at_pose(robot, to_si(np.array(degrees, dtype=np.float64), "deg"))


def until(robot: Robot, draws: Draws, fits: Callable[[PoseReport], bool]) -> PoseReport:
    """The first configuration drawn that ``fits`` and is far from a singular one."""
    for _ in range(TRIES):
        pose = stood(robot, draws)
        if not pose.near_singular and fits(pose):
            return pose
    raise LearnError(f"{robot.title or robot.name}: no configuration suits this exercise; choose another robot.")


def giving(robot: Robot, draws: Draws) -> tuple[PoseReport, int]:
    """A configuration, and an axis along which it gives about as it does along its softest one."""
    pose = until(robot, draws, lambda _: True)
    direct = np.diag(pose.C)
    return pose, draws.one_of([a for a in range(3) if direct[a] > 0.15 * direct.max()])


def place(pose: PoseReport) -> str:
    """The configuration in words."""
    return f"The arm stands at θ = ({format_many(pose.theta, 'deg', 0)})"


def without_joint(pose: PoseReport, i: int) -> FloatArray:
    """C (3, 3) without the share of joint ``i`` (counted from 0)."""
    return np.asarray(pose.C - pose.C_joint[i])


def without_levers(pose: PoseReport) -> FloatArray:
    """(3, 3): J C_theta J^T with the rows of omega in place of those of v."""
    return joint_contributions(pose.J[3:], pose.robot.C_theta).sum(axis=0)


def transposed(pose: PoseReport) -> FloatArray | None:
    """(3, 3): J^T C_theta J in place of J C_theta J^T; None where J is not square or too small."""
    J = task_matrix(pose.robot, pose.theta)
    if J.shape[0] != J.shape[1] or len(J) < 3:
        return None
    return np.asarray((J.T * pose.robot.C_theta) @ J)[:3, :3]


def _left_out(pose: PoseReport, value: Callable[[FloatArray], float]) -> Iterator[Slip]:
    """What ``value`` of C is where one joint is forgotten."""
    for i, number in enumerate(pose.robot.joint_numbers):
        yield Slip(
            f"The share of joint {number} is missing: C is the sum over all joints.", value(without_joint(pose, i))
        )


def _exchanged(pose: PoseReport, value: Callable[[FloatArray], float]) -> Iterator[Slip]:
    C = transposed(pose)
    if C is not None:
        yield Slip("J and its transpose are exchanged: C = J Cθ Jᵀ, not Jᵀ Cθ J.", value(C))
    text = "The lever arms are missing: the rows of v of the Jacobian carry them, the rows of ω do not."
    yield Slip(text, value(without_levers(pose)))


def tip(robot: Robot, draws: Draws) -> Made:
    """How far a push moves the tip along another axis."""
    force = 10.0 * draws.whole(8, 40)
    ways: list[tuple[int, int]] = []

    def fits(pose: PoseReport) -> bool:
        ways[:] = [
            (a, b)
            for a in range(3)
            for b in range(3)
            if a != b and abs(pose.C[b, a]) > ASIDE * np.linalg.norm(pose.C[:, a])
        ]
        return bool(ways)

    pose = until(robot, draws, fits)
    a, b = draws.one_of(ways)
    push, along = "XYZ"[a], "XYZ"[b]

    def value(C: FloatArray) -> float:
        return float(C[b, a] * force)

    slips = [
        Slip(
            f"This is how far the tip goes along {push}, the push itself: asked is its way along {along}.",
            float(pose.C[a, a] * force),
        ),
        Slip(
            "This is the length of the whole displacement: asked is one component of it.",
            float(np.linalg.norm(pose.C[:, a]) * force),
        ),
        *_left_out(pose, value),
        *_exchanged(pose, value),
    ]
    text = (
        f"{place(pose)}. A force of {format_si(force, 'N', 0)} pushes the tip along +{push} of the robot frame. How "
        f"far does the tip move along {along}? Give the sign."
    )
    return Made(text, value(pose.C), tuple(slips))


def torque(robot: Robot, draws: Draws) -> Made:
    """Which torque a push puts on a joint."""
    force = 10.0 * draws.whole(8, 40)
    ways: list[tuple[int, int]] = []

    def fits(pose: PoseReport) -> bool:
        size = np.abs(pose.J[:3])
        ways[:] = [(k, a) for k in range(robot.n) for a in range(3) if size[a, k] > 0.2 * size.max()]
        return bool(ways)

    pose = until(robot, draws, fits)
    k, axis = draws.one_of(ways)
    F = force * np.eye(3)[axis]
    tau = pose.J[:3].T @ F
    numbers, name = robot.joint_numbers, "XYZ"[axis]
    slips = [Slip("The lever arm is missing: a torque is the force times its distance from the joint's axis.", force)]
    slips += [
        Slip(f"This is the torque on joint {numbers[i]}: asked is joint {numbers[k]}.", float(tau[i]))
        for i in range(robot.n)
        if i != k and abs(tau[i]) > 1e-9 * force
    ]
    J = task_matrix(robot, pose.theta)
    if J.shape[0] == J.shape[1]:
        wrench = np.concatenate([F, np.zeros(3)])[: len(J)]
        slips.append(Slip("J is not transposed: τ = Jᵀ F.", float((J @ wrench)[k])))
    reach = float(np.linalg.norm(pose.T_MT[:3, 3]) * force)
    slips.append(
        Slip(
            "This is the force times the distance of the tip from the robot's base: the lever arm is that from the "
            "joint's axis.",
            reach,
        )
    )
    text = (
        f"{place(pose)}. A force of {format_si(force, 'N', 0)} pushes the tip along +{name}. Which torque does it put "
        f"on joint {numbers[k]}? Positive is what drives the joint to larger θ."
    )
    return Made(text, float(tau[k]), tuple(slips))


def share(robot: Robot, draws: Draws) -> Made:
    """Which share of a direct compliance is one joint's."""
    ways: list[tuple[int, int]] = []

    def parts(C_joint: FloatArray, a: int) -> FloatArray:
        return np.asarray(C_joint[:, a, a] / C_joint[:, a, a].sum())

    def fits(pose: PoseReport) -> bool:
        direct = np.diag(pose.C)
        ways[:] = [
            (k, a)
            for a in range(3)
            if direct[a] > 0.05 * direct.max()
            for k in range(robot.n)
            if 0.08 < parts(pose.C_joint, a)[k] < 0.92
        ]
        return bool(ways)

    pose = until(robot, draws, fits)
    k, a = draws.one_of(ways)
    numbers, name = robot.joint_numbers, "XYZ"[a]
    levers, compliances = pose.J[a] ** 2, robot.C_theta
    traces = np.einsum("nii->n", pose.C_joint)
    slips = [
        Slip(
            "The lever arms are missing: these are shares of the joints' compliances alone.",
            float(compliances[k] / compliances.sum()),
        ),
        Slip(
            "The joints' compliances are missing: these are shares of the squared lever arms alone.",
            float(levers[k] / levers.sum()),
        ),
        Slip("The lever arm comes in squared: once for the torque, once for the way of the tip.", _once(pose, a, k)),
        Slip(
            "These are shares of the joints' torques, not of what they give.",
            float(abs(pose.J[a, k]) / np.abs(pose.J[a]).sum()),
        ),
        Slip(
            f"This is the share in all three directions together: asked is {name} alone.",
            float(traces[k] / traces.sum()),
        ),
    ]
    slips += [
        Slip(f"This is the share of joint {numbers[i]}: asked is joint {numbers[k]}.", float(parts(pose.C_joint, a)[i]))
        for i in range(robot.n)
        if i != k
    ]
    text = (
        f"{place(pose)}. The tip is pushed along {name} and gives along {name}. Which share of that is joint "
        f"{numbers[k]}'s?"
    )
    return Made(text, float(parts(pose.C_joint, a)[k]), tuple(slips))


def _once(pose: PoseReport, a: int, k: int) -> float:
    """The share of joint ``k`` where the lever arm is taken once, not squared."""
    part = pose.robot.C_theta * np.abs(pose.J[a])
    return float(part[k] / part.sum())


def softest(robot: Robot, draws: Draws) -> Made:
    """How far the tip gives at most, by newton."""
    pose = until(robot, draws, lambda pose: bool(np.abs(pose.principal[1][:, -1]).max() < 0.97))

    def value(C: FloatArray) -> float:
        return float(np.linalg.eigvalsh(0.5 * (C + C.T))[-1])

    values = pose.principal[0]
    slips = [
        Slip(
            "This is the largest number on the diagonal: in between the axes the tip gives more.",
            float(np.diag(pose.C).max()),
        ),
        Slip("This is the smallest principal compliance, the stiffest direction.", float(values[0])),
        Slip("This is the middle principal compliance.", float(values[1])),
        Slip("This is the sum of the diagonal, of all three principal compliances.", float(values.sum())),
        Slip("This is the square root of the sum of squares of all numbers of C.", float(np.linalg.norm(pose.C))),
        *_left_out(pose, value),
        *_exchanged(pose, value),
    ]
    text = f"{place(pose)}. In its softest direction, how far does the tip give by newton?"
    return Made(text, value(pose.C), tuple(slips))


def press(robot: Robot, draws: Draws) -> Made:
    """Which force moves the tip so far, where nothing holds it aside."""
    way = 1e-5 * draws.whole(4, 30)
    pose, a = giving(robot, draws)
    name = "XYZ"[a]

    def value(C: FloatArray) -> float:
        return float(way / C[a, a]) if C[a, a] > 1e-3 * pose.C[a, a] else float("nan")

    slips = list(_left_out(pose, value))
    values = pose.principal[0]
    if values[0] > SINGULAR * values[-1]:
        held = float(way * np.linalg.inv(pose.C)[a, a])
        slips.insert(0, Slip("This force is with the tip held aside: the inverse of C was taken, not C itself.", held))
    slips += [
        Slip(
            "The compliance stands above, not below: the force is the way divided by C.",
            float(from_si(way, "mm") * from_si(pose.C[a, a], "um/N")),
        ),
        *(
            Slip(f"This is the force along {'XYZ'[b]}: asked is {name}.", float(way / pose.C[b, b]))
            for b in range(3)
            if b != a and pose.C[b, b] > 0.0
        ),
        *_exchanged(pose, value),
    ]
    text = (
        f"{place(pose)}. Which force along {name} moves the tip by {format_si(way, 'mm', 2)} along {name}, where "
        "nothing holds it aside?"
    )
    return Made(text, value(pose.C), tuple(slips))


def regular(robot: Robot, draws: Draws) -> Made:
    """How far from a singular configuration."""
    pose = until(robot, draws, lambda pose: True)
    J = task_matrix(robot, pose.theta)
    square = pose.has_det_J
    answer = pose.det_J if square else pose.manipulability
    slips = [Slip("This is det(J Jᵀ), the square of what is asked: take its root.", float(np.linalg.det(J @ J.T)))]
    if square:
        slips.append(
            Slip(
                "Joint coordinates of degrees were used as if they were radians, which is another pose.",
                _as_radians(pose),
            )
        )
    rows = (
        ("the 5 × 5 task Jacobian (rows v, and ω across the tool)" if robot.n == 5 else "the task Jacobian")
        if square
        else ""
    )
    what = f"What is det(J) of {rows}?" if square else "What is its manipulability √det(J Jᵀ)?"
    return Made(f"{place(pose)}. {what}", float(answer), tuple(slips), pose.det_J_unit)


def _as_radians(pose: PoseReport) -> float:
    theta = np.angle(np.exp(1j * from_si(pose.theta, "deg")))  # whole turns taken off, which change nothing
    return at_pose(pose.robot, theta).det_J
