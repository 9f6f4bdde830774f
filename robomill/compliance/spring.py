"""What gives beside the joints: tool, spindle, bending of bearings and links. Each spring is a line of its own.

Every spring turns the joint frames of a configuration into its own translational compliance of the tip in {M}.
They act in series with the joints, so contributions and deflections simply add. Their kinds stand in ``springs``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, as_floats
from robomill.cutting.tool import Cutter
from robomill.errors import RobotError
from robomill.provenance import TYPED as TYPED, Provenance
from robomill.quantities import settle
from robomill.values import Said

ASSUMED = Provenance("assumed", "entered without a source")


class Spring(Said):
    """Something in series with the joints; its children say how it gives (``contribution``).

    A child is a frozen dataclass whose numbers are declared with ``quantity``; they are checked here, and files, the
    page and the result follow from them. Raises RobotError for a number that cannot be.

    kind        its name in files; a child that states one is found in ``kinds``
    title, hint what its switch on the page says, ``rank`` where it stands among the others
    follows_tooth  whether it is light enough to follow each tooth; the others see the mean force
    at_tip      whether it is stated at the tip, of the first tool that cuts: a longer one leans on it more, by what
                nobody has said
    each_joint  whether there is one a joint (then it has the field ``joint``, 1-based among the free joints)
    """

    kind: ClassVar[str] = ""
    title: ClassVar[str] = ""
    hint: ClassVar[str | None] = None
    rank: ClassVar[int] = 100
    follows_tooth: ClassVar[bool] = False
    at_tip: ClassVar[bool] = False
    each_joint: ClassVar[bool] = False
    kinds: ClassVar[dict[str, type[Spring]]] = {}

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if cls.kind:
            Spring.kinds[cls.kind] = cls

    def __post_init__(self) -> None:
        settle(self, RobotError, self.name.capitalize())

    @classmethod
    def first(cls, cutter: Cutter) -> Self:
        """What it starts with when it is switched on."""
        return cls()

    @property
    def name(self) -> str:
        """What the result calls its line."""
        return self.title.lower()

    @property
    def provenance(self) -> Provenance:
        """Where its stiffness comes from."""
        raise NotImplementedError

    @property
    def facts(self) -> str:
        """What to say beside its numbers: its source, unless there is more to say."""
        return self.provenance.source

    def edited(self, **changes: Any) -> Self:
        """A copy with numbers typed by a person, who is then its source."""
        return replace(self, **{"provenance": TYPED, **changes})  # type: ignore[type-var]

    def fitted(self, cutter: Cutter) -> Self:
        """Itself as ``cutter`` has it, for springs that know one; what differs is offered on the page."""
        return self

    def of_tool(self, cutter: Cutter, longer: float) -> Self:
        """Itself with another tool in the spindle, ``longer`` (m) than the one it was stated for."""
        return self

    def doubted(self, cutters: Sequence[Cutter]) -> str:
        """What looks like another unit, or another tool than the ``cutters`` of a cut; empty where nothing does."""
        return ""

    def contribution(self, frames: ArrayLike) -> FloatArray:
        """C (..., 3, 3) m/N in {M} from joint frames (..., n + 1, 4, 4) in {M}; the last frame is {T}."""
        raise NotImplementedError


def extra_contributions(springs: Sequence[Spring], frames: ArrayLike) -> FloatArray:
    """C_extra (..., k, 3, 3) m/N in {M}, one a spring in their order; k may be 0.

    ``frames`` (..., n + 1, 4, 4) as ``joint_frames`` gives them (NaN where not reached stays NaN). The result goes
    through ``deflection`` as the joints' C_joint does, so every spring has its own line.
    """
    frames = checked_frames(frames)
    if not springs:
        return np.zeros((*frames.shape[:-3], 0, 3, 3))
    return np.stack([spring.contribution(frames) for spring in springs], axis=-3)


def about_tool(frames: ArrayLike, lateral: float, axial: float) -> FloatArray:
    """lateral (1 - z z^T) + axial z z^T, (..., 3, 3) m/N in {M}, with the tool axis z_T of the last frame."""
    z = checked_frames(frames)[..., -1, :3, 2]
    along = z[..., :, None] * z[..., None, :]
    return lateral * (np.eye(3) - along) + axial * along


def checked_frames(frames: ArrayLike) -> FloatArray:
    """Joint frames (..., n + 1, 4, 4); NaN is allowed."""
    return as_floats(frames, "joint frames", (None, 4, 4), error=RobotError, finite=False)
