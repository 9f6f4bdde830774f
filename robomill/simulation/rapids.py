"""Rapids that run through material: a machine would break the tool there, and the simulation must say so."""

from collections.abc import Sequence

import numpy as np

from robomill.provenance import Finding, named
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.tools import tooling
from robomill.surface.stock import fitting_cell
from robomill.surface.zmap import cut
from robomill.toolpath.path import Toolpath

LEAST_DEPTH = 1e-6  # m: less than this is rounding
MANY = 50  # lines: more are not looked for
MOST_CELLS = 4_000_000  # a large block is looked at in larger cells than it is cut in


def rapid_notes(lines: Sequence[int]) -> tuple[Finding, ...]:
    """Rapids that break the tool, by their lines."""
    if not lines:
        return ()
    also = f" (also line {named(lines[1:])})" if len(lines) > 1 else ""
    text = f"a rapid runs through material that no cut removes; lift the tool first{also}."
    return (Finding("warning", lines[0], text, code="rapid-in-material"),)


def rapids_through_material(setup: SimulationSetup, path: Toolpath) -> tuple[int, ...]:
    """Source lines of rapids that pass through material which no cut of the program removes, in order.

    Told by cutting the stock once with the feed moves and once with all, at the cells' centres, where heights are
    exact; so a rapid through material that is cut only later is not found. The first ``MANY`` lines are found.
    """
    moves = path.step_length > 0
    feed, rapid = moves & path.cutting, moves & ~path.cutting
    rapid[: np.argmax(moves) + 1] = False  # where the machine stands before its first move is not known
    low, high = setup.stock_block.lower, setup.stock_block.upper
    tools = tooling(setup, path)
    widest = max(cutter.radius for cutter in tools.cutters)
    reach = np.array([widest, widest, 0.0])
    ends = np.stack([np.roll(path.p, 1, axis=0), path.p])
    near = (ends.min(axis=0) <= high + reach).all(axis=1) & (ends.max(axis=0)[:, :2] >= (low - reach)[:2]).all(axis=1)
    suspects = np.flatnonzero(rapid & near)
    if not len(suspects):
        return ()

    length, width, _ = setup.stock_block.size
    cell = max(setup.cell, fitting_cell(float(length), float(width), MOST_CELLS))

    def heights(rapids: np.ndarray) -> np.ndarray:
        chosen = feed.copy()
        chosen[rapids] = True
        return cut(setup.stock_block, cell, tools, path.p, path.k, chosen, must_touch=False).z

    base = heights(np.zeros(0, dtype=int))

    def cuts(rapids: np.ndarray) -> bool:
        return bool((base - heights(rapids)).max() > LEAST_DEPTH)

    bad: set[int] = set()

    def look(rapids: np.ndarray) -> None:
        """Halve a group that cuts until single rapids are left."""
        if len(bad) >= MANY or not len(rapids) or not cuts(rapids):
            return
        if len(rapids) == 1:
            bad.add(int(path.block[rapids[0]]))
            return
        for half in np.array_split(rapids, 2):
            look(half)

    look(suspects)
    return tuple(sorted(bad))
