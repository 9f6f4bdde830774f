"""Where the numbers of a changed set-up come from: a block that was changed is of who changed it, and a force that was
measured on one cut is an assumption on another. One law for the library, the command line and the app."""

from collections.abc import Collection, Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any, Protocol

import numpy as np

from robomill.arrays import digest
from robomill.cutting.tool import Cutter
from robomill.errors import SetupError
from robomill.provenance import BY_HAND, GIVEN, Provenance, stated_blocks
from robomill.quantities import quantities
from robomill.robot.model import Robot
from robomill.robot.sources import BLOCKS as ROBOT_BLOCKS, changed_blocks, is_of_robot

BLOCKS = {
    "source": "path",
    "T_MW": "part",
    "cutter": "cutter",
    "force": "force",
    "stock": "stock",
    "tools": "tools",
    **dict.fromkeys(("tolerance", "floor_tolerance", "feed_tolerance"), "tolerance"),
}
"""The block of a set-up's provenance that speaks for a field."""
KNOWN = (*dict.fromkeys(BLOCKS.values()), "measured_map")
"""All blocks of a set-up's own; what is of its robot may be said there, too (``is_of_robot``)."""
UNSTATED_TOLERANCE = Provenance("assumed", "nobody has stated one")
AROUND = Provenance("computed", "a block around what the path cuts")
OF_ONE_CUT = ("paper", "measured")
NOT_CUTTING = ("flute_length", "stick_out")  # what of a cutter the force does not depend on
OF_THE_ARM = ("geometry", "lengths", "base", "tool")


class Sourced(Protocol):
    """What of a set-up its sources rest on."""

    @property
    def name(self) -> str: ...
    @property
    def robot(self) -> Robot: ...
    @property
    def cutter(self) -> Cutter: ...
    @property
    def force(self) -> Any: ...
    @property
    def measured_map(self) -> Any: ...
    @property
    def provenance(self) -> Mapping[str, Provenance]: ...


def stated(said: Any) -> dict[str, Provenance]:
    """``said`` by blocks, as a person gives it of a set-up. Raises SetupError, ArgumentError for an unknown block."""
    found = stated_blocks(said, SetupError)
    return stated_blocks(found, SetupError, (*KNOWN, *filter(is_of_robot, found), *ROBOT_BLOCKS))


def changed_sources(setup: Sourced, changes: Mapping[str, Any], mark: Provenance = GIVEN) -> dict[str, Provenance]:
    """The provenance of ``setup`` with ``changes`` of its fields, whose numbers are then ``mark``.

    What is given anew as it was keeps its source, save an assumption, which somebody states by giving it. A force
    speaks for itself where it knows its source (a record, a material's row). A force of the paper, or a measured one,
    that is kept beside another path or cutter is carried over: assumed; likewise a map of compliances beside another
    arm. Of another robot, its own words count.
    """
    said = dict(setup.provenance)
    anew = [name for name in BLOCKS if name in changes and _anew(getattr(setup, name), changes[name], said, name)]
    said |= {BLOCKS[name]: mark for name in anew}
    if "cutter" in anew:
        said["cutter"] = unstated(changes["cutter"]) or mark
    if "stock" in anew and changes["stock"] is None:
        said["stock"] = AROUND
    if "force" in anew:
        said["force"] = _of_force(setup.force, changes["force"]) or mark
    elif "source" in anew or ("cutter" in anew and _cuts_otherwise(setup.cutter, changes["cutter"])):
        force = said.get("force", setup.force.provenance)
        if force.kind in OF_ONE_CUT:
            said["force"] = carried(force, setup.name)
    _of_robot(setup, changes, said)
    return said


def carried(said: Provenance, name: str) -> Provenance:
    """What was stated in ``name``, an assumption elsewhere, with nobody asked whether it holds there."""
    return replace(said.carried(name), carried_from="")


def unstated(cutter: Any, names: Collection[str] | None = None) -> Provenance | None:
    """What is assumed of a cutter of which not all was given: its numbers ``names``, or those it knows; None else."""
    left_out = getattr(cutter, "unstated", ()) if names is None else names
    if not isinstance(cutter, Cutter) or not left_out:
        return None
    declared = (quantities(Cutter)[name] for name in left_out)
    numbers = [f"{each.label.lower()} {each.short(getattr(cutter, each.name))}" for each in declared]
    return Provenance("assumed", f"nobody has stated {' and '.join(numbers)}")


def _anew(old: Any, new: Any, said: Mapping[str, Provenance], name: str) -> bool:
    """Whether a field was given another value, or an assumption was stated."""
    if old is new:
        return False
    before = said.get(BLOCKS[name])
    if before is not None and before.kind == "assumed":
        return True
    if isinstance(old, np.ndarray | float):
        return not np.array_equal(old, new)
    return type(old) is not type(new) or digest(old) != digest(new)


def _cuts_otherwise(old: Cutter, new: Any) -> bool:
    """Whether the force on a cutter may be another one."""
    plain = dict.fromkeys(NOT_CUTTING)
    return not isinstance(new, Cutter) or old.replace(**plain) != new.replace(**plain)


def _of_force(old: Any, new: Any) -> Provenance | None:
    """What a force says of itself; None where it was typed."""
    own: Provenance | None = getattr(new, "provenance", None)
    typed = is_dataclass(new) and "provenance" in {each.name for each in fields(new)}
    return None if typed and own in (BY_HAND, old.provenance) else own


def _of_robot(setup: Sourced, changes: Mapping[str, Any], said: dict[str, Provenance]) -> None:
    """Drop from ``said`` what was said of another robot's numbers, or of another map's."""
    robot = changes.get("robot")
    if "measured_map" in changes and changes["measured_map"] is not setup.measured_map:
        said.pop("measured_map", None)
    if not isinstance(robot, Robot) or robot is setup.robot:
        return
    another, changed = robot.name != setup.robot.name, changed_blocks(setup.robot, robot)
    for block in [block for block in said if is_of_robot(block) and (another or block in changed)]:
        said.pop(block)
    known = setup.measured_map
    if known is not None and "measured_map" not in changes and (another or {*OF_THE_ARM} & {*changed}):
        found = said.get("measured_map", known.provenance)
        if found.kind in OF_ONE_CUT:
            said["measured_map"] = carried(found, setup.robot.name)
