"""Shape checks at the door, read-only arrays, and the canonical fingerprint."""

from __future__ import annotations

from dataclasses import dataclass, field
from hashlib import sha256
from typing import Any

import numpy as np
import pandas as pd
import pytest

import robomill as rm
from robomill.arrays import as_floats, brief, check_place, digest, frozen, next_true, sealed, stretches, with_article
from robomill.errors import RobomillError, RobotError


def test_as_floats_says_what_was_found() -> None:
    with pytest.raises(RobotError, match=r"limits: expected shape \(\.\.\., any, 2\), found \(3,\)"):
        as_floats([1, 2, 3], "limits", (None, 2), error=RobotError)
    with pytest.raises(RobotError, match="NaN or infinity"):
        as_floats([[1, np.nan]], "limits", (None, 2), error=RobotError)
    with pytest.raises(RobotError, match="expected numbers"):
        as_floats("abc", "limits", (None, 2), error=RobotError)


def test_what_has_no_short_words_of_its_own_is_named_by_its_kind() -> None:
    with pytest.raises(RobotError, match="^theta: expected numbers, found a generator, which is read once only"):
        as_floats((0.0 for _ in range(3)), "theta", (3,), error=RobotError)
    with pytest.raises(RobotError, match=r"^theta: expected numbers, found None\.$"):
        as_floats(None, "theta", (3,), error=RobotError)
    assert brief(pd.DataFrame({"a": [1, 2]})) == "a DataFrame"
    assert brief(object()) == "an object"
    assert brief([1, 2]) == "[1, 2]"


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


def test_as_floats_lets_leading_axes_free_and_any_length_where_none_is_asked() -> None:
    assert as_floats([[1, 2], [3, 4]], "x", (2,)).shape == (2, 2)
    assert as_floats(np.zeros((5, 4, 7, 2)), "x", (None, 2)).shape == (5, 4, 7, 2)
    assert as_floats([1, 2, 3], "x", (None,)).dtype == np.float64
    assert as_floats(3, "x", ()).shape == ()
    assert np.isnan(as_floats([np.nan], "x", (1,), finite=False)).all()
    for wrong in (3.0, [1.0, 2.0], np.zeros((2, 4))):
        with pytest.raises(RobomillError, match=r"^x: expected shape \(\.\.\., 3\), found "):
            as_floats(wrong, "x", (3,))
    with pytest.raises(RobomillError, match=r"x: expected finite numbers"):
        as_floats([np.inf], "x", (1,))


def test_frozen_copies_once_and_keeps_what_is_frozen_already() -> None:
    source = np.arange(6.0).reshape(2, 3)
    kept = frozen(source)
    source[0, 0] = 9.0
    assert kept[0, 0] == 0.0
    assert frozen(kept) is kept
    assert frozen(kept, np.int64).dtype == np.int64
    assert frozen(kept.T) is not kept
    for copied in (frozen(kept.T), frozen(kept[:1]), frozen(np.asfortranarray(source))):
        assert copied.flags.c_contiguous
        assert not copied.flags.writeable
        with pytest.raises(ValueError, match="WRITEABLE"):
            copied.setflags(write=True)
        assert np.asarray(copied.base).size == copied.size  # nothing larger is kept for its sake
    # A view of somebody's array could still change under it.
    view = source[:]
    view.flags.writeable = False
    held = frozen(view)
    source[1, 1] = 77.0
    assert held[1, 1] != 77.0
    lent = np.asfortranarray(np.eye(3) + np.arange(3))
    lent.flags.writeable = False
    assert frozen(lent).flags.c_contiguous


@dataclass(frozen=True)
class One:
    a: Any
    b: Any = field(default=0, compare=False)


@dataclass(frozen=True)
class Other:
    a: Any


DIFFERENT = [
    None,
    True,
    False,
    0,
    1,
    2,
    0.0,
    1.0,
    -1.0,
    "",
    "a",
    "b",
    b"",
    b"a",
    "1",
    [],
    [0],
    [0, 0],
    [[0], 0],
    [0, [0]],
    {},
    {0: 1},
    {1: 0},
    {"a": 1},
    {"a": {}},
    One(1),
    One(2),
    Other(1),
    [One(1)],
    np.zeros(2),
    np.zeros(3),
    np.zeros((1, 2)),
    np.zeros(2, np.int64),
    np.zeros(2, np.float32),
    np.array([0.0, 1.0]),
]


def test_different_values_have_different_digests() -> None:
    assert len({digest(value) for value in DIFFERENT}) == len(DIFFERENT)
    assert all(len(digest(value)) == 64 for value in DIFFERENT)


def test_equal_values_have_equal_digests_however_they_are_held() -> None:
    assert digest(One(1, b=5)) == digest(One(1, b=6)), "what does not count for equality does not count here"
    assert digest((1, "a")) == digest([1, "a"])
    assert digest(np.float64(0.1)) == digest(0.1)
    assert digest(np.int32(7)) == digest(7)
    assert digest(np.bool_(True)) == digest(True)
    grid = np.arange(6.0).reshape(2, 3)
    assert digest(np.asfortranarray(grid)) == digest(grid)
    assert digest(grid.astype(">f8")) == digest(grid)


@pytest.mark.parametrize("places", range(5))
def test_one_length_in_two_units_has_one_digest(places: int) -> None:
    lengths_mm = np.round(np.random.default_rng(places).uniform(-3000, 3000, 1000), places)
    apart, together = lengths_mm * 1e-3, lengths_mm / 1000
    assert places or (apart != together).any(), "their last bits differ"
    assert digest(apart) == digest(together)
    assert [digest(x) for x in apart.tolist()] == [digest(x) for x in together.tolist()]


@pytest.mark.parametrize("base", [0.7, -123.456, 1e-9, 0.1 + 0.2, 9.999999999999, 1e300])
def test_twelve_digits_tell_numbers_apart(base: float) -> None:
    near, other = np.nextafter(base, np.inf), base * (1 + 2e-12)
    assert digest(near) == digest(base)
    assert digest(np.array([near])) == digest(np.array([base]))
    assert digest(other) != digest(base)
    assert digest(np.array([other])) != digest(np.array([base]))


@pytest.mark.parametrize("power", range(-300, 301, 20))
def test_a_power_of_ten_is_told_alike_from_both_sides(power: int) -> None:
    one = float(f"1e{power}")
    around = [one, float(np.nextafter(one, 0)), float(np.nextafter(one, np.inf))]
    assert len({digest(value) for value in around}) == 1
    assert len({digest(np.array([value])) for value in around}) == (1 if power > -290 else 3)


def test_zero_has_no_sign_and_what_is_not_finite_is_told_apart() -> None:
    assert digest(np.array([-0.0])) == digest(np.array([0.0]))
    assert digest(-0.0) == digest(0.0)
    ends = [0.0, 5e-324, -5e-324, np.nan, np.inf, -np.inf, 1.7e308, -1.7e308]
    assert len({digest(np.array([end])) for end in ends}) == len(ends)


def test_what_has_no_canonical_bytes_is_a_bug() -> None:
    with pytest.raises(TypeError, match="no canonical bytes for set"):
        digest({1, 2})
    with pytest.raises(TypeError, match="no canonical bytes for type"):
        digest(One)


def test_the_digest_is_the_same_on_every_machine() -> None:
    """SHA-256 of the canonical bytes, spelled out."""
    assert digest([1, 0.5, "ab"]) == sha256(b"s3(i1f5.000000000000e-01t2:ab)").hexdigest()
    words = np.array([1e12, 0.0]).tobytes()
    assert digest(One(np.array([1.0]))) == sha256(b"dOne(a=a<f8(1,)" + words + b")").hexdigest()
    assert digest({"a": None, "b": b"xy"}) == sha256(b"m(t1:ant1:by2:xy)").hexdigest()


@pytest.mark.parametrize("far", [1.0001e4, -1e300, np.nan, np.inf])
def test_a_place_is_where_a_machine_can_be(far: float) -> None:
    check_place([0.0, -1e4, 1e4], "Part zero", RobomillError)
    with pytest.raises(RobomillError, match="^Part zero: it lies .* m off; expected 10000 m at most"):
        check_place([0.0, 0.0, far], "Part zero", RobomillError)


def test_arrays_in_values_that_do_not_see_to_it_themselves_are_sealed_too() -> None:
    @dataclass
    class Pair:
        first: Any
        second: Any

    inner, outer, named = np.zeros(2), np.zeros(3), np.zeros(4)
    sealed(Pair(outer, (Pair(inner, 1.0), {"named": named})))
    assert [array.flags.writeable for array in (inner, outer, named)] == [False] * 3


@pytest.mark.parametrize("length", [0, 1, 2, 7])
def test_the_next_true_is_the_one_that_a_look_at_each_place_finds(length: int) -> None:
    for bits in range(2**length):
        which = np.array([bool(bits >> k & 1) for k in range(length)], dtype=bool)
        looked = [next((j for j in range(i, length) if which[j]), length) for i in range(length)]
        assert next_true(which, length).tolist() == looked


@pytest.mark.parametrize(
    ("name", "text"), [("list", "a list"), ("Arc", "an Arc"), ("int", "an int"), ("Robot", "a Robot")]
)
def test_a_noun_has_its_article(name, text) -> None:
    assert with_article(name) == text


@pytest.mark.parametrize("length", range(8))
def test_stretches_are_those_that_a_look_at_each_place_finds(length: int) -> None:
    for bits in range(2**length):
        which = np.array([bool(bits >> k & 1) for k in range(length)], dtype=bool)
        begins = [i for i in range(length) if which[i] and not (i and which[i - 1])]
        looked = [[i, next((j for j in range(i, length) if not which[j]), length)] for i in begins]
        assert stretches(which).tolist() == looked


@pytest.mark.parametrize(
    "call",
    [
        lambda p: rm.Toolpath.from_points(p_mm=p, feed_mm_min=600),
        lambda p: rm.Toolpath.from_points(p * 1e-3, 0.01),
        lambda p: rm.tool_pose(rm.load_robot("planar_2r"), p[:, :2]),
        lambda p: rm.Robot.from_dh(a_mm=p[0] * 100.0),
        lambda p: rm.frame_from_points(p[0], p[1] + 1.0, [0.0, 1.0, 0.0]),
    ],
)
def test_a_masked_entry_is_no_number(call) -> None:
    """NumPy hands on what stands behind the mask, which is what the mask says not to use."""
    p = np.ma.array([[0.0, 1.0, -2.0], [5.0, 0.0, -2.0]], mask=[[1, 0, 0], [0, 0, 0]])
    with pytest.raises(rm.RobomillError, match="a masked entry"):
        call(p)
    call(np.ma.array(p.data))


def test_a_table_in_place_of_a_file_is_told_in_a_line() -> None:
    with pytest.raises(rm.RobomillError) as refused:
        rm.read_points(pd.DataFrame({"X_mm": [0.0, 1.0]}))
    assert "found a DataFrame" in str(refused.value)


@pytest.mark.parametrize("unit", ["datetime64[s]", "timedelta64[ms]"])
def test_dates_and_times_are_no_numbers(unit: str) -> None:
    with pytest.raises(RobomillError, match="expected numbers, found"):
        as_floats(np.zeros(3, dtype=unit), "p", (3,))
