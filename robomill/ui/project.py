"""The project: one frozen value that holds everything a person decided, and its file.

The file is the set-up of ``io.setups.projects`` with the tables ``[view]``, ``[maps]``, ``[experiments]`` and
``[uncertainty]``; a file that lacks them, or a bare set-up, opens as well.
"""

from __future__ import annotations

import dataclasses
import re
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
import tomli_w

from robomill.arrays import FloatArray, digest
from robomill.compliance.components import COMPONENTS
from robomill.errors import ProjectError, RobomillError
from robomill.files import SETUP
from robomill.identification.knowledge import Knowledge
from robomill.io.declared import from_table, to_table
from robomill.io.samples import samples_dir
from robomill.io.setups.knowledge import knowledge_from_table
from robomill.io.setups.projects import OF_THE_APP, load_setup, open_project, setup_to_toml
from robomill.io.tables import Table, parse_toml, shown
from robomill.io.texts import read_text
from robomill.paper import BOX
from robomill.quantities import choice, quantities, quantity as number, settle, switch
from robomill.robot.model import Robot
from robomill.robot.stiffness import COMPLIANCE, JOINT_UNITS
from robomill.simulation.setup import SimulationSetup
from robomill.spelled import Replaceable
from robomill.ui.bench import Bench
from robomill.units import in_lengths, unit_label
from robomill.viz.rendered.picture import CAMERAS
from robomill.workspace.quantities import map_quantities
from robomill.workspace.region import holds_paper_box

WHERE = "project file"
SUFFIX = ".robomill.toml"
MAX_PROJECT_MB = 25
DEFAULT_PRESET = "paper_flute"
PLACE: dict[str, Any] = {"unit": "mm", "shape": (3,), "axes": tuple("XYZ"), "digits": 2}  # in {M}
TILT: dict[str, Any] = {"unit": "deg", "default": 0.0}


@dataclass(frozen=True, eq=False)
class View:
    """How the project is looked at; saved with it, but not part of the history."""

    units: str = choice("Lengths", {"mm": "mm", "in": "inch"}, default="mm")
    joint_unit: str = choice(
        "Joint compliance", {unit: unit_label(unit) for unit in JOINT_UNITS}, default=COMPLIANCE.unit
    )
    exaggeration: float = number("Exaggeration", least=0.0, most=1e6, default=10.0)
    station: float = number("Station", least=0.0, most=1.0, default=0.5)
    camera: str = choice("Camera", CAMERAS, default="iso")
    share_axis: str = choice("Shares of", {axis: f"in {axis.upper()}" for axis in "xyz"}, default="y")
    push: str = choice(
        "Force on the tool",
        {"cut": "As in this cut", **{axis: f"100 N along {axis.upper()}" for axis in "xyz"}},
        default="cut",
    )
    theta: FloatArray | None = number("Joint angles", shape=(None,), optional=True)
    beside: str = ""  # what it is held against, as ``ui.other`` says it

    def __post_init__(self) -> None:
        settle(self, ProjectError, "View")

    @property
    def length(self) -> str:
        """Unit of lengths and deviations, a key of ``UNITS``."""
        return self.units

    @property
    def feed(self) -> str:
        """Unit of feed rates."""
        return self.of("mm/min")

    def of(self, unit: str) -> str:
        """The unit, a key of ``UNITS``, in which a quantity of ``unit`` is shown: ``view.of("um/N")``."""
        return in_lengths(unit, self.units)


@dataclass(frozen=True, eq=False)
class MapView:
    """What the maps look at, SI throughout; None means "as robomill proposes for this robot".

    ``robot`` names the robot it was made for; ``factors`` (n,) are tried on the joints' stiffness.
    """

    robot: str = ""
    region: str = choice(
        "Region",
        {
            "paper": "Reference box (Slavkovic 2013)",
            "cut": "Around the cut",
            "largest": "Largest box in reach",
            "reach": "Everything in reach",
            "own": "My own numbers",
        },
        default="largest",
    )
    lower: FloatArray = number("From", default=BOX[0], **PLACE)
    upper: FloatArray = number("To", default=BOX[1], **PLACE)
    step: float | None = number("Step", "mm", above=0.0, digits=2, optional=True)
    A: float = number("Tilt A", **TILT)
    B: float = number("Tilt B", **TILT)
    normal: str = choice("Plane", {"z": "XY", "y": "XZ", "x": "YZ"}, default="z")
    at: float | None = number("Plane at", "mm", optional=True)
    pair: FloatArray | None = number("Planes at", "mm", shape=(2,), optional=True)
    point: FloatArray | None = number("At", optional=True, **PLACE)
    quantity: str = "det_J"
    picture: str = choice("Picture", {"plane": "Plane", "pair": "Two planes", "solid": "3-D"}, default="plane")
    level: float = number("Cells from", least=0.0, most=1.0, default=0.5)
    sheet: str = choice(
        "Picture",
        {
            "nine": "3 × 3 maps",
            "one": "One map",
            "shares": "By joint",
            "dominant": "Largest contributor",
            "lines": "Path lines",
            "compare": "Compare",
        },
        default="nine",
    )
    component: str = choice("Component", {c: f"C_{c}" for c in COMPONENTS}, default="yy")
    one: str = "C_soft"
    shares: str = choice("Components", {"direct": "Direct terms", "cross": "Cross terms"}, default="direct")
    common: bool = switch("One scale for all nine maps", default=False)
    factors: FloatArray | None = number("Times its stiffness", shape=(None,), above=0.0, optional=True)
    against: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        settle(self, ProjectError, "Maps")

    def of(self, robot: Robot) -> MapView:
        """This view where it was made for ``robot``, else a fresh one that keeps what suits any robot."""
        name = f"{robot.name}/{robot.n}"  # not its compliances, which are what one plays with
        if self.robot == name:
            return self
        region = "paper" if robot.n == 5 and holds_paper_box(robot) else "cut" if robot.n >= 5 else "largest"
        return MapView(name, region, picture=self.picture, quantity=self.quantity, sheet=self.sheet)

    def stiffening(self, robot: Robot) -> FloatArray:
        """(n,) factors on the joints' stiffness; ones where nothing was asked."""
        if self.factors is None or len(self.factors) != robot.n:
            return np.ones(robot.n)
        return np.array(self.factors)


@dataclass(frozen=True, eq=False)
class Project(Replaceable):
    """The set-up, how it and its maps are looked at, the preset it began with, load tests and what they let know."""

    setup: SimulationSetup
    view: View = field(default_factory=View)
    preset: str = DEFAULT_PRESET
    maps: MapView = field(default_factory=MapView)
    knowledge: Knowledge | None = None
    bench: Bench = field(default_factory=Bench)

    @property
    def known(self) -> Knowledge | None:
        """How sure the compliances in force are; None where they did not come from an identification.

        An edit or another set ends that, going back brings it again.
        """
        return self.knowledge if self.holds(self.setup) else None

    def holds(self, setup: SimulationSetup) -> bool:
        """Whether what is known is of the compliances of ``setup``."""
        return self.knowledge is not None and self.knowledge.holds_for(setup.robot, setup.springs)

    def digest(self) -> str:
        """Fingerprint of what is remembered for undo: everything but the looking."""
        return digest((self.setup.digest(), self.known, self.bench.digest()))


@lru_cache(maxsize=1)
def presets() -> tuple[str, ...]:
    """Folder name of every sample with a set-up, the default first."""
    names = (path.parent.name for path in samples_dir().glob("*/setup.toml"))
    return tuple(sorted(names, key=lambda name: (name != DEFAULT_PRESET, name)))


@lru_cache(maxsize=32)
def preset_setup(name: str) -> SimulationSetup:
    """The set-up of a sample folder, read once."""
    return load_setup(samples_dir() / name / "setup.toml")


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
    tables: dict[str, Any] = {"view": {**to_table(project.view), "preset": project.preset}}
    if project.maps.robot:
        tables["maps"] = to_table(project.maps)
    if project.bench.digest() != Bench().digest():
        tables["experiments"] = to_table(project.bench.kept())
    return setup_to_toml(project.setup, project.known) + "\n" + tomli_w.dumps(tables)


def project_from_toml(
    text: str, view: View | None = None, maps: MapView | None = None, bench: Bench | None = None
) -> Project:
    """A project from its file; what a bare set-up does not say is as in ``view``, ``maps`` and ``bench``.

    Raises ProjectError with the reason.
    """
    data = parse_toml(text, WHERE, exact=True)
    own = {name: Table(data.pop(name), f"{WHERE}, [{name}]") for name in (*OF_THE_APP, "uncertainty") if name in data}
    setup = open_project(data, WHERE)
    known = None
    if "uncertainty" in own:
        known = knowledge_from_table(own["uncertainty"], setup.robot, setup.springs)
    seen = maps or MapView()
    if "maps" in own:
        _in_units(own["maps"])
        own["maps"].choice("quantity", tuple(map_quantities(setup.robot, "geometry")), seen.quantity)
        seen = from_table(own["maps"], MapView)
    if "view" not in own:
        looked = dataclasses.replace(view or View(), theta=None)
        return Project(setup, looked, "", seen, known, bench or Bench())
    preset = own["view"].text("preset", "")
    bench = from_table(own["experiments"], Bench) if "experiments" in own else Bench()
    return Project(setup, from_table(own["view"], View), preset, seen, known, bench)


def project_from_file(data: bytes, name: str, now: Project) -> Project:
    """The project in a file that somebody brings; what a bare set-up does not say is as in ``now``.

    Raises ProjectError with the reason.
    """
    text = read_text(data, ProjectError, SETUP, name)[0]
    try:
        return project_from_toml(text, now.view, now.maps, now.bench)
    except RobomillError as exc:
        raise ProjectError(f"{name} was not opened. {exc} Your project is as it was.") from None


def _in_units(table: Table) -> None:
    """Files of older versions have what the maps look at in SI, without a unit in the key."""
    for said in quantities(MapView).values():
        if said.name != said.key and said.name in table.data:
            old = table.data.pop(said.name)
            listed = old if isinstance(old, list) else [old]
            if all(isinstance(number, int | float) and not isinstance(number, bool) for number in listed):
                listed = [shown(number, said.unit) for number in listed]
            table.data[said.key] = listed if isinstance(old, list) else listed[0]
