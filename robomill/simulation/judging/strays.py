"""Where the tip is off its path most, and what of that is on the finished part: a later pass may have cleaned it up."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.simulation.judging.gauge import ALIKE, BESIDE, Gauge
from robomill.simulation.judging.seen import Run
from robomill.surface.stock import stock_span
from robomill.surface.swept import swept_path

LOWER = 1e-6  # m: floors that differ by less are one
ON_SIDE = 0.5  # share of the feed-normal in plan below which the tool lies on its side: there are no heights beside it
PART = 0.1  # of the deviation: what takes less of it away has not cleaned it up

Mark = Literal["wall", "floor", "feed"]
WORDS = {
    "stays": "what it leaves there stays on the part",
    "cleaned": "a later pass cleans that place up",
    "none": "nothing stands beside the tool there to bear its mark",
    "feed": "mostly along the feed, which leaves no mark on a straight cut",
}


@dataclass(frozen=True)
class Stray:
    """The largest deviation of the tip: at ``sample``, of ``size`` (m), mostly across the feed ("wall"), along the tool
    ("floor") or along the "feed"; ``fate`` says what becomes of its mark, one of ``WORDS``; ``left`` (m) is the largest
    error that a gauge finds on what this sample made of the part, NaN where that is nothing."""

    sample: int
    size: float
    mark: Mark
    fate: str
    left: float

    @property
    def words(self) -> str:
        return WORDS[self.fate]


def stray(result: Run, gauge: Gauge) -> Stray | None:
    """What becomes of the largest deviation of the tip; None where nothing is judged."""
    if result.worst < 0:
        return None
    i = _amid(result)
    along, across, up = np.abs(result.delta_in_cut[i])
    mark: Mark = "feed" if along > max(across, up) else "wall" if across >= up else "floor"
    errors = [0.0]
    for found in (gauge.walls, gauge.floors, gauge.ends):
        errors += np.abs(found.error[found.sample == i]).tolist()
    left = max(errors) if len(errors) > 1 else float("nan")
    fate = "feed" if mark == "feed" else _fate(result, i, mark)
    return Stray(i, result.max_deviation, mark, fate, left)


def _amid(result: Run) -> int:
    """The middle one of the samples of the worst line that are off as much: its ends may lie beside the stock."""
    size, i = np.linalg.norm(result.delta, axis=1), result.worst
    with np.errstate(invalid="ignore"):
        alike = result.judged & (result.path.block == result.path.block[i]) & (size >= size[i] - ALIKE)
    there = np.flatnonzero(alike)
    return int(there[len(there) // 2])


def _fate(result: Run, i: int, mark: Mark) -> str:
    """What other passes do to the walls or the floor that the tool leaves at a sample."""
    tip, cutter = result.p_machined[i], result.tooling.at(i)
    left_of_feed = result.setup.to_part(result.R_MF[i, :, 1])
    plan = float(np.hypot(left_of_feed[0], left_of_feed[1]))
    if plan < ON_SIDE:
        return "stays"
    normal = np.array([left_of_feed[0], left_of_feed[1], 0.0]) / plan
    span = stock_span(result.setup.stock_block, tip, normal)
    moves, size = np.arange(len(result.path)), float(result.max_deviation)
    # The cutter has been over its own floor while it came; beside a wall it left it has not.
    before = moves < i if mark == "wall" else result.path.s < result.path.s[i] - cutter.diameter
    rim = (cutter.radius + max(BESIDE, PART * size)) * np.array([1.0, -1.0])
    spots = rim if mark == "wall" else np.zeros(1)
    spots = spots[(spots > span[0]) & (spots < span[1])]
    before_it = _height(result, before, (tip, normal), spots)
    # Beside a wall that it leaves the stock stands higher than its nose; over a floor, than it was told to go.
    stood = before_it > (tip[2] + cutter.nose_height if mark == "wall" else result.path.p[i, 2]) + LOWER
    if not stood.any():
        return "none"
    own = tip[2] + cutter.nose_height if mark == "wall" else np.minimum(before_it[stood], tip[2])
    made = own + LOWER if mark == "wall" else own - max(LOWER, PART * size)
    stands = _height(result, moves > i, (tip, normal), spots[stood]) > made
    return "stays" if stands.any() else "cleaned"


def _height(result: Run, moves: BoolArray, line: tuple[FloatArray, FloatArray], w: FloatArray) -> FloatArray:
    """Height (q,) m that some ``moves`` (m,) alone leave of the stock at positions w (q,) m of a line."""
    made = swept_path(
        result.setup.stock_block, result.tooling, result.p_machined, result.path.k, result.removes & moves
    )
    return made.heights(*line, float(np.abs(w).max(initial=0.0)) + 1e-3)(w)
