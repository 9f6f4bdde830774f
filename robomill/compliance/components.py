"""The six components of a symmetric 3 x 3 matrix: their order, their names and the matrix they make."""

from typing import Any

from numpy.typing import NDArray

ROW, COLUMN = (0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)
COMPONENTS = tuple("xyz"[i] + "xyz"[j] for i, j in zip(ROW, COLUMN))  # xx, yy, zz, xy, xz, yz
DIRECT, CROSS = COMPONENTS[:3], COMPONENTS[3:]


def symmetric(six: NDArray[Any]) -> NDArray[Any]:
    """(..., 3, 3) from the six components (..., 6)."""
    return six[..., [[0, 3, 4], [3, 1, 5], [4, 5, 2]]]
