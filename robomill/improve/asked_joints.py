"""What is asked of joints that may be made stiffer, checked, and what was found of them, in words."""

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, as_floats, brief
from robomill.errors import SetupError
from robomill.units import format_short
from robomill.wording import listed

SETTLED = 1e-3  # change of a stiffness ratio, of itself, that is none


def checked_bounds(bounds: ArrayLike, n: int) -> FloatArray:
    given = np.asarray(bounds, dtype=object)
    if given.shape not in ((2,), (n, 2)):
        raise SetupError(
            f"Bounds of the stiffness ratio: expected two numbers, the least and the most times as stiff, such as "
            f"(1, 4), or two for each of {n} joints; found {brief(bounds)}.",
            where="bounds",
        )
    shape = (n, 2) if given.ndim == 2 else (2,)
    found = np.broadcast_to(as_floats(bounds, "bounds", shape, error=SetupError), (n, 2))
    for joint, (low, high) in enumerate(found, 1):
        if not 0.0 < low <= high:
            raise SetupError(
                f"Bounds of the stiffness ratio of free joint {joint}: found {low:g} to {high:g}, expected two numbers "
                "above zero, the smaller one first.",
                where="bounds",
            )
    return np.asarray(found)


def checked_weight(weight: ArrayLike, n: int) -> FloatArray:
    """(n,) weights. Raises SetupError for others than numbers above zero, one for all joints or one for each."""
    weights = as_floats(weight, "Weight", (), error=SetupError)
    if weights.shape not in ((), (n,)) or (weights <= 0.0).any():
        words = f"expected numbers above zero, one for all {n} joints or one for each"
        raise SetupError(f"Weight: {words}; found {brief(weight)}.", where="weight")
    return np.broadcast_to(weights, (n,))


def joints_named(numbers: tuple[int, ...], ratios: FloatArray) -> list[str]:
    """The joints that do not stay as they are, each with how many times as stiff it is: ``joint 3 1.25 times``."""
    return [
        f"joint {number} {format_short(ratio, '1', 3)} times"
        for number, ratio in zip(numbers, ratios, strict=True)
        if abs(ratio - 1.0) > SETTLED
    ]


def words_of_joints(numbers: tuple[int, ...], ratios: FloatArray) -> tuple[str, int] | None:
    """Which joints are how many times as stiff, and how many they are; None where none is."""
    named = joints_named(numbers, ratios)
    return (listed(named), len(named)) if named else None
