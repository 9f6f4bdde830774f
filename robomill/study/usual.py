"""The numbers of a set-up that one asks about first, each with the key by which a study changes it."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal

import numpy as np

from robomill.errors import StudyError
from robomill.io.robot.reader import COMPLIANCE, STIFFNESS
from robomill.io.robot.writer import robot_to_toml
from robomill.io.tables import parse_toml
from robomill.quantities import quantities
from robomill.robot.model import Robot
from robomill.simulation.setup import SimulationSetup
from robomill.study.addressed import FEED, Data, tables_of, value_at
from robomill.units import from_si, to_si

AROUND = 0.5  # of a number: so far its range goes to both sides where nothing else is usual
ASIDE, TURN = 0.1, to_si(30.0, "deg")  # m and rad: so far the part is moved and turned to both sides
PUSH = 50.0  # N to both sides of none
COEFFICIENT = "_N_mm2"  # how the names of the coefficients of a material end that follow the chip


@dataclass(frozen=True)
class Usual:
    """A number of a set-up: its ``key`` in a study, what people call it, the unit of the key; what it is ``now``, and
    between which ends one asks about it, SI."""

    key: str
    label: str
    unit: str
    now: float
    low: float
    high: float

    def in_key(self, value: float) -> float:
        """A value in SI as the key has it."""
        return float(from_si(value, self.unit))


def usual_parameters(setup: SimulationSetup) -> tuple[Usual, ...]:
    """What this set-up has of the usual: force, how deep and how fast it cuts, the cutter, the part's place, joints."""
    found = [*_force(setup), *_cut(setup)]
    if not setup.tools:
        found.append(_around("cutter.diameter_mm", "Diameter of the cutter", "mm", setup.cutter.diameter))
    data = tables_of(setup, [])
    for i, axis in enumerate("XY"):
        key, now = f"part.zero_mm[{i + 1}]", float(setup.T_MW[i, 3])
        found += [Usual(key, f"Part zero {axis}", "mm", now, now - ASIDE, now + ASIDE)] if _stands(data, key) else []
    if _stands(data, "part.rotation_z_deg"):
        now = float(np.arctan2(setup.T_MW[1, 0], setup.T_MW[0, 0]))
        found.append(Usual("part.rotation_z_deg", "Turn of the part", "deg", now, now - TURN, now + TURN))
    return (*found, *_joints(setup.robot))


def _around(key: str, label: str, unit: str, now: float) -> Usual:
    if now == 0.0:
        return Usual(key, label, unit, 0.0, -PUSH, PUSH)
    ends = sorted(((1.0 - AROUND) * now, (1.0 + AROUND) * now))
    return Usual(key, label, unit, now, *ends)


def _stands(data: Data, key: str) -> bool:
    try:
        value_at(data, key)
    except StudyError:
        return False
    return True


def _force(setup: SimulationSetup) -> list[Usual]:
    """Components of a stated force; coefficients of the material that follow the chip."""
    found: list[Usual] = []
    for name, declared in quantities(type(setup.force)).items():
        value = np.asarray(getattr(setup.force, name), dtype=object)
        if declared.unit != "N" or any(part is None for part in value.ravel()):
            continue
        label = "Force" if declared.label == "F" else f"Force, {declared.label[:1].lower()}{declared.label[1:]}"
        if declared.shape:
            axes = declared.axes or [str(i + 1) for i in range(len(value))]
            found += [
                _around(f"force.{declared.key}[{i + 1}]", f"{label} {axis}", "N", float(part))
                for i, (axis, part) in enumerate(zip(axes, value, strict=True))
            ]
        else:
            found.append(_around(f"force.{declared.key}", label, "N", float(value)))
    found.sort(key=lambda each: each.now == 0.0)
    if getattr(setup.force, "material", None) is None:
        return found
    beneath = "force.material.coefficients"
    table = value_at(tables_of(setup, [f"{beneath}.any"]), beneath)
    for key, number in table.items():
        if key.endswith(COEFFICIENT) and isinstance(number, int | float | Decimal) and number > 0.0:
            label = f"Coefficient {key.removesuffix(COEFFICIENT)}"
            found.append(_around(f"{beneath}.{key}", label, "N/mm2", float(to_si(float(number), "N/mm2"))))
    return found


def _cut(setup: SimulationSetup) -> list[Usual]:
    """The feed, and how deep it cuts: by the top of the stock over the same path."""
    if not setup.force.follows_cut:
        return []
    found = [_around(FEED, "Feed, of what it is", "%", 1.0)]
    stock = setup.stock
    if stock is not None and stock.triangles is None and setup.engagement:
        top = float(stock.upper[2])
        depth = top - float(setup.toolpath.extents[0][2])
        if depth > 0.0:
            ends = (top - AROUND * depth, top + AROUND * depth)
            found.append(Usual("stock.upper_mm[3]", "Top of the stock, Z (how deep it cuts)", "mm", top, *ends))
    return found


def _joints(robot: Robot) -> list[Usual]:
    """The compliance of each joint, of an arm whose joints all turn; as its file says it."""
    if robot.prismatic.any():
        return []
    table = parse_toml(robot_to_toml(robot), "robot")["compliance"]
    table = table if any(key in COMPLIANCE for key in table) else table[table["use"]]
    key = next((key for key in table if key in COMPLIANCE and key != STIFFNESS), None)
    if key is None:
        return []
    return [
        _around(
            f"robot.compliance.{key}[{number}]", f"Compliance of joint {number}", COMPLIANCE[key], float(compliance)
        )
        for number, compliance in zip(robot.joint_numbers, robot.C_theta, strict=True)
        if compliance > 0.0
    ]
