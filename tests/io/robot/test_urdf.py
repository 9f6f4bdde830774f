"""URDF import against Pinocchio on random serial chains, and its refusals."""

import numpy as np
import pytest

import robomill as rm
from robomill.errors import RobotError
from robomill.io.robot.urdf import dh_from_axes, read_urdf


def tip_along(axis):
    """Roll, pitch and yaw of a frame whose z is ``axis``."""
    x = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    x /= np.linalg.norm(x)
    R = np.column_stack([x, np.cross(axis, x), axis])
    return np.arctan2(R[2, 1], R[2, 2]), -np.arcsin(R[2, 0]), np.arctan2(R[1, 0], R[0, 0])


def urdf_text(rng, n, parallel=False, flange=0):
    """A random chain; with ``flange`` 1 or -1 the tip's z is the last joint's axis, or against it."""
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
    roll, pitch, yaw = tip_along(flange * axis / np.linalg.norm(axis)) if flange else (0.1, -0.2, 0.3)
    joints += (
        f'<joint name="tool" type="fixed"><parent link="l{n}"/><child link="l{n + 1}"/>'
        f'<origin xyz="0.1 0.2 0.3" rpy="{roll} {pitch} {yaw}"/></joint>'
    )
    return f'<robot name="random">{links}{joints}</robot>'


@pytest.mark.parametrize("flange", [0, 1, -1])
@pytest.mark.parametrize("seed", range(6))
def test_urdf_agrees_with_pinocchio(tmp_path, seed, flange):
    pin = pytest.importorskip("pinocchio")
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 8))
    text = urdf_text(rng, n, parallel=seed % 2 == 0, flange=flange)
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


def test_of_two_links_at_the_end_one_is_not_taken_by_chance(tmp_path):
    links = "".join(f'<link name="{c}"/>' for c in "abc")
    arm = links + _joint("1", "a", "b") + _joint("2", "b", "c")

    def end(name, xyz):
        joins = f'<parent link="c"/><child link="{name}"/><origin xyz="{xyz}"/>'
        return f'<link name="{name}"/><joint name="to_{name}" type="fixed">{joins}</joint>'

    both = _write(tmp_path, arm + end("probe", "0 0 0.1") + end("cutter", "0 0.2 0"))
    with pytest.raises(
        RobotError, match=r"several links are fixed to the last that moves \(probe, cutter\); say which"
    ):
        read_urdf(both)
    theta = [0.0, 0.0]
    np.testing.assert_allclose(rm.tool_pose(read_urdf(both, tip="cutter"), theta)[:3, 3], [0.0, 0.2, 0.0], atol=1e-12)
    standard = read_urdf(_write(tmp_path, arm + end("probe", "0 0 0.1") + end("tool0", "0.3 0 0")))
    np.testing.assert_allclose(rm.tool_pose(standard, theta)[:3, 3], [0.3, 0.0, 0.0], atol=1e-12)
    same = read_urdf(_write(tmp_path, arm + end("probe", "0 0 0.1") + end("flange", "0 0 0.1")))
    np.testing.assert_allclose(rm.tool_pose(same, theta)[:3, 3], [0.0, 0.0, 0.1], atol=1e-12)


def test_not_xml(tmp_path):
    path = tmp_path / "noise.urdf"
    path.write_bytes(b"\x00\x01 not xml")
    with pytest.raises(RobotError, match="not a text file; expected a robot"):
        read_urdf(path)


def test_the_tip(tmp_path):
    body = LINKS + _joint("1", "a", "b") + _joint("2", "b", "c") + _joint("3", "c", "d")
    path = _write(tmp_path, body)
    assert read_urdf(path).n == 3
    assert read_urdf(path).name == "bad"
    assert read_urdf(path).title == "bad (from URDF)"
    assert read_urdf(path, tip="c").n == 2
    with pytest.raises(RobotError, match=r"bad.urdf: has no link 'x'; its links are a, b, c, d"):
        read_urdf(path, tip="x")
    with pytest.raises(RobotError, match="a robot needs 1 to 7"):
        read_urdf(path, tip="a")
    with pytest.raises(RobotError, match=r"none.urdf: cannot be opened"):
        read_urdf(tmp_path / "none.urdf")


def test_a_ring_of_joints_is_refused(tmp_path):
    ring = LINKS + _joint("1", "a", "b") + _joint("2", "b", "c") + _joint("3", "c", "a") + _joint("4", "b", "d")
    with pytest.raises(RobotError, match="joints '2', '3', '1' lead back to link 'b', a closed loop"):
        read_urdf(_write(tmp_path, ring), tip="d")


@pytest.mark.parametrize(
    ("joints", "said"),
    [
        (
            _joint("1", "a", "b") + _joint("2", "c", "d") + _joint("3", "d", "c"),
            "joints '3', '2' lead back to link 'd'",
        ),
        (_joint("1", "a", "b") + _joint("2", "c", "c"), "joint '2' leads back to link 'c', a closed loop"),
        (_joint("1", "a", "b") + _joint("1", "b", "c") + _joint("3", "c", "d"), "2 joints are called '1'"),
        ('<link name="b"/>' + _joint("1", "a", "b"), "2 links are called 'b'; give each a name of its own"),
    ],
)
def test_rings_beside_the_arm_and_names_that_are_there_twice_are_refused(tmp_path, joints, said):
    """A ring that hangs on nothing was dropped without a word, and of two joints of one name nobody knew which."""
    with pytest.raises(RobotError, match=said):
        read_urdf(_write(tmp_path, LINKS + joints), tip="b")


def test_a_branch_of_fixed_parts_is_no_branch(tmp_path):
    links = LINKS + '<link name="camera"/><link name="lens"/>'
    camera = _joint("4", "b", "camera", "fixed") + _joint("5", "camera", "lens", "fixed")
    robot = read_urdf(
        _write(tmp_path, links + camera + _joint("1", "a", "b") + _joint("2", "b", "c") + _joint("3", "c", "d"))
    )
    assert robot.n == 3
    turned = (
        links
        + _joint("4", "b", "camera", "fixed")
        + _joint("5", "camera", "lens")
        + _joint("1", "a", "b")
        + _joint("2", "b", "c")
    )
    with pytest.raises(RobotError, match="branches at link 'b' into 'camera', 'c'"):
        read_urdf(_write(tmp_path, turned + _joint("3", "c", "d")))


def test_limits_compliances_and_where_they_come_from(tmp_path):
    body = LINKS + _joint("1", "a", "b", "continuous", "") + _joint("2", "b", "c", "prismatic") + _joint("3", "c", "d")
    robot = read_urdf(_write(tmp_path, body))
    np.testing.assert_allclose(robot.limits, [[-np.pi, np.pi], [-1, 1], [-1, 1]])
    np.testing.assert_array_equal(robot.prismatic, [False, True, False])
    np.testing.assert_array_equal(robot.C_theta, [1e-6] * 3)
    assert robot.provenance["compliance"].kind == "assumed"
    assert {robot.provenance[block].source for block in ("geometry", "limits", "base", "tool")} == {
        "URDF file bad.urdf"
    }


@pytest.mark.parametrize(
    ("joint", "words"),
    [
        (_joint("2", "b", "c").replace('<axis xyz="0 0 1"/>', '<axis xyz="0 0 0"/>'), "joint '2' has a zero axis"),
        (_joint("2", "b", "c").replace("<axis", '<mimic joint="1"/><axis'), "joint '2' mimics another"),
    ],
)
def test_joints_that_cannot_be_read(tmp_path, joint, words):
    with pytest.raises(RobotError, match=words):
        read_urdf(_write(tmp_path, LINKS + _joint("1", "a", "b") + joint + _joint("3", "c", "d")))


def test_the_axis_is_made_a_unit_vector_and_is_x_where_none_is_given(tmp_path):
    long = _joint("2", "b", "c").replace("0 0 1", "0 0 7")
    bare = _joint("3", "c", "d").replace('<axis xyz="0 0 1"/>', "")
    robot = read_urdf(_write(tmp_path, LINKS + _joint("1", "a", "b") + long + bare))
    J = rm.geometric_jacobian(robot, [0.0, 0.0, 0.0])
    np.testing.assert_allclose(J[3:], [[0, 0, 1], [0, 0, 0], [1, 1, 0]], atol=1e-12)


def test_the_length_goes_from_axis_to_axis():
    """Two parallel, two crossing and two skew axes: a, alpha and d as the modified table defines them."""
    k = np.array([[0, 0, 1], [0, 0, 1], [0, 1, 0], [1, 0, 0]], dtype=float)
    p = np.array([[0, 0, 0], [0.5, 0, 0.2], [0.5, 0, 0.7], [0.5, 0.3, 1.1]])
    tip = np.eye(4)
    tip[:3, 3] = p[-1]
    table = dh_from_axes(k, p, tip)
    np.testing.assert_allclose(table["a"], [0, 0.5, 0, 0.4], atol=1e-12)
    np.testing.assert_allclose(np.abs(table["alpha"]), [0, 0, np.pi / 2, np.pi / 2], atol=1e-12)
    np.testing.assert_allclose(table["d"], [0, 0.7, 0.3, 0], atol=1e-12)
    for T in (table["T_base"], table["T_tool"]):
        np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-15)


@pytest.mark.parametrize("way", [1, -1])
def test_the_flange_is_the_tip_on_the_last_axis(tmp_path, way):
    """As robot makers draw it: the last joint turns about x or -x, and the flange's z is that x, 80 mm further out."""
    last = _joint("2", "b", "c").replace("0 0 1", f"{way} 0 0")
    tip = (
        '<joint name="tip" type="fixed"><parent link="d"/><child link="e"/>'
        '<origin xyz="0.08 0 0" rpy="3.141592653589793 -1.5707963267948966 0"/></joint>'
    )
    third = _joint("3", "c", "d").replace("0 0 1", f"{way} 0 0")
    body = LINKS + '<link name="e"/>' + _joint("1", "a", "b") + last + third + tip
    robot = read_urdf(_write(tmp_path, body))
    np.testing.assert_allclose(robot.T_tool, np.eye(4), atol=1e-12)
    J = rm.geometric_jacobian(robot, [0.3, 0.0, 0.0])
    np.testing.assert_allclose(J[3:, 2], way * np.array([np.cos(0.3), np.sin(0.3), 0.0]), atol=1e-12)


@pytest.mark.parametrize(
    ("find", "put", "words"),
    [
        ('axis xyz="0 0 1"', 'axis xyz="0 1"', "joint '1' has axis xyz='0 1'; expected 3 numbers"),
        ('axis xyz="0 0 1"', 'axis xyz="0 0 1_0"', "joint '1' has axis xyz='0 0 1_0'; expected 3 numbers"),
        ('axis xyz="0 0 1"', 'axis xyz="0 0 up"', "joint '1' has axis xyz='0 0 up'; expected 3 numbers"),
        ('lower="-1"', 'lower="-1 2"', "joint '1' has limit lower='-1 2'; expected a number"),
        ('upper="1"', 'upper="inf"', "joint '1' has limit upper='inf'; expected a number"),
        ('<robot name="bad">', '<!DOCTYPE robot><robot name="bad">', "no <!DOCTYPE> and no entities"),
        ("robot", "arm", "found <arm>, expected <robot>"),
        ("</robot>", "", "this is not a URDF that can be read"),
    ],
)
def test_what_is_written_wrong_is_refused_with_what_is_expected(tmp_path, find, put, words):
    path = _write(tmp_path, LINKS + _joint("1", "a", "b") + _joint("2", "b", "c") + _joint("3", "c", "d"))
    text = path.read_text()
    path.write_text(text.replace(find, put) if find == "robot" else text.replace(find, put, 1))
    with pytest.raises(RobotError) as refused:
        read_urdf(path)
    assert words in str(refused.value)


@pytest.mark.parametrize(("count", "words"), [(7, ""), (8, "found 8"), (20, "found 20"), (21, "has 21 moving joints")])
def test_an_arm_has_seven_joints_at_most(tmp_path, count, words):
    links = "".join(f'<link name="l{i}"/>' for i in range(count + 1))
    joints = "".join(_joint(str(i), f"l{i}", f"l{i + 1}") for i in range(count))
    path = _write(tmp_path, links + joints)
    if words:
        with pytest.raises(RobotError, match=words):
            read_urdf(path)
    else:
        assert read_urdf(path).n == 7


def test_neighbouring_frames_lie_on_the_common_perpendicular_of_their_axes():
    """Two axes that pass each other: by the D-H convention x goes from one to the next, a is their distance."""
    k = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
    for away in (0.3, -0.3):
        p = np.array([[0.0, 0.0, 0.1], [away, 0.5, 0.4]])  # they pass at height 0.4, ``away`` apart along x
        T_MT = np.eye(4)
        T_MT[:3, 3] = [away, 0.9, 0.4]
        T_MT[:3, :3] = np.column_stack([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])  # z along the last axis
        dh = dh_from_axes(k, p, T_MT)
        assert dh["a"][1] == pytest.approx(0.3)
        np.testing.assert_allclose(
            dh["T_base"], [[np.sign(away), 0, 0, 0], [0, np.sign(away), 0, 0], [0, 0, 1, 0.4], [0, 0, 0, 1]], atol=1e-15
        )
        np.testing.assert_allclose(dh["T_tool"], np.eye(4), atol=1e-15)
        assert np.abs(dh["alpha"][1]) == pytest.approx(np.pi / 2)
        assert dh["d"][1] == pytest.approx(0.9)
