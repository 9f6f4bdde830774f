"""What a stiffer joint leaves of a deviation, against the linear law and against a robot with a halved compliance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from robomill.improve.stiffening import Stiffening, some_stiffer, stiffer_joints
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.progress import Progress, watched
from robomill.simulation.run import simulate


def test_each_joint_leaves_what_the_linear_law_says() -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    result = simulate(setup)
    ranked = stiffer_joints(setup)
    assert ranked.before.sentence == result.verdict.sentence
    assert ranked.tip[0] == result.max_deviation
    judged = result.judged
    left = np.linalg.norm(result.delta[judged, None] - 0.5 * result.delta_joint[judged], axis=-1).max(axis=0)
    np.testing.assert_allclose(ranked.tip[1:], left, rtol=1e-9)
    q = result.verdict.wall.worst
    aside = result.delta_in_cut[q, 1] - 0.5 * (result.delta_joint[q] @ result.R_MF[q, :, 1])
    np.testing.assert_allclose([verdict.wall.value for verdict in ranked.after], aside, rtol=1e-3)
    down = result.delta_in_cut[q, 2] - 0.5 * (result.delta_joint[q] @ result.R_MF[q, :, 2])
    used = np.maximum(np.abs(aside), np.abs(down)) / setup.tolerance
    np.testing.assert_allclose(ranked.used, used, rtol=2e-3)
    np.testing.assert_allclose(ranked.saved, result.verdict.share - used, atol=2e-3)


def test_twice_as_stiff_is_half_the_compliance_of_that_joint_alone() -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    C = np.array(setup.robot.C_theta)
    C[2] /= 2.0
    np.testing.assert_array_equal(some_stiffer(setup.robot, [2]).C_theta, C)
    halved = simulate(setup.replace(robot=setup.robot.replace(C_theta=C))).max_deviation
    assert stiffer_joints(setup).tip[3] == pytest.approx(halved, rel=1e-12)


def test_the_best_comes_first() -> None:
    verdict = simulate(load_setup(samples_dir() / "paper_flute" / "setup.toml")).verdict
    left = tuple(replace(verdict, share=share) for share in (2.5, 1.0, float("nan"), 3.5, 1.0))
    ranked = Stiffening(replace(verdict, share=3.0), left, np.zeros(6))
    assert ranked.ranking.tolist() == [1, 4, 0, 3, 2]
    assert ranked.saved[[0, 1, 3, 4]].tolist() == [0.5, 2.0, -0.5, 2.0]


def test_a_floor_that_decides_is_what_is_ranked_not_the_tip() -> None:
    """Where nobody limits the walls, the floor alone ranks the joints."""
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(tolerance=0.05, floor_tolerance=1e-4)
    ranked = stiffer_joints(setup)
    deciding = ranked.before.deciding
    assert deciding is not None
    assert deciding[0] == "floor"
    result = simulate(setup)
    q = result.verdict.floor.worst
    down = result.delta_in_cut[q, 2] - 0.5 * (result.delta_joint[q] @ result.R_MF[q, :, 2])
    np.testing.assert_allclose(ranked.used, np.abs(down) / 1e-4, rtol=2e-3)


@pytest.mark.parametrize("tolerance", [0.18e-3, 0.14e-3, 0.12e-3, 0.1e-3])
def test_where_no_joint_is_enough_the_best_ones_are_taken_together_until_they_are(tolerance: float) -> None:
    """By superposition: of the joints in the order of what they save, as few as keep the tolerance, or all of them."""
    setup = load_setup("paper_flute").replace(tolerance=tolerance, floor_tolerance=None)
    result = simulate(setup)
    q = result.verdict.wall.worst
    of_joint = result.delta_joint[q] @ result.R_MF[q, :, 1]
    best = [int(joint) for joint in np.argsort(-of_joint, kind="stable") if of_joint[joint] > 1e-9]
    left = of_joint.sum() - 0.5 * np.cumsum(of_joint[best])
    enough = np.flatnonzero(left <= tolerance)
    told: list[float] = []
    with watched(Progress(say=lambda each: told.append(each.share) if "together" in each.stage else None)):
        ranked = stiffer_joints(setup)
    if len(enough) and enough[0] == 0:
        assert ranked.together == ()
        assert ranked.with_together is None
        return
    count = enough[0] + 1 if len(enough) else len(best)
    assert ranked.together == tuple(best[:count])
    np.testing.assert_allclose(told, np.arange(count - 1) / (len(best) - 1), err_msg="two, three, ... or all of them")
    assert ranked.with_together is not None
    assert ranked.with_together.wall.value == pytest.approx(left[count - 1], rel=1e-3)
    assert (ranked.with_together.level != "out") == bool(len(enough))
