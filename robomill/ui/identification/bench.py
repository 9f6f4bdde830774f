"""The bench: load tests and the choices made about them, one plain session entry beside the project.

The text of the tests is the truth; what is read from it, fitted and planned is kept by what it depends on, in the
session only (uploads are a person's own) and bounded. A text that is refused stays as it was typed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.errors import LoadTestError
from robomill.identification.comparison import Comparison, compare_models
from robomill.identification.estimate import identify
from robomill.identification.laboratory import MAX_LOAD, Laboratory
from robomill.identification.lines_of_pull import LinesOfPull, lines_of_pull
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.measured_field import MeasuredField
from robomill.identification.result import IdentificationResult
from robomill.identification.treatment import AUTO, Treatment
from robomill.io.load_tests import read_load_tests, read_measured_map
from robomill.io.robots import load_robot
from robomill.io.samples import samples_dir
from robomill.paper import SLOT
from robomill.robot.model import Robot
from robomill.ui import session

Value = TypeVar("Value")

KEY = "identification.bench"
REMEMBERED = 24
SAMPLE_ROBOT = "slavkovic_5r"
SAMPLES = {
    "nine_points": "Nine points, 81 equations",
    "tilted_bending_tool": "Tilted tool, links bend too",
    "grid_45x6": "Grid of 45 x 6 points",
    "nine_points_compliances": "Nine points as compliances",
    "one_joint_at_a_time": "One joint at a time",
    "cable_six_axis": "Cable on a six-axis arm, points misstated",
}
SAMPLE_ROBOTS = {"cable_six_axis": "kuka_kr270"}  # the others were made for SAMPLE_ROBOT
MAP_SAMPLES = {"grid_45x6": SAMPLES["grid_45x6"], "nine_points_compliances": SAMPLES["nine_points_compliances"]}


@dataclass(frozen=True)
class Trial:
    """What is measured next in the laboratory: X, Y, Z, A, B (m, rad), the axis of {M} pushed along, the load in N."""

    pose: tuple[float, ...] = (*SLOT.point, 0.0, 0.0)
    axis: str = "Y"
    load: float = 250.0

    def __post_init__(self) -> None:
        if not 0 < self.load <= MAX_LOAD:
            raise LoadTestError(f"Load: found {self.load:g} N, expected more than 0 and at most {MAX_LOAD:g} N.")

    @property
    def F(self) -> FloatArray:
        """(3,) N in {M}."""
        return np.eye(3)["XYZ".index(self.axis)] * self.load


@dataclass(eq=False)
class Bench:
    """Text and name of the tests, the model asked for, what was left out, the plan's goal; ``sample`` "" if own.

    robot_name "": the project's robot; seen_robot: its name when last looked. Lengths m, angles rad, forces N.
    ``revision`` counts changes of the text.
    """

    text: str = ""
    name: str = ""
    sample: str = ""
    revision: int = 0
    robot_name: str = ""
    seen_robot: str = ""
    model: str = "joints"
    bending: tuple[int, ...] = (2, 3)
    bending_auto: bool = False
    fit_points: str = "none"
    weights: str = "equal"
    leave_out: str = "pose"
    robust: bool = False
    excluded: tuple[int, ...] = ()
    goal: str = "joint"
    goal_joint: int = 0
    count: int = 3
    load: float = 250.0
    tilt: float = 0.5235987755982988
    band: str = "model"
    force_unsure: float = 0.0
    length_unsure: float = 0.0
    map_text: str = ""
    map_name: str = ""
    map_sample: str = ""
    map_revision: int = 0
    laboratory: Laboratory | None = None
    trial: Trial = Trial()
    handed_in: bool = False
    memory: dict[Any, Any] = field(default_factory=dict, repr=False)

    @property
    def treatment(self) -> Treatment:
        """How the tests are fitted, whichever the model: where links bend, what weighs less, what is left out."""
        bending = AUTO if self.bending_auto else self.bending
        return Treatment(bending, self.fit_points, self.robust, self.excluded, self.weights, self.leave_out)

    def remembered(self, key: Any, make: Callable[[], Value]) -> Value:
        """``make()``, once for each ``key``; the oldest of ``REMEMBERED`` is forgotten. Refusals are not kept."""
        if key not in self.memory:
            made = make()
            while len(self.memory) >= REMEMBERED:
                del self.memory[next(iter(self.memory))]
            self.memory[key] = made
        found: Value = self.memory[key]
        return found

    def writer(self, name: str) -> Callable[[Any], None]:
        """What an input calls with its new value for ``name``."""
        return lambda value: setattr(self, name, value)

    def take(self, text: str, name: str, sample: str = "") -> None:
        """Put other tests on the bench; what was left out of the old ones is forgotten."""
        self.text, self.name, self.sample = text, name, sample
        self.revision += 1
        self.excluded, self.fit_points = (), "none"

    def take_map(self, text: str, name: str, sample: str = "") -> None:
        """Put another measured map on the bench."""
        self.map_text, self.map_name, self.map_sample = text, name, sample
        self.map_revision += 1


def bench() -> Bench:
    """The bench of this session; the first call lays the nine-point sample on it."""
    held: Bench | None = session.kept(KEY)
    if held is None:
        held = Bench()
        take_sample(held, "nine_points")
        held.take_map(sample_text("grid_45x6"), "grid_45x6.csv", "grid_45x6")
        session.keep(KEY, held)
    if held.sample and held.seen_robot != session.project().setup.robot.name:
        _sample_robot(held)
    return held


def take_sample(bench: Bench, sample: str) -> None:
    """Put a sample on the bench, with the robot that it was made for."""
    bench.take(sample_text(sample), f"{sample}.csv", sample)
    _sample_robot(bench)


def _sample_robot(bench: Bench) -> None:
    bench.seen_robot = session.project().setup.robot.name
    made_for = SAMPLE_ROBOTS.get(bench.sample, SAMPLE_ROBOT)
    bench.robot_name = "" if bench.seen_robot == made_for else made_for


@st.cache_data(max_entries=8, show_spinner=False)
def sample_text(sample: str) -> str:
    """The text of a sample of load tests."""
    return (samples_dir() / "load_tests" / f"{sample}.csv").read_text(encoding="utf-8")


def robot_of(bench: Bench) -> Robot:
    """The robot that was measured: the project's, or a preset."""
    return load_robot(bench.robot_name) if bench.robot_name else session.project().setup.robot


def tests_of(bench: Bench, robot: Robot) -> LoadTests | JointTests:
    """The tests as read, their poses checked against the robot. Raises LoadTestError with row and column."""
    # The line end makes a single typed line a text, never the name of a file on this machine.
    return bench.remembered(
        ("tests", bench.revision, robot.digest()), lambda: read_load_tests(bench.text + "\n", robot)
    )


def fit_of(bench: Bench, robot: Robot) -> IdentificationResult:
    """The fit of the model asked for. Raises LoadTestError."""
    tests = tests_of(bench, robot)

    def fit() -> IdentificationResult:
        with st.spinner("Fitting, and predicting what was left out …"):
            return identify(robot, tests, bench.model, bench.treatment)

    return bench.remembered(("fit", _choices(bench, robot), bench.model), fit)


def comparison_of(bench: Bench, robot: Robot) -> Comparison:
    """Every model fitted to the same tests, bending at the joints that are named. Raises LoadTestError."""
    tests = tests_of(bench, robot)
    if tests.single:
        raise LoadTestError(
            "One joint at a time shows nothing but joints: models are compared on displacements of the tool."
        )
    treatment = replace(bench.treatment, bending=bench.bending)
    return bench.remembered(
        ("models", _choices(bench, robot)), lambda: compare_models(robot, tests, treatment=treatment)
    )


def field_of(bench: Bench, robot: Robot) -> MeasuredField:
    """The measured map. Raises LoadTestError."""
    return bench.remembered(
        ("map", bench.map_revision, robot.digest()), lambda: read_measured_map(bench.map_text + "\n", robot)
    )


def lines_of(bench: Bench, robot: Robot) -> LinesOfPull | None:
    """Where the lines of pull meet; None for tests of single joints."""
    tests = used_tests(bench, robot)
    if tests is None:
        return None
    return bench.remembered(("pull", *_choices(bench, robot)), lambda: lines_of_pull(robot, tests))


def used_tests(bench: Bench, robot: Robot) -> LoadTests | None:
    """The tests of the tool without the rows left out; None for tests of single joints."""
    tests = tests_of(bench, robot)
    return None if tests.single else tests.without(bench.excluded)


def _choices(bench: Bench, robot: Robot) -> tuple[Any, ...]:
    return bench.revision, robot.digest(), bench.treatment
