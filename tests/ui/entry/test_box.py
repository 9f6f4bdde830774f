"""Boxes as fields declare them, and what a number typed into one means."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from robomill.arrays import FloatArray
from robomill.errors import ProjectError
from robomill.quantities import quantity, whole
from robomill.ui.entry.box import NumberBox, box_of, declaration, declared


@dataclass(frozen=True)
class Slot:
    width: float = quantity("Width", "mm", default=2e-3, digits=2, hint="Across.")
    ends: FloatArray = quantity("End", "mm", shape=(3,), axes="XYZ", default=None)
    passes: int = whole("Passes", default=2)
    radius: float | None = quantity("Radius", "mm", optional=True)
    note: str = ""


@dataclass(frozen=True)
class Part:
    slot: Slot


PART = Part(Slot(ends=np.array([0.01, 0.02, 0.03])))


def test_a_number_is_shown_as_its_field_declares_it() -> None:
    box = declared(PART, "slot.width")
    assert (box.title, box.written(2e-3), box.hint, box.optional) == ("Width, mm", "2.00", "Across.", False)
    assert declared(PART.slot, "radius").optional


def test_another_unit_takes_the_digits_along_and_what_is_given_replaces_the_declaration() -> None:
    box = declared(PART, "slot.width", unit="in", label="Breadth")
    assert box.title == "Breadth, in"
    assert box.written(25.4e-3) == "1.0000"
    assert box.typed(1.0) == pytest.approx(0.0254)


def test_an_index_names_one_entry_with_its_axis() -> None:
    said = declaration(PART, "slot.ends[1]")
    assert said is not None
    assert (said.kind, said.label, said.axes) == ("number", "End Y", ())


def test_what_is_not_declared_has_no_declaration_and_stands_on_its_own_words() -> None:
    assert declaration(PART, "slot.note") is None
    assert box_of(None, label="Free", digits=1).written(2.0) == "2.0"


def test_a_whole_number_has_no_decimals() -> None:
    box = declared(PART, "slot.passes")
    assert box.whole
    assert box.written(3.0) == "3"
    assert isinstance(box.typed(3.0), int)


def test_an_empty_box_is_none_only_where_it_may_be() -> None:
    assert NumberBox("Radius", optional=True).typed(None) is None
    with pytest.raises(ProjectError, match="empty"):
        NumberBox("Radius").typed(None)


def test_what_may_be_left_out_is_a_line_of_text_that_comes_back_as_it_was() -> None:
    box = NumberBox("Depth", "mm", optional=True, digits=2)
    assert [box.written(value) for value in (None, 4e-4, 0.123456e-3, -3e-3)] == ["", "0.40", "0.123456", "-3.00"]
    for value in (None, 4e-4, 0.123456e-3, -3e-3, 1e-13, 1220.4567e-3):
        assert box.read(box.written(value)) == (None if value is None else pytest.approx(value, rel=1e-11))
    assert box.read(" 0,4 ") == box.read("0.4") == box.read("4e-1") == pytest.approx(4e-4)
    assert box.read("−2") == pytest.approx(-2e-3)
    assert box.read("  ") is None


@pytest.mark.parametrize("text", ["abc", "nan", "inf", "1e400", "1.2.3", "1 00", "5 N"])
def test_a_line_that_is_no_number_is_refused_with_its_box(text: str) -> None:
    with pytest.raises(ProjectError, match=f"Depth: found {text!r}, expected a number"):
        NumberBox("Depth", "mm", optional=True).read(text)


def test_a_whole_number_that_may_be_left_out_is_whole() -> None:
    box = NumberBox("Flutes", whole=True, optional=True)
    assert (box.written(3), box.read("3"), box.read("")) == ("3", 3, None)
    with pytest.raises(ProjectError, match=r"found '3.5', expected a whole number"):
        box.read("3.5")
    with pytest.raises(ProjectError, match="3.000 to some and 3000 to others"):
        box.read("3,000")


@pytest.mark.parametrize(
    ("low", "high", "expected"), [(1.0, None, "1 or more"), (None, 5.0, "5 or less"), (1.0, 5.0, "1 to 5")]
)
def test_bounds_are_said_in_the_unit_that_is_shown(low: float | None, high: float | None, expected: str) -> None:
    box = NumberBox("Depth", "mm", low=low, high=high)
    outside = 0.5 if low is not None else 5.5
    with pytest.raises(ProjectError, match=f"Depth: found {outside:g}, expected {expected} mm"):
        box.typed(outside)
    assert box.typed(1.0 if low is not None else 5.0) == pytest.approx(1e-3 if low is not None else 5e-3)


@pytest.mark.parametrize(
    ("text", "box", "cell"),
    [
        ("12.5", "", ""),
        ("1e-6", "", ""),
        ("12,5", "", "12,5 is 12.5 mm"),
        ("1 220", "", "1 220 is 1220 mm"),
        ("1/16 in", "1/16 in is 1.5875 mm", "1/16 in is 1.5875 mm"),
        ("2 in", "2 in is 50.8 mm", "2 in is 50.8 mm"),
        ("3 mm", "", "3 mm is 3 mm"),
        ("", "", ""),
    ],
)
def test_what_was_typed_otherwise_than_it_is_shown_is_said(text: str, box: str, cell: str) -> None:
    depth = NumberBox("Depth", "mm", optional=True)
    assert (depth.understood(text), depth.understood(text, cell=True)) == (box, cell)


def test_a_value_is_named_with_its_unit() -> None:
    box = NumberBox("Depth", "mm")
    assert [box.named(value) for value in (2e-3, None)] == ["2.000 mm", "empty"]
    assert box.named(2e-3, cell=True) == "2 mm"


def test_a_cell_shows_the_digits_that_it_was_given_and_six_of_what_was_computed() -> None:
    inches = NumberBox("Depth", "in", optional=True)
    assert [inches.written(value, cell=True) for value in (None, 25.4e-3, 1220.5e-3, -0.0, 1.5e-3)] == [
        "",
        "1",
        "48.0512",
        "0",
        "0.0590551",
    ]
