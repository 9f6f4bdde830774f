"""The eight lessons: every answer and every other choice found another way, for arms of 2 to 7 axes."""

from __future__ import annotations

import html
import re

import numpy as np
import pytest
from truth import SEVEN, compliance, jacobian

import robomill as rm
from robomill.compliance.at_pose import PoseReport
from robomill.errors import LearnError
from robomill.learn.handout import handout, notes
from robomill.learn.lesson import COUNT, MINUTES, TITLES, Lesson
from robomill.learn.lessons import lesson
from robomill.learn.marking import check

STANDS = {
    "kuka_kr270": [10, -60, 80, 20, 40, 15],
    "fanuc_r2000ic": [10, -60, 80, 20, 40, 15],
    "planar_2r": [20, 50],
    "planar_3r": [20, 50, 30],
}


def pose_of(name: str) -> PoseReport:
    if name == "seven":
        return rm.at_pose(SEVEN, np.deg2rad([10, 40, 20, -70, 30, 60, 5]))
    robot = rm.load_robot(name)
    if name == "slavkovic_5r":
        return rm.at_pose(robot, rm.inverse_kinematics(robot, rm.pose_from_world([0.0, -1.3, 0.0, 0.0, 0.0])).theta)
    return rm.at_pose(robot, np.deg2rad(STANDS[name]))


@pytest.fixture(scope="module", params=["slavkovic_5r", *STANDS, "seven"])
def pose(request: pytest.FixtureRequest) -> PoseReport:
    return pose_of(request.param)


@pytest.fixture(scope="module")
def lessons(pose: PoseReport) -> list[Lesson]:
    return [lesson(k, pose) for k in range(1, COUNT + 1)]


def number(text: str) -> float:
    return float(re.findall(r"[−+-]?[\d.]+", text)[-1].replace("−", "-"))


def beside(pose: PoseReport, names: tuple[str, ...]) -> dict[str, np.ndarray]:
    """C at the places that the choices name, by the pose that the model is sent to."""
    found = {}
    for name in names:
        T = pose.T_MT.copy()
        if way := re.search(r"150 mm towards ([+−])([XY])", name):
            T["XY".index(way[2]), 3] += 0.15 * (1 if way[1] == "+" else -1)
        there = rm.inverse_kinematics(pose.robot, T, near=pose.theta)
        theta = there.theta if "towards" in name else pose.theta
        np.testing.assert_allclose(rm.tool_pose(pose.robot, theta)[:3, 3], T[:3, 3], atol=1e-6)
        found[name] = (compliance(pose.robot, theta), theta)
    return found


def test_where_the_tip_goes_is_c_times_f(pose: PoseReport, lessons: list[Lesson]) -> None:
    first = lessons[0]
    delta = compliance(pose.robot, pose.theta) @ first.push
    np.testing.assert_allclose(first.moved, delta, rtol=1e-5, atol=1e-12)
    along = int(np.argmax(first.push))
    aside = [i for i in range(3) if i != along and abs(delta[i]) > 0.02 * np.linalg.norm(delta)]
    text = first.choices[first.right].text
    if not aside:
        assert text.endswith("nowhere else")
    else:
        most = max(aside, key=lambda i: abs(delta[i]))
        up = delta[most] > 0
        words = {2: "up" if up else "down"}.get(most, f"towards {'+' if up else '−'}{'XYZ'[most]}")
        assert text.endswith((words, f"along {'XYZ'[most]}"))


def test_which_joint_gives_is_what_is_lost_when_it_is_rigid(pose: PoseReport, lessons: list[Lesson]) -> None:
    second = lessons[1]
    delta = compliance(pose.robot, pose.theta) @ second.push
    lost = [
        1 - (compliance(pose.robot, pose.theta, i) @ second.push) @ delta / (delta @ delta) for i in range(pose.robot.n)
    ]
    assert second.right == int(np.argmax(lost))
    for choice, share in zip(second.choices, lost, strict=True):
        assert number(choice.told.split("%")[0]) == pytest.approx(100 * share, abs=0.51)


def test_the_lever_arms_factor_is_of_the_largest_ways_by_newton(pose: PoseReport, lessons: list[Lesson]) -> None:
    third = lessons[2]
    assert third.typed is not None
    near, far = (float(x) / 1e3 for x in re.findall(r"(\d+) mm", third.question))
    base, p = pose.robot.T_base[:2, 3], pose.T_MT[:3, 3]
    way = (p[:2] - base) / np.linalg.norm(p[:2] - base)
    largest = []
    for radius in (near, far * (1 - 1e-4)):
        T = rm.pose_from_world([*(base + radius * way), p[2], 0.0, 0.0])
        there = rm.inverse_kinematics(pose.robot, T)
        largest.append(np.linalg.norm(compliance(pose.robot, there.theta), 2) if there.reached else np.nan)
    if np.isfinite(largest).all() and pose.robot.n < 7:  # seven axes have many ways to stand there
        assert largest[1] / largest[0] == pytest.approx(third.typed.answer, rel=0.04)
    for slip in third.typed.slips:
        wanted = {"ratio of the distances:": far / near, "squared": (far / near) ** 2, "as soft as before": 1.0}
        assert slip.value == pytest.approx(next(v for k, v in wanted.items() if k in slip.says), rel=2e-3)


def test_the_map_is_read_at_poses_that_the_arm_takes(pose: PoseReport, lessons: list[Lesson]) -> None:
    fourth = lessons[3]
    a = int(np.argmax(fourth.push))
    found = {name: C[a, a] * 1e6 for name, (C, _) in beside(pose, tuple(c.text for c in fourth.choices)).items()}
    for choice in fourth.choices:
        assert number(choice.told.split("µm")[0]) == pytest.approx(found[choice.text], abs=6e-4)
    assert found[fourth.choices[fourth.right].text] == pytest.approx(min(found.values()), rel=1e-5)


def test_up_and_down_milling_push_as_the_integral_over_the_arc_says(pose: PoseReport, lessons: list[Lesson]) -> None:
    """Mean force by a sum over the arc of engagement; the tooth at phi cuts c sin(phi), phi clockwise from the left."""
    fifth = lessons[4]
    row = rm.load_material("al7075_t6_carbide_ref190")
    arc = np.arccos(1 - 2 * 2.0 / 8.0)
    C, shifts = compliance(pose.robot, pose.theta), []
    for start, side in ((0.0, 1.0), (np.pi - arc, -1.0)):
        phi = start + (np.arange(20_000) + 0.5) * arc / 20_000
        h = 0.05e-3 * np.sin(phi)
        Ft, Fr, Fa = (K * h + E for K, E in ((row.Ktc, row.Kte), (row.Krc, row.Kre), (row.Kac, row.Kae)))
        weight = 3 * 2e-3 * arc / (2 * np.pi)
        x = np.mean(-Ft * np.cos(phi) - Fr * np.sin(phi)) * weight
        y = np.mean(Ft * np.sin(phi) - Fr * np.cos(phi)) * weight
        F = np.array([x, y, -np.mean(Fa) * weight])
        shifts.append(side * float((C @ F)[1]))
    said = re.findall(r"([\d.]+) µm (into|away from) its wall", fifth.answer)
    told = [float(far) * (1 if way == "into" else -1) for far, way in said]
    assert told == pytest.approx([1e6 * shift for shift in shifts], abs=0.06)
    words = ["too much is cut away" if shift > 0 else "material is left" for shift in shifts]
    assert fifth.choices[fifth.right].text == f"Up: {words[0]}; down: {words[1]}"
    assert len({choice.text for choice in fifth.choices}) == 4


def test_the_test_that_sees_a_joint_moves_the_tip_most_by_it(pose: PoseReport, lessons: list[Lesson]) -> None:
    sixth = lessons[5]
    joint = int(re.search(r"joint (\d)", sixth.question)[1]) - 1  # type: ignore[index]
    places = beside(pose, tuple({choice.text.split(",")[0] for choice in sixth.choices}))
    seen = []
    for choice in sixth.choices:
        name, axis = choice.text.split(", pushed along ")
        J = jacobian(pose.robot, places[name][1])[0][:, joint]
        seen.append(float(pose.robot.C_theta[joint] * np.linalg.norm(J) * abs(J["XYZ".index(axis)]) * 250e6))
        assert number(choice.told.split("µm")[0]) == pytest.approx(seen[-1], abs=0.06)
    assert seen[sixth.right] == pytest.approx(max(seen), abs=1e-3)


def test_what_compensation_leaves_is_a_fifth_of_what_the_model_says(pose: PoseReport, lessons: list[Lesson]) -> None:
    seventh = lessons[6]
    assert seventh.typed is not None
    a = int(np.argmax(seventh.push))
    model = compliance(pose.robot, pose.theta)[a, a] * 100
    assert seventh.typed.answer == pytest.approx(0.2 * model, rel=1e-5)
    assert sorted(slip.value / model for slip in seventh.typed.slips) == pytest.approx([0.24, 1.0, 1.2], rel=1e-5)


def test_the_budget_is_spent_where_least_is_left(pose: PoseReport, lessons: list[Lesson]) -> None:
    eighth = lessons[7]
    places = beside(pose, tuple(choice.text for choice in eighth.choices))
    left = []
    for choice in eighth.choices:
        C = places[choice.text][0]
        if made := re.match(r"Make joint (\d) twice as stiff", choice.text):
            halved = np.where(np.arange(pose.robot.n) == int(made[1]) - 1, 0.5, 1.0)
            C = compliance(pose.robot.replace(C_theta=pose.robot.C_theta * halved), pose.theta)
        left.append(float(np.linalg.norm(C @ eighth.push)))
        assert number(choice.told.split(": ")[1].split("mm")[0]) == pytest.approx(1e3 * left[-1], abs=6e-4)
    assert eighth.right == int(np.argmin(left))


def test_a_typed_prediction_knows_its_slips(lessons: list[Lesson]) -> None:
    for each in lessons:
        if each.typed is not None:
            assert check(each.typed, each.typed.answer / {"mm": 1e-3, "1": 1.0}[each.typed.unit]).right
            for slip in each.typed.slips:
                found = check(each.typed, slip.value / {"mm": 1e-3, "1": 1.0}[each.typed.unit])
                assert found.sentence == slip.says


def test_every_lesson_is_whole(lessons: list[Lesson]) -> None:
    for each in lessons:
        assert each.question.endswith("?")
        assert each.reason.endswith(".")
        assert each.breaking.endswith((".", "?"))
        assert 0 <= each.right < len(each.choices)
        assert each.typed is not None or len({choice.text for choice in each.choices}) == len(each.choices) >= 2
        assert each.equation.count("{") == each.equation.count("}")


def test_a_lesson_is_fifty_minutes() -> None:
    assert sum(MINUTES) == 50
    assert len(MINUTES) == len(TITLES) == COUNT == 8


def test_the_hand_out_asks_and_the_notes_answer(lessons: list[Lesson]) -> None:
    where = 'An arm called <script>alert("x")</script>.'
    asked, told = handout(lessons, where), notes(lessons, where)
    for page in (asked, told):
        assert page.startswith("<!doctype html>")
        assert "<script" not in page
        assert "http" not in page  # no foreign request
        assert "@media print" in page
        for each in lessons:
            assert html.escape(each.question, quote=False) in page
    assert "50 minutes" in told
    for each in lessons:
        assert html.escape(each.reason, quote=False) in told
        assert html.escape(each.reason, quote=False) not in asked
    assert "class='right'" not in asked


@pytest.mark.parametrize("given", [0, 9, -1, 1.5, "1", None])
def test_a_lesson_that_is_none_is_refused(given: object) -> None:
    with pytest.raises(rm.RobomillError):
        lesson(given, pose_of("planar_2r"))  # type: ignore[arg-type]


def test_a_pose_that_is_not_reached_has_no_lesson() -> None:
    robot = rm.load_robot("planar_2r")
    with pytest.raises(LearnError, match="not reached"):
        lesson(1, rm.at_pose(robot, [np.nan, np.nan]))
