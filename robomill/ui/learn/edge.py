"""The lesson's second half: the arm is dragged to the edge of its workspace, the ellipsoid stretches, and the equations
follow."""

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.compliance.at_pose import PoseReport
from robomill.compliance.cartesian import cartesian_compliance
from robomill.compliance.deflection import soft_direction
from robomill.kinematics.dexterity import near_singular
from robomill.learn.push import FORCE, AsidePush
from robomill.ui import pieces, session, shell
from robomill.ui.entry import inputs
from robomill.ui.learn import lesson, mathematics
from robomill.ui.posed import fields
from robomill.ui.posed.arm import arm
from robomill.ui.posed.point import InHand, in_hand
from robomill.ui.work.cached import shared
from robomill.units import format_si, format_times, format_value, from_si, split_unit, unit_label
from robomill.viz import solids
from robomill.viz.arm import ArmScene
from robomill.viz.chart import Chart
from robomill.viz.ellipsoid import ellipsoid_scale, ellipsoid_traces
from robomill.viz.lesson import ray_figure
from robomill.viz.voxels import widen
from robomill.workspace.quantities import map_quantity
from robomill.workspace.ray import Ray, ray_through

_ray = shared(lambda robot, point: (fields.geometry_key(robot), point), "Moving out to the edge")(ray_through)


@st.fragment
def edge(found: InHand) -> None:
    """Drag the arm to the edge of its workspace: the ellipsoid stretches, det(J) beside it, the mathematics beneath."""
    st.html('<p class="rm-ask">Now drag the arm to the edge of its workspace.</p>')
    robot = found.pose.robot
    way = pieces.attempt(_ray, robot, found.point)
    if way is None:
        return
    unit = session.project().view.length
    radius = from_si(way.radius, unit)
    if len(way.p) < 3:
        pieces.note("This pose is the only one in reach on its ray; choose another robot or point.")
        return
    out = lesson.progress().out
    i = way.start if out is None else int(np.abs(way.radius - out).argmin())
    inputs.stops(
        f"Distance from the base, {unit_label(unit)}",
        f"learn.out.{len(radius)}:{unit}",
        {k: format_value(r, unit, 0, with_unit=False) for k, r in enumerate(radius)},
        i,
        lambda k: lesson.go(out=float(way.radius[k])),
    )
    x, y, z = way.p[i].tolist()
    here = in_hand(robot, (x, y, z), 0.0, 0.0)
    left, right = pieces.split([1.35, 1], "edge", gap="large")
    with left, st.container(border=True):
        _stretch(found, here, way)
    with right:
        _measure(here.pose, way, i)
    if here.pose.reached:
        st.divider()
        mathematics.equations(here.pose, AsidePush.of(found.pose.C), format_si(float(way.radius[i]), unit, 0))


def _stretch(found: InHand, here: InHand, way: Ray) -> None:
    pose = here.pose
    if not pose.reached:
        pieces.note(here.reason)
        return
    yardstick = solids.yardstick(found.pose.frames)
    # One scale for the whole ray, so that the body is seen to stretch.
    times = ellipsoid_scale(found.pose.C, 0.13 * yardstick)

    def finish(fig: Chart, dark: bool) -> None:
        tip = pose.T_MT[:3, 3]
        body, said = ellipsoid_traces(pose.C, tip, times, dark=dark, width=0.005 * yardstick)
        fig.add_traces([*body, *(solids.words([each], textposition=_side(each[0] - tip)) for each in said)])
        # The box holds the body where it is longest, so that nothing of it is cut off.
        longest = 1.2 * times * float(soft_direction(cartesian_compliance(pose.robot, way.theta))[0].max())
        widen(fig, way.p.min(axis=0) - longest, way.p.max(axis=0) + longest, room=2.6)
        bare = {f"{axis}axis": {"visible": False} for axis in "xyz"}
        fig.lay_out(scene={"camera": lesson.SIDE, **bare})

    grown = format_times(times / FORCE)
    push = format_si(FORCE, "N", 0)
    caption = f"Where {push} in every direction take the tip, shown {grown}; the same scale at every distance."
    alt = "The arm with its compliance ellipsoid at the chosen distance."
    arm(
        ArmScene(frames=pose.frames, joints=pose.robot.joint_numbers, unit=session.project().view.of("m")),
        "learn-edge",
        (caption, alt),
        480,
        1.1,
        ((pose.C, way.p), finish),
    )


def _side(away: FloatArray) -> str:
    """Where a word stands beside its point, so that it does not lie over what it is ``away`` (3,) from."""
    return f"{'bottom' if away[2] < 0.0 else 'top'} center"


def _large(value: float, unit: str) -> str:
    number, label = split_unit(format_si(value, unit, 3))
    return f'<div class="rm-det">{number} <small>{label}</small></div>'


def _measure(pose: PoseReport, way: Ray, i: int) -> None:
    what = map_quantity(pose.robot, "det_J")
    det = float(way.det[i])
    softest_here = pose.principal[0][-1]
    view = session.project().view
    give, det_unit = view.of("um/N"), view.of(what.unit)
    near = "A singularity: one direction is lost." if near_singular(pose.robot, det) else "Far from a singularity."
    st.html(
        f'<p class="rm-note">Distance to singularity, det(J)</p>{_large(det, det_unit)}<p class="rm-note">{near}</p>'
        f'<p class="rm-note">Largest compliance</p>{_large(float(softest_here), give)}'
    )
    unit = view.length
    softest = soft_direction(cartesian_compliance(pose.robot, way.theta))[0][:, -1]
    fig = ray_figure(
        from_si(way.radius, unit),
        i,
        (
            f"distance from the base, {unit_label(unit)}",
            f"det(J), {unit_label(det_unit)}",
            f"compliance,<br>{unit_label(give)}",
        ),
        (from_si(way.det, det_unit), from_si(softest, give)),
        dark=shell.dark(),
    )
    pieces.figure(
        fig,
        "learn-ray",
        alt="det(J) and the largest compliance against the distance from the base.",
        table=lambda: {
            f"distance_{unit}": from_si(way.radius, unit),
            "det_J": from_si(way.det, det_unit),
            f"largest_compliance_{give}": from_si(softest, give),
        },
    )
