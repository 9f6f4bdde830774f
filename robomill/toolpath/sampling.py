"""Cutting a path into short steps, so that forces and deflections are known all along it."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import ToolpathError
from robomill.toolpath.path import Toolpath

MAX_SAMPLES = 5_000_000


def resample(path: Toolpath, step: float) -> Toolpath:
    """``path`` with every feed move cut into equal pieces no longer than ``step`` (m); corners are kept.

    Rapids stay whole: no force acts on them. The tool axis is interpolated on the great circle.
    Raises ToolpathError if the step is not positive or would give more than ``MAX_SAMPLES`` points.
    """
    if not (math.isfinite(step) and step > 0):
        raise ToolpathError(f"Step along the path: found {step}; expected a length above 0.")
    pieces = np.where(path.cutting, np.ceil(path.step_length / step - 1e-9), 1).astype(np.int64)
    pieces = np.maximum(pieces, 1)
    pieces[0] = 1
    total = int(pieces.sum())
    if total > MAX_SAMPLES:
        fits = float(path.step_length[path.cutting].sum()) / (MAX_SAMPLES - len(path))
        raise ToolpathError(
            f"Step along the path: {step * 1e3:.3g} mm would need {total} points; "
            f"at most {MAX_SAMPLES} fit, so use {fits * 1e3:.3g} mm or more."
        )
    if total == len(path):
        return path
    owner = np.repeat(np.arange(len(path)), pieces)
    first = np.repeat(np.cumsum(pieces) - pieces, pieces)
    fraction = (np.arange(total) - first + 1) / pieces[owner]
    before = np.maximum(owner - 1, 0)
    p = path.p[before] + fraction[:, None] * (path.p[owner] - path.p[before])
    last = fraction == 1.0
    p[last] = path.p[owner[last]]
    return dataclasses.replace(
        path, p=p, k=_slerp(path.k[before], path.k[owner], fraction), v_f=path.v_f[owner],
        cutting=path.cutting[owner], block=path.block[owner], n_s=path.n_s[owner], tool=path.tool[owner],
    )  # fmt: skip


def _slerp(k_a: FloatArray, k_b: FloatArray, fraction: FloatArray) -> FloatArray:
    angle = np.arctan2(np.linalg.norm(np.cross(k_a, k_b), axis=1), np.einsum("ij,ij->i", k_a, k_b))
    sine = np.sin(angle)
    turning = sine > 1e-12
    safe = np.where(turning, sine, 1.0)
    w_a = np.where(turning, np.sin((1 - fraction) * angle) / safe, 1 - fraction)
    w_b = np.where(turning, np.sin(fraction * angle) / safe, fraction)
    k = w_a[:, None] * k_a + w_b[:, None] * k_b
    return np.asarray(k / np.linalg.norm(k, axis=1, keepdims=True))
