"""Force ON the tool along the path: one interface for every model. N, feed frame or {M}.

The feed frame at a step has the axes feed (across the tool axis), feed-normal = z_T x feed (the left of the feed)
and axial = z_T (out of the part, towards the spindle).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, as_floats, frozen
from robomill.cutting.conditions import CutConditions
from robomill.errors import CuttingError
from robomill.provenance import Provenance

#: Below this share of the feed across the tool axis a move counts as a plunge (or a retract).
PLUNGE = 1e-6
ASSUMED = Provenance("user", "entered by hand")


Frame = Literal["path", "M"]


class ForceModel(Protocol):
    """Every model gives the mean force on the tool at every step, in the ``frame`` it is known in.

    ``"path"``: feed, feed-normal, axial; ``"M"``: x, y, z of the robot's frame.
    """

    @property
    def frame(self) -> Frame:
        """Axes of ``components``."""
        ...

    @property
    def provenance(self) -> Provenance:
        """Where its numbers come from."""
        ...

    @property
    def notes(self) -> tuple[str, ...]:
        """What is unknown or assumed, in sentences for the result."""
        ...

    def components(self, conditions: CutConditions) -> FloatArray:
        """Mean force ON the tool at every step, (m, 3) N, in ``frame``."""
        ...


@dataclass(frozen=True, eq=False)
class ConstantForce:
    """The paper's static force: one vector (3,) N in {M} wherever the tool cuts."""

    vector_M: FloatArray
    provenance: Provenance = ASSUMED
    notes: tuple[str, ...] = ()
    frame: ClassVar[Frame] = "M"

    def __post_init__(self) -> None:
        vector = as_floats(self.vector_M, "constant force (x, y, z in N)", (3,), error=CuttingError)
        if vector.shape != (3,):
            raise CuttingError(f"Constant force: expected three numbers x, y, z in N, found shape {vector.shape}.")
        object.__setattr__(self, "vector_M", frozen(vector))

    def components(self, conditions: CutConditions) -> FloatArray:
        """The vector at every step, (m, 3) N in {M}."""
        return np.tile(self.vector_M, (len(conditions), 1))


@dataclass(frozen=True)
class PathForce:
    """Constant components that follow the path: feed, feed_normal (left of the feed), axial (+ out of the part), N."""

    feed: float = 0.0
    feed_normal: float = 0.0
    axial: float = 0.0
    provenance: Provenance = ASSUMED
    notes: tuple[str, ...] = ()
    frame: ClassVar[Frame] = "path"

    def __post_init__(self) -> None:
        for name in ("feed", "feed_normal", "axial"):
            value = as_floats(getattr(self, name), f"path force, {name} (N)", (), error=CuttingError)
            if value.shape != ():
                raise CuttingError(f"Path force, {name} (N): expected one number, found shape {value.shape}.")
            object.__setattr__(self, name, float(value))

    def components(self, conditions: CutConditions) -> FloatArray:
        """(m, 3) N, the same at every step; a plunge has no feed across the tool, so only the axial part there."""
        force = np.tile([self.feed, self.feed_normal, self.axial], (len(conditions), 1))
        force[conditions.across <= PLUNGE, :2] = 0.0
        return force


def feed_share(p: ArrayLike, k: ArrayLike) -> FloatArray:
    """Share (m,) of every move that lies across the tool axis: 1 on the level, 0 in a plunge, 1 where nothing moves.

    ``p`` (m, 3) m tips, ``k`` (m, 3) unit tool axes, both in one frame; entry i is the move p[i-1] -> p[i].
    """
    step, across = _moves(p, k)
    length = np.linalg.norm(step, axis=1)
    return np.divide(np.linalg.norm(across, axis=1), length, out=np.ones(len(length)), where=length > 0.0)


def feed_frame(p: ArrayLike, k: ArrayLike) -> FloatArray:
    """Feed frames R (m, 3, 3) in the frame of ``p`` and ``k``; columns feed, feed-normal, axial.

    Orthonormal and right-handed. Feed is the part of the move p[i-1] -> p[i] across the tool axis k[i].
    Where a move has none (plunge, retract, standstill) the last direction that had one is kept, and before the first
    such move the next one is used; a path without any takes the x axis (or y where the tool lies along x).
    Raises CuttingError for shapes that differ.
    """
    _, across = _moves(p, k)
    axis = as_floats(k, "tool axis", (None, 3), error=CuttingError)
    axis = axis / np.linalg.norm(axis, axis=1, keepdims=True)
    moving = feed_share(p, k) > PLUNGE
    moving &= np.linalg.norm(across, axis=1) > 0.0
    fallback = np.where(np.abs(axis[:, :1]) > 0.9, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
    feed = fallback
    if moving.any():
        index = np.maximum.accumulate(np.where(moving, np.arange(len(moving)), -1))
        index[index < 0] = np.flatnonzero(moving)[0]
        feed = across[index]
        # A direction carried over to a step whose axis has turned need not lie across that axis, or may lie along it.
        lying = np.linalg.norm(np.cross(feed, axis), axis=1, keepdims=True)
        feed = np.where(lying > PLUNGE * np.linalg.norm(feed, axis=1, keepdims=True), feed, fallback)
    feed = feed - np.sum(feed * axis, axis=1, keepdims=True) * axis
    feed = feed / np.linalg.norm(feed, axis=1, keepdims=True)
    return np.stack([feed, np.cross(axis, feed), axis], axis=-1)


def _moves(p: ArrayLike, k: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """The moves (m, 3), first one zero, and their parts across the tool axis."""
    points = as_floats(p, "path points", (None, 3), error=CuttingError)
    axis = as_floats(k, "tool axis", (None, 3), error=CuttingError)
    if points.ndim != 2 or points.shape != axis.shape:
        raise CuttingError(f"Feed frame: path points {points.shape} and tool axes {axis.shape} should both be (m, 3).")
    axis = axis / np.linalg.norm(axis, axis=1, keepdims=True)
    step = np.diff(points, axis=0, prepend=points[:1])
    return step, step - np.sum(step * axis, axis=1, keepdims=True) * axis


def force_on_tool(model: ForceModel, conditions: CutConditions, R_MF: ArrayLike) -> FloatArray:
    """Force ON the tool F (m, 3) N in {M}; ``R_MF`` (m, 3, 3) are the feed frames in {M}. Exactly 0 on rapids.

    Models that know the engagement give 0 in air by themselves; constant ones push wherever the path cuts.
    """
    frames = as_floats(R_MF, "feed frames", (3, 3), error=CuttingError)
    if frames.shape != (len(conditions), 3, 3):
        raise CuttingError(f"Feed frames: expected shape ({len(conditions)}, 3, 3), found {frames.shape}.")
    F = model.components(conditions)
    if model.frame == "path":
        F = np.einsum("mij,mj->mi", frames, F)
    return np.where(conditions.cutting[:, None], F, 0.0)
