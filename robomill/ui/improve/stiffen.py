"""One remedy for the project's cut: a stiffer joint, ranked by what it leaves of the largest deviation."""

from functools import partial
from typing import Any

import streamlit as st

from robomill.improve.stiffening import Stiffening, one_stiffer, stiffer_joints
from robomill.simulation.estimate import run_seconds
from robomill.simulation.setup import SimulationSetup
from robomill.ui import cached, inputs, pieces, session
from robomill.ui import job as jobs
from robomill.ui.job import Job
from robomill.ui.verdict import WORDS, share_words, tone
from robomill.units import format_si, from_si, unit_label
from robomill.viz.shares import gain_bars

KEY, AT_ONCE_S = "improve.ranking", 1.0


def found(setup: SimulationSetup) -> Stiffening | None:
    """The ranking: at once where that is short, else beside the page when it is asked for. Raises the simulation's
    refusal."""
    if run_seconds(setup) * (setup.robot.n + 1) <= AT_ONCE_S:
        return stiffer_joints(setup, cached.result)
    job: Job | None = session.kept(KEY)
    if job is None or job.about.digest() != setup.digest():
        return None
    ended = jobs.finished(KEY, AT_ONCE_S)
    if ended is None:
        return None
    if ended.error is not None:
        raise ended.error
    made: Stiffening | None = ended.made
    return made


def ask(setup: SimulationSetup) -> None:
    """The button that ranks the joints of a long path, or how far that has come."""
    if session.kept(KEY) is not None and session.kept(KEY).about.digest() == setup.digest():
        jobs.waiting(KEY, lambda job: f"Cutting once with each joint twice as stiff: {job.progress.stage}")
        return
    rank = Job(partial(stiffer_joints, setup, cached.result), setup)
    inputs.button("Rank the joints", "improve.rank", "play_arrow", jobs.begin, KEY, rank, type="primary")
    pieces.note(f"Not computed yet: the cut is simulated {setup.robot.n} times more, once for each joint.")


def sentence(ranked: Stiffening, joints: tuple[int, ...], unit: str) -> str:
    """Which joint saves most, in one line."""
    best = int(ranked.ranking[0])
    if not ranked.saved[best] > 0:
        return "No joint twice as stiff would make the largest deviation of this cut smaller."
    before, after = (format_si(float(v), unit) for v in (ranked.before, ranked.after[best]))
    return f"Joint {joints[best]} twice as stiff would bring the largest deviation from {before} to {after}."


def tiles(ranked: Stiffening, joints: tuple[int, ...], setup: SimulationSetup, unit: str) -> list[pieces.Tile]:
    """The deviation now, the best joint, what it leaves, what the tolerance asks."""
    best = int(ranked.ranking[0])
    after, saved = float(ranked.after[best]), float(ranked.saved[best])
    verdict = ranked.verdict
    return [
        pieces.Tile("Max deviation", format_si(ranked.before, unit), "as the robot is", kind="computed"),
        pieces.Tile("Stiffen first", f"joint {joints[best]}", f"saves {format_si(saved, unit)}"),
        pieces.Tile("Then", format_si(after, unit), "with that joint twice as stiff", kind="computed"),
        pieces.Tile("Verdict then", WORDS[verdict.level], share_words(verdict), tone=tone(verdict)),
    ]


def columns(ranked: Stiffening, joints: tuple[int, ...], unit: str) -> dict[str, list[Any]]:
    """The ranking as a table, best first, in display units."""
    order = ranked.ranking
    return {
        "joint": [str(joints[i]) for i in order],
        f"now_{unit}": [float(from_si(ranked.before, unit))] * len(order),
        f"twice_as_stiff_{unit}": [float(from_si(ranked.after[i], unit)) for i in order],
        f"saved_{unit}": [float(from_si(ranked.saved[i], unit)) for i in order],
    }


def ranking(ranked: Stiffening, joints: tuple[int, ...], unit: str, dark: bool) -> None:
    """The bars with their table."""
    pieces.figure(
        gain_bars(
            [("largest deviation, less", from_si(ranked.saved, unit), unit_label(unit))],
            joints,
            dark=dark,
            height=88 + 34 * len(joints),
        ),
        "improve-joints",
        name="stiffer-joints",
        table=lambda: columns(ranked, joints, unit),
        alt="How much smaller the largest deviation becomes with each joint twice as stiff.",
        caption="Each joint alone twice as stiff, by a run of the same simulation with the same path and cut.",
    )


def remedies(ranked: Stiffening, joints: tuple[int, ...], unit: str) -> None:
    """The joints from best to least, each with its numbers and its button."""
    for i in map(int, ranked.ranking):
        words, button = st.columns([2.2, 1], vertical_alignment="center")
        after, saved = (format_si(float(v), unit) for v in (ranked.after[i], ranked.saved[i]))
        words.markdown(f"**Joint {joints[i]}**: {after} left, {saved} saved")
        with button:
            hint = "Halves this joint's compliance in the project; undo leads back."
            inputs.button("Use it", f"improve.use.{joints[i]}", "check", _use, i, width="stretch", help=hint)


def _use(joint: int) -> None:
    session.change(robot=one_stiffer(session.project().setup.robot, joint))
