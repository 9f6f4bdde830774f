"""Threads: what a tap or a thread cutter pushes with is not the force of a milling cutter."""

from robomill.cutting.conditions import CutConditions
from robomill.cutting.unjudged import Unjudged
from robomill.toolpath.path import Toolpath


def threads_in_cut(path: Toolpath, conditions: CutConditions) -> tuple[Unjudged, ...]:
    """Steps in the material at which the program cuts a thread."""
    where = conditions.engaged & path.thread
    why = "a thread is cut in step with the spindle (G33, G33.1, G74, G76, G84), and its force has no model"
    return Unjudged.at("thread", where, why)
