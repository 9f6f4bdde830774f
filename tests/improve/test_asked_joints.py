"""What is asked of joints that may be made stiffer, and what is said of them."""

import numpy as np
import pytest

from robomill.errors import SetupError
from robomill.improve.asked_joints import checked_bounds, checked_weight, joints_named, words_of_joints


def test_bounds_are_those_of_every_joint_or_each_its_own() -> None:
    np.testing.assert_array_equal(checked_bounds((1, 4), 3), [[1.0, 4.0]] * 3)
    own = [(1, 4), (0.5, 2), (3, 3)]
    np.testing.assert_array_equal(checked_bounds(own, 3), own)
    np.testing.assert_array_equal(checked_bounds([(1, 4), (2, 5)], 2), [(1, 4), (2, 5)])


@pytest.mark.parametrize(
    ("bounds", "words"),
    [
        (2.0, "expected two numbers"),
        ((1, 2, 3), "expected two numbers"),
        ([(1, 4)], "two for each of 3 joints"),
        ([(1, 4), (1, 4), (0, 4)], "free joint 3: found 0 to 4"),
        ([(1, 4), (4, 1), (1, 4)], "free joint 2: found 4 to 1"),
        ((-1, 4), "free joint 1: found -1 to 4"),
    ],
)
def test_other_bounds_are_refused_by_the_joint(bounds: object, words: str) -> None:
    with pytest.raises(SetupError, match=words):
        checked_bounds(bounds, 3)  # type: ignore[arg-type]


def test_a_weight_is_that_of_every_joint_or_each_its_own() -> None:
    np.testing.assert_array_equal(checked_weight(2.0, 3), [2.0] * 3)
    np.testing.assert_array_equal(checked_weight([1.0, 2.0, 0.5], 3), [1.0, 2.0, 0.5])
    for wrong in (0.0, [1.0, 2.0], [1.0, 0.0, 1.0], [[1.0, 1.0, 1.0]], -1.0):
        with pytest.raises(SetupError, match="numbers above zero, one for all 3 joints"):
            checked_weight(wrong, 3)


def test_joints_that_change_by_more_than_a_thousandth_are_named() -> None:
    """By the numbers of the joints that are free, and not by their order."""
    ratios = np.array([1.25, 1.0009, 0.5, 0.997])
    named = joints_named((2, 3, 5, 6), ratios)
    assert [words.replace("\u00a0", " ").split()[:3] for words in named] == [
        ["joint", "2", "1.25"],
        ["joint", "5", "0.5"],
        ["joint", "6", "0.997"],
    ]
    words = words_of_joints((2, 3, 5, 6), ratios)
    assert words is not None
    assert words[1] == 3
    assert words_of_joints((2, 3), np.array([1.0, 1.0005])) is None
