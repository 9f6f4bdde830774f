"""The door between SI and the shop floor."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

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
