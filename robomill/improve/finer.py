"""What a corrected program leaves where it is looked at more closely than the set-up asks: between two samples, too."""

from __future__ import annotations

import numpy as np

from robomill.improve.errors import Errors, errors_of, measured
from robomill.provenance import Finding
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import ran
from robomill.units import format_si

CLOSE = 0.25e-3  # m: as closely is looked,
MANY = 8_000  # samples: where a program's cuts have no more of them
ALIKE = 5e-6  # m: residuals that differ by no more are one


def closer(led: SimulationResult, told: Errors) -> tuple[Finding, ...]:
    """What the run ``led`` of a corrected program leaves between its samples, where that is more than is ``told``."""
    setup = led.setup
    if setup.step <= CLOSE or setup.toolpath.step_length[setup.toolpath.cutting].sum() > MANY * CLOSE:
        return ()
    run = ran(setup.replace(step=CLOSE))
    gauge = measured(run)
    found = errors_of(run, gauge)
    text = []
    for name, readings in (("wall", gauge.walls), ("floor", gauge.floors)):
        there, here = getattr(found, name)[0], np.nan_to_num(getattr(told, name)[0])
        if np.isfinite(there) and there > here + ALIKE:
            line = run.path.block[readings.sample[readings.worst]]
            where = f"{run.path.block_name} {line}"
            text.append(f"{format_si(there, 'mm')} at a {name} ({where}), not {format_si(here, 'mm')}")
    if not text:
        return ()
    close, asked = format_si(CLOSE, "mm", 2), format_si(setup.step, "mm", 1)
    said = (
        f"looked at every {close} instead of every {asked}, it leaves {' and '.join(text)}: the force jumps between "
        f"two samples, or a short wall lies there; a step of {close} corrects what can be."
    )
    return (Finding("warning", said, code="between-samples"),)
