"""Which poses to measure next: goal, plan, measuring sheet, and the filled-in sheet back."""

from functools import partial
from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.identification.plan import MARGIN, POSES, Loads, Plan, candidates_around, next_best
from robomill.identification.result import IdentificationResult
from robomill.io.columns import append_rows
from robomill.io.measured.load_test_columns import LAYOUT
from robomill.io.measured.load_test_sheets import measuring_sheet
from robomill.io.measured.load_tests import read_load_tests
from robomill.robot.model import Robot
from robomill.ui import pieces, session
from robomill.ui.bench import Bench
from robomill.ui.entry import inputs
from robomill.ui.identification.bench import decided, field, put_tests, remembered, tests_of
from robomill.ui.identification.cut import cut_of
from robomill.ui.identification.inputs import upload
from robomill.units import format_count, format_si, from_si, unit_label
from robomill.viz.identification import gain_figure
from robomill.wording import signed


def measure_next(bench: Bench, robot: Robot, result: IdentificationResult, unit: str, dark: bool) -> None:
    """Goal, box and load; the poses to measure, as a table and a sheet; intervals before and after."""
    if tests_of(bench, robot).single:
        st.info("One joint at a time needs no plan: load the joint known least once more.", icon=":material/info:")
        return
    _goal_inputs(bench, robot, result)
    plan = pieces.attempt(plan_of, bench, robot, result)
    if plan is None:
        return
    pieces.strong(plan.sentence())
    with st.container(border=True):
        names = [p.label.capitalize() for p in plan.labels]
        live = [k for k, p in enumerate(plan.labels) if p.label not in result.lumped and result.parameters[k] > 0]
        with np.errstate(invalid="ignore", divide="ignore"):
            before, after = (100.0 * h / np.abs(result.parameters) for h in (plan.half_before, plan.half_after))
        pieces.figure(
            gain_figure([names[k] for k in live], before[live], after[live], dark=dark),
            "ident-gain",
            name="plan-intervals",
            table=lambda: {"parameter": names, "half_now_%": before, "half_after_%": after},
            caption="As the noise of these tests says; the new readings decide.",
            alt="Half widths of the 95 % intervals now and after the planned tests.",
        )
    columns = plan_columns(robot, plan, unit)
    st.dataframe(columns, hide_index=True)
    with st.container(horizontal=True, vertical_alignment="center", gap="small"):
        sheet = partial(measuring_sheet, plan, bench.name)
        pieces.download("Measuring sheet (CSV)", sheet, "measuring-sheet.csv", "identification.sheet")
        pieces.note("Fill in dx, dy, dz and bring the sheet back here: its rows join the tests.")
    upload(
        "Filled-in sheet (CSV)",
        "identification.filled",
        lambda text, name: put_tests(*joined(bench, robot, text, name)),
    )


def _goal_inputs(bench: Bench, robot: Robot, result: IdentificationResult) -> None:
    first, second, third, fourth, fifth = pieces.split([1.5, 1.1, 1, 1, 1], "goal", gap="small")
    with first:
        field(bench, "goal", inputs.LISTED)
    if bench.goal == "joint":
        joints = {j: f"Joint {j}" for j in robot.joint_numbers}
        now = _joint(bench, robot, result)
        with second:
            inputs.choice("Joint", "identification.goal_joint", joints, now, decided("goal_joint"), inputs.LISTED)
    with third:
        field(bench, "count")
    with fourth:
        field(bench, "load")
    with fifth:
        field(bench, "tilt")
    pieces.note(
        f"Chosen among {format_count(POSES, 'pose')} within the joint limits and "
        f"{format_si(MARGIN, 'mm', 0)} of the measured ones, each pushed along X, Y or Z."
    )


def _joint(bench: Bench, robot: Robot, result: IdentificationResult) -> int:
    if bench.goal_joint in robot.joint_numbers:
        return bench.goal_joint
    return result.weakest_joint if result.has_joints else robot.joint_numbers[0]


def joined(bench: Bench, robot: Robot, text: str, name: str) -> tuple[str, str]:
    """The tests with the rows of a sheet that was filled in, and what they are called then."""
    read_load_tests(text + "\n", robot)  # refused here with row and column of the sheet, before it joins anything
    return append_rows(bench.text, text, LAYOUT, name), f"{bench.name} + {name}"


def plan_of(bench: Bench, robot: Robot, result: IdentificationResult) -> Plan:
    """The tests of the tool to do next. Raises LoadTestError where nothing can be planned."""
    tests = tests_of(bench, robot)
    assert not tests.single
    goal: str | int | Loads = bench.goal
    if goal == "joint":
        goal = _joint(bench, robot, result)
    elif goal == "path":
        cut = cut_of(robot)
        goal = Loads(cut.theta[cut.judged], cut.F[cut.judged])
    setup = session.project().setup.digest()
    key = ("plan", id(result), bench.goal, bench.goal_joint, setup, bench.count, bench.load, bench.tilt)

    def make() -> tuple[IdentificationResult, Plan]:
        found = candidates_around(robot, tests, tilt=bench.tilt, load=bench.load)
        # The fit is kept beside the plan so that its identity stays its own.
        return result, next_best(robot, tests, result, found, count=bench.count, goal=goal)

    return remembered(key, make, "Choosing the tests")[1]


def plan_columns(robot: Robot, plan: Plan, unit: str) -> dict[str, Any]:
    """The plan as columns: pose in the world, load, and joint angles."""
    columns: dict[str, Any] = {"test": np.arange(1, len(plan.F) + 1)}
    for i, name in enumerate("XYZ"):
        columns[f"{name}, {unit_label(unit)}"] = np.round(from_si(plan.x_M[:, i], unit), 2)
    for i, name in enumerate("AB"):
        columns[f"{name}, °"] = np.round(from_si(plan.x_M[:, 3 + i], "deg"), 2)
    columns["push"] = [_direction(F) for F in plan.F]
    columns["N"] = np.round(np.linalg.norm(plan.F, axis=1), 1)
    return columns | theta_columns(robot, plan.theta)


def theta_columns(robot: Robot, theta: FloatArray) -> dict[str, FloatArray]:
    """Joint coordinates (m, n) as columns under each joint's number, in its own unit."""
    joints = zip(robot.joint_numbers, robot.joint_units, theta.T, strict=True)
    return {f"θ{number}, {unit_label(unit)}": np.round(from_si(values, unit), 2) for number, unit, values in joints}


def _direction(F: FloatArray) -> str:
    i = int(np.argmax(np.abs(F)))
    return signed(float(F[i]), "XYZ"[i])
