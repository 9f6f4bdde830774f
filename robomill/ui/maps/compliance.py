"""The compliance page's tiles, its left column, what-if factors and what stiffness buys."""

from dataclasses import dataclass
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
from robomill.units import format_many, format_si, format_significant, from_si, unit_label
from robomill.viz.shares import gain_bars
from robomill.workspace.fields import ComplianceMap

UM = "um/N"


@dataclass(frozen=True, eq=False)
class Saved:
    """What each joint ``STIFFER`` times as stiff alone saves, gain (n,) in SI of ``unit``, of ``before``.

    ``of_cut``: of the largest deviation of the project's cut; else of the component at the selected point.
    """

    before: float
    gain: FloatArray
    unit: str
    of_cut: bool

    @property
    def best(self) -> int:
        """Index of the joint that saves most."""
        return int(np.argmax(self.gain))


def saved_by(found: InHand, result: SimulationResult | None, view: MapView) -> Saved | None:
    """Which joint to stiffen for this cut; for the selected point where the cut has no result; None where that is not
    reached either."""
    robot = found.pose.robot
    along = _along_path(result, view, robot)
    if along is not None:
        largest = float(along.before.max())
        left = (along.before[:, None] - along.gain).max(axis=0)
        return Saved(largest, largest - left, "um", True)
    if not found.pose.reached:
        return None
    at_point = compliance_sensitivity(found.pose.C_joint, view.component, joint_numbers=robot.joint_numbers)
    return Saved(float(at_point.before), np.asarray(at_point.gain), UM, False)


def tiles(
    found: InHand,
    old: PoseReport,
    now: ComplianceMap,
    before: ComplianceMap,
    saved: Saved | None,
    view: MapView,
) -> list[pieces.Tile]:
    """The component at the point, the largest compliance there and in the region, the joint to stiffen."""
    component, pose, unit = view.component, found.pose, session.project().view.length
    soft = now.values("C_soft")
    worst = np.unravel_index(int(np.nanargmax(soft)), soft.shape) if now.reached.any() else None
    where = tuple(float(axis[i]) for axis, i in zip((now.grid.x, now.grid.y, now.grid.z), worst)) if worst else None
    values, axes = pose.principal if pose.reached else (np.zeros(3), np.zeros((3, 3)))
    way = axes[:, -1] * (-1.0 if axes[np.abs(axes[:, -1]).argmax(), -1] < 0 else 1.0)
    return [
        pieces.Tile(
            f"C_{component} at the selected point",
            _um(pose.component(component)) if pose.reached else "not reached",
            f"at {place(found.point, unit)}",
            _um(old.component(component)) if old.reached else "",
            kind="computed",
        ),
        pieces.Tile(
            "Largest compliance there",
            _um(values[-1]) if pose.reached else "not reached",
            f"in direction ({format_many(way, '1', 2, with_unit=False)})" if pose.reached else "",
            _um(old.principal[0][-1]) if old.reached else "",
        ),
        pieces.Tile(
            "Largest in the region",
            _um(float(soft[worst])) if worst else "not reached",
            f"at {place(where, unit)}" if where else "",  # type: ignore[arg-type]
            _um(float(np.nanmax(before.values("C_soft")))) if before.reached.any() else "",
        ),
        _best(saved, pose.robot.joint_numbers, component),
    ]


def _best(saved: Saved | None, joints: tuple[int, ...], component: str) -> pieces.Tile:
    label = "Best joint to stiffen"
    if saved is None:
        return pieces.Tile(label, "–", "neither the cut nor the point is reached")
    if not saved.gain[saved.best] > 0:
        return pieces.Tile(label, "none", "no joint alone makes it smaller")
    of = "of this cut" if saved.of_cut else f"of C_{component} at the point"
    return pieces.Tile(label, f"joint {joints[saved.best]}", f"10 % stiffer saves {_in_words(saved, saved.best)} {of}")


def _in_words(saved: Saved, joint: int) -> str:
    unit = session.project().view.of(saved.unit)
    return f"{format_significant(from_si(float(saved.gain[joint]), unit), 3)} {unit_label(unit)}"


def _um(value: float) -> str:
    return format_si(value, session.project().view.of(UM), 3)


def controls(robot: Robot, view: MapView, found: InHand) -> None:
    """Region, tilt, plane; component; point; scale."""
    plane.controls(robot, view)
    declared.seen("maps.component", inputs.LISTED)
    st.markdown("**Selected point**")
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


def best_joint(found: InHand, saved: Saved | None, view: MapView) -> None:
    """The joints from best to least: what each, 10 % stiffer, takes off the largest deviation of this cut."""
    joints = found.pose.robot.joint_numbers
    if saved is None:
        pieces.note("Neither the cut nor the selected point is reached, so no joint can be ranked.")
        return
    unit = session.project().view.of(saved.unit)
    gain = from_si(saved.gain, unit)
    whole = format_si(saved.before, session.project().view.of("mm") if saved.of_cut else unit)
    of = f"the largest deviation of this cut, {whole}" if saved.of_cut else f"C_{view.component} here, {whole}"
    said = ", ".join(f"joint {joints[i]} {_in_words(saved, i)}" for i in np.argsort(-saved.gain, kind="stable"))
    more = "" if saved.of_cut else " The cut of this project has no result to rank by."
    pieces.figure(
        gain_bars(
            f"Each joint 10 % stiffer saves, of {of.replace(f'C_{view.component}', f'C<sub>{view.component}</sub>')}",
            gain,
            unit_label(unit),
            joints,
            dark=shell.dark(),
            height=54 + 19 * len(joints),
        ),
        "gains",
        table=lambda: {"joint": list(map(str, joints)), f"saved_{unit}": gain},
        alt=f"What each joint 10 % stiffer saves of {of}: {said}.",
        caption="Exact where the force stays: the displacement is linear in each joint's compliance, eq. (13)." + more,
    )


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
