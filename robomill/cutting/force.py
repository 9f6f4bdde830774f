"""Force ON the tool along the path: one interface for every model. N, feed frame or {M}.

The feed frame at a step has the axes feed (across the tool axis), feed-normal = z_T x feed (the left of the feed)
and axial = z_T (out of the part, towards the spindle).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import BoolArray, FloatArray, as_floats
from robomill.cutting.conditions import STRAIGHT, CutConditions
from robomill.cutting.materials import Material
from robomill.cutting.numbers import Number, numbers_of, with_number
from robomill.cutting.tool import Cutter
from robomill.cutting.unjudged import Unjudged, against_hand
from robomill.errors import CuttingError
from robomill.progress import gathered
from robomill.provenance import BY_HAND, Finding, Provenance
from robomill.quantities import described, settle
from robomill.values import Said, Value
from robomill.vectors import across

Frame = Literal["path", "M"]
COMPONENTS = {"feed": "feed", "feed_normal": "feed-normal", "axial": "axial"}
"""Of a force in the feed frame, in their order: the name in files and what people call it."""


@dataclass(frozen=True, eq=False)
class MeanForce:
    """The force that pushed so far, so that another model can start from it: (3,) N in {M}, and feed frame."""

    in_M: FloatArray
    along_path: FloatArray


@dataclass(frozen=True, eq=False)
class ForceSpread:
    """Lowest and highest of each component, each (m, 3) N: over a revolution, or over alternative coefficients.

    ``at_peak`` (m, 3) is the force vector at the instant (or for the coefficients) at which it is largest.
    """

    low: FloatArray
    high: FloatArray
    at_peak: FloatArray


class ForceModel(Said, Value):
    """Mean force on the tool at every step, in the ``frame`` it is known in. Each model is a file in ``forces``.

    A child is a frozen dataclass whose numbers are declared with ``quantity``; they are checked here, and files, the
    page and the report follow from them. Fields of other types (a material, a record) are read, written and drawn by
    their type; a field ``cutter`` is the set-up's. Raises CuttingError for a number that cannot be.

    kind         its name in files; a child that states one is found in ``kinds``
    title, hint  what the page calls it, and says beneath its numbers; ``rank`` where it stands among the others
    follows_cut  whether it follows feed, depth and arc of engagement by itself, so that deflection can change it
    ends_with_material   whether the engagement, where it is computed, ends the force in air
    stated       whether its numbers are a person's, so that the page says where they come from
    of_milling   whether it is what a milling cutter is pushed with, so that it says nothing of a tap
    takes, example   the law of the material rows it needs, and the sample it starts with
    frame        ``"path"``: feed, feed-normal, axial; ``"M"``: x, y, z of the robot's frame

    Examples
    --------
    >>> import robomill as rm
    >>> isinstance(rm.PathForce(axial=-20.0), rm.ForceModel)
    True
    """

    kind: ClassVar[str] = ""
    title: ClassVar[str] = ""
    hint: ClassVar[str | None] = None
    rank: ClassVar[int] = 100
    follows_cut: ClassVar[bool] = False
    ends_with_material: ClassVar[bool] = True
    stated: ClassVar[bool] = True
    of_milling: ClassVar[bool] = True
    takes: ClassVar[type[Material] | None] = None
    example: ClassVar[str] = ""
    kinds: ClassVar[dict[str, type[ForceModel]]] = {}

    def _said(self) -> str:
        return self.numbers or self.title

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if cls.kind:
            ForceModel.kinds[cls.kind] = cls

    def __post_init__(self) -> None:
        settle(self, CuttingError, f"{self.kind.replace('_', ' ').capitalize()} force")

    @classmethod
    def first(cls, mean: MeanForce) -> dict[str, Any]:
        """Its numbers when it is chosen in place of a model that pushed ``mean``."""
        return {}

    @property
    def frame(self) -> Frame:
        """Axes of ``components``."""
        return "path"

    @property
    def provenance(self) -> Provenance:
        """Where its numbers come from."""
        return BY_HAND

    @property
    def notes(self) -> tuple[str, ...]:
        """What a person has noted of its numbers."""
        return ()

    @property
    def uncertain(self) -> list[Number]:
        """The numbers that make it larger or smaller and that nobody knows exactly: its components, in N. Where there
        are none the whole of it is."""
        return [each for each in numbers_of(self) if each.unit == "N"]

    def changed(self, key: str, by: float) -> Self:
        """With one of its ``uncertain`` numbers changed ``by`` so much; itself where it has no such one."""
        return with_number(self, key, by)

    def findings(self, conditions: CutConditions) -> tuple[Finding, ...]:
        """What is unknown or assumed, for the result."""
        return tuple(Finding("info", words, code="force-note") for words in self.notes)

    @property
    def numbers(self) -> str:
        """Its numbers in words, for the report."""
        return described(self) + (" in {M}" if self.frame == "M" else "")

    @property
    def in_time(self) -> bool:
        """Whether it runs by the clock, so that the time of rapids and dwells must be known."""
        return False

    @property
    def turns_with_part(self) -> bool:
        """Whether its axes are the part's, so that a turned part turns it."""
        return False

    def placed(self, R_MW: FloatArray) -> Self:
        """The same model for a part whose axes in {M} are R_MW (3, 3); itself where it does not depend on them."""
        return self

    @property
    def exponents(self) -> tuple[float, ...]:
        """Exponents of the chip thickness that its law has; the engaged part is summed for them."""
        return ()

    def unjudged(self, conditions: CutConditions) -> tuple[Unjudged, ...]:
        """Steps in the material whose force it has no model for, reason by reason; each is NaN in ``force_on_tool``."""
        return against_hand(conditions, conditions.tooling) if conditions.tooling else ()

    def cut_by(self, cutter: Cutter) -> Self:
        """The same model for another cutter; itself where it does not depend on one."""
        return self

    def components(self, conditions: CutConditions) -> FloatArray:
        """Mean force ON the tool at every step, (m, 3) N, in ``frame``."""
        raise NotImplementedError

    def peak(self, conditions: CutConditions) -> ForceSpread | None:
        """Extremes over a revolution, feed frame; None where only a mean is known."""
        return None

    def by_material(self, conditions: CutConditions) -> list[tuple[Material, FloatArray]]:
        """Mean force (m, 3) N for the material in force and each other of its alloy; none without a material."""
        return []

    def at_ends(self, conditions: CutConditions) -> list[FloatArray]:
        """Mean force (m, 3) N at the ends of what is assumed of it; none where nothing is."""
        return []


def feed_share(way: ArrayLike, k: ArrayLike) -> FloatArray:
    """Share (m,) of every way that lies across the tool axis: 1 on the level, 0 in a plunge, 1 where nothing moves.

    ``way`` (m, 3) is where the tip goes (a vector of any length, 0 where it stands), ``k`` (m, 3) the tool axis, both
    in one frame.
    """
    step, axis = _ways(way, k)
    length = np.linalg.norm(step, axis=1)
    flat = np.linalg.norm(across(step, axis), axis=1)
    return np.divide(flat, length, out=np.ones(len(length)), where=length > 0.0)


def feed_along(way: ArrayLike, k: ArrayLike) -> FloatArray:
    """Part (m,) of every way, as a unit vector, along the tool axis: 0 on the level, -1 straight down, 0 where nothing
    moves; ``way`` and ``k`` (m, 3) as above."""
    step, axis = _ways(way, k)
    length = np.linalg.norm(step, axis=1)
    return np.divide(np.sum(step * axis, axis=1), length, out=np.zeros(len(length)), where=length > 0.0)


def feed_frame(way: ArrayLike, k: ArrayLike) -> FloatArray:
    """Feed frames R (m, 3, 3) in the frame of ``way`` and ``k`` (m, 3); columns feed, feed-normal, axial.

    Orthonormal and right-handed. Feed is the part of the way across the tool axis.
    Where a way has none (plunge, retract, standstill) the last direction that had one is kept, and before the first
    such way the next one is used; a path without any takes the x axis (or y where the tool lies along x).
    Raises CuttingError for shapes that differ.
    """
    step, axis = _ways(way, k)
    m = len(step)

    def moves(some: slice) -> BoolArray:
        lies_across = np.linalg.norm(across(step[some], axis[some]), axis=1) > 0.0
        return np.asarray(lies_across & (feed_share(step[some], axis[some]) > STRAIGHT))

    moving = gathered(m, "", moves)
    index = np.maximum.accumulate(np.where(moving, np.arange(m), -1))
    index[index < 0] = np.argmax(moving) if m else 0

    def frames(some: slice) -> FloatArray:
        here = axis[some]
        feed = fallback = np.where(np.abs(here[:, :1]) > 0.9, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
        if moving.any():
            feed = across(step[index[some]], axis[index[some]])
            # A direction carried over to a step whose axis has turned need not lie across that axis, or lie along it.
            lying = np.linalg.norm(np.cross(feed, here), axis=1, keepdims=True)
            feed = np.where(lying > STRAIGHT * np.linalg.norm(feed, axis=1, keepdims=True), feed, fallback)
        feed = across(feed, here)
        feed = feed / np.linalg.norm(feed, axis=1, keepdims=True)
        return np.stack([feed, np.cross(here, feed), here], axis=-1)

    return gathered(m, "", frames)


def _ways(way: ArrayLike, k: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Ways (m, 3) and unit axes (m, 3), checked."""
    step = as_floats(way, "ways", (None, 3), error=CuttingError)
    axis = as_floats(k, "tool axis", (None, 3), error=CuttingError)
    if step.ndim != 2 or step.shape != axis.shape:
        raise CuttingError(f"Feed frame: ways {step.shape} and tool axes {axis.shape} should both be (m, 3).")
    return step, axis / np.linalg.norm(axis, axis=1, keepdims=True)


def force_on_tool(model: ForceModel, conditions: CutConditions, R_MF: ArrayLike) -> FloatArray:
    """Force ON the tool F (m, 3) N in {M}; ``R_MF`` (m, 3, 3) are the feed frames in {M}. Exactly 0 on rapids, NaN
    where the model does not know it (``ForceModel.unjudged``).

    Models that know the engagement give 0 in air by themselves; constant ones push wherever the path cuts.
    """
    return _on_tool(model, conditions, R_MF, model.components(conditions))


def force_by_material(
    model: ForceModel, conditions: CutConditions, R_MF: ArrayLike
) -> list[tuple[Material, FloatArray]]:
    """``force_on_tool`` for the material in force and each other of its alloy; none without a material."""
    return [(row, _on_tool(model, conditions, R_MF, F)) for row, F in model.by_material(conditions)]


def force_at_ends(model: ForceModel, conditions: CutConditions, R_MF: ArrayLike) -> list[FloatArray]:
    """``force_on_tool`` at the ends of what is assumed of the force; none where nothing is."""
    return [_on_tool(model, conditions, R_MF, F) for F in model.at_ends(conditions)]


def _on_tool(model: ForceModel, conditions: CutConditions, R_MF: ArrayLike, components: FloatArray) -> FloatArray:
    """Components (m, 3) N in the model's frame as the force on the tool in {M}: 0 on rapids, NaN where unjudged."""
    frames = as_floats(R_MF, "feed frames", (3, 3), error=CuttingError)
    if frames.shape != (len(conditions), 3, 3):
        raise CuttingError(f"Feed frames: expected shape ({len(conditions)}, 3, 3), found {frames.shape}.")
    F = np.array(components)
    for unknown in model.unjudged(conditions):
        F[unknown.where] = np.nan
    if model.frame == "path":
        F = np.einsum("mij,mj->mi", frames, F)
    return np.where(conditions.cutting[:, None], F, 0.0)
