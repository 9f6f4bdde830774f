"""Declared numbers: what is settled, what is refused in which words, and digits in other units."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

from robomill.arrays import FloatArray
from robomill.errors import CuttingError
from robomill.quantities import (
    Quantity,
    again,
    choice,
    declared_types,
    described,
    file_suffix,
    quantities,
    quantity,
    settle,
    switch,
    whole,
)
from robomill.units import to_si


@dataclass(frozen=True, eq=False)
class Sample:
    source: CuttingError
    width: float = quantity("Width", "mm", above=0.0, most=to_si(5.0, "mm"), digits=2, hint="Across.")
    turn: float = quantity("Turn", "deg", default=0.0, least=-math.pi, below=math.pi)
    reach: float | None = quantity("Reach", "mm", optional=True, above=0.0)
    ratio: float = quantity("Ratio", default=0.5, least=0.0, most=1.0, key="share")
    left: float = quantity("Left", "N", default=-1.0, below=0.0)
    right: float = quantity("Right", "N", default=-1.0, most=0.0)
    free: float = quantity("Free", "N", default=0.0)
    push: FloatArray = quantity("Push", "N", default=(0.0, 0.0, 1.0), shape=(3,), axes="XYZ", least=-10.0)
    teeth: int = whole("Teeth", default=2, least=1)
    any_whole: int = whole("Any", default=0)
    on: bool = switch("On", default=False)
    hand: str = choice("Hand", {"l": "left", "r": "right"}, default="r")

    def __post_init__(self) -> None:
        settle(self, CuttingError, "Sample")


def made(**fields: object) -> Sample:
    return Sample(CuttingError("x"), **{"width": 1e-3, **fields})


def test_fields_come_out_as_their_class_keeps_them() -> None:
    value = made(width=np.float32(0.002), teeth=3.0, push=[1, 2, 3], on=np.True_)
    assert (type(value.width), type(value.teeth), type(value.on)) == (float, int, bool)
    assert value.push.dtype == np.float64
    assert not value.push.flags.writeable
    assert value.reach is None
    assert made(reach=2).reach == 2.0
    assert (value.turn, value.hand, value.on, value.teeth) == (0.0, "r", True, 3)


@pytest.mark.parametrize(
    ("field", "good"),
    [
        ("width", to_si(5.0, "mm")),
        ("width", to_si(1e-12, "mm")),
        ("turn", -math.pi),
        ("turn", math.nextafter(math.pi, 0)),
        ("ratio", 0.0),
        ("ratio", 1.0),
        ("left", -1e-300),
        ("right", 0.0),
        ("push", [-10.0, 0.0, 1e9]),
        ("teeth", 1),
        ("any_whole", -5),
    ],
)
def test_bounds_hold_what_they_include(field: str, good: object) -> None:
    np.testing.assert_array_equal(getattr(made(**{field: good}), field), good)


@pytest.mark.parametrize(
    ("field", "bad", "sentence"),
    [
        ("width", 0.0, "Sample, Width: found 0 mm; expected more than 0 mm to 5 mm."),
        ("width", 6e-3, "Sample, Width: found 6 mm; expected more than 0 mm to 5 mm."),
        ("width", None, "Sample, Width: found nothing; expected more than 0 mm to 5 mm."),
        ("width", math.nan, "Sample, Width: found nan; expected more than 0 mm to 5 mm."),
        ("turn", math.pi, "Sample, Turn: found 180°; expected −180° to less than 180°."),
        ("turn", -3.2, "Sample, Turn: found −183.346°; expected −180° to less than 180°."),
        ("reach", -1e-3, "Sample, Reach: found −1 mm; expected more than 0 mm, or left out."),
        ("ratio", 1.5, "Sample, Ratio: found 1.5; expected 0 to 1."),
        ("ratio", -0.1, "Sample, Ratio: found −0.1; expected 0 to 1."),
        ("ratio", 1e12, "Sample, Ratio: found 1e+12; expected 0 to 1."),
        ("ratio", 1.1e12, "Sample, Ratio: found 1.1e+12; expected 0 to 1, and no larger than 1e+12."),
        ("left", 0.0, "Sample, Left: found 0 N; expected less than 0 N."),
        ("right", 1e-3, "Sample, Right: found 0.001 N; expected at most 0 N."),
        ("free", "much", "Sample, Free: found 'much'; expected a finite number."),
        ("free", math.inf, "Sample, Free: found inf; expected a finite number."),
        ("free", -1e308, "Sample, Free: found −1e+308 N; expected a finite number, and no larger than 1e+12 N."),
        (
            "width",
            1e-300,
            "Sample, Width: found 1e−297 mm; expected more than 0 mm to 5 mm, and no smaller than 1e−12 mm.",
        ),
        ("push", [1.0, -11.0, -12.0], "Sample, Push: found −11 N; expected −10 N or more."),
        ("push", [1.0, 2.0], "Sample, Push (N): expected shape (..., 3), found (2,)."),
        ("push", [[1.0, 2.0, 3.0]], "Sample, Push (N): expected shape (3), found (1, 3)."),
        ("push", [1.0, 2.0, math.nan], "Sample, Push (N): expected finite numbers, found NaN or infinity."),
        ("teeth", 0, "Sample, Teeth: found 0; expected 1 or more."),
        ("teeth", 2.5, "Sample, Teeth: found 2.5; expected a whole number, 1 or more."),
        ("teeth", True, "Sample, Teeth: found True; expected a whole number, 1 or more."),
        ("teeth", "2", "Sample, Teeth: found '2'; expected a whole number, 1 or more."),
        ("teeth", 10**400, "Sample, Teeth: found 1000"),
        ("any_whole", None, "Sample, Any: found nothing; expected a whole number."),
        ("on", 1, "Sample, On: found 1; expected true or false."),
        ("hand", "x", "Sample, Hand: found 'x'; expected l or r."),
        ("hand", ["l"], "Sample, Hand: found ['l']; expected l or r."),
    ],
)
def test_refusals_say_who_what_and_what_was_expected(field: str, bad: object, sentence: str) -> None:
    with pytest.raises(CuttingError) as refused:
        made(**{field: bad})
    assert str(refused.value).startswith(sentence)
    assert refused.value.where in (field, None)


def test_a_refusal_without_a_class_starts_with_the_label() -> None:
    with pytest.raises(CuttingError, match=r"^Width: found 0 mm"):
        quantities(Sample)["width"].settled(0.0, CuttingError)


def test_a_class_is_asked_for_its_numbers() -> None:
    found = quantities(Sample)
    names = "width turn reach ratio left right free push teeth any_whole on hand"
    assert list(found) == names.split()
    assert [q.key for q in found.values()][:5] == ["width_mm", "turn_deg", "reach_mm", "share", "left_N"]
    assert (found["width"].needed, found["width"].default) == (True, None)
    assert (found["ratio"].needed, found["ratio"].default) == (False, 0.5)
    assert (found["reach"].needed, found["reach"].default) == (False, None)
    assert found["push"].axes == "XYZ"
    assert found["teeth"].kind == "whole"
    assert found["teeth"].digits == 0
    assert found["hand"].options == {"l": "left", "r": "right"}
    assert found["width"].hint == "Across."
    assert found["width"].boxed
    assert declared_types(Sample) == {"source": CuttingError}


def test_a_value_says_its_numbers_in_words() -> None:
    said = described(made(turn=math.pi / 2, push=[1.0, -2.5, 3.0], on=True))
    assert said == (
        "Width 1 mm, Turn 90°, Ratio 0.5, Left −1 N, Right −1 N, Free 0 N, Push (1, −2.5, 3) N, Teeth 2, Any 0, On on, "
        "Hand right"
    )
    assert "Reach 2 mm" in described(made(reach=2e-3))
    assert "On off" in described(made())
    shapes = choice("Shape", {"a": "A", "b": "B", "c": "C"}).metadata["quantity"]
    assert shapes.expected == "a, b or c"


def test_keys_in_files() -> None:
    units = ("1", "mm", "N/mm2", "1/min", "um/N", "kN m")
    assert [file_suffix(u) for u in units] == ["", "_mm", "_N_mm2", "_1_min", "_um_N", "_kN_m"]


def test_a_box_in_inches_shows_about_the_same() -> None:
    width, free = quantities(Sample)["width"], quantities(Sample)["free"]
    assert [width.digits_in(unit) for unit in ("mm", "in", "um", "m")] == [2, 4, 0, 5]
    assert [free.digits_in(unit) for unit in ("N", "kN")] == [1, 4]


def test_what_no_number_may_exceed_is_itself_allowed():
    """A million million of its unit, and no less than the million-millionth part where it has to be above zero."""
    for value, good in ((1e12, True), (-1e12, True), (1.0001e12, False), (-1.0001e12, False), (math.nan, False)):
        assert bool(quantities(Sample)["free"].allows(value)) == good
    for value, good in ((1e-12, True), (0.9999e-12, False), (0.0, False), (-1e-12, False)):
        assert bool(quantities(Sample)["width"].allows(to_si(value, "mm"))) == good
    for value, good in ((0.9999e12, True), (1.0001e12, False)):
        assert bool(quantities(Sample)["reach"].allows(to_si(value, "mm"))) == good


def test_a_bound_that_is_not_nothing_is_left_out_where_it_says_so() -> None:
    @dataclass
    class Between:
        size: float = quantity("Size", "mm", default=3e-3, above=to_si(2.0, "mm"), below=to_si(4.0, "mm"))

    size = quantities(Between)["size"]
    for value, good in ((1.9, False), (2.0, False), (2.001, True), (3.999, True), (4.0, False), (5.0, False)):
        assert bool(size.allows(to_si(value, "mm"))) == good


def test_a_joint_that_slides_has_the_unit_of_lengths_where_one_is_declared() -> None:
    @dataclass
    class Joint:
        limit: float = quantity("Limit", "deg", sliding="mm", default=0.0)
        sense: float = quantity("Sense", default=1.0)

    limit, sense = quantities(Joint)["limit"], quantities(Joint)["sense"]
    assert [limit.of_joint(slides).unit for slides in (False, True)] == ["deg", "mm"]
    assert {sense.of_joint(slides).unit for slides in (False, True)} == {sense.unit}


def test_a_quantity_declared_elsewhere_is_one_number_of_a_field_with_what_is_its_own() -> None:
    speeds = Quantity("Speed", "1/min", "array", name="n", key="speed_1_min", least=0.0, slip=1000.0)

    @dataclass(frozen=True)
    class Mill:
        n_s: float = again(speeds, label="Spindle", default=2.0)

        def __post_init__(self) -> None:
            settle(self, CuttingError, "Mill")

    found = quantities(Mill)["n_s"]
    assert (found.kind, found.label, found.name, found.key) == ("number", "Spindle", "n_s", "speed_1_min")
    assert (found.unit, found.least, found.slip) == ("1/min", 0.0, 1000.0)
    assert Mill().n_s == found.default == 2.0
    with pytest.raises(CuttingError, match="Mill, Spindle: found"):
        Mill(-1.0)
