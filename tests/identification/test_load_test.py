"""Load tests as values: shapes, defaults and refusals by row; poses counted by brute force."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.errors import LoadTestError
from robomill.identification.configurations import LIMIT_SLACK
from robomill.identification.load_test import JointTests, LoadTests

ROBOT = rm.load_robot("slavkovic_5r")
RNG = np.random.default_rng(2)
THETA = RNG.uniform(ROBOT.limits[:, 0], ROBOT.limits[:, 1], (6, 5))
F = RNG.normal(size=(6, 3)) * 100
MOVED = RNG.normal(size=(6, 3)) * 1e-4


def test_what_is_left_out_is_filled_in():
    tests = LoadTests(F, MOVED, theta=THETA)
    np.testing.assert_array_equal(tests.wrench, np.column_stack([F, np.zeros((6, 3))]))
    np.testing.assert_array_equal(tests.displacement[:, :3], MOVED)
    assert np.isnan(tests.displacement[:, 3:]).all()
    np.testing.assert_array_equal(tests.row, range(1, 7))
    assert not tests.force_point.any()
    assert tests.measuring_point.shape == (6, 3)
    assert np.isnan(tests.noise).all()
    given = LoadTests(F, MOVED, theta=THETA, noise=2e-6, force_point=[0, 0, 0.1], measuring_point=np.ones((6, 3)))
    np.testing.assert_array_equal(given.noise, [2e-6] * 6)
    np.testing.assert_array_equal(given.force_point, np.tile([0, 0, 0.1], (6, 1)))
    full = LoadTests(np.ones((6, 6)), np.ones((6, 6)), theta=THETA)
    assert (full.wrench == 1).all()
    assert full.provenance.kind == "measured"


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"wrench": F[:0], "displacement": MOVED[:0], "theta": THETA[:0]}, "no test"),
        ({"row": [1, 2]}, "6 row numbers"),
        ({"theta": None}, "one of the two"),
        ({"x_M": np.zeros((6, 5))}, "one of the two"),
        ({"theta": THETA[:4]}, "theta: expected one pose for each of the 6"),
        ({"theta": THETA[0]}, "theta: expected one pose"),
        ({"theta": None, "x_M": np.zeros((6, 7))}, "x_M: expected one pose"),
        ({"displacement": MOVED[:3]}, "displacement: expected shape"),
        ({"wrench": F[:, :2]}, "wrench: expected shape"),
        ({"wrench": F[0]}, "wrench: expected shape"),
        ({"force_point": np.zeros((4, 3))}, "force_point: expected shape"),
        ({"wrench": np.where(np.arange(6)[:, None] == 2, np.nan, F)}, "Row 3, wrench"),
        ({"theta": np.where(np.arange(6)[:, None] == 4, np.inf, THETA)}, "Row 5, theta"),
        ({"displacement": np.where(np.arange(6)[:, None] == 1, np.inf, MOVED)}, "Row 2, displacement"),
        ({"wrench": np.where(np.arange(6)[:, None] == 3, 0.0, F)}, "Row 4: the force is zero"),
        ({"displacement": np.where(np.arange(6)[:, None] == 5, np.nan, MOVED)}, "Row 6: no displacement"),
    ],
)
def test_refusals_name_the_row(fields, words):
    with pytest.raises(LoadTestError, match=words):
        LoadTests(**{"wrench": F, "displacement": MOVED, "theta": THETA, **fields})


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"noise": np.full((6, 3), 1e-6)}, r"noise: expected one number or shape \(6,\), found \(6, 3\)"),
        ({"gauges": np.eye(3)}, r"gauges: expected shape \(6, 3, 3\), three directions a test, found \(3, 3\)"),
        ({"gauges": np.ones((6, 3, 3))}, "Row 1, gauge 1: found a direction of length 1.73, expected a unit vector"),
        ({"pulley": np.zeros((5, 3))}, r"pulley: expected shape \(3,\) or shape \(6, 3\), found \(5, 3\)"),
        ({"displacement": np.ma.masked_less(MOVED, 0.0)}, "displacement: expected numbers, found a masked entry"),
        ({"wrench": F + 0j}, "wrench: expected numbers, found"),
        ({"wrench": F * 1e300}, "Row 1, wrench: found a number beyond any measurement"),
    ],
)
def test_arrays_that_numpy_would_take_are_refused_in_a_sentence(fields, words):
    """A masked reading is none, two millimetres along (1, 1, 1) are not read along a unit vector."""
    with pytest.raises(LoadTestError, match=words):
        LoadTests(**{"wrench": F, "displacement": MOVED, "theta": THETA} | fields)


def test_gauges_that_read_nothing_may_point_anywhere():
    along, read = np.broadcast_to(np.eye(3), (6, 3, 3)).copy(), MOVED.copy()
    along[:, 2], read[:, 2] = 0.0, np.nan
    assert LoadTests(F, read, theta=THETA, gauges=along).gauges is not None


def test_a_partly_measured_displacement_and_a_pure_moment_are_tests():
    half = MOVED.copy()
    half[2, :2] = np.nan
    kept = LoadTests(F, half, theta=THETA).displacement
    np.testing.assert_array_equal(np.isfinite(kept).sum(axis=1), [3, 3, 1, 3, 3, 3])
    assert kept[2, 2] == MOVED[2, 2]
    wrench = np.zeros((6, 6))
    wrench[:, 4] = 10.0
    np.testing.assert_array_equal(LoadTests(wrench, MOVED, theta=THETA).wrench, wrench)


def test_selecting_joining_and_leaving_out():
    tests = LoadTests(F, MOVED, theta=THETA, row=np.arange(6) + 10)
    np.testing.assert_array_equal(tests.without([11, 14]).wrench, tests.wrench[[0, 2, 3, 5]])
    np.testing.assert_array_equal(tests.without([11, 14]).row, [10, 12, 13, 15])
    chosen = tests.select([4, 0])
    np.testing.assert_array_equal(chosen.theta, THETA[[4, 0]])
    assert chosen.x_M is None
    both = chosen.joined(tests)
    np.testing.assert_array_equal(both.displacement[:, :3], MOVED[[4, 0, 0, 1, 2, 3, 4, 5]])
    np.testing.assert_array_equal(both.row, range(1, 9))
    world = LoadTests(F, MOVED, x_M=np.tile([0, -1.3, 0, 0, 0], (6, 1)))
    for one, other in ((tests, world), (world, tests)):
        with pytest.raises(LoadTestError, match="cannot be joined"):
            one.joined(other)
    with pytest.raises(LoadTestError, match="with_joints"):
        world.tool_poses(ROBOT)
    np.testing.assert_allclose(tests.tool_poses(ROBOT), rm.tool_pose(ROBOT, THETA))
    turned = LoadTests(F, MOVED, x_M=np.tile([0, -1.3, 0, 0, 0, 0.2], (6, 1)))
    for some, told in ((tests, {}), (world, {}), (turned, {"frame": "tool", "angles": "robomill"})):
        assert {name: some.to_dataframe().attrs[name] for name in told} == told
        assert ("frame" in some.to_dataframe().attrs) == bool(told)


def test_poses_are_counted_as_by_comparing_each_with_each():
    theta = THETA[[0, 3, 0, 1, 3, 2, 0]]
    theta[2] += 3e-10
    theta[6] += 1e-6
    tests = LoadTests(np.ones((7, 3)), np.ones((7, 3)), theta=theta)
    index = tests.pose_index()
    same = np.abs(theta[:, None] - theta).max(axis=-1) < 1e-9
    np.testing.assert_array_equal(index[:, None] == index, same)
    np.testing.assert_array_equal(np.unique(index), range(5))
    for column in range(5):
        theta = np.repeat(THETA[:1], 4, axis=0)
        theta[[1, 3], column] += 0.1
        index = LoadTests(np.ones((4, 3)), np.ones((4, 3)), theta=theta).pose_index()
        np.testing.assert_array_equal(index[:, None] == index, np.abs(theta[:, None] - theta).max(axis=-1) < 1e-9)
    zero = LoadTests(np.ones((2, 3)), np.ones((2, 3)), x_M=[[0.0, -1.3, 0, 0, 0], [-0.0, -1.3, -1e-12, 0, 0]])
    np.testing.assert_array_equal(zero.pose_index(), [0, 0])


def test_world_poses_are_solved_once_each_and_said():
    x_M = np.array([[0.1, -1.3, 0, 0, 0], [0, -1.2, 0.05, 0.1, 0], [0.1, -1.3, 0, 0, 0]])
    solved = LoadTests(F[:3], MOVED[:3], x_M=x_M).with_joints(ROBOT)
    assert solved.x_M is None
    np.testing.assert_allclose(rm.world_from_pose(rm.tool_pose(ROBOT, solved.theta)), x_M, atol=1e-9)
    assert [(f.level, f.code) for f in solved.findings] == [("info", "joints-solved")]
    six = rm.load_robot("kuka_kr500")
    home = rm.world_from_pose(rm.tool_pose(six, six.home))
    found = LoadTests(F[:1], MOVED[:1], x_M=home[None]).with_joints(six).findings
    assert [(f.level, f.code) for f in found] == [("warning", "turn-about-the-tool")]
    far = x_M.copy()
    far[1, 1] = -9.0
    with pytest.raises(LoadTestError, match=r"Row 2: the pose X, Y, Z = 0\.0, −9000\.0, 50\.0 mm is not reached"):
        LoadTests(F[:3], MOVED[:3], x_M=far).with_joints(ROBOT)


@pytest.mark.parametrize("side", [0, 1])
def test_limits_hold_but_for_the_rounding_of_a_written_angle(side):
    theta = THETA.copy()
    outwards = (-1, 1)[side]
    theta[3, 2] = ROBOT.limits[2, side] + outwards * 0.9 * LIMIT_SLACK
    tests = LoadTests(F, MOVED, theta=theta)
    assert tests.with_joints(ROBOT) is tests
    theta[3, 2] = ROBOT.limits[2, side] + outwards * 1.1 * LIMIT_SLACK
    with pytest.raises(LoadTestError, match="Row 4, theta3"):
        LoadTests(F, MOVED, theta=theta).with_joints(ROBOT)
    with pytest.raises(LoadTestError, match="4 joint columns for a robot of 5"):
        LoadTests(F, MOVED, theta=theta[:, :4]).with_joints(ROBOT)
    assert LIMIT_SLACK == pytest.approx(np.radians(0.0005), rel=0.2), "half of the third decimal of a degree"


def test_joint_tests_are_checked_row_by_row():
    joint, torque = np.array([1, 2, 3]), np.array([10.0, -20, 30])
    tests = JointTests(joint, torque, torque * 1e-6, row=np.array([4, 5, 6]))
    assert len(tests) == 3
    assert np.isnan(tests.noise).all()
    assert tests.provenance.kind == "measured"
    np.testing.assert_array_equal(JointTests(joint, torque, torque, noise=1e-6).noise, [1e-6] * 3)
    np.testing.assert_array_equal(JointTests(joint, torque, torque).row, [1, 2, 3])
    left = tests.without([5])
    np.testing.assert_array_equal(left.joint, [1, 3])
    np.testing.assert_array_equal(left.torque, [10, 30])
    np.testing.assert_allclose(left.angle, [1e-5, 3e-5])
    np.testing.assert_array_equal(left.row, [4, 6])
    with pytest.raises(LoadTestError, match="no test"):
        JointTests(joint[:0], torque[:0], torque[:0])
    with pytest.raises(LoadTestError, match="Row 2: the torque is zero"):
        JointTests(joint, np.array([2.0, 0, 2]), torque)
    for bad in (np.array([1.0, np.nan, 1]), np.ones(2)):
        with pytest.raises(LoadTestError, match="angle: expected 3 finite"):
            JointTests(joint, torque, bad)


def test_gauges_that_nothing_read_have_no_columns():
    """In mm; the second gauge reads along X from the third test on, the third one never."""
    read = np.full((6, 3), np.nan)
    read[:, 0], read[2:, 1] = 1e-6 * np.arange(6), 4e-6
    along = np.tile(np.eye(3)[[2, 0, 1]], (6, 1, 1))
    columns = LoadTests(F, read, theta=THETA, gauges=along).columns()
    assert [name for name in columns if name.startswith("reading")] == ["reading1_mm", "reading2_mm"]
    np.testing.assert_allclose(columns["reading1_mm"], 1e-3 * np.arange(6))
    np.testing.assert_allclose(columns["reading2_mm"], [np.nan, np.nan, *[4e-3] * 4])
    assert [columns[f"gauge2_{axis}"].tolist() for axis in "xyz"] == [[1.0] * 6, [0.0] * 6, [0.0] * 6]


def test_the_columns_of_tests_are_the_tests_again():
    """Read as the file that they make, and number by number where each unit is one of its own."""
    wrench = np.column_stack([F, np.linspace(-3.0, 4.0, 18).reshape(6, 3)])
    moved = np.column_stack([MOVED, 1e-4 * np.arange(18.0).reshape(6, 3)])
    points = RNG.normal(size=(2, 6, 3)) * 0.1
    tests = LoadTests(
        wrench, moved, theta=THETA, force_point=points[0], measuring_point=points[1], noise=np.full(6, 3e-6)
    )
    table = tests.columns()
    np.testing.assert_allclose(np.transpose([table[f"theta{j}_deg"] for j in range(1, 6)]), np.rad2deg(THETA))
    for names, values in (
        ("F{}_N", F),
        ("M{}_Nm", wrench[:, 3:]),
        ("d{}_mm", MOVED * 1e3),
        ("r{}_mrad", moved[:, 3:] * 1e3),
        ("FP{}_mm", points[0] * 1e3),
        ("MP{}_mm", points[1] * 1e3),
    ):
        np.testing.assert_allclose(np.transpose([table[names.format(axis)] for axis in "xyz"]), values, err_msg=names)
    np.testing.assert_allclose(table["noise_um"], 3.0)
    text = "\n".join(
        [
            ",".join(table),
            *(
                ",".join("" if np.isnan(v) else repr(float(v)) for v in row)
                for row in zip(*table.values(), strict=True)
            ),
        ]
    )
    again = rm.read_load_tests(text, ROBOT)
    for name in ("wrench", "displacement", "theta", "force_point", "measuring_point", "noise"):
        np.testing.assert_allclose(getattr(again, name), getattr(tests, name), rtol=1e-9, atol=1e-15, err_msg=name)
    plain = LoadTests(F, MOVED, theta=THETA).columns()
    assert list(plain) == [
        *(f"theta{j}_deg" for j in range(1, 6)),
        *(f"F{a}_N" for a in "xyz"),
        *(f"d{a}_mm" for a in "xyz"),
    ]


def test_world_poses_and_pulleys_have_columns_of_their_own():
    x_M = np.array([[0.1, -1.3, 0.05, 0.2, -0.1, 0.4], [0.0, -1.2, 0.0, 0.0, 0.1, 0.0]])
    pulley = np.array([[2.0, 0.0, 1.0], [0.0, -3.0, 0.5]])
    table = LoadTests(F[:2], MOVED[:2], x_M=x_M, pulley=pulley).columns()
    np.testing.assert_allclose(np.transpose([table[f"{a}_mm"] for a in "XYZ"]), x_M[:, :3] * 1e3)
    np.testing.assert_allclose(np.transpose([table[f"{a}_deg"] for a in "ABC"]), np.rad2deg(x_M[:, 3:]))
    np.testing.assert_allclose(table["load_N"], np.sqrt((F[:2] ** 2).sum(axis=1)))
    np.testing.assert_allclose(np.transpose([table[f"pulley_{a}_mm"] for a in "xyz"]), pulley * 1e3)
    assert "Fx_N" not in table
    mixed = LoadTests(F[:2], MOVED[:2], x_M=x_M, pulley=np.where(np.arange(2)[:, None] == 0, pulley, np.nan)).columns()
    assert "pulley_x_mm" not in mixed
    np.testing.assert_allclose(mixed["Fx_N"], F[:2, 0])


@pytest.mark.parametrize("most", range(1, 9))
def test_thinned_tests_are_evenly_chosen_and_no_more_than_asked(most):
    rows = LoadTests(F, MOVED, theta=THETA).thinned(most).row
    assert 0 < len(rows) <= most
    assert rows[0] == 1
    assert len(set(np.diff(rows))) <= 1
    closer = np.diff(rows)[0] - 1 if len(rows) > 1 else 5
    assert closer == 0 or len(range(0, 6, closer)) > most, "one taken closer together would be too many"


def test_a_cable_pulls_from_the_force_point_to_its_pulley_however_the_point_is_moved():
    pulley = np.tile([2.0, -2.0, 1.0], (6, 1))
    tests = LoadTests(F, MOVED, theta=THETA, pulley=pulley, force_point=[0.0, 0.02, 0.1])
    for shift in (np.zeros(3), np.array([0.05, -0.1, 0.02])):
        moved = tests.moved(ROBOT, shift)
        for n, T in enumerate(rm.tool_pose(ROBOT, THETA)):
            way = pulley[n] - (T @ [*(np.array([0.0, 0.02, 0.1]) + shift), 1.0])[:3]
            pull = moved.wrench[n, :3]
            np.testing.assert_allclose(np.cross(pull, way), 0.0, atol=1e-9)
            assert pull @ way > 0.0
            assert np.linalg.norm(pull) == pytest.approx(np.linalg.norm(F[n]))


def test_readings_of_three_gauges_make_the_vector_that_they_read():
    gauges = np.linalg.qr(RNG.normal(size=(6, 3, 3)))[0] + 0.2 * RNG.normal(size=(6, 3, 3))
    gauges /= np.linalg.norm(gauges, axis=2, keepdims=True)
    gauges[4, 2] = gauges[4, 1]
    read = np.einsum("mgi,mi->mg", gauges, MOVED)
    read[2, 1] = np.nan
    found = LoadTests(F, read, theta=THETA, gauges=gauges).vectors
    np.testing.assert_allclose(found[[0, 1, 3, 5]], MOVED[[0, 1, 3, 5]], rtol=1e-9)
    assert np.isnan(found[[2, 4]]).all()


def test_columns_of_single_joints_are_torque_and_angle():
    table = JointTests([1, 3], [300.0, -20.0], [2.1e-4, 3e-5], noise=2e-6).columns()
    assert {name: np.round(values, 9).tolist() for name, values in table.items()} == {
        "joint": [1, 3],
        "torque_Nm": [300.0, -20.0],
        "angle_mrad": [0.21, 0.03],
        "noise_mrad": [0.002, 0.002],
    }
    assert "noise_mrad" not in JointTests([1], [300.0], [2.1e-4]).columns()


@pytest.mark.parametrize(("length", "taken"), [(1.015, True), (0.985, True), (1.025, False), (0.975, False)])
def test_a_written_direction_may_be_as_long_as_its_rounding_leaves_it(length, taken):
    """Two digits behind the point, of three components: within some 0.01 of a unit vector."""
    along = np.tile(np.eye(3), (6, 1, 1))
    along[3, 1] *= length
    if taken:
        assert LoadTests(F, MOVED, theta=THETA, gauges=along).gauges is not None
        return
    with pytest.raises(LoadTestError, match=f"Row 4, gauge 2: found a direction of length {length:.3g}"):
        LoadTests(F, MOVED, theta=THETA, gauges=along)


def test_forces_that_are_aimed_at_no_pulley_stay_as_they_are_where_the_point_moves():
    """Of six rows two have no pulley, and one of them only half of one."""
    pulley = np.tile([2.0, -2.0, 1.0], (6, 1))
    pulley[1], pulley[4, 2] = np.nan, np.nan
    tests = LoadTests(F, MOVED, theta=THETA, pulley=pulley)
    moved = tests.moved(ROBOT, np.array([0.05, -0.1, 0.02]))
    np.testing.assert_array_equal(np.isclose(moved.wrench[:, :3], F).all(axis=1), np.isin(range(6), [1, 4]))
    np.testing.assert_allclose(moved.force_point, np.tile([0.05, -0.1, 0.02], (6, 1)))
    assert not moved.wrench[:, 3:].any()


def test_rotations_beside_gauges_have_columns_of_their_own():
    """Three gauges and three rotations of the flange, in mm and mrad."""
    read = np.column_stack([MOVED, 1e-4 * np.arange(18.0).reshape(6, 3)])
    columns = LoadTests(F, read, theta=THETA, gauges=np.tile(np.eye(3)[[2, 0, 1]], (6, 1, 1))).columns()
    assert [name for name in columns if "reading" in name] == [f"reading{k}_mm" for k in (1, 2, 3)]
    np.testing.assert_allclose(np.transpose([columns[f"reading{k}_mm"] for k in (1, 2, 3)]), MOVED * 1e3)
    np.testing.assert_allclose(np.transpose([columns[f"r{axis}_mrad"] for axis in "xyz"]), read[:, 3:] * 1e3)
