"""What is asked before a cut: which points of a plane the arm reaches."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.io.samples import samples_dir
from robomill.kinematics.transforms import translation
from robomill.simulation.reach import path_reach, plane_reach
from robomill.toolpath.source import GCodeSource


def test_a_plane_is_reached_where_each_of_its_points_is() -> None:
    robot = rm.load_robot("slavkovic_5r")
    T_MW = translation([0.1, -1.2, -0.2])
    x, y = np.linspace(-2.0, 2.0, 7), np.linspace(-1.5, 1.5, 5)
    found = plane_reach(robot, T_MW, x, y, 0.05)
    alone = [[rm.inverse_kinematics(robot, T_MW @ translation([u, v, 0.05])).reached for u in x] for v in y]
    np.testing.assert_array_equal(found, alone)
    assert found.any()
    assert not found.all()


def test_a_path_is_missed_where_a_point_at_feed_is_not_reached_and_the_first_of_them_says_why() -> None:
    """Out of reach on a rapid to one side, at feed beyond the arm's end on the other."""
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(step=20e-3)
    text = "G21 G90 S9000 M3\nG0 Y5000 Z5\nG0 Y0\nG1 Z-1 F900\nG1 X-4000\nM2\n"
    found = path_reach(setup.replace(source=GCodeSource(text)))
    at = [setup.T_MW @ translation(p) for p in found.path.p]
    alone = np.array([bool(rm.inverse_kinematics(setup.robot, T).reached) for T in at])
    np.testing.assert_array_equal(found.reached, alone)
    np.testing.assert_array_equal(found.missed, [on and not there for on, there in zip(found.path.cutting, alone)])
    assert 0 < found.missed.sum() < (~alone).sum()
    np.testing.assert_array_equal(np.isfinite(found.room), alone)
    lost = [i for i, on in enumerate(found.path.cutting) if on and not alone[i]]
    step = [float(np.linalg.norm(found.path.p[i] - found.path.p[i - 1])) for i in lost]
    assert found.missed_length == pytest.approx(sum(step))
    assert found.missed_blocks.tolist() == sorted({int(found.path.block[i]) for i in lost})
    assert found.share == 1.0 - len(lost) / sum(map(bool, found.path.cutting))
    first = rm.inverse_kinematics(setup.robot, np.array(at)[found.missed][:1])
    assert found.reason == first.reason(0) != ""
    near = "G21 G90 S9000 M3\nG0 Y5000 Z5\nG0 Y0\nG1 Z-1 F900\nG1 X-40\nM2\n"
    assert path_reach(setup.replace(source=GCodeSource(near))).reason == ""


@pytest.mark.parametrize("most", [20, 60, 1000])
def test_a_long_path_is_looked_at_in_as_many_steps_as_are_asked_for(monkeypatch: pytest.MonkeyPatch, most: int) -> None:
    """Of its length, 100 mm at feed; a short one in the steps of its run, of 1 mm."""
    monkeypatch.setattr("robomill.simulation.reach.MAX_SAMPLES", most)
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(step=1e-3)
    path = path_reach(setup).path
    step = path.step_length[path.cutting]
    assert step.max() == pytest.approx(max(setup.toolpath.s[-1] / most, 1e-3), rel=0.1)
