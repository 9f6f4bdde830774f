"""URDF import against Pinocchio on random serial chains, and its refusals."""

import numpy as np
import pytest

import robomill as rm
from robomill.errors import RobotError
from robomill.io.urdf import read_urdf


def urdf_text(rng, n, parallel=False):
    links = "".join(f'<link name="l{i}"/>' for i in range(n + 2))
    joints = ""
    for i in range(n):
        axis = np.eye(3)[rng.integers(3)] if parallel else rng.normal(size=3)
        rpy = rng.choice([0.0, np.pi / 2, -np.pi / 2], 3) if parallel else rng.uniform(-3, 3, 3)
        xyz = rng.uniform(-0.5, 0.5, 3)
        kind = "prismatic" if i == 1 and not parallel else "revolute"
        joints += (
            f'<joint name="j{i}" type="{kind}"><parent link="l{i}"/><child link="l{i + 1}"/>'
            f'<origin xyz="{xyz[0]} {xyz[1]} {xyz[2]}" rpy="{rpy[0]} {rpy[1]} {rpy[2]}"/>'
            f'<axis xyz="{axis[0]} {axis[1]} {axis[2]}"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>'
        )
    joints += (
        f'<joint name="tool" type="fixed"><parent link="l{n}"/><child link="l{n + 1}"/>'
        '<origin xyz="0.1 0.2 0.3" rpy="0.1 -0.2 0.3"/></joint>'
    )
    return f'<robot name="random">{links}{joints}</robot>'


@pytest.mark.parametrize("seed", range(6))
def test_urdf_agrees_with_pinocchio(tmp_path, seed):
    pin = pytest.importorskip("pinocchio")
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 8))
    text = urdf_text(rng, n, parallel=seed % 2 == 0)
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    robot = read_urdf(path)
    model = pin.buildModelFromXML(text)
    data = model.createData()
    frame = model.getFrameId(f"l{n + 1}")
    for theta in rng.uniform(-2, 2, (5, n)):
        pin.forwardKinematics(model, data, theta)
        pin.updateFramePlacements(model, data)
        np.testing.assert_allclose(rm.tool_pose(robot, theta), data.oMf[frame].homogeneous, atol=1e-12)
        J = pin.computeFrameJacobian(model, data, theta, frame, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        np.testing.assert_allclose(rm.geometric_jacobian(robot, theta), J, atol=1e-12)


def _write(tmp_path, body):
    path = tmp_path / "bad.urdf"
    path.write_text(f'<robot name="bad">{body}</robot>')
    return path


def _joint(name, parent, child, kind="revolute", limit='<limit lower="-1" upper="1" effort="1" velocity="1"/>'):
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}<axis xyz="0 0 1"/>{limit}</joint>'


LINKS = "".join(f'<link name="{c}"/>' for c in "abcd")


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (LINKS + _joint("1", "a", "b") + _joint("2", "b", "c") + _joint("3", "b", "d"), "branches at link 'b'"),
        (LINKS + _joint("1", "a", "b") + _joint("2", "c", "d"), "missing"),
        (LINKS + _joint("1", "a", "b") + _joint("2", "b", "c") + _joint("3", "a", "c"), "closed loop"),
        (LINKS + _joint("1", "a", "b") + _joint("2", "b", "x"), "'x'"),
        (LINKS[: LINKS.index("c") - 12] + _joint("1", "a", "b", "fixed"), "no moving joints"),
        (LINKS + _joint("1", "a", "b") + _joint("2", "b", "c", "floating") + _joint("3", "c", "d"), "floating"),
        (LINKS + _joint("1", "a", "b", limit="") + _joint("2", "b", "c") + _joint("3", "c", "d"), "no limits"),
    ],
)
def test_refusals_in_one_sentence(tmp_path, body, words):
    with pytest.raises(RobotError, match=words) as error:
        read_urdf(_write(tmp_path, body))
    assert str(error.value).startswith("bad.urdf:")


def test_a_named_tip_picks_the_branch(tmp_path):
    body = LINKS + _joint("1", "a", "b") + _joint("2", "b", "c") + _joint("3", "b", "d")
    assert read_urdf(_write(tmp_path, body), tip="d").n == 2


def test_not_xml(tmp_path):
    path = tmp_path / "noise.urdf"
    path.write_bytes(b"\x00\x01 not xml")
    with pytest.raises(RobotError, match="not a URDF"):
        read_urdf(path)
