"""Where the numbers of a set-up come from, in words: one row a block."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from robomill.provenance import BY_HAND, UNSTATED, Provenance
from robomill.robot.model import USER_SET, Robot
from robomill.robot.sources import block_in_force
from robomill.simulation.setup import SimulationSetup
from robomill.units import format_limit, format_many, format_si, format_significant, from_si, unit_label

MODEL = Provenance("assumed", "static force, stiff links, joints as linear springs, small deflections")


@dataclass(frozen=True)
class Source:
    """A block of numbers: what it is, its value in short, and its provenance."""

    what: str
    value: str
    provenance: Provenance


def sources(setup: SimulationSetup, length: str = "mm") -> list[Source]:
    """One row for each block that the result rests on, the assumed ones among them; lengths in ``length``."""
    given = {**setup.robot.provenance, **setup.provenance}
    path = setup.toolpath
    return [
        *robot_sources(setup.robot, given, length),
        Source("Path", f"{format_si(float(path.s[-1]), length, 0)} at feed", given.get("path", UNSTATED)),
        Source("Cutter", setup.cutter.called(length), given.get("cutter", UNSTATED)),
        Source("Force", setup.force.numbers, given.get("force", setup.force.provenance)),
        Source("Stock", _stock(setup, length), given.get("stock", UNSTATED)),
        Source("Tolerance", _tolerances(setup, length), given.get("tolerance", UNSTATED)),
        Source("Model", "C = J C_θ Jᵀ, δ = C F", MODEL),
    ]


def robot_sources(robot: Robot, given: Mapping[str, Provenance], length: str = "mm") -> list[Source]:
    """The rows of a robot: of each block what is ``given`` of it."""
    name = "Edited" if robot.compliance_set == USER_SET else robot.compliance_set.replace("_", " ").capitalize()
    of_set = given.get(block_in_force(robot), BY_HAND)
    lengths = ", ".join(format_significant(from_si(v, length)) for v in robot_lengths(robot).values())
    geometry = given.get("geometry", UNSTATED)
    return [
        Source("Joint compliances", f"{name}: {_compliances(robot)}", of_set),
        Source("D-H table", f"{robot.rows} joints, {robot.convention}", geometry),
        Source("Link lengths", f"{lengths} {unit_label(length)}", given.get("lengths", geometry)),
        Source("Joint limits", f"{robot.n} ranges", given.get("limits", UNSTATED)),
        Source("Tool in the last axis", _tool(robot, length), given.get("tool", UNSTATED)),
    ]


def _compliances(robot: Robot) -> str:
    """Those of the free joints, the unit once for neighbours that share it: a joint that slides has its own."""
    each = zip(robot.compliance_units, robot.C_theta, strict=True)
    alike = groupby(each, key=lambda one: one[0])
    return ", ".join(format_many([C for _, C in some], unit, 2) for unit, some in alike)


def robot_lengths(robot: Robot) -> dict[str, float]:
    """Its link lengths that are not zero, m, by their symbols: ``a_2``, ``d_4``."""
    rows = enumerate(zip(robot.a, robot.d, strict=True), 1)
    named = {f"{symbol}_{i}": float(v) for i, row in rows for symbol, v in zip("ad", row, strict=True)}
    return {name: value for name, value in named.items() if value != 0.0}


def _tool(robot: Robot, length: str) -> str:
    tip, k = robot.T_tool[:3, 3], robot.T_tool[:3, 2]
    direction = ", ".join(format_significant(float(v) + 0.0) for v in np.round(k, 4))
    return f"tip {format_many(tip, length, 1)}, z_T along ({direction})"


def _tolerances(setup: SimulationSetup, length: str) -> str:
    """One, or each that is another."""
    own = {"floors": setup.floor_tolerance, "along the feed": setup.feed_tolerance}
    said = [
        f"{format_limit(each, length)} {where}" for where, each in own.items() if each not in (None, setup.tolerance)
    ]
    return ", ".join([format_limit(setup.tolerance, length), *said])


def _stock(setup: SimulationSetup, length: str) -> str:
    size = from_si(setup.stock_block.upper - setup.stock_block.lower, length)
    return " × ".join(format_significant(v) for v in np.round(size, 3)) + f" {unit_label(length)}"
