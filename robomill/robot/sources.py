"""Where the numbers of a changed robot come from: a block that was changed is of who changed it."""

from typing import Any

import numpy as np

from robomill.errors import RobotError
from robomill.provenance import GIVEN, Provenance, stated_blocks
from robomill.robot.arm import COMPLIANCE, USER_SET, Arm

BLOCKS = {
    "geometry": ("convention", "alpha", "a", "d", "theta_offset", "sign", "prismatic"),
    "lengths": ("a", "d"),
    "limits": ("limits_all",),
    "base": ("T_base",),
    "tool": ("T_tool",),
}
"""The fields whose numbers a block of a robot's provenance speaks for."""


def block_in_force(robot: Arm) -> str:
    """The block that speaks for the compliances in force."""
    return COMPLIANCE if robot.compliance_set == USER_SET else of_set(robot.compliance_set)


def of_set(name: str) -> str:
    """The block that speaks for a named compliance set."""
    return f"{COMPLIANCE}.{name}"


def is_of_robot(block: str) -> bool:
    """Whether a block speaks for numbers of a robot."""
    return block in BLOCKS or block.partition(".")[0] == COMPLIANCE


def stated_of_robot(said: Any) -> dict[str, Provenance]:
    """``said`` by blocks, as a person gives it of a robot. Raises RobotError, ArgumentError for an unknown block."""
    found = stated_blocks(said, RobotError)
    return stated_blocks(found, RobotError, (*BLOCKS, COMPLIANCE, *filter(is_of_robot, found)))


def changed_blocks(before: Arm, after: Arm) -> list[str]:
    """The blocks whose numbers differ between two robots; of the compliances those of sets of ``after``."""
    found = [
        block for block, names in BLOCKS.items() if not all(_same(getattr(before, n), getattr(after, n)) for n in names)
    ]
    sets = before.compliance_sets
    found += [of_set(n) for n, C in after.compliance_sets.items() if n not in sets or not _same(sets[n], C)]
    if after.compliance_set == USER_SET and not (
        before.compliance_set == USER_SET and _same(before.C_theta_all, after.C_theta_all)
    ):
        found.append(COMPLIANCE)
    return found


def changed_sources(before: Arm, after: Arm, mark: Provenance = GIVEN) -> dict[str, Provenance]:
    """What to say of the blocks of ``after`` that were changed by hand from those of ``before``.

    A table whose lengths have no word of their own is one block.
    """
    found = changed_blocks(before, after)
    return {block: mark for block in found if block != "lengths" or block in after.provenance}


def _same(one: Any, other: Any) -> bool:
    return bool(np.array_equal(one, other))
