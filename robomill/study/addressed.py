"""A set-up as tables, and any number of it by the key it has in files: of the set-up, of its robot, of its material.

    cutter.diameter_mm    part.zero_mm[2]    robot.joint[2].a_mm    force.material.coefficients.Ktc_N_mm2

Entries of lists are counted from 1, as joints are. The readers of these files check what comes out, so that a key has
no meaning here that it has not there. One key stands in no file: ``path.feed_percent`` is every feed of the path, in
per cent of what it is.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping
from typing import Any

import tomli_w

from robomill.errors import RobomillError, StudyError
from robomill.improve.ways import fed
from robomill.io.materials import material_to_toml
from robomill.io.robot.writer import robot_to_toml
from robomill.io.setups.projects import setup_from_table, setup_to_toml
from robomill.io.tables import parse_toml
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.source import PointsSource
from robomill.units import to_si

Data = dict[str, Any]
NAMES = ("name", "compliance_set")  # of [robot] in the set-up's own file
ROBOT, MATERIAL = "definition", "material_definition"  # keys that hold a file as text
FEED = "path.feed_percent"
FASTEST = 1000.0  # % of the feed
_PART = re.compile(r"([^\[\].\s]+)((?:\[\d+\])*)")


def parts_of(key: str) -> list[str | int]:
    """A key taken apart: names, and 0-based places in lists. Raises StudyError for one that is none."""
    found: list[str | int] = []
    for word in key.split("."):
        part = _PART.fullmatch(word)
        if part is None:
            raise StudyError(
                f"Parameter {key!r:.80}: expected a key as cutter.diameter_mm or part.zero_mm[2].", where=key
            )
        found.append(part[1])
        for number in re.findall(r"\d+", part[2]):
            if number.strip("0") == "":
                raise StudyError(f"Parameter {key!r:.80}: entries of a list are counted from 1.", where=key)
            found.append(int(number) - 1)
    return found


def tables_of(setup: SimulationSetup, keys: list[str]) -> Data:
    """The set-up as the tables of its file, complete in themselves; the robot's and the material's own where one of
    ``keys`` is in them."""
    data = parse_toml(setup_to_toml(setup), "set-up", exact=True)
    data.pop("uncertainty", None)  # of the compliances as they are, which a parameter may change
    split = [parts_of(key) for key in keys]
    if any(parts[0] == "robot" and parts[1:2] and parts[1] not in NAMES for parts in split):
        robot = parse_toml(robot_to_toml(setup.robot), "robot")
        data["robot"] = {ROBOT: _in_force(robot, keys)}
    if any(parts[:2] == ["force", "material"] and len(parts) > 2 for parts in split):
        material = getattr(setup.force, "material", None)
        if material is None:
            raise StudyError("Parameter force.material: the force of this set-up is not computed from a material.")
        force = {key: value for key, value in data["force"].items() if key != "material"}
        data["force"] = {**force, MATERIAL: parse_toml(material_to_toml(material), "material", exact=True)}
    return data


def _in_force(robot: Data, keys: list[str]) -> Data:
    """The robot's tables; compliances addressed beside the sets are those in force, without a set's name."""
    compliance, own = robot["compliance"], [key for key in keys if key.startswith("robot.compliance.")]
    names = {part for key in own for part in parts_of(key)[2:3]}
    if names and not names & set(compliance) - {"use"} and compliance.get("use") in compliance:
        robot["compliance"] = dict(compliance[compliance["use"]])
    return robot


def changed(data: Data, values: Mapping[str, Any]) -> SimulationSetup:
    """The set-up with numbers changed by their keys. Raises what the readers of its files raise."""
    made = copy.deepcopy(data)
    for key, value in values.items():
        if key != FEED:
            _put(made, key, value)
    for table, key in ((made["robot"], ROBOT), (made["force"], MATERIAL)):
        if isinstance(table.get(key), dict):
            table[key] = tomli_w.dumps(table[key])
    setup = setup_from_table(made, "set-up")
    return _fed(setup, values[FEED]) if FEED in values else setup


def _fed(setup: SimulationSetup, percent: Any) -> SimulationSetup:
    """The set-up with every feed so many per cent of what it is."""
    if isinstance(percent, bool) or not isinstance(percent, int | float) or not 0.0 < percent <= FASTEST:
        raise StudyError(
            f"Parameter {FEED}: found {percent!r:.40}; expected a number above 0, at most {FASTEST:g}.", where=FEED
        )
    if percent == 100.0:
        return setup
    source = PointsSource(fed(setup.toolpath, float(to_si(percent, "%"))), setup.source.name)
    return setup.replace(source=source, stock=setup.stock_block, provenance=dict(setup.provenance))


def value_at(data: Data, key: str) -> Any:
    """The number, list or table that stands at a key. Raises StudyError where nothing does."""
    here, last = _holder(data, key)
    if isinstance(here, dict) and isinstance(last, str):
        if last not in here:
            raise StudyError(f"Parameter {key}: nothing stands there.", where=key)
        return here[last]
    _entry(here, last, key)
    return here[last]


def _put(data: Data, key: str, value: Any) -> None:
    here, last = _holder(data, key)
    if isinstance(here, dict) and isinstance(last, str):
        if isinstance(here.get(last), dict | list):
            raise StudyError(
                f"Parameter {key}: it is a table or a list; name one number of it, as {key}[1].", where=key
            )
        here[last] = value
    else:
        _entry(here, last, key)
        here[last] = value


def _holder(data: Data, key: str) -> tuple[Any, str | int]:
    """The table or list in which a key's last part stands, and that part."""
    parts = parts_of(key)
    inner: list[str | int] = parts
    if parts[0] == "robot" and isinstance(data["robot"].get(ROBOT), dict):
        inner = ["robot", ROBOT, *parts[1:]]
    elif parts[:2] == ["force", "material"] and isinstance(data["force"].get(MATERIAL), dict):
        inner = ["force", MATERIAL, *parts[2:]]
    here: Any = data
    for part in inner[:-1]:
        if isinstance(here, dict) and isinstance(part, str):
            here = here.setdefault(part, {})
        else:
            here = _entry(here, part, key)
    return here, inner[-1]


def _entry(here: Any, part: str | int, key: str) -> Any:
    """An entry of a list; a StudyError where there is none."""
    if isinstance(here, list) and isinstance(part, int) and part < len(here):
        return here[part]
    if isinstance(here, list):
        said = (
            f"the list has {len(here)} entries"
            if isinstance(part, int)
            else "it is a list: name an entry of it, as [1]"
        )
    else:
        said = f"nothing is within {part!r} there" if isinstance(part, str) else "it is no list"
    raise StudyError(f"Parameter {key}: {said}.", where=key)


def checked(data: Data, key: str, values: list[Any]) -> None:
    """Refuse a key that a file does not have, or values of another kind than it takes there; a number that is merely
    out of bounds somewhere fails its own points."""
    refusals = []
    for value in values:
        try:
            changed(data, {key: value})
            return
        except StudyError:
            raise
        except RobomillError as refused:
            refusals.append(str(refused))
    raise StudyError(f"Parameter {key}: {refusals[0]}", where=key)
