"""A study of the cut on the page: two or three of its numbers over ranges, many runs, their table and one picture."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.extras import missing
from robomill.frames import Columns
from robomill.simulation.estimate import run_seconds
from robomill.simulation.setup import SimulationSetup
from robomill.study.described import Study, load_study
from robomill.study.design import Kind
from robomill.study.kept import RESULTS
from robomill.study.local import processors
from robomill.study.running import StudyResult, run_study
from robomill.study.usual import Usual, usual_parameters
from robomill.study.writing import study_to_toml
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.ui.entry.box import NumberBox
from robomill.ui.entry.inputs import Look
from robomill.ui.judged.verdict import WORDS
from robomill.ui.shell import dark
from robomill.ui.work import cached
from robomill.units import (
    format_count,
    format_percent,
    format_si,
    format_significant,
    from_si,
    in_lengths,
    to_si,
    unit_label,
)
from robomill.viz.studied import response_dots, response_map

KEPT, PLACE = "improve.study", "improve.studying"
MOST, MOST_S = 1000, 300.0  # points and seconds of a study that is run beside a page
MOST_KEYS, STARTS_S = 3, 3.0  # parameters; s until the processes have begun
SHOWN = 6  # points in the table
KINDS: dict[Kind, str] = {"grid": "Grid", "latin_hypercube": "Latin hypercube", "sobol": "Sobol"}
RESPONSES = ("share", "wall_mm", "floor_mm", "max_deviation_mm", "verdict")
SHOWN_AS = {"share": "Of tolerance", "wall_mm": "Wall", "floor_mm": "Floor", "max_deviation_mm": "Tip"}


@dataclass(frozen=True)
class Asked:
    """What is asked of the page: the keys, ends (SI) that were typed by key, how points are chosen and how many; of a
    grid how many values each number takes."""

    keys: tuple[str, ...] = ()
    ends: dict[tuple[str, str], float] = field(default_factory=dict)
    kind: Kind = "grid"
    count: int = 64
    steps: int = 7


@dataclass(frozen=True, eq=False)
class Ran:
    """A study that was run, and its rows as Parquet."""

    result: StudyResult
    parquet: bytes


def panel(setup: SimulationSetup, unit: str) -> None:
    """What to study, and what came of it."""
    pieces.strong("A study: many runs of this cut")
    pieces.note("Up to three numbers over ranges; everything else stays as it is. Each point is a run of its own.")
    absent = missing("A study", "study", "pyarrow")
    if absent is not None:
        pieces.said("info", str(absent), "info")
        return
    offered = {each.key: each for each in usual_parameters(setup)}
    asked = _asked(offered, unit)
    if len(asked.keys) < 2:
        pieces.note("Choose two numbers, or three.")
        return
    study = pieces.attempt(described, setup, offered, asked)
    if study is None:
        return
    count = len(study.points)
    seconds = STARTS_S + count * run_seconds(setup) / _hands()
    short = count <= MOST and seconds <= MOST_S
    words = f"{format_count(count, 'point')}, about {format_si(seconds, 's', 0)}."
    if not short:
        words += (
            f" Here a study has at most {format_count(MOST, 'point')} and takes at most {format_si(MOST_S, 'min', 0)}: "
            "take the description along; the command line runs it on all processors, or on a cluster."
        )
    pieces.note(words)
    found = pieces.attempt(_ran, study) if short else None
    if found is not None:
        _shown(found, [offered[key] for key in study.keys], setup, unit)
    with st.container(horizontal=True, gap="small"):
        if found is not None:
            pieces.download("Parquet", found.parquet, pieces.named("study.parquet"), "improve.study.parquet")
        pieces.download("Description (TOML)", study_to_toml(study), pieces.named("study.toml"), "improve.study.toml")
    pieces.note(
        f"The command line runs it to the same numbers: robomill study {pieces.named('study.toml')} --out study"
    )


def _hands() -> int:
    """Processes of a study: one processor is left to the pages."""
    return max(processors() - 1, 1)


def described(setup: SimulationSetup, offered: dict[str, Usual], asked: Asked) -> Study:
    """The study that the boxes say. Raises StudyError where they contradict each other."""
    parameters: dict[str, Any] = {}
    for key in asked.keys:
        low, high = (offered[key].in_key(end) for end in _ends(offered[key], asked))
        parameters[key] = {"low": low, "high": high, **({"steps": asked.steps} if asked.kind == "grid" else {})}
    design: dict[str, Any] = {"kind": asked.kind}
    design |= {} if asked.kind == "grid" else {"points": asked.count}
    return load_study(
        {
            "setup": setup,
            "name": f"A study of {setup.name}",
            "design": design,
            "parameters": parameters,
            "responses": list(RESPONSES),
        }
    )


def _ran(study: Study) -> Ran:
    about = study.digest(), study.setup.provenance, study.setup.name
    found: Ran = cached.asked_for("Run the study", KEPT, about, partial(_run, study), PLACE, "play_arrow")
    return found


def _run(study: Study) -> Ran:
    with tempfile.TemporaryDirectory(prefix="robomill-study-") as folder:
        found = run_study(study, folder, processes=_hands())
        return Ran(found, (Path(folder) / RESULTS).read_bytes())


def _ends(each: Usual, asked: Asked) -> tuple[float, float]:
    return asked.ends.get((each.key, "low"), each.low), asked.ends.get((each.key, "high"), each.high)


def _asked(offered: dict[str, Usual], unit: str) -> Asked:
    """The boxes, and what they say."""
    names = {key: each.label for key, each in offered.items()}
    look = Look(listed=True, most=MOST_KEYS, placeholder="two or three numbers")
    inputs.several("Numbers", f"{KEPT}.keys", names, _now(offered).keys, lambda some: _say(keys=tuple(some)), look)
    for key in _now(offered).keys:
        _range(offered[key], _now(offered), unit)
    one, two = pieces.split((2, 1), "study")
    with one:
        inputs.choice("Points by", f"{KEPT}.kind", KINDS, _now(offered).kind, lambda kind: _say(kind=kind))
    with two:
        if _now(offered).kind == "grid":
            box = NumberBox("Values of each number", whole=True, low=2, high=100)
            inputs.value(f"{KEPT}.steps", box, _now(offered).steps, lambda number: _say(steps=int(number or 2)))
        else:
            box = NumberBox("Points", whole=True, low=4, high=1_000_000)
            inputs.value(f"{KEPT}.count", box, _now(offered).count, lambda number: _say(count=int(number or 4)))
    return _now(offered)


def _now(offered: dict[str, Usual]) -> Asked:
    """What is asked of this cut: at first its first two numbers."""
    asked: Asked | None = session.kept(KEPT)
    if asked is None or not all(key in offered for key in asked.keys):
        known = () if asked is None else tuple(key for key in asked.keys if key in offered)
        asked = replace(asked or Asked(), keys=known or tuple(offered)[:2])
        session.keep(KEPT, asked)
    return asked


def _say(**what: Any) -> None:
    session.keep(KEPT, replace(session.kept(KEPT, Asked()), **what))


def _range(each: Usual, asked: Asked, unit: str) -> None:
    """From where to where a number goes."""
    own = in_lengths(each.unit, unit)
    for column, which, end in zip(pieces.split((1, 1), f"study-{each.key}"), ("low", "high"), _ends(each, asked)):
        words = "from" if which == "low" else "to"
        now = NumberBox(each.label, own).named(each.now)
        box = NumberBox(f"{each.label}, {words}", own, hint=f"It is {now} now.")
        with column:
            inputs.value(f"{KEPT}.{each.key}.{which}", box, end, partial(_state, each.key, which))


def _state(key: str, which: str, value: float | None) -> None:
    asked: Asked = session.kept(KEPT, Asked())
    if value is not None:
        _say(ends={**asked.ends, (key, which): value})


def _shown(found: Ran, parameters: list[Usual], setup: SimulationSetup, unit: str) -> None:
    """How it went, the truest points, and a picture."""
    result = found.result
    lost = next((row.reason for row in result.rows if row.reason), "")
    words = f"{format_count(result.done, 'point')} done in {format_si(result.seconds, 's', 1)}."
    if lost:
        words += f" {format_count(result.failed, 'point')} failed: {lost}"
    pieces.note(words)
    if not result.done:
        return
    columns = result.columns()
    done = columns["reason"] == ""
    shares = np.where(done, columns["share"].astype(float), np.nan)
    said = {str(level): words for level, words in WORDS.items()}
    order = np.argsort(np.where(np.isfinite(shares), shares, np.inf), kind="stable")[: min(SHOWN, result.done)]
    rows = [
        [
            *(_value(each, float(columns[each.key][i]), unit) for each in parameters),
            format_percent(float(shares[i])) if np.isfinite(shares[i]) else "–",
            said[str(columns["verdict"][i])],
        ]
        for i in order
    ]
    head = [*(each.label for each in parameters), "Of tolerance", "Verdict"]
    pieces.strong("The truest points")
    pieces.table(rows, "n" * len(parameters) + "nv", head, strong=0)
    _picture(columns, done, parameters, (result, setup), unit)


def _value(each: Usual, value: float, unit: str) -> str:
    own = in_lengths(each.unit, unit)
    return f"{format_significant(from_si(to_si(value, each.unit), own), 4)} {unit_label(own)}".strip()


def _picture(
    columns: Columns, done: FloatArray, parameters: list[Usual], about: tuple[StudyResult, SimulationSetup], unit: str
) -> None:
    result, setup = about
    shown = {name: words for name, words in SHOWN_AS.items() if np.isfinite(columns[name][done].astype(float)).any()}
    named = {each.key: each.label for each in parameters}
    with st.container(horizontal=True, gap="medium"):
        response = inputs.pick("Shown", f"{KEPT}.shown", shown)
        x = inputs.pick("Across", f"{KEPT}.x", named)
    others = {key: label for key, label in named.items() if key != x}
    other = inputs.pick("Coloured by", f"{KEPT}.colour", others) if len(others) > 1 else next(iter(others))

    def of(key: str) -> tuple[str, FloatArray]:
        each = next(each for each in parameters if each.key == key)
        own = in_lengths(each.unit, unit)
        values = from_si(to_si(columns[key].astype(float), each.unit), own)
        return f"{each.label}, {unit_label(own)}".rstrip(", "), np.asarray(values)

    values = np.where(done, columns[response].astype(float), np.nan)
    if response == "share":
        told, limit = ("Of tolerance, %", np.asarray(from_si(values, "%"))), 100.0
    else:
        told = (f"{SHOWN_AS[response]}, {unit_label(unit)}", np.abs(from_si(to_si(values, "mm"), unit)))
        limit = float(from_si(setup.tolerance, unit))
    grid = result.study.kind == "grid" and len(parameters) == 2
    fig = (response_map if grid else response_dots)(of(x), of(other), told, limit, dark=dark())
    known = told[1][np.isfinite(told[1])]
    pieces.figure(
        fig,
        "improve-study",
        table=lambda: columns,
        alt=f"{told[0]} of {format_count(result.done, 'point')}: {known.min():.3g} to {known.max():.3g}.",
        caption="White line: the tolerance." if grid else "Each dot is a run.",
    )
