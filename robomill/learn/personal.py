"""A student's exercises: the list of them as data, and the numbers that the student number draws."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from robomill.arguments import asked
from robomill.errors import LearnError
from robomill.identification.load_test import LoadTests
from robomill.io.robot.robots import load_robot, robot_names
from robomill.learn import poses, readings, remedies
from robomill.learn.draws import Draws, student_number
from robomill.learn.exercise import Exercise
from robomill.learn.made import Made
from robomill.robot.model import Robot

ROBOT = "slavkovic_5r"
NOTHING = 1e-9  # share of the answer below which a slip gives zero


@dataclass(frozen=True)
class Task:
    """An exercise for everybody: what it is about, and who makes a student's numbers."""

    id: str
    title: str
    unit: str
    tolerance: float
    make: Callable[[Robot, Draws], Made]
    equation: str
    number: str
    hints: tuple[str, ...]


TASKS = (
    Task(
        "torque",
        "The torque on a joint",
        "N m",
        0.01,
        poses.torque,
        r"\tau = J^T F",
        "before (11)",
        (
            "A force on the tip is felt in a joint by its lever arm about the joint's axis.",
            "The column of the Jacobian of that joint holds the lever arm for each direction of the force.",
            "τ = Jᵀ F: multiply the joint's column of the rows of v by the force, component by component, and add.",
        ),
    ),
    Task(
        "tip",
        "Where the tip goes",
        "mm",
        0.01,
        poses.tip,
        r"\delta x = C_{X\delta}\,F",
        "(15), (16)",
        (
            "A push along one axis moves the tip along the others, too.",
            "The column of C under the push says where it leads; C = J Cθ Jᵀ with the rows of v.",
            "Sum over the joints: C_ba = Σ Cθi J_bi J_ai, and multiply by the force.",
        ),
    ),
    Task(
        "share",
        "Which joint gives",
        "%",
        0.01,
        poses.share,
        r"C_X = \sum C_{\theta i} J_i J_i^T",
        "(13), (14)",
        (
            "Every joint gives in its own direction; what they give adds up.",
            "Joint i gives Cθi J_ai² of the direct compliance along a.",
            "Divide that by the sum over all joints.",
        ),
    ),
    Task(
        "softest",
        "The softest direction",
        "um/N",
        0.01,
        poses.softest,
        r"C\,e = \lambda e",
        "(11)-(14)",
        (
            "The tip gives most in a direction that is none of the axes.",
            "The principal compliances are the eigenvalues of C, which is symmetric.",
            "Take the largest of the three.",
        ),
    ),
    Task(
        "press",
        "A force for a way",
        "N",
        0.01,
        poses.press,
        r"F_a = \delta_a / C_{aa}",
        "(15), (16)",
        (
            "Only one component of the force is not zero; the tip may go aside.",
            "Then the way along the push is C_aa times the force.",
            "Divide the way by C_aa. The inverse of C would hold the tip aside.",
        ),
    ),
    Task(
        "regular",
        "Distance from a singularity",
        "m3",
        0.01,
        poses.regular,
        r"\det(J)",
        "Fig. 4",
        (
            "Where det(J) is zero, the tool cannot move in one direction.",
            "Of an arm of five axes the rows are v_x, v_y, v_z and the two of ω across the tool.",
            "robomill.at_pose(robot, theta).det_J is it; by hand, build J by eq. (9) first.",
        ),
    ),
    Task(
        "laboratory",
        "The virtual laboratory",
        "1e-7 rad/(N m)",
        0.03,
        readings.laboratory,
        r"\delta = \sum C_{\theta i} J_i J_i^T F",
        "(16), (17)",
        (
            "The displacement is linear in the compliances of the joints: every reading is one equation.",
            "The coefficient of Cθi in a reading is J_i (J_iᵀ F).",
            "Solve all equations at once by least squares; robomill.identify does it.",
        ),
    ),
    Task(
        "soft_joint",
        "The hidden robot",
        "1",
        0.0,
        readings.soft_joint,
        r"\Delta\delta = (s - 1)\,C_{\theta k} J_k J_k^T F",
        "(13)-(16)",
        (
            "Compute what the robot of the file would do under these loads.",
            "What the tip goes farther is the share of one joint, times its factor less one.",
            "Compare the difference with every joint's share J_k (J_kᵀ F): directions must agree in all tests.",
        ),
    ),
    Task(
        "left_over",
        "What a correction leaves",
        "um",
        0.01,
        remedies.left_over,
        r"r = (C_{real} - C_{model})\,F",
        "(15)",
        (
            "The corrected program goes against the push by what the model says.",
            "The real robot goes farther than that.",
            "What is left is the difference of the two.",
        ),
    ),
    Task(
        "slot",
        "The force across the feed",
        "N",
        0.01,
        remedies.slot,
        r"F_y = N a (K_{tc} c / 4 + K_{te} / \pi)",
        "Altintas",
        (
            "Mean forces in a slot are integrals over half a turn of the cutter.",
            "Chip and edge add up: one grows with the feed per tooth c, the other does not.",
            "F_y = N a (Ktc c/4 + Kte/π).",
        ),
    ),
)
BY_ID = {task.id: task for task in TASKS}


@asked
def exercises(student: str | int, robot: str = ROBOT) -> tuple[Exercise, ...]:
    """A student's exercises, the same on every machine.

    Parameters
    ----------
    student : str or int
        The student number; blanks and leading zeros do not count.
    robot : str
        The name of a robot that comes with robomill, or a file.

    Returns
    -------
    tuple of Exercise
        In the order in which they are done.

    Raises
    ------
    LearnError
        For what is no student number, and a robot that they cannot be made for; RobotError for one that is not known.

    Examples
    --------
    >>> from robomill import learn
    >>> [given.id for given in learn.exercises(1234567)][:3]
    ['torque', 'tip', 'share']
    """
    return tuple(exercise(task.id, student, robot) for task in TASKS)


@asked
def exercise(id: str, student: str | int, robot: str = ROBOT) -> Exercise:  # noqa: A002
    """One exercise of a student.

    Parameters
    ----------
    id : str
        Which: ``torque``, ``tip``, ``share``, ``softest``, ``press``, ``regular``, ``laboratory``, ``soft_joint``,
        ``left_over`` or ``slot``.
    student : str or int
        The student number; blanks and leading zeros do not count.
    robot : str
        The name of a robot that comes with robomill, or a file.

    Returns
    -------
    Exercise
        With this student's numbers.

    Raises
    ------
    LearnError
        For an id or a number that is none, and a robot that it cannot be made for.

    Examples
    --------
    >>> from robomill import learn
    >>> learn.exercise("slot", "1234567").unit
    'N'
    """
    if id not in BY_ID:
        raise LearnError(f"Exercise {id!r:.40} is not known; known are {', '.join(BY_ID)}.", where=str(id))
    return _made(id, student_number(student), turning(robot))


@asked
def load_tests(student: str | int, robot: str = ROBOT) -> LoadTests:
    """The load tests of a student's hidden robot, as the exercise ``laboratory`` tells them.

    Parameters
    ----------
    student : str or int
        The student number.
    robot : str
        The name of a robot that comes with robomill, or a file.

    Returns
    -------
    LoadTests
        24 tests at 8 poses, for ``robomill.identify``.

    Raises
    ------
    LearnError
        As ``exercise``.

    Examples
    --------
    >>> from robomill import learn
    >>> len(learn.load_tests(1234567))
    24
    """
    arm = turning(robot)
    return readings.readings(arm, _draws("laboratory", student_number(student), arm))[1]


def turning(name: str) -> Robot:
    """The robot of that name, all of whose joints turn. Raises LearnError."""
    robot = _known(name) if name in robot_names() else load_robot(name)
    if robot.prismatic[robot.free].any() or robot.n < 2:
        raise LearnError(f"{robot.title or robot.name}: exercises are for arms of two and more joints that all turn.")
    if not (robot.C_theta > 0.0).all():
        raise LearnError(f"{robot.title or robot.name}: exercises are for arms whose joints all give; one is rigid.")
    return robot


@lru_cache(maxsize=32)
def _known(name: str) -> Robot:
    return load_robot(name)


def _draws(task: str, student: str, robot: Robot) -> Draws:
    return Draws(task, student, robot.name)


@lru_cache(maxsize=4096)
def _made(name: str, student: str, robot: Robot) -> Exercise:
    task = BY_ID[name]
    made = task.make(robot, _draws(name, student, robot))
    unit = made.unit or task.unit
    tolerance = task.tolerance if made.tolerance is None else made.tolerance
    seed = _draws(name, student, robot).words
    bare = Exercise(
        task.id,
        task.title,
        made.text,
        seed,
        unit,
        tolerance,
        task.hints,
        task.equation,
        task.number,
        made.answer,
        (),
        made.data,
    )
    least = NOTHING * abs(made.answer)
    told = (slip for slip in made.slips if math.isfinite(slip.value) and abs(slip.value) > least)
    return bare.telling(slip for slip in told if not bare.holds(-slip.value))
