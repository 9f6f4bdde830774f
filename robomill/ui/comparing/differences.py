"""Set-ups put beside each other: what each comes to, then what differs in them, by name and value."""

import dataclasses
import hashlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from robomill.errors import RobomillError
from robomill.io.setups.projects import setup_to_toml
from robomill.io.tables import parse_toml
from robomill.quantities import Quantity, quantities
from robomill.simulation.judging.verdict_words import FLOOR, WALL
from robomill.simulation.setup import SimulationSetup
from robomill.ui.judged.verdict import WORDS
from robomill.ui.work import cached
from robomill.units import format_si, unit_label

# Of a set-up's file: what is no decision, or said by the rows above.
NOT_COMPARED = ("format", "version", "name", "description", "provenance")


def outcomes(setups: Sequence[SimulationSetup], unit: str) -> list[list[str]]:
    """Robot, force, wall, floor and verdict of each set-up, a row each."""
    return [list(row) for row in zip(OUTCOMES, *(_outcome(setup, unit) for setup in setups), strict=True)]


OUTCOMES = ("Robot", "Force", WALL.label, FLOOR.label, "Verdict")


def _outcome(setup: SimulationSetup, unit: str) -> tuple[str, ...]:
    robot, force = setup.robot.title or setup.robot.name, setup.force.title
    try:
        result = cached.result(setup)
    except RobomillError as exc:
        return robot, force, "–", "–", str(exc)
    verdict = result.verdict
    read = [
        format_si(each.value, unit, sign=True) if each.worst >= 0 else "–" for each in (verdict.wall, verdict.floor)
    ]
    size = result.force_size[result.path.cutting]
    size = size[np.isfinite(size)]
    most = f", up to {format_si(float(size.max()), 'N')}" if size.size else ""
    return robot, force + most, *read, WORDS[verdict.level]


def differences(setups: Sequence[SimulationSetup]) -> list[list[str]]:
    """What the set-ups' files say differently, a row each: its name, then each value."""
    said = [_flat(parse_toml(setup_to_toml(setup), "set-up")) for setup in setups]
    rows = []
    for key in dict.fromkeys(key for each in said for key in each):
        values = [each.get(key) for each in said]
        if any(value != values[0] for value in values[1:]):
            declared = next((found for setup in setups if (found := _declared(setup, key))), None)
            rows.append([_title(key, declared), *(_shown(value, declared) for value in values)])
    return rows


def _flat(table: Mapping[str, Any], under: tuple[str, ...] = ()) -> dict[tuple[str, ...], Any]:
    found: dict[tuple[str, ...], Any] = {}
    for name, value in table.items():
        if not under and name in NOT_COMPARED:
            continue
        found |= _flat(value, (*under, name)) if isinstance(value, Mapping) else {(*under, name): value}
    return found


def _declared(setup: SimulationSetup, key: tuple[str, ...]) -> Quantity | None:
    """The declared number that stands under ``key`` of the set-up's file."""
    owner: Any = getattr(setup, key[0], None) if len(key) == 2 and key[0] != "numerics" else setup
    known = quantities(type(owner)).values() if dataclasses.is_dataclass(owner) else ()
    return next((each for each in known if each.key == key[-1]), None)


def _title(key: tuple[str, ...], declared: Quantity | None) -> str:
    where = "" if len(key) == 1 or key[0] == "numerics" else f"{key[0].capitalize()}: "
    return where + (declared.label if declared is not None else " ".join(key[-1:]).replace("_", " "))


def _shown(value: Any, declared: Quantity | None) -> str:
    """A value of a file in few words."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, float | int):
        unit = unit_label(declared.unit) if declared is not None else ""
        return f"{value:.6g} {unit}".rstrip()
    if isinstance(value, list) and all(isinstance(each, float | int) for each in value) and len(value) <= 7:
        return ", ".join(_shown(each, None) for each in value)
    text = str(value)
    if len(text) <= 60 and "\n" not in text:
        return text
    return f"{len(text.splitlines())} lines ({hashlib.sha256(text.encode()).hexdigest()[:6]})"
