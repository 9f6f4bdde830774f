"""The eight lessons, for the robot and the pose in hand: every answer, right or wrong, is computed by the model."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from robomill.arguments import asked
from robomill.compliance.at_pose import PoseReport, at_pose
from robomill.compliance.cartesian import cartesian_compliance
from robomill.compliance.deflection import deflection, displacement, shares_along, soft_direction
from robomill.errors import LearnError
from robomill.learn.compared import neighbours, side_cut
from robomill.learn.equations import component, product, settled
from robomill.learn.exercise import Exercise, Slip
from robomill.learn.lesson import COUNT, Bars, Choice, Lesson
from robomill.learn.push import FORCE, AsidePush
from robomill.learn.readings import LOAD
from robomill.units import format_number, format_percent, format_si, from_si
from robomill.workspace.ray import ray_through

WRONG = 0.2  # share by which the model of lesson 7 is too stiff


@asked
def lesson(number: int, pose: PoseReport) -> Lesson:
    """One of the eight lessons at a pose.

    Parameters
    ----------
    number : int
        1 to 8.
    pose : PoseReport
        Where the arm stands.

    Returns
    -------
    Lesson
        Question, choices, and what the model says of each.

    Raises
    ------
    LearnError
        For a number that is none, and a pose that is not reached.

    Examples
    --------
    >>> import robomill as rm
    >>> from robomill.learn.lessons import lesson
    >>> robot = rm.load_robot("slavkovic_5r")
    >>> lesson(2, rm.at_pose(robot, robot.home)).question
    'Push the tool along Y with 100 N. Which joint gives most?'
    """
    if number not in range(1, COUNT + 1):
        raise LearnError(f"Lesson {number!r:.20} is not there: lessons are 1 to {COUNT}.")
    if not pose.reached:
        raise LearnError("A lesson needs an arm that stands somewhere: this pose is not reached.")
    return LESSONS[number - 1](pose)


def _where(pose: PoseReport) -> Lesson:
    push = AsidePush.of(pose.C)
    delta = pose.delta(push.force)
    names = list(push.answers)
    right = push.went(delta)
    moved = push.told(delta, "mm")
    choices = tuple(Choice(text, f"The model says: {moved}.") for text in push.answers.values())
    return Lesson(
        1,
        f"Push the tool along {push.name} with {format_si(FORCE, 'N', 0)}. Where does the tip go?",
        names.index(right),
        choices,
        f"The {push.column} column of C says where a push along {push.name} leads; what stands beside the diagonal "
        "leads aside.",
        product(pose.C, push.force),
        "(15), (16)",
        "Find a pose where the tip goes nowhere but along the push: on Compliance, look for a map of a cross "
        "compliance that is zero.",
        "Let everybody point with the hand before the reveal. Most say: along the push.",
        push.force,
        delta,
    )


def _which(pose: PoseReport) -> Lesson:
    push = AsidePush.of(pose.C)
    delta_joint = deflection(pose.C_joint, push.force)
    delta = delta_joint.sum(axis=0)
    share = shares_along(delta_joint, delta)
    numbers = pose.robot.joint_numbers
    softest = int(np.argmax(pose.robot.C_theta))
    right = int(np.argmax(share))
    others = (
        "and it is the softest of all"
        if softest == right
        else (f"though joint {numbers[softest]} is the softest: its lever arm is short")
    )
    return Lesson(
        2,
        f"Push the tool along {push.name} with {format_si(FORCE, 'N', 0)}. Which joint gives most?",
        right,
        tuple(
            Choice(f"Joint {number}", f"Joint {number} gives {format_percent(part)} of the displacement.")
            for number, part in zip(numbers, share)
        ),
        f"What joint {numbers[right]} gives is its compliance times its lever arm squared, {others}.",
        component(pose, push.along, push.along),
        "(13), (14)",
        f"On Robot, make joint {numbers[right]} twice as stiff and see which joint gives most then.",
        "Ask for the softest joint first: it need not be the one that gives most.",
        push.force,
        delta,
        bars=Bars("Share of the displacement", tuple(f"joint {n}" for n in numbers), share, "%", right),
    )


def _numbered(id: str, question: str, unit: str, answer: float, slips: Sequence[Slip], tolerance: float) -> Exercise:  # noqa: A002
    """A prediction that is typed; slips that cannot be told from the answer or from each other are left out."""
    return Exercise(id, "", question, "", unit, tolerance, (), "", "", answer, ()).telling(slips)


def _lever(pose: PoseReport) -> Lesson:
    push = AsidePush.of(pose.C)
    way = ray_through(pose.robot, pose.T_MT[:3, 3])
    taken = np.flatnonzero(np.isfinite(way.theta).all(axis=1))  # with the tool vertical, which it may not be here
    if len(taken) < 2:
        raise LearnError("This lesson needs a pose that the arm reaches with its tool vertical; choose another one.")
    start, far = int(taken[np.abs(taken - way.start).argmin()]), int(taken[-1])
    if way.radius[far] < 1.02 * way.radius[start]:
        start = int(taken[0])
    near_r, far_r = way.radius[start], way.radius[far]
    softest = soft_direction(cartesian_compliance(pose.robot, way.theta[[start, far]]))[0][:, -1]
    times, ratio = float(softest[1] / softest[0]), float(far_r / max(near_r, 1e-9))
    question = (
        f"The arm goes from {format_si(near_r, 'mm', 0)} out to {format_si(far_r, 'mm', 0)} from its base, as far as "
        "it reaches. How many times as soft is the tip then, in its softest direction?"
    )
    slips = (
        Slip("That is the ratio of the distances: the lever arm counts twice, for the torque and for the way.", ratio),
        Slip(
            "That is the ratio of the distances squared, as of one joint at the base: every joint has its own lever "
            "arm.",
            ratio**2,
        ),
        Slip("That is as soft as before: the lever arms have changed.", 1.0),
    )
    near_um, far_um = from_si(softest, "um/N")
    (far_C,), (near_C,), (shown,) = settled(np.divide, 2, (far_um, 3), (near_um, 3))
    typed = _numbered("lever", question, "1", times, slips, 0.15)
    dets = [format_si(float(way.det[i]), pose.det_J_unit, 2) for i in (start, far)]
    what = "det(J)" if pose.has_det_J else "its manipulability"
    told = f"{format_number(times, 2)} times as soft; {what} goes from {dets[0]} to {dets[1]}."
    return Lesson(
        3,
        question,
        0,
        (Choice(f"{format_number(times, 2)} times", told),),
        "A lever arm counts twice, once for the torque and once for the way of the tip; at the edge det(J) falls to "
        "zero, as one direction is lost.",
        rf"\frac{{C_{{max}}({from_si(far_r, 'mm'):.0f})}}{{C_{{max}}({from_si(near_r, 'mm'):.0f})}} = "
        rf"\frac{{{far_C}}}{{{near_C}}} = {shown}",
        "(9), (13), Fig. 4",
        "Drag the arm to its edge on the first screen of Learn and watch det(J) beside the ellipsoid.",
        "Hold a broom at its end and half way: who feels the lever arm feels it squared.",
        push.force,
        pose.delta(push.force),
        typed,
        Bars("Largest compliance", tuple(f"{from_si(r, 'mm'):.0f} mm" for r in (near_r, far_r)), softest, "um/N"),
    )


def _map(pose: PoseReport) -> Lesson:
    push = AsidePush.of(pose.C)
    names, _, theta = neighbours(pose)
    C = cartesian_compliance(pose.robot, theta)
    direct = C[:, push.along, push.along]
    right = int(np.argmin(direct))
    axis = push.name.lower() * 2
    return Lesson(
        4,
        f"Where does the tip give least along {push.name}: here, or a step aside?",
        right,
        tuple(
            Choice(name, f"{name}: {format_si(value, 'um/N')} along {push.name}.") for name, value in zip(names, direct)
        ),
        f"A map of C_{axis} shows that at a glance: the tip gives least where the lever arms of the joints that turn "
        f"it along {push.name} are short.",
        rf"C_{{{axis}}} = \sum_i C_{{\theta i}} J_{{{push.name.lower()},i}}^2 = {from_si(direct[right], 'um/N'):.3f}"
        r"\;\mathrm{\mu m/N}",
        "(13), (14), Fig. 5",
        f"On Compliance, open the map of C_{axis}, move the Z slider, and find a height at which another place is the "
        "stiffest.",
        "Let the class read the map before the numbers are shown: darker is stiffer.",
        push.force,
        pose.delta(push.force),
        bars=Bars(f"Compliance along {push.name}", names, direct, "um/N", right),
    )


def _milling(pose: PoseReport) -> Lesson:
    (F_up, up), (F_down, down) = side_cut(pose, True), side_cut(pose, False)
    words = {True: "too much is cut away", False: "material is left"}
    combos = [(a, b) for a in (True, False) for b in (True, False)]
    right = combos.index((up > 0.0, down > 0.0))
    far = [f"{format_si(abs(way), 'um', 1)} {'into' if way > 0.0 else 'away from'} its wall" for way in (up, down)]
    told = f"Up milling moves the tip {far[0]}, down milling {far[1]}."
    return Lesson(
        5,
        "A right-hand cutter mills a wall along +X, once up, once down. Which wall is off, and how?",
        right,
        tuple(Choice(f"Up: {words[a]}; down: {words[b]}", told) for a, b in combos),
        f"Across the feed up milling pushes with {format_si(F_up[1], 'N', 1, sign=True)}, down milling with "
        f"{format_si(F_down[1], 'N', 1, sign=True)} (plus is left); the wall is on the left milling up, on the right "
        "milling down, and C leads the other components aside, too.",
        product(pose.C, F_up),
        "(15), (16)",
        "On Milling, turn the feed round: which wall is off then?",
        "Let the students turn a hand clockwise and move it: where do the teeth push?",
        F_up,
        displacement(pose.C, F_up),
        bars=Bars("Tip into its wall", ("up milling", "down milling"), np.array([up, down]), "um"),
    )


def _seeing(pose: PoseReport) -> Lesson:
    robot = pose.robot
    k = 3 if robot.n > 4 else robot.n - 1
    number = robot.joint_numbers[k]
    names, _, theta = neighbours(pose)
    tests = [(names[i], theta[i], axis) for i in (0, len(names) - 1) for axis in range(3)]
    seen = np.array([float(np.linalg.norm(at_pose(robot, t).C_joint[k][:, axis]) * LOAD) for _, t, axis in tests])
    if len(names) == 1:
        tests, seen = tests[:3], seen[:3]
    right = int(np.argmax(seen))
    called = [f"{name}, pushed along {'XYZ'[axis]}" for name, _, axis in tests]
    best = format_si(seen[right], "um", 1)
    reason = (
        f"A test sees joint {number} by what this joint moves the tip, Cθ J (Jᵀ F): at best {best}, to be read beside "
        "the noise of the gauge."
        if seen[right] > 1e-9
        else f"No test here turns joint {number}: its axis runs through the tip; only another pose of the wrist does."
    )
    return Lesson(
        6,
        f"A load test with {format_si(LOAD, 'N', 0)}: which of these sees joint {number} best?",
        right,
        tuple(
            Choice(name, f"{name}: joint {number} moves the tip by {format_si(value, 'um', 1)}.")
            for name, value in zip(called, seen)
        ),
        reason,
        rf"\left|C_{{\theta {number}}} J_{{{number}}} (J_{{{number}}}^T F)\right| = {from_si(seen[right], 'um'):.1f}"
        r"\;\mathrm{\mu m}",
        "(16), (17)",
        "In the laboratory (Identification), measure only tests that do not see it and look at its interval.",
        "The laboratory gives twelve tests: let groups spend them and compare their intervals.",
        LOAD * np.eye(3)[tests[right][2]],
        pose.delta(LOAD * np.eye(3)[tests[right][2]]),
        bars=Bars(f"What joint {number} moves the tip", tuple(called), seen, "um", right),
    )


def _compensated(pose: PoseReport) -> Lesson:
    push = AsidePush.of(pose.C)
    robot, a = pose.robot, push.along
    softer = cartesian_compliance(robot.replace(C_theta=(1.0 + WRONG) * robot.C_theta), pose.theta)
    model = float(pose.C[a, a] * FORCE)
    actual = float(softer[a, a] * FORCE)
    left = actual - model
    question = (
        f"The program is corrected by what the model says along {push.name}: {format_si(model, 'mm', 3)}. The real "
        f"robot is {format_percent(WRONG)} softer than the model in every joint. How far is the tip still off?"
    )
    slips = (
        Slip("That is all of it, as if nothing had been corrected.", actual),
        Slip("That is what the correction takes off, not what it leaves.", model),
        Slip("That share was taken of the real displacement, not of the model's.", WRONG * actual),
    )
    both = [(from_si(C[a, a], "um/N"), 3) for C in (softer, pose.C)]
    (real_C,), (own_C,), (left_um,) = settled(lambda real, own: (real - own) * FORCE, 1, *both)
    told = f"{format_si(left, 'mm', 3)} of {format_si(actual, 'mm', 3)}: {format_percent(left / actual)} of it stays."
    return Lesson(
        7,
        question,
        0,
        (Choice(format_si(left, "mm", 3), told),),
        "A correction takes off what the model knows: what is left is the model's own error, however large the "
        "deflection was.",
        rf"(C_{{real}} - C_{{model}})\,F = ({real_C} - {own_C})\cdot {FORCE:.0f} = {left_um}\;\mathrm{{\mu m}}",
        "(15)",
        "On Improve, correct the program and read what is left if all that gives is 20 % softer or stiffer.",
        "Ask what is better: a robot twice as stiff, or a model twice as good?",
        push.force,
        pose.delta(push.force),
        _numbered("left", question, "mm", left, slips, 0.1),
        Bars("Deviation", ("before", "corrected"), np.array([actual, left]), "mm"),
    )


def _spend(pose: PoseReport) -> Lesson:
    push = AsidePush.of(pose.C)
    robot = pose.robot
    share = shares_along(deflection(pose.C_joint, push.force), pose.delta(push.force))
    names: list[str] = []
    left: list[float] = []
    for k in np.argsort(share)[::-1][:2]:
        stiffer = robot.C_theta.copy()
        stiffer[k] *= 0.5
        C = cartesian_compliance(robot.replace(C_theta=stiffer), pose.theta)
        names.append(f"Make joint {robot.joint_numbers[k]} twice as stiff")
        left.append(float(np.linalg.norm(displacement(C, push.force))))
    near, _, theta = neighbours(pose)
    moved = np.linalg.norm(displacement(cartesian_compliance(robot, theta), push.force), axis=1)
    names += [f"Move the part {name}" for name in near[1:]]
    left += moved[1:].tolist()
    values = np.array(left)
    now = float(np.linalg.norm(pose.delta(push.force)))
    right = int(np.argmin(values))
    told = [
        f"{name}: {format_si(value, 'mm', 3)} instead of {format_si(now, 'mm', 3)}."
        for name, value in zip(names, values)
    ]
    free = "moving costs nothing" if right >= 2 else "a stiffer joint holds wherever the part lies"
    return Lesson(
        8,
        f"A push of {format_si(FORCE, 'N', 0)} along {push.name} moves the tip by {format_si(now, 'mm', 3)}. You may "
        "do one thing: which leaves least?",
        right,
        tuple(Choice(name, words) for name, words in zip(names, told)),
        f"{names[right]}: what is left is computed by the same sum over the joints, and {free}.",
        rf"|\delta| : {from_si(now, 'um'):.1f} \to {from_si(values[right], 'um'):.1f}\;\mathrm{{\mu m}}",
        "(13)-(16)",
        "On Improve, let the program look for the best place in a whole box, and for the joints to stiffen at the "
        "least cost.",
        "Give prices: a stiffer gear 8 000, a new fixture 500. Would the class decide otherwise?",
        push.force,
        pose.delta(push.force),
        bars=Bars("Displacement left", ("now", *names), np.array([now, *left]), "mm", right + 1),
    )


LESSONS: tuple[Callable[[PoseReport], Lesson], ...] = (
    _where,
    _which,
    _lever,
    _map,
    _milling,
    _seeing,
    _compensated,
    _spend,
)
