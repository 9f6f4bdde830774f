"""What a run that takes each step as if the tool had gone where it was told leaves out: the cut of a deflected tool."""

import numpy as np

from robomill.arrays import FloatArray
from robomill.cutting.conditions import CutConditions
from robomill.cutting.force import force_on_tool
from robomill.provenance import Finding
from robomill.simulation.cut import Led, met_conditions, through_stock
from robomill.simulation.judging.premise import NONE, Premise
from robomill.simulation.judging.seen import Run
from robomill.simulation.judging.verdict_words import Verdict
from robomill.simulation.meant import LINK
from robomill.simulation.samples import ways
from robomill.surface.contact.engagement import engage
from robomill.units import format_share

FELT = 0.05  # of the tolerance: a step that would be off by less otherwise moves no reading that counts
OFF = "Coupling (deflection feeds back on the force) is off"  # in the words of its switch
MORE = 0.1  # of the tolerance: so much more than was read is told


def met_where_pushed(run: Run) -> tuple[CutConditions, FloatArray]:
    """Conditions and force F (m, 3) N in {M} of what the deflected tool meets: where it really goes, in the stock that
    its earlier passes really left. This is the first step of the way to a coupled run: its size, not its number. Of
    a corrected program the force is as it was where the tool just touches or sinks, whose push is there or not and
    hardly more in deeper cuts, and where it goes from one correction to the next: that is told apart."""
    led = Led(run.path.p, ways(run.path), run.p_machined)
    met = met_conditions(run.conditions, engage(through_stock(run.setup, run.path, run.conditions, led)))
    F = force_on_tool(run.setup.force, met, run.R_MF)
    if run.ahead is not None:
        jumps = np.linalg.norm(np.diff(run.ahead, axis=0), axis=1) > LINK
        jumps = (
            np.append(jumps, False)
            | np.append(False, jumps)
            | (met.engaged != run.conditions.engaged)
            | (met.sinks > 0.0)
        )
        F = np.where(jumps[:, None], run.F, F)
    return met, F


def moves_a_reading(run: Run, pushed: Run) -> bool:
    """Whether what the deflected tool meets has ``pushed`` it elsewhere by so much that a verdict may be another."""
    limits = np.array([run.setup.limits["wall"], run.setup.limits["floor"]])
    change = np.abs(pushed.delta_in_cut - run.delta_in_cut)[run.judged, 1:]
    return bool((change > FELT * limits).any())


def coupling_notes(verdict: Verdict, pushed: Verdict, place: str) -> tuple[Finding, ...]:
    """Whether the ``verdict`` of a run without coupling would be another, or a tenth of the tolerance worse, where what
    the deflected tool meets has ``pushed`` it; that one is decided at ``place``."""
    here, there = verdict.share, pushed.share
    if not (there > here + MORE or (there > here and pushed.level != verdict.level)):
        return ()
    text = (
        f"{OFF}, so the tool is taken to cut where it is told to. Where it is pushed to, and after earlier passes that "
        f"were pushed off, too, {_used(pushed, place)}, not {format_share(here)}: switch coupling on."
    )
    return (Finding("warning", text, code="uncoupled"),)


def left_open(verdict: Verdict, pushed: Verdict, place: str) -> Premise:
    """On what the green ``verdict`` of a run without coupling rests where that of what the deflected tool meets would
    be red: clearly, since it is the first step towards a coupled run only, where ``verdict`` is tight already."""
    if not pushed.share > (1.0 if verdict.level == "ok" else 1.0 + MORE):
        return NONE
    asked = f"{OFF}, and where the tool is pushed to, {_used(pushed, place)}: switch it on. Not judged."
    return Premise("if the tool cuts where it is told to", asked)


def _used(pushed: Verdict, place: str) -> str:
    return f"about {format_share(pushed.share)} of the tolerance would be used ({place})"
