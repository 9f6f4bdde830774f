"""Springs beside the joints: closed forms, brute-force elastostatics, energy, reciprocity."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robomill.compliance.cartesian import joint_contributions
from robomill.compliance.deflection import deflection
from robomill.compliance.spring import TYPED, extra_contributions
from robomill.compliance.springs import SPRINGS as KINDS
from robomill.compliance.springs.joint_bending import JointBending, bending_axes
from robomill.compliance.springs.spindle import SpindleSpring
from robomill.compliance.springs.tool_bending import ToolBending
from robomill.cutting.tool import Cutter
from robomill.errors import RobotError
from robomill.io.robot.robots import load_robot
from robomill.kinematics.forward import joint_frames, tool_pose
from robomill.kinematics.jacobian import geometric_jacobian
from tests.identification.cables import Arm

ROBOT = load_robot("slavkovic_5r")
RNG = np.random.default_rng(11)
THETA = RNG.uniform(-0.6, 0.6, (6, ROBOT.n))
SPRINGS = [
    ToolBending(8e-3, 40e-3),
    SpindleSpring(0.05e-6, 0.02e-6),
    *(JointBending(i, 3e-7 * i, 5e-7) for i in range(1, ROBOT.n + 1)),
]
FORCE = np.array([-63.0, 110.0, -23.0])


def test_cantilever_closed_form():
    tool = ToolBending(8e-3, 40e-3, core=1.0)
    by_hand = 0.04**3 / (3 * 600e9 * math.pi * 8e-3**4 / 64)
    delta = tool.contribution(joint_frames(ROBOT, THETA)) @ FORCE
    z = tool_pose(ROBOT, THETA)[:, :3, 2]
    across = FORCE - (z @ FORCE)[:, None] * z
    np.testing.assert_allclose(delta, by_hand * across, rtol=1e-12, atol=1e-18)
    assert ToolBending(8e-3, 40e-3).lateral == pytest.approx(by_hand / 0.8**4)


def test_spindle_is_soft_across_and_along_its_axis():
    spindle = SpindleSpring(0.05e-6, 0.02e-6)
    T_MT = tool_pose(ROBOT, THETA)
    expected = T_MT[:, :3, :3] @ np.diag([0.05e-6, 0.05e-6, 0.02e-6]) @ np.swapaxes(T_MT[:, :3, :3], 1, 2)
    np.testing.assert_allclose(spindle.contribution(joint_frames(ROBOT, THETA)), expected, atol=1e-20)


def chain_under(F, scale):
    """Tip of the arm when every joint and bending spring turns by C tau under scale * F: forward kinematics only.

    The torque about each axis is moment . axis at the unloaded arm; the turns are put between the joints as rotations.
    """
    tips = []
    for theta in THETA:
        frames = joint_frames(ROBOT, theta)
        tip = frames[-1, :3, 3]
        T = np.eye(4)
        for i in range(ROBOT.n):
            moment = np.cross(tip - frames[i, :3, 3], scale * F)
            torque = frames[i, :3, :3].T @ moment
            bend = SPRINGS[2 + i]
            turn = np.eye(4)
            angles = torque * [bend.C_x, bend.C_y, ROBOT.C_theta[i]]
            turn[:3, :3] = Rotation.from_rotvec(angles).as_matrix()
            T = T @ frames[i] @ turn @ np.linalg.inv(frames[i])
        tips.append((T @ frames[-1])[:3, 3])
    return np.array(tips)


def test_brute_force_elastostatics_with_a_quadratic_remainder():
    frames = joint_frames(ROBOT, THETA)
    C_joint = joint_contributions(geometric_jacobian(ROBOT, THETA)[..., :3, :], ROBOT.C_theta)
    C = C_joint.sum(-3) + extra_contributions(SPRINGS[2:], frames).sum(-3)
    linear = C @ FORCE
    remainders = []
    for scale in (1.0, 2.0, 4.0):
        moved = chain_under(FORCE, scale) - frames[:, -1, :3, 3]
        remainders.append(np.linalg.norm(moved - scale * linear))
        assert remainders[-1] < 0.01 * np.linalg.norm(scale * linear)
    order = np.log2(np.array(remainders[1:]) / remainders[:-1])
    np.testing.assert_allclose(order, 2.0, atol=0.05)


def test_energy_stored_equals_work_done():
    """Half F . delta of all springs = energy from each spring's own moment or force, computed apart."""
    frames = joint_frames(ROBOT, THETA)
    delta = deflection(extra_contributions(SPRINGS, frames), FORCE)
    assert delta.shape == (6, len(SPRINGS), 3)
    work = 0.5 * delta @ FORCE
    z = frames[:, -1, :3, 2]
    axial = z @ FORCE
    lateral = np.linalg.norm(FORCE - axial[:, None] * z, axis=1)
    tool, spindle = SPRINGS[:2]
    x, w = np.polynomial.legendre.leggauss(5)
    arm = 0.5 * tool.stick_out * (x + 1)
    EI = tool.E * math.pi / 64 * (tool.core * tool.diameter) ** 4
    bending = (lateral[:, None] * arm) ** 2 / (2 * EI) @ (0.5 * tool.stick_out * w)
    np.testing.assert_allclose(work[:, 0], bending, rtol=1e-12)
    springs = 0.5 * (spindle.lateral * lateral**2 + spindle.axial * axial**2)
    np.testing.assert_allclose(work[:, 1], springs, rtol=1e-12)
    for i, bend in enumerate(SPRINGS[2:]):
        moment = np.cross(frames[:, -1, :3, 3] - frames[:, i, :3, 3], FORCE)
        about = np.einsum("mji,mj->mi", frames[:, i, :3, :3], moment)
        np.testing.assert_allclose(work[:, 2 + i], 0.5 * about[:, :2] ** 2 @ [bend.C_x, bend.C_y], rtol=1e-10)


def test_reciprocity_and_no_spring_pushes_back():
    C = extra_contributions(SPRINGS, joint_frames(ROBOT, THETA))
    np.testing.assert_allclose(C, np.swapaxes(C, -1, -2), atol=1e-22)
    assert np.linalg.eigvalsh(C).min() > -1e-20
    f, g = RNG.normal(size=(2, 3))
    np.testing.assert_allclose(g @ (C @ f)[..., None], f @ (C @ g)[..., None], rtol=1e-9, atol=1e-18)


def test_batch_equals_loop_and_unreached_stays_nan():
    frames = joint_frames(ROBOT, THETA)
    batch = extra_contributions(SPRINGS, frames.reshape(2, 3, *frames.shape[1:]))
    assert batch.shape == (2, 3, len(SPRINGS), 3, 3)
    for i, theta in enumerate(THETA):
        for j, spring in enumerate(SPRINGS):
            np.testing.assert_allclose(
                batch[i // 3, i % 3, j], spring.contribution(joint_frames(ROBOT, theta)), rtol=1e-12, atol=1e-24
            )
    assert np.isnan(extra_contributions(SPRINGS, joint_frames(ROBOT, np.full(ROBOT.n, np.nan)))).all()
    assert extra_contributions([], frames).shape == (6, 0, 3, 3)


def test_names_are_lines_of_the_result():
    names = [spring.name for spring in SPRINGS]
    assert names[:4] == ["tool bending", "spindle and holder", "joint 1 bending", "joint 2 bending"]
    assert len(set(names)) == len(names)
    assert "E = 600 GPa" in ToolBending(8e-3, 40e-3).provenance.source
    steel = ToolBending(8e-3, 40e-3, E=210e9).provenance
    assert (steel.kind, "E = 2.1e+11 N/m^2" in steel.source) == ("user", True)


@pytest.mark.parametrize(
    ("build", "sentence"),
    [
        (lambda: ToolBending(0.0, 0.04), "Tool bending, Diameter: found 0 mm; expected more than 0 mm."),
        (lambda: ToolBending(8e-3, -0.04), "Stick-out: found −40 mm"),
        (lambda: ToolBending(8e-3, None), "Stick-out: found nothing"),
        (lambda: ToolBending(8e-3, 0.04, E=math.inf), "Young's modulus: found inf"),
        (lambda: ToolBending(8e-3, 0.04, core=1.5), "Bending Ø / Ø: found 1.5; expected more than 0 to 1."),
        (lambda: SpindleSpring(-1e-6), "Spindle and holder, Across: found −1 µm/N; expected 0 µm/N or more."),
        (lambda: SpindleSpring(0.05), "If 0.05 µm/N is meant"),
        (lambda: SpindleSpring(1e-7, 0.02), "If 0.02 µm/N is meant"),
        (lambda: ToolBending(8e-3, 0.04, E=600e3), "found 0.6 N/mm²; expected 1000 N/mm² to 2e+06 N/mm²"),
        (lambda: JointBending(0), "Joint: found 0; expected 1 or more."),
        (lambda: JointBending(2, C_y=-1e-7), "Joint 2 bending, about y: found −1 ×10⁻⁷ rad/(N m)"),
        (lambda: JointBending(9).contribution(joint_frames(ROBOT, THETA)), "there is no joint 9; the robot has 5"),
    ],
)
def test_refusals(build, sentence):
    with pytest.raises(RobotError) as refusal:
        build()
    assert sentence in str(refusal.value)


def test_edited_springs_say_who_typed_them_and_a_tool_follows_the_cutter():
    spindle = SpindleSpring(1e-7, 2e-7).edited(axial=3e-7)
    assert (spindle.lateral, spindle.axial, spindle.provenance) == (1e-7, 3e-7, TYPED)
    cutter = Cutter("flat", 10e-3, stick_out=25e-3)
    tool = ToolBending.first(Cutter("flat", 8e-3))
    assert (tool.diameter, tool.stick_out) == (8e-3, pytest.approx(32e-3))
    assert ToolBending.first(cutter).stick_out == 25e-3
    assert tool.edited(core=0.7).provenance.kind == "user"
    assert tool.edited(stick_out=20e-3).provenance == tool.provenance
    assert tool.fitted(cutter) == ToolBending(10e-3, tool.stick_out)
    assert spindle.fitted(cutter) is spindle
    by_hand = 0.032**3 / (3 * 600e9 * math.pi * (0.8 * 8e-3) ** 4 / 64)
    assert tool.facts == f"Ø 8.0 mm: {by_hand * 1e6:.4f} µm/N across the axis"
    assert SpindleSpring.first(cutter).facts.startswith("20 N/µm across and 50 N/µm along")
    assert 1 / SpindleSpring.first(cutter).lateral == pytest.approx(20e6)
    assert 1 / SpindleSpring.first(cutter).axial == pytest.approx(50e6)


def test_springs_are_found_in_their_order():
    """From the tip inwards; tool and spindle are light enough for the teeth, what bends a link moves the arm along."""
    assert list(KINDS) == ["tool_bending", "spindle", "joint_bending"]
    assert [name for name, kind in KINDS.items() if kind.each_joint] == ["joint_bending"]
    assert [name for name, kind in KINDS.items() if kind.follows_tooth] == ["tool_bending", "spindle"]
    assert [name for name, kind in KINDS.items() if kind.at_tip] == ["spindle"]


def test_turned_bending_axes_stay_with_the_link_after_the_joint():
    """Against the frame turned by its own matrix: modified D-H rows multiplied out, not the product's."""
    arm, robot = Arm.of("kuka_kr500"), load_robot("kuka_kr500")
    q = np.random.default_rng(0).uniform(-1.0, 1.0, 6)
    frames = joint_frames(robot, q)
    own = arm.frames(q)
    for joint in range(1, 6):
        C = JointBending(joint, 3e-7, 5e-7, turned=True).contribution(frames)
        turned, reach = own[joint - 1], frames[-1, :3, 3] - own[joint - 1][:3, 3]
        levers = [np.cross(turned[:3, axis], reach) for axis in (0, 1)]
        expected = 3e-7 * np.outer(levers[0], levers[0]) + 5e-7 * np.outer(levers[1], levers[1])
        np.testing.assert_allclose(C, expected, atol=1e-16)


@pytest.mark.parametrize("seed", range(5))
def test_axes_that_turn_with_a_joint_are_square_to_it_and_lie_as_the_next_frame_does(seed):
    """Frames turned at random: x is what is seen of the next x from above z; where that is along z, the next y."""
    frames = np.tile(np.eye(4), (5, 4, 1, 1))
    frames[..., :3, :3] = Rotation.random(20, random_state=seed).as_matrix().reshape(5, 4, 3, 3)
    frames[4, 2, :3, :3] = frames[4, 1, :3, :3] @ [
        [0, 1, 0],
        [0, 0, 1],
        [1, 0, 0],
    ]  # x of the third along z of the second
    for joint in (0, 1, 2):
        x, y = bending_axes(frames, joint, turned=True)
        z, after = frames[:, joint, :3, 2], frames[:, joint + 1, :3, :3]
        np.testing.assert_allclose(np.linalg.norm(x, axis=1), 1.0, atol=1e-12)
        np.testing.assert_allclose(np.linalg.det(np.stack([x, y, z], axis=-1)), 1.0, atol=1e-12)
        np.testing.assert_allclose(np.stack([x, y], axis=1) @ z[..., None], 0.0, atol=1e-12)
        for n in range(5):
            seen = after[n, :, 1] if (n, joint) == (4, 1) else after[n, :, 0]
            np.testing.assert_allclose(np.cross(z[n], np.cross(seen, z[n])), (seen @ x[n]) * x[n], atol=1e-12)
            assert seen @ x[n] > 0.0
        x, y = bending_axes(frames, joint, turned=False)
        np.testing.assert_array_equal(np.stack([x, y], axis=-1), frames[:, joint, :3, :2])


def test_the_last_joint_bends_about_axes_that_turn_with_the_tool():
    """Against twisting it by hand: a tool frame that is turned anyhow keeps the axes of the joint's own turn."""
    tool = np.eye(4)
    tool[:3, :3], tool[:3, 3] = Rotation.random(random_state=3).as_matrix(), (0.1, -0.05, 0.2)
    robot = ROBOT.replace(T_tool=tool)
    for theta in THETA:
        frames = joint_frames(robot, theta)
        z, seen = frames[-2, :3, 2], frames[-1, :3, 0]
        x = (seen - (seen @ z) * z) / np.linalg.norm(np.cross(seen, z))
        moved = []
        for axis, give in ((x, 3e-7), (np.cross(z, x), 5e-7)):
            arm = frames[-1, :3, 3] - frames[-2, :3, 3]
            turn = 1e3 * give * (np.cross(arm, FORCE) @ axis) * axis  # enlarged, for the digits
            moved.append((Rotation.from_rotvec(turn).apply(arm) - Rotation.from_rotvec(-turn).apply(arm)) / 2e3)
        C = JointBending(robot.n, 3e-7, 5e-7, turned=True).contribution(joint_frames(robot, theta))
        np.testing.assert_allclose(C @ FORCE, np.sum(moved, axis=0), rtol=1e-3, atol=1e-12)


def test_another_tool_sticks_out_as_it_says_or_as_much_more_as_it_is_longer():
    """Never less than its own diameter; a spindle gives the same whatever it holds."""
    stated = ToolBending(8e-3, 40e-3, E=500e9, core=0.7)
    for cutter, longer, stick_out in (
        (Cutter("flat", 10e-3), 15e-3, 55e-3),
        (Cutter("flat", 10e-3), -12e-3, 28e-3),
        (Cutter("flat", 10e-3), -35e-3, 10e-3),
        (Cutter("flat", 10e-3, stick_out=25e-3), 15e-3, 25e-3),
    ):
        found = stated.of_tool(cutter, longer)
        assert (found.diameter, found.E, found.core) == (10e-3, 500e9, 0.7)
        assert found.stick_out == pytest.approx(stick_out)
        spindle = SpindleSpring(1e-7)
        assert spindle.of_tool(cutter, longer) is spindle


def test_a_spring_doubts_what_no_spindle_and_no_other_cutter_is_like() -> None:
    thin, thick = Cutter("flat", diameter_mm=6, flutes=3), Cutter("flat", diameter_mm=10, flutes=3)
    assert SpindleSpring(5e-8, 2e-8).doubted([thin]) == ""
    assert SpindleSpring(5e-8, 6e-6).doubted([thin]).startswith("Spindle and holder: 6 µm/N")
    bending = ToolBending(10e-3, 30e-3)
    assert bending.doubted([thick]) == bending.doubted([thin, thick]) == ""
    assert "of a tool of 10 mm, and the cutter is 6 mm wide" in bending.doubted([thin])
    assert ToolBending(7.9e-3, 30e-3).doubted([thin]) == "", "three quarters of it are 5.9 mm"
