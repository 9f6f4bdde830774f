"""How the tool meets the part along the path: stated (a full slot) or found from the stock as it stands."""

from __future__ import annotations

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.cutting.conditions import CutConditions, cut_warnings
from robomill.cutting.force import feed_share
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath


def cut_conditions(
    setup: SimulationSetup, path: Toolpath, reached: BoolArray, p: FloatArray | None = None
) -> tuple[CutConditions, tuple[str, ...]]:
    """Conditions at each sample of ``path`` and what is to be said about them.

    ``p`` (m, 3) m in {W}: where the tip really goes, if not where it was told to (coupled runs).
    """
    tip = path.p if p is None else p
    cutting = path.cutting & reached
    common = {
        "v_f": path.v_f, "n_s": path.n_s, "s": path.s, "t": path.t, "cutting": cutting,
        "across": _across(path), "block": path.block,
    }  # fmt: skip
    if setup.engagement:
        from robomill.surface.engagement import engage

        engagement = engage(setup.stock_block, setup.cell, setup.cutter, tip, path.k, cutting)
        conditions = CutConditions(a_p=engagement.a_p, phi_st=engagement.phi_st, phi_ex=engagement.phi_ex, **common)
    else:
        a_p = np.maximum(setup.stock_block.upper[2] - tip[:, 2], 0.0)
        conditions = CutConditions.steady(a_p=np.nan_to_num(a_p), **common)
    return conditions, cut_warnings(setup.cutter, conditions) + setup.stock_block.warnings(setup.cutter)


def _across(path: Toolpath) -> FloatArray:
    """(m,) share of the feed across the tool axis; a step of no length takes the next one's."""
    share = np.array(feed_share(path.p, path.k))
    still = np.flatnonzero(path.step_length == 0.0)
    still = still[still + 1 < len(path)]
    share[still] = share[still + 1]
    return share
