"""A step's place and the frame on the tool's axis."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from robomill.surface.contact import step_kernels
from robomill.surface.contact.material_kernels import Dexels
from robomill.surface.contact.step_kernels import ask_for_rim, step_at


def test_a_step_has_its_place_and_a_frame_on_the_axis():
    rng = np.random.default_rng(4)
    for _ in range(20):
        tip, k, v = rng.normal(size=3), rng.normal(size=3), rng.normal(size=3)
        k, v = k / np.linalg.norm(k), v / np.linalg.norm(v)
        step = step_at(tip, k, v, np.zeros(3), (0.3, 5), np.zeros(3))
        feed, left, axis = np.array(step[3:6]), np.array(step[6:9]), np.array(step[9:12])
        np.testing.assert_allclose(step[:3], tip)
        np.testing.assert_allclose(axis, k)
        np.testing.assert_allclose(
            np.column_stack([feed, left, axis]).T @ np.column_stack([feed, left, axis]), np.eye(3), atol=1e-12
        )
        np.testing.assert_allclose(np.cross(feed, left), axis, atol=1e-12)
        np.testing.assert_allclose(step.across * feed + step.along * axis, v, atol=1e-12)
        assert step.across > 0.0
        assert (step.sinks, step.run) == (0.3, 5)


@pytest.mark.parametrize("k", [[0.0, 0, 1], [1.0, 0, 0], [0, 0.6, -0.8], [-0.96, 0.28, 0]])
def test_straight_along_the_axis_the_heading_stands_for_the_feed(k):
    k = np.array(k)
    heading = np.cross(k, [0.3, -0.5, 0.7])
    heading /= np.linalg.norm(heading)
    step = step_at(np.zeros(3), k, -k, heading, (1.0, 0), np.zeros(3))
    assert (step.across, step.along) == pytest.approx((0.0, -1.0))
    frame = np.column_stack([step[3:6], step[6:9], k])
    np.testing.assert_allclose(step[3:6], heading, atol=1e-12)
    np.testing.assert_allclose(frame.T @ frame, np.eye(3), atol=1e-12)
    assert np.linalg.det(frame) == pytest.approx(1.0)


@pytest.mark.parametrize("halves", [1, 2])
@pytest.mark.parametrize("lean", [0.0, 0.4])
def test_the_columns_asked_for_lie_under_the_rim_one_beside_the_other(monkeypatch, halves, lean):
    """Of cells twice as long as wide, whose first one has its centre anywhere: ahead of the tool, or all about it."""
    asked = []
    monkeypatch.setattr(step_kernels, "soon", lambda array, i, j: asked.append((array.name, i, j)))
    heights, names = SimpleNamespace(name="heights"), SimpleNamespace(name="names")
    dexels, R = Dexels(heights, names, None, 0.013, -0.021, 2e-4, 4e-4, 0.0), 3e-3
    k = np.array([np.sin(lean), 0.0, np.cos(lean)])
    step = step_at(np.array([0.0213, -0.0052, -1e-3]), k, np.array([0.6, 0.8, 0.0]), np.zeros(3), (0.0, 1), np.zeros(3))
    ask_for_rim(dexels, step, R, halves)
    cells = np.array([place[1:] for place in asked])
    np.testing.assert_array_equal(cells[::2], cells[1::2])
    assert [place[0] for place in asked[:2]] == ["heights", "names"]
    phi = np.linspace(0.0, halves * np.pi, 20_001)[:, None]
    rim = np.array(step[:3]) + R * (np.sin(phi) * step[3:6] + np.cos(phi) * step[6:9])
    under = np.round((rim[:, :2] - [0.013, -0.021]) / [2e-4, 4e-4]).astype(int)
    assert set(map(tuple, cells)) <= set(map(tuple, under))
    assert np.abs(np.diff(cells[::2], axis=0)).max() <= 1
    np.testing.assert_allclose(cells[-1], under[-1], atol=2)
