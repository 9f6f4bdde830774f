"""What is read from the bench, fitted and planned: kept by what it depends on, in the session only and bounded."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any, TypeVar

from robomill.errors import LoadTestError
from robomill.identification.fit.comparison import Comparison, compare_models
from robomill.identification.fit.estimate import identify
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.measured_field import MeasuredField
from robomill.identification.pull.lines_of_pull import LinesOfPull, lines_of_pull
from robomill.identification.result import IdentificationResult
from robomill.io.measured.load_tests import read_load_tests, read_measured_map
from robomill.io.robot.robots import load_robot
from robomill.quantities import quantities
from robomill.robot.model import Robot
from robomill.ui import session
from robomill.ui.bench import Bench
from robomill.ui.entry import declared
from robomill.ui.entry.inputs import PLAIN, Look
from robomill.ui.work import beside

Value = TypeVar("Value")

MEMORY = "identification.memory"
REMEMBERED = 24


def remembered(key: Any, make: Callable[[], Value], doing: str = "") -> Value:
    """``make()``, once for each ``key``; the oldest of ``REMEMBERED`` is forgotten. Refusals are not kept. What is
    ``doing`` may take long: it is made beside the page, and ``Underway`` raised while it is not there."""
    memory: dict[Any, Any] = session.kept(MEMORY, {})
    if key not in memory:
        made = make() if not doing else beside.made(f"identification.{key[0]}", key, make, doing)
        while len(memory) >= REMEMBERED:
            del memory[next(iter(memory))]
        memory[key] = made
        session.keep(MEMORY, memory)
    found: Value = memory[key]
    return found


def decide(**fields: Any) -> None:
    """Decide otherwise about the load tests or the map; remembered for undo."""
    session.experiment(session.project().bench.replace(**fields))


def decided(name: str) -> Callable[[Any], None]:
    """What an input calls with its new value for ``name``."""
    return lambda value: decide(**{name: value})


def field(bench: Bench, name: str, look: Look = PLAIN) -> None:
    """The input of a declared field of the bench."""
    declared.draw(quantities(Bench)[name], f"identification.{name}", getattr(bench, name), decided(name), look)


def put_sample(sample: str) -> None:
    """Put a sample on the bench."""
    session.experiment(session.project().bench.with_sample(sample))


def put_tests(text: str, name: str) -> None:
    """Put a person's own tests on the bench."""
    project = session.project()
    session.experiment(project.bench.with_tests(text, name, project.setup.robot.name))


def put_map_sample(sample: str) -> None:
    """Put a sample of a measured map on the bench."""
    session.experiment(session.project().bench.with_map_sample(sample))


def put_map(text: str, name: str) -> None:
    """Put a person's own measured map on the bench."""
    session.experiment(session.project().bench.with_map(text, name))


def robot_of(bench: Bench) -> Robot:
    """The robot that was measured: the project's, or a preset."""
    own = session.project().setup.robot
    name = bench.robot_name(own.name)
    return load_robot(name) if name else own


def tests_of(bench: Bench, robot: Robot) -> LoadTests | JointTests:
    """The tests as read, their poses checked against the robot. Raises LoadTestError with row and column."""
    # The line end makes a single typed line a text, never the name of a file on this machine.
    key = "tests", bench.text, robot.digest()
    return remembered(key, lambda: read_load_tests(bench.text + "\n", robot), "Reading the load tests")


def fit_of(bench: Bench, robot: Robot) -> IdentificationResult:
    """The fit of the model asked for. Raises LoadTestError."""
    tests = tests_of(bench, robot)

    fit = partial(identify, robot, tests, bench.model, bench.treatment)
    return remembered(("fit", *_choices(bench, robot), bench.model), fit, "Fitting, and predicting what was left out")


def comparison_of(bench: Bench, robot: Robot) -> Comparison:
    """Every model fitted to the same tests, bending at the joints that are named. Raises LoadTestError."""
    tests = tests_of(bench, robot)
    if tests.single:
        raise LoadTestError(
            "One joint at a time shows nothing but joints: models are compared on displacements of the tool."
        )
    treatment = replace(bench.treatment, bending=bench.bending)
    compare = partial(compare_models, robot, tests, treatment=treatment)
    return remembered(("models", *_choices(bench, robot)), compare, "Fitting every model")


def field_of(bench: Bench, robot: Robot) -> MeasuredField:
    """The measured map. Raises LoadTestError."""
    key = "map", bench.map_text, robot.digest()
    return remembered(key, lambda: read_measured_map(bench.map_text + "\n", robot), "Reading the measured map")


def lines_of(bench: Bench, robot: Robot) -> LinesOfPull | None:
    """Where the lines of pull meet; None for tests of single joints."""
    tests = used_tests(bench, robot)
    if tests is None:
        return None
    return remembered(("pull", *_choices(bench, robot)), partial(lines_of_pull, robot, tests), "Lines of pull")


def used_tests(bench: Bench, robot: Robot) -> LoadTests | None:
    """The tests of the tool without the rows left out; None for tests of single joints."""
    tests = tests_of(bench, robot)
    return None if tests.single else tests.without(bench.excluded)


def _choices(bench: Bench, robot: Robot) -> tuple[Any, ...]:
    return bench.text, robot.digest(), bench.treatment
