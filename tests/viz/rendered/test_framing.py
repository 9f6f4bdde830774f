"""The arm on its frame: the points projected here by another way, a look-at matrix."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.viz.rendered.framing import FILL, STEP, framed, signs


def on_screen(layout: dict, points: np.ndarray) -> np.ndarray:
    """(m, 2) where plotly shows points: its box around the origin, as long as ``aspectratio``, seen in parallel."""
    ratio = np.array([layout["aspectratio"][a] for a in "xyz"])
    ends = np.array([layout[f"{a}axis"]["range"] for a in "xyz"])
    placed = ((points - ends[:, 0]) / np.ptp(ends, axis=1) - 0.5) * ratio
    eye, centre = (np.array([layout["camera"][name][a] for a in "xyz"]) for name in ("eye", "center"))
    z = (eye - centre) / np.linalg.norm(eye - centre)
    x = np.cross([0, 0, 1], z) / np.linalg.norm(np.cross([0, 0, 1], z))
    look = np.eye(4)
    look[:3, :3] = [x, np.cross(z, x), z]
    look[:3, 3] = -look[:3, :3] @ centre
    return np.asarray((np.c_[placed, np.ones(len(placed))] @ look.T)[:, :2])


@pytest.mark.parametrize("aspect", [0.6, 0.9, 1.6])
@pytest.mark.parametrize("seed", range(5))
def test_the_points_fill_four_fifths_of_the_frame_and_stand_in_its_middle(aspect: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.uniform(-1, 1, (60, 3)) * rng.uniform(0.2, 3, 3) + rng.uniform(-2, 2, 3)
    seen = on_screen(framed(points, rng.uniform(0.2, 1.5, 3) * rng.choice([-1, 1], 3), aspect), points)
    fill = np.ptp(seen, axis=0) / (2 * np.array([aspect, 1.0]))
    assert FILL / STEP <= fill.max() <= FILL + 1e-9
    np.testing.assert_allclose(seen.min(axis=0) + seen.max(axis=0), 0.0, atol=1e-9)


def test_the_scale_stands_still_while_the_arm_moves_a_little() -> None:
    points = np.array([[0.0, 0, 0], [1, 0.2, 1.5], [0.3, 1, 0.1]])
    first, second = (framed(points * grown, (1.3, -0.9, 0.6), 0.9) for grown in (1.0, 1.001))
    sizes = [np.array(list(layout["aspectratio"].values())) for layout in (first, second)]
    np.testing.assert_allclose(sizes[1] / sizes[0], 1.001, rtol=1e-9)


def test_words_stand_on_a_ground_and_empty_ones_do_not_stand_at_all() -> None:
    said = [(np.zeros(3), "100 N", "#000000"), (np.ones(3), "", "#000000")]
    (sign,) = signs(said, "rgba(255,255,255,0.8)")
    assert (sign["text"], sign["bgcolor"], sign["x"]) == ("100 N", "rgba(255,255,255,0.8)", 0.0)
