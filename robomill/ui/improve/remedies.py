"""Every remedy for the project's cut in one table, ranked by what it leaves; one of them opens beneath."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import streamlit as st

from robomill.errors import RobomillError
from robomill.identification.fit.confidence import LEVEL
from robomill.identification.knowledge import Knowledge
from robomill.improve.advice import Advice, advise
from robomill.improve.asked_joints import joints_named
from robomill.improve.compensation import Compensation
from robomill.improve.design import STIFFEST
from robomill.improve.placed import Placement
from robomill.improve.placement import place
from robomill.improve.remedies import (
    REMEDIES,
    Both,
    Left,
    Remedy,
    Stiffened,
    decides,
    moved_and_corrected,
    saves,
    stiffened,
)
from robomill.improve.turning import Turning, turn
from robomill.io.compensated import compensate
from robomill.simulation.estimate import run_seconds
from robomill.simulation.judging.verdict_words import level_of_share
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.ui.improve import sure
from robomill.ui.judged.verdict import WORDS
from robomill.ui.sharing import report
from robomill.ui.work import cached
from robomill.ui.work.job import Underway
from robomill.units import (
    format_count,
    format_duration,
    format_many,
    format_share,
    format_short,
    format_si,
    to_si,
)

RUNS_OF_DESIGN, RUNS_OF_ADVICE, RUNS_OF_PLACES, RUNS_OF_PROGRAM, RUNS_OF_SPIN = 4, 20, 25, 12, 60
BY = "improve.by"
NOMINAL, SURE = "nominal", "sure"
JUDGED = {NOMINAL: "what is predicted", SURE: "what 95 % of the draws keep"}
TURNED = to_si(0.5, "deg")  # what turns the part by less is not said to turn it
IN_FULL = "simulated in full"
NOTHING_JUDGED = "No error to reduce: nothing of this cut is judged."


@dataclass(frozen=True, eq=False)
class Shown:
    """What a remedy leaves; its error, what it costs and how sure it is, in words. ``setup`` is what its button puts
    into the project, None where that is no better than what there is."""

    left: Left
    error: str
    cost: str = ""
    sure: str = ""
    setup: SimulationSetup | None = None


@dataclass(frozen=True, eq=False)
class Found:
    """A remedy as far as it is known: what was ``made`` and what it leaves; or why there is none."""

    remedy: Remedy
    made: Any = None
    shown: Shown | None = None
    why: str = ""


@cached.shared(cached.by_setup, "Stiffer joints", lambda setup: run_seconds(setup) * RUNS_OF_DESIGN)
def designed(setup: SimulationSetup) -> Stiffened:
    """The cheapest stiffer joints."""
    return stiffened(setup, cached.result)


@cached.shared(
    lambda setup, known: (cached.by_setup(setup), cached.by_knowledge(known)),
    "The corrected program",
    lambda setup, known: run_seconds(setup) * RUNS_OF_PROGRAM,
)
def corrected(setup: SimulationSetup, known: Knowledge | None) -> Compensation:
    """The program that is pushed onto the path that was meant."""
    return compensate(setup, known=known)


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


def _corrected(setup: SimulationSetup) -> Compensation:
    return corrected(setup, session.known(setup))


FINDS: dict[str, Callable[[SimulationSetup], Any]] = {
    "program": _corrected,
    "stiffen": designed,
    "place": placed,
    "both": lambda setup: moved_and_corrected(placed(setup), _corrected),
    "turn": turned,
    "cut": advised,
}
"""What computes a remedy for a set-up, by its code; raises its refusal, or ``Underway``."""


def error_words(error: tuple[str, float], unit: str) -> str:
    """What decides, by name and m: ``wall 0.230 mm``."""
    return f"{error[0]} {format_si(error[1], unit)}"


def shown(remedy: Remedy, made: Any, now: SimulationResult, unit: str) -> Shown:
    """What a remedy that was made leaves of the run as it is, in words."""
    return SHOWN[remedy.code](made, remedy.left(made, now), now, unit)


def _program(found: Compensation, left: Left, now: SimulationResult, unit: str) -> Shown:
    wrong = found.doubted.max
    lines = f"a new program, {format_count(found.lines_in, 'line')} become {format_count(found.lines_out)}"
    how_sure = f"{format_si(wrong, unit)} if stiffness or force is 20 % off"
    if np.isfinite(found.half):
        how_sure += f"; ± {format_si(found.half, unit)} by the tests"
    return Shown(left, format_many((found.after.max, wrong), unit, between=" to "), lines, how_sure)


def _stiffened(found: Stiffened, left: Left, now: SimulationResult, unit: str) -> Shown:
    made = found.design
    named = joints_named(made.setup.robot.joint_numbers, made.stiffness_ratio)
    how_sure = "the least stiffening, proved" if np.isfinite(made.residual) else "kept; the least is not proved"
    if not made.feasible:
        how_sure = f"{format_short(STIFFEST, '1')} times as stiff is the most that is tried"
    cost = f"{', '.join(named) or 'nothing'} as stiff"
    return Shown(left, error_words(left.error, unit), cost, how_sure, left.then)


def _cut(found: Advice, left: Left, now: SimulationResult, unit: str) -> Shown:
    truest = found.truest
    extra = format_duration(truest.seconds - found.ways[0].seconds, sign=True)
    cost = f"{truest.title[0].lower()}{truest.title[1:]}: {extra}"
    return _if_better(left, unit, cost, "by a run on what the deflected tool leaves")


def _if_better(left: Left, unit: str, cost: str, how_sure: str) -> Shown:
    return Shown(left, error_words(left.error, unit), cost, how_sure, left.then if left.better else None)


def _moved(found: Placement, unit: str) -> str:
    """By how much a place moves part zero, in words."""
    return f"part zero moved by X, Y, Z {format_many(found.best.zero - found.now.zero, unit, 0)}"


def _placed(found: Placement, left: Left, now: SimulationResult, unit: str) -> Shown:
    turn = found.best.yaw - found.now.yaw
    cost = _moved(found, unit) + (f", turned by {format_si(turn, 'deg', 0)}" if abs(turn) > TURNED else "")
    cost = cost if left.better else "no place is better than where it lies"
    return _if_better(left, unit, cost, f"best of {format_count(found.allowed, 'place')}, {IN_FULL}")


def _both(found: Both, left: Left, now: SimulationResult, unit: str) -> Shown:
    made = _program(found.program, left, now, unit)
    return replace(made, cost=f"{_moved(found.place, unit)}; {made.cost}", setup=found.place.moved)


def _turned(found: Turning, left: Left, now: SimulationResult, unit: str) -> Shown:
    was = "" if now.ik.spin is None else f", now {format_si(float(now.ik.spin[0]), 'deg', 0)}"
    cost = f"the tool turned to {format_si(found.spin, 'deg', 0)} about its axis{was}"
    return _if_better(left, unit, cost if left.better else "no turn is better than what it has", IN_FULL)


SHOWN: dict[str, Callable[[Any, Left, SimulationResult, str], Shown]] = {
    "program": _program,
    "stiffen": _stiffened,
    "place": _placed,
    "both": _both,
    "turn": _turned,
    "cut": _cut,
}


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
            made = FINDS[remedy.code](result.setup)
            left = shown(remedy, made, result, unit)
            every.append(Found(remedy, made, at_95(left, unit) if by == SURE else left))
        except Underway as now:
            waits = now
            every.append(Found(remedy, why="is being computed"))
        except RobomillError as refusal:
            every.append(Found(remedy, why=_why(str(refusal), result, every)))
    made = tuple(each.made for each in every if each.shown is not None)
    session.hold(report.REMEDIES, (result.setup.digest(), made))  # for the report
    return sorted(every, key=_rank), waits


def _why(refusal: str, result: SimulationResult, above: Sequence[Found]) -> str:
    """Why there is none, in short: the verdict that refusals end with (that of the cut, or of one much like it whose
    refusal begins as one ``above``) is said once, beneath the table."""
    begun = next((each.why for each in above if each.why and refusal.startswith(each.why)), None)
    said = refusal.removesuffix(result.verdict.sentence)
    return begun or (refusal if said == refusal else f"{said.rstrip(': .')}.")


def _rank(found: Found) -> tuple[bool, bool, float]:
    """The truest first; then what joins some of them; then what is not there."""
    there = found.shown
    return there is None, there is not None and found.remedy.joins, 0.0 if there is None else there.left.share


def as_it_is(result: SimulationResult, unit: str, by: str = NOMINAL) -> Shown:
    """The cut without a remedy, judged as they are. Raises ``Underway``, and the refusal of draws."""
    now, error = result.verdict, decides(result)
    left = Shown(Left(now.share, now.level, error, result.setup, better=False), error_words(error, unit))
    return at_95(left, unit) if by == SURE else left


def judged_by(result: SimulationResult, unit: str) -> tuple[str, Shown]:
    """What the page judges by, and the cut as it is; by what is predicted where draws of it are refused, or not there
    yet."""
    by = session.kept(BY, NOMINAL)
    try:
        return by, as_it_is(result, unit, by)
    except (Underway, RobomillError):
        return by, as_it_is(result, unit)


def at_95(row: Shown, unit: str) -> Shown:
    """What a remedy leaves in 95 % of the draws."""
    found = sure.of(row.left.then)
    share = found.quantile(LEVEL, "share")
    left = replace(row.left, share=share, level=level_of_share(share))
    return replace(row, left=left, error=format_si(found.quantile(LEVEL), unit), sure=sure.kept_words(found))


def sentence(found: Sequence[Found], result: SimulationResult, now: Shown, unit: str) -> str:
    """What would fix it, in one line; ``now`` is the cut as it is."""
    then = found[0].shown
    if then is None:
        return "What would fix it?"
    title, left = found[0].remedy.title, then.left
    if not saves(left.share, now.left.share):
        rests = f" {result.verdict.premise}" if result.verdict.premise else ""
        return f"Nothing that was tried makes this cut noticeably truer{rests}."
    if result.verdict.level == "unjudged":  # a share of the tolerance would be a judgement
        name, size = decides(result)
        rests = f", {result.verdict.premise}" if result.verdict.premise else ", where it is judged"
        return (
            f"{title}: {name} error of {format_si(size, unit)} becomes "
            f"{then.error.removeprefix(f'{name} ')}{rests}. Nothing is within tolerance or out of it yet."
        )
    used, was = format_share(left.share), format_share(now.left.share)
    judged = f"{WORDS[left.level].lower()} ({used} of the tolerance, now {was})."
    if now.sure:
        return f"{title}: in 95 % of the draws the error is at most {then.error} instead of {now.error}, {judged}"
    name, size = decides(result)
    return f"{title}: {name} error of {format_si(size, unit)} becomes {then.error.removeprefix(f'{name} ')}, {judged}"


def table(found: Sequence[Found], now: Shown) -> None:
    """Remedies with what they leave, what they cost and how sure that is, beneath the cut as it is ``now``; of those
    that are not there, why."""
    rows = [["As it is", now.error, format_share(now.left.share), WORDS[now.left.level], "", now.sure]]
    for each in found:
        row = each.shown
        if row is None:
            rows.append([each.remedy.title, each.why])
        else:
            used, verdict = format_share(row.left.share), WORDS[row.left.level]
            rows.append([each.remedy.title, row.error, used, verdict, row.cost, row.sure])
    first = found[0].shown if found else None
    best = first is not None and saves(first.left.share, now.left.share)
    head = ("Remedy", "Error then", "Of tolerance", "Verdict then", "What it takes", "How sure")
    with st.container(key="improve-table"):
        pieces.table(rows, "snnvww", head, strong=1 if best else -1)


def once(result: SimulationResult) -> None:
    """What of the cut is not judged, which the remedies leave out."""
    if result.verdict.level == "unjudged":
        pieces.note(result.verdict.sentence)


def use(row: Shown, title: str) -> None:
    """The button that does it; undo takes it back."""
    if row.setup is None:
        pieces.note("It leaves no less than there is now: nothing to use.")
        return
    inputs.button(title, f"improve.do.{title}", "check", take, row.setup, type="primary", help="Undo takes it back.")


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
