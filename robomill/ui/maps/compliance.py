"""The compliance page's tiles, its left column, what-if factors and what stiffness buys."""

from functools import partial

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.compliance.at_pose import PoseReport
from robomill.errors import RobomillError
from robomill.improve.sensitivity import (
    Sensitivity,
    compliance_sensitivity,
    deflection_sensitivity,
    scaled_shares,
    stiffened,
)
from robomill.quantities import quantities
from robomill.robot.model import Robot
from robomill.simulation.result import SimulationResult
from robomill.ui import cached, declared, inputs, pieces, running, session, shell
from robomill.ui.maps import plane
from robomill.ui.maps.point import place
from robomill.ui.point import InHand
from robomill.ui.project import MapView, Project
from robomill.units import format_si, from_si, unit_label
from robomill.viz.shares import gain_bars
from robomill.workspace.fields import ComplianceField

UM = "um/N"


def tiles(
    found: InHand, old: PoseReport, now: ComplianceField, before: ComplianceField, view: MapView, unit: str
) -> list[pieces.Tile]:
    """The component at the point, the softest direction there, the softest place, where stiffness pays."""
    component, pose = view.component, found.pose
    point = place(found.point, unit)
    gain = compliance_sensitivity(now.C_joint(), component, joint_numbers=pose.robot.joint_numbers)
    best = int(gain.ranking[0])
    known = bool(now.reached.any())
    saved = float(gain.mean[best])
    soft = now.values("C_soft")
    worst = np.unravel_index(int(np.nanargmax(soft)), soft.shape) if known else None
    where = tuple(float(axis[i]) for axis, i in zip((now.grid.x, now.grid.y, now.grid.z), worst)) if worst else None
    return [
        pieces.Tile(
            f"C_{component} at the point",
            _um(pose.component(component)) if pose.reached else "not reached",
            f"at {point}",
            _um(old.component(component)) if old.reached else "",
            kind="computed",
        ),
        pieces.Tile(
            "Softest direction there",
            _um(pose.principal[0][-1]) if pose.reached else "not reached",
            "what 1 N moves the tip at most",
            _um(old.principal[0][-1]) if old.reached else "",
        ),
        pieces.Tile(
            "Softest place of the region",
            _um(float(soft[worst])) if worst else "not reached",
            f"at {place(where, unit)}" if where else "",  # type: ignore[arg-type]
            _um(float(np.nanmax(before.values("C_soft")))) if known else "",
        ),
        pieces.Tile(
            "Stiffness pays most in",
            f"joint {pose.robot.joint_numbers[best]}" if known else "nothing reached",
            f"10 % stiffer: |C_{component}| less {_um(saved)} over the region" if known else "",
        ),
    ]


def _um(value: float) -> str:
    return format_si(value, UM, 3)


def controls(robot: Robot, view: MapView, found: InHand) -> None:
    """Region, tilt, plane; component; point; scale."""
    plane.controls(robot, view)
    declared.seen("maps.component", inputs.LISTED)
    st.markdown("**The point in hand**")
    declared.draw(quantities(MapView)["point"], "maps.point", found.point, lambda point: session.see(point=point))
    declared.seen("maps.common")


def what_if(robot: Robot, view: MapView) -> None:
    """A factor on each joint's stiffness; the old result stays as ghost until they are 1 or put into the robot."""
    scale = view.stiffening(robot)
    changed = bool((scale != 1.0).any())
    with st.container(horizontal=True, vertical_alignment="center", horizontal_alignment="distribute"):
        st.markdown("**What if a joint were stiffer?**")
        reset = partial(session.see, factors=None)
        inputs.button("All × 1", "maps.reset", "restart_alt", reset, type="tertiary", disabled=not changed)
    for i, number in enumerate(robot.joint_numbers):
        name, slider = st.columns([0.52, 1], vertical_alignment="center")
        name.markdown(f"Joint {number} **× {scale[i]:.2f}**")
        with slider:
            inputs.slider(
                f"Joint {number}, times its stiffness",
                f"maps.factor.{i}",
                inputs.Span(0.5, 4.0, 0.05, "%.2f"),
                float(scale[i]),
                partial(_factor, robot, i),
                inputs.HIDDEN,
            )
    how = {"disabled": not changed, "width": "stretch", "help": "The milling result follows; undo leads back."}
    inputs.button("Put these joints into the robot", "maps.adopt", "check", _adopt, robot, **how)


def _factor(robot: Robot, i: int, value: float) -> None:
    scale = session.maps().stiffening(robot)
    scale[i] = value
    session.see(factors=None if (scale == 1.0).all() else scale)


def _adopt(robot: Robot) -> None:
    session.change(robot=stiffened(robot, session.maps().stiffening(robot)))
    session.see(factors=None)


def where_it_pays(
    found: InHand, now: ComplianceField, result: SimulationResult | None, view: MapView, unit: str
) -> None:
    """What 10 % more stiffness in one joint takes off: at the point, along the path of the project, over the region."""
    robot = found.pose.robot
    joints = robot.joint_numbers
    groups: list[tuple[str, FloatArray, str]] = []
    if found.pose.reached:
        at_point = compliance_sensitivity(found.pose.C_joint, view.component, joint_numbers=joints)
        groups.append((f"|C<sub>{view.component}</sub>|<br>at the point", from_si(at_point.gain, UM), unit_label(UM)))
    along = _along_path(result, view, robot)
    micro = "um"
    if along is not None:
        groups.append(("deviation<br>on the path", from_si(along.mean, micro), f"{unit_label(micro)}, mean"))
    if now.reached.any():
        over = compliance_sensitivity(now.C_joint(), view.component, joint_numbers=joints)
        groups.append(
            (f"|C<sub>{view.component}</sub>|<br>in region", from_si(over.mean, UM), f"{unit_label(UM)}, mean")
        )
    if not groups:
        pieces.note("Nothing is reached here, so nothing can be ranked.")
        return
    with st.container(border=True):
        pieces.figure(
            gain_bars(groups, joints, dark=shell.dark(), height=104 + 34 * len(joints)),
            "gains",
            table=lambda: {"joint": list(map(str, joints)), **{f"{_plain(t)}, {u}": g for t, g, u in groups}},
            alt="How much smaller compliance and deviation become with each joint 10 % stiffer.",
            caption="What each joint 10 % stiffer takes off. Exact: C is linear in the joints' compliances, eq. (13)."
            + ("" if along is not None else " The path of this project has no result to rank by."),
        )


def _plain(title: str) -> str:
    return title.replace("<sub>", "_").replace("</sub>", "").replace("<br>", " ")


def _along_path(result: SimulationResult | None, view: MapView, robot: Robot) -> Sensitivity | None:
    if result is None or result.setup.robot.n != robot.n:
        return None
    judged = result.judged
    if not judged.any():
        return None
    delta_joint = scaled_shares(result.delta_joint[judged], view.stiffening(robot), -2)
    if not np.isfinite(delta_joint).all():
        return None
    return deflection_sensitivity(delta_joint, joint_numbers=robot.joint_numbers)


def quiet_result(project: Project) -> SimulationResult | None:
    """The milling result of the project, or None where it is refused or long: this page works without one."""
    try:
        if pieces.underway(running.path_of, project.setup) is None:
            return None
        return cached.result(project.setup) if running.there(project.setup) else None
    except RobomillError:
        return None
