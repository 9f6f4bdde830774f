"""Which push leads aside most, and which answer is right."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from robomill.learn.push import FORCE, AsidePush

PAPER = np.array([[1.281, 0, 0], [0, 2.295, -1.024], [0, -1.024, 2.422]]) * 1e-6


def test_the_paper_s_robot_is_pushed_along_y() -> None:
    push = AsidePush.of(PAPER)
    assert (push.name, push.aside, push.other) == ("Y", 2, 0)
    assert push.answers == {
        "alone": "Along Y, nowhere else",
        "+2": "Along Y and up",
        "-2": "Along Y and down",
        "other": "Along Y and along X",
    }


@pytest.mark.parametrize("along", range(3))
def test_the_push_is_the_one_whose_tip_strays_by_the_largest_angle(along: int) -> None:
    """The angle between the push and where it leads, by the arc cosine, over random compliances of springs."""
    rng = np.random.default_rng(along)
    for _ in range(50):
        J = rng.normal(size=(3, 4)) * [[0.1], [0.1], [0.1]]
        J[along] += rng.normal(size=4) * 0.5
        C = np.round(J @ J.T, 6)
        C[(along + 1) % 3, :] = C[:, (along + 1) % 3] = 0.0  # so that a single term leads aside
        C[(along + 1) % 3, (along + 1) % 3] = 1.0
        angles = [np.arccos(abs(C[i, i]) / np.linalg.norm(C[:, i])) for i in range(3)]
        assert AsidePush.of(C).along == int(np.argmax(np.round(angles, 6)))


@pytest.mark.parametrize(("along", "aside"), list(itertools.permutations(range(3), 2)))
@pytest.mark.parametrize("sign", [1, -1])
def test_the_answer_follows_the_largest_part_aside(along: int, aside: int, sign: int) -> None:
    push = AsidePush(along, aside, 3 - along - aside)
    delta = np.zeros(3)
    delta[along] = 1.0
    assert push.went(delta) == "alone"
    delta[aside] = 0.5 * sign
    assert push.went(delta) == f"{'+' if sign > 0 else '-'}{aside}"
    delta[push.other] = 0.6
    assert push.went(delta) == "other"
    delta[[aside, push.other]] = 0.01
    assert push.went(delta) == "alone"
    assert push.force.tolist() == [FORCE * (i == along) for i in range(3)]


def test_an_arm_that_bends_in_no_direction_is_asked_all_the_same() -> None:
    push = AsidePush.of(np.zeros((3, 3)))
    assert push.went(np.zeros(3)) in push.answers


def test_where_the_tip_goes_is_told_along_the_push_first() -> None:
    push = AsidePush.of(PAPER)
    delta = np.array([4e-6, 0.2295e-3, -0.1024e-3])
    assert push.told(delta, "mm") == "0.229 mm along Y and 0.102 mm down", "2 % aside are nowhere"
    assert push.told(delta, "in", "<b>{}</b>") == "<b>0.0090 in</b> along Y and <b>0.0040 in</b> down"
    assert push.told(np.array([-1e-3, 0.0, 0.0]), "mm") == "1.000 mm towards −X"
    assert push.told(np.zeros(3), "mm") == "nowhere"
