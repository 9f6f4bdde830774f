"""Runs along a path beside the one that was meant, measured against that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray, next_true, stretches
from robomill.cutting.conditions import CutConditions
from robomill.cutting.tool import DISH
from robomill.simulation.corners import SAME
from robomill.simulation.cut import Led, met_conditions, through_stock
from robomill.simulation.result import SimulationResult
from robomill.simulation.samples import arrivals, ways
from robomill.simulation.setup import SimulationSetup
from robomill.surface.contact.engagement import engagement
from robomill.toolpath.path import Toolpath
from robomill.vectors import across


def plunges(path: Toolpath, conditions: CutConditions) -> tuple[IntArray, BoolArray]:
    """(m,) of samples on the way down the first one of the level cut that goes on from there, else -1; (m,) plunges."""
    down = path.cutting & (conditions.along < -DISH)
    steep = conditions.mostly_axial
    then = np.append(next_true(~down, len(path))[1:], len(path))  # the first sample behind that does not go down
    level = np.append(path.cutting & ~down & ~steep, False)
    return np.where(down & level[then], then, -1), steep


def led_beside(path: Toolpath, p: FloatArray, down: tuple[IntArray, BoolArray], links: BoolArray | None = None) -> Led:
    """The tool that is sent to p (m, 3) m in {W} to go along ``path``, in whose direction it feeds. What goes ``down``
    (see ``plunges``) meets the part where the cut does that goes on from there: both were meant to be at one place; how
    deep a plunge is, it says itself. ``links`` (m,) are samples on the way from one cut to the next, which are no steps
    of either."""
    then, steep = down
    behind = np.arange(len(p)) if links is None else _behind(links)
    ahead = p - path.p
    deep = np.where(steep[:, None], ahead - across(ahead, path.k), 0.0)
    met = path.p + across(ahead[behind[then]], path.k) + deep
    tips = np.where((then >= 0)[:, None], met, p)[behind]
    arrives = arrivals(path)
    tips[arrives] = tips[arrives + 1]  # the way there is no cut
    way = ways(path)
    back = np.einsum("mi,mi->m", np.diff(tips, axis=0, prepend=tips[:1]), way) < 0.0
    back &= path.step_length > 0.0  # a link is no step of the cut
    return Led(path.p, np.where(back[:, None], ways(replace(path, p=tips)), way), tips)


def led_conditions(setup: SimulationSetup, path: Toolpath, told: CutConditions, led: Led) -> CutConditions:
    """What is told, with what each step meets of a tool that is ``led``.

    What is cut is cut where the tool is sent, and where a later plunge comes down the floor is beside that by what the
    arm gave way. So a plunge that would meet nothing where every tool is meant to be meets nothing.
    """
    march = through_stock(setup, path, told, led)
    rows, sectors = march.run()
    found = engagement(march.exponents, rows, sectors)
    down = told.cutting & told.plunges
    if (down & found.part.touches).any():
        free = engagement(march.exponents, *through_stock(setup, path, told, replace(led, tips=led.meant)).run())
        rows, sectors = rows.copy(), sectors.copy()
        for some in (slice(begin, past) for begin, past in stretches(down)):
            if not free.part.touches[some].any():
                rows[some], sectors[some] = 0.0, 0.0
        found = engagement(march.exponents, rows, sectors)
    return met_conditions(told, found)


def _behind(links: BoolArray) -> IntArray:
    """(m,) samples themselves, and for those on ``links`` (m,) the first one behind the link."""
    return next_true(~links, len(links) - 1)


def tip_error(run: SimulationResult, wanted: Toolpath) -> FloatArray:
    """(m, 3) m in {W}: the tip of a run against the ``wanted`` path, sample by sample."""
    return np.asarray(run.path.p - wanted.p + run.setup.to_part(run.delta))


def against(
    run: SimulationResult,
    wanted: Toolpath,
    R_MF: FloatArray,
    links: BoolArray | None = None,
    untold: BoolArray | None = None,
) -> SimulationResult:
    """The run along a corrected path as one that was told to go along the ``wanted`` one, whose axes of the cut are
    R_MF (m, 3, 3); where nobody knows how far along it that is, ``untold`` (m,), the tip is told from the place that it
    comes by. What a gauge reads on it is the error of the part. On ``links`` (m,) from one cut to the next it is taken
    to be where the next begins, as on one in the air to where it touches: how far the tip springs there is told
    apart."""
    off, ahead = (
        np.where(wanted.cutting[:, None], each, 0.0) for each in (tip_error(run, wanted), run.path.p - wanted.p)
    )
    if untold is not None:
        way = ways(wanted)
        lag = np.where(untold, np.einsum("mi,mi->m", off, way), 0.0)[:, None] * way
        off, ahead = off - lag, ahead - lag
    off, ahead = run.setup.to_base(off), run.setup.to_base(ahead)
    told = replace(run, path=wanted, delta=off, R_MF=R_MF, ahead=ahead, untold=untold)
    if links is None:
        return told
    of = _behind(links | (wanted.cutting & (wanted.step_length < SAME) & ~run.conditions.engaged))
    rows = {name: getattr(told, name)[of] for name in ("F", "delta_joint", "delta_spring", "delta", "ahead")}
    unjudged = tuple(replace(each, where=each.where[of]) for each in told.unjudged)
    return replace(told, **rows, unjudged=unjudged, untold=None if untold is None else untold[of])
