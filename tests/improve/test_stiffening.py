"""What a stiffer joint leaves of a deviation, against the linear law and against a robot with a halved compliance."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.improve.stiffening import Stiffening, one_stiffer, stiffer_joints
from robomill.io.projects import load_setup
from robomill.io.samples import samples_dir
from robomill.simulation.run import simulate


def test_each_joint_leaves_what_the_linear_law_says() -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    result = simulate(setup)
    ranked = stiffer_joints(setup)
    assert ranked.before == result.max_deviation
    judged = result.judged
    left = np.linalg.norm(result.delta[judged, None] - 0.5 * result.delta_joint[judged], axis=-1).max(axis=0)
    np.testing.assert_allclose(ranked.after, left, rtol=1e-9)
    np.testing.assert_allclose(ranked.saved, result.max_deviation - left, rtol=1e-9, atol=1e-15)
    q = result.verdict.wall.worst
    aside = result.delta_in_cut[q, 1] - 0.5 * (result.delta_joint[q, int(left.argmin())] @ result.R_MF[q, :, 1])
    assert ranked.verdict.wall.value == pytest.approx(aside, rel=1e-3)


def test_twice_as_stiff_is_half_the_compliance_of_that_joint_alone() -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    C = np.array(setup.robot.C_theta)
    C[2] /= 2.0
    np.testing.assert_array_equal(one_stiffer(setup.robot, 2).C_theta, C)
    halved = simulate(setup.replace(robot=setup.robot.replace(C_theta=C))).max_deviation
    assert stiffer_joints(setup).after[2] == pytest.approx(halved, rel=1e-12)


def test_the_best_comes_first() -> None:
    verdict = simulate(load_setup(samples_dir() / "paper_flute" / "setup.toml")).verdict
    ranked = Stiffening(3.0, np.array([2.5, 1.0, 3.5, 1.0]), verdict)
    assert ranked.ranking.tolist() == [1, 3, 0, 2]
    assert ranked.saved.tolist() == [0.5, 2.0, -0.5, 2.0]
