"""How steeply the tip really sinks where the tool is told to go down, for the end of the tool cuts only as it does.

A tool that is told to go down just as its arm is pushed up stays at its height, and its end meets nothing: so goes a
program that undoes its own deflection. The slope is that of the tip over the last diameter of its way, which a hollow
end needs to be met by what its rim has left.
"""

from dataclasses import replace

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.cutting.conditions import CutConditions
from robomill.cutting.engaged import sinks
from robomill.toolpath.path import Toolpath


def told_to_sink(told: CutConditions) -> BoolArray:
    """(m,) bool: steps of mills with an end face that are told to go down, short of a plunge."""
    assert told.tooling is not None
    ends = told.tooling.each("flat_radius") > 0.0
    return np.asarray(told.cutting & (told.along < 0.0) & (told.sinks > 0.0) & ~told.mostly_axial & ends)


def clear(told: CutConditions) -> CutConditions:
    """The conditions as if the ends of those tools met nothing."""
    return replace(told, steep=np.where(told_to_sink(told), 0.0, told.sinks))


def sinking(told: CutConditions, path: Toolpath, tips: FloatArray) -> CutConditions:
    """The conditions with ends that sink no more steeply than ``tips`` (m, 3) m do, along the axes of a path."""
    some = told_to_sink(told)
    if not some.any():
        return told
    really = sinks(-_slopes(told, path, tips))
    return replace(told, steep=np.where(some, np.minimum(told.sinks, really), told.sinks))


def _slopes(told: CutConditions, path: Toolpath, tips: FloatArray) -> FloatArray:
    """(m,) how much the tip falls along the tool's axis for each length of its way, over a diameter before each step:
    from the mean height on the first half of that to the mean on the second; level before a cut, or the level cut that
    follows a plunge, begins."""
    assert told.tooling is not None
    step = np.where(path.cutting, path.step_length, 0.0)
    s = np.cumsum(step)
    fallen, fall = (
        -np.einsum("mi,mi->m", np.diff(points, axis=0, prepend=points[:1]), path.k) for points in (tips, path.p)
    )
    fallen = np.cumsum(fallen)
    kind = np.where(path.cutting, np.where(told.mostly_axial, 2, 1), 0)
    begins = np.append(True, kind[1:] != kind[:-1])
    first = np.maximum.accumulate(np.where(begins, np.arange(len(s)), 0))
    before = np.where(begins, fallen - fall, np.append(fallen[:1], fallen[:-1]))
    area = np.cumsum(0.5 * (fallen + before) * step)
    start, level = (s - step)[first], before[first]
    way = told.tooling.each("diameter")

    def until(back: FloatArray) -> FloatArray:
        there = s - back
        return np.asarray(np.interp(np.maximum(there, start), s, area) - level * np.maximum(start - there, 0.0))

    return np.asarray(4.0 * (area - 2.0 * until(0.5 * way) + until(way)) / way**2)
