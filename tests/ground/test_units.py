"""The door between SI and the shop floor."""

from __future__ import annotations

import dataclasses
import math
import re
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given, strategies as st

from robomill.typed_numbers import read_number
from robomill.unit_words import measure
from robomill.units import (
    GAP,
    INCHES,
    MINUS,
    UNITS,
    format_beside,
    format_bytes,
    format_count,
    format_duration,
    format_limit,
    format_many,
    format_number,
    format_percent,
    format_plain,
    format_share,
    format_short,
    format_short_count,
    format_si,
    format_significant,
    format_times,
    format_value,
    from_si,
    in_lengths,
    rounded,
    split_unit,
    to_si,
    unit_label,
)

# What one unit is in SI, how it is written and the decimals shown, written down independently of the table.
KNOWN = {
    "1": (1, "", 3),
    "%": (1 / 100, "%", 1),
    "m": (1, "m", 4),
    "cm": (1 / 100, "cm", 2),
    "mm": (1 / 1000, "mm", 3),
    "um": (1 / 1000**2, "µm", 1),
    "in": (0.3048 / 12, "in", 4),
    "thou": (0.3048 / 12 / 1000, "thou", 2),
    "uin": (0.3048 / 12 / 1000**2, "µin", 1),
    "ft": (0.3048, "ft", 3),
    "in/s": (0.3048 / 12, "in/s", 2),
    "deg/in": (math.radians(12 / 0.3048), "°/in", 0),
    "in/tooth": (0.3048 / 12, "in/tooth", 5),
    "N/in": (12 / 0.3048, "N/in", 1),
    "MPa": (1000**2, "MPa", 1),
    "uin/N": (0.3048 / 12 / 1000**2, "µin/N", 2),
    "in/N": (0.3048 / 12, "in/N", 8),
    "N/thou": (12 / 0.3048 * 1000, "N/thou", 2),
    "ft2": (0.3048**2, "ft²", 3),
    "ft3": (0.3048**3, "ft³", 2),
    "in3": ((0.3048 / 12) ** 3, "in³", 5),
    "in2": ((0.3048 / 12) ** 2, "in²", 5),
    "cm3/min": ((1 / 100) ** 3 / 60, "cm³/min", 1),
    "in3/min": ((0.3048 / 12) ** 3 / 60, "in³/min", 2),
    "rad": (1, "rad", 5),
    "deg": (math.radians(1), "°", 2),
    "mrad": (1 / 1000, "mrad", 3),
    "urad": (1 / 1000**2, "µrad", 1),
    "deg/s": (math.radians(1), "°/s", 0),
    "deg/mm": (math.radians(1000), "°/mm", 1),
    "mm/s": (1 / 1000, "mm/s", 1),
    "mm/min": (1 / 1000 / 60, "mm/min", 0),
    "in/min": (0.3048 / 12 / 60, "in/min", 2),
    "mm/tooth": (1 / 1000, "mm/tooth", 4),
    "1/min": (1 / 60, "min⁻¹", 0),
    "s": (1, "s", 1),
    "Hz": (1, "Hz", 1),
    "min": (60, "min", 2),
    "N": (1, "N", 1),
    "kN": (1000, "kN", 3),
    "N m": (1, "N m", 2),
    "kN m": (1000, "kN m", 3),
    "kg": (1, "kg", 2),
    "N/mm": (1000, "N/mm", 2),
    "N/mm2": (1000**2, "N/mm²", 1),
    "um/N": (1 / 1000**2, "µm/N", 3),
    "mm/N": (1 / 1000, "mm/N", 6),
    "m/N": (1, "m/N", 9),
    "N/um": (1000**2, "N/µm", 3),
    "1e-7 rad/(N m)": (1 / 10**7, "×10⁻⁷ rad/(N m)", 2),
    "kN m/rad": (1000, "kN m/rad", 1),
    "1e-9 m/N": (1 / 10**9, "×10⁻⁹ m/N", 2),
    "urad/N": (1 / 1000**2, "µrad/N", 3),
    "urad/(N m)": (1 / 1000**2, "µrad/(N m)", 3),
    "m2": (1, "m²", 3),
    "m3": (1, "m³", 3),
    "mm3": (1 / 1000**3, "mm³", 1),
    "mm2": (1 / 1000**2, "mm²", 2),
}


# Decimals that inches show where so many are asked of the metric unit: never fewer, but for µin, and never idle ones.
MORE = {
    "in": lambda n: max(n, min(n + 2, 4)),
    "thou": lambda n: max(n, min(n + 1, 2)),
    "uin/N": lambda n: max(n - 1, 0),
    "in/s": lambda n: max(n, min(n + 1, 2)),
    "in/tooth": lambda n: max(n, min(n + 2, 5)),
    "in/N": lambda n: max(n, min(n + 2, 8)),
    "in2": lambda n: max(n, min(n + 3, 5)),
    "in3": lambda n: max(n, min(n + 4, 5)),
}


@pytest.mark.parametrize("unit", sorted(INCHES))
def test_inches_measure_what_the_metric_unit_measures_and_hold_none_of_it(unit: str) -> None:
    shown = in_lengths(unit, "in")
    assert measure(shown).dimensions == measure(unit).dimensions
    assert in_lengths(unit, "mm") == unit
    assert re.search(r"m", unit_label(shown).replace("min", "")) is None


def test_every_unit_with_a_length_in_it_has_its_inches_and_no_other() -> None:
    long = {unit for unit in UNITS if "length" in dict(measure(unit).dimensions)}
    held = {unit for unit in long if not re.search(r"\bu?in($|/|\d)|ft|thou", unit)}
    turning = {"N m", "kN m", "1e-7 rad/(N m)", "kN m/rad", "urad/(N m)"}  # torque, by convention
    bare = {"m/N", "1e-9 m/N", "MPa", "N/mm2"}  # of linear joints; stress
    assert held - turning - bare == set(INCHES) - {"N/mm2"}
    assert all(in_lengths(unit, "in") == unit for unit in turning)


@pytest.mark.parametrize("unit", UNITS)
def test_every_unit_is_what_it_is_called(unit: str) -> None:
    factor, label, digits = KNOWN[unit]
    assert to_si(1.0, unit) == pytest.approx(factor, rel=1e-14)
    assert from_si(1.0, unit) == pytest.approx(1 / factor, rel=1e-14)
    assert unit_label(unit) == label
    decimals = format_value(1.0, unit, with_unit=False).partition(".")[2]
    assert len(decimals) == digits


def test_units_cannot_be_changed_on_the_way() -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        UNITS["mm"].factor = 1.0  # type: ignore[misc]


@given(value=st.floats(-1e9, 1e9), unit=st.sampled_from(sorted(UNITS)))
def test_every_factor_round_trips(value: float, unit: str) -> None:
    assert from_si(to_si(value, unit), unit) == pytest.approx(value, rel=1e-14, abs=1e-300)


def test_one_formatter() -> None:
    assert format_si(2.2954e-4, "mm") == "0.230 mm"
    assert format_si(-1.024e-4, "mm") == "−0.102 mm"
    assert format_si(1e-9, "mm", sign=True) == "0.000 mm"
    assert format_si(-1e-9, "mm") == "0.000 mm"
    assert format_si(1.5e-3, "mm", 1, sign=True) == "+1.5 mm"
    assert format_si(math.nan, "mm") == "not reached"
    assert format_si(math.nan, "mm", missing="–") == "–"
    assert format_si(math.inf, "N/um") == "∞"
    assert format_si(-math.inf, "N/um") == "−∞"
    assert format_value(45.0, "deg") == "45.00°"
    assert format_value(-45.0, "deg", 0, with_unit=False) == "−45"
    assert format_si(7.14e-7, "1e-7 rad/(N m)") == "7.14 ×10⁻⁷ rad/(N m)"
    assert format_si(0.5, "1") == "0.500"
    assert [format_short(v, "mm") for v in (8e-3, 1.25e-3, -0.1234567)] == ["8 mm", "1.25 mm", "−123.457 mm"]
    assert format_si(math.nan, "mm", with_unit=False) == "not reached"


def test_bare_numbers() -> None:
    assert [format_number(-0.0001, 3), format_number(-1.5, 3), format_number(0.25, 3, True)] == [
        "0.000",
        "−1.500",
        "+0.250",
    ]
    assert format_number(-0.0006, 3, sign=True) == "−0.001"
    assert format_number(np.float64(2.0), 0, sign=True) == "+2"
    assert format_significant(-0.00012345, 3) == "−0.000123"
    assert format_significant(1e-7, 3) == "1e−07"
    assert format_significant(12.5) == "12.5"
    assert format_significant(math.inf, 3) == "∞"
    assert format_percent(0.416) == "42 %"
    assert format_percent(-0.416, 1, sign=True) == "−41.6 %"
    assert format_percent(0.1, sign=True) == "+10 %"
    assert format_times(1234.0) == "× 1200"
    assert format_times(2.5, 6) == "× 2.5"
    assert format_times(1.0, 6) == "× 1"
    assert rounded(0.1 + 0.2) == 0.3
    assert rounded(0.123456789012345) == 0.123456789012
    assert format_significant(1.23456789) == "1.23457"
    assert format_times(1234567.0, 12) == f"× 1{GAP}234{GAP}567"
    assert rounded(1234.0, 2) == 1200.0


@given(number=st.integers(-(10**11), 10**11), digits=st.integers(0, 6))
def test_counts_lengths_and_times_part_their_thousands_alike(number: int, digits: int) -> None:
    whole = f"{number:,}".replace(",", GAP if abs(number) >= 10_000 else "").replace("-", MINUS)
    assert format_count(number) == whole
    assert format_number(number, digits) == (f"{whole}.{'0' * digits}" if digits else whole)
    assert format_significant(number, 15) == whole
    assert format_times(abs(number), 12) == f"× {whole.lstrip(MINUS)}"
    assert read_number(whole).value == number


def test_fractions_and_powers_of_ten_are_not_parted() -> None:
    assert format_number(0.123456789, 9) == "0.123456789"
    assert format_number(9999.96, 1) == f"10{GAP}000.0"
    assert format_si(75.036, "mm", 1) == f"75{GAP}036.0 mm"
    assert split_unit(format_si(75.036, "mm", 1)) == (f"75{GAP}036.0", "mm")
    assert format_significant(1.23456e20) == "1.23456e+20"


def test_counts() -> None:
    assert [format_count(n, "cut") for n in (0, 1, 2, 12400)] == ["0 cuts", "1 cut", "2 cuts", f"12{GAP}400 cuts"]
    assert format_count(12400) == f"12{GAP}400"
    assert [format_short_count(n) for n in (12, 9_999, 10_000, 812_345, 999_499, 999_500, 1_234_567)] == [
        "12",
        "9999",
        "10k",
        "812k",
        "999k",
        "1.0M",
        "1.2M",
    ]


def test_several_values_carry_their_unit_once() -> None:
    assert format_many(np.array([1e-3, -2e-3, 0.5]), "mm", 1) == "1.0, −2.0, 500.0 mm"
    assert format_many((0.1, 0.02), "mm", 0, " × ") == "100 × 20 mm"
    assert format_many((2.3e-4, 2e-5), "mm", 2, " ± ") == "0.23 ± 0.02 mm"
    assert format_many((1e-3, 2e-3), "mm", 0, sign=True) == "+1, +2 mm"
    assert format_many((1e-3, 2e-3), "mm", 0, " to ", with_unit=False) == "1 to 2"
    assert format_many([0.5], "m", 1, " × ") == "0.5 m"


@given(value=st.floats(-1e6, 1e6), unit=st.sampled_from(sorted(UNITS)), digits=st.integers(0, 6))
def test_what_is_shown_can_be_read_back(value: float, unit: str, digits: int) -> None:
    text = format_value(value, unit, digits)
    shown = MORE.get(unit, lambda n: n)(digits)  # asked of the metric unit
    assert read_number(text, unit).value == pytest.approx(round(value, shown), rel=1e-14)
    assert not text.startswith("-")
    label = UNITS[unit].label
    space = "" if label == "°" else " "
    assert text == f"{format_value(value, unit, digits, with_unit=False)}{space}{label}".rstrip()


def test_the_unit_comes_off_where_one_follows() -> None:
    assert split_unit("0.230 mm") == ("0.230", "mm")
    assert split_unit("24 lines") == ("24", "lines")
    assert split_unit("−0.5 µm/N") == ("−0.5", "µm/N")
    assert split_unit("1.134 m³") == ("1.134", "m³")
    for whole in ("not reached", "0.5", "of 1200", "100 of 500", "45.00°", "2 samples", "2 h 05 min", "80 of 100", ""):
        number, unit = split_unit(whole)
        assert " ".join(filter(None, (number, unit))) == whole
    assert split_unit("not reached") == ("not reached", "")
    assert split_unit("2 samples") == ("2 samples", "")
    assert split_unit("2 sample") == ("2", "sample")
    assert split_unit("3 x2") == ("3 x2", "")
    assert split_unit("joint 4") == ("joint 4", "")


@pytest.mark.parametrize("digits", [0, 1, 3, 6])
@pytest.mark.parametrize("value", [0.0, -0.0, 1.0, -1.0, 0.25, -0.0004, 0.0006, 120.0, -1200.5, 1e6, 99.9996])
def test_a_number_of_a_file_is_the_nearest_decimal_without_anything_idle(value: float, digits: int) -> None:
    text = format_plain(value, digits)
    assert Decimal(text) == round(Decimal(value), digits)
    assert text != "-0"
    assert "e" not in text
    assert "." not in text or not text.endswith(("0", "."))


@pytest.mark.parametrize(
    ("share", "words"),
    [
        (0.42, "42 %"),
        (1.0, "100 %"),
        (1.0033, "100.3 %"),
        (0.9996, "99.96 %"),
        (0.996, "99.6 %"),
        (0.9949, "99 %"),
        (1.0049, "100.5 %"),
        (1.006, "101 %"),
        (1.0000001, "100.000 %"),
    ],
)
def test_a_share_shows_on_which_side_of_the_limit_it_lies(share, words) -> None:
    assert format_share(share) == words


@pytest.mark.parametrize(
    ("value", "words"),
    [(0.301, "0.301 mm"), (0.3, "0.30 mm"), (-0.2996, "−0.2996 mm"), (0.31, "0.31 mm"), (0.29, "0.29 mm")],
)
def test_a_value_beside_its_limit_lies_on_its_side_of_it(value, words) -> None:
    assert format_beside(value * 1e-3, 0.3e-3, "mm", 2) == words


def test_a_value_is_not_rounded_over_a_limit_of_more_digits() -> None:
    assert format_beside(0.2290e-3, 0.2294e-3, "mm", 2) == "0.229 mm"
    assert format_beside(0.2295e-3, 0.2294e-3, "mm", 2) == "0.23 mm"


@pytest.mark.parametrize(
    ("limit", "words"), [(0.3, "0.30 mm"), (0.2294, "0.2294 mm"), (0.125, "0.125 mm"), (1 / 3, "0.3333 mm")]
)
def test_a_limit_is_shown_as_it_was_given(limit, words) -> None:
    assert format_limit(to_si(limit, "mm"), "mm") == words


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.04, "0.0 s"),
        (12.04, "12.0 s"),
        (119.9, "119.9 s"),
        (120.0, "2.0 min"),
        (252.0, "4.2 min"),
        (630.0, "10 min"),
        (7199.0, "120 min"),
        (3.0 * 3600.0, "3 h 00 min"),
        (3.0 * 3600.0 - 20.0, "3 h 00 min"),
        (12_060.0, "3 h 21 min"),
        (-252.0, "−4.2 min"),
        (-12_060.0, "−3 h 21 min"),
        (float("nan"), "not reached"),
    ],
)
def test_a_time_is_said_in_seconds_minutes_and_hours(seconds, words) -> None:
    assert format_duration(seconds) == words


def test_a_time_is_said_with_its_sign_and_digits_where_they_are_asked_for() -> None:
    assert (format_duration(12.04, sign=True), format_duration(12_060.0, sign=True)) == ("+12.0 s", "+3 h 21 min")
    assert (format_duration(12.6, 0), format_duration(250.0, 0)) == ("13 s", "4 min")


@pytest.mark.parametrize("seconds", [1e9, 1e303, float("inf")])
def test_a_time_that_no_machine_has_is_said_so(seconds: float) -> None:
    assert format_duration(seconds) == "more than three years"


@pytest.mark.parametrize(
    ("count", "words"), [(1, "1 byte"), (999, "999 bytes"), (1200, "1.2 kB"), (7_905_084, "7.9 MB"), (2e9, "2.0 GB")]
)
def test_the_size_of_a_file_is_said_by_its_leading_digits(count, words) -> None:
    assert format_bytes(count) == words
