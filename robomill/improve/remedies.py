"""What would fix a cut: every remedy by its name, and what it leaves of what the verdict judges."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from robomill.errors import SetupError
from robomill.improve.advice import Advice
from robomill.improve.compensation import Compensation
from robomill.improve.design import Design, design
from robomill.improve.errors import deciding
from robomill.improve.judged import judged
from robomill.improve.placed import Place, Placement
from robomill.improve.turning import Turning
from robomill.simulation.judging.verdict_words import NO_NUMBER, Level
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import Simulate
from robomill.simulation.setup import SimulationSetup

LEAST = 0.005  # of the tolerance: what saves less is no remedy


@dataclass(frozen=True, eq=False)
class Left:
    """What a remedy leaves: ``share`` of the tolerance, the verdict's ``level`` and the ``error`` that decides, by name
    and m; ``then`` is the cut with it, and ``better`` whether noticeably less is left than there is."""

    share: float
    level: Level
    error: tuple[str, float]
    then: SimulationSetup
    better: bool


@dataclass(frozen=True, eq=False)
class Remedy:
    """A kind of remedy: ``makes`` is what finding it returns, and ``left`` says what that leaves against the run as it
    is. One that ``joins`` others stands beneath them."""

    code: str
    title: str
    makes: type
    left: Callable[[Any, SimulationResult], Left]
    joins: bool = False


@dataclass(frozen=True, eq=False)
class Stiffened:
    """A design, and the ``run`` of the cut with its joints, judged by the tolerances of the cut; ``half``: it was to
    halve an error that keeps them."""

    design: Design
    run: SimulationResult
    half: bool = False


@dataclass(frozen=True, eq=False)
class Both:
    """The best place of the part, and the program corrected for that place."""

    place: Placement
    program: Compensation


def stiffened(setup: SimulationSetup, run: Simulate) -> Stiffened:
    """The cheapest stiffer joints that keep the tolerance; where it is kept, that halve what is used of it. ``run`` is
    what simulates a set-up. Raises the refusal of ``design``."""
    now = run(setup)
    share = judged(now).share
    if not share <= 1.0 or now.verdict.level in NO_NUMBER:
        found = design(setup)
        return Stiffened(found, found.after)
    if share < LEAST:
        raise SetupError("No error to reduce: the cut is as it was told to be.")
    half = {name: 0.5 * share * each for name, each in setup.tolerances.items() if each is not None}
    halved = design(setup.replace(**half, provenance=setup.provenance))
    return Stiffened(halved, run(setup.replace(robot=halved.setup.robot)), half=True)


def moved_and_corrected(place: Placement, correct: Callable[[SimulationSetup], Compensation]) -> Both:
    """A place and the program corrected for it. Raises SetupError where it is no better than where the part lies."""
    if not saves(place.best.share, place.now.share):
        raise SetupError("No place is better than where the part lies: correct the program there.")
    return Both(place, correct(place.moved))


def saves(share: float, now: float) -> bool:
    """Whether a share of the tolerance is noticeably less than what is used now."""
    return share < now - LEAST


def decides(result: SimulationResult) -> tuple[str, float]:
    """The name of what decides a verdict, and its size, m."""
    kind, size, _ = result.decided
    return kind.code, size


def error_at(place: Place, setup: SimulationSetup) -> tuple[str, float]:
    """What decides at a place, by name and m."""
    return deciding(setup, place.wall, place.floor, place.feed, place.max_deviation)


def _of_run(run: SimulationResult, now: float) -> Left:
    return Left(run.verdict.share, run.verdict.level, decides(run), run.setup, saves(run.verdict.share, now))


def _of_place(place: Place, then: SimulationSetup, now: float) -> Left:
    return Left(place.share, place.level, error_at(place, then), then, saves(place.share, now))


def _of_program(found: Compensation, setup: SimulationSetup, now: float) -> Left:
    then = setup.replace(source=found.source)
    return Left(found.share, found.level, found.doubted.decides(setup), then, saves(found.share, now))


def _of_both(found: Both, now: SimulationResult) -> Left:
    return _of_program(found.program, found.place.moved, now.verdict.share)


REMEDIES: tuple[Remedy, ...] = (
    Remedy(
        "program",
        "Correct the program",
        Compensation,
        lambda found, now: _of_program(found, now.setup, now.verdict.share),
    ),
    Remedy("stiffen", "Stiffen joints", Stiffened, lambda found, now: _of_run(found.run, now.verdict.share)),
    Remedy("place", "Move the part", Placement, lambda found, now: _of_place(found.best, found.moved, found.now.share)),
    Remedy("both", "Move the part, then correct", Both, _of_both, joins=True),
    Remedy(
        "turn",
        "Turn the spindle",
        Turning,
        lambda found, now: _of_place(found.constant, found.turned, now.verdict.share),
    ),
    Remedy("cut", "Cut otherwise", Advice, lambda found, now: _of_run(found.truest.run or now, found.ways[0].share)),
)


def remedy_of(found: Any) -> Remedy | None:
    """The kind of what was found; None for what is no remedy."""
    return next((each for each in REMEDIES if isinstance(found, each.makes)), None)
