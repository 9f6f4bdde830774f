"""The virtual laboratory: a robot whose compliances are hidden, a noisy dial gauge, a budget, and a score."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import streamlit as st

from robomill.errors import LoadTestError, RobomillError
from robomill.identification.laboratory import MAX_LOAD, Laboratory
from robomill.identification.load_test import LoadTests
from robomill.identification.result import IdentificationResult
from robomill.io.load_test_sheets import load_tests_to_csv
from robomill.kinematics.forward import joint_frames, tool_pose
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import pose_from_world, world_from_pose
from robomill.robot.model import Robot
from robomill.ui import inputs, pieces
from robomill.ui.identification import words
from robomill.ui.identification.bench import SAMPLE_ROBOT, Bench, robot_of
from robomill.ui.project import View
from robomill.units import format_number, format_percent, format_si, from_si, to_si
from robomill.viz.arm import ArmScene, arm_figure
from robomill.viz.identification import intervals_figure

POSE = (("X", "mm"), ("Y", "mm"), ("Z", "mm"), ("A", "deg"), ("B", "deg"))
KEPT = "identification:laboratory"
START: dict[str, Any] = {"pose": (0.0, -1.3, 0.0, 0.0, 0.0), "push": "Y", "load": 250.0}
BUDGET, NOISE, SEED = 12, 5e-6, 1


def page(kept: Bench, view: View, dark: bool, top: Any) -> None:
    """The whole section: what is left (its sentence at the ``top``), the pose, the readings, the fit, the score."""
    robot = robot_of(kept)
    if kept.laboratory is None or kept.laboratory.robot.name != robot.name:
        _open(kept, robot, SEED, NOISE, BUDGET)
    lab = kept.laboratory
    assert lab is not None
    result, reason = _fit(lab)
    done = 0 if lab.tests is None else len(lab.tests)
    task = (
        "The compliances of this robot's joints are hidden. Hang weights on the tool, read the dial gauge, find them."
    )
    with top:
        pieces.headline("Virtual laboratory", title(lab, done, result, kept.handed_in), "" if done else task)
    pieces.tiles(tiles(lab, done, result, kept.handed_in))
    left, right = pieces.split([1, 1.9], "laboratory", gap="large")
    with left:
        _rules(kept, robot, lab)
        _measure(kept, robot, lab)
    with right:
        with st.container(border=True):
            _arm(robot, dark, 330 if done else 450)
        if result is not None:
            truth = lab.reveal() if kept.handed_in else None
            with st.container(border=True):
                for k, drawn in enumerate(words.intervals(result, _bare(robot), view.joint_unit, truth)):
                    pieces.figure(
                        intervals_figure(drawn, dark=dark),
                        f"lab-intervals-{k}",
                        name="laboratory",
                        table=lambda: words.parameter_columns(result, _bare(robot), view.joint_unit),
                        caption="Crosses: the truth." if kept.handed_in else "Bars: 95 % intervals.",
                        alt="What the readings say of each joint.",
                    )
            _hand_in(kept, lab, result)
        elif done:
            st.info(reason, icon=":material/lightbulb:")
        _readings(lab.tests)


def title(lab: Laboratory, done: int, result: IdentificationResult | None, handed_in: bool) -> str:
    """Where the exercise stands, in one sentence."""
    if handed_in and result is not None:
        return lab.score(result).sentence
    if not done:
        return "Which joint of this robot is soft?"
    if result is None:
        return f"{done} readings, {lab.budget} left: not enough yet to tell the joints apart."
    label, half = words.weakest(result)
    known = f"known to ± {format_percent(half)}" if np.isfinite(half) else "not seen at all"
    return f"{done} readings, {lab.budget} left: {label} is {known}."


def tiles(lab: Laboratory, done: int, result: IdentificationResult | None, handed_in: bool) -> list[pieces.Tile]:
    """Readings left, the gauge, the weakest joint, the score."""
    weakest = words.weakest(result) if result is not None else None
    if weakest is None:
        least = pieces.Tile("Least known", "everything", "measure first")
    else:
        label, half = weakest
        known = f"± {format_percent(half)}" if np.isfinite(half) else "not seen"
        least = pieces.Tile("Least known", label.capitalize(), known)
    score = lab.score(result) if handed_in and result is not None else None
    covered = int(np.nansum(score.covered)) if score else 0
    tone = "" if score is None else "ok" if score.points >= 80 else "tight" if score.points >= 50 else "out"
    return [
        pieces.Tile("Readings left", f"{lab.budget}", f"{done} taken"),
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


def _open(kept: Bench, robot: Robot, seed: int, noise: float, budget: int) -> None:
    kept.laboratory = Laboratory(robot, seed=seed, noise=noise, budget=budget)
    kept.handed_in = False
    if KEPT not in st.session_state or st.session_state[KEPT].get("robot") != robot.name:
        pose = START["pose"]
        if robot.name != SAMPLE_ROBOT:
            pose = tuple(float(v) for v in world_from_pose(tool_pose(robot, robot.home)))
        st.session_state[KEPT] = {**START, "pose": pose, "robot": robot.name}


def _rules(kept: Bench, robot: Robot, lab: Laboratory) -> None:
    """Number of the hidden robot, noise and budget; a new exercise begins with the button."""
    with st.expander(f"Hidden robot no. {lab.seed}", icon=":material/science:"):
        pieces.note("The same number hides the same robot from everyone in the class.")
        first, second, third = st.columns(3)
        done = 0 if lab.tests is None else len(lab.tests)
        values = {"seed": lab.seed, "noise": round(float(from_si(lab.noise, "um")), 6), "budget": lab.budget + done}
        for name, value in values.items():
            if f"lab:{name}" not in st.session_state:
                st.session_state[f"lab:{name}"] = value
        first.number_input("Number", 0, 9999, key="lab:seed", step=1)
        second.number_input("Noise, µm", 0.0, 500.0, key="lab:noise", step=1.0, format="%.1f")
        third.number_input("Budget", 1, 500, key="lab:budget", step=1)

        def begin() -> None:
            chosen: dict[str, Any] = {name: st.session_state.get(f"lab:{name}") for name in values}
            if None in chosen.values():
                inputs.refuse("lab:new", None, "Number, noise and budget: one of the boxes is empty; fill it in.")
                return
            inputs.accept("lab:new")
            _open(kept, robot, int(chosen["seed"]), to_si(float(chosen["noise"]), "um"), int(chosen["budget"]))

        st.button("Begin anew", on_click=begin, key="lab:new", icon=":material/restart_alt:", width="stretch")
        inputs.sentence("lab:new")


def _measure(kept: Bench, robot: Robot, lab: Laboratory) -> None:
    """Pose, weight and direction, and the two buttons that spend readings."""
    choice = st.session_state[KEPT]
    st.markdown("**Put the tool tip at**")
    for names in (POSE[:3], POSE[3:]):
        for column, (name, unit) in zip(st.columns(3), names, strict=False):
            key, i = f"lab:{name}", [n for n, _ in POSE].index(name)
            inputs.seed(key, round(float(from_si(choice["pose"][i], unit)), 6))
            step, mark = (50.0, "mm") if unit == "mm" else (5.0, "°")
            column.number_input(
                f"{name}, {mark}", key=key, step=step, format="%.1f", on_change=_take_pose, args=(i, key, unit)
            )
    st.markdown("**Hang on it**")
    left, right = st.columns([1, 1.6])
    with left:
        inputs.seed("lab:load", float(choice["load"]))
        st.number_input("Load, N", key="lab:load", step=50.0, format="%.0f", on_change=_take_load)
    with right:
        inputs.choice(
            "Direction",
            "lab:push",
            {a: f"+{a}" for a in "XYZ"},
            choice["push"],
            lambda a: st.session_state[KEPT].update(push=a),
        )
    spent = lab.budget == 0 or kept.handed_in
    first, second = st.columns(2)
    first.button(
        "Measure",
        key="lab:measure",
        type="primary",
        width="stretch",
        disabled=spent,
        icon=":material/straighten:",
        on_click=_push,
        args=(kept, False),
    )
    second.button(
        "Along X, Y and Z",
        key="lab:three",
        width="stretch",
        disabled=spent or lab.budget < 3,
        on_click=_push,
        args=(kept, True),
    )
    inputs.sentence("lab:measure")
    if spent and not kept.handed_in:
        pieces.note("The budget is spent: hand in what you have.")


def _take_pose(i: int, key: str, unit: str) -> None:
    typed = st.session_state[key]
    if typed is None:
        inputs.refuse("lab:measure", None, f"{POSE[i][0]} is empty: type a number.")
        return
    pose = list(st.session_state[KEPT]["pose"])
    pose[i] = to_si(float(typed), unit)
    st.session_state[KEPT]["pose"] = tuple(pose)
    inputs.accept("lab:measure")


def _take_load() -> None:
    def put() -> None:
        typed = st.session_state["lab:load"]
        if typed is None or not 0 < typed <= MAX_LOAD:
            found = "nothing" if typed is None else f"{typed:g} N"
            raise LoadTestError(f"Load: found {found}, expected more than 0 and at most {MAX_LOAD:g} N.")
        st.session_state[KEPT]["load"] = float(typed)

    inputs.submit("lab:measure", None, put)


def _push(kept: Bench, three: bool) -> None:
    def put() -> None:
        assert kept.laboratory is not None
        choice = st.session_state[KEPT]
        F = np.eye(3) * choice["load"]
        chosen = F if three else F["XYZ".index(choice["push"])]
        kept.laboratory = kept.laboratory.measure_at(np.array(choice["pose"]), chosen)

    inputs.submit("lab:measure", None, put)


def _fit(lab: Laboratory) -> tuple[IdentificationResult | None, str]:
    try:
        return lab.fit(), ""
    except RobomillError as exc:
        return None, str(exc)


def _arm(robot: Robot, dark: bool, height: int) -> None:
    choice = st.session_state[KEPT]
    solved = inverse_kinematics(robot, pose_from_world(np.array(choice["pose"])))
    if not bool(solved.reached):
        st.info(f"This pose cannot be measured: {solved.reason()}.", icon=":material/block:")
        return
    force = np.eye(3)["XYZ".index(choice["push"])] * choice["load"]
    scene = ArmScene(frames=joint_frames(robot, solved.theta), force=force, force_label=f"{choice['load']:g} N")
    pieces.figure(
        arm_figure(scene, dark=dark, height=height, revision="lab-arm", zoom=0.9),
        "lab-arm",
        caption="The pose to be measured and the weight on the tool.",
        alt="The arm at the chosen pose with its load.",
    )


def _hand_in(kept: Bench, lab: Laboratory, result: IdentificationResult) -> None:
    if not kept.handed_in:
        st.button(
            "Hand in and see the truth",
            key="lab:hand",
            icon=":material/flag:",
            on_click=lambda: setattr(kept, "handed_in", True),
        )
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


def _readings(tests: LoadTests | None) -> None:
    if tests is None:
        return
    assert tests.theta is not None
    with st.expander(f"Readings ({len(tests)})", icon=":material/table:"):
        columns: dict[str, Any] = {
            f"θ{i + 1}, °": np.round(from_si(tests.theta[:, i], "deg"), 2) for i in range(tests.theta.shape[1])
        }
        for i, axis in enumerate("xyz"):
            columns[f"F{axis}, N"] = tests.wrench[:, i]
        for i, axis in enumerate("xyz"):
            columns[f"d{axis}, mm"] = np.round(from_si(tests.displacement[:, i], "mm"), 4)
        st.dataframe(columns, hide_index=True, height=min(36 * (len(tests) + 1) + 3, 320))
        remark = "Readings of a virtual laboratory: synthetic, no measurement of a real robot."
        pieces.download("CSV", lambda: load_tests_to_csv(tests, remark), "laboratory.csv", "text/csv", key="lab:csv")


def _bare(robot: Robot) -> Robot:
    """The robot without its compliance sets, so that no reference values give the game away."""
    return replace(robot, compliance_sets={}, compliance_set="user")
