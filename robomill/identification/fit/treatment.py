"""How load tests are treated, whichever the model: where links bend, which points are fitted, what counts how much."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal, TypedDict

import numpy as np

from robomill.errors import LoadTestError
from robomill.identification.fit.folds import LEAVE_OUT
from robomill.identification.pull.points import FREED, Point

BENDING_JOINTS = (2, 3)
AUTO: Literal["auto"] = "auto"
WEIGHTS = {"equal": "every reading of a gauge alike", "size": "every test by its relative error"}


class Choices(TypedDict, total=False):
    """The fields of a Treatment as they may be given by name, for type checkers and completion."""

    bending: Literal["auto"] | Iterable[int]
    fit_points: Literal["none", "force", "gauge", "both"]
    robust: bool
    exclude: Iterable[int]
    weights: Literal["equal", "size"]
    leave_out: Literal["pose", "neighbours"]


@dataclass(frozen=True)
class Treatment:
    """Choices about load tests.

    bending: joints (1-based) at which links bend, in models with bending; "auto": in every model, at the joints that a
    cross-validation of their own names in each fold, or none; fit_points: none, force, gauge or both, the points of the
    tool that are fitted beside the compliances; robust: weigh down tests that do not fit (Tukey's bisquare); exclude:
    rows left out; weights: "equal", or "size" for errors that grow with the displacement; leave_out: what
    cross-validation leaves out together, "pose" (spread over the fold by a fixed shuffle) or "neighbours".
    """

    bending: Literal["auto"] | tuple[int, ...] = BENDING_JOINTS
    fit_points: str = "none"
    robust: bool = False
    exclude: tuple[int, ...] = ()
    weights: str = "equal"
    leave_out: str = "pose"

    def __post_init__(self) -> None:
        for name, known in (("fit_points", FREED), ("weights", WEIGHTS), ("leave_out", LEAVE_OUT)):
            if getattr(self, name) not in known:
                listed = ", ".join(known)
                raise LoadTestError(f"{name}: found {getattr(self, name)!r}, expected one of {listed}.")
        if not isinstance(self.robust, bool):
            raise LoadTestError(f"robust: found {self.robust!r:.40}, expected True or False.")
        if self.bending != AUTO:
            joints = _wholes("bending", self.bending, "joint numbers, e.g. [2, 3], or auto")
            object.__setattr__(self, "bending", tuple(dict.fromkeys(joints)))
        rows = _wholes("exclude", self.exclude, "numbers of rows, e.g. [2, 3]")
        object.__setattr__(self, "exclude", tuple(sorted({*rows})))

    @property
    def freed(self) -> tuple[Point, ...]:
        """The points that are fitted."""
        return FREED[self.fit_points]


def _wholes(name: str, given: Any, expected: str) -> tuple[int, ...]:
    """Whole numbers, in their order."""
    found = list(given) if isinstance(given, Iterable) and not isinstance(given, str | bytes) else None
    if found is None or not all(isinstance(each, int | np.integer) and not isinstance(each, bool) for each in found):
        raise LoadTestError(f"{name}: found {given!r:.60}, expected {expected}.")
    return tuple(map(int, found))


STANDARD = Treatment()
