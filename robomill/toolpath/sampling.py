"""Cutting a path into short steps, so that forces and deflections are known all along it."""

import dataclasses

import numpy as np

from robomill import budgets
from robomill.arrays import BoolArray, FloatArray, IntArray, stretches
from robomill.errors import ToolpathError
from robomill.progress import checkpoint
from robomill.toolpath.path import PER_MOVE, Toolpath
from robomill.units import format_count, format_number, format_short, to_si
from robomill.vectors import angle_between

CORNER = to_si(10.0, "deg")


def resample(path: Toolpath, step: float | FloatArray, sinking: tuple[float, float] | None = None) -> Toolpath:
    """``path`` with every feed move cut into equal pieces no longer than ``step`` (m, one for all moves or one each);
    corners are kept.

    A feed move that begins a cut or turns by more than ``CORNER`` also gets a sample at its start (a step of
    no length): there the force already has the new direction; and one that begins or ends a way down, if ``sinking``
    says what is one: the sines of the slopes up to which nothing, and from which on all, of a tool's end pushes. One
    that draws the tool straight back out of a plunge does not, but behind a dwell: what the tool is off at the bottom
    stays in the part, as it does before a rapid.
    Rapids stay whole: no force acts on them.
    The tool axis is interpolated on the great circle. Raises ToolpathError if the step is not positive or
    would give more points than the memory holds.
    """
    if not (np.isfinite(step).all() and np.all(np.asarray(step) > 0)):
        raise ToolpathError(f"Step along the path: found {step}; expected a length above 0.")
    pieces = np.where(path.cutting, np.ceil(path.step_length / step - 1e-9), 1.0)
    starts = _begins(path, sinking)
    total = float(np.maximum(pieces, 1.0).sum() + starts.sum())
    check_samples(path, float(np.min(step)), total, budgets.samples())
    return divided(path, np.maximum(pieces, 1.0).astype(np.int64), starts)


def divided(path: Toolpath, counts: IntArray, starts: BoolArray | None = None) -> Toolpath:
    """``path`` with every move cut into ``counts`` (m,) equal pieces, and a sample more at the start of those that
    ``starts`` (m,) names."""
    checkpoint(0.0, "Samples")
    starts = np.zeros(len(path), dtype=bool) if starts is None else starts
    samples = counts + starts
    owner = np.repeat(np.arange(len(path)), samples)
    first = np.repeat(np.cumsum(samples) - samples, samples)
    checkpoint(0.2, "Samples")
    index = np.arange(len(owner)) - first + 1 - starts[owner]
    fraction = index / counts[owner]
    before = np.maximum(owner - 1, 0)
    checkpoint(0.4, "Samples")
    p = path.p[before] + fraction[:, None] * (path.p[owner] - path.p[before])
    last = index == counts[owner]
    p[last] = path.p[owner[last]]
    checkpoint(0.6, "Samples")
    carried = {name: getattr(path, name)[owner] for name in PER_MOVE}
    carried["dwell"] = np.where(np.arange(len(owner)) == first, carried["dwell"], 0.0)
    return dataclasses.replace(
        path,
        p=p,
        k=_slerp(path.k[before], path.k[owner], fraction),
        **carried,
    )


def check_samples(path: Toolpath, step: float, total: float, most: int) -> None:
    """Raises ToolpathError where ``total`` points are more than ``most``, naming the step (m) that fits."""
    if total <= most:
        return
    spare = most - 2 * len(path)
    fits = float(path.step_length[path.cutting].sum()) / max(spare, 1)
    found = (
        f"Step along the path: {format_short(step, 'mm')} would need {format_number(total, 0)} "
        f"points; at most {format_count(most)} fit"
    )
    if spare <= 0:
        raise ToolpathError(f"{found}, and the path has {format_count(len(path))} moves of its own: run it in parts.")
    raise ToolpathError(f"{found}, so use {format_short(1.05 * fits, 'mm')} or more.")


def _begins(path: Toolpath, sinking: tuple[float, float] | None) -> BoolArray:
    """(m,) feed moves that begin a cut, turn sharply, or go down (``sinking``) where those before do not, or the other
    way."""
    moved = path.step_length > 0
    turns = _turns(path)
    resumed = np.append(True, ~path.cutting[:-1] | ~moved[:-1])
    sharp = turns[0] > CORNER
    if sinking is not None:
        sharp[1:] |= _sinks_or_stops(path, *sinking)
    begins = path.cutting & moved & (resumed | (sharp & ~_turns_back(path, turns)))
    begins[0] = False
    return np.asarray(begins)


def _sinks_or_stops(path: Toolpath, level: float, whole: float) -> BoolArray:
    """(m - 1,) where of a move and the next one the one goes down at a sine of ``whole`` and more against the axis in
    which they meet, and the other at less than ``level``."""
    move, length = np.diff(path.p, axis=0, prepend=path.p[:1]), path.step_length
    down = -np.einsum("mi,nmi->nm", path.k[:-1], np.stack([move[:-1], move[1:]]))
    size = np.stack([length[:-1], length[1:]])
    return np.asarray(((down > whole * size) & (down < level * size)[::-1]).any(axis=0))


def drawn_back(path: Toolpath) -> BoolArray:
    """(m,) steps at feed on the way straight back out of a plunge that has not waited at its bottom."""
    found = np.zeros(len(path), dtype=bool)
    turns = _turns(path)
    begins = _turns_back(path, turns)
    for begin, past in stretches(path.cutting & turns[1]):
        found[begin:past] = begins[begin] and path.cutting[begin - 1]
    return found


def _turns(path: Toolpath) -> tuple[FloatArray, BoolArray]:
    """(m,) rad by which moves turn against those before, and (m,) those that lead up along the tool."""
    move = np.diff(path.p, axis=0, prepend=path.p[:1])
    angle = np.zeros(len(path))
    angle[1:] = angle_between(move[:-1], move[1:])
    up = np.sum(move * path.k, axis=1) > np.cos(CORNER) * path.step_length
    return angle, np.asarray(up)


def _turns_back(path: Toolpath, turns: tuple[FloatArray, BoolArray]) -> BoolArray:
    """(m,) moves, with their ``turns``, straight back out of a plunge that has not waited at its bottom."""
    angle, up = turns
    return np.asarray(up & (angle > np.pi - CORNER) & (path.dwell == 0.0))


def _slerp(k_a: FloatArray, k_b: FloatArray, fraction: FloatArray) -> FloatArray:
    if np.array_equal(k_a, k_b):
        return k_b
    angle = angle_between(k_a, k_b)
    sine = np.sin(angle)
    turning = sine > 1e-12
    safe = np.where(turning, sine, 1.0)
    w_a = np.where(turning, np.sin((1 - fraction) * angle) / safe, 1 - fraction)
    w_b = np.where(turning, np.sin(fraction * angle) / safe, fraction)
    k = w_a[:, None] * k_a + w_b[:, None] * k_b
    return np.asarray(k / np.linalg.norm(k, axis=1, keepdims=True))
