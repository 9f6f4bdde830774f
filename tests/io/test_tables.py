"""Tables of a file: what is asked for comes back in SI, and a refusal names the place, what was found and expected."""

from __future__ import annotations

import math
import tomllib
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, strategies as st

from robomill.errors import LoadTestError, ProjectError
from robomill.io.tables import Table, exactly, parse_toml, shown, toml_value
from robomill.provenance import Provenance

MM_IN_M, DEG_IN_RAD = 1e-3, math.pi / 180


def table(text: str, where: str = "f.toml") -> Table:
    return Table(tomllib.loads(text), where)


@given(st.floats(-1e6, 1e6))
def test_what_is_written_reads_back_to_the_last_bit(value: float) -> None:
    """A number of metres that no float of millimetres is, is written with more digits than a float has."""
    written = shown(value, "mm")
    assert float(Fraction(written) * Fraction(MM_IN_M)) == value
    again = Table(parse_toml(f"x = {toml_value(written)}", "f.toml", exact=True), "f.toml").number("x", "mm")
    assert again == value
    if exactly(value, "mm") is None:
        near = value / MM_IN_M
        around = (near, math.nextafter(near, math.inf), math.nextafter(near, -math.inf))
        assert all(n * MM_IN_M != value for n in around)


@given(st.floats(-1e3, 1e3), st.sampled_from(["deg", "mm/min", "1/min", "N/mm2", "in", "1e-7 rad/(N m)", "um"]))
def test_so_it_does_in_every_unit(value: float, unit: str) -> None:
    text = f"x = {toml_value(shown(value, unit))}"
    assert Table(parse_toml(text, "f.toml", exact=True), "f.toml").number("x", unit) == value


def test_a_number_of_many_digits_is_a_number_like_another() -> None:
    for text in ("0.10000000000000000555111512312578", "1.00000000000000000000000000001e999999", "1e400"):
        for exact in (True, False):
            read = Table(parse_toml(f"x = {text}", "f.toml", exact=exact), "f.toml")
            if "e" in text:
                with pytest.raises(ProjectError, match="x: expected a"):
                    read.number("x", "mm")
            else:
                assert read.number("x", "mm") == 0.1 * MM_IN_M


@given(st.integers(-999_999, 999_999), st.sampled_from([1, 10, 100, 1000]))
def test_a_typed_number_comes_back_as_it_was_typed(digits: int, scale: int) -> None:
    typed = digits / scale
    assert shown(typed * MM_IN_M, "mm") == typed
    assert repr(shown(typed * DEG_IN_RAD, "deg")) == repr(typed)


def test_as_few_digits_as_possible() -> None:
    assert repr(shown(0.1 + 0.2, "1")) == "0.30000000000000004"
    assert repr(shown(0.3, "1")) == "0.3"
    assert repr(shown(1e-3 / 60, "mm/min")) == "1.0"


@given(st.one_of(st.text(st.characters(exclude_categories=["Cs"])), st.floats(allow_nan=False, allow_infinity=False)))
def test_values_on_one_line_are_toml(value: str | float) -> None:
    written = toml_value([value, value])
    assert "\n" not in written
    assert tomllib.loads(f"x = {written}")["x"] == [value, value]


def test_what_is_not_toml_names_the_line() -> None:
    with pytest.raises(ProjectError, match=r"^mine: this is not a readable TOML file: .*line 2") as caught:
        parse_toml("a = 1\nb 2", "mine")
    assert caught.value.where == "mine"
    with pytest.raises(LoadTestError):
        parse_toml("a", "mine", LoadTestError)


def test_values_come_in_si_and_defaults_as_they_are() -> None:
    numbers = "a_mm = 2\nb = [1, 2.5]\nd = true\ne = 3\nf = [[1, 2], [3, 4]]\ni = [1, -2]\n"
    t = table(numbers + 'c = "text"\ng = ["x", "y"]\nh = "two"')
    assert t.number("a_mm", "mm") == 0.002
    assert t.numbers("b", 2, "mm") == [0.001, 0.0025]
    assert t.text("c") == "text"
    assert t.flag("d", False) is True
    assert t.whole("e") == 3
    np.testing.assert_array_equal(t.rows("f", 2, "kN"), [[1e3, 2e3], [3e3, 4e3]])
    assert t.wholes("i") == [1, -2]
    assert t.words("g") == ["x", "y"]
    assert t.choice("h", ("one", "two")) == "two"
    t.finish()
    nothing = table("")
    assert nothing.number("a", "mm", None) is None
    assert nothing.number("a", "mm", 5.0) == 5.0
    assert nothing.numbers("b", 2, "mm", "none") == "none"
    assert nothing.text("c", "else") == "else"
    assert nothing.flag("d", True) is True
    assert nothing.whole("e", 7) == 7
    assert nothing.wholes("i", (4,)) == (4,)
    assert nothing.words("g") == []
    assert nothing.choice("h", ("one", "two"), "one") == "one"
    assert nothing.tables("i") == []
    assert nothing.table("j", {}).data == {}
    assert not nothing.has("a")
    assert table("a = 1").has("a")


UNITS = {"mm": "mm", "m": "m"}


def test_the_key_may_name_the_unit() -> None:
    assert table("a_mm = 2").measure("a", UNITS) == 0.002
    assert table("a_m = 2").measure("a", UNITS) == 2.0
    assert table("").measure("a", UNITS, 9.0) == 9.0
    assert table("a_m = [1, 2]").measures("a", UNITS, 2, None, "a pair") == [1.0, 2.0]
    assert table("a_mm = [1, 2]").measures("a", UNITS, 2, None, "a pair") == [0.001, 0.002]
    assert table("").measures("a", UNITS, 2, (0.0, 0.0), "a pair") == (0.0, 0.0)
    t = table("a_mm = 2\nb = 1")
    t.measure("a", UNITS)
    with pytest.raises(ProjectError, match="b: this key is not known here; known are: a_m, a_mm"):
        t.finish()


@pytest.mark.parametrize(
    ("text", "ask", "sentence"),
    [
        ("", lambda t: t.number("a", "mm"), "f.toml, a: missing; add it."),
        ("a = true", lambda t: t.number("a", "mm"), "f.toml, a: expected a number in mm, found True."),
        ("a = 'x'", lambda t: t.number("a", "1"), "f.toml, a: expected a number, found 'x'."),
        ("a = nan", lambda t: t.number("a", "mm"), "f.toml, a: expected a finite number in mm, found nan."),
        ("a = inf", lambda t: t.number("a", "1"), "f.toml, a: expected a finite number, found inf."),
        ("a = 5", lambda t: t.text("a"), "f.toml, a: expected text in quotes, found 5."),
        ("a = 5", lambda t: t.words("a"), "f.toml, a: expected a list of texts, found 5."),
        ("a = [5]", lambda t: t.words("a"), "f.toml, a: expected a list of texts, found [5]."),
        ("a = 1", lambda t: t.flag("a", False), "f.toml, a: expected true or false, found 1."),
        ("a = 1.5", lambda t: t.whole("a"), "f.toml, a: expected a whole number, found 1.5."),
        ("a = true", lambda t: t.whole("a"), "f.toml, a: expected a whole number, found True."),
        ("a = [1, 1.5]", lambda t: t.wholes("a"), "f.toml, a: expected a list of whole numbers, found [1, 1.5]."),
        ("a = [true]", lambda t: t.wholes("a"), "f.toml, a: expected a list of whole numbers, found [True]."),
        ("a = 1", lambda t: t.wholes("a", ()), "f.toml, a: expected a list of whole numbers, found 1."),
        ("", lambda t: t.wholes("a"), "f.toml, a: missing; add it."),
        ("a = 'c'", lambda t: t.choice("a", ("x", "y")), "f.toml, a: expected one of x, y, found 'c'."),
        ("a = 1", lambda t: t.numbers("a", 2, "mm"), "f.toml, a: expected a list of 2 numbers, found 1."),
        ("a = [1]", lambda t: t.numbers("a", 2, "mm"), "f.toml, a: expected a list of 2 numbers, found 1: [1]."),
        ("a = [1]", lambda t: t.numbers("a", 2, "mm", expected="a pair"), "f.toml, a: expected a pair, found 1: [1]."),
        ("a = [1, '']", lambda t: t.numbers("a", 2, "mm"), "f.toml, a: expected a number in mm, found ''."),
        ("a = []", lambda t: t.rows("a", 2, "mm"), "f.toml, a: expected a list of rows of 2 numbers, found []."),
        ("a = 1", lambda t: t.rows("a", 2, "mm"), "f.toml, a: expected a list of rows of 2 numbers, found 1."),
        ("a = [[1, 2], [3]]", lambda t: t.rows("a", 2, "m"), "f.toml, a: row 2: expected 2 numbers, found [3]."),
        ("a = [3, 4]", lambda t: t.rows("a", 2, "m"), "f.toml, a: row 1: expected 2 numbers, found 3."),
        (
            "a_mm = 1\na_m = 1",
            lambda t: t.measure("a", UNITS),
            "f.toml, a: it is given twice, as a_mm and a_m; keep one.",
        ),
        ("", lambda t: t.measure("a", UNITS), "f.toml: a is missing; give a_mm or a_m."),
        ("a_cm = 1", lambda t: t.measure("a", UNITS), "f.toml: a is missing; give a_mm or a_m, not a_cm."),
        ("a_m = 1", lambda t: t.measures("a", UNITS, 2, None, "x, y"), "f.toml, a_m: expected x, y, found 1."),
        ("a = 1", lambda t: t.table("a"), "f.toml, [a]: expected a table of keys, found 1."),
        ("a = 1", lambda t: t.tables("a"), "f.toml, a: expected entries written as [[a]], found 1."),
        ("a = [1]", lambda t: t.tables("a"), "f.toml, a 1: expected a table of keys, found 1."),
        (
            "[[a]]\n[[a]]\nb = 1",
            lambda t: t.tables("a")[1].finish(),
            "f.toml, a 2, b: this key is not known here; known are: .",
        ),
        ("[a]\nb = 1", lambda t: t.table("a").text("b"), "f.toml, [a], b: expected text in quotes, found 1."),
        ("[a.b]", lambda t: t.table("a").table("b").text("c"), "f.toml, [a.b], c: missing; add it."),
        (
            "p = { kind = 'hearsay', source = '' }",
            lambda t: t.provenance("p"),
            "f.toml, [p], kind: expected one of paper, measured, assumed, user, computed, synthetic, found 'hearsay'.",
        ),
        (
            "p = { kind = 'paper', source = '', year = 1 }",
            lambda t: t.provenance("p"),
            "f.toml, [p], year: this key is not known here; known are: carried_from, kind, source.",
        ),
    ],
)
def test_refusals(text, ask, sentence: str) -> None:
    with pytest.raises(ProjectError) as caught:
        ask(table(text))
    assert str(caught.value) == sentence
    assert caught.value.where is not None or "missing; give" in sentence


def test_the_refusal_is_of_the_kind_asked_for_in_tables_inside_too() -> None:
    t = Table({"a": {}, "b": [{}]}, "x", LoadTestError)
    for inner in (t.table("a"), t.tables("b")[0]):
        with pytest.raises(LoadTestError):
            inner.text("c")


def test_provenance() -> None:
    found = table("p = { kind = 'paper', source = 'Table 2' }").provenance("p")
    assert found == Provenance("paper", "Table 2")


@pytest.mark.parametrize(("deep", "stands"), [(12, True), (13, False)])
@pytest.mark.parametrize("ends", ["[]", "{}"])
def test_tables_and_lists_stand_at_most_twelve_deep(deep: int, stands: bool, ends: str) -> None:
    inner = ends
    for _ in range(deep - 2):
        inner = f"[{inner}]"
    if stands:
        assert list(parse_toml(f"a = {inner}", "f.toml")) == ["a"]
    else:
        with pytest.raises(ProjectError, match=r"^f.toml, a: tables and lists stand more than 12 deep\.$"):
            parse_toml(f"a = [{inner}]", "f.toml")


@pytest.mark.parametrize("whole", [2**63 - 1, -(2**63)])
def test_the_largest_whole_numbers_of_the_format_are_read(whole: int) -> None:
    assert parse_toml(f"a = {whole}", "f.toml") == {"a": whole}
    assert table(f"a = {2**63 - 1}").number("a", "1") == 2.0**63


@pytest.mark.parametrize("whole", [2**63, -(2**63) - 1])
@pytest.mark.parametrize(("text", "key"), [("b = {}", "b"), ("b = [1, {}]", "b"), ("[t]\nc = [[{}]]", "c")])
def test_a_larger_whole_number_is_refused_at_its_key(whole: int, text: str, key: str) -> None:
    with pytest.raises(ProjectError, match=f"^f.toml, {key}: a whole number is too large; expected fewer digits") as no:
        parse_toml(text.format(whole), "f.toml")
    assert no.value.where == "f.toml"


@pytest.mark.parametrize("text", [".".join("a" * 65) + " = 1", "a = " + "9" * 5000])
def test_what_takes_too_long_to_read_is_refused_unread(text: str) -> None:
    with pytest.raises(
        ProjectError, match=r"^f.toml: this is not a readable TOML file: a number is too long, or lists"
    ):
        parse_toml(text, "f.toml")


def test_a_number_that_is_none_in_si_is_refused() -> None:
    assert table("a = 1.7e305").number("a", "kN") == pytest.approx(1.7e308)
    with pytest.raises(ProjectError, match=r"^f.toml, a: expected a number in kN of ordinary size, found 1.7e\+306\.$"):
        table("a = 1.7e306").number("a", "kN")


@pytest.mark.parametrize("path", [r"C:\Users\x\p.nc", r"C:\data\p.nc"])
def test_a_path_of_windows_in_double_quotes_is_told_how_to_write_it(path: str) -> None:
    with pytest.raises(ProjectError, match=r"single quotes, as 'C:\\Users\\\.\.\.'\.$"):
        parse_toml(f'program = "{path}"', "mine")
