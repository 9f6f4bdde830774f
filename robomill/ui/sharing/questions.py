"""What a page asks that is no run of the cut: a map, or what load tests say; as a command and as Python."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from robomill.compliance.components import COMPONENTS
from robomill.identification.fit.treatment import AUTO, STANDARD
from robomill.io.robot.robots import load_robot, robot_names
from robomill.io.tables import exactly
from robomill.robot.model import Robot
from robomill.ui.bench import OWN, Bench
from robomill.ui.posed import fields
from robomill.ui.project import MapView, Project

NINE = tuple(f"C_{component}" for component in COMPONENTS)


class Question(NamedTuple):
    """The words of a command behind ``robomill`` (none where it takes more than a command can say) and lines of
    Python behind those that make ``setup``."""

    words: tuple[str, ...]
    lines: tuple[str, ...]


def question(project: Project, page: str) -> Question | None:
    """What a page of the project asks; None where it asks about the cut. Raises what the maps' region raises."""
    if page in ("Workspace", "Compliance"):
        return _map(project, page)
    if page == "Identification" and project.bench.sample != OWN:
        return _tests(project.setup.robot, project.bench)
    return None


def _map(project: Project, page: str) -> Question:
    """The plane that stands on a page of maps, of what is shown there."""
    robot = project.setup.robot
    view = project.maps.of(robot)
    box = fields.region(robot, view)
    normal, at = fields.plane_at(robot, view, box)
    step = fields.plane_step(robot, view, box, normal)
    names = (view.quantity,) if page == "Workspace" else _of_sheet(view)
    low, high = box.lower.tolist(), box.upper.tolist()
    factors = view.stiffening(robot) if page == "Compliance" else np.ones(robot.n)
    lines = ["robot = setup.robot"]
    if (factors != 1.0).any():
        lines.append(f"robot = robot.replace(C_theta=robot.C_theta / {factors.tolist()})")
    lines += [
        f'grid = rm.plane_grid("{normal}", {at!r}, {low!r}, {high!r}, {step!r})',
        f"cells = rm.compliance_map(robot, grid, {view.A!r}, {view.B!r})",
        f"for field in cells.fields({list(names)!r}):",
        "    print(field)",
    ]
    axes: list[Any] = [(at,) if axis == normal else (low[i], high[i], step) for i, axis in enumerate("xyz")]
    told = [f"--{axis}={_in(ends, 'mm')}" for axis, ends in zip("xyz", axes, strict=True)]
    told += [f"--{name}-deg={_in((angle,), 'deg')}" for name, angle in (("a", view.A), ("b", view.B)) if angle]
    known = _named(robot) if (factors == 1.0).all() else ()
    words = ("map", *known, "--quantity", ",".join(names), *told) if known else ()
    return Question(() if any("None" in word for word in words) else words, tuple(lines))


def _of_sheet(view: MapView) -> tuple[str, ...]:
    return {"one": (view.one,), "dominant": (f"dominant_C_{view.component}",)}.get(view.sheet, NINE)


def _tests(robot: Robot, bench: Bench) -> Question:
    """What a sample of load tests says."""
    other, treatment = bench.robot_name(robot.name), bench.treatment
    line = f'robot = rm.load_robot("{other}")' if other else "robot = setup.robot"
    known = (other,) if other else _named(robot)[:1]  # its own compliances do not enter
    words, given = ["--model", bench.model], [f'"{bench.model}"']
    for name in ("bending", "fit_points", "robust", "exclude", "weights", "leave_out"):
        value = getattr(treatment, name)
        if value != getattr(STANDARD, name):
            given.append(f"{name}={value!r}")
            said = ",".join(map(str, value)) if isinstance(value, tuple) else str(value)
            words += [f"--{name.replace('_', '-')}"] + ([] if value is True else [said])
    lines = (line, f'found = rm.identify(robot, "{bench.sample}", {", ".join(given)})', "print(found)")
    plain = treatment.bending in (AUTO, STANDARD.bending)  # other joints make the command's model another one
    return Question(("identify", *known, bench.sample, *words) if known and plain else (), lines)


def _named(robot: Robot) -> tuple[str, ...]:
    """The robot as words of a command; none where it is no preset as it came."""
    if robot.name in robot_names():
        preset = load_robot(robot.name)
        if preset == robot:
            return (robot.name,)
        if robot.compliance_set in preset.compliance_sets and preset.with_compliance_set(robot.compliance_set) == robot:
            return robot.name, "--compliance-set", robot.compliance_set
    return ()


def _in(numbers: Sequence[float], unit: str) -> str:
    """Numbers of a command, "None" for one that no decimal meets."""
    return ":".join(repr(exactly(number, unit)).removesuffix(".0") for number in numbers)
