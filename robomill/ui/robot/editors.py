"""The robot page's inputs: which robot, its compliances, D-H table, limits and tool."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pandas as pd
import streamlit as st

from robomill.arrays import FloatArray
from robomill.io.robots import load_robot, robot_names
from robomill.kinematics.spin import LEAST_DEVIATION, LEAST_MOTION
from robomill.kinematics.transforms import transform
from robomill.robot.model import TOOL_TIP, USER_SET, Robot
from robomill.robot.stiffness import is_stiffness
from robomill.simulation.setup import SPIN
from robomill.ui import cached, declared, grid, inputs, pieces, session
from robomill.ui.project import Project
from robomill.ui.robot import tables
from robomill.units import format_many, format_si, unit_label

MINUS, GIVEN = "−", "given"
SPELLINGS = "7.14, 7,14 and 7.14e-7 (in rad/(N m)) are the same."


def editors(project: Project) -> None:
    """Compliances, geometry, limits and tool, each in its own tab."""
    robot = project.setup.robot
    _which_robot(robot)
    compliance, geometry, limits, tool = st.tabs(["Compliances", "D-H table", "Limits", "Tool"])
    with compliance:
        _compliances(robot, project.view.joint_unit)
    with geometry:
        widths = {tables.HEADINGS[name]: 64 if said.unit == "mm" else 54 for name, said in tables.GEOMETRY.items()}
        sheet = grid.Sheet(tables.LENGTHS.boxes(), {"joint": _joints("#", 34)}, width=widths)
        _table("geometry", sheet, tables.geometry_frame, _with(tables.with_geometry))
        pieces.note(f"{robot.convention.capitalize()} Denavit-Hartenberg; the joint turns by sign · θ + θ₀.")
        _said(robot, "geometry")
        _said(robot, "lengths")
    with limits:
        slides = f" ({tables.LIMIT.sliding} where it slides)" if robot.prismatic.any() else ""
        unit = unit_label(tables.LIMIT.unit) + slides
        heads = {side: f"{side.capitalize()}, {unit}" for side in tables.LIMIT.axes}
        sheet = grid.Sheet(tables.limits(robot).boxes(), {"joint": _joints("Joint")}, heads)
        _table("limits", sheet, tables.limits_frame, _with(tables.with_limits))
        _said(robot, "limits")
    with tool:
        _tool(robot)
        if robot.n >= 6:
            _spin(project)


def _which_robot(robot: Robot) -> None:
    names = {name: _title(name) for name in robot_names()}
    if robot.name not in names:
        names = {robot.name: robot.name, **names}
    inputs.choice("Robot", "robot.name", names, robot.name, _take_robot, inputs.LISTED)


@st.cache_resource(max_entries=64, show_spinner=False)
def _title(name: str) -> str:
    return load_robot(name).title or name.replace("_", " ")


def _take_robot(name: str) -> None:
    session.change(robot=load_robot(name))
    session.look(theta=None)


def _compliances(robot: Robot, unit: str) -> None:
    sets = {name: name.replace("_", " ").capitalize() for name in robot.compliance_sets}
    if robot.compliance_set == USER_SET:
        sets[USER_SET] = "Edited"
    if sets:
        inputs.choice(
            "Set in force",
            "robot.compliance_set",
            sets,
            robot.compliance_set,
            lambda name: (
                None
                if name == USER_SET
                else session.change(robot=session.project().setup.robot.with_compliance_set(name))
            ),
        )
    heading = f"{'Stiffness' if is_stiffness(unit) else 'Compliance'}, {unit_label(unit)}"
    hint = None if is_stiffness(unit) else SPELLINGS
    column = st.column_config.TextColumn(heading, help=hint, alignment="right")
    sheet = grid.Sheet({"value": tables.compliance_boxes(robot, unit)}, {"joint": _joints("Joint"), "value": column})
    _table(f"compliance:{unit}", sheet, tables.compliance_frame, _with(tables.with_compliance))
    if robot.compliance_set == USER_SET:
        pieces.note(pieces.badge("user"), "entered in the app")
    else:
        _said(robot, f"compliance.{robot.compliance_set}")


def _with(change: Callable[[Robot, pd.DataFrame], Robot]) -> Callable[[pd.DataFrame], None]:
    """What puts a table that was edited into the robot."""
    return lambda frame: session.change(robot=change(session.project().setup.robot, frame), from_editor=True)


def _joints(head: str, width: Any = "small") -> Any:
    """The first column, which says the joint."""
    return st.column_config.TextColumn(head, width=width)


def _table(
    name: str, sheet: grid.Sheet, shown: Callable[[Robot], pd.DataFrame], write: Callable[[pd.DataFrame], None]
) -> None:
    """A table with a row a joint, the first column of which says which."""
    own = replace(sheet, where=tables.joint, locked=("joint",))
    grid.table(name, lambda: shown(session.project().setup.robot), write, own)


def _tool(robot: Robot) -> None:
    st.markdown("Tool tip from the last axis, along its own axes")
    declared.draw(TOOL_TIP, "robot.tip", robot.T_tool[:3, 3], _put_tip)
    k = tables.tool_axis(robot)
    names = {axis: axis.replace("-", MINUS) for axis in tables.TOOL_AXES}
    inputs.choice(
        "z_T, from the tip to the spindle, along the last axis's own",
        "robot.tool_axis",
        names if k in names else {k: "as in its file", **names},
        k,
        lambda axis: session.change(robot=tables.with_tool_axis(session.project().setup.robot, axis)),
        inputs.LISTED,
    )
    _said(robot, "tool")


def _put_tip(tip: FloatArray) -> None:
    robot = session.project().setup.robot
    session.change(label="robot.tip", robot=robot.replace(T_tool=transform(robot.T_tool[:3, :3], tip)))


def _spin(project: Project) -> None:
    """The free rotation about the tool axis, and what it does to the deviation of this cut."""
    setup = project.setup
    given = isinstance(setup.spin, float)
    inputs.choice(
        "Spin about the tool axis, along the whole path",
        "robot.spin_rule",
        {LEAST_MOTION: "Least motion", LEAST_DEVIATION: "Least deviation", GIVEN: "As given"},
        GIVEN if given else setup.spin,
        lambda rule: session.change(spin=0.0 if rule == GIVEN else rule),
        inputs.LISTED,
    )
    if given:
        declared.draw(SPIN, "robot.spin", float(setup.spin), lambda angle: session.change(spin=angle))
    asked = "robot.spin_range.of"
    if st.button("How much does the spin matter here?", key="robot.spin_range", icon=":material/360:"):
        session.keep(asked, setup.digest())
    if session.kept(asked) == setup.digest():
        over = pieces.attempt(cached.over_spin, setup)
        if over is None:
            return
        missed = int((over.missed > over.missed[over.best]).sum())
        ends = format_many(over.range, project.view.length, between=" and ")
        best = format_si(float(over.angle[over.best]), "deg", 0)
        pieces.note(
            f"Over all spins the largest deviation of this cut lies between {ends}; least at {best}."
            + (f" {missed} of {len(over.angle)} spins do not reach as much of the path." if missed else "")
        )


def _said(robot: Robot, block: str) -> None:
    found = robot.provenance.get(block)
    if found is not None:
        pieces.note(pieces.sourced(found))
