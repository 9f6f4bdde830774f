"""Numbers as people type them, against the same numbers written down as Python has them."""

from __future__ import annotations

import math
import re

import pytest
from hypothesis import example, given, strategies as st

from robomill.errors import NumberError
from robomill.typed_numbers import read_number, write_number
from robomill.units import UNITS, format_value, from_si, to_si

UNIT = st.sampled_from(sorted(UNITS))
MODEST = st.floats(-1e9, 1e9, allow_nan=False)

READ = [
    ("1220,5", "mm", 1220.5),
    ("-1300,5", "mm", -1300.5),
    ("0,3", "mm", 0.3),
    ("12,5", "mm", 12.5),
    ("1e-6", "mm", 1e-6),
    ("1E+3", "mm", 1000.0),
    ("7,14E−07", "mm", 7.14e-7),
    ("7.14·10^-7", "mm", 7.14e-7),
    ("7,14 × 10⁻⁷", "mm", 7.14e-7),
    ("7.14x10^-7", "mm", 7.14e-7),
    ("7.14*10**-7", "mm", 7.14e-7),
    ("10^-6", "mm", 1e-6),
    ("-10⁻⁶", "mm", -1e-6),
    ("+5", "mm", 5.0),
    ("− 5", "mm", -5.0),
    ("–5", "mm", -5.0),
    ("12.", "mm", 12.0),
    (",5", "mm", 0.5),
    ("-.5", "mm", -0.5),
    ("60.125", "mm", 60.125),
    ("0,125", "mm", 0.125),
    ("1234,500", "mm", 1234.5),
    ("1 220", "mm", 1220.0),
    ("1\u00a0220,5", "mm", 1220.5),
    ("1\u2009220\u2009500.25", "mm", 1220500.25),
    ("1\u202f220,125", "mm", 1220.125),
    ("1'220.5", "mm", 1220.5),
    ("1’220’500", "mm", 1220500.0),
    ("1.220,5", "mm", 1220.5),
    ("1,220.5", "mm", 1220.5),
    ("1.220,500", "mm", 1220.5),
    ("1,220,500", "mm", 1220500.0),
    ("1.220.500", "mm", 1220500.0),
    ("12.345.678,9", "mm", 12345678.9),
    ("1/16 in", "mm", 25.4 / 16),
    ('1/16"', "mm", 25.4 / 16),
    ('1 1/2"', "mm", 38.1),
    ("-1½ in", "mm", -38.1),
    ("⅜", "in", 0.375),
    ("3/4", "1", 0.75),
    ("2 in", "mm", 50.8),
    ("50.8mm", "in", 2.0),
    ("1,5 m", "mm", 1500.0),
    ("250 µm", "mm", 0.25),
    ("250 um", "mm", 0.25),
    ("1 220,5 mm", "mm", 1220.5),
    ("90°", "rad", math.pi / 2),
    ("1.5707963267948966 rad", "deg", 90.0),
    ("2 kN", "N", 2000.0),
    ("2 m/min", "mm/min", 2000.0),
    ("60 in/min", "mm/s", 25.4),
    ("12 000 rev/min", "1/min", 12000.0),
    ("12 000 1/min", "1/min", 12000.0),
    ("200 Hz", "1/min", 12000.0),
    ("0,4 mm/N", "um/N", 400.0),
    ("210 GPa", "N/mm2", 210000.0),
    ("50 %", "1", 0.5),
    ("0.5 ", "%", 0.5),
    ("7.14e-7", "1e-7 rad/(N m)", 7.14),
    ("7,14·10⁻⁷", "1e-7 rad/(N m)", 7.14),
    ("7.14e-7 rad/(N m)", "1e-7 rad/(N m)", 7.14),
    ("7.14 ×10⁻⁷ rad/(N m)", "1e-7 rad/(N m)", 7.14),
    ("0.714 µrad/(N m)", "1e-7 rad/(N m)", 7.14),
    ("7.14", "1e-7 rad/(N m)", 7.14),
    ("1e1", "1e-7 rad/(N m)", 10.0),
    ("0.0005", "1e-7 rad/(N m)", 0.0005),
    ("5e-4", "kN m/rad", 5e-4),
    ("１２", "mm", 12.0),
    ("\ufeff12\u200b", "mm", 12.0),
]


@pytest.mark.parametrize(("text", "unit", "value"), READ)
def test_a_number_is_what_was_typed(text: str, unit: str, value: float) -> None:
    assert read_number(text, unit).value == pytest.approx(value, rel=2e-15)


@pytest.mark.parametrize(
    ("text", "ways"),
    [
        ("1,220", ("1.220", "1220")),
        ("-1,220", ("-1.220", "-1220")),
        ("12,345 mm", ("12.345 mm", "12345 mm")),
        ("999,000", ("999.000", "999000")),
        ("7,140e-7", ("7.140e-7", "7140e-7")),
        ("1,220·10^3", ("1.220·10^3", "1220·10^3")),
    ],
)
def test_what_can_be_read_in_two_ways_is_asked_and_each_way_is_shown(text: str, ways: tuple[str, str]) -> None:
    with pytest.raises(NumberError) as refused:
        read_number(text, "mm")
    assert f"which is {ways[0]} to some and {ways[1]} to others" in str(refused.value)
    first, second = (read_number(way, "mm").value for way in ways)
    assert second == pytest.approx(1000 * first)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "  ",
        "abc",
        "nan",
        "inf",
        "-inf",
        "Infinity",
        "∞",
        "1e400",
        "1.2.3",
        "1,2,3",
        "1,22,333",
        "1.22,5,5",
        "0.123,456",
        "1 22",
        "1 2204",
        "12 00",
        "1 220'500",
        "1.5 220",
        "1_000",
        "0x10",
        "5 1",
        "--5",
        "5-",
        "1e",
        "1e5.5",
        "1/0",
        "1/2/3",
        "1 3/2",
        "1.5/2",
        "1-1/2",
        "30'",
        "7.14e-",
        "9" * 400,
        "9" * 400 + "/3",
        "9" * 400 + " 1/2",
        "1" + "0" * 4400 + "/7",
        ".",
        ",",
        "%",
        "mm",
    ],
)
def test_what_is_no_number_is_refused_and_quoted(text: str) -> None:
    with pytest.raises(NumberError, match=re.escape(f"found {text.strip()!r:.40}, expected ")):
        read_number(text, "mm")


@pytest.mark.parametrize(
    ("text", "unit"),
    [("5 N", "mm"), ("5 foo", "mm"), ("5 mm2", "mm"), ("5 rad", "1"), ("5 deg", "Hz"), ("5 N/mm", "um/N")],
)
def test_a_unit_of_another_kind_is_refused_with_those_that_fit(text: str, unit: str) -> None:
    with pytest.raises(NumberError, match=f"{re.escape(repr(text.split()[1]))} is no such unit"):
        read_number(text, unit)


def test_what_fits_is_named() -> None:
    with pytest.raises(NumberError, match="expected a number in mm, m, cm, µm, in, thou, µin or ft;"):
        read_number("5 N", "mm")
    with pytest.raises(NumberError, match="expected a number in kg;"):
        read_number("5 N", "kg")


def test_how_a_number_was_written_is_told() -> None:
    assert [read_number(text, "mm").plain for text in ("1.5", "-2e-3", "1,5", "2 mm", "1 000")] == [
        True,
        True,
        False,
        False,
        False,
    ]
    texts = ("1.5", "1,5", "2 mm", "2 in", "1/2")
    assert [read_number(text, "mm").converted for text in texts] == [False, False, False, True, True]


@given(value=MODEST, unit=UNIT)
@example(value=1e-13, unit="mm")
@example(value=-0.0, unit="1e-7 rad/(N m)")
def test_python_s_own_spelling_is_read_in_every_unit(value: float, unit: str) -> None:
    """Whole, not as an exponent, which has a meaning of its own in units with a power of ten."""
    text = f"{value:.20f}"
    assert read_number(text, unit).value == float(text)
    assert read_number(text.replace(".", ","), unit).value == float(text)


@given(value=MODEST, unit=UNIT, other=UNIT)
def test_a_number_in_any_unit_of_the_kind_is_converted_and_in_none_other(value: float, unit: str, other: str) -> None:
    text = format_value(value, other, 9)
    shown = float(format_value(value, other, 9, with_unit=False).replace("−", "-").replace("\u202f", ""))
    try:
        found = read_number(text, unit).value
    except NumberError:
        assert unit != other
        return
    if other == "1":  # nothing stands behind it
        assert found == shown
    else:
        assert to_si(found, unit) == pytest.approx(to_si(shown, other), rel=1e-14, abs=1e-300)


@given(value=st.floats(allow_nan=False, allow_infinity=False, min_value=-1e300, max_value=1e300))
@example(60.900000000000006)
@example(-1.65768417e-22)
@example(25.4 / 7)
@example(100000000.25)
def test_what_is_written_is_read_back(value: float) -> None:
    for decimals in (None, 0, 3):
        text = write_number(value, decimals)
        assert read_number(text).value == pytest.approx(
            value, rel=5.1e-3 if decimals is not None else 5.1e-6, abs=1e-12
        )
        assert write_number(read_number(text).value, decimals) == text


@given(units=st.integers(-(10**10) + 1, 10**10 - 1), power=st.integers(-9, 3), unit=UNIT)
def test_a_number_that_was_given_is_written_whole_after_it_went_to_si_and_back(
    units: int, power: int, unit: str
) -> None:
    value = float(f"{units}e{power}")
    text = write_number(from_si(to_si(value, unit), unit))
    assert read_number(text).value == value


def test_numbers_are_written_as_the_app_has_them() -> None:
    assert [write_number(v) for v in (60.900000000000006, -1.65768417e-22, -0.0, 1220.4567, -1300.0, 1e-6)] == [
        "60.9",
        "0",
        "0",
        "1220.4567",
        "-1300",
        "1e-06",
    ]
    assert [write_number(v, 3) for v in (2.0, 0.125, 0.12345, -1e-15, 1 / 3)] == [
        "2.000",
        "0.125",
        "0.12345",
        "0.000",
        "0.333",
    ]
    assert [write_number(v, 4) for v in (1220.5 / 25.4, 0.3 / 25.4, 0.03 / 25.4, 60.4712345678)] == [
        "48.0512",
        "0.0118",
        "0.0011811",
        "60.4712",
    ]
    assert write_number(1e308, 3) == "1e+308"
    assert write_number(math.inf) == "inf"


@pytest.mark.parametrize("decimals", [0, 1, 2, 3, 5])
def test_what_was_computed_keeps_to_its_decimals_where_they_hold_three_digits_of_it(decimals: int) -> None:
    """From 10^(2 - decimals) on; below it six digits are written."""
    digits = 0.123456789012345678  # a number of seventeen digits, which nobody typed
    for power in range(-6, 6):
        value = digits * 10.0**power
        first = math.floor(math.log10(value))
        written = write_number(value, decimals)
        if first >= 2 - decimals:
            assert written == f"{value:.{decimals}f}"
        else:
            assert float(written) == float(f"{value:.5e}")
            assert written.lower().replace("e-0", "e-") == f"{value:.6g}".replace("e-0", "e-")
        assert write_number(-value, decimals) == f"-{written}"
