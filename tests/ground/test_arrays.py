"""Shape checks at the door, read-only arrays, and the canonical fingerprint."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.arrays import as_floats, digest, frozen
from robomill.errors import RobotError


def test_as_floats_says_what_was_found() -> None:
    with pytest.raises(RobotError, match=r"limits: expected shape \(\.\.\., any, 2\), found \(3,\)"):
        as_floats([1, 2, 3], "limits", (None, 2), error=RobotError)
    with pytest.raises(RobotError, match="NaN or infinity"):
        as_floats([[1, np.nan]], "limits", (None, 2), error=RobotError)
    with pytest.raises(RobotError, match="expected numbers"):
        as_floats("abc", "limits", (None, 2), error=RobotError)


def test_frozen_arrays_cannot_be_written() -> None:
    array = frozen([1.0, 2.0])
    with pytest.raises(ValueError, match="read-only"):
        array[0] = 3.0


def test_digest_sees_one_changed_cell_in_a_million() -> None:
    field = np.zeros((1000, 1000))
    other = field.copy()
    other[517, 333] = 1e-300
    assert digest(field) != digest(other)
    assert digest(field) == digest(field.copy())
    assert digest({"a": 1, "b": [2.0]}) == digest({"b": [2.0], "a": 1})
    assert digest([1.0]) != digest([1])
