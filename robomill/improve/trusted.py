"""Where no corrected program is made: its prediction is not to be trusted, or the arm cannot follow it."""

from __future__ import annotations

import numpy as np

from robomill.errors import CompensationError
from robomill.improve.correction import Correction
from robomill.provenance import named
from robomill.simulation.corners import FARTHEST
from robomill.simulation.judging.gauge import Gauge
from robomill.simulation.judging.verdict import judge
from robomill.simulation.judging.verdict_words import NO_NUMBER
from robomill.simulation.result import SimulationResult
from robomill.units import format_si, to_si

MOST_HELD = 0.05  # of the length cut: so much may have no force that agrees with its place
TURNED = to_si(5.0, "deg")  # a joint that stands further off than this stands otherwise


def check_trusted(run: SimulationResult, gauge: Gauge) -> None:
    """Raises CompensationError where the prediction itself is not to be trusted, by what was measured on it."""
    errors = [finding for finding in run.setup.toolpath.findings if finding.level == "error"]
    if errors:
        raise CompensationError(f"The path is not corrected: {errors[0].sentence}")
    verdict = judge(run, gauge)
    if verdict.level in NO_NUMBER:
        raise CompensationError(
            f"The path is not corrected, since its prediction is not to be trusted. {verdict.sentence}"
        )
    if run.coupling is not None and not run.coupling.converged:
        at = f"{run.path.block_name} {named(run.coupling.lines)}"
        raise CompensationError(
            f"The path is not corrected: at {at} {run.coupling.why}; cut less at once, or with a stiffer arm."
        )


def check_found(found: Correction, wanted: SimulationResult) -> None:
    """Raises CompensationError where path and force do not agree anywhere near the wanted path."""
    path = wanted.path
    size = np.linalg.norm(found.c, axis=1)
    cut = path.cutting & wanted.conditions.engaged
    length = float(path.step_length[cut].sum())
    held = float(path.step_length[found.held & cut].sum())
    if found.settled and size.max() > FARTHEST:
        i = int(np.argmax(size))
        raise CompensationError(
            f"The path is not corrected: at {path.block_name} {path.block[i]} the tool would be sent "
            f"{format_si(size[i], 'mm')} beside its path, and at most {format_si(FARTHEST, 'mm', 0)} can be trusted; "
            "cut less at once, or with a stiffer arm."
        )
    if found.settled and held <= MOST_HELD * length:
        return
    at = path.block[found.held & cut] if found.settled else path.block[[int(np.argmax(size))]]
    left = (
        ""
        if found.settled
        else f": after {found.iterations} runs it still changes by {format_si(found.change[-1], 'mm')}"
    )
    cure = "couple the force" if wanted.coupling is None else "make the arm stiffer"
    raise CompensationError(
        f"The path is not corrected: the correction does not settle ({path.block_name} {named(at.tolist())}){left}. "
        f"The force changes faster with the tool's place than the arm gives way; cut less at once, or {cure}."
    )


def check_reached(run: SimulationResult, wanted: SimulationResult) -> None:
    """Raises CompensationError where the arm does not follow the corrected path as it follows the wanted one."""
    path, place = wanted.path, wanted.path.block_name
    lost = wanted.reached & ~run.reached
    if lost.any():
        i = int(np.flatnonzero(lost)[0])
        raise CompensationError(
            f"The path is not corrected: at {place} {named(path.block[lost].tolist())} the corrected path is out of "
            f"reach ({run.ik.reason(i)}); move the part."
        )
    lost = path.cutting & ~np.isfinite(run.delta).all(axis=1)
    if run.coupling is not None:  # where force and deflection do not agree the program that is written is not judged
        lost &= ~np.isin(path.block, run.coupling.lines)
    if lost.any():
        raise CompensationError(
            f"The path is not corrected: at {place} {named(path.block[lost].tolist())} no force is known on the "
            "corrected path."
        )
    turned = np.abs(run.theta - wanted.theta)[:, ~np.array(wanted.setup.robot.chain.prismatic)[-run.theta.shape[1] :]]
    over = wanted.reached & (turned.max(axis=1, initial=0.0) > TURNED)
    if over.any():
        raise CompensationError(
            f"The path is not corrected: at {place} {named(path.block[over].tolist())} the arm would stand otherwise "
            "than on the path as it is, close to a singular configuration or a joint's limit; move the part."
        )
