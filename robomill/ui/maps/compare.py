"""Up to three robots or compliance sets side by side, with the difference to the first."""

from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import RobomillError, WorkspaceError
from robomill.io.robots import load_robot, robot_names
from robomill.robot.model import USER_SET, Robot
from robomill.ui import fields, inputs, pieces, session
from robomill.ui.project import MapView
from robomill.units import NOT_REACHED, format_number, format_percent, format_value, from_si, unit_label
from robomill.viz.maps import Map, Scale, symmetric_limit
from robomill.viz.theme import plain
from robomill.workspace.fields import ComplianceField
from robomill.workspace.quantities import one_sign

UM = "um/N"
MOST = 3


def candidates(robot: Robot, view: MapView) -> dict[str, str]:
    """Key -> name of everything that can be compared."""
    found = {f"set:{name}": name.replace("_", " ").capitalize() for name in robot.compliance_sets}
    if robot.compliance_set == USER_SET:
        found["now"] = "As edited"
    if (view.stiffening(robot) != 1.0).any():
        found["what-if"] = "What if"
    found |= {f"robot:{name}": name.replace("_", " ") for name in robot_names() if name != robot.name}
    return found


def chosen(robot: Robot, view: MapView) -> list[str]:
    """What is compared: as chosen, else what is at hand (two compliance sets, the edited robot, what-if)."""
    known = candidates(robot, view)
    kept = [key for key in view.against if key in known]
    return kept or [key for key in known if not key.startswith("robot:")][:MOST] or list(known)[:2]


def controls(robot: Robot, view: MapView) -> None:
    """The list to choose from."""
    inputs.several(
        "Compare up to three",
        "maps.against",
        candidates(robot, view),
        chosen(robot, view),
        lambda keys: session.see(against=tuple(keys)),
        inputs.Look(listed=True, hidden=True, most=MOST, placeholder="Robots or compliance sets"),
    )


def panels(
    robot: Robot, view: MapView, known: ComplianceField, normal: str
) -> tuple[list[list[Map | None]], dict[str, Scale], list[tuple[str, str, str]], dict[str, Any]]:
    """Maps, scales, rows of text and columns of the comparison over the plane of ``known``."""
    names = candidates(robot, view)
    name = f"C_{view.component}"
    values: dict[str, FloatArray] = {}
    for key in chosen(robot, view):
        try:
            values[key] = from_si(_field(key, robot, view, known).values(name), UM).squeeze(axis="xyz".index(normal))
        except RobomillError as exc:
            pieces.error(exc)
    keys = list(values)
    if not keys:
        raise WorkspaceError("Nothing to compare: choose a robot or a compliance set that can be computed here.")
    cross = not one_sign(view.component)
    every = [v for v in values.values() if np.isfinite(v).any()]
    low = min((float(np.nanmin(v)) for v in every), default=0.0)
    label = f"C<sub>{view.component}</sub>, {unit_label(UM)}"
    first = values[keys[0]]
    differences = {key: values[key] - first for key in keys[1:]}
    scales = {
        "main": Scale.signed(label, every) if cross else Scale(label, low, symmetric_limit(every)),
        "difference": Scale.signed(f"difference, {unit_label(UM)}", list(differences.values())),
    }
    rows: list[list[Map | None]] = [
        [Map(f"<b>{plain(names[key])}</b>  {_mean(values[key])}", values[key], unit=unit_label(UM)) for key in keys]
    ]
    apart: list[Map | None] = [
        Map(f"{plain(names[key])} − {plain(names[keys[0]])}", differences[key], "difference", unit_label(UM))
        for key in keys[1:]
    ]
    if len(apart) == 1:
        rows[0] += apart
    elif apart:
        rows.append([None, *apart])
    return rows, scales, _text(names, values, keys), _columns(names, values, keys)


def _field(key: str, robot: Robot, view: MapView, known: ComplianceField) -> ComplianceField:
    if key == "now":
        return known
    if key == "what-if":
        return fields.stiffer(known, view.stiffening(robot))
    kind, _, name = key.partition(":")
    other = robot.with_compliance_set(name) if kind == "set" else load_robot(name)
    return fields.field(other, known.grid, view.A, view.B)


def _mean(values: FloatArray) -> str:
    return f"mean {format_number(np.nanmean(values), 3)}" if np.isfinite(values).any() else NOT_REACHED


def _text(names: dict[str, str], values: dict[str, FloatArray], keys: list[str]) -> list[tuple[str, str, str]]:
    first = values[keys[0]]
    rows = []
    for key in keys:
        both = np.isfinite(values[key]) & np.isfinite(first)
        if not both.any():
            rows.append((names[key], "not reached", "no cell in common with the first"))
            continue
        mean, base = float(values[key][both].mean()), float(first[both].mean())
        change = (
            ""
            if key == keys[0] or abs(base) < 1e-9
            else f"{format_percent(mean / base - 1, sign=True)} against {names[keys[0]]}"
        )
        rows.append((names[key], format_value(mean, UM, 3), f"mean over the plane {change}"))
    return rows


def _columns(names: dict[str, str], values: dict[str, FloatArray], keys: list[str]) -> dict[str, Any]:
    return {f"{names[key]}, um/N": values[key].ravel() for key in keys}
