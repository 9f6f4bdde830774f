"""One remedy for the project's cut: stiffer joints, ranked by what they leave of what the verdict judges."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import streamlit as st

from robomill.improve.remedies import LEAST
from robomill.improve.stiffening import Stiffening, some_stiffer, stiffer_joints
from robomill.simulation.estimate import run_seconds
from robomill.simulation.judging.verdict_words import KINDS, TIP, Verdict
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.stations import joint_shares
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.ui.judged.verdict import WORDS, previous
from robomill.ui.work import cached
from robomill.units import format_percent, format_share, format_si, from_si, unit_label
from robomill.viz.shares import gain_bars
from robomill.wording import listed


def _seconds(setup: SimulationSetup) -> float:
    """About how long the ranking takes: a run as it is, and one for each joint."""
    return run_seconds(setup) * (setup.robot.n + 1)


@cached.shared(cached.by_setup, "Each joint alone twice as stiff", _seconds)
def found(setup: SimulationSetup) -> Stiffening:
    """The ranking, kept or made. Raises the simulation's refusal."""
    return stiffer_joints(setup, cached.result)


def meanwhile(result: SimulationResult) -> str:
    """Which joints make the error that decides; "" where none stands out."""
    kind, _, at = result.decided
    share, numbers = joint_shares(result, at, kind.axis), result.setup.robot.joint_numbers
    first = [int(j) for j in np.argsort(-share, kind="stable")[:2] if share[j] > LEAST]
    if not first:
        return ""
    parts = " and ".join(f"{format_percent(share[j])} from joint {numbers[j]}" for j in first)
    rest = 1.0 - float(share[first].sum())
    back = f"; all else takes {format_percent(-rest)} of it back" if rest < -LEAST else ""
    return f"The {kind.error} at line {result.path.block[at]} comes {parts}{back}."


def changed(result: SimulationResult) -> str:
    """What the last change of the robot has done to the verdict; "" where it was another change."""
    old = previous(result)
    if old is None or old.setup.replace(robot=result.setup.robot).digest() != result.setup.digest():
        return ""
    was, now = (format_share(each.verdict.share) for each in (old, result))
    return (
        f"With the last change of the robot {now} of the tolerance is used, {was} before it: "
        f"{WORDS[result.verdict.level].lower()}. Undo leads back."
    )


def sentence(ranked: Stiffening, joints: tuple[int, ...], unit: str) -> str:
    """Which joint saves most, in one line: what the verdict judges, now and then."""
    best = int(ranked.ranking[0])
    if not ranked.saved[best] > LEAST:
        return "No joint twice as stiff would make this cut noticeably truer."
    then = ranked.after[best]
    if ranked.with_together is not None:
        return (
            f"No joint alone brings the cut within tolerance: joint {joints[best]} twice as stiff still uses "
            f"{format_share(then.share)} of it (now {format_share(ranked.before.share)})."
        )
    now, left = _worst(ranked.before, ranked.tip[0], unit), _worst(then, ranked.tip[best + 1], unit)
    same = now.rpartition(" of ")[0] + " of "
    moves = f"{now} becomes {left.removeprefix(same)}" if left.startswith(same) else f"{left} decides, no more {now}"
    return (
        f"Joint {joints[best]} twice as stiff: {moves}; {WORDS[then.level].lower()} "
        f"({format_share(then.share)} of the tolerance used, now {format_share(ranked.before.share)})."
    )


def together(ranked: Stiffening, joints: tuple[int, ...]) -> str:
    """What the best joints do together where one alone is not enough; "" where it is."""
    then = ranked.with_together
    if then is None:
        return ""
    both = f"{_all([joints[i] for i in ranked.together])} together twice as stiff"
    if then.level != "out":
        return f"{both}: {WORDS[then.level].lower()}, {format_share(then.share)} of the tolerance used."
    return (
        f"{both} still use {format_share(then.share)} of the tolerance: a smaller cut (Milling), another place of the "
        "part (Toolpath) or more than twice the stiffness has to do the rest."
    )


def _worst(verdict: Verdict, tip: float, unit: str) -> str:
    """What decides the verdict, in words: "a wall error of 0.230 mm"."""
    if verdict.deciding is None:
        return f"{TIP.an_error} of {format_si(tip, unit)}"
    name, reading = verdict.deciding
    return f"{KINDS[name].an_error} of {format_si(abs(reading.value), unit)}"


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
    pieces.strong("Saved of the tolerance")
    pieces.figure(
        gain_bars(
            from_si(ranked.saved, "%"),
            unit_label("%"),
            0,
            joints,
            dark=dark,
            height=80 + 34 * len(joints),
        ),
        "improve-joints",
        name="stiffer-joints",
        table=lambda: columns(ranked, joints, unit),
        alt="How much less of the tolerance is used with each joint twice as stiff: "
        + ", ".join(f"joint {joints[i]} {format_percent(ranked.saved[i])}" for i in ranked.ranking),
        caption="Each joint alone twice as stiff, by a run of the same simulation with the same path and cut.",
    )


def remedies(ranked: Stiffening, joints: tuple[int, ...], unit: str) -> None:
    """The joints that save something, from best to least, what each leaves and its button; those that have to be
    stiffer together; the rest in a line."""
    idle: list[int] = []
    worse: list[int] = []
    for i in map(int, ranked.ranking):
        if not ranked.saved[i] > LEAST:
            (worse if ranked.saved[i] < -LEAST else idle).append(joints[i])
            continue
        then = ranked.after[i]
        words = f"{_verdict(then)}, {_worst(then, ranked.tip[i + 1], unit)}"
        _remedy(f"Joint {joints[i]}", words, f"Stiffen joint {joints[i]}", (i,))
    if ranked.with_together is not None:
        which = _all([joints[i] for i in ranked.together])
        _remedy(f"{which} together", _verdict(ranked.with_together), "Stiffen them all", ranked.together)
    if idle:
        pieces.note(f"{_all(idle)}: twice as stiff, the error that decides stays as it is.")
    if worse:
        pieces.note(f"{_all(worse)}: twice as stiff, more of the tolerance is used than now.")


def _all(numbers: list[int]) -> str:
    """``Joint 2``, ``Joints 1, 2 and 4``: each of them."""
    return f"Joint{'s' * (len(numbers) > 1)} {listed(map(str, sorted(numbers)))}"


def _verdict(then: Verdict) -> str:
    return f"{WORDS[then.level].lower()}, {format_share(then.share)} of the tolerance used"


def _remedy(what: str, words: str, label: str, joints: tuple[int, ...]) -> None:
    name = ".".join(str(session.project().setup.robot.joint_numbers[i]) for i in joints)
    with st.container(horizontal=True, vertical_alignment="center", gap="small"):
        with st.container(gap=None):
            pieces.strong(what)
            pieces.note(f"{words[0].upper()}{words[1:]}.")
        hint = "Halves the compliance in the project; undo leads back."
        inputs.button(label, f"improve.use.{name}", "", _use, joints, width="content", help=hint)


def _use(joints: Iterable[int]) -> None:
    session.change(robot=some_stiffer(session.project().setup.robot, joints))
