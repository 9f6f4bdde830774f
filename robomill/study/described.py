"""What a study is: a set-up, parameters of it, what is asked of every run. Read from TOML, or made in code."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any

from robomill.arguments import asked, made_by
from robomill.arrays import digest
from robomill.errors import RobomillError, StudyError
from robomill.files import STUDY
from robomill.io.beside import ALLOW, Beside
from robomill.io.samples import find_sample, sample_or_file
from robomill.io.setups.projects import load_setup, setup_from_table
from robomill.io.tables import Table, parse_toml
from robomill.io.texts import read_text
from robomill.lazy import cached_property
from robomill.simulation.setup import SimulationSetup
from robomill.study.addressed import Data, checked, tables_of
from robomill.study.design import DISTRIBUTIONS, KINDS, MOST, Kind, Parameter, points
from robomill.study.responses import RESPONSES, USUAL
from robomill.units import format_count
from robomill.values import Value

FORMAT, VERSION = "robomill-study", 1
COUNT = 100  # points where nothing is said


@made_by('rm.load_study("study.toml")')
@dataclass(frozen=True, eq=False, repr=False)
class Study(Value):
    """Many runs of one set-up, described.

    name         what it is called
    setup        the set-up as it is
    parameters   what is changed, each a key of the set-up's or its robot's file
    responses    what is asked of every run, of ``RESPONSES``
    kind, count, seed   "grid", "latin_hypercube" or "sobol"; how many points, and what they are drawn with

    Examples
    --------
    >>> import robomill as rm
    >>> study = rm.load_study({"setup": "paper_flute", "parameters": {"cutter.diameter_mm": {"values": [6, 8, 10]}}})
    >>> study
    <Study paper_flute: 3 points of 1 parameter>
    >>> study.points
    [[6], [8], [10]]
    """

    name: str
    setup: SimulationSetup
    parameters: tuple[Parameter, ...]
    responses: tuple[str, ...]
    kind: Kind
    count: int
    seed: int

    @property
    def keys(self) -> list[str]:
        """Of the parameters."""
        return [each.key for each in self.parameters]

    @cached_property
    def points(self) -> list[list[Any]]:
        """Every point, with one value a parameter."""
        return points(self.parameters, self.kind, self.count, self.seed)

    @cached_property
    def data(self) -> Data:
        """The set-up as tables that need no other file."""
        return tables_of(self.setup, self.keys)

    @cached_property
    def _digest(self) -> str:
        said = [(each.key, repr(each)) for each in self.parameters]
        return digest((self.setup.digest(), repr(said), self.responses, self.kind, self.count, self.seed))

    def _said(self) -> str:
        return f"{self.name}: {format_count(len(self.points), 'point')} of {format_count(len(self.keys), 'parameter')}"


@asked
def load_study(study: str | Path | Mapping[str, Any], allow_outside: bool = False) -> Study:
    """A study from its TOML file.

    Parameters
    ----------
    study : str, Path or mapping
        The file, or a sample's name; or what stands in it, as a mapping, in which ``setup`` may be a set-up itself.
    allow_outside : bool
        Whether a file may name a set-up, and that one files, that lie neither in its own folder nor below.

    Returns
    -------
    Study
        Checked: every parameter is a key of the set-up's, its robot's or its material's file, every response is known.

    Raises
    ------
    StudyError
        Naming the key that is wrong, and what is known there.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.load_study(
    ...     {
    ...         "setup": rm.load_setup("paper_flute"),
    ...         "design": {"kind": "sobol", "points": 64, "seed": 3},
    ...         "parameters": {
    ...             "robot.joint[2].a_mm": {"distribution": "normal", "mean": 1220, "std": 2},
    ...             "part.zero_mm[2]": {"low": -1400, "high": -1200},
    ...         },
    ...         "responses": ["wall_mm"],
    ...     }
    ... ).keys
    ['robot.joint[2].a_mm', 'part.zero_mm[2]']
    """
    if isinstance(study, Mapping):
        return _read(Table(dict(study), "study", StudyError), Beside(Path.cwd(), outside=True))
    file = sample_or_file("study", study, StudyError)
    text, _ = read_text(file, StudyError, STUDY)
    return study_from_toml(text, file.name, Beside(file.parent, allow_outside))


def study_from_toml(text: str, where: str, beside: Beside) -> Study:
    """A study from TOML text; its set-up lies where ``beside`` allows, or is a sample."""
    return _read(Table(parse_toml(text, where, StudyError, exact=True), where, StudyError), beside)


def _read(top: Table, beside: Beside) -> Study:
    found = top.text("format", FORMAT), top.whole("version", VERSION)
    if found != (FORMAT, VERSION):
        raise top.refuse("format", f"expected {FORMAT!r}, version {VERSION}; found {found[0]!r:.40}, {found[1]}.")
    setup, called = _setup(top, beside)
    design = top.table("design", {})
    kind: Any = design.choice("kind", KINDS, "grid")
    count = 0 if kind == "grid" else design.whole("points", COUNT)
    seed = design.whole("seed", 0)
    design.finish()
    if kind != "grid" and not 1 <= count <= MOST:
        raise design.refuse("points", f"expected a whole number from 1 to {format_count(MOST)}, found {count}.")
    if seed < 0:
        raise design.refuse("seed", f"expected a whole number from 0 on, found {seed}.")
    table = top.table("parameters")
    for key, given in table.data.items():
        if isinstance(given, list | tuple):
            table.data[key] = {"values": list(given)}
    parameters = tuple(_parameter(table.table(key), key, kind) for key in table.data)
    if not parameters:
        raise top.refuse("parameters", 'there is none; give at least one, as [parameters."cutter.diameter_mm"].')
    responses = tuple(top.words("responses")) if top.has("responses") else USUAL
    unknown = [name for name in responses if name not in RESPONSES]
    if unknown or not responses:
        what = f"{unknown[0]!r:.60} is not known" if unknown else "there is none"
        raise top.refuse("responses", f"{what}; known are {', '.join(RESPONSES)}.")
    name = top.text("name", called)
    top.asked.update(("responses", "description"))
    top.finish()
    made = Study(name, setup, parameters, tuple(dict.fromkeys(responses)), kind, count, seed)
    for each in parameters:
        checked(made.data, each.key, each.tried)
    return made


def _setup(top: Table, beside: Beside) -> tuple[SimulationSetup, str]:
    """The set-up, by a sample's name or a file beside the study, or as its own table, and what it is called."""
    if isinstance(top.data.get("setup"), SimulationSetup):
        top.asked.add("setup")
        return top.data["setup"], top.data["setup"].name
    if isinstance(top.data.get("setup"), dict):
        top.asked.add("setup")
        try:
            made = setup_from_table(top.data["setup"], f"{top.where}, setup", beside)
        except RobomillError as refused:
            raise top.refuse("setup", str(refused)) from None
        return made, made.name
    named = top.text("setup")
    place = beside.place(beside.folder or Path.cwd(), named)
    sample = place is None or not place.exists()
    if sample and find_sample("set-up", named) is None:
        what = "neither a file beside the study nor a sample."
        if place is None:
            what = f"not in the folder of the study nor below it; bring it there, or allow it with {ALLOW}."
        raise top.refuse("setup", f"{named!r:.80} is {what}")
    try:
        return load_setup(named if sample or place is None else place, beside.outside), Path(named).stem
    except RobomillError as refused:
        raise top.refuse("setup", str(refused)) from None


def _parameter(table: Table, key: str, kind: Kind) -> Parameter:
    forms = [form for form in ("values", "low", "distribution") if table.has(form)]
    if table.has("distribution"):
        name = table.choice("distribution", tuple(DISTRIBUTIONS))
        stated = tuple(table.number(word, "1") for word in DISTRIBUTIONS[name])
        found = Parameter(key, distribution=name, stated=stated, steps=_steps(table, kind))
        _check_distribution(table, found)
    elif forms == ["values"]:
        values = table.data["values"]
        table.asked.add("values")
        if isinstance(values, list):
            values = [float(v) if isinstance(v, Decimal) else v for v in values]
        if (
            not isinstance(values, list)
            or not values
            or not all(isinstance(v, bool | int | float | str) for v in values)
        ):
            raise table.refuse("values", f"expected a list of numbers, words, or true and false; found {values!r:.60}.")
        if len({isinstance(v, str) for v in values}) > 1 or len({isinstance(v, bool) for v in values}) > 1:
            raise table.refuse("values", "numbers, words, and true and false do not stand in one list.")
        if any(isinstance(v, float) and not math.isfinite(v) for v in values):
            raise table.refuse("values", "expected finite numbers.")
        found = Parameter(key, tuple(values))
    elif forms == ["low"]:
        low, high = table.number("low", "1"), table.number("high", "1")
        found = Parameter(key, low=low, high=high, steps=_steps(table, kind), log=table.flag("log", False))
        if not low < high:
            raise table.refuse(
                "low", f"the bounds contradict each other, {low:g} to {high:g}; give the smaller one first."
            )
        if found.log and low <= 0.0:
            raise table.refuse("log", f"equal ratios need bounds above zero; found {low:g}.")
    else:
        raise table.refuse("values", "give one of values, low and high, or distribution.")
    table.finish()
    return found


def _steps(table: Table, kind: Kind) -> int:
    """How many values a range has on a grid."""
    if kind != "grid":
        table.asked.add("steps")
        return 0
    if not table.has("steps"):
        raise table.refuse("steps", "missing; say how many values it takes on the grid, or take another design.")
    steps = table.whole("steps")
    if not 1 <= steps <= MOST:
        raise table.refuse("steps", f"expected a whole number from 1 on, found {steps}.")
    return int(steps)


def _check_distribution(table: Table, found: Parameter) -> None:
    numbers = dict(zip(DISTRIBUTIONS[found.distribution], found.stated, strict=True))
    if found.distribution == "normal" and numbers["std"] <= 0.0:
        raise table.refuse("std", f"expected a number above zero, found {numbers['std']:g}.")
    if found.distribution == "lognormal" and not (numbers["median"] > 0.0 and numbers["factor"] > 1.0):
        raise table.refuse("factor", "expected a median above zero and a factor above 1 (one standard deviation).")
    if "low" in numbers and not numbers["low"] < numbers["high"]:
        raise table.refuse("low", "the bounds contradict each other; give the smaller one first.")
    if "mode" in numbers and not numbers["low"] <= numbers["mode"] <= numbers["high"]:
        raise table.refuse("mode", "expected a number between low and high.")
