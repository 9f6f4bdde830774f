"""Arrays of load tests at the door: shapes, and what is no number."""

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, IntArray, as_floats
from robomill.errors import LoadTestError

UNIT_VECTOR = 0.02  # how far the length of a written direction may be from 1


def floats(value: ArrayLike, name: str) -> FloatArray:
    """Numbers of any shape: no masked ones, which NumPy would take for read."""
    return as_floats(value, name, (), error=LoadTestError, finite=False)


def six_columns(value: ArrayLike, name: str) -> FloatArray:
    """(m, 3) or (m, 6) as (m, 6): no moment, rotation not measured."""
    array = floats(value, name)
    if array.ndim != 2 or array.shape[1] not in (3, 6):
        raise LoadTestError(f"{name}: expected shape (m, 3) or (m, 6), found {array.shape}.")
    if array.shape[1] == 6:
        return array
    fill = 0.0 if name == "wrench" else np.nan
    return np.concatenate([array, np.full_like(array, fill)], axis=1)


def given_or(value: ArrayLike | None, shape: tuple[int, ...], name: str, fill: float = 0.0) -> FloatArray:
    """An array of that shape, of which the last axis may be given alone, or one number where there is no other."""
    if value is None:
        return np.full(shape, fill)
    array = floats(value, name)
    if array.shape not in (shape, shape[1:]):
        one = "one number" if len(shape) == 1 else f"shape {shape[1:]}"
        raise LoadTestError(f"{name}: expected {one} or shape {shape}, found {array.shape}.")
    return np.broadcast_to(array, shape)


def gauge_directions(value: ArrayLike, displacement: FloatArray, row: IntArray) -> FloatArray:
    """(m, 3, 3) directions, of unit length where anything was read along them."""
    along, shape = floats(value, "gauges"), (len(row), 3, 3)
    if along.shape != shape:
        raise LoadTestError(f"gauges: expected shape {shape}, three directions a test, found {along.shape}.")
    size = np.linalg.norm(along, axis=-1)
    odd = np.isfinite(displacement[:, :3]) & ~(np.abs(size - 1.0) <= UNIT_VECTOR)
    if odd.any():
        k, gauge = np.argwhere(odd)[0]
        raise LoadTestError(
            f"Row {row[k]}, gauge {gauge + 1}: found a direction of length {size[k, gauge]:.3g}, expected a unit "
            "vector in {M}."
        )
    return along
