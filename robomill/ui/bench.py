"""The bench: the load tests and the measured map of a project, and what a person decided about them.

A value of the project, so that undo, saving and autosave hold it; what is read from it, fitted and planned is found in
``ui.identification.bench`` and kept by what it depends on.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

from robomill.arrays import digest
from robomill.errors import ProjectError
from robomill.identification.fit.folds import LEAVE_OUT
from robomill.identification.fit.models import MODELS
from robomill.identification.fit.treatment import AUTO, BENDING_JOINTS, WEIGHTS, Treatment
from robomill.io.samples import samples_dir
from robomill.lazy import cached_property
from robomill.quantities import choice, quantity, settle, switch, whole
from robomill.spelled import Replaceable
from robomill.units import to_si

OWN = "own"
SAMPLES = {
    "nine_points": "Nine points, 81 equations",
    "tilted_bending_tool": "Tilted tool, links bend too",
    "grid_45x6": "Grid of 45 x 6 points",
    "nine_points_compliances": "Nine points as compliances",
    "one_joint_at_a_time": "One joint at a time",
    "cable_six_axis": "Cable on a six-axis arm, points misstated",
}
MAP_SAMPLES = {name: SAMPLES[name] for name in ("grid_45x6", "nine_points_compliances")}
SAMPLE_ROBOT = "slavkovic_5r"
SAMPLE_ROBOTS = {"cable_six_axis": "kuka_kr270"}  # the others were made for SAMPLE_ROBOT
AS_MADE, THE_PROJECTS = "as made", ""
MOST_KEPT = 2_000_000  # characters of tests, or of a map, that a project's file takes up


def _titles(words: Mapping[str, str]) -> dict[str, str]:
    return {code: said.capitalize() for code, said in words.items()}


@dataclass(frozen=True, eq=False)
class Bench(Replaceable):
    """Load tests and a measured map, each a sample or a person's own text, and how they are treated and used.

    robot: which one was measured, by name: that for which the sample was made, or the project's. ``bending``: joints at
    which links bend; ``excluded``: rows left out. ``goal`` to ``tilt``: what is measured next, a joint 0 is the one
    known least. ``band`` to ``length_unsure``: what bands are made of, one standard deviation each.
    """

    sample: str = choice("Load tests", {**SAMPLES, OWN: "Your own"}, default="nine_points")
    own_name: str = ""
    own_text: str = ""
    map_sample: str = choice("Measured compliances", {**MAP_SAMPLES, OWN: "Your own"}, default="grid_45x6")
    map_own_name: str = ""
    map_own_text: str = ""
    robot: str = AS_MADE
    model: str = choice("Flexible elements", {name: family.title for name, family in MODELS.items()}, default="joints")
    bending: tuple[int, ...] = BENDING_JOINTS
    bending_auto: bool = switch("Let the tests say where links bend", default=False)
    robust: bool = switch("Reduce weight of outliers", default=False)
    fit_points: str = choice(
        "Points fitted beside the compliances",
        {"none": "None: as stated", "force": "Load point", "gauge": "Gauge point", "both": "Load and gauge point"},
        default="none",
    )
    weights: str = choice("What counts how much", _titles(WEIGHTS), default="equal")
    leave_out: str = choice("Left out together", _titles(LEAVE_OUT), default="pose")
    excluded: tuple[int, ...] = ()
    goal: str = choice(
        "Make more certain", {"joint": "One joint", "all": "All of them", "path": "The project's cut"}, default="joint"
    )
    goal_joint: int = whole("Joint", least=0, default=0)
    count: int = whole("More tests", least=1, most=30, default=3)
    load: float = quantity("Load", "N", least=1.0, most=5000.0, digits=0, default=250.0)
    tilt: float = quantity(
        "Tilt up to", "deg", least=0.0, most=to_si(90.0, "deg"), digits=0, default=to_si(30.0, "deg")
    )
    band: str = choice(
        "Band", {"model": "Noise and error of the model", "noise": "Noise of the fit only"}, default="model"
    )
    force_unsure: float = quantity("Force known to ±", "N", least=0.0, most=1000.0, digits=0, default=0.0)
    length_unsure: float = quantity("Link lengths to ±", "mm", least=0.0, most=0.05, digits=2, default=0.0)

    def __post_init__(self) -> None:
        settle(self, ProjectError, "Load tests")

    @property
    def text(self) -> str:
        """The load tests as they are read."""
        return self.own_text if self.sample == OWN else sample_text(self.sample)

    @property
    def name(self) -> str:
        """What the load tests are called."""
        return self.own_name if self.sample == OWN else f"{self.sample}.csv"

    @property
    def title(self) -> str:
        """What the screen calls the load tests: a sample by what it is, a file by its name."""
        return self.own_name if self.sample == OWN else SAMPLES[self.sample]

    @property
    def map_text(self) -> str:
        """The measured map as it is read."""
        return self.map_own_text if self.map_sample == OWN else sample_text(self.map_sample)

    @property
    def map_title(self) -> str:
        """What the screen calls the map."""
        return self.map_own_name if self.map_sample == OWN else MAP_SAMPLES[self.map_sample]

    @property
    def map_name(self) -> str:
        """What the measured map is called."""
        return self.map_own_name if self.map_sample == OWN else f"{self.map_sample}.csv"

    @property
    def treatment(self) -> Treatment:
        """How the tests are fitted, whichever the model: where links bend, what weighs less, what is left out."""
        bending = AUTO if self.bending_auto else self.bending
        return Treatment(bending, self.fit_points, self.robust, self.excluded, self.weights, self.leave_out)

    def robot_name(self, project: str) -> str:
        """Which robot was measured, "" for the project's own, whose name is ``project``."""
        if self.robot != AS_MADE:
            return self.robot
        made_for = project if self.sample == OWN else SAMPLE_ROBOTS.get(self.sample, SAMPLE_ROBOT)
        return THE_PROJECTS if project == made_for else made_for

    def with_sample(self, sample: str) -> Bench:
        """A sample and the robot that it was made for; what was left out of other tests is forgotten."""
        if sample == OWN:
            return self
        return self.replace(sample=sample, own_name="", own_text="", robot=AS_MADE, excluded=(), fit_points="none")

    def with_tests(self, text: str, name: str, project: str) -> Bench:
        """A person's own tests of the robot in force; what was left out of other tests is forgotten."""
        new = {"sample": OWN, "own_name": name, "own_text": text, "robot": self.robot_name(project)}
        return self.replace(**new, excluded=(), fit_points="none")

    def with_map_sample(self, sample: str) -> Bench:
        """A sample of a measured map."""
        return self if sample == OWN else self.replace(map_sample=sample, map_own_name="", map_own_text="")

    def with_map(self, text: str, name: str) -> Bench:
        """A person's own measured map."""
        return self.replace(map_sample=OWN, map_own_name=name, map_own_text=text)

    def kept(self) -> Bench:
        """As a file takes it up: texts that are too long for it are left out."""
        long = [name for name in ("own_text", "map_own_text") if len(getattr(self, name)) > MOST_KEPT]
        return self.replace(**dict.fromkeys(long, "")) if long else self

    def digest(self) -> str:
        """Fingerprint of all of it."""
        return self._digest

    @cached_property
    def _digest(self) -> str:
        return digest(self)


@lru_cache(maxsize=len(SAMPLES))
def sample_text(sample: str) -> str:
    """The text of a sample of load tests."""
    return (samples_dir() / "load_tests" / f"{sample}.csv").read_text(encoding="utf-8")
