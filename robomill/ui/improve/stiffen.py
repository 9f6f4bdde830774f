"""One remedy for the project's cut: a stiffer joint, ranked by what it leaves of what the verdict judges."""

from functools import partial
from typing import Any

import streamlit as st

from robomill.improve.stiffening import Stiffening, one_stiffer, stiffer_joints
from robomill.provenance import named
from robomill.simulation.estimate import run_seconds
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.verdict_words import Verdict
from robomill.ui import cached, inputs, pieces, session
from robomill.ui import job as jobs
from robomill.ui.job import Job
from robomill.ui.verdict import WORDS, previous, share_words, tone
from robomill.units import format_percent, format_share, format_si, from_si, unit_label
from robomill.viz.shares import gain_bars

KEY, AT_ONCE_S = "improve.ranking", 1.0
LEAST = 0.005  # of the tolerance; what saves less is not offered
ERRORS = {
    "wall": "a wall error",
    "floor": "a floor error",
    "feed": "an error along the feed",
    "end": "an error of an end wall",
}


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


def changed(result: SimulationResult) -> str:
    """What the last change of the robot has done to the verdict; "" where it was another change."""
    old = previous(result)
    if old is None or old.setup.replace(robot=result.setup.robot).digest() != result.setup.digest():
        return ""
    was, now = (format_share(each.verdict.share) for each in (old, result))
    return f"With the last change of the robot {now} of the tolerance is used, {was} before it; undo leads back."


def sentence(ranked: Stiffening, joints: tuple[int, ...], unit: str) -> str:
    """Which joint saves most, in one line: what the verdict judges, now and then."""
    best = int(ranked.ranking[0])
    if not ranked.saved[best] > LEAST:
        return "No joint twice as stiff would make this cut noticeably truer."
    then = ranked.after[best]
    now, left = _worst(ranked.before, ranked.tip[0], unit), _worst(then, ranked.tip[best + 1], unit)
    same = now.rpartition(" of ")[0] + " of "
    return (
        f"Joint {joints[best]} twice as stiff: {now} becomes {left.removeprefix(same)}, {WORDS[then.level].lower()} "
        f"({format_share(then.share)} of the tolerance used, now {format_share(ranked.before.share)})."
    )


def _worst(verdict: Verdict, tip: float, unit: str) -> str:
    """What decides the verdict, in words: "a wall error of 0.230 mm"."""
    if verdict.deciding is None:
        return f"a deviation of the tip of {format_si(tip, unit)}"
    name, reading = verdict.deciding
    return f"{ERRORS[name]} of {format_si(abs(reading.value), unit)}"


def tiles(ranked: Stiffening, joints: tuple[int, ...], unit: str) -> list[pieces.Tile]:
    """What decides now, the best joint, what it leaves, and the verdict then."""
    best = int(ranked.ranking[0])
    then, saved = ranked.after[best], float(ranked.saved[best])
    if not saved > LEAST:
        return [_used("Used now", ranked.before, ranked.tip[0], unit)]
    return [
        _used("Used now", ranked.before, ranked.tip[0], unit),
        pieces.Tile("Stiffen first", f"joint {joints[best]}", f"saves {format_percent(saved)} of the tolerance"),
        _used("Used then", then, ranked.tip[best + 1], unit),
        pieces.Tile("Verdict then", WORDS[then.level], share_words(then), tone=tone(then)),
    ]


def _used(label: str, verdict: Verdict, tip: float, unit: str) -> pieces.Tile:
    words = f"of the tolerance: {_worst(verdict, tip, unit)}"
    return pieces.Tile(label, format_share(verdict.share), words, kind="computed")


def columns(ranked: Stiffening, joints: tuple[int, ...], unit: str) -> dict[str, list[Any]]:
    """The ranking as a table, best first: shares of the tolerance, errors of wall and floor, the tip's deviation."""
    order, tip = ranked.ranking, from_si(ranked.tip, unit)
    found: dict[str, list[Any]] = {
        "joint": [str(joints[i]) for i in order],
        "used_now_%": [float(from_si(ranked.before.share, "%"))] * len(order),
        "used_then_%": [float(from_si(ranked.used[i], "%")) for i in order],
    }
    for name in ("wall", "floor"):
        found[f"{name}_{unit}"] = [float(from_si(getattr(ranked.after[i], name).value, unit)) for i in order]
    return {**found, f"tip_{unit}": [float(tip[i + 1]) for i in order], "verdict": _levels(ranked)}


def _levels(ranked: Stiffening) -> list[str]:
    return [WORDS[ranked.after[i].level].lower() for i in ranked.ranking]


def ranking(ranked: Stiffening, joints: tuple[int, ...], unit: str, dark: bool) -> None:
    """The bars with their table."""
    pieces.figure(
        gain_bars(
            "Saved of the tolerance",
            from_si(ranked.saved, "%"),
            unit_label("%"),
            joints,
            dark=dark,
            height=88 + 34 * len(joints),
        ),
        "improve-joints",
        name="stiffer-joints",
        table=lambda: columns(ranked, joints, unit),
        alt="How much less of the tolerance is used with each joint twice as stiff: "
        + ", ".join(f"joint {joints[i]} {format_percent(ranked.saved[i])}" for i in ranked.ranking),
        caption="Each joint alone twice as stiff, by a run of the same simulation with the same path and cut.",
    )


def remedies(ranked: Stiffening, joints: tuple[int, ...], unit: str) -> None:
    """The joints that save something, from best to least, what each leaves and its button; the rest in a line."""
    idle = []
    for i in map(int, ranked.ranking):
        if not ranked.saved[i] > LEAST:
            idle.append(joints[i])
            continue
        words, button = st.columns([2.2, 1], vertical_alignment="center")
        then = ranked.after[i]
        words.markdown(
            f"**Joint {joints[i]}**: {format_share(then.share)} of the tolerance used, "
            f"{_worst(then, ranked.tip[i + 1], unit)}"
        )
        with button:
            hint = "Halves this joint's compliance in the project; undo leads back."
            inputs.button(
                f"Stiffen joint {joints[i]}", f"improve.use.{joints[i]}", "check", _use, i, width="stretch", help=hint
            )
    if idle:
        pieces.note(
            f"Joint{'s' * (len(idle) > 1)} {named(idle)}: twice as stiff, the error that decides stays as it is."
        )


def _use(joint: int) -> None:
    session.change(robot=one_stiffer(session.project().setup.robot, joint))
