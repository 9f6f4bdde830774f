"""The door between SI and the shop floor, and the canonical fingerprint."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robomill.arrays import as_floats, digest, frozen
from robomill.errors import RobotError
from robomill.units import UNITS, format_si, format_value, from_si, to_si

# The factor of each unit, written independently of the table: one unit in SI.
ONE = {
    "mm": 0.001,
    "um": 1e-6,
    "in": 0.0254,
    "deg": math.radians(1),
    "mm/min": 0.001 / 60,
    "mm/s": 0.001,
    "1/min": 1 / 60,
    "min": 60.0,
    "N/mm2": 1e6,
    "N/mm": 1000.0,
    "um/N": 1e-6,
    "N/um": 1e6,
    "1e-7 rad/(N m)": 1e-7,
    "kN m/rad": 1000.0,
    "urad/N": 1e-6,
    "mm3": 1e-9,
    "mm2": 1e-6,
    "%": 0.01,
    "in/min": 0.0254 / 60,
}


@pytest.mark.parametrize("unit", UNITS)
@given(value=st.floats(-1e9, 1e9))
def test_every_factor_round_trips(unit: str, value: float) -> None:
    assert from_si(to_si(value, unit), unit) == pytest.approx(value, rel=1e-14, abs=1e-300)


@pytest.mark.parametrize(("unit", "factor"), ONE.items())
def test_factors_are_the_right_way_up(unit: str, factor: float) -> None:
    assert to_si(1.0, unit) == pytest.approx(factor, rel=1e-15)


def test_one_formatter() -> None:
    assert format_si(2.2954e-4, "mm") == "0.230 mm"
    assert format_si(-1.024e-4, "mm") == "−0.102 mm"
    assert format_si(1e-9, "mm", sign=True) == "0.000 mm"
    assert format_si(math.nan, "mm") == "not reached"
    assert format_value(45.0, "deg") == "45.00°"
    assert format_si(7.14e-7, "1e-7 rad/(N m)") == "7.14 ×10⁻⁷ rad/(N m)"


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
