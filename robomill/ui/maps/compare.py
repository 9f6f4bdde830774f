"""Up to three robots or compliance sets side by side, with the difference to the first."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import RobomillError, WorkspaceError
from robomill.improve.sensitivity import stiffened
from robomill.io.robot.robots import load_robot, robot_names
from robomill.robot.model import USER_SET, Robot
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.ui.maps.board import Planes
from robomill.ui.posed import fields
from robomill.ui.project import MapView
from robomill.units import UNITS, format_percent, format_value, from_si
from robomill.viz.maps import Scale
from robomill.viz.planes import Codes, PlaneMap, ends, means
from robomill.workspace.quantities import one_sign

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


@dataclass(frozen=True, eq=False)
class Compared:
    """What is compared by key, the first one what the others are held against; rows of maps and their scales."""

    robots: dict[str, Robot]
    names: dict[str, str]
    component: str
    unit: str
    rows: list[list[PlaneMap | None]]
    scales: dict[str, Scale]

    def _values(self, planes: Planes) -> dict[str, FloatArray]:
        """The component over the plane in force."""
        name = f"C_{self.component}"
        return {key: from_si(planes.known(robot).values(name), self.unit) for key, robot in self.robots.items()}

    def columns(self, planes: Planes) -> dict[str, Any]:
        """The table twin."""
        label = UNITS[self.unit].label
        return {f"{self.names[key]}, {label}": v.ravel() for key, v in self._values(planes).items()}

    def words(self, planes: Planes) -> list[tuple[str, str, str]]:
        """The mean of each over the plane in force, and how it differs from the first."""
        values = self._values(planes)
        first, *_ = self.robots
        rows = []
        for key, shown in values.items():
            both = np.isfinite(shown) & np.isfinite(values[first])
            if not both.any():
                rows.append((self.names[key], "not reached", "no cell in common with the first"))
                continue
            mean, base = float(shown[both].mean()), float(values[first][both].mean())
            against = "" if key == first or abs(base) < 1e-9 else f" against {self.names[first]}"
            change = f"{format_percent(mean / base - 1, sign=True)}{against}" if against else ""
            rows.append((self.names[key], format_value(mean, self.unit, 3), f"mean over the plane {change}"))
        return rows


def panels(planes: Planes, unit: str) -> Compared:
    """The maps of what is compared over all planes, and their differences to the first. Raises WorkspaceError."""
    robot, view = planes.region.robot, planes.region.view
    names, name = candidates(robot, view), f"C_{view.component}"
    robots: dict[str, Robot] = {}
    codes: dict[str, Codes] = {}
    for key in chosen(robot, view):
        try:
            other = _robot(key, robot, view)
            codes[key] = planes.codes([name], other)[name]
            robots[key] = other
        except RobomillError as exc:
            pieces.error(exc)
    if not robots:
        raise WorkspaceError("Nothing to compare: choose a robot or a compliance set that can be computed here.")
    first, *others = robots
    apart = {key: _apart(planes, robots[first], robots[key], name) for key in others}
    label, every = UNITS[unit].label, ends(codes.values(), unit)
    low, high = (float(every.min()), float(every.max())) if len(every) else (0.0, 1.0)
    scales = {
        "main": Scale(f"{name}, {label}", low, high)
        if one_sign(view.component)
        else Scale.signed(f"{name}, {label}", [every]),
        "difference": Scale.signed(f"difference, {label}", [ends(apart.values(), unit)]),
    }
    rows: list[list[PlaneMap | None]] = [
        [
            PlaneMap(
                names[key], codes[key], unit, notes=[f"mean {words}" for words in means(codes[key], unit)], low=False
            )
            for key in robots
        ]
    ]
    differences: list[PlaneMap | None] = [
        PlaneMap(f"{names[key]} − {names[first]}", each, unit, "difference", low=False) for key, each in apart.items()
    ]
    if len(differences) == 1:
        rows[0] += differences
    elif differences:
        rows.append([None, *differences])
    used = {panel.scale for row in rows for panel in row if panel is not None}
    return Compared(robots, names, view.component, unit, rows, {k: v for k, v in scales.items() if k in used})


def _apart(planes: Planes, first: Robot, other: Robot, name: str) -> Codes:
    view = planes.region.view
    return fields.coded_differences(first, other, planes.grid, planes.normal, (view.A, view.B), (name,))[name]


def _robot(key: str, robot: Robot, view: MapView) -> Robot:
    if key == "now":
        return robot
    if key == "what-if":
        return stiffened(robot, view.stiffening(robot))
    kind, _, name = key.partition(":")
    return robot.with_compliance_set(name) if kind == "set" else load_robot(name)
