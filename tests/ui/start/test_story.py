"""What the start page tells of the cause."""

from __future__ import annotations

import pytest

from robomill.io.robot.robots import load_robot
from robomill.simulation.run import simulate
from robomill.ui.posed.push import whole
from robomill.ui.project import preset_setup
from robomill.ui.start.story import cause


@pytest.mark.parametrize("shares", [(0.605, 0.395), (0.333, 0.333, 0.334), (0.7004, 0.2996), (0.516, 0.304, 0.1)])
def test_shares_in_whole_per_cent_sum_to_what_they_are(shares: tuple[float, ...]) -> None:
    """60.5 and 39.5 % were 61 and 40 %: more than all of it."""
    assert sum(whole(list(shares))) == round(100.0 * sum(shares))
    assert all(abs(each - 100.0 * share) < 1.0 for each, share in zip(whole(list(shares)), shares, strict=True))


def test_the_cause_is_told_of_the_groove() -> None:
    assert cause(simulate(preset_setup("paper_flute")), "mm") == (
        "100 N on the tool moves the tip by +0.230 mm along Y, −0.102 mm along Z. "
        "Of these 0.251 mm, 70 % come from joint 3 and 30 % from joint 5."
    )


def test_where_the_tip_strays_farther_at_another_place_the_cause_says_of_which_it_speaks() -> None:
    """The tile beside it tells of the tip where that is farthest off: two vectors, and each says whose it is."""
    setup = preset_setup("paper_flute").replace(robot=load_robot("fanuc_r2000ic"))
    result = simulate(setup)
    assert result.worst != result.decided.sample
    assert cause(result, "mm").startswith("Where the wall is farthest off, 100 N on the tool moves the tip by ")
