"""The project: one frozen value that holds everything a person decided, and its file.

The file is the set-up of ``io.projects`` with the tables ``[view]``, ``[maps]`` and ``[uncertainty]`` after it; a file
that lacks them, or a bare set-up, opens as well.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Container
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, get_type_hints

import numpy as np
import tomli_w

from robomill.arrays import FloatArray, digest
from robomill.errors import ProjectError
from robomill.identification.knowledge import Knowledge
from robomill.io.projects import load_setup, open_project, setup_to_toml
from robomill.io.samples import samples_dir
from robomill.io.tables import parse_toml
from robomill.paper import BOX, Point
from robomill.quantities import quantities
from robomill.robot.model import Robot
from robomill.simulation.setup import SimulationSetup
from robomill.workspace.quantities import COMPONENTS, map_quantities
from robomill.workspace.region import holds_paper_box

WHERE = "project file"
LARGEST = 1e6  # of any number that says how something is looked at, in SI
SUFFIX = ".robomill.toml"
DEFAULT_PRESET = "paper_flute"
COMPLIANCE = quantities(Robot)["C_theta_all"]
PRISMATIC_UNITS = {COMPLIANCE.unit: str(COMPLIANCE.sliding), "kN m/rad": "N/um"}  # as shown for joints that turn, slide


@dataclass(frozen=True)
class View:
    """How the project is looked at; saved with it, but not part of the history."""

    units: str = "mm"
    joint_unit: str = COMPLIANCE.unit
    exaggeration: float = 10.0
    station: float = 0.5
    camera: str = "iso"
    share_axis: str = "y"
    theta: tuple[float, ...] | None = None

    @property
    def length(self) -> str:
        """Unit of lengths and deviations, a key of ``UNITS``."""
        return self.units

    @property
    def feed(self) -> str:
        """Unit of feed rates."""
        return "in/min" if self.units == "in" else "mm/min"


@dataclass(frozen=True)
class MapView:
    """What the maps look at, SI throughout; None means "as robomill proposes for this robot".

    ``robot`` names the robot it was made for; ``factors`` (n,) are tried on the joints' stiffness.
    """

    robot: str = ""
    region: str = "largest"
    lower: Point = BOX[0]
    upper: Point = BOX[1]
    step: float | None = None
    A: float = 0.0
    B: float = 0.0
    normal: str = "z"
    at: float | None = None
    pair: tuple[float, float] | None = None
    point: Point | None = None
    quantity: str = "det_J"
    picture: str = "plane"
    level: float = 0.5
    sheet: str = "nine"
    component: str = "yy"
    one: str = "C_soft"
    shares: str = "direct"
    common: bool = True
    factors: tuple[float, ...] | None = None
    against: tuple[str, ...] = ()

    def of(self, robot: Robot) -> MapView:
        """This view where it was made for ``robot``, else a fresh one that keeps what suits any robot."""
        name = f"{robot.name}/{robot.n}"  # not its compliances, which are what one plays with
        if self.robot == name:
            return self
        region = "paper" if robot.n == 5 and holds_paper_box(robot) else "largest"
        return MapView(name, region, picture=self.picture, quantity=self.quantity, sheet=self.sheet)

    def stiffening(self, robot: Robot) -> FloatArray:
        """(n,) factors on the joints' stiffness; ones where nothing was asked."""
        if self.factors is None or len(self.factors) != robot.n:
            return np.ones(robot.n)
        return np.array(self.factors)


@dataclass(frozen=True, eq=False)
class Project:
    """The set-up, how it and its maps are looked at, the preset it began with, and what an identification knows."""

    setup: SimulationSetup
    view: View = field(default_factory=View)
    preset: str = DEFAULT_PRESET
    maps: MapView = field(default_factory=MapView)
    knowledge: Knowledge | None = None

    @property
    def known(self) -> Knowledge | None:
        """How sure the compliances in force are; None where they did not come from an identification.

        An edit or another set ends that, going back brings it again.
        """
        return self.knowledge if self.holds(self.setup) else None

    def holds(self, setup: SimulationSetup) -> bool:
        """Whether what is known is of the compliances of ``setup``."""
        return self.knowledge is not None and self.knowledge.holds_for(setup.robot, setup.springs)

    def replace(self, **fields: Any) -> Project:
        """A copy with fields replaced."""
        return dataclasses.replace(self, **fields)

    def digest(self) -> str:
        """Fingerprint of what is remembered for undo: everything but the looking."""
        return digest((self.setup.digest(), self.known))


def presets() -> list[str]:
    """Folder name of every sample with a set-up, the default first."""
    names = (path.parent.name for path in samples_dir().glob("*/setup.toml"))
    return sorted(names, key=lambda name: (name != DEFAULT_PRESET, name))


@lru_cache(maxsize=32)
def preset_setup(name: str) -> SimulationSetup:
    """The set-up of a sample folder, read once."""
    return load_setup(samples_dir() / name / "setup.toml")


def is_stiffness(unit: str) -> bool:
    """Whether the joints are shown by stiffness rather than compliance."""
    return unit in ("kN m/rad", "N/um")


_PART = re.compile(r"(?P<name>\w+)(?:\[(?P<index>[\d,\s]+)\])?$")


def read_field(value: Any, path: str) -> Any:
    """The field at ``path`` ("cutter.diameter", "T_MW[0,3]") of a nested value; an index picks one of an array."""
    for part in path.split("."):
        name, index = _split(part)
        value = getattr(value, name)
        if index is not None:
            value = np.asarray(value)[index].item()
    return value


def with_field(value: Any, path: str, new: Any) -> Any:
    """A copy of ``value`` with the field at ``path`` replaced; every level is checked again by its own class."""
    first, _, rest = path.partition(".")
    name, index = _split(first)
    if rest:
        new = with_field(getattr(value, name), rest, new)
    elif index is not None:
        array = np.array(getattr(value, name), dtype=float)
        array[index] = new
        new = array
    if hasattr(value, "replace"):
        return value.replace(**{name: new})
    return dataclasses.replace(value, **{name: new})


def _split(part: str) -> tuple[str, tuple[int, ...] | None]:
    match = _PART.match(part)
    if match is None:
        raise KeyError(f"not a field path: {part!r}")
    index = match["index"]
    return match["name"], None if index is None else tuple(int(i) for i in index.split(","))


def project_to_toml(project: Project) -> str:
    """The project as text that ``project_from_toml`` reads back to the same project."""
    tables: dict[str, Any] = {"view": {**_plain(project.view), "preset": project.preset}}
    if project.maps != MapView():
        tables["maps"] = _plain(project.maps)
    if project.known is not None:
        tables["uncertainty"] = project.known.to_table()
    return setup_to_toml(project.setup) + "\n" + tomli_w.dumps(tables)


def project_from_toml(text: str, view: View | None = None, maps: MapView | None = None) -> Project:
    """A project from its file; what the file does not say of the looking is as in ``view`` and ``maps``.

    Raises ProjectError with the reason.
    """
    data = parse_toml(text, WHERE)
    tables = {name: _table(data, name) for name in ("view", "maps", "uncertainty")}
    setup = open_project(data, WHERE)
    known = None
    if tables["uncertainty"] is not None:
        known = Knowledge.from_table(tables["uncertainty"], setup.robot, setup.springs, f"{WHERE}: [uncertainty]")
    seen = maps or MapView() if tables["maps"] is None else _looked(MapView, tables["maps"], "maps", setup.robot)
    if tables["view"] is None:
        return Project(setup, dataclasses.replace(view or View(), theta=None), maps=seen, knowledge=known)
    preset = tables["view"].pop("preset", "")
    looked = _looked(View, tables["view"], "view", setup.robot)
    return Project(setup, looked, preset if isinstance(preset, str) else "", seen, known)


def _table(data: dict[str, Any], name: str) -> dict[str, Any] | None:
    table = data.pop(name, None)
    if table is None or isinstance(table, dict):
        return table
    raise ProjectError(f"{WHERE}: [{name}] is not a table; remove it or save the project again.")


def _plain(value: Any) -> dict[str, Any]:
    return {k: v for k, v in dataclasses.asdict(value).items() if v is not None}


def _looked(kind: type, table: dict[str, Any], where: str, robot: Robot) -> Any:
    """A View or a MapView from its table; every value is checked against the type of its field."""
    hints = get_type_hints(kind)
    choices = {**CHOICES, ("maps", "quantity"): map_quantities(robot, "geometry")}
    for name, value in table.items():
        if name not in hints:
            raise ProjectError(f"{WHERE}: [{where}] has a key {name!r} that this robomill does not know; remove it.")
        good, table[name] = _fits(hints[name], value)
        if not good or table[name] not in choices.get((where, name), (table[name],)):
            raise ProjectError(f"{WHERE}: [{where}] {name} is {value!r:.40}; remove it or save the project again.")
    return kind(**table)


def _fits(hint: Any, value: Any) -> tuple[bool, Any]:
    """Whether a value of a TOML file is what a field of type ``hint`` holds, and that value."""
    number = isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < LARGEST
    kinds = {str: isinstance(value, str), bool: isinstance(value, bool), float: number, float | None: number}
    if hint in kinds:
        return kinds[hint], float(value) if number and hint is not bool else value
    inner = str if hint == tuple[str, ...] else float
    if not isinstance(value, list) or not all(_fits(inner, v)[0] for v in value):
        return False, value
    fixed = {Point: 3, Point | None: 3, tuple[float, float] | None: 2}.get(hint, len(value))
    return len(value) == fixed, tuple(map(inner, value))


# Words that a field of the view or the maps may hold, where they are few.
CHOICES: dict[tuple[str, str], Container[str]] = {
    ("view", "units"): ("mm", "in"),
    ("view", "joint_unit"): tuple(PRISMATIC_UNITS),
    ("view", "camera"): ("iso", "along", "top", "front"),
    ("view", "share_axis"): ("x", "y", "z"),
    ("maps", "region"): ("paper", "largest", "reach", "own"),
    ("maps", "normal"): ("x", "y", "z"),
    ("maps", "picture"): ("plane", "pair", "solid"),
    ("maps", "sheet"): ("nine", "one", "shares", "dominant", "lines", "compare"),
    ("maps", "shares"): ("direct", "cross"),
    ("maps", "component"): COMPONENTS,
}
