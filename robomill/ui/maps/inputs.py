"""Inputs both map pages share: region, tilt, plane and its slider."""

from __future__ import annotations

from collections.abc import Callable

import streamlit as st

from robomill.errors import WorkspaceError
from robomill.robot.model import Robot
from robomill.ui import fields as maps_fields
from robomill.ui import inputs, pieces, session
from robomill.ui.project import MapView
from robomill.units import UNITS, format_si, from_si, to_si, unit_label
from robomill.workspace.reach import Box

REGIONS = {
    "paper": "The paper's box",
    "largest": "Largest box in reach",
    "reach": "Everything in reach",
    "own": "My own numbers",
}


def value(
    label: str, key: str, current: float, unit: str, write: Callable[[float], None], step: float | None = None
) -> None:
    """A number box for a value in SI that is no field of the set-up."""
    inputs.seed(key, float(f"{from_si(float(current), unit):.10g}"))
    st.number_input(
        f"{label}, {unit_label(unit)}" if unit_label(unit) else label,
        key=key,
        step=step,
        format=f"%.{min(UNITS[unit].digits, 2)}f",
        on_change=lambda: inputs.submit(
            key, st.session_state[key], lambda: write(to_si(float(st.session_state[key]), unit))
        ),
    )
    inputs.sentence(key)


def where(robot: Robot, view: MapView, unit: str) -> None:
    """Region, tilt and plane."""
    inputs.choice(
        "Region", "maps:region", REGIONS, view.region, lambda kind: _take_region(kind, robot, view), inputs.LISTED
    )
    if view.region == "own":
        _corners(view, unit)
    left, right = st.columns(2)
    with left:
        value("Tilt A", "maps:A", view.A, "deg", lambda v: session.see(A=v, point=None), 5.0)
    with right:
        value("Tilt B", "maps:B", view.B, "deg", lambda v: session.see(B=v, point=None), 5.0)
    known = maps_fields.normals(robot)
    if len(known) == 1:
        pieces.note(f"This arm moves in one plane: only {next(iter(known.values()))} can be shown.")
    else:
        normal = view.normal if view.normal in known else "z"
        inputs.choice("Plane", "maps:normal", known, normal, lambda n: session.see(normal=n, at=None))


def tilt_note(robot: Robot) -> str:
    """What of the tilt counts for this arm."""
    if robot.n < 5:
        return "An arm of fewer than five joints reaches points; the tilt does not count."
    return "A, B turn the tool about X and then Y: k_T = (sin B, −sin A cos B, cos A cos B)."


def plane_slider(robot: Robot, box: Box, normal: str, at: float, unit: str) -> None:
    """The slider that moves the plane through the region."""
    i = "xyz".index(normal)
    low, high = (float(from_si(float(v), unit)) for v in (box.lower[i], box.upper[i]))
    name = f"{normal.upper()}ₘ, {unit_label(unit)}"
    if high - low < 1e-9:
        pieces.note(f"{name}: {format_si(at, unit, 1)}; the region has no depth here.")
        return
    step = float(f"{(high - low) / 50:.1g}")
    inputs.slider(
        name,
        f"maps:at:{normal}:{unit}",
        inputs.Span(round(low, 3), round(high, 3), step, "%.0f" if unit == "mm" else "%.2f"),
        round(float(from_si(at, unit)), 3),
        lambda v: session.see(at=to_si(v, unit), normal=normal),
    )


def plane_title(normal: str, at: float, unit: str) -> str:
    """``Z_M = 0 mm`` as people read it."""
    return f"{normal.upper()}<sub>M</sub> = {format_si(at, unit, 0 if unit == 'mm' else 2)}"


def axes_titles(normal: str, unit: str) -> tuple[str, str]:
    """Titles across and upwards."""
    u, v = (a for a in "xyz" if a != normal)
    return tuple(f"{a.upper()}<sub>M</sub>, {unit_label(unit)}" for a in (u, v))  # type: ignore[return-value]


def _take_region(kind: str, robot: Robot, view: MapView) -> None:
    if kind == "own":
        try:
            box = maps_fields.region(robot, view)
        except WorkspaceError:
            session.see(region=kind, at=None)
            return
        session.see(region=kind, at=None, lower=tuple(map(float, box.lower)), upper=tuple(map(float, box.upper)))
    else:
        session.see(region=kind, at=None, point=None)


def _corners(view: MapView, unit: str) -> None:
    for name, side in (("from", "lower"), ("to", "upper")):
        for i, column in enumerate(st.columns(3)):
            with column:
                value(
                    f"{'XYZ'[i]} {name}",
                    f"maps:{side}:{i}:{unit}",
                    getattr(view, side)[i],
                    unit,
                    lambda v, i=i, side=side: _put_corner(side, i, v),  # type: ignore[misc]
                    50.0,
                )
    value("Step (0 lets robomill choose)", f"maps:step:{unit}", view.step or 0.0, unit, _put_step, 5.0)


def _put_corner(side: str, i: int, value_SI: float) -> None:
    current = list(getattr(session.maps(), side))
    current[i] = value_SI
    session.see(**{side: tuple(current)}, at=None)


def _put_step(step: float) -> None:
    if step < 0:
        raise WorkspaceError("Step: found a number below zero; type 0 to let robomill choose, or a spacing above 0.")
    session.see(step=step or None)
