"""Splines G5, G5.1 and NURBS G5.2/G5.3 in the plane G17, as straight pieces between points of the curve."""

import math

import numpy as np

from robomill.arrays import FloatArray
from robomill.toolpath.gcode.codes import I, J
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.moves import find_end, need_feed
from robomill.toolpath.gcode.program import FEED
from robomill.toolpath.gcode.words import Block

PIECES = 15
"""Straight pieces per control point, equal steps of the parameter (as in LinuxCNC's preview)."""

MAX_CONTROL_POINTS = 2000


def spline(machine: Machine, block: Block) -> None:
    """G5 (cubic: I J leave, P Q arrive), G5.1 (quadratic: I J) and G5.2 (a control point with weight P)."""
    name = f"G5.{block.motion % 10}" if block.motion % 10 else "G5"
    machine.need_compensation_off(block, name)
    need_feed(machine, block, name)
    if machine.plane != 17:
        raise block.refuse(f"{name} works in the plane G17 only.")
    if block.motion == 52:
        _control_point(machine, block)
        return
    if any(letter in block.words for letter in "zabc"):
        raise block.refuse(f"{name} takes no Z, A, B or C; splines stay in their plane.")
    words = block.words
    x, y = machine.p[0], machine.p[1]
    end = find_end(machine, block)
    if block.motion == 51:
        if "i" not in words or "j" not in words:
            raise block.refuse("G5.1 needs I and J, its control point.")
        points = [(x, y), (x + words["i"], y + words["j"]), (end[0], end[1])]
    else:
        if ("i" in words) != ("j" in words):
            raise block.refuse("G5 needs both I and J, or neither.")
        if "p" not in words or "q" not in words:
            raise block.refuse("G5 needs P and Q, its second control point.")
        if "i" in words:
            machine.cycle[I], machine.cycle[J] = words["i"], words["j"]
        i, j = (0.0 if math.isnan(v) else v for v in (machine.cycle[I], machine.cycle[J]))
        points = [(x, y), (x + i, y + j), (end[0] + words["p"], end[1] + words["q"]), (end[0], end[1])]
        machine.cycle[I], machine.cycle[J] = -words["p"], -words["q"]
    _run(machine, block, [(u, v, 1.0) for u, v in points], len(points))


def _control_point(machine: Machine, block: Block) -> None:
    words = block.words
    if ("x" in words) != ("y" in words):
        raise block.refuse("G5.2 needs both X and Y.")
    weight = words.get("p", -1.0)
    if machine.motion != 52:
        machine.spline, machine.spline_order = [], 3
    if machine.spline and ("x" not in words or weight <= 0):
        raise block.refuse("G5.2 needs X, Y and a weight P above 0 for every further control point.")
    if not machine.spline:
        first = weight if "x" not in words and weight > 0 else 1.0
        machine.spline = [(machine.p[0], machine.p[1], first)]
        machine.spline_order = 3
    if words.get("l", 0.0) > 3:
        machine.spline_order = round(words["l"])
    if "x" in words:
        end = find_end(machine, block)
        machine.spline.append((end[0], end[1], weight if weight > 0 else 1.0))
    if len(machine.spline) > MAX_CONTROL_POINTS:
        raise block.refuse(f"a spline has more than {MAX_CONTROL_POINTS} control points; split it.")
    machine.motion = 52


def finish(machine: Machine, block: Block) -> None:
    """G5.3: the NURBS through the control points that were collected."""
    if machine.motion != 52:
        raise block.refuse("G5.3 ends a NURBS, but none was begun with G5.2.")
    if len(machine.spline) < machine.spline_order:
        raise block.refuse(
            f"the NURBS has {len(machine.spline)} control points; order {machine.spline_order} needs more."
        )
    _run(machine, block, machine.spline, machine.spline_order)
    machine.spline, machine.motion = [], -1


def _run(machine: Machine, block: Block, control: list[tuple[float, float, float]], order: int) -> None:
    for x, y in curve(control, order):
        machine.go(FEED, block.line, [x, y, *machine.p[2:]])
    machine.p = [control[-1][0], control[-1][1], *machine.p[2:]]


def curve(control: list[tuple[float, float, float]], order: int) -> list[tuple[float, float]]:
    """Points of the NURBS with clamped uniform knots after its start; ``control`` holds x, y and weight."""
    n = len(control) - 1
    last = float(n - order + 2)
    pieces = PIECES * len(control)
    knots: FloatArray = np.clip(np.arange(n + order + 1) - order + 1, 0, n - order + 2).astype(float)
    u: FloatArray = np.arange(1, pieces, dtype=np.float64) * (last / pieces)
    basis = _basis(knots, u, n, order)
    table = np.array(control, dtype=np.float64)
    weights = basis * table[:, 2]
    points = weights @ table[:, :2] / weights.sum(axis=1)[:, None]
    return [(float(x), float(y)) for x, y in points] + [control[-1][:2]]


def _basis(knots: FloatArray, u: FloatArray, n: int, order: int) -> FloatArray:
    """(len(u), n + 1) values of the B-spline basis of an order (degree + 1), by Cox and de Boor."""
    basis = ((knots[:-1] <= u[:, None]) & (u[:, None] < knots[1:])).astype(float)
    for degree in range(1, order):
        count = len(knots) - 1 - degree
        span_left, span_right = (
            knots[degree : degree + count] - knots[:count],
            knots[degree + 1 :] - knots[1 : count + 1],
        )
        rising = np.where(span_left > 0, (u[:, None] - knots[:count]) / np.where(span_left > 0, span_left, 1.0), 0.0)
        falling = np.where(
            span_right > 0, (knots[degree + 1 :] - u[:, None]) / np.where(span_right > 0, span_right, 1.0), 0.0
        )
        basis = rising * basis[:, :count] + falling * basis[:, 1 : count + 1]
    return np.asarray(basis[:, : n + 1])
