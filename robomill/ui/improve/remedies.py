"""Every remedy for the project's cut in one table, ranked by what it leaves; one of them opens beneath."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from robomill.errors import RobomillError, SetupError
from robomill.identification.fit.confidence import LEVEL
from robomill.identification.knowledge import Knowledge
from robomill.improve.advice import Advice, advise
from robomill.improve.compensation import Compensation
from robomill.improve.design import STIFFEST, Design, design
from robomill.improve.judged import judged
from robomill.improve.placed import Place, Placement
from robomill.improve.placement import place
from robomill.improve.turning import Turning, turn
from robomill.io.compensated import compensate
from robomill.simulation.estimate import run_seconds
from robomill.simulation.judging.verdict_words import TIGHT_FROM, Level
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.ui.improve import sure
from robomill.ui.sharing import report
from robomill.ui.verdict import WORDS
from robomill.ui.work import cached
from robomill.ui.work.job import Underway
from robomill.units import (
    format_count,
    format_many,
    format_percent,
    format_share,
    format_short,
    format_si,
    to_si,
)

RUNS_OF_DESIGN, RUNS_OF_ADVICE, RUNS_OF_PLACES, RUNS_OF_PROGRAM, RUNS_OF_SPIN = 4, 20, 25, 12, 60
LEAST = 0.005  # of the tolerance: what saves less is no remedy
BY = "improve.by"
NOMINAL, SURE = "nominal", "sure"
JUDGED = {NOMINAL: "what is predicted", SURE: "what 95 % of the draws keep"}
TURNED = to_si(0.5, "deg")  # what turns the part by less is not said to turn it


@dataclass(frozen=True, eq=False)
class Left:
    """What a remedy leaves: share of the tolerance, its error in words, the verdict; what it costs and how sure it is;
    ``setup`` is the cut with it, None where it is no better than what there is; ``then`` is that cut in any case."""

    share: float
    error: str
    level: Level
    cost: str
    sure: str
    setup: SimulationSetup | None
    then: SimulationSetup


@dataclass(frozen=True, eq=False)
class Remedy:
    """A kind of remedy: ``find`` computes it for a set-up (and raises its refusal, or ``Underway``), ``left`` says what
    it leaves against the run as it is, in a unit of length. One that ``joins`` others stands beneath them."""

    name: str
    title: str
    find: Callable[[SimulationSetup], Any]
    left: Callable[[Any, SimulationResult, str], Left]
    joins: bool = False


@dataclass(frozen=True, eq=False)
class Found:
    """A remedy as far as it is known: what was ``made`` and what it leaves; or why there is none."""

    remedy: Remedy
    made: Any = None
    left: Left | None = None
    why: str = ""


@dataclass(frozen=True, eq=False)
class Both:
    """The best place of the part, and the program corrected for that place."""

    place: Placement
    program: Compensation


@dataclass(frozen=True, eq=False)
class Stiffened:
    """A design, and the project's cut with its joints; ``half``: it was to halve an error that keeps its tolerance."""

    design: Design
    run: SimulationResult
    half: bool


@cached.shared(cached.by_setup, "Stiffer joints", lambda setup: run_seconds(setup) * RUNS_OF_DESIGN)
def designed(setup: SimulationSetup) -> Stiffened:
    """The cheapest stiffer joints that keep the tolerance; where it is kept, that halve what is used of it."""
    share = judged(cached.result(setup)).share
    if not share <= 1.0:
        found = design(setup)
        return Stiffened(found, found.after, half=False)
    halved = design(setup, 0.5 * share * setup.tolerance)
    return Stiffened(halved, cached.result(setup.replace(robot=halved.setup.robot)), half=True)


@cached.shared(
    lambda setup, known: (cached.by_setup(setup), None if known is None else (known.covariance, known.source)),
    "The corrected program",
    lambda setup, known: run_seconds(setup) * RUNS_OF_PROGRAM,
)
def corrected(setup: SimulationSetup, known: Knowledge | None) -> Compensation:
    """The program that is pushed onto the path that was meant."""
    return compensate(setup, known=known)


def _of_program(found: Compensation, now: SimulationResult, unit: str) -> Left:
    wrong = max(found.softer.max, found.stronger.max)
    share = wrong / now.setup.tolerance
    level: Level = "ok" if share < TIGHT_FROM else "tight" if share <= 1.0 else "out"
    error = f"{format_si(found.after.max, unit, with_unit=False)} to {format_si(wrong, unit)}"
    lines = f"a new program, {format_count(found.lines_in, 'line')} become {format_count(found.lines_out)}"
    how_sure = f"{format_si(wrong, unit)} if stiffness or force is 20 % off"
    if np.isfinite(found.half):
        how_sure += f"; ± {format_si(found.half, unit)} by the tests"
    return Left(share, error, level, lines, how_sure, None, now.setup.replace(source=found.source))


@cached.shared(cached.by_setup, "Other ways to cut", lambda setup: run_seconds(setup) * RUNS_OF_ADVICE)
def advised(setup: SimulationSetup) -> Advice:
    """The same part cut otherwise."""
    return advise(setup, cached.result)


@cached.shared(cached.by_setup, "Other places of the part", lambda setup: run_seconds(setup) * RUNS_OF_PLACES)
def placed(setup: SimulationSetup) -> Placement:
    """The best place of the part about where it is."""
    return place(setup)


@cached.shared(cached.by_setup, "Other turns of the spindle", lambda setup: run_seconds(setup) * RUNS_OF_SPIN)
def turned(setup: SimulationSetup) -> Turning:
    """The best spin about the tool."""
    return turn(setup)


def _decides(result: SimulationResult) -> tuple[str, float]:
    """The name of what decides a verdict, and its size, m."""
    rests = result.verdict.deciding
    return ("tip", result.max_deviation) if rests is None else (rests[0], abs(rests[1].value))


def error_words(result: SimulationResult, unit: str) -> str:
    """What decides a verdict: ``wall 0.230 mm``."""
    name, size = _decides(result)
    return f"{name} {format_si(size, unit)}"


def _of_design(found: Stiffened, now: SimulationResult, unit: str) -> Left:
    made, then = found.design, found.run.verdict
    named = [
        f"joint {number} {format_short(ratio, '1', 3)} times"
        for number, ratio in zip(made.setup.robot.joint_numbers, made.stiffness_ratio, strict=True)
        if ratio > 1.001
    ]
    how_sure = "the least stiffening, proved" if np.isfinite(made.residual) else "kept; the least is not proved"
    if not made.feasible:
        how_sure = f"{format_short(STIFFEST, '1')} times as stiff is the most that is tried"
    cost = f"{', '.join(named) or 'nothing'} as stiff"
    return Left(then.share, error_words(found.run, unit), then.level, cost, how_sure, found.run.setup, found.run.setup)


def _of_advice(found: Advice, now: SimulationResult, unit: str) -> Left:
    known = [way for way in found.ways if way.run is not None]
    truest = min(known, key=lambda way: way.share if np.isfinite(way.share) else np.inf)
    run = truest.run or now
    extra = truest.seconds - found.ways[0].seconds
    cost = f"{truest.title[0].lower()}{truest.title[1:]}: {'+' if extra >= 0 else '−'}{_time(abs(extra))}"
    better = truest.share < found.ways[0].share - LEAST
    how_sure = "by a run on what the deflected tool leaves"
    return Left(
        truest.share,
        error_words(run, unit),
        run.verdict.level,
        cost,
        how_sure,
        run.setup if better else None,
        run.setup,
    )


def _time(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 90.0 else f"{seconds / 60.0:.1f} min"


def _of_place(found: Placement, now: SimulationResult, unit: str) -> Left:
    best = found.best
    far = best.zero - now.setup.T_MW[:3, 3]
    error = error_at(best, unit)
    better = _better(found)
    cost = f"part zero moved by X, Y, Z {format_many(far, unit, 0)}"
    turn = best.yaw - found.now.yaw
    cost += f", turned by {format_si(turn, 'deg', 0)}" if abs(turn) > TURNED else ""
    cost = cost if better else "no place is better than where it lies"
    how_sure = f"best of {format_count(found.allowed, 'place')}, simulated in full"
    return Left(best.share, error, best.level, cost, how_sure, found.moved if better else None, found.moved)


def moved_and_corrected(setup: SimulationSetup) -> Both:
    """The best place, and the program that is corrected for it. Raises SetupError where no place is better."""
    found = placed(setup)
    if not _better(found):
        raise SetupError("No place is better than where the part lies: correct the program there.")
    return Both(found, corrected(found.moved, session.known(setup)))


def _of_both(found: Both, now: SimulationResult, unit: str) -> Left:
    left = _of_program(found.program, now, unit)
    far = found.place.best.zero - now.setup.T_MW[:3, 3]
    cost = f"part zero moved by X, Y, Z {format_many(far, unit, 0)}; {left.cost}"
    then = found.place.moved.replace(source=found.program.source)
    return replace(left, cost=cost, setup=found.place.moved, then=then)


def _better(found: Placement) -> bool:
    """Whether the best place is noticeably better than where the part lies."""
    return found.best.share < found.now.share - LEAST


def _of_spin(found: Turning, now: SimulationResult, unit: str) -> Left:
    then = found.constant
    better = then.share < now.verdict.share - LEAST
    was = "" if now.ik.spin is None else f", now {format_si(float(now.ik.spin[0]), 'deg', 0)}"
    cost = f"the tool turned to {format_si(found.spin, 'deg', 0)} about its axis{was}"
    cost = cost if better else "no turn is better than what it has"
    how_sure = "simulated in full"
    return Left(
        then.share, error_at(then, unit), then.level, cost, how_sure, found.turned if better else None, found.turned
    )


def error_at(place: Place, unit: str) -> str:
    """What is largest of a place's wall and floor; the tip where there is neither."""
    sizes = [(abs(value), name) for name, value in (("wall", place.wall), ("floor", place.floor)) if np.isfinite(value)]
    size, name = max(sizes, default=(place.max_deviation, "tip"))
    return f"{name} {format_si(size, unit)}"


REMEDIES: tuple[Remedy, ...] = (
    Remedy("program", "Correct the program", lambda setup: corrected(setup, session.known(setup)), _of_program),
    Remedy("stiffen", "Stiffen joints", designed, _of_design),
    Remedy("place", "Move the part", placed, _of_place),
    Remedy("both", "Move the part, then correct", moved_and_corrected, _of_both, joins=True),
    Remedy("turn", "Turn the spindle", turned, _of_spin),
    Remedy("cut", "Cut otherwise", advised, _of_advice),
)


def known(result: SimulationResult, unit: str, by: str = NOMINAL) -> tuple[list[Found], Underway | None]:
    """Every remedy as far as it is known, the truest first, those that join others beneath, then what is computed (one
    after the other) and what does not apply; and what is being computed. They are judged ``by`` what is predicted, or
    by what 95 % of the draws keep."""
    every, waits = [], None
    for remedy in REMEDIES:
        if waits is not None:
            every.append(Found(remedy, why="is computed next"))
            continue
        try:
            made = remedy.find(result.setup)
            left = remedy.left(made, result, unit)
            every.append(Found(remedy, made, at_95(left, unit) if by == SURE else left))
        except Underway as now:
            waits = now
            every.append(Found(remedy, why="is being computed"))
        except RobomillError as refusal:
            every.append(Found(remedy, why=str(refusal)))
    single = [each.made for each in every if each.left is not None and not each.remedy.joins]
    made = tuple(each.design if isinstance(each, Stiffened) else each for each in single)
    session.hold(report.REMEDIES, (result.setup.digest(), made))  # for the report
    return sorted(every, key=_rank), waits


def _rank(found: Found) -> tuple[bool, bool, float]:
    """The truest first; then what joins some of them; then what is not there."""
    left = found.left
    return left is None, left is not None and found.remedy.joins, 0.0 if left is None else left.share


def as_it_is(result: SimulationResult, unit: str, by: str = NOMINAL) -> Left:
    """The cut without a remedy, judged as they are. Raises ``Underway``, and the refusal of draws."""
    now, setup = result.verdict, result.setup
    left = Left(now.share, error_words(result, unit), now.level, "", "", None, setup)
    return at_95(left, unit) if by == SURE else left


def judged_by(result: SimulationResult, unit: str) -> tuple[str, Left]:
    """What the page judges by, and the cut as it is; by what is predicted where draws of it are refused, or not there
    yet."""
    by = session.kept(BY, NOMINAL)
    try:
        return by, as_it_is(result, unit, by)
    except (Underway, RobomillError):
        return by, as_it_is(result, unit)


def at_95(left: Left, unit: str) -> Left:
    """What a remedy leaves in 95 % of the draws."""
    found = sure.of(left.then)
    share, error = found.quantile(LEVEL, "share"), found.quantile(LEVEL)
    level: Level = "ok" if share < TIGHT_FROM else "tight" if share <= 1.0 else "out"
    words = format_si(error, unit, missing="not reached")
    return replace(left, share=share, error=words, level=level, sure=sure.kept_words(found))


def sentence(found: Sequence[Found], result: SimulationResult, now: Left, unit: str) -> str:
    """What would fix it, in one line; ``now`` is the cut as it is."""
    left = found[0].left
    if left is None:
        return "What would fix it?"
    if result.verdict.level == "unjudged":  # a share of the tolerance would be a judgement
        name, size = _decides(result)
        rests = f", {result.verdict.premise}" if result.verdict.premise else ", where it is judged"
        return (
            f"{found[0].remedy.title}: {name} error of {format_si(size, unit)} becomes "
            f"{left.error.removeprefix(f'{name} ')}{rests}. Nothing is within tolerance or out of it yet."
        )
    if not left.share < now.share - LEAST:
        return "Nothing that was tried makes this cut noticeably truer."
    if now.sure:
        return (
            f"{found[0].remedy.title}: in 95 % of the draws the error is at most {left.error} instead of {now.error}, "
            f"{WORDS[left.level].lower()} ({format_percent(left.share)} of the tolerance, now "
            f"{format_percent(now.share)})."
        )
    name, size = _decides(result)
    return (
        f"{found[0].remedy.title}: {name} error of {format_si(size, unit)} becomes "
        f"{left.error.removeprefix(f'{name} ')}, {WORDS[left.level].lower()} "
        f"({format_percent(left.share)} of the tolerance, now {format_percent(now.share)})."
    )


def table(found: Sequence[Found], now: Left) -> None:
    """Remedies with what they leave, what they cost and how sure that is, beneath the cut as it is ``now``."""
    rows = [["As it is", now.error, format_share(now.share), WORDS[now.level], "", now.sure]]
    for each in found:
        left = each.left
        if left is None:
            rows.append([each.remedy.title, "–", "–", "–", each.why, ""])
        else:
            rows.append(
                [each.remedy.title, left.error, format_percent(left.share), WORDS[left.level], left.cost, left.sure]
            )
    head = ("Remedy", "Error then", "Of tolerance", "Verdict then", "What it takes", "How sure")
    pieces.table(rows, "snnvww", head, strong=1 if found and found[0].left else -1)


def use(left: Left, title: str) -> None:
    """The button that does it; undo takes it back."""
    if left.setup is None:
        pieces.note("It leaves no less than there is now: nothing to use.")
        return
    inputs.button(title, f"improve.do.{title}", "check", take, left.setup, type="primary", help="Undo takes it back.")


def take(setup: SimulationSetup) -> None:
    """Put into the project what a remedy has changed of its set-up."""
    old = session.project().setup
    changes: dict[str, Any] = {}
    if setup.robot is not old.robot:
        changes["robot"] = setup.robot
    if setup.spin != old.spin:
        changes["spin"] = setup.spin
    if (setup.T_MW != old.T_MW).any():
        changes["T_MW"] = setup.T_MW
    if setup.source is not old.source:
        changes |= {"source": setup.source, "stock": setup.stock, "engagement": setup.engagement}
    session.change(**changes)
