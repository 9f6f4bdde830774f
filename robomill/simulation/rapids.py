"""Rapids that run through material: a machine would break the tool there, and the simulation must say so."""

from __future__ import annotations

import numpy as np

from robomill.provenance import Finding, named
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.tools import tooling
from robomill.surface.zmap import cut
from robomill.toolpath.path import Toolpath

LEAST_VOLUME = 1e-12  # m^3: less than this is rounding at a wall
MANY = 2000


def rapids_through_material(setup: SimulationSetup, path: Toolpath) -> tuple[Finding, ...]:
    """Rapids that pass through material which no cut of the program removes, by their source lines.

    Told by cutting the stock once with the feed moves and once with all; so a rapid through material that is cut
    only later is not found. Looks at most at ``MANY`` rapids one by one.
    """
    moves = path.step_length > 0
    feed, rapid = moves & path.cutting, moves & ~path.cutting
    rapid[0] = False
    low, high = setup.stock_block.lower, setup.stock_block.upper
    tools = tooling(setup, path)
    widest = max(cutter.radius for cutter in tools.cutters)
    reach = np.array([widest, widest, 0.0])
    ends = np.stack([np.roll(path.p, 1, axis=0), path.p])
    near = (ends.min(axis=0) <= high + reach).all(axis=1) & (ends.max(axis=0)[:, :2] >= (low - reach)[:2]).all(axis=1)
    suspects = np.flatnonzero(rapid & near)
    if not len(suspects):
        return ()

    def volume(chosen: np.ndarray) -> float:
        if not chosen.any():
            return 0.0
        zmap = cut(setup.stock_block, setup.cell, tools, path.p, path.k, chosen, must_touch=False)
        return zmap.removed_volume

    def with_rapids(indices: np.ndarray) -> float:
        chosen = feed.copy()
        chosen[indices] = True
        return volume(chosen)

    base = volume(feed)
    if with_rapids(suspects) - base <= LEAST_VOLUME:
        return ()
    bad = [int(path.block[i]) for i in suspects[:MANY] if with_rapids(np.array([i])) - base > LEAST_VOLUME]
    if not bad:
        return ()
    first, *others = sorted(set(bad))
    also = f" (also line {named(others)})" if others else ""
    text = f"a rapid runs through material that no cut removes; lift the tool first{also}."
    return (Finding("warning", first, text, code="rapid-in-material"),)
