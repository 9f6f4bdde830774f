"""Another table for a robot: joints taken out, put in and moved, and the same robot under the other D-H convention.

What belongs to a joint goes with it: its row of the table, its limits, where it is held, and its compliance in force
and in every set.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import RobotError
from robomill.provenance import Provenance
from robomill.robot.checks import MAX_JOINTS, MIN_JOINTS
from robomill.robot.dh import screw_x
from robomill.robot.model import Robot
from robomill.robot.table import ASSUMED_COMPLIANCE

CONVENTIONS = {"standard": "modified", "modified": "standard"}
ROWS = ("alpha", "a", "d", "theta_offset", "sign", "prismatic", "blocked", "limits_all", "C_theta_all")
TABLE_BLOCKS = ("geometry", "lengths", "limits")
# A joint that was not there: it turns or slides about the z axis that it finds, and moves nothing at zero.
NEW_ROW = {"alpha": 0.0, "a": 0.0, "d": 0.0, "theta_offset": 0.0, "sign": 1.0, "blocked": np.nan}
NEW_LIMITS = {False: (-np.pi, np.pi), True: (0.0, 0.5)}


def with_joints(robot: Robot, rows: Sequence[int]) -> Robot:
    """The robot with these rows of its table, counted from 0, in this order. Raises RobotError where too few are left.

    Fewer joints, or the same ones in another order.
    """
    if len(rows) < MIN_JOINTS:
        raise RobotError(
            f"Robot {(robot.title or robot.name)!r}: an arm needs at least one joint; this is the last one."
        )
    order = list(rows)
    sets = {name: values[order] for name, values in robot.compliance_sets.items()}
    kept = {name: getattr(robot, name)[order] for name in ROWS}
    words = "joints were taken out" if len(order) < robot.rows else "joints were put in another order"
    said = _with_said(robot, f"; {words}") if order != list(range(robot.rows)) else robot.provenance
    return robot.replace(**kept, compliance_sets=sets, compliance_set=robot.compliance_set, provenance=said)


def with_new_joint(robot: Robot, at: int, slides: bool = False) -> Robot:
    """The robot with another joint in row ``at`` (0 to rows); at its zero the tool stands where it stood.

    The joint turns, or ``slides``, about the z axis that it finds there, between +-180 degrees or 0 and 500 mm, and
    gives ``ASSUMED_COMPLIANCE``, which every set of compliances says. Raises RobotError for a joint too many.
    """
    if robot.rows >= MAX_JOINTS:
        raise RobotError(
            f"Robot {(robot.title or robot.name)!r}: has {robot.rows} joints already; robomill computes "
            f"arms of {MIN_JOINTS} to {MAX_JOINTS} joints."
        )
    new: dict[str, Any] = {
        **NEW_ROW,
        "prismatic": slides,
        "limits_all": NEW_LIMITS[slides],
        "C_theta_all": ASSUMED_COMPLIANCE,
    }
    table = {name: np.insert(getattr(robot, name), at, new[name], axis=0) for name in ROWS}
    sets = {name: np.insert(values, at, ASSUMED_COMPLIANCE) for name, values in robot.compliance_sets.items()}
    return robot.replace(
        **table,
        compliance_sets=sets,
        compliance_set=robot.compliance_set,
        provenance={**_with_said(robot, f"; joint {at + 1} was added"), **_assumed(robot, at)},
    )


def _assumed(robot: Robot, at: int) -> dict[str, Provenance]:
    """What is said of the compliances where joint ``at`` (from 0) was added: its own are assumed in every set."""
    words = f"; joint {at + 1} was added, its compliance is assumed"
    blocks = {block: found for block, found in robot.provenance.items() if block.partition(".")[0] == "compliance"}
    return {block: Provenance("assumed", found.source + words) for block, found in blocks.items()}


def _with_said(robot: Robot, words: str) -> dict[str, Provenance]:
    """Where the table and the limits come from, once they were changed."""
    changed = {block: robot.provenance[block] for block in TABLE_BLOCKS if block in robot.provenance}
    return {**robot.provenance, **{block: Provenance("user", said.source + words) for block, said in changed.items()}}


def in_other_convention(robot: Robot) -> Robot:
    """The same robot, its table written in the other Denavit-Hartenberg convention: every pose stays.

    A standard row ends with Rot(x, alpha) Trans(x, a), a modified one begins with them, so they move by one row. What
    then has no row goes into a frame: of a standard table the last link into the tool, of a modified one the first
    into the base. Hence every table of either kind has an equal one of the other.
    """
    alpha, a = robot.alpha, robot.a
    found = robot.provenance["geometry"]
    other = CONVENTIONS[robot.convention]
    if robot.convention == "standard":
        alpha, a = np.append(0.0, alpha[:-1]), np.append(0.0, a[:-1])
        frames = {"T_tool": _square(screw_x(robot.alpha[-1], robot.a[-1]) @ robot.T_tool)}
    else:
        alpha, a = np.append(alpha[1:], 0.0), np.append(a[1:], 0.0)
        frames = {"T_base": _square(robot.T_base @ screw_x(robot.alpha[0], robot.a[0]))}
    written = replace(found, source=f"{found.source}; rewritten as a {other} table, the same robot")
    return robot.replace(
        convention=other, alpha=alpha, a=a, provenance={**robot.provenance, "geometry": written}, **frames
    )


def read_in_other_convention(robot: Robot) -> Robot:
    """Another robot: the same numbers, read in the other Denavit-Hartenberg convention."""
    said = Provenance("user", f"read as a {CONVENTIONS[robot.convention]} table")
    return robot.replace(convention=CONVENTIONS[robot.convention], provenance={**robot.provenance, "geometry": said})


def _square(T: FloatArray) -> FloatArray:
    """T with its last row exact, which a product of transforms keeps."""
    T[3] = [0.0, 0.0, 0.0, 1.0]
    return T
