"""The compliance page's tiles, its left column, what-if factors and what stiffness buys."""

from dataclasses import dataclass
from functools import partial

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.compliance.at_pose import PoseReport
from robomill.improve.sensitivity import gain, stiffened
from robomill.quantities import quantities
from robomill.robot.model import Robot
from robomill.ui import pieces, session, shell
from robomill.ui.entry import declared, inputs
from robomill.ui.maps import plane
from robomill.ui.posed import fields, push
from robomill.ui.posed.point import InHand, place
from robomill.ui.posed.push import Decided, Moved, Push
from robomill.ui.project import MapView, Project
from robomill.ui.work import running
from robomill.units import UNITS, format_many, format_number, format_si, from_si, unit_label
from robomill.viz.shares import gain_bars
from robomill.workspace.fields import ComplianceMap

UM = "um/N"


@dataclass(frozen=True, eq=False)
class Saved:
    """What each joint ``STIFFER`` times as stiff alone saves, gain (n,) m, of a displacement of ``before`` m: that at
    ``line`` of the cut, or at the selected point (0)."""

    before: float
    gain: FloatArray
    line: int

    @property
    def best(self) -> int:
        """Index of the joint that saves most."""
        return int(np.argmax(self.gain))

    @property
    def where(self) -> str:
        """Of what it saves."""
        return f"of this cut at line {self.line}" if self.line else "at the selected point"


def saved_by(moved: Moved, line: int) -> Saved | None:
    """Which joint to stiffen for what a push does; None where the tip does not get there."""
    if not np.isfinite(moved.delta).all():
        return None
    beside = moved.delta - moved.delta_joint.sum(axis=0)  # what springs give, which no joint takes away
    return Saved(moved.size, gain(np.vstack([moved.delta_joint, beside]))[:-1], line)


@dataclass(frozen=True, eq=False)
class Looked:
    """What the page looks at: the view of the maps, the region coarsely ``known``, the point in hand ``here``, whether
    that is where the ``cut`` is decided, and what pushes there."""

    view: MapView
    known: ComplianceMap
    here: InHand
    at_cut: bool
    cut: Decided | None
    pushed: Push

    @property
    def factors(self) -> FloatArray:
        """(n,) how much stiffer each joint is looked at."""
        return self.view.stiffening(self.known.robot)

    @property
    def found(self) -> InHand:
        """The point in hand with the joints so much stiffer."""
        return self.here.with_robot(stiffened(self.known.robot, self.factors))

    @property
    def moved(self) -> Moved:
        """What the push does there."""
        if self.cut is not None and not self.pushed.axis and self.at_cut:
            return self.cut.moved.stiffer(self.factors)
        return Moved.at(self.found.pose, self.pushed)

    @property
    def saved(self) -> Saved | None:
        """Which joint to stiffen: for the cut where its force pushes, else for what is pushed at the point."""
        if self.cut is not None and not self.pushed.axis:
            return saved_by(self.cut.moved.stiffer(self.factors), self.cut.line)
        return saved_by(self.moved, 0)

    def tiles(self) -> list[pieces.Tile]:
        """The page's."""
        now = fields.stiffer(self.known, self.factors)
        return tiles(self.found, self.here.pose, now, self.known, self.saved, self.view)


def looked(project: Project) -> Looked:
    """What the page looks at in a project. Raises WorkspaceError, and ``Underway``."""
    robot, view = project.setup.robot, session.maps()
    box = fields.region(robot, view)
    known = fields.overview(robot, view, box)
    cut = push.decided(running.quiet(project.setup))
    here, at_cut = push.selected(view, box, known, cut)
    return Looked(view, known, here, at_cut, cut, push.in_force(project.view, cut))


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
        _best(saved, pose.robot.joint_numbers),
    ]


def _best(saved: Saved | None, joints: tuple[int, ...]) -> pieces.Tile:
    label = "Best joint to stiffen"
    if saved is None:
        return pieces.Tile(label, "–", "neither the cut nor the point is reached")
    if not saved.gain[saved.best] > 0:
        return pieces.Tile(label, "none", "no joint alone makes it smaller")
    words = f"10 % stiffer saves {_in_words(saved, saved.best)} {saved.where}"
    return pieces.Tile(label, f"joint {joints[saved.best]}", words)


def _in_words(saved: Saved, joint: int) -> str:
    return format_si(float(saved.gain[joint]), session.project().view.length)


def _um(value: float) -> str:
    return format_si(value, session.project().view.of(UM), 3)


def controls(robot: Robot, view: MapView, found: InHand) -> None:
    """Force; region, tilt, plane; component; point; scale."""
    push.choice()
    plane.controls(robot, view)
    declared.seen("maps.component", inputs.LISTED)
    with st.container(key="maps-place"):
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
    with st.container(key="maps-factors"):
        for i, number in enumerate(robot.joint_numbers):
            name, slider = st.columns([0.52, 1], vertical_alignment="center")
            name.markdown(f"Joint {number} **× {format_number(scale[i], 2)}**")
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


def best_joint(joints: tuple[int, ...], saved: Saved | None) -> None:
    """The joints from best to least: what each, 10 % stiffer, takes off the displacement."""
    if saved is None:
        pieces.note("Neither the cut nor the selected point is reached, so no joint can be ranked.")
        return
    unit = session.project().view.length
    shown = from_si(saved.gain, unit)
    of = f"the {format_si(saved.before, unit)} {saved.where}"
    said = ", ".join(f"joint {joints[i]} {_in_words(saved, i)}" for i in np.argsort(-saved.gain, kind="stable"))
    pieces.strong(f"Each joint 10 % stiffer saves, of {of}")
    pieces.figure(
        gain_bars(
            shown,
            unit_label(unit),
            UNITS[unit].digits,
            joints,
            dark=shell.dark(),
            height=54 + 19 * len(joints),
        ),
        "gains",
        table=lambda: {"joint": list(map(str, joints)), f"saved_{unit}": shown},
        alt=f"What each joint 10 % stiffer saves of {of}: {said}.",
        caption="Exact where the force stays: the displacement is linear in each joint's compliance, eq. (13).",
    )
