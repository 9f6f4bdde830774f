"""How the tool meets the part along the path: stated (a full slot) or found from the stock as it stands."""

from __future__ import annotations

from typing import Any

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.cutting.conditions import CutConditions, cut_warnings
from robomill.cutting.force import feed_share
from robomill.simulation.samples import at_starts
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.tools import one_cutter, tooling
from robomill.toolpath.path import Toolpath


def cut_conditions(
    setup: SimulationSetup, path: Toolpath, reached: BoolArray, p: FloatArray | None = None
) -> CutConditions:
    """Conditions at each sample of ``path``.

    ``p`` (m, 3) m in {W}: where the tip really goes, if not where it was told to (coupled runs).
    """
    tip = path.p if p is None else p
    cutting = path.cutting & reached
    common: dict[str, Any] = {
        "v_f": path.v_f,
        "n_s": path.n_s,
        "s": path.s,
        "t": path.t,
        "cutting": cutting,
        "across": at_starts(path, feed_share(path.p, path.k)),
        "block": path.block,
    }
    if not setup.engagement:
        a_p = np.maximum(setup.stock_block.upper[2] - tip[:, 2], 0.0)
        return CutConditions.steady(a_p=np.nan_to_num(a_p), **common)
    from robomill.surface.engagement import engage

    found = engage(setup.stock_block, setup.cell, one_cutter(tooling(setup, path)), tip, path.k, cutting)
    arc: dict[str, Any] = {name: at_starts(path, getattr(found, name)) for name in ("a_p", "phi_st", "phi_ex")}
    return CutConditions(**arc, **common)


def moved_points(T_MW: FloatArray, path: Toolpath, reached: BoolArray, delta: FloatArray) -> FloatArray:
    """(m, 3) m in {W}: where the tip goes under ``delta`` (m, 3) m in {M}.

    A rapid arrives where the cut that follows it begins, and points that are not reached stay where they were told.
    """
    moved = np.where(reached[:, None], np.nan_to_num(delta), 0.0)
    arrives = np.flatnonzero(~path.cutting & np.append(path.cutting[1:], False))
    moved[arrives] = moved[arrives + 1]
    return np.asarray(path.p + moved @ T_MW[:3, :3])


def cut_notes(setup: SimulationSetup, conditions: CutConditions) -> tuple[str, ...]:
    """What a reader of the numbers must know about cutter, stock and force."""
    notes = [*setup.stock_block.warnings(setup.cutter), *setup.force.notes]
    if not setup.engagement and hasattr(setup.force, "material"):
        notes.append("The force is that of a full slot everywhere: the engagement with the part is switched off.")
    if conditions.a_p.any():
        notes += cut_warnings(setup.cutter, conditions)
    return tuple(notes)
