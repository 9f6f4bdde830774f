"""Which error of a part decides, by its own tolerance, and what the larger of several is."""

from types import SimpleNamespace

import numpy as np
import pytest

from robomill.improve.errors import MEASURED, Errors, deciding, graver, is_measured_whole

NAN = float("nan")


def setup(wall: float, floor: float, feed: float | None) -> SimpleNamespace:
    return SimpleNamespace(feed_tolerance=feed, limits={"wall": wall, "floor": floor, "feed": feed, "tip": wall})


@pytest.mark.parametrize(
    ("limits", "sizes", "expected"),
    [
        ((0.3, 0.3, None), (0.2, -0.25, 9.0, 9.0), ("floor", 0.25)),
        ((0.3, 0.3, None), (-0.26, -0.25, 9.0, 9.0), ("wall", 0.26)),
        ((0.3, 0.1, None), (0.26, 0.1, 9.0, 9.0), ("floor", 0.1)),
        ((0.3, 0.3, 0.05), (0.2, 0.25, -0.05, 9.0), ("feed", 0.05)),
        ((0.3, 0.3, 0.5), (0.2, 0.25, 0.3, 9.0), ("floor", 0.25)),
        ((0.3, 0.3, None), (NAN, 0.01, NAN, 9.0), ("floor", 0.01)),
        ((0.3, 0.3, 0.5), (NAN, NAN, 0.1, 9.0), ("feed", 0.1)),
        ((0.3, 0.3, None), (NAN, NAN, 0.1, 9.0), ("tip", 9.0)),
        ((0.3, 0.3, 0.5), (NAN, NAN, NAN, 9.0), ("tip", 9.0)),
    ],
)
def test_what_uses_most_of_its_own_tolerance_decides(
    limits: tuple[float, float, float | None], sizes: tuple[float, float, float, float], expected: tuple[str, float]
) -> None:
    assert deciding(setup(*limits), *sizes) == expected
    wall, floor, feed, tip = sizes
    errors = Errors(*(np.array([abs(each), 0.0]) for each in (wall, floor, tip)), abs(feed))
    name, size = expected
    assert errors.decides(setup(*limits)) == expected
    assert errors.share(setup(*limits)) == pytest.approx(size / setup(*limits).limits[name])


def test_the_larger_of_wall_and_floor_and_the_tips_where_there_is_neither() -> None:
    tip = np.array([7.0, 6.0])
    for wall, floor, expected in (
        ([1.0, 0.5], [2.0, 0.2], (2.0, 0.5)),
        ([NAN, NAN], [2.0, 0.2], (2.0, 0.2)),
        ([3.0, 0.1], [NAN, NAN], (3.0, 0.1)),
        ([NAN, NAN], [NAN, NAN], (7.0, 6.0)),
    ):
        found = Errors(np.array(wall), np.array(floor), tip)
        assert (found.max, found.rms) == expected


def test_the_graver_one_uses_more_of_the_tolerance_whatever_its_size() -> None:
    tip = np.zeros(2)
    deep, wide = Errors(np.array([0.2, 0.2]), np.array([0.09, 0.0]), tip), Errors(np.array([0.26, 0.2]), tip, tip)
    for order in ((deep, wide), (wide, deep)):
        assert graver(*order, setup(0.3, 0.1, None)) is deep  # type: ignore[arg-type]
        assert graver(*order, setup(0.3, 0.3, None)) is wide  # type: ignore[arg-type]


def test_up_to_six_thousand_samples_are_all_measured() -> None:
    assert MEASURED == 6000
    for judged, whole in ((6000, True), (6001, False)):
        every = np.append(np.ones(judged, dtype=bool), np.zeros(9000, dtype=bool))
        assert is_measured_whole(SimpleNamespace(judged=every)) == whole  # type: ignore[arg-type]
