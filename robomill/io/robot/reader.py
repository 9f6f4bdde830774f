"""A robot from TOML text: units in the keys, a provenance for every block, one sentence for whatever is wrong."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import RobotError
from robomill.io.tables import MISSING, Table, parse_toml
from robomill.quantities import quantities
from robomill.rigid import transform
from robomill.robot.model import USER_SET, Robot
from robomill.robot.stiffness import turned_over

FORMAT, VERSION = "robomill robot", 1
# Accepted suffixes of a key and the unit each names. The writer takes the first that gives the number back exactly.
LENGTH = {"mm": "mm", "m": "m"}
ANGLE = {"deg": "deg", "rad": "rad"}
SPELLED = {"mm": LENGTH, "deg": ANGLE}
STEMS = {"limits_all": "limits", "blocked": "blocked_at"}  # of keys that are not called as their field
C_THETA = {"1e-7_rad_per_Nm": "1e-7 rad/(N m)", "SI": "1"}
STIFFNESS = "k_theta_Nm_per_rad"
COMPLIANCE = {**{f"C_theta_{suffix}": unit for suffix, unit in C_THETA.items()}, STIFFNESS: "1"}
TURNS, SLIDES = "revolute", "prismatic"


def robot_from_toml(text: str, where: str = "robot") -> Robot:
    """The robot written in ``text``; ``where`` names it in refusals. Raises RobotError with one sentence."""
    top = Table(parse_toml(text, where, RobotError), where, RobotError)
    found = top.text("format", FORMAT), top.whole("version", VERSION)
    if found[0] == "robomill-setup":
        raise top.refuse("format", "this is a set-up, not a robot; give the robot that it names.")
    if found != (FORMAT, VERSION):
        raise top.refuse("version", f"expected format {FORMAT!r}, version {VERSION}; found {found[0]!r}, {found[1]}.")
    joints = top.tables("joint")
    if not joints:
        raise top.refuse("joint", "found no joints; write one [[joint]] table for each of 1 to 7 joints.")
    if not top.data.get("compliance"):
        raise top.refuse("compliance", "missing; give [compliance] with use = '<set>' and [compliance.<set>].")
    provenance = top.table("provenance", {})
    values = {
        "name": top.text("name", Path(where).stem),
        "title": top.text("title", ""),
        "convention": top.text("convention", "standard"),
        "T_base": _frame(top.table("base", {})),
        "T_tool": _frame(top.table("tool", {})),
        "provenance": {block: provenance.provenance(block) for block in provenance.data},
        **_columns(joints),
        **_compliance(top.table("compliance"), len(joints)),
    }
    top.finish()
    try:
        return Robot(**values)
    except RobotError as exc:
        raise RobotError(f"{where}: {exc}", where=where) from None


def _columns(joints: Sequence[Table]) -> dict[str, list[Any]]:
    """The columns of the D-H table and what else a joint's row says, by the robot's own names."""
    rows = [_joint(joint) for joint in joints]
    return {name: [row[name] for row in rows] for name in rows[0]}


def _joint(table: Table) -> dict[str, Any]:
    slides = table.choice("type", (TURNS, SLIDES), TURNS) == SLIDES
    table.asked.add("name")  # for whoever reads the file
    row: dict[str, Any] = {"prismatic": slides, "sign": table.number("sign", "1", 1.0)}
    for name, stem, spelled in written(slides):
        if name == "limits_all":
            row[name] = table.measures(stem, spelled, 2, MISSING, "[lower, upper]")
        else:
            row[name] = table.measure(stem, spelled, np.nan if name == "blocked" else MISSING)
    table.finish()
    return row


def written(slides: bool) -> list[tuple[str, str, Mapping[str, str]]]:
    """(field, stem of its key, how the key may end and the unit of each) of what a joint's table says in units."""
    found = [declared.of_joint(slides) for declared in quantities(Robot).values()]
    return [(each.name, STEMS.get(each.name, each.name), SPELLED[each.unit]) for each in found if each.unit in SPELLED]


def _compliance(table: Table, rows: int) -> dict[str, Any]:
    """The sets, the one in force and its numbers. ``use`` names a set; numbers beside the sets are the user's own."""
    sets = {}
    for key, value in table.data.items():
        if isinstance(value, dict):
            entry = table.table(key)
            sets[key] = _column(entry, rows)
            entry.finish()
    own = any(table.has(key) for key in COMPLIANCE)
    current = table.text("use", USER_SET if own or not sets else next(iter(sets)))
    if not own and current not in sets:
        raise table.refuse("use", f"{current!r} is not among its sets ({', '.join(sets) or 'none'}).")
    values = _column(table, rows) if own else sets[current]
    table.finish()
    return {"compliance_sets": sets, "compliance_set": current, "C_theta_all": values}


def _column(table: Table, rows: int) -> FloatArray:
    """(rows,) rad/(N m), m/N for sliding joints, from compliances or stiffnesses."""
    found = [key for key in COMPLIANCE if table.has(key)]
    if len(found) != 1:
        raise table.refuse(" or ".join(found) or "numbers", f"give exactly one of {', '.join(COMPLIANCE)}.")
    key = found[0]
    values = np.array(table.numbers(key, rows, COMPLIANCE[key], expected=f"{rows} numbers, one a joint"))
    if key != STIFFNESS:
        return values
    for joint, stiffness in enumerate(values, 1):
        if stiffness <= 0:
            raise table.refuse(key, f"joint {joint}: the stiffness is {stiffness:g}; it must be above zero.")
    return np.asarray(turned_over(values))


def _frame(table: Table) -> FloatArray:
    """(4, 4) from ``xyz_mm``/``xyz_m`` and three rows ``rotation``."""
    p = table.measures("xyz", LENGTH, 3, (0.0, 0.0, 0.0), "three numbers")
    R = table.rows("rotation", 3, "1", 3) if table.has("rotation") else np.eye(3)
    table.finish()
    return transform(R, p)
