"""Where the numbers of a set-up come from, in words: one row a block."""

from dataclasses import dataclass

import numpy as np

from robomill.provenance import Provenance
from robomill.robot.model import USER_SET
from robomill.simulation.setup import SimulationSetup
from robomill.units import format_limit, format_many, format_si, format_significant, from_si, unit_label

NOT_STATED = Provenance("user", "not stated")
MODEL = Provenance("assumed", "static force, stiff links, joints as linear springs, small deflections")


@dataclass(frozen=True)
class Source:
    """A block of numbers: what it is, its value in short, and its provenance."""

    what: str
    value: str
    provenance: Provenance


def sources(setup: SimulationSetup, length: str = "mm") -> list[Source]:
    """One row for each block that the result rests on, the assumed ones among them; lengths in ``length``."""
    robot, given = setup.robot, {**setup.robot.provenance, **setup.provenance}
    unit = "1e-7 rad/(N m)"
    compliances = format_many(robot.C_theta, unit, 2)
    name = robot.compliance_set.replace("_", " ").capitalize() if robot.compliance_set != USER_SET else "Edited"
    set_source = given.get(f"compliance.{robot.compliance_set}", Provenance("user", "entered by hand"))
    lengths = ", ".join(format_significant(from_si(v, length)) for v in _lengths(setup))
    path = setup.toolpath
    return [
        Source("Joint compliances", f"{name}: {compliances}", set_source),
        Source("D-H table", f"{robot.rows} joints, {robot.convention}", given.get("geometry", NOT_STATED)),
        Source(
            "Link lengths", f"{lengths} {unit_label(length)}", given.get("lengths", given.get("geometry", NOT_STATED))
        ),
        Source("Joint limits", f"{robot.n} ranges", given.get("limits", NOT_STATED)),
        Source("Tool in the last axis", _tool(setup, length), given.get("tool", NOT_STATED)),
        Source("Path", f"{format_si(float(path.s[-1]), length, 0)} at feed", given.get("path", NOT_STATED)),
        Source("Cutter", setup.cutter.called(length), given.get("cutter", NOT_STATED)),
        Source("Force", setup.force.numbers, given.get("force", setup.force.provenance)),
        Source("Stock", _stock(setup, length), given.get("stock", NOT_STATED)),
        Source("Tolerance", format_limit(setup.tolerance, length), given.get("tolerance", NOT_STATED)),
        Source("Model", "C = J C_θ Jᵀ, δ = C F", MODEL),
    ]


def _lengths(setup: SimulationSetup) -> list[float]:
    robot = setup.robot
    return [float(v) for v in np.concatenate([robot.a, robot.d]) if v != 0.0]


def _tool(setup: SimulationSetup, length: str) -> str:
    tip, k = setup.robot.T_tool[:3, 3], setup.robot.T_tool[:3, 2]
    direction = ", ".join(format_significant(float(v) + 0.0) for v in np.round(k, 4))
    return f"tip {format_many(tip, length, 1)}, z_T along ({direction})"


def _stock(setup: SimulationSetup, length: str) -> str:
    size = from_si(setup.stock_block.upper - setup.stock_block.lower, length)
    return " × ".join(format_significant(v) for v in np.round(size, 3)) + f" {unit_label(length)}"
