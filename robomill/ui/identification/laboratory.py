"""The virtual laboratory: a robot whose compliances are hidden, a noisy dial gauge, a budget, and a score."""

from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.errors import LoadTestError, RobomillError
from robomill.identification.laboratory import MAX_LOAD, Laboratory
from robomill.identification.load_test import LoadTests
from robomill.identification.result import IdentificationResult
from robomill.io.measured.load_test_sheets import load_tests_to_csv
from robomill.kinematics.forward import joint_frames, tool_pose
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import pose_from_world, world_from_pose
from robomill.paper import SLOT
from robomill.quantities import choice, quantities, quantity, settle, whole
from robomill.robot.model import Robot
from robomill.ui import pieces, session
from robomill.ui.bench import Bench
from robomill.ui.entry import declared, inputs
from robomill.ui.identification import words
from robomill.ui.identification.bench import robot_of
from robomill.ui.identification.plan import theta_columns
from robomill.ui.posed.arm import arm
from robomill.ui.project import View
from robomill.units import decimals, format_number, format_percent, format_short, format_si, from_si, unit_label
from robomill.viz.arm import ArmScene
from robomill.viz.identification import intervals_figure

KEY = "identification.lab"
HEIGHT, ASPECT = 380, 1.3  # of the picture; of the arm's frame: a narrower column shows it smaller
TONES = {"good": "ok", "fair": "tight", "poor": "out"}


@dataclass(frozen=True, eq=False)
class Rules:
    """What hides the robot, how far the dial gauge is off (one standard deviation, m), how many readings there are."""

    seed: int = whole("Number", least=0, most=9999, default=1)
    noise: float = quantity("Noise", "um", least=0.0, most=500e-6, default=Laboratory.noise)
    budget: int = whole("Budget", least=1, most=500, default=Laboratory.budget)

    def __post_init__(self) -> None:
        settle(self, LoadTestError)


@dataclass(frozen=True, eq=False)
class Trial:
    """What is measured next: the tip (3,) m in {M} and the tilt A, B rad; the load, N, along an axis of {M}."""

    tip: FloatArray = quantity("Tip", "mm", shape=(3,), axes=tuple("XYZ"), digits=1, default=SLOT.point)
    tilt: FloatArray = quantity("Tilt", "deg", shape=(2,), axes=tuple("AB"), digits=1, default=(0.0, 0.0))
    load: float = quantity("Load", "N", above=0.0, most=MAX_LOAD, digits=0, default=250.0)
    axis: str = choice("Direction", {axis: f"+{axis}" for axis in "XYZ"}, default="Y")

    def __post_init__(self) -> None:
        settle(self, LoadTestError)

    @property
    def pose(self) -> FloatArray:
        """(5,) X, Y, Z, A, B."""
        return np.concatenate([self.tip, self.tilt])

    @property
    def F(self) -> FloatArray:
        """(3,) N in {M}."""
        return np.eye(3)["XYZ".index(self.axis)] * self.load


@dataclass(eq=False)
class Exercise:
    """An exercise under way, in the session only: it is no part of the project. ``rules`` are those of the next one."""

    laboratory: Laboratory
    trial: Trial
    rules: Rules = field(default_factory=Rules)
    handed_in: bool = False


def exercise(robot: Robot) -> Exercise:
    """The exercise with ``robot``; a new one begins at the paper's point, or where the arm stands at home."""
    held: Exercise | None = session.kept(KEY)
    if held is None or held.laboratory.robot.name != robot.name:
        trial, rules = Trial(), Rules()
        if not inverse_kinematics(robot, pose_from_world(trial.pose)).reached:
            home = world_from_pose(tool_pose(robot, robot.home))
            trial = Trial(tip=home[:3], tilt=home[3:])
        held = Exercise(_laboratory(robot, rules), trial, rules)
        session.keep(KEY, held)
    return held


def _laboratory(robot: Robot, rules: Rules) -> Laboratory:
    return Laboratory(robot, rules.seed, rules.noise, budget=rules.budget)


def page(bench: Bench, view: View, dark: bool, top: Any) -> None:
    """The whole section: what is left (its sentence at the ``top``), the pose, the readings, the fit, the score."""
    robot = robot_of(bench)
    now = exercise(robot)
    lab = now.laboratory
    result, reason = _fit(lab)
    done = _taken(lab)
    task = (
        "The compliances of this robot's joints are hidden. Hang weights on the tool, read the dial gauge, find them."
    )
    with top:
        pieces.headline("Identification · virtual laboratory", title(lab, result, now.handed_in), "" if done else task)
    pieces.tiles(tiles(lab, result, now.handed_in))
    left, right = pieces.split([1, 1.9], "laboratory")
    with left:
        _rules(now, robot)
        _measure(now)
    with right:
        with st.container(border=True):
            _arm(robot, now.trial)
        if result is not None:
            truth = lab.reveal() if now.handed_in else None
            with st.container(border=True):
                for k, drawn in enumerate(words.intervals(result, _bare(robot), view.joint_unit, truth)):
                    pieces.figure(
                        intervals_figure(drawn, dark=dark),
                        f"lab-intervals-{k}",
                        name="laboratory",
                        table=lambda: words.parameter_columns(result, _bare(robot), view.joint_unit),
                        caption="Crosses: the truth." if now.handed_in else "Bars: 95 % intervals.",
                        alt="What the readings say of each joint.",
                    )
            _hand_in(now, result)
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
    least = pieces.Tile("Least certain", "everything", "measure first")
    if result is not None:
        label, half = words.weakest(result)
        least = pieces.Tile("Least certain", label.capitalize(), words.within(half))
    score = lab.score(result) if handed_in and result is not None else None
    covered = int(np.nansum(score.covered)) if score else 0
    tone = "" if score is None else TONES[score.grade]
    return [
        pieces.Tile("Readings left", f"{lab.budget}", f"{_taken(lab)} taken"),
        pieces.Tile(
            "Dial gauge",
            f"± {format_si(lab.noise, session.project().view.of('um'), 1)}",
            f"one standard deviation; reads to {format_si(lab.resolution, session.project().view.of('um'), 0)}",
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


def _rules(now: Exercise, robot: Robot) -> None:
    """Number of the hidden robot, noise and budget; a new exercise begins with the button."""

    def write(name: str, value: Any) -> None:
        now.rules = replace(now.rules, **{name: value})

    def anew() -> None:
        now.laboratory, now.handed_in = _laboratory(robot, now.rules), False

    with st.expander(f"Hidden robot no. {now.laboratory.seed}", icon=":material/science:"):
        pieces.note("The same number hides the same robot from everyone in the class.")
        declared.fields(now.rules, KEY, write)
        inputs.button("Begin anew", "identification.lab.begin", "restart_alt", anew, width="stretch")


def _measure(now: Exercise) -> None:
    """Pose, weight and direction, and the two buttons that spend readings."""

    def draw(name: str) -> None:
        def write(value: Any) -> None:
            now.trial = replace(now.trial, **{name: value})

        declared.draw(quantities(Trial)[name], f"{KEY}.{name}", getattr(now.trial, name), write)

    st.markdown("**Put the tool tip at, and hang on it**")
    for name in ("tip", "tilt"):
        draw(name)
    left, right = st.columns([1, 1.6])
    with left:
        draw("load")
    with right:
        draw("axis")
    lab = now.laboratory
    spent = lab.budget == 0 or now.handed_in
    first, second = st.columns(2)
    with first:
        one = ("identification.lab.measure", "straighten", _push, now, now.trial.F)
        inputs.button("Measure", *one, type="primary", width="stretch", disabled=spent)
    with second:
        three = ("identification.lab.three", "", _push, now, np.eye(3) * now.trial.load)
        inputs.button("Along X, Y and Z", *three, width="stretch", disabled=spent or lab.budget < 3)
    if spent and not now.handed_in:
        pieces.note("The budget is spent: hand in what you have.")


def _push(now: Exercise, F: FloatArray) -> None:
    now.laboratory = now.laboratory.measure_at(now.trial.pose, F)


def _fit(lab: Laboratory) -> tuple[IdentificationResult | None, str]:
    try:
        return lab.fit(), ""
    except RobomillError as exc:
        return None, str(exc)


def _arm(robot: Robot, trial: Trial) -> None:
    solved = inverse_kinematics(robot, pose_from_world(trial.pose))
    if not bool(solved.reached):
        pieces.said("info", f"This pose cannot be measured: {solved.reason()}.", "block")
        return
    scene = ArmScene(
        joint_frames(robot, solved.theta),
        force=trial.F,
        force_label=format_short(trial.load, "N"),
        joints=robot.joint_numbers,
        aspect=ASPECT,
    )
    words = ("The pose to be measured and the weight on the tool.", "The arm at the chosen pose with its load.")
    arm(scene, "lab-arm", words, HEIGHT)


def _hand_in(now: Exercise, result: IdentificationResult) -> None:
    lab = now.laboratory
    if not now.handed_in:
        show = partial(setattr, now, "handed_in", True)
        inputs.button("Hand in and see the truth", "identification.lab.hand_in", "flag", show)
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
    unit = session.project().view.length
    with st.expander(f"Readings ({len(tests)})", icon=":material/table:"):
        columns: dict[str, Any] = theta_columns(robot, tests.theta)
        for i, axis in enumerate("xyz"):
            columns[f"F{axis}, N"] = tests.wrench[:, i]
        moved = np.round(from_si(tests.displacement, unit), decimals(unit, None) + 1)
        columns |= {f"d{axis}, {unit_label(unit)}": moved[:, i] for i, axis in enumerate("xyz")}
        st.dataframe(columns, hide_index=True, height=pieces.rows_high(len(tests), 320))
        remark = "Readings of a virtual laboratory: synthetic, no measurement of a real robot."
        text = partial(load_tests_to_csv, tests, remark)
        pieces.download("CSV", text, "laboratory.csv", "identification.lab.csv")


def _bare(robot: Robot) -> Robot:
    """The robot without its compliance sets, so that no reference values give the game away."""
    return replace(robot, compliance_sets={}, compliance_set="user")
