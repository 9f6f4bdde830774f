"""The cut as the browser draws it by itself: heights, their history, tool, arm and path in one compact parcel.

Lengths in mm, in {W}. A parcel is made once for a result: whatever only looks at it (station, exaggeration, camera,
playing) asks for nothing more.
"""

import base64
import gzip
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.cutting.tool import Cutter
from robomill.kinematics.forward import joint_frames
from robomill.kinematics.jacobian import geometric_jacobian
from robomill.kinematics.transforms import invert
from robomill.simulation.enlarged import Enlarged, enlarged, tips
from robomill.simulation.result import SimulationResult
from robomill.simulation.stations import place_at
from robomill.surface.history import history
from robomill.units import from_si
from robomill.viz import solids
from robomill.viz.arm import displacement_scale
from robomill.viz.rendered.scene import best_angle
from robomill.viz.tool_shape import tool_shape

CELLS = 40_000  # as many as a screen shows of a part 700 pixels wide
LOWERINGS = 400_000  # of all exaggerations together
FRAMES, ARM_FRAMES, LONGEST = 16_000, 240, 160
NO_ERROR = -128  # of int8: nothing is cut there
STEPS = 65_535  # of the 16 bits of a height
COLOURS = 127  # steps of the error from zero to the tolerance, where the colours end
REACHED, JUDGED, JOINED, OVER = 1, 2, 4, 8


@dataclass(frozen=True, eq=False)
class Parcel:
    """``about``: names, places and scales of the arrays, and what is small; ``blob``: the arrays, packed by gzip, in
    base64."""

    about: dict[str, Any]
    blob: str


class _Packing:
    """Arrays put one after the other, each at a place that a browser can read its type from."""

    def __init__(self) -> None:
        self.places: dict[str, tuple[str, int, int]] = {}
        self._parts: list[bytes] = []
        self._at = 0

    def add(self, name: str, array: Any, kind: str) -> None:
        data = np.ascontiguousarray(array, dtype=np.dtype(kind).newbyteorder("<")).tobytes()
        self.places[name] = (kind, self._at, len(data))
        padded = data + bytes(-len(data) % 4)
        self._parts.append(padded)
        self._at += len(padded)

    def text(self) -> str:
        return base64.b64encode(gzip.compress(b"".join(self._parts), 6, mtime=0)).decode("ascii")


def parcel(result: SimulationResult, exaggerations: Sequence[float]) -> Parcel:
    """All that a browser needs to draw the cut at each of ``exaggerations``.

    ``about["arrays"]`` names each array with its type, first byte and length:

    z.K, ideal (nx ny,) u2    height = low + value * quantum, at exaggeration K
    error.K (nx ny,) i1       true signed error over the tolerance x 127, held at +-127; -128 where nothing was cut
    wall.K (nx ny,) i1        as much of the wall that the cell stands beside; -128 where none stands
    ready.K (nx ny,) u2       frame at which a cell has its last height and the ideal cut has passed it
    cell.K, height.K, frame.K the lowerings of cells on the way there, in their order
    p, delta, k (f, 3) f4     tip as told, its deviation at true size, tool axis; s (f,) mm cut so far
    state (f,) u1             1 reached, 2 counts for the verdict, 4 the cut goes on from the frame before, 8 in air
    arm.o, arm.a, arm.do, arm.da (a, n + 1, 3) f4   joints' places and axes, and what the load does to them
    """
    packing, frames, worst = _Packing(), frames_of(result), result.decided.sample
    shown = [enlarged(result, times, CELLS, must_touch=False) for times in exaggerations]
    first = shown[0]
    heights = [first.ideal.z, *(each.drawn.z for each in shown), first.ideal.z_stock]
    low, high = (float(f([f(z) for z in heights])) for f in (np.min, np.max))
    low = min(low, first.ideal.bottom)
    quantum = max(high - low, 1e-9) / STEPS
    packing.add("ideal", quantised(first.ideal.z, low, quantum), "u2")
    if first.ideal.z_stock.ndim:
        packing.add("stock", quantised(first.ideal.z_stock, low, quantum), "u2")
    told = _last_frame(result, first, 0.0, frames)
    for n, each in enumerate(shown):
        _surface(packing, str(n), result, each, (low, quantum), (frames, told))
    _samples(packing, result, frames)
    about: dict[str, Any] = {
        "arrays": packing.places,
        "grid": [*first.drawn.z.shape, *_mm(first.drawn.x[0], first.drawn.y[0], first.drawn.dx, first.drawn.dy)],
        "low": _mm(low)[0],
        "quantum": _mm(quantum)[0],
        "bottom": _mm(first.drawn.bottom)[0],
        "top": _mm(float(np.max(first.ideal.z_stock)))[0],
        "voids": bool(result.setup.stock_block.triangles is not None),
        "times": list(exaggerations),
        "frames": len(frames),
        "total": _mm(float(result.path.s[-1]))[0],
        "tolerance": _mm(result.setup.tolerance)[0],
        "worst": int(np.searchsorted(frames, worst)) if worst >= 0 else -1,
        "tools": [tool_outlines(cutter) for cutter in result.tooling.cutters],
        "cameras": cameras(result, first),
        "lines": _lines(result, frames, packing),
        **_arm(packing, result, frames),
    }
    return Parcel(about, packing.text())


def frames_of(result: SimulationResult) -> IntArray:
    """Samples (f,) that the browser knows: those at feed and where a feed move begins; of very many, evenly chosen."""
    cutting = result.path.cutting
    every = np.flatnonzero(cutting | np.append(cutting[1:], False))
    if len(every) <= FRAMES:
        return every
    chosen = every[np.unique(np.linspace(0, len(every) - 1, FRAMES).round().astype(int))]
    return np.union1d(chosen, [result.worst]) if result.worst >= 0 else chosen


def quantised(z: FloatArray, low: float, quantum: float) -> IntArray:
    """Heights as steps of ``quantum`` above ``low``."""
    return np.clip(np.rint((np.asarray(z) - low) / quantum), 0, STEPS).astype(np.int64)


def coloured(error: FloatArray, limit: float) -> IntArray:
    """Errors over ``limit`` in steps of a colour, held at the ends; ``NO_ERROR`` for NaN."""
    steps = np.clip(np.rint(np.nan_to_num(error) / limit * COLOURS), -COLOURS, COLOURS)
    return np.where(np.isfinite(error), steps, NO_ERROR).astype(np.int64)


def _mm(*values: float) -> list[float]:
    return [float(from_si(float(value), "mm")) for value in values]


def _surface(
    packing: _Packing,
    name: str,
    result: SimulationResult,
    shown: Enlarged,
    scale: tuple[float, float],
    when: tuple[IntArray, IntArray],
) -> None:
    """Final heights, their colours, and the way there; ``when``: the frames, and the last one of the ideal cut."""
    frames, told = when
    most = LOWERINGS // 5
    past = history(shown.drawn, result.tooling, tips(result, shown.times), result.path.k, result.removes, most)
    at = np.searchsorted(frames, past.step)
    ready = told.copy()
    np.maximum.at(ready, past.cell, at)
    packing.add(f"z.{name}", quantised(shown.drawn.z, *scale), "u2")
    packing.add(f"error.{name}", coloured(shown.error, result.setup.tolerance), "i1")
    packing.add(f"wall.{name}", coloured(shown.wall, result.setup.tolerance), "i1")
    packing.add(f"ready.{name}", np.minimum(ready, len(frames) - 1), "u2")
    packing.add(f"cell.{name}", past.cell, "u4")
    packing.add(f"height.{name}", quantised(past.height, *scale), "u2")
    packing.add(f"frame.{name}", np.minimum(at, len(frames) - 1), "u2")


def _last_frame(result: SimulationResult, shown: Enlarged, times: float, frames: IntArray) -> IntArray:
    """(nx ny,) frame at which the ideal cut leaves each cell for good; 0 where it never is."""
    past = history(shown.ideal, result.tooling, tips(result, times), result.path.k, result.removes)
    last = np.zeros(shown.ideal.z.size, dtype=np.int64)
    np.maximum.at(last, past.cell, np.searchsorted(frames, past.step))
    return last


def _samples(packing: _Packing, result: SimulationResult, frames: IntArray) -> None:
    path = result.path
    joined = np.diff(np.cumsum(~path.cutting)[frames]) == 0
    state = REACHED * result.reached[frames] + JUDGED * result.judged[frames]
    state += JOINED * np.append(False, joined) + OVER * ~result.over_stock[frames]
    packing.add("p", from_si(path.p[frames], "mm"), "f4")
    packing.add("delta", from_si((result.p_machined - path.p)[frames], "mm"), "f4")
    packing.add("k", path.k[frames], "f4")
    packing.add("s", from_si(path.s[frames], "mm"), "f4")
    packing.add("state", state, "u1")
    packing.add("tool", result.tooling.of_step[frames], "u1")
    packing.add("size", from_si(result.deviation[frames], "mm"), "f4")
    packing.add("force", result.force_size[frames], "f4")


def _lines(result: SimulationResult, frames: IntArray, packing: _Packing) -> dict[str, Any]:
    """The program's lines that cut: numbers and texts, each once; every frame says which."""
    numbers, which = np.unique(result.path.block[frames], return_inverse=True)
    texts = result.setup.source.block_texts()
    packing.add("line", which, "u2")
    said = [texts[n - 1][:LONGEST] if 1 <= n <= len(texts) else "" for n in numbers.tolist()]
    return {"number": numbers.tolist(), "text": said}


def tool_outlines(cutter: Cutter) -> list[dict[str, Any]]:
    """Cutter, shank and spindle nose as solids of revolution over the tip: radii and heights, mm."""
    return [
        {"role": role, "radius": from_si(radius, "mm").tolist(), "height": from_si(height, "mm").tolist()}
        for role, (radius, height) in tool_shape(cutter, rim=13).items()
    ]


def cameras(result: SimulationResult, shown: Enlarged) -> dict[str, list[list[float]]]:
    """From where each preset looks (unit vector towards the eye), and what is up; by the way of the cut at its middle,
    as in the rendered picture."""
    along = place_at(result.path, 0.5 * float(result.path.s[-1]))[1].copy()
    along[2] = 0.0
    along = along / np.linalg.norm(along) if np.linalg.norm(along) > 1e-9 else np.array([1.0, 0.0, 0.0])
    across, up = np.array([-along[1], along[0], 0.0]), np.array([0.0, 0.0, 1.0])
    block = result.setup.stock_block
    views = {
        "iso": (best_angle(block.upper - block.lower, along, across, 1.9, 0.9), up),
        "along": (-along + 0.32 * up, up),
        "top": (up, across),
        "front": (-across + 0.02 * up, up),
    }
    return {name: [(view / np.linalg.norm(view)).tolist(), top.tolist()] for name, (view, top) in views.items()}


def _arm(packing: _Packing, result: SimulationResult, frames: IntArray) -> dict[str, Any]:
    """Joints' places and axes at frames evenly chosen among the reached ones, and what the load does to them."""
    known = np.flatnonzero(np.isfinite(result.theta[frames]).all(axis=1))
    if not len(known):
        return {"arm": None}
    chosen = known[np.unique(np.linspace(0, len(known) - 1, ARM_FRAMES).round().astype(int))]
    straight, bent = arm_frames(result, frames[chosen])
    packing.add("arm.at", chosen, "u2")
    for name, column in (("o", 3), ("a", 2)):
        scale = "mm" if name == "o" else "m"
        packing.add(f"arm.{name}", from_si(straight[..., :3, column], scale), "f4")
        packing.add(f"arm.d{name}", from_si((bent - straight)[..., :3, column], scale), "f4")
    i = result.worst if result.worst >= 0 else int(frames[chosen[0]])
    size = result.delta[i] if np.isfinite(result.delta[i]).all() else np.zeros(3)
    largest = displacement_scale(size, straight[0])
    power = 10.0 ** np.floor(np.log10(largest))
    return {
        "arm": {
            "joints": straight.shape[1] - 1,
            "size": _mm(solids.yardstick(straight[0]))[0],
            "times": float(max(power * np.floor(largest / power), 1.0)),
        }
    }


def arm_frames(result: SimulationResult, samples: IntArray) -> tuple[FloatArray, FloatArray]:
    """(a, n + 1, 4, 4) m in {W}: the frame before each joint and {T}, unloaded and with the joints turned as the force
    turns them, at ``samples``; a sample whose force is not known stands unloaded."""
    robot, theta = result.setup.robot, result.theta[samples]
    T_WM = invert(result.setup.T_MW)
    tau = np.einsum("mij,mi->mj", geometric_jacobian(robot, theta)[:, :3], np.nan_to_num(result.F[samples]))
    turned = theta + robot.C_theta * tau
    return T_WM @ joint_frames(robot, theta), T_WM @ joint_frames(robot, turned)
