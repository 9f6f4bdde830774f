"""The virtual laboratory: a robot whose compliances are hidden, a noisy dial gauge, a budget, and a score."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import streamlit as st

from robomill.errors import RobomillError
from robomill.identification.laboratory import Laboratory
from robomill.identification.load_test import LoadTests
from robomill.identification.result import IdentificationResult
from robomill.io.load_test_sheets import load_tests_to_csv
from robomill.kinematics.forward import joint_frames, tool_pose
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import pose_from_world, world_from_pose
from robomill.robot.model import Robot
from robomill.ui import inputs, pieces, session
from robomill.ui.box import NumberBox
from robomill.ui.identification import words
from robomill.ui.identification.bench import Bench, Trial, robot_of
from robomill.ui.identification.plan import theta_columns
from robomill.ui.project import View
from robomill.units import format_number, format_percent, format_si, from_si
from robomill.viz.arm import ArmScene, arm_figure
from robomill.viz.identification import intervals_figure

POSE = (*(NumberBox(name, "mm", 50.0, 1) for name in "XYZ"), *(NumberBox(name, "deg", 5.0, 1) for name in "AB"))
SEED = 1


def page(bench: Bench, view: View, dark: bool, top: Any) -> None:
    """The whole section: what is left (its sentence at the ``top``), the pose, the readings, the fit, the score."""
    robot = robot_of(bench)
    if bench.laboratory is None or bench.laboratory.robot.name != robot.name:
        _open(bench, robot)
    lab = bench.laboratory
    assert lab is not None
    result, reason = _fit(lab)
    done = _taken(lab)
    task = (
        "The compliances of this robot's joints are hidden. Hang weights on the tool, read the dial gauge, find them."
    )
    with top:
        pieces.headline("Virtual laboratory", title(lab, result, bench.handed_in), "" if done else task)
    pieces.tiles(tiles(lab, result, bench.handed_in))
    left, right = pieces.split([1, 1.9], "laboratory", gap="large")
    with left:
        _rules(bench, robot, lab)
        _measure(bench, lab)
    with right:
        with st.container(border=True):
            _arm(robot, bench.trial, dark, 330 if done else 450)
        if result is not None:
            truth = lab.reveal() if bench.handed_in else None
            with st.container(border=True):
                for k, drawn in enumerate(words.intervals(result, _bare(robot), view.joint_unit, truth)):
                    pieces.figure(
                        intervals_figure(drawn, dark=dark),
                        f"lab-intervals-{k}",
                        name="laboratory",
                        table=lambda: words.parameter_columns(result, _bare(robot), view.joint_unit),
                        caption="Crosses: the truth." if bench.handed_in else "Bars: 95 % intervals.",
                        alt="What the readings say of each joint.",
                    )
            _hand_in(bench, lab, result)
        elif done:
            pieces.said("info", reason, "lightbulb")
        _readings(robot, lab.tests)


def _taken(lab: Laboratory) -> int:
    return 0 if lab.tests is None else len(lab.tests)


def title(lab: Laboratory, result: IdentificationResult | None, handed_in: bool) -> str:
    """Where the exercise stands, in one sentence."""
    done = _taken(lab)
    if handed_in and result is not None:
        return lab.score(result).sentence
    if not done:
        return "Which joint of this robot is soft?"
    if result is None:
        return f"{done} readings, {lab.budget} left: not enough yet to tell the joints apart."
    label, half = words.weakest(result)
    known = f"known to {words.within(half)}" if np.isfinite(half) else "not seen at all"
    return f"{done} readings, {lab.budget} left: {label} is {known}."


def tiles(lab: Laboratory, result: IdentificationResult | None, handed_in: bool) -> list[pieces.Tile]:
    """Readings left, the gauge, the weakest joint, the score."""
    least = pieces.Tile("Least known", "everything", "measure first")
    if result is not None:
        label, half = words.weakest(result)
        least = pieces.Tile("Least known", label.capitalize(), words.within(half))
    score = lab.score(result) if handed_in and result is not None else None
    covered = int(np.nansum(score.covered)) if score else 0
    tone = "" if score is None else "ok" if score.points >= 80 else "tight" if score.points >= 50 else "out"
    return [
        pieces.Tile("Readings left", f"{lab.budget}", f"{_taken(lab)} taken"),
        pieces.Tile(
            "Dial gauge",
            f"± {format_si(lab.noise, 'um', 1)}",
            f"one standard deviation; reads to {format_si(lab.resolution, 'um', 0)}",
            kind="assumed",
        ),
        least,
        pieces.Tile(
            "Score",
            f"{format_number(score.points, 0)} of 100" if score else "not handed in",
            f"{covered} of {lab.robot.n} intervals hold the truth" if score else "up to 100, shared by joints",
            tone=tone,
        ),
    ]


def _open(bench: Bench, robot: Robot) -> None:
    """A new exercise with ``robot``, which begins at a pose that it reaches."""
    _begin(bench, Laboratory(robot, seed=SEED))
    reached = bool(inverse_kinematics(robot, pose_from_world(Trial.pose)).reached)
    bench.trial = Trial() if reached else Trial(tuple(world_from_pose(tool_pose(robot, robot.home)).tolist()))


def _begin(bench: Bench, lab: Laboratory) -> None:
    bench.laboratory, bench.handed_in = lab, False


def _rules(bench: Bench, robot: Robot, lab: Laboratory) -> None:
    """Number of the hidden robot, noise and budget; a new exercise begins with the button."""
    boxes = {
        "seed": (NumberBox("Number", whole=True, low=0, high=9999), lab.seed),
        "noise": (NumberBox("Noise", "um", 1.0, 1, low=0, high=500), lab.noise),
        "budget": (NumberBox("Budget", whole=True, low=1, high=500), lab.budget + _taken(lab)),
    }

    def asked(name: str) -> Any:
        return session.kept(f"identification.lab.{name}", boxes[name][1])

    with st.expander(f"Hidden robot no. {lab.seed}", icon=":material/science:"):
        pieces.note("The same number hides the same robot from everyone in the class.")
        for column, (name, (box, _)) in zip(st.columns(3), boxes.items(), strict=True):
            key = f"identification.lab.{name}"
            with column:
                inputs.value(key, box, asked(name), partial(session.keep, key))

        def anew() -> None:
            _begin(bench, Laboratory(robot, **{name: asked(name) for name in boxes}))

        inputs.button("Begin anew", "identification.lab.begin", "restart_alt", anew, width="stretch")


def _measure(bench: Bench, lab: Laboratory) -> None:
    """Pose, weight and direction, and the two buttons that spend readings."""

    def write(**changed: Any) -> None:
        bench.trial = replace(bench.trial, **changed)

    def move(i: int, value: float) -> None:
        pose = bench.trial.pose
        write(pose=(*pose[:i], value, *pose[i + 1 :]))

    trial = bench.trial
    st.markdown("**Put the tool tip at**")
    for i, (box, column) in enumerate(zip(POSE, [*st.columns(3), *st.columns(3)], strict=False)):
        with column:
            inputs.value(f"identification.lab.{box.label}", box, trial.pose[i], partial(move, i))
    st.markdown("**Hang on it**")
    left, right = st.columns([1, 1.6])
    with left:
        load = NumberBox("Load", "N", 50.0, 0)
        inputs.value("identification.lab.load", load, trial.load, lambda v: write(load=v))
    with right:
        axes = {axis: f"+{axis}" for axis in "XYZ"}
        inputs.choice("Direction", "identification.lab.axis", axes, trial.axis, lambda v: write(axis=v))
    spent = lab.budget == 0 or bench.handed_in
    first, second = st.columns(2)
    with first:
        one = ("identification.lab.measure", "straighten", _push, bench, False)
        inputs.button("Measure", *one, type="primary", width="stretch", disabled=spent)
    with second:
        three = ("identification.lab.three", "", _push, bench, True)
        inputs.button("Along X, Y and Z", *three, width="stretch", disabled=spent or lab.budget < 3)
    if spent and not bench.handed_in:
        pieces.note("The budget is spent: hand in what you have.")


def _push(bench: Bench, three: bool) -> None:
    assert bench.laboratory is not None
    trial = bench.trial
    F = np.eye(3) * trial.load if three else trial.F
    bench.laboratory = bench.laboratory.measure_at(np.array(trial.pose), F)


def _fit(lab: Laboratory) -> tuple[IdentificationResult | None, str]:
    try:
        return lab.fit(), ""
    except RobomillError as exc:
        return None, str(exc)


def _arm(robot: Robot, trial: Trial, dark: bool, height: int) -> None:
    solved = inverse_kinematics(robot, pose_from_world(np.array(trial.pose)))
    if not bool(solved.reached):
        pieces.said("info", f"This pose cannot be measured: {solved.reason()}.", "block")
        return
    scene = ArmScene(
        joint_frames(robot, solved.theta),
        force=trial.F,
        force_label=f"{trial.load:g} N",
        joints=robot.joint_numbers,
    )
    pieces.figure(
        arm_figure(scene, dark=dark, height=height, revision="lab-arm", zoom=0.9),
        "lab-arm",
        caption="The pose to be measured and the weight on the tool.",
        alt="The arm at the chosen pose with its load.",
    )


def _hand_in(bench: Bench, lab: Laboratory, result: IdentificationResult) -> None:
    if not bench.handed_in:
        show = (bench.writer("handed_in"), True)
        inputs.button("Hand in and see the truth", "identification.lab.hand_in", "flag", *show)
        pieces.note(result.explain(result.weakest_joint))
        return
    score = lab.score(result)
    rows = [
        (f"Joint {number}", _off(error), "inside its interval" if held else "outside its interval" if held == 0 else "")
        for number, error, held in zip(lab.robot.joint_numbers, score.error, score.covered, strict=True)
    ]
    pieces.facts(rows)
    pieces.note("Begin anew under Hidden robot for another try; the interval is 95 %, so one in twenty may miss.")


def _off(error: float) -> str:
    return "not seen" if np.isnan(error) else f"{format_percent(error, 1)} off"


def _readings(robot: Robot, tests: LoadTests | None) -> None:
    if tests is None:
        return
    assert tests.theta is not None
    with st.expander(f"Readings ({len(tests)})", icon=":material/table:"):
        columns: dict[str, Any] = theta_columns(robot, tests.theta)
        for i, axis in enumerate("xyz"):
            columns[f"F{axis}, N"] = tests.wrench[:, i]
        for i, axis in enumerate("xyz"):
            columns[f"d{axis}, mm"] = np.round(from_si(tests.displacement[:, i], "mm"), 4)
        st.dataframe(columns, hide_index=True, height=min(36 * (len(tests) + 1) + 3, 320))
        remark = "Readings of a virtual laboratory: synthetic, no measurement of a real robot."
        pieces.download(
            "CSV", lambda: load_tests_to_csv(tests, remark), "laboratory.csv", "text/csv", key="identification.lab.csv"
        )


def _bare(robot: Robot) -> Robot:
    """The robot without its compliance sets, so that no reference values give the game away."""
    return replace(robot, compliance_sets={}, compliance_set="user")
