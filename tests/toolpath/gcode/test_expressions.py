"""Expressions against Python's own arithmetic: every operator, its precedence, and trees drawn at random."""

from __future__ import annotations

import math
import operator
import random

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret
from robomill.toolpath.gcode.expressions import Reader
from robomill.toolpath.gcode.parameters import Parameters
from robomill.toolpath.gcode.rules.value_rules import MAX_DEPTH

ARITHMETIC = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv, "**": operator.pow}
LOGIC = {
    "and": lambda a, b: bool(a) and bool(b),
    "or": lambda a, b: bool(a) or bool(b),
    "xor": lambda a, b: bool(a) ^ bool(b),
    "eq": operator.eq,
    "ne": operator.ne,
    "ge": operator.ge,
    "le": operator.le,
    "gt": operator.gt,
    "lt": operator.lt,
}
LEVELS = [("and", "or", "xor"), ("eq", "ne", "ge", "le", "gt", "lt"), ("+", "-"), ("*", "/"), ("**",)]


def value(text):
    reader = Reader(text, 1, Parameters())
    found = reader.value()
    assert reader.at == len(text)
    return found


@pytest.mark.parametrize("name", LOGIC)
def test_truth_tables(name):
    for a in (-2.0, 0.0, 1.0, 3.5):
        for b in (-2.0, 0.0, 1.0, 3.5):
            assert value(f"[{a}{name}{b}]") == float(LOGIC[name](a, b)), (a, b)


@pytest.mark.parametrize(("apart", "equal"), [(0.99e-4, 1.0), (1.01e-4, 0.0)])
def test_numbers_are_equal_within_a_ten_thousandth(apart, equal):
    for sign in (1, -1):
        assert value(f"[1eq{1 + sign * apart:.7f}]") == equal
        assert value(f"[1ne{1 + sign * apart:.7f}]") == 1.0 - equal


@pytest.mark.parametrize(("a", "b"), [(7, 3), (-7, 3), (7, -3), (-7, -3), (7.5, 2), (-7.5, 2.5), (0, 4)])
def test_a_remainder_is_never_negative(a, b):
    rest = value(f"[{a}mod{b}]")
    assert 0 <= rest < abs(b)
    assert math.isclose((a - rest) / b, round((a - rest) / b), abs_tol=1e-12)


def tree(r, depth):
    """(text, value) of an expression in brackets; its operators bind as they stand, equals from the left."""
    if depth == 0:
        number = r.choice([0.5, 1.0, 2.0, 3.0])
        return f"{number:g}", number
    terms = [tree(r, depth - 1) for _ in range(r.randint(2, 5))]
    operators = [r.choice([*ARITHMETIC, *LOGIC]) for _ in terms[1:]]
    text = "[" + terms[0][0] + "".join(o + t for o, (t, _) in zip(operators, terms[1:], strict=True)) + "]"
    values = [v for _, v in terms]
    for level in reversed(LEVELS):
        i = 0
        while i < len(operators):
            if operators[i] in level:
                law = ARITHMETIC.get(operators[i]) or LOGIC[operators[i]]
                if operators[i] == "**" and (abs(values[i]) > 50 or abs(values[i + 1]) > 8 or values[i] <= 0):
                    raise ZeroDivisionError
                values[i : i + 2] = [float(law(values[i], values[i + 1]))]
                del operators[i]
            else:
                i += 1
    return text, values[0]


def test_trees_drawn_at_random():
    r, tried = random.Random(0), 0
    while tried < 500:
        try:
            text, expected = tree(r, r.choice([1, 1, 2]))
        except (ZeroDivisionError, OverflowError):
            continue
        if abs(expected) > 1e12:
            continue
        assert value(text) == pytest.approx(expected, rel=1e-12, abs=1e-12), text
        tried += 1


def test_functions_are_pythons_in_degrees():
    for x in (-0.9, -0.25, 0.0, 0.5, 1.0):
        assert value(f"asin[{x}]") == pytest.approx(math.degrees(math.asin(x)))
        assert value(f"acos[{x}]") == pytest.approx(math.degrees(math.acos(x)))
        assert value(f"sin[{100 * x}]") == pytest.approx(math.sin(math.radians(100 * x)))
        assert value(f"cos[{100 * x}]") == pytest.approx(math.cos(math.radians(100 * x)))
        assert value(f"tan[{80 * x}]") == pytest.approx(math.tan(math.radians(80 * x)))
        assert value(f"exp[{x}]") == pytest.approx(math.exp(x))
        assert value(f"abs[{x}]") == abs(x)
        assert value(f"atan[{x}]/[-2]") == pytest.approx(math.degrees(math.atan2(x, -2)))
    assert value("ln[exp[2]]") == pytest.approx(2.0)
    assert value("sqrt[2]") == math.sqrt(2)
    for x, down, up, nearest in ((2.4, 2, 3, 2), (2.5, 2, 3, 3), (-2.4, -3, -2, -2), (-2.5, -3, -2, -3), (4, 4, 4, 4)):
        assert (value(f"fix[{x}]"), value(f"fup[{x}]"), value(f"round[{x}]")) == (down, up, nearest)


def test_signs_before_numbers_brackets_and_functions():
    assert value("-[2+3]") == -5
    assert value("--[2]") == 2
    assert value("+[2]") == 2
    assert value("-abs[-4]") == -4
    assert value("[2--3]") == 5


def test_depth_is_what_is_open_at_once_and_not_what_was_opened():
    many = 3 * MAX_DEPTH
    assert value("[" + "+".join(["[1]"] * many) + "]") == many
    assert value("[" * MAX_DEPTH + "1" + "]" * MAX_DEPTH) == 1
    with pytest.raises(GCodeError, match=f"more than {MAX_DEPTH} deep"):
        value("[" * (MAX_DEPTH + 1) + "1" + "]" * (MAX_DEPTH + 1))


@pytest.mark.parametrize(("names", "there"), [({"a"}, "a"), ({"a", "longername"}, "longername"), (set(), None)])
def test_a_name_exists_where_it_was_set(names, there):
    store = Parameters()
    for name in names:
        store.set(name, -7.0)
    for name in ("a", "longername", "b"):
        assert Reader(f"exists[#<{name}>]", 1, store).value() == float(
            name in {each.replace(" ", "") for each in names}
        )
    assert Reader(f"[2*exists[#<{there}>]-1]", 1, store).value() == (1.0 if there else -1.0)
    with pytest.raises(GCodeError, match="Line 1: "):
        Reader("exists[#<a", 1, store).value()


@pytest.mark.parametrize("b", [-3.0, -2.0, -0.5, 0.0, 0.5, 1.0, 2.5, 4.0])
@pytest.mark.parametrize("a", [-2.0, -1.0, 0.0, 0.25, 1.0, 3.0])
def test_a_power_is_pythons_where_it_is_a_number(a, b):
    try:
        expected = a**b
    except ZeroDivisionError:
        expected = None
    if expected is None or isinstance(expected, complex):
        with pytest.raises(GCodeError, match="Line 1: "):
            value(f"[[{a}]**[{b}]]")
    else:
        assert value(f"[[{a}]**[{b}]]") == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize("text", ["[1/0]", "[1mod0]", "[-2**0.5]", "sqrt[-1]", "ln[0]", "acos[1.1]", "[10**999]"])
def test_what_has_no_value_is_refused(text):
    with pytest.raises(GCodeError, match="Line 1: "):
        value(text)


@pytest.mark.parametrize(("text", "found"), [("5.00009", 5), ("4.99991", 5), ("-2.00009", -2), ("[1/3*3]", 1)])
def test_a_whole_number_is_one_within_a_ten_thousandth(text, found):
    assert Reader(text, 1, Parameters()).integer("N") == found
    with pytest.raises(GCodeError, match="expected a whole number"):
        Reader("5.0002", 1, Parameters()).integer("N")


SHORT = ["[2*", "[2* ", "[2**", "[2+", "[2-", "[2/", "[2 MOD", "[", "[2", "-", "#", "SIN", "ATAN[1]/", "#<a"]


@pytest.mark.parametrize("text", SHORT)
def test_a_value_that_the_end_of_its_line_cuts_short_is_refused_at_its_line(text):
    """At the end of the file too, where nothing follows that could be looked at."""
    for behind in ("\nM2\n", ""):
        with pytest.raises(GCodeError) as refused:
            interpret(f"G21 G90 F100\nG1 X{text}{behind}")
        assert refused.value.line == 2
