"""How the tool meets the part along the path: stated (a full slot) or found from the stock as it stands."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.cutting.conditions import CutConditions, cut_warnings
from robomill.cutting.force import feed_along, feed_share
from robomill.cutting.tool import DISH
from robomill.cutting.unjudged import Unjudged
from robomill.errors import SetupError
from robomill.progress import gathered
from robomill.provenance import Finding
from robomill.simulation.samples import clock, ways
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.tools import tooling
from robomill.surface.contact.engagement import Engagement, engage
from robomill.surface.contact.march import March
from robomill.surface.stock_unit import unit_doubt
from robomill.toolpath.path import ROTARY_ASKED, Toolpath
from robomill.units import format_short

SUSPECTED = 0.1  # of a force's size: that much along the feed is suspected
SEEN = 4.0  # steps a tool's width: what the tool is in for half its width is met twice


@dataclass(frozen=True, eq=False)
class Led:
    """A tool that, pushed off, goes otherwise than it is told to, in {W}: where it is ``meant`` to go (m, 3) m, which
    says what a step is, the unit feeds ``way`` (m, 3) that it has, and where ``tips`` (m, 3) m it meets the part."""

    meant: FloatArray
    way: FloatArray
    tips: FloatArray


def steps_in_stock(setup: SimulationSetup, path: Toolpath) -> FloatArray:
    """(m,) m: how long the steps of a move may be at most so that no material is passed over: a share of the tool's
    width where its body comes near the stock, any length elsewhere."""
    width, stock = tooling(setup, path).each("diameter"), setup.stock_block
    before = np.roll(path.p, 1, axis=0)
    low, high = np.minimum(path.p, before), np.maximum(path.p, before)
    reach = (width + _aside(path, stock.upper[2] - low[:, 2]))[:, None]
    beside = (high[:, :2] + reach < stock.lower[:2]) | (low[:, :2] - reach > stock.upper[:2])
    near = ~beside.any(axis=1) & (low[:, 2] - width < stock.upper[2])
    return np.where(near, width / SEEN, np.inf)


def over_stock(setup: SimulationSetup, path: Toolpath) -> BoolArray:
    """(m,) samples where the cutter reaches into the block of the stock: what is further off cuts air."""
    block, p = setup.stock_block, path.p
    depth = block.upper[2] - p[:, 2]
    beside = np.linalg.norm(np.maximum(np.maximum(block.lower - p, p - block.upper), 0.0)[:, :2], axis=1)
    reach = tooling(setup, path).each("radius") + _aside(path, depth)
    return np.asarray((beside < reach - 1e-9) & (depth > 1e-9))


def _aside(path: Toolpath, depth: FloatArray) -> FloatArray:
    """(m,) m: how far beside its tip a tool that leans goes through the top of a block, ``depth`` (m,) m above it."""
    lean = np.linalg.norm(path.k[:, :2], axis=1) / np.maximum(path.k[:, 2], DISH)
    return np.asarray(np.maximum(depth, 0.0) * lean)


def told_conditions(
    setup: SimulationSetup, path: Toolpath, reached: BoolArray, led: Led | None = None
) -> CutConditions:
    """What the program alone says of every sample: feeds, speeds, tools, and a full slot as deep as the tip stands
    within the stock's block."""
    a_p = np.where(over_stock(setup, path), setup.stock_block.upper[2] - path.p[:, 2], 0.0)
    way = ways(path) if led is None else led.way
    told = CutConditions.steady(
        path.v_f,
        path.n_s,
        np.nan_to_num(a_p),
        s=path.s,
        t=record_time(setup, path) if setup.force.in_time else path.t,
        cutting=path.cutting & reached,
        across=gathered(len(path), "", lambda some: feed_share(way[some], path.k[some])),
        along=gathered(len(path), "", lambda some: feed_along(way[some], path.k[some])),
        ccw=path.ccw,
        block=path.block,
        block_name=path.block_name,
    )
    return replace(told, tooling=tooling(setup, path))


def cut_conditions(setup: SimulationSetup, path: Toolpath, told: CutConditions) -> CutConditions:
    """What is told, with what each step meets where the tool goes as it is told."""
    return met_conditions(told, engage(through_stock(setup, path, told)))


def through_stock(
    setup: SimulationSetup,
    path: Toolpath,
    told: CutConditions,
    led: Led | None = None,
    looked: FloatArray | None = None,
) -> March:
    """The path through its stock, ready to be marched; ``looked`` as in ``March``."""
    assert told.tooling is not None
    exponents = setup.force.exponents or (0.0,)
    p, way, tips = (path.p, ways(path), None) if led is None else (led.meant, led.way, led.tips)
    block, cell = setup.stock_block, setup.cell
    return March(block, cell, told.tooling, p, path.k, told.cutting, exponents, tips, way, told.sinks, looked)


def met_conditions(told: CutConditions, found: Engagement) -> CutConditions:
    """What was told, with what each step really meets."""
    arc: dict[str, Any] = {name: getattr(found, name) for name in ("a_p", "phi_st", "phi_ex", "reach", "part")}
    return told.meeting(**arc)


def unknown_material(conditions: CutConditions) -> tuple[Unjudged, ...]:
    """Steps before which leaning cutters have cut more gaps above each other than a column of the stock can keep."""
    known = None if conditions.part is None else conditions.part.known
    where = np.zeros(len(conditions), dtype=bool) if known is None else conditions.cutting & ~known
    why = (
        "leaning cuts leave more layers of material above each other than are kept apart, so what stands there is not "
        "known: cut fewer above each other, or part the program"
    )
    return Unjudged.at("layers", where, why)


def rotary_asked(path: Toolpath, conditions: CutConditions) -> tuple[Unjudged, ...]:
    """All cuts of a program that turns far, while nobody has said whether its table or its tool does."""
    if not any(each.code == ROTARY_ASKED for each in path.findings):
        return ()
    why = "the program turns an axis far, or C beside a lean: say whether it turns the part or leans the tool"
    return (Unjudged(ROTARY_ASKED, conditions.cutting.copy(), why),)


def record_time(setup: SimulationSetup, path: Toolpath) -> FloatArray:
    """(m,) s in a record that began with the first cut. Raises SetupError where the time of a rapid is not known."""
    t = clock(path, setup.rapid_rate)
    unknown = np.flatnonzero(path.cutting & np.isnan(t))
    if len(unknown):
        raise SetupError(
            f"Force: the record runs over time, and before line {path.block[unknown[0]]} a rapid takes a time that is "
            "not known; give the machine's rapid rate (rapid_rate_mm_min), or a record over path length.",
            where="rapid_rate",
        )
    return np.nan_to_num(t)


def suspicions(setup: SimulationSetup, pull: FloatArray) -> tuple[Finding, ...]:
    """What looks wrong in a measured force; ``pull`` (k, 3) N are its components along the path where it is judged."""
    force, found = setup.force, []
    if force.provenance.kind != "measured" or not len(pull):
        return ()
    size, along = float(np.linalg.norm(pull, axis=1).mean()), float(pull[:, 0].mean())
    if along > SUSPECTED * size:
        text = (
            f"Force: on average it pulls the tool along its feed, with {format_short(along, 'N')}; a cut holds it "
            "back, but for some climb cuts. Did the sensor feel the force on the part (force_on), or in other axes?"
        )
        found.append(Finding("suspicious", text, code="force-pulls"))
    if force.frame == "M" and not force.turns_with_part and np.abs(setup.T_MW[:3, :3] - np.eye(3)).max() > 1e-6:
        text = (
            "Force: its x, y and z are taken as the robot's, and the part is turned against them; where the sensor "
            "turns with the part, say so (force_axes)."
        )
        found.append(Finding("suspicious", text, code="force-axes"))
    return tuple(found)


def moved_points(T_MW: FloatArray, path: Toolpath, reached: BoolArray, delta: FloatArray) -> FloatArray:
    """(m, 3) m in {W}: where the tip goes under ``delta`` (m, 3) m in {M}.

    A rapid arrives where the cut that follows it begins, and points that are not reached stay where they were told.
    """
    moved = np.where(reached[:, None], np.nan_to_num(delta), 0.0)
    arrives = np.flatnonzero(~path.cutting & np.append(path.cutting[1:], False))
    moved[arrives] = moved[arrives + 1]
    return np.asarray(path.p + moved @ T_MW[:3, :3])


def cut_notes(setup: SimulationSetup, conditions: CutConditions, known: BoolArray) -> tuple[Finding, ...]:
    """What a reader of the numbers must know about cutter, stock and force, where that is ``known`` (m,)."""
    notes = [*setup.stock_block.warnings(setup.cutter), *setup.force.findings(conditions)]
    if setup.stock is not None:
        notes += unit_doubt(setup.stock, setup.toolpath.p, setup.toolpath.cutting)
    if not setup.engagement and setup.force.follows_cut:
        text = "The force is that of a full slot everywhere: the engagement with the part is switched off."
        notes.append(Finding("warning", text, code="full-slot"))
    if conditions.engaged.any():
        notes += cut_warnings(setup.cutter, conditions, setup.force.follows_cut & known)
    return tuple(notes)
