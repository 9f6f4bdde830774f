"""Units as they are written behind a number, against what each is made of."""

from __future__ import annotations

import math

import pytest

from robomill.unit_words import alike, meaning, measure
from robomill.units import UNITS, to_si, unit_label


@pytest.mark.parametrize("unit", UNITS)
def test_a_unit_made_of_simple_ones_is_the_one_of_the_table(unit: str) -> None:
    assert measure(unit).factor == pytest.approx(to_si(1.0, unit), rel=1e-14)
    label = unit_label(unit)
    if label and "×" not in label:
        assert measure(unit).same(measure(label))


@pytest.mark.parametrize(
    ("words", "unit"),
    [
        ("µm", "um"),
        ("μm", "um"),
        ("microns", "um"),
        ('"', "in"),
        ("''", "in"),
        ("″", "in"),
        ("inch", "in"),
        ("MM", "mm"),
        ("Deg", "deg"),
        ("°", "deg"),
        ("rpm", "1/min"),
        ("RPM", "1/min"),
        ("rev/min", "1/min"),
        ("U/min", "1/min"),
        ("min^-1", "1/min"),
        ("min⁻¹", "1/min"),
        ("ipm", "in/min"),
        ("mm min⁻¹", "mm/min"),
        ("Nm", "N m"),
        ("N·m", "N m"),
        ("N.m", "N m"),
        ("N*m", "N m"),
        ("kNm/rad", "kN m/rad"),
        ("N/mm²", "N/mm2"),
        ("N/mm^2", "N/mm2"),
        ("MPa", "N/mm2"),
        ("µrad/(N m)", "urad/(N m)"),
        ("urad/Nm", "urad/(N m)"),
        ("rad/N/m", "urad/(N m)"),
        ("µm N^-1", "um/N"),
    ],
)
def test_other_ways_to_write_a_unit_mean_the_same(words: str, unit: str) -> None:
    found = meaning(words)
    assert found is not None
    assert found.dimensions == measure(unit).dimensions
    factor = 1e-6 if words == "rad/N/m" else 1.0
    assert found.factor * factor == pytest.approx(measure(unit).factor, rel=1e-14)


def test_a_unit_that_no_field_has_is_made_of_those_that_it_names() -> None:
    assert meaning("m/min") == meaning("m/ min")
    assert math.isclose(measure("m/min").factor, 1 / 60)
    assert math.isclose(measure("rad/(N*m)").factor, 1.0)
    assert math.isclose(measure("GPa").factor, 1e9)
    assert math.isclose(measure("N mm").factor, 1e-3)


@pytest.mark.parametrize(
    "words", ["", " ", "foo", "nm", "mN", "M m m x", "mm)", "(mm", "mm/", "/", "mm//s", "5 mm", "yd", "mm 2", "N/()/"]
)
def test_what_is_no_unit_has_no_meaning(words: str) -> None:
    assert meaning(words) is None


def test_units_of_one_dimension_are_named_beside_each_other() -> None:
    assert set(alike("mm")) == {"m", "cm", "µm", "in", "thou", "µin", "ft"}
    assert set(alike("deg")) == {"rad", "mrad", "µrad"}
    assert alike("1") == ["%"]
    assert alike("1/min") == ["Hz"]
    assert not measure("mm").same(measure("m"))
    assert not measure("N").same(measure("m"))
