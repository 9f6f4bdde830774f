"""What to do with a fit: which poses to measure next, and what it means for the project's cut."""

from __future__ import annotations

from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.errors import RobomillError
from robomill.identification.load_test import JointTests
from robomill.identification.plan import PathLoad, Plan, box_candidates, next_best
from robomill.identification.result import IdentificationResult
from robomill.improve.uncertainty import quantile
from robomill.io.load_test_sheets import load_tests_to_csv
from robomill.io.load_tests import read_load_tests
from robomill.robot.model import Robot
from robomill.simulation.result import SimulationResult
from robomill.ui import cache, inputs, parts, state, uncertainty
from robomill.ui.identification_panel import adopted, field, upload
from robomill.ui.load_bench import Bench, appended, tests_of
from robomill.units import format_si, from_si, unit_label
from robomill.viz.bands import band_figure
from robomill.viz.identification import gain_figure

GOALS = {"joint": "One joint", "all": "All of them", "path": "The project's cut"}
MARGIN = 0.15  # m: how far beyond the measured tips poses are looked for


def measure_next(kept: Bench, robot: Robot, result: IdentificationResult, unit: str, dark: bool) -> None:
    """Goal, box and load; the poses to measure, as a table and a sheet; intervals before and after."""
    if isinstance(tests_of(kept, robot), JointTests):
        st.info("One joint at a time needs no plan: load the joint known least once more.", icon=":material/info:")
        return
    _goal_inputs(kept, robot, result)
    try:
        plan = plan_of(kept, robot, result)
    except RobomillError as exc:
        parts.error(exc)
        return
    st.markdown(f"**{plan.sentence()}**")
    with st.container(border=True):
        names = [p.label.capitalize() for p in plan.labels]
        live = [k for k, p in enumerate(plan.labels) if p.label not in result.lumped and result.parameters[k] > 0]
        with np.errstate(invalid="ignore", divide="ignore"):
            before, after = (100.0 * h / np.abs(result.parameters) for h in (plan.half_before, plan.half_after))
        parts.figure(
            gain_figure([names[k] for k in live], before[live], after[live], dark=dark), "ident-gain",
            name="plan-intervals", table=lambda: {"parameter": names, "half_now_%": before, "half_after_%": after},
            caption="As the noise of these tests says; the new readings decide.",
            alt="Half widths of the 95 % intervals now and after the planned tests.",
        )  # fmt: skip
    columns = plan_columns(plan, unit)
    st.dataframe(columns, hide_index=True)
    with st.container(horizontal=True, vertical_alignment="center", gap="small"):
        parts.download(
            "Measuring sheet (CSV)", lambda: measuring_sheet(plan, kept.name), "measuring-sheet.csv", "text/csv",
            key="ident:sheet",
        )  # fmt: skip
        parts.note("Fill in dx, dy, dz and bring the sheet back here: its rows join the tests.")
    upload(
        "Filled-in sheet (CSV)", "ident:filled", lambda text, name: _take_sheet(kept, robot, text, name), kept.revision
    )  # fmt: skip


def _goal_inputs(kept: Bench, robot: Robot, result: IdentificationResult) -> None:
    def take(name: str) -> Any:
        def put(value: Any) -> None:
            setattr(kept, name, value)

        return put

    first, second, third, fourth, fifth = parts.split([1.5, 1.1, 1, 1, 1], "goal", gap="small")
    with first:
        inputs.choice("Make more certain", "ident:goal", GOALS, kept.goal, take("goal"), horizontal=False)
    if kept.goal == "joint":
        joints = {j: f"Joint {j}" for j in robot.joint_numbers}
        now = _joint(kept, robot, result)
        with second:
            inputs.choice("Joint", "ident:goal_joint", joints, now, take("goal_joint"), horizontal=False)
    with third:
        field("More tests", kept, "count", "1", 1, 30, 1, 0)
    with fourth:
        field("Load", kept, "load", "N", 1, 5000, 50, 0)
    with fifth:
        field("Tilt up to", kept, "tilt", "deg", 0, 90, 5, 0)
    parts.note(
        "Chosen among 300 poses within the joint limits and "
        f"{from_si(MARGIN, 'mm'):.0f} mm of the measured ones, each pushed along X, Y or Z."
    )


def _joint(kept: Bench, robot: Robot, result: IdentificationResult) -> int:
    if kept.goal_joint in robot.joint_numbers:
        return kept.goal_joint
    return result.weakest_joint if result.model != "constant" else robot.joint_numbers[0]


def _take_sheet(kept: Bench, robot: Robot, text: str, name: str) -> None:
    read_load_tests(text + "\n", robot)  # refused here with row and column of the sheet, before it joins anything
    kept.take(appended(kept.text, text), f"{kept.name} + {name}")


def plan_of(kept: Bench, robot: Robot, result: IdentificationResult) -> Plan:
    """The tests of the tool to do next. Raises LoadTestError where nothing can be planned."""
    tests = tests_of(kept, robot)
    assert not isinstance(tests, JointTests)
    goal: Any = kept.goal if kept.goal == "all" else _joint(kept, robot, result)
    if kept.goal == "path":
        cut = cut_of(robot)
        goal = PathLoad(cut.theta[cut.judged], cut.F[cut.judged])
    key = ("plan", id(result), kept.goal, goal if isinstance(goal, int) else state.project().setup.digest(),
           kept.count, kept.load, kept.tilt)  # fmt: skip

    def make() -> tuple[IdentificationResult, Plan]:
        tips = tests.tool_poses(robot)[:, :3, 3]
        found = box_candidates(
            robot, tips.min(axis=0) - MARGIN, tips.max(axis=0) + MARGIN, tilt=kept.tilt, load=kept.load
        )
        # The fit is kept beside the plan so that its identity stays its own.
        return result, next_best(robot, tests, result, found, count=int(kept.count), goal=goal)

    return kept.remembered(key, make)[1]


def plan_columns(plan: Plan, unit: str) -> dict[str, Any]:
    """The plan as columns: pose in the world, load, and joint angles."""
    columns: dict[str, Any] = {"test": np.arange(1, len(plan.F) + 1)}
    for i, name in enumerate("XYZ"):
        columns[f"{name}, {unit_label(unit)}"] = np.round(from_si(plan.x_M[:, i], unit), 2)
    for i, name in enumerate("AB"):
        columns[f"{name}, °"] = np.round(from_si(plan.x_M[:, 3 + i], "deg"), 2)
    columns["push"] = [_direction(F) for F in plan.F]
    columns["N"] = np.round(np.linalg.norm(plan.F, axis=1), 1)
    for i in range(plan.theta.shape[1]):
        columns[f"θ{i + 1}, °"] = np.round(from_si(plan.theta[:, i], "deg"), 2)
    return columns


def _direction(F: FloatArray) -> str:
    i = int(np.argmax(np.abs(F)))
    return f"{'+' if F[i] > 0 else '−'}{'XYZ'[i]}"


def measuring_sheet(plan: Plan, name: str) -> str:
    """The plan as a CSV with empty displacement columns, in the form that is read back."""
    remarks = f"Measuring sheet of robomill: tests to make {plan.goal} more certain, after {name}.\n"
    remarks += "Displacements are differences between loaded and preloaded reading, in {M}; fill in dx, dy, dz."
    return load_tests_to_csv(plan.as_tests(), remarks, blank=True)


# ---- in the cut ----------------------------------------------------------------------------------------------------
def cut_of(robot: Robot) -> SimulationResult:
    """The project's cut by ``robot``. Raises the refusal of the simulation."""
    setup = state.project().setup
    return cache.result(setup if setup.robot == robot else setup.replace(robot=robot))


def cut_tile(kept: Bench, robot: Robot, result: IdentificationResult, unit: str) -> tuple[str, str]:
    """Value and note of the tile on the cut: its worst deviation by the compliances found, with its band."""
    if result.model == "constant":
        return "no joints", "choose a model with joint springs"
    try:
        found, known = predicted(kept, robot, result)
    except RobomillError:
        return "not computed", "see In the cut"
    if found.worst < 0:
        return "out of reach", "no point of the cut is reached"
    half = float(uncertainty.size_band(found, uncertainty.deviation_band(found, known, found.worst), found.worst))
    now = cut_of(robot).max_deviation
    if not np.isfinite(half):
        return "not known", "no residuals to judge the noise by"
    digits = uncertainty.band_digits(half, unit)
    text = uncertainty.band_text(found.max_deviation, half, unit)
    if uncertainty.fingerprint(found.setup) == uncertainty.fingerprint(state.project().setup):
        return text, "95 % band; in force in the project"
    return text, f"by these compliances; the project has {format_si(now, unit, digits)}"


def predicted(
    kept: Bench, robot: Robot, result: IdentificationResult
) -> tuple[SimulationResult, uncertainty.Knowledge]:
    """The project's cut with the compliances found, and how unsure they, force and lengths are."""
    found = cache.result(adopted(state.project().setup, robot, result, kept.name))
    known = uncertainty.knowledge(result, robot, f"from {len(result.row)} load tests")
    return found, uncertainty.widened(known, robot, kept.force_unsure, kept.length_unsure)


def in_the_cut(kept: Bench, robot: Robot, result: IdentificationResult, unit: str, dark: bool) -> None:
    """The deviation along the project's path with its band, and what the band is made of."""
    if result.model == "constant":
        parts.note("One constant matrix has no joint compliances; choose a model with joint springs.")
        return
    first, second, third = parts.split([1.5, 1, 1], "cut", gap="small")
    with first:
        axis = _component()
    with second:
        field("Force known to ±", kept, "force_unsure", "N", 0, 1000, 5, 0)
    with third:
        field("Link lengths to ±", kept, "length_unsure", "mm", 0, 50, 0.5, 2)
    try:
        found, known = predicted(kept, robot, result)
        now = cut_of(robot)
    except RobomillError as exc:
        parts.error(exc)
        return
    st.markdown(f"**{uncertainty.sentence(found, known, unit)}**")
    s, value, half, before = (from_si(v, unit) for v in _curves(found, now, known, axis))
    with st.container(border=True):
        parts.figure(
            band_figure(s, value, half, before, axis, unit, dark=dark), "ident-band", name="deviation-band",
            table=lambda: band_columns(found, known),
            caption="Shaded: 95 % band by linear propagation. Dashed: the compliances of the project now.",
            alt="Deviation along the path with its 95 % band.",
        )  # fmt: skip
    parts.note("Force: each component, link lengths: each a and d; one standard deviation, zero is taken as exact.")


def _component() -> str:
    options = {"": "Size", "x": "X", "y": "Y", "z": "Z"}
    current = st.session_state.get("identification:component", "")

    def take(name: str) -> None:
        st.session_state["identification:component"] = name

    inputs.choice("Deviation", "ident:component", options, current, take)
    return str(st.session_state.get("identification:component", current))


def _curves(
    found: SimulationResult, now: SimulationResult, known: uncertainty.Knowledge, axis: str
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Length cut, value, half width and the project's value now (m,), all m, where the tool cuts."""
    band = uncertainty.deviation_band(found, known)
    cutting = found.judged
    if axis:
        i = "xyz".index(axis)
        value, half, before = found.delta[:, i], band.half_width(uncertainty.LEVEL)[:, i], now.delta[:, i]
    else:
        value, half, before = found.deviation, uncertainty.size_band(found, band), now.deviation
    blank = np.where(cutting, 1.0, np.nan)
    return found.path.s, value * blank, half * blank, before * blank


def band_columns(found: SimulationResult, known: uncertainty.Knowledge) -> dict[str, Any]:
    """Along the path: station, deviation and the standard deviation by source, mm."""
    band = uncertainty.deviation_band(found, known)
    columns: dict[str, Any] = {"line": found.path.block, "station_mm": from_si(found.path.s, "mm")}
    for i, axis in enumerate("xyz"):
        columns[f"delta_{axis}_mm"] = from_si(found.delta[:, i], "mm")
        columns[f"half95_{axis}_mm"] = from_si(quantile(uncertainty.LEVEL, band.dof) * band.std[:, i], "mm")
    for name in ("compliance", "force", "lengths"):
        spread = np.linalg.norm(getattr(band, f"by_{name}"), axis=1)
        columns[f"std_by_{name}_mm"] = from_si(spread, "mm")
    return columns
