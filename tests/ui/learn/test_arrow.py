"""An arrow that is drawn as a prediction: its angle on the board, and the answer that it gives."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.learn.push import AsidePush
from robomill.ui.learn.arrow import angle, answer, apart, plane

ALONG_Y = AsidePush(1, 2, 0)  # pushed along Y, led aside along Z
ALONG_Z = AsidePush(2, 0, 1)
ALONG_X = AsidePush(0, 1, 2)


def test_z_points_up_on_the_board() -> None:
    assert plane(ALONG_Y) == (1, 2)
    assert plane(ALONG_Z) == (0, 2)
    assert plane(ALONG_X) == (0, 1)


@pytest.mark.parametrize("push", [ALONG_Y, ALONG_Z, ALONG_X])
def test_an_arrow_along_a_displacement_gives_the_answer_of_that_displacement(push: AsidePush) -> None:
    """Drawn exactly where the tip goes, an arrow is judged as the tip's own displacement is."""
    for share in (-1.5, -0.5, 0.0, 0.5, 1.5):
        delta = np.zeros(3)
        delta[push.along], delta[push.aside] = 1.0, share
        assert answer(push, angle(push, delta)) == push.went(delta)


def test_the_angle_is_counted_from_the_right_upwards() -> None:
    assert angle(ALONG_Y, np.array([0.0, 1.0, 0.0])) == pytest.approx(0.0)
    assert angle(ALONG_Y, np.array([0.0, 0.0, 1.0])) == pytest.approx(90.0)
    assert angle(ALONG_Z, np.array([0.0, 0.0, 2.0])) == pytest.approx(90.0)


def test_directions_are_at_most_a_half_turn_apart() -> None:
    assert apart(170.0, -170.0) == pytest.approx(20.0)
    assert apart(0.0, 180.0) == pytest.approx(180.0)
    assert apart(-90.0, -66.0) == pytest.approx(24.0)
