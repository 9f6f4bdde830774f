"""A student's exercises: the same everywhere, and every answer and slip found another way."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable

import numpy as np
import pytest
import scipy.optimize
from truth import SEVEN, axis_of, compliance, jacobian, numbers, theta_of

import robomill as rm
from robomill import learn
from robomill.errors import ArgumentError, LearnError
from robomill.io.robot.robots import robot_names
from robomill.learn.draws import Draws, student_number
from robomill.learn.personal import TASKS, _made

STUDENTS = (1234567, "S-0815", 42)
ROBOTS = robot_names()


def exercise(task: str, student: str | int, name: str) -> tuple[learn.Exercise, rm.Robot]:
    if name == "seven":
        return _made(task, student_number(student), SEVEN), SEVEN
    return learn.exercise(task, student, name), rm.load_robot(name)


def tip(given: learn.Exercise, robot: rm.Robot, C: np.ndarray) -> float:
    a, b = axis_of(given.text, "tip along"), axis_of(given.text, "move along")
    return float(C[b, a] * numbers(given.text.split("force of")[1])[0])


def press(given: learn.Exercise, robot: rm.Robot, C: np.ndarray) -> float:
    a = axis_of(given.text, "force along")
    return numbers(given.text.split("tip by")[1])[0] * 1e-3 / float(C[a, a])


def softest(given: learn.Exercise, robot: rm.Robot, C: np.ndarray) -> float:
    """The largest way of the tip by a unit force, over directions."""
    way = lambda x: -float(np.linalg.norm(C @ x) / np.linalg.norm(x))  # noqa: E731
    return -min(scipy.optimize.minimize(way, start, tol=1e-14).fun for start in (np.eye(3) + 0.1) * 1.0)


def left_over(given: learn.Exercise, robot: rm.Robot, C: np.ndarray) -> float:
    a = axis_of(given.text, "along")
    force = numbers(given.text.split("tip with")[1])[0]
    wrong = numbers(given.text.split("real robot is")[1])[0] / 100
    softer = compliance(robot.replace(C_theta=robot.C_theta * (1 + wrong)), theta_of(given))
    return float((softer - C)[a, a] * force)


OF_C: dict[str, Callable[[learn.Exercise, rm.Robot, np.ndarray], float]] = {
    "tip": tip,
    "press": press,
    "softest": softest,
    "left_over": left_over,
}


@pytest.mark.parametrize("name", [*ROBOTS, "seven"])
@pytest.mark.parametrize("task", OF_C)
def test_answers_of_compliance_are_those_of_a_jacobian_by_differences(task: str, name: str) -> None:
    for student in STUDENTS:
        given, robot = exercise(task, student, name)
        theta = theta_of(given)
        assert OF_C[task](given, robot, compliance(robot, theta)) == pytest.approx(given.answer, rel=2e-6)
        for slip in given.slips:
            if found := re.match(r"The share of joint (\d) is missing", slip.says):
                without = compliance(robot, theta, int(found[1]) - 1)
                assert OF_C[task](given, robot, without) == pytest.approx(slip.value, rel=1e-5, abs=1e-12)


@pytest.mark.parametrize("name", [*ROBOTS, "seven"])
def test_slips_of_matrices_are_what_their_sentence_says(name: str) -> None:
    for student in STUDENTS:
        given, robot = exercise("tip", student, name)
        theta = theta_of(given)
        J_v, J_w = jacobian(robot, theta)
        levers = tip(given, robot, J_w @ np.diag(robot.C_theta) @ J_w.T)
        told = {slip.says.split(":")[0]: slip.value for slip in given.slips}
        if "The lever arms are missing" in told:
            assert levers == pytest.approx(told["The lever arms are missing"], rel=1e-5, abs=1e-9)
        held, robot = exercise("press", student, name)
        C = compliance(robot, theta_of(held))
        inverse = [slip.value for slip in held.slips if "held aside" in slip.says]
        if inverse:
            a = axis_of(held.text, "force along")
            u = np.eye(3)[a] * numbers(held.text.split("tip by")[1])[0] * 1e-3
            assert np.linalg.solve(C, u)[a] == pytest.approx(inverse[0], rel=1e-3)


@pytest.mark.parametrize("name", [*ROBOTS, "seven"])
def test_torques_are_the_work_of_the_force_by_a_turn_of_the_joint(name: str) -> None:
    for student in STUDENTS:
        given, robot = exercise("torque", student, name)
        F = numbers(given.text.split("force of")[1])[0] * np.eye(3)[axis_of(given.text, "tip along")]
        tau = jacobian(robot, theta_of(given))[0].T @ F
        joint = int(re.search(r"on joint (\d)\?", given.text)[1])  # type: ignore[index]
        assert tau[joint - 1] == pytest.approx(given.answer, rel=1e-6)
        for slip in given.slips:
            if found := re.match(r"This is the torque on joint (\d)", slip.says):
                assert tau[int(found[1]) - 1] == pytest.approx(slip.value, rel=1e-4, abs=1e-6)


@pytest.mark.parametrize("name", [*ROBOTS, "seven"])
def test_shares_are_what_is_lost_when_the_joint_is_rigid(name: str) -> None:
    for student in STUDENTS:
        given, robot = exercise("share", student, name)
        a, theta = axis_of(given.text, "pushed along"), theta_of(given)
        joint = int(re.search(r"joint (\d)'s", given.text)[1])  # type: ignore[index]
        all_of_it = compliance(robot, theta)[a, a]
        lost = [1 - compliance(robot, theta, i)[a, a] / all_of_it for i in range(robot.n)]
        assert lost[joint - 1] == pytest.approx(given.answer, rel=1e-6)
        for slip in given.slips:
            if found := re.match(r"This is the share of joint (\d)", slip.says):
                assert lost[int(found[1]) - 1] == pytest.approx(slip.value, rel=1e-4, abs=1e-8)


@pytest.mark.parametrize("name", [*ROBOTS, "seven"])
def test_distances_from_a_singularity_are_the_product_of_singular_values(name: str) -> None:
    given, robot = exercise("regular", 1234567, name)
    J_v, J_w = jacobian(robot, theta_of(given))
    if robot.n == 5:
        k = rm.tool_pose(robot, theta_of(given))[:3, 2]
        across = np.linalg.svd(k[None])[2][1:]
        J = np.vstack([J_v, across @ J_w])
    else:
        J = np.vstack([J_v, J_w])[{2: [0, 1], 3: [0, 1, 5]}.get(robot.n, [0, 1, 2, 3, 4, 5])]
    size = np.prod(np.linalg.svd(J, compute_uv=False))
    assert size == pytest.approx(abs(given.answer), rel=1e-5)


@pytest.mark.parametrize("name", [*ROBOTS, "seven"])
def test_laboratories_answer_is_the_fit_of_the_table_and_near_the_truth(name: str) -> None:
    for student in STUDENTS:
        given, robot = exercise("laboratory", student, name)
        table = {key: np.array(values) for key, values in given.data.items()}
        theta = np.deg2rad(np.stack([table[f"theta{i + 1}_deg"] for i in range(robot.n)], axis=1))
        F = np.stack([table[f"F{axis}_N"] for axis in "xyz"], axis=1)
        read = np.stack([table[f"d{axis}_um"] for axis in "xyz"], axis=1) * 1e-6
        rows = [
            J[axis] * (J.T @ f) for J, f in zip((jacobian(robot, each)[0] for each in theta), F) for axis in range(3)
        ]
        scale = 1e-6
        fit = scipy.optimize.nnls(np.array(rows) * scale, read.ravel())[0] * scale
        joint = int(re.search(r"joint (\d)\?", given.text)[1])  # type: ignore[index]
        assert fit[joint - 1] == pytest.approx(given.answer, rel=1e-4)
        assert 0.6 * 0.9 < given.answer / robot.C_theta[joint - 1] < 1.6 * 1.1  # drawn from 0.6 to 1.6 times
        missing = {
            int(m[1]): s.value for s in given.slips if (m := re.match(r"Joint (\d) is missing in the fit", s.says))
        }
        for other, value in missing.items():
            kept = [i for i in range(robot.n) if i != other - 1]
            solved = np.linalg.lstsq(np.array(rows)[:, kept] * scale, read.ravel(), rcond=None)[0] * scale
            assert solved[kept.index(joint - 1)] == pytest.approx(value, rel=1e-4, abs=1e-12)


@pytest.mark.parametrize("name", [*ROBOTS, "seven"])
def test_the_soft_joint_is_the_one_that_explains_the_table(name: str) -> None:
    for student in STUDENTS:
        given, robot = exercise("soft_joint", student, name)
        times = numbers(given.text.split("robot is")[1])[0]
        table = {key: np.array(values) for key, values in given.data.items()}
        theta = np.deg2rad(np.stack([table[f"theta{i + 1}_deg"] for i in range(robot.n)], axis=1))
        F = np.stack([table[f"F{axis}_N"] for axis in "xyz"], axis=1)
        read = np.stack([table[f"d{axis}_um"] for axis in "xyz"], axis=1) * 1e-6
        missed = []
        for i in range(robot.n):
            softer = robot.replace(C_theta=robot.C_theta * np.where(np.arange(robot.n) == i, times, 1.0))
            missed.append(max(np.abs(compliance(softer, t) @ f - d).max() for t, f, d in zip(theta, F, read)))
        order = np.argsort(missed)
        assert order[0] + 1 == given.answer
        assert missed[order[0]] < 1e-7 < 3e-6 < missed[order[1]]  # the gauge tells them apart
        assert {slip.value for slip in given.slips} == {i + 1.0 for i in range(robot.n)} - {given.answer}


def test_the_slots_force_is_the_closed_form_of_the_textbook() -> None:
    for student in range(20):
        given = learn.exercise("slot", student)
        teeth, depth, feed = (numbers(given.text)[i] for i in (0, 1, 2))
        Ktc, Kte, Krc, Kre = (numbers(given.text.split(f"{name} = ")[1])[0] for name in ("Ktc", "Kte", "Krc", "Kre"))
        across = teeth * depth * (Ktc * feed / 4 + Kte / np.pi)
        assert across == pytest.approx(given.answer, rel=1e-4)
        told = {slip.says: slip.value for slip in given.slips}
        edge = [value for says, value in told.items() if "Kte is missing" in says]
        assert edge == pytest.approx([teeth * depth * Ktc * feed / 4] * len(edge), rel=1e-4)
        along = [value for says, value in told.items() if "along the feed" in says]
        assert along == pytest.approx([-teeth * depth * (Krc * feed / 4 + Kre / np.pi)] * len(along), rel=1e-4)


def test_a_student_number_gives_the_same_numbers_on_every_machine_and_in_every_version() -> None:
    """A promise to classes: an exercise handed out in autumn is marked in spring. The digest changes only together
    with PROTOCOL, and then the changelog says so."""
    told = [(numbers(given.text), given.unit, sorted(given.data.items())) for given in learn.exercises("1234567")]
    assert hashlib.sha256(repr(told).encode()).hexdigest()[:16] == "66c573091bc793cb"
    assert Draws("a").unit() == int(hashlib.sha256(b"robomill exercises 1|a|0").hexdigest()[:16], 16) // 2**11 / 2**53


def test_blanks_leading_zeros_and_capitals_of_a_student_number_do_not_count() -> None:
    assert student_number(" 0012 345 ") == student_number(12345) == "12345"
    assert student_number("S0815") == "s0815"
    assert learn.exercise("tip", "0042").text == learn.exercise("tip", 42).text


@pytest.mark.parametrize("given", ["", "  ", "a" * 33, "<b>", "../x", "1;2", "ä", "\x00"])
def test_what_is_no_student_number_is_refused_in_a_sentence(given: str) -> None:
    with pytest.raises(LearnError, match="^Student number: found .*, expected up to 32 letters and digits"):
        learn.exercises(given)


def test_neighbouring_student_numbers_have_other_exercises() -> None:
    for task in TASKS:
        assert (
            len(
                {learn.exercise(task.id, 1000 + k).text + str(learn.exercise(task.id, 1000 + k).data) for k in range(8)}
            )
            > 5
        )


def test_an_unknown_exercise_robot_or_kind_is_refused() -> None:
    with pytest.raises(LearnError, match="known are torque, tip"):
        learn.exercise("nothing", 1)
    with pytest.raises(rm.RobomillError, match="nobody"):
        learn.exercises(1, "nobody")
    for wrong in (None, [], {}, 3.5j):
        with pytest.raises(rm.RobomillError):
            learn.exercise(wrong, 1)  # type: ignore[arg-type]
        with pytest.raises(rm.RobomillError):
            learn.exercises(1, wrong)  # type: ignore[arg-type]
    with pytest.raises(ArgumentError):
        learn.check("tip", 1.0)  # type: ignore[arg-type]


def test_the_answer_is_not_in_the_repr() -> None:
    assert "answer" not in repr(learn.exercise("tip", 1))
    assert "slips" not in repr(learn.exercise("tip", 1))
