"""A step as the cutter sees it, compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

from robomill.arrays import FloatArray
from robomill.compiled import part
from robomill.cutting.engaged import FACING
from robomill.cutting.tool import DISH
from robomill.surface.contact.material_kernels import Dexels
from robomill.surface.contact.soon import soon


class Step(NamedTuple):
    """A step seen by the cutter, in {W}: tip (m), unit vectors of the feed across the axis, to its left, and the axis,
    the parts of the unit feed across and along the axis, how steeply it sinks for its end (0 to 1, see ``heel``), the
    run it belongs to, and how far the axis turns ahead and to the left on the tip's way, rad/m."""

    x: float
    y: float
    z: float
    fx: float
    fy: float
    fz: float
    lx: float
    ly: float
    lz: float
    kx: float
    ky: float
    kz: float
    across: float
    along: float
    sinks: float
    run: int
    turn_f: float
    turn_l: float


@part
def step_at(
    tip: FloatArray, k: FloatArray, v: FloatArray, heading: FloatArray, of: tuple[float, int], turn: FloatArray
) -> Step:
    """A tool along k (3,) with its ``tip`` (3,) m, fed along a unit v (3,); fed straight along its axis, its angles are
    counted from ``heading`` (3,), a unit vector across k. ``of``: how steeply it sinks, and its run;
    ``turn`` (3,) is by how much k changes on the tip's way, 1/m."""
    sinks, run = of
    along = v[0] * k[0] + v[1] * k[1] + v[2] * k[2]
    fx, fy, fz = v[0] - along * k[0], v[1] - along * k[1], v[2] - along * k[2]
    across = math.sqrt(fx * fx + fy * fy + fz * fz)
    if across < FACING:
        across = 0.0
        fx, fy, fz = heading[0], heading[1], heading[2]
    size = math.sqrt(fx * fx + fy * fy + fz * fz)
    fx, fy, fz = fx / size, fy / size, fz / size
    lx, ly, lz = k[1] * fz - k[2] * fy, k[2] * fx - k[0] * fz, k[0] * fy - k[1] * fx
    return Step(
        tip[0],
        tip[1],
        tip[2],
        fx,
        fy,
        fz,
        lx,
        ly,
        lz,
        k[0],
        k[1],
        k[2],
        across,
        along,
        sinks,
        run,
        turn[0] * fx + turn[1] * fy + turn[2] * fz,
        turn[0] * lx + turn[1] * ly + turn[2] * lz,
    )


@part
def rim_turns(step: Step, R: float) -> bool:
    """Whether the rim of radius R (m) goes down or up by more than hollow end teeth clear, as the axis turns."""
    return R * math.hypot(step.turn_f, step.turn_l) > DISH


@part
def ask_for_rim(dexels: Dexels, step: Step, R: float, halves: int) -> None:
    """Have the columns under the rim of radius R (m), cell by cell round the half turn ahead or both ``halves``, in the
    processor's reach before they are looked at."""
    x, y = (step.x - dexels.x0) / dexels.dx + 0.5, (step.y - dexels.y0) / dexels.dy + 0.5
    fx, fy, lx, ly = R * step.fx / dexels.dx, R * step.fy / dexels.dy, R * step.lx / dexels.dx, R * step.ly / dexels.dy
    pitch, sine, cosine = min(dexels.dx, dexels.dy) / R, 0.0, 1.0
    sine_on, cosine_on = math.sin(pitch), math.cos(pitch)
    for _ in range(int(halves * math.pi / pitch)):
        i, j = math.floor(x + sine * fx + cosine * lx), math.floor(y + sine * fy + cosine * ly)
        soon(dexels.heights, i, j)
        soon(dexels.names, i, j)
        sine, cosine = sine * cosine_on + cosine * sine_on, cosine * cosine_on - sine * sine_on
