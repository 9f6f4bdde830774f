"""How steeply the tip really sinks where the tool is told to go down, for the end of the tool cuts only as it does.

A tool that is told to go down just as its arm is pushed up stays at its height, and its end meets nothing: so goes a
program that undoes its own deflection. The slope is that of the tip over the last diameter of its way, which a hollow
end needs to be met by what its rim has left.

An end that presses on its floor holds its tip up, by its thrust, above where the tip would go if the end met nothing.
Where the arm springs up, as where the flank leaves the material, it lets go only once it has sprung up by all of that:
until then the tip would sink into the floor that it has left.

A nose is pushed up the more the deeper it is. What a ramp so lifts its own tip is its deflection, as the thrust of its
end is, and takes nothing off the force of the path as it is told; only what it is lifted by beside does.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.cutting.conditions import CutConditions
from robomill.cutting.engaged import sinks
from robomill.cutting.tool import DISH
from robomill.toolpath.path import Toolpath

SLIGHT = 1e-6  # of what an end cuts: less of it is lost by rounding only
SLOT = 1e-3  # m deep: any depth has the same thrust of its end
LEAST = 0.2  # of a slope: how much of it is left to a tip, however much it lifts itself
ALIKE = 4  # decimals of a feed's part along the axis: ways down that differ by less press alike


def told_to_sink(told: CutConditions) -> BoolArray:
    """(m,) bool: steps of mills with an end face that are told to go down, short of a plunge."""
    assert told.tooling is not None
    ends = told.tooling.each("flat_radius") > 0.0
    return np.asarray(told.cutting & (told.sinks > 0.0) & ~told.mostly_axial & ends)


def clear(told: CutConditions) -> CutConditions:
    """The conditions as if the ends of those tools met nothing."""
    return replace(told, steep=np.where(told_to_sink(told), 0.0, told.sinks))


def pressing(told: CutConditions) -> CutConditions:
    """Conditions of the same tools that go down as steeply in a slot: against them ``clear`` of end, the force is that
    of whole ends."""
    some = told_to_sink(told) & (told.n_s != 0.0) & (told.v_f > 0.0)
    return replace(told, a_p=np.where(some, SLOT, 0.0), along=np.round(told.along, ALIKE))


def sinking(
    told: CutConditions,
    path: Toolpath,
    tips: FloatArray,
    own: Callable[[], FloatArray] | None,
    lift: Callable[[], FloatArray],
) -> CutConditions:
    """The conditions with ends that sink no more steeply than ``tips`` (m, 3) m do, where these go along a path if no
    end meets anything; ``own`` says how far (m,) m each step lifts its tip by going deeper (None: not at all), ``lift``
    how far, (m, 3) m, whole ends that press hold them off that."""
    some = told_to_sink(told)
    if not some.any():
        return told
    steep = np.where(some, np.minimum(told.sinks, sinks(-_slopes(told, path, tips))), told.sinks)
    if own is not None:
        steep = _without_own(told, path, (tips, steep), own)
    goes_on = some & np.append(False, some[:-1])
    if (goes_on & (steep < np.minimum(np.append(0.0, steep[:-1]), told.sinks) - SLIGHT)).any():
        up = np.einsum("mi,mi->m", lift(), path.k)
        steep = np.minimum(told.sinks, _held(told, steep, goes_on, fallen(path, tips), up))
    return replace(told, steep=steep)


def _without_own(
    told: CutConditions, path: Toolpath, free: tuple[FloatArray, FloatArray], own: Callable[[], FloatArray]
) -> FloatArray:
    """(m,) how steeply ends sink: as ``free`` tips say, (m, 3) m and (m,); those of noses as they are told to, less the
    share of their slope that is lost to other than their ``own`` lift, (m,) m a step."""
    assert told.tooling is not None
    tips, steep = free
    nosed = told_to_sink(told) & (told.tooling.each("nose_height") > 0.0)
    as_told = _slopes(told, path, path.p)
    nosed &= (steep < np.minimum(told.sinks, sinks(-as_told)) - SLIGHT) & (as_told > 0.0)
    if not nosed.any():
        return steep
    lifted = np.cumsum(np.where(told_to_sink(told), own(), 0.0))
    alone, really = (_slopes(told, path, each) for each in (path.p + lifted[:, None] * path.k, tips))
    lost = (alone - really) / np.maximum(np.maximum(alone, LEAST * as_told), np.finfo(float).tiny)
    kept = as_told * np.clip(1.0 - lost, 0.0, 1.0)
    return np.where(nosed, np.maximum(steep, np.minimum(told.sinks, sinks(-kept))), steep)


def _held(
    told: CutConditions, steep: FloatArray, goes_on: BoolArray, falls: FloatArray, lift: FloatArray
) -> FloatArray:
    """(m,) how steeply ends sink: as their slopes say, ``steep`` (m,), or as before while they hold, on a way down that
    ``goes_on`` (m,). The free tip ``falls`` (m,) m on each step, and a pressing end lifts it by ``lift`` (m,) m.

    The end keeps the tip at its height while the free tip would sink below it, by its lift at most (the stop of
    Prandtl); it holds with all that it held with before while it would sink deeper than it is ground hollow.
    """
    assert told.tooling is not None
    hollow = told.tooling.each("flat_radius") * (DISH / np.sqrt(1.0 - DISH**2))
    held, depth, last = np.empty(len(steep)), 0.0, 0.0
    steps = zip(steep.tolist(), goes_on.tolist(), falls.tolist(), lift.tolist(), hollow.tolist(), strict=True)
    for i, (own, on, fall, most, whole) in enumerate(steps):
        depth = max(min(depth + fall, most), 0.0) if on else 0.0
        last = max(own, min(last, depth / whole)) if depth > 0.0 else own
        held[i] = last
    return held


def fallen(path: Toolpath, points: FloatArray) -> FloatArray:
    """(m,) m by which points (m, 3) m along a path fall along the tool's axis on each step."""
    return np.asarray(-np.einsum("mi,mi->m", np.diff(points, axis=0, prepend=points[:1]), path.k))


def _slopes(told: CutConditions, path: Toolpath, tips: FloatArray) -> FloatArray:
    """(m,) how much the tip falls along the tool's axis for each length of its way, over a diameter before each step:
    from the mean height on the first half of that to the mean on the second; level before a cut, or the level cut that
    follows a plunge, begins."""
    assert told.tooling is not None
    step = np.where(path.cutting, path.step_length, 0.0)
    s = np.cumsum(step)
    down, fall = np.cumsum(fallen(path, tips)), fallen(path, path.p)
    on_its_way = path.cutting & ~told.mostly_axial
    begins = np.append(True, on_its_way[1:] != on_its_way[:-1])
    first = np.maximum.accumulate(np.where(begins, np.arange(len(s)), 0))
    before = np.where(begins, down - fall, np.append(down[:1], down[:-1]))
    area = np.cumsum(0.5 * (down + before) * step)
    start, level = (s - step)[first], before[first]
    way = told.tooling.each("diameter")

    def until(back: FloatArray) -> FloatArray:
        there = s - back
        return np.asarray(np.interp(np.maximum(there, start), s, area) - level * np.maximum(start - there, 0.0))

    return np.asarray(4.0 * (area - 2.0 * until(0.5 * way) + until(way)) / way**2)
