"""How sure a cut's error is: its distribution, what to measure next, and what 95 % of the draws keep of a remedy."""

from __future__ import annotations

from functools import partial

import numpy as np

from robomill.identification.fit.confidence import LEVEL
from robomill.identification.knowledge import Knowledge
from robomill.improve.draws import Uncertainty
from robomill.improve.uncertainty import FULL, uncertainty
from robomill.improve.unsure import USUAL, Spread
from robomill.quantities import quantities
from robomill.simulation.estimate import run_seconds
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.ui.entry.box import NumberBox
from robomill.ui.shell import dark
from robomill.ui.work import cached
from robomill.units import (
    format_beside,
    format_count,
    format_many,
    format_percent,
    format_share,
    format_si,
    format_value,
    from_si,
)
from robomill.viz.unsure import distribution, tornado_bars

KEPT = "improve.spread"
RUNS = 60  # runs in the time that ten thousand draws take
SHOWN = 8  # inputs of the tornado
IN_PARTS = {"compliance": "%", "force": "%"}  # shares are typed in per cent


@cached.shared(
    lambda setup, spread, known: (
        cached.by_setup(setup),
        spread.digest(),
        cached.by_knowledge(known),
    ),
    "How sure it is",
    lambda setup, spread, known: run_seconds(setup) * (FULL if setup.coupling else RUNS),
)
def drawn(setup: SimulationSetup, spread: Spread, known: Knowledge | None) -> Uncertainty:
    """The distribution of what a cut uses of its tolerance."""
    return uncertainty(setup, spread, known=known)


def of(setup: SimulationSetup) -> Uncertainty:
    """The same with what the page states, and what is known of the project's compliances where they are in force."""
    return drawn(setup, session.kept(KEPT, Spread()), session.known(setup))


def kept_words(found: Uncertainty) -> str:
    """``tolerance kept in 99.97 % of 10,000 draws``."""
    return f"tolerance kept in {format_beside(found.probability, 1.0, '%', 1)} of {format_count(found.samples, 'draw')}"


def panel(result: SimulationResult, predicted: str, unit: str) -> None:
    """What is not known exactly, by how much, and what that does to the cut as it is, whose error is ``predicted``."""
    pieces.strong("How sure the error is")
    pieces.note("One standard deviation of what is not known exactly. An empty box is assumed, as it says.")
    _boxes(unit)
    found = pieces.attempt(of, result.setup)
    if found is None:
        return
    low, high = (format_beside(end, 1.0, "%", 1) for end in found.interval)
    rows = [
        ("Predicted", predicted, format_share(result.verdict.share)),
        (
            "95 % of the draws keep",
            format_si(found.quantile(LEVEL), unit, missing="not reached"),
            format_share(found.quantile(LEVEL, "share")),
        ),
    ]
    pieces.table(rows, " nn", ("", "Error", "Of tolerance"), strong=1)
    words = kept_words(found)
    pieces.note(f"{words[0].upper()}{words[1:]} (between {low} and {high}, as so many draws can tell).")
    for finding in found.findings:
        pieces.note(finding.sentence)
    _pictures(found, result)


def _pictures(found: Uncertainty, result: SimulationResult) -> None:
    here, beside = pieces.split((1, 1), "sure")
    now = float(from_si(result.verdict.share, "%"))
    used, sure = np.asarray(from_si(found.share, "%")), float(from_si(found.quantile(LEVEL, "share"), "%"))
    with here:
        pieces.figure(
            distribution(used, now, sure, dark=dark()),
            "improve-draws",
            table=found.columns,
            alt=f"Distribution of the tolerance used: {format_value(now, '%', 0)} predicted, "
            f"{format_value(sure, '%', 0)} in 95 % of the draws.",
            caption="How often which part of the tolerance is used.",
        )
    with beside:
        tornado = found.tornado
        names = [
            each.label + (" (± assumed)" if each.provenance.kind == "assumed" else "")
            for each in tornado.inputs[:SHOWN]
        ]
        low, high = (np.asarray(from_si(end[:SHOWN], "%")) for end in (tornado.low, tornado.high))
        pieces.figure(
            tornado_bars(names, low, high, now, dark=dark()),
            "improve-tornado",
            table=tornado.columns,
            alt="What each input alone does to the tolerance used: "
            + ", ".join(
                f"{name} {format_many(ends, '%', 0, ' to ')}"
                for name, *ends in zip(names[:3], tornado.low, tornado.high, strict=False)
            ),
            caption="Each alone at the ends of its 95 % interval. Measure the first one next: it makes "
            f"{format_percent(float(tornado.part[0]))} of the variance.",
        )


def _boxes(unit: str) -> None:
    """The standard deviations, six boxes in a row."""
    declared, stated = quantities(Spread), session.kept(KEPT, Spread())
    for column, name in zip(pieces.split((1,) * len(USUAL), "spread"), USUAL, strict=True):
        each = declared[name]
        own = IN_PARTS.get(name, unit if each.unit == "mm" else each.unit)
        digits = {"%": 1, "mm": 2, "in": 4}.get(own, 2)
        usual = NumberBox(each.label, own, digits).named(USUAL[name])
        box = NumberBox(each.label, own, digits, each.hint, low=0.0, optional=True, placeholder=f"{usual} assumed")
        with column:
            inputs.value(f"improve.spread.{name}", box, getattr(stated, name), partial(_state, name))


def _state(name: str, value: float | None) -> None:
    session.keep(KEPT, session.kept(KEPT, Spread()).replace(**{name: value}))
