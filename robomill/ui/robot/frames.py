"""Where the robot stands in its base frame, and where the tool stands on its last axis."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.kinematics.spin import LEAST_DEVIATION, LEAST_MOTION
from robomill.kinematics.transforms import rotation_from_turns, transform, turns_from_rotation
from robomill.provenance import Provenance
from robomill.quantities import Quantity
from robomill.robot.model import TOOL_TIP, Robot
from robomill.robot.tool_frame import TOOL_AXES, tool_axis, with_tool_axis
from robomill.simulation.given import SPIN
from robomill.ui import pieces, session
from robomill.ui.entry import declared, inputs
from robomill.ui.project import Project
from robomill.ui.work import cached
from robomill.units import MINUS, format_many, format_si

GIVEN = "given"
CHOSEN = Provenance("user", "direction of the tool chosen in the app")
TURNS = Quantity("Turn", "deg", "array", shape=(3,), axes=tuple("ABC"), digits=3)
BASE = replace(TOOL_TIP, label="Base")


def frames(project: Project) -> None:
    """The tool frame with its rotation, the base frame, and the free turn of an arm with six axes."""
    robot = project.setup.robot
    st.markdown("**Tool tip**, seen from the last axis and along its axes")
    declared.draw(TOOL_TIP, "robot.tip", robot.T_tool[:3, 3], _put("T_tool", "robot.tip", point=True))
    k = tool_axis(robot)
    names = {axis: axis.replace("-", MINUS) for axis in TOOL_AXES}
    inputs.choice(
        "From the tip to the spindle, along the last axis's own",
        "robot.tool_axis",
        names if k in names else {k: "as turned below", **names},
        k,
        lambda axis: session.change(robot=with_tool_axis(session.project().setup.robot, axis, CHOSEN)),
        inputs.LISTED,
    )
    _turns("Tool", robot.T_tool, "robot.tool_turn", _put("T_tool", "robot.tool_turn", point=False))
    pieces.note("A about x, then B about the new y, then C about the new z.")
    said(robot, "tool")
    st.markdown("**First axis**, seen from the robot frame")
    declared.draw(BASE, "robot.base", robot.T_base[:3, 3], _put("T_base", "robot.base", point=True))
    _turns("Base", robot.T_base, "robot.base_turn", _put("T_base", "robot.base_turn", point=False))
    said(robot, "base")
    if robot.n >= 6:
        _spin(project)


def _turns(name: str, T: FloatArray, key: str, write: Callable[[FloatArray], None]) -> None:
    shown = np.round(turns_from_rotation(T[:3, :3]), 12) + 0.0  # without the last bits, which would read -0.000
    typed = session.kept(f"{key}.typed")  # at B = 90 degrees many turns are one rotation: what was typed is shown
    if typed is not None and np.allclose(rotation_from_turns(typed), T[:3, :3], rtol=0.0, atol=1e-12):
        shown = np.array(typed)
    declared.draw(replace(TURNS, label=name), key, shown, write)


def _put(name: str, label: str, *, point: bool) -> Callable[[FloatArray], None]:
    """What puts a point (m) or three turns (rad) into one of the robot's frames."""

    def write(new: FloatArray) -> None:
        robot = session.project().setup.robot
        T = getattr(robot, name)
        made = transform(T[:3, :3], new) if point else transform(rotation_from_turns(new), T[:3, 3])
        if not point:
            session.keep(f"{label}.typed", tuple(new))
        session.change(label=label, robot=robot.replace(**{name: made}))

    return write


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


def said(robot: Robot, block: str) -> None:
    """Where a block of the robot's numbers comes from."""
    found = robot.provenance.get(block)
    if found is not None:
        pieces.note(pieces.sourced(found))
