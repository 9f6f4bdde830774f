"""The lesson's second half: the arm is dragged to the edge of its workspace and the ellipsoid stretches."""

from __future__ import annotations

import html
from dataclasses import dataclass

import numpy as np
import plotly.graph_objects as go
import streamlit as st

from robomill.arrays import FloatArray, digest
from robomill.compliance.at_pose import PoseReport
from robomill.compliance.cartesian import cartesian_compliance
from robomill.compliance.deflection import soft_direction
from robomill.kinematics.decoupled import decoupled
from robomill.kinematics.dexterity import determinant, near_singular
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.result import IKResult
from robomill.kinematics.transforms import pose_from_world
from robomill.robot.model import Robot
from robomill.ui import cached, fields, inputs, pieces, session, shell
from robomill.ui.learn import lesson
from robomill.ui.point import FORCE, InHand, in_hand
from robomill.units import format_si, format_times, format_value, from_si, split_unit, unit_label
from robomill.viz import solids
from robomill.viz.arm import ArmScene, arm_figure
from robomill.viz.ellipsoid import ellipsoid_scale, ellipsoid_traces
from robomill.viz.lesson import ray_figure
from robomill.viz.voxels import widen
from robomill.workspace.quantities import map_quantity

RADII = 121
HALVINGS = 24


@dataclass(frozen=True, eq=False)
class Ray:
    """Poses along a horizontal ray from the base: p (m, 3) m, theta (m, n), det (m,); ``start`` is the lesson's."""

    p: FloatArray
    theta: FloatArray
    det: FloatArray
    start: int

    @property
    def radius(self) -> FloatArray:
        """(m,) m from the base axis."""
        return np.linalg.norm(self.p[:, :2], axis=1)


def ray(found: InHand) -> Ray:
    """The poses from near the base to the edge of the workspace through the lesson's point, from the cache."""
    robot = found.pose.robot
    return _ray(f"{fields.geometry_key(robot)}/{digest(np.array(found.point))}", robot, np.array(found.point))


@st.cache_resource(max_entries=16, show_spinner=False)
def _ray(key: str, _robot: Robot, _point: FloatArray) -> Ray:
    base = np.array([_robot.T_base[0, 3], _robot.T_base[1, 3]])
    across = _point[:2] - base
    size = float(np.linalg.norm(across))
    across = across / size if size > 1e-9 else np.array([0.0, -1.0])
    longest = float(np.abs(_robot.a).sum() + np.abs(_robot.d).sum()) + size
    count = RADII if decoupled(_robot) is not None else 41
    radii = np.union1d(np.linspace(0.02, 1.0, count) * longest, [size])

    def solved(r: FloatArray) -> tuple[FloatArray, IKResult]:
        p = np.column_stack([base + r[:, None] * across, np.full(len(r), _point[2])])
        return p, inverse_kinematics(_robot, pose_from_world(np.column_stack([p, np.zeros((len(p), 2))])))

    reached = solved(radii)[1].reached
    at = int(np.searchsorted(radii, size))
    first, last = at, at
    while first > 0 and reached[first - 1]:
        first -= 1
    while last < len(radii) - 1 and reached[last + 1]:
        last += 1
    # The edges themselves, by halving between the last point in reach and the first one out of it.
    edges = []
    for inside, outside in ((first, first - 1), (last, last + 1)):
        if 0 <= outside < len(radii):
            low, high = radii[inside], radii[outside]
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if bool(solved(np.array([middle]))[1].reached[0]) else (low, middle)
            edges.append(low)
    run = np.union1d(radii[first : last + 1], edges)
    p, found = solved(run)
    return Ray(p, found.theta, determinant(_robot, found.theta), int(np.argmin(np.abs(run - size))))


@st.fragment
def edge(found: InHand) -> None:
    """Drag the arm to the edge of its workspace: the ellipsoid stretches, det(J) beside it."""
    st.html('<p class="rm-ask">Now drag the arm to the edge of its workspace.</p>')
    way = ray(found)
    unit = session.project().view.length
    radius = from_si(way.radius, unit)
    if len(way.p) < 3:
        pieces.note("This pose is the only one in reach on its ray; choose another robot or point.")
        return
    out = lesson.progress().out
    i = way.start if out is None else int(np.abs(way.radius - out).argmin())
    digits = 0 if unit == "mm" else 1
    inputs.stops(
        f"Distance from the base, {unit_label(unit)}",
        f"learn.out.{len(radius)}:{unit}",
        {k: format_value(r, unit, digits, with_unit=False) for k, r in enumerate(radius)},
        i,
        lambda k: lesson.go(out=float(way.radius[k])),
    )
    x, y, z = way.p[i].tolist()
    here = in_hand(found.pose.robot, (x, y, z), 0.0, 0.0)
    left, right = pieces.split([1.35, 1], "edge", gap="large")
    with left, st.container(border=True):
        _stretch(found, here, way)
    with right:
        _measure(here.pose, way, i)


def _stretch(found: InHand, here: InHand, way: Ray) -> None:
    pose = here.pose
    if not pose.reached:
        pieces.note(html.escape(here.reason))
        return
    dark = shell.dark()
    yardstick = solids.yardstick(found.pose.frames)
    # One scale for the whole ray, so that the body is seen to stretch.
    times = ellipsoid_scale(found.pose.C, 0.13 * yardstick)

    def draw() -> go.Figure:
        fig = arm_figure(ArmScene(frames=pose.frames), dark=dark, height=480, revision="learn-edge", zoom=1.1)
        fig.add_traces(ellipsoid_traces(pose.C, pose.T_MT[:3, 3], times, dark=dark, width=0.005 * yardstick))
        low, high = way.p.min(axis=0) - 0.12 * yardstick, way.p.max(axis=0) + 0.12 * yardstick
        widen(fig, low, high, room=2.6)
        return fig.update_layout(scene_camera=lesson.SIDE)

    fig = cached.kept_figure("learn-edge", (pose.robot.digest(), digest(pose.theta), way.start, dark), draw)
    grown = format_times(times / FORCE)
    pieces.figure(
        fig,
        "learn-edge",
        alt="The arm with its compliance ellipsoid at the chosen distance.",
        caption=f"Where 100 N in every direction take the tip, shown {grown}; the same scale at every distance.",
    )


def _measure(pose: PoseReport, way: Ray, i: int) -> None:
    what = map_quantity(pose.robot, "det_J")
    det = float(way.det[i])
    softest_here = pose.principal[0][-1]
    number, label = split_unit(format_si(det, what.unit, 3))
    near = "A singularity: one direction is lost." if near_singular(pose.robot, det) else "Far from a singularity."
    st.html(
        f'<p class="rm-note">det(J)</p><div class="rm-det">{number} <small>{label}</small></div>'
        f'<p class="rm-note">{near}</p>'
        f'<p class="rm-note">softest direction</p><div class="rm-det">{format_si(softest_here, "um/N", 2)}</div>'
    )
    unit = session.project().view.length
    softest = soft_direction(cartesian_compliance(pose.robot, way.theta))[0][:, -1]
    fig = ray_figure(
        from_si(way.radius, unit),
        i,
        (f"distance from the base, {unit_label(unit)}", what.label, f"softest, {unit_label('um/N')}"),
        (from_si(way.det, what.unit), from_si(softest, "um/N")),
        dark=shell.dark(),
    )
    pieces.figure(
        fig,
        "learn-ray",
        alt="det(J) and the largest compliance against the distance from the base.",
        table=lambda: {
            f"distance_{unit}": from_si(way.radius, unit),
            "det_J": from_si(way.det, what.unit),
            "softest_um/N": from_si(softest, "um/N"),
        },
    )
