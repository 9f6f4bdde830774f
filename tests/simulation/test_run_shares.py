"""What gives, by which share, held against other ways to the same number: twisted joints, beams, potential energy."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.compliance.gravity import LinkMasses
from robomill.compliance.springs.spindle import SpindleSpring
from robomill.compliance.springs.tool_bending import ToolBending
from robomill.cutting.forces.constant import ConstantForce
from robomill.io.samples import samples_dir
from robomill.kinematics.forward import joint_frames
from robomill.report.simulation_record import simulation_record
from robomill.surface.contact.engagement import engage
from robomill.surface.contact.march import March

SETUP = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(step=10e-3, cell=4e-4)
PROCESS = rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml").replace(cell=4e-4)
FORCE = np.array([40.0, 100.0, -30.0])
TOOL = ToolBending(0.008, 0.04)
SPINDLE = SpindleSpring(2e-7, 5e-8)


def twisted(robot, theta, C_theta, F):
    """Where the tip goes when each joint turns by its compliance times the torque of F, by differences of poses."""
    h, still = 1e-6, rm.tool_pose(robot, theta)[:3, 3]
    J = np.array(
        [
            (rm.tool_pose(robot, theta + h * e)[:3, 3] - rm.tool_pose(robot, theta - h * e)[:3, 3]) / (2 * h)
            for e in np.eye(len(theta))
        ]
    ).T
    small = 1e-3  # the model is linear: a small force, so that the arm stays where it is
    return (rm.tool_pose(robot, theta + C_theta * (J.T @ F) * small)[:3, 3] - still) / small


def test_joints_and_springs_add_up():
    """Joints twisted by their torques, the cutter as a beam, the spindle as springs; nothing is taken off."""
    run = rm.simulate(SETUP.replace(force=ConstantForce(FORCE), springs=(TOOL, SPINDLE)))
    second_moment = np.pi / 64 * (0.8 * 0.008) ** 4
    beam = 0.04**3 / (3 * 600e9 * second_moment)
    for i in np.flatnonzero(run.path.cutting):
        axis = rm.tool_pose(run.setup.robot, run.theta[i])[:3, 2]
        along = (FORCE @ axis) * axis
        tool, spindle = beam * (FORCE - along), 2e-7 * (FORCE - along) + 5e-8 * along
        joints = twisted(run.setup.robot, run.theta[i], run.setup.robot.C_theta, FORCE)
        np.testing.assert_allclose(run.delta_spring[i], [tool, spindle], atol=1e-12)
        np.testing.assert_allclose(run.delta_joint[i].sum(axis=0), joints, rtol=2e-5, atol=1e-9)
        np.testing.assert_allclose(run.delta[i], joints + tool + spindle, rtol=2e-5, atol=1e-9)
        np.testing.assert_allclose(run.C[i] @ FORCE, run.delta[i], atol=1e-15)
        assert run.delta[i] @ FORCE > joints @ FORCE > 0.0  # what gives, gives the force's way


def test_sag_is_added_only_when_asked():
    """Each joint turns by its compliance times the fall of the potential energy, found by differences."""
    rng = np.random.default_rng(2)
    links = LinkMasses(rng.uniform(5, 40, 5), rng.uniform(-0.2, 0.2, (5, 3)))
    plain, told, added = (
        rm.simulate(SETUP.replace(**more)) for more in ({}, {"links": links}, {"links": links, "add_sag": True})
    )
    np.testing.assert_array_equal(told.delta, plain.delta)
    robot = SETUP.robot

    def energy(theta):
        frames = joint_frames(robot, theta)[1:]
        centres = np.einsum("nij,nj->ni", frames[:, :3, :3], links.centre) + frames[:, :3, 3]
        return 9.80665 * float(links.mass @ centres[:, 2])

    h = 1e-5
    for i in (1, len(plain.path) // 2):
        theta = plain.theta[i]
        torque = np.array([-(energy(theta + h * e) - energy(theta - h * e)) / (2 * h) for e in np.eye(5)])
        fall = rm.geometric_jacobian(robot, theta)[:3] @ (robot.C_theta * torque)
        np.testing.assert_allclose(added.delta[i] - plain.delta[i], fall, rtol=1e-3, atol=1e-7)
        np.testing.assert_allclose(told.sag[i].sum(axis=0), fall, rtol=1e-3, atol=1e-7)


@pytest.mark.parametrize("sag", [False, True])
def test_coupled_runs_agree_with_themselves(sag):
    """The deflected path meets the material that the force was computed from, and bends by just that force."""
    links = LinkMasses([30.0, 20.0, 15.0, 5.0, 5.0], np.zeros((5, 3)))
    changes = {"links": links, "add_sag": True} if sag else {}
    run = rm.simulate(PROCESS.replace(coupling=True, **changes))
    single = rm.simulate(PROCESS.replace(**changes))
    assert single.coupling is None
    assert run.coupling.converged
    found = engage(
        March(
            run.setup.stock_block, 4e-4, run.setup.cutter, run.path.p, run.path.k, run.path.cutting, (), run.p_machined
        )
    )
    cutting = run.path.cutting & (run.path.step_length > 0)
    # A step is met where its own force bends it to; where the bend changes along it, its start stands elsewhere.
    steady = cutting & (np.abs(np.diff(run.delta, axis=0, prepend=run.delta[:1])).max(axis=1) < 1e-6)
    assert steady.sum() > 0.8 * cutting.sum()
    np.testing.assert_allclose(run.conditions.a_p[steady], found.a_p[steady], atol=1e-6)
    assert np.abs(run.conditions.a_p - single.conditions.a_p)[cutting].max() > 1e-5
    offset = run.sag.sum(axis=1) if sag else 0.0
    np.testing.assert_allclose(run.delta, np.einsum("mij,mj->mi", run.C, run.F) + offset, atol=1e-15)
    assert run.coupling.difference == pytest.approx(np.abs(run.delta - single.delta)[run.path.cutting].max(), abs=1e-9)


def test_off_the_cut_a_measured_map_is_not_asked():
    mapped = rm.load_setup(samples_dir() / "paper_flute" / "setup_measured_map.toml")
    run = rm.simulate(mapped)
    shares = run.C_joint.sum(axis=1) + run.C_spring.sum(axis=1)
    off = ~run.path.cutting
    np.testing.assert_array_equal(run.C[off], shares[off])
    assert np.abs(run.C - shares)[run.path.cutting].max() > 1e-8
    assert np.isfinite(run.delta).all()


def test_depth_of_a_full_slot_is_measured_from_the_stocks_top():
    run = rm.simulate(SETUP)
    top = run.setup.stock_block.upper[2]
    lower, p = run.setup.stock_block.lower, run.path.p
    within = p[:, 0] + 0.004 > lower[0] + 1e-9  # the path begins with the mill of 8 mm just clear of the block
    assert 0 < within.sum() < len(p)
    np.testing.assert_allclose(run.conditions.a_p, np.where(within, np.maximum(top - p[:, 2], 0.0), 0.0))


def test_a_step_of_no_length_goes_the_way_of_the_next_step():
    """A cut that begins where it stands has its first step's frame and depth."""
    run = rm.simulate(PROCESS)
    still = np.flatnonzero(run.path.cutting & (run.path.step_length == 0.0))
    assert len(still)
    for i in still:
        np.testing.assert_array_equal(run.R_MF[i], run.R_MF[i + 1])
        assert run.conditions.a_p[i] == pytest.approx(run.conditions.a_p[i + 1], rel=1e-9)


def test_joints_springs_and_an_added_sag_make_up_the_deviation_that_is_reported():
    links = LinkMasses(np.array([0.0, 0.0, 0.0, 10.0, 50.0]), np.zeros((5, 3)))
    added, told = (rm.simulate(SETUP.replace(links=links, add_sag=add)) for add in (True, False))
    for run in (added, told):
        record = simulation_record(run)
        parts = np.sum(record["joint_share_mm"], axis=0) + sum(map(np.array, record["spring_share_mm"].values()))
        sag = np.array(record["sag_mm"])
        assert np.linalg.norm(sag) > 0.1
        np.testing.assert_allclose(parts + record["sag_added"] * sag, record["deviation_mm"], atol=1e-9)
        columns = run.columns()
        assert columns["sag_z_mm"][run.worst] == pytest.approx(sag[2])
    assert [note.code for note in added.notes].count("sag") == 1
    assert "sag" not in [note.code for note in told.notes]
    assert simulation_record(rm.simulate(SETUP))["sag_mm"] is None
