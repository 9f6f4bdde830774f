"""Everything the paper says, one test a statement: its numbers by plane geometry and closed forms, then our answer."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest
from scipy.optimize import nnls

import robomill as rm
from robomill.cutting.forces.mechanistic import MechanisticRow
from robomill.io.materials import sample_materials
from robomill.io.samples import samples_dir
from robomill.paper import BOX_SIZE, SLOT
from robomill.report.paper import STATEMENTS, TABLE_1, TABLES, WORDS
from robomill.report.reproduction import CHECKS, reproduction
from robomill.report.reproduction_row import Evidence, columns, summary
from robomill.workspace.fields import compliance_map
from robomill.workspace.grid import PAPER_BOX, box_grid, plane_grid
from robomill.workspace.lines import border_and_middle_lines
from tests.paper import arm

FILES = samples_dir() / "load_tests"
X, Y = np.meshgrid(np.linspace(-0.6, 0.6, 25), np.linspace(-1.6, -1, 13), indexing="ij")
C_2, C_3 = (np.array(TABLES[name]) * 1e-7 for name in ("table_2", "table_3"))
SHARES = arm.shares(X, Y, 0.0, C_2)  # (x, y, joint, 3, 3) over the plane Z_M = 0
C = SHARES.sum(axis=2)
JOINTS_1_3_5 = [0, 2, 4]
MOSTLY = 0.90
ROUNDING = 1e-12  # "only from": what other joints may add, as a part of the largest value


@pytest.fixture(scope="module")
def evidence() -> Evidence:
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml")
    robot = rm.load_robot("slavkovic_5r")
    files = ("nine_points.csv", "one_joint_at_a_time.csv")
    nine, single = (rm.identify(robot, rm.read_load_tests(FILES / name)) for name in files)
    other = setup.replace(robot=setup.robot.with_compliance_set("table_3"))
    return Evidence(robot, rm.simulate(setup), rm.simulate(other), nine, single, tuple(sample_materials()))


@pytest.fixture(scope="module")
def rows(evidence):
    return {row.statement.code: row for row in reproduction(evidence)}


def numbers(text):
    return [float(n.replace("−", "-")) for n in re.findall(r"−?\d+\.?\d*(?:e-\d+)?", text)]


def component(name):
    return C[..., "xyz".index(name[0]), "xyz".index(name[1])]


def part_of(name, joints):
    """The part of the mean size of an entry that some joints make."""
    sizes = np.abs(SHARES[..., "xyz".index(name[0]), "xyz".index(name[1])]).mean(axis=(0, 1))
    return sizes[joints].sum() / sizes.sum()


# ---- what each statement comes to, computed another way -------------------------------------------------------------
def table_1(found, evidence):
    alpha, offset, sense = (np.array(v, dtype=float) for v in TABLE_1)
    robot, theta = evidence.robot, np.radians([10.0, -20.0, 30.0, 40.0, -50.0])
    T = np.eye(4)
    for i, (a, d) in enumerate(zip((0, arm.A_2, 0, 0, arm.A_5), (0, 0, 0, arm.D_4, 0), strict=True)):
        q, al = sense[i] * theta[i] + np.radians(offset[i]), np.radians(alpha[i])
        turn = np.array([[np.cos(q), -np.sin(q), 0, 0], [np.sin(q), np.cos(q), 0, 0], [0, 0, 1, d], [0, 0, 0, 1]])
        tilt = np.array([[1, 0, 0, a], [0, np.cos(al), -np.sin(al), 0], [0, np.sin(al), np.cos(al), 0], [0, 0, 0, 1]])
        T = T @ turn @ tilt
    T_MT = rm.tool_pose(robot, theta)
    np.testing.assert_allclose(T_MT[:3, 3], T[:3, 3], atol=1e-14)
    np.testing.assert_allclose(T_MT[:3, 2], -T[:3, 0], atol=1e-14)  # z_T is -x_5


def lengths(found, evidence):
    np.testing.assert_allclose([*found.values()], [1.22, 1.1, 0.3, 0, -1.1, 0.92], atol=1e-12)


def jacobian(found, evidence):
    """With the tool vertical: each column is the one of plane geometry, up to the joint's own sense."""
    poses = np.stack([X, Y, 0 * X - 0.2, 0 * X, 0 * X], axis=-1)
    J = rm.geometric_jacobian(evidence.robot, rm.inverse_kinematics(evidence.robot, rm.pose_from_world(poses)).theta)
    sizes = np.linalg.norm(arm.columns(X, Y, -0.2)[..., :3, :], axis=-2)
    np.testing.assert_allclose(np.linalg.norm(J[..., :3, :], axis=-2), sizes, atol=1e-9)


def workspace(found, evidence):
    np.testing.assert_allclose(PAPER_BOX[1] - PAPER_BOX[0], BOX_SIZE)
    corners = np.array(np.meshgrid(*np.array(PAPER_BOX).T)).reshape(3, -1).T
    reach = np.hypot(np.hypot(corners[:, 0], corners[:, 1]), corners[:, 2] + arm.A_5)
    assert (reach < arm.A_2 + arm.D_4).all()
    np.testing.assert_allclose([*found.values()], [1, 1.2, 0.6, 0.5], rtol=1e-12)


def determinant(found, evidence):
    low, high = (arm.determinant(X, Y, z) for z in (-0.4, 0.1))
    np.testing.assert_allclose([*found.values()], [low.min(), low.max(), high.min(), high.max()], rtol=1e-9)
    Z = np.linspace(-0.4, 0.1, 11)
    every = arm.determinant(X[..., None], Y[..., None], Z)
    assert (every.min(), every.max()) == (pytest.approx(0.25, abs=0.01), pytest.approx(1.96, abs=0.01))
    field = compliance_map(evidence.robot, box_grid(*PAPER_BOX, 0.05))
    np.testing.assert_allclose(np.abs(field.det_J), every, rtol=1e-9)
    assert (np.sign(field.det_J) == np.sign(field.det_J.flat[0])).all()


def table_2(found, evidence):
    robot, tests = evidence.robot, rm.read_load_tests(FILES / "one_joint_at_a_time.csv")
    np.testing.assert_allclose(robot.compliance_sets["table_2"], C_2, rtol=1e-14)
    mine = [tests.joint == j for j in range(1, 6)]
    ratio = [tests.angle[m] @ tests.torque[m] / (tests.torque[m] @ tests.torque[m]) for m in mine]
    assert found["worst"] == pytest.approx(np.abs(ratio / C_2 - 1).max(), rel=1e-6)
    assert ((evidence.single.ci95[:, 0] <= C_2) & (C_2 <= evidence.single.ci95[:, 1])).all()


def figure_5(found, evidence):
    field = compliance_map(evidence.robot, plane_grid("z", 0.0, *PAPER_BOX, 0.05))
    for name in ("xx", "yy", "zz"):
        np.testing.assert_allclose(field.values(f"C_{name}")[:, :, 0], component(name), rtol=1e-9)
    right, inner = X[:, 0] > -1e-9, np.abs(X[:, 0]) < 0.4 + 1e-9
    for name in ("xx", "zz"):
        assert (np.diff(component(name), axis=1) < 0).all()
        assert (np.diff(component(name)[right], axis=0) > 0).all()
    assert (np.diff(component("yy")[inner], axis=1) > 0).all()
    assert (np.diff(component("yy")[right], axis=0) < 0).all()
    # C_yy grows with Y up to the largest |X| at which every step in Y goes up, and says so.
    grows = [
        x
        for x in np.unique(np.abs(X[:, 0]).round(9))
        if (np.diff(component("yy")[np.abs(X[:, 0]) < x + 1e-9]) > 0).all()
    ]
    assert found["reach"] == pytest.approx(1e3 * max(grows))
    assert max(grows) < 0.6


def figure_6(found, evidence):
    parts = [part_of(name, JOINTS_1_3_5) for name in ("xx", "yy")]
    assert min(parts) >= MOSTLY
    assert part_of("zz", [1, 2]) == pytest.approx(1.0, abs=ROUNDING)
    assert min(part_of("zz", [1]), part_of("zz", [2])) > 0.05
    np.testing.assert_allclose([found["xx"], found["yy"]], parts, atol=0.01)  # ours on another grid


def figure_7(found, evidence):
    assert part_of("xy", JOINTS_1_3_5) >= MOSTLY
    for name in ("xz", "yz"):
        assert part_of(name, [2]) == pytest.approx(1.0, abs=ROUNDING)
    field = compliance_map(evidence.robot, plane_grid("z", 0.0, *PAPER_BOX, 0.05))
    for name in ("xy", "xz", "yz"):
        np.testing.assert_allclose(field.values(f"C_{name}")[:, :, 0], component(name), atol=1e-15)


def figure_8(found, evidence):
    """Along X at the nearest border the normal is Y: the force times C_yy; along Y it is X."""
    along_x, along_y = (SLOT.force * component(name) for name in ("yy", "xx"))
    expected = [along_x[:, [0, 6, 12]].max(), along_y[[0, 12, 24]].max()]
    np.testing.assert_allclose([found["along_x"], found["along_y"]], expected, atol=1e-7)
    assert all(line.reached.all() for line in border_and_middle_lines(evidence.robot, points=5))


def photographs(found, evidence):
    pass  # nothing to compute


def measured_maps(found, evidence):
    tests = rm.read_load_tests(FILES / "grid_45x6.csv", evidence.robot)
    assert len(np.unique(tests.pose_index())) == 45 * 6
    np.testing.assert_allclose(np.linalg.norm(tests.wrench[:, :3], axis=1), 250.0)


def nine_points(found, evidence):
    tests = rm.read_load_tests(FILES / "nine_points.csv")
    p = tests.tool_poses(evidence.robot)[:, :3, 3]
    assert len(np.unique(p.round(6), axis=0)) * 9 == found["equations"]
    np.testing.assert_allclose(p[:, 2], 0.0, atol=1e-7)


def table_3(found, evidence):
    """The same least squares with the regressor of plane geometry."""
    tests = rm.read_load_tests(FILES / "nine_points.csv")
    p = tests.tool_poses(evidence.robot)[:, :3, 3]
    unit = np.stack([arm.shares(p[:, 0], p[:, 1], p[:, 2], np.eye(5)[i])[:, i] for i in range(5)], axis=-1)
    A = np.einsum("mijk,mj->mik", unit, tests.wrench[:, :3]).reshape(-1, 5)
    solved = nnls(A * 1e-6, tests.displacement[:, :3].reshape(-1))[0] * 1e-6 * 1e7
    np.testing.assert_allclose(np.array([*found.values()]) * 1e7, solved, atol=0.0051)
    np.testing.assert_allclose(evidence.robot.compliance_sets["table_3"], C_3, rtol=1e-14)
    assert (solved[[0, 1, 2, 4]] > np.array(TABLES["table_2"])[[0, 1, 2, 4]]).all()


def figure_13(found, evidence):
    ratio = np.stack([arm.shares(X, Y, 0.0, C_3).sum(2)[..., i, i] / C[..., i, i] for i in range(3)])
    low, high = found["low"], found["high"]
    assert 1.0 < low <= high < 1.4
    assert (low, high) == (pytest.approx(ratio.min(), abs=0.011), pytest.approx(ratio.max(), abs=0.011))


def force(found, evidence):
    forces = [arm.slot_force(m.Ktc, m.Kte) for m in sample_materials() if isinstance(m, MechanisticRow)]
    assert found["rows"] == len(forces)
    np.testing.assert_allclose(
        [found["used"], found["low"], found["high"]], [SLOT.force, min(forces), max(forces)], rtol=1e-6
    )
    assert min(forces) < SLOT.force < max(forces)


def at_the_slot(C_theta):
    return SLOT.force * arm.shares(*SLOT.point, C_theta).sum(axis=0)[:, 1]


def predicted(found, evidence):
    """At X = 0 with the tool vertical C_yy = C_3 h^2 + C_5 a_5^2, and the cross-compliance lowers the tip."""
    moved = at_the_slot(C_2)
    assert moved[1] == pytest.approx(SLOT.from_table_2, abs=1e-6)
    np.testing.assert_allclose([found["aside"], found["up"]], moved[1:], rtol=1e-6)
    assert found["up"] < 0
    each = SLOT.force * arm.shares(*SLOT.point, C_2)[:, 1, 1] * 1e3
    np.testing.assert_allclose(each, [0, 0, 0.1473, 0, 0.0822], atol=1e-4)


def from_map(found, evidence):
    """Only joints 3 and 5 act there, so the ratio lies between theirs, and the map's number is out of reach."""
    moved = at_the_slot(C_3)[1]
    assert found["aside"] == pytest.approx(moved, rel=1e-6)
    low, high = sorted(SLOT.from_table_2 * C_3[[2, 4]] / C_2[[2, 4]])
    assert low < moved < high < SLOT.from_map


def machined(found, evidence):
    """The groove is off by what the tip is, to a few micrometres, and shallower than nothing: it is too deep."""
    first, second = at_the_slot(C_2), at_the_slot(C_3)
    expected = [first[1], second[1], -first[2]]
    np.testing.assert_allclose([found["first"], found["second"], found["too_deep"]], expected, atol=12e-6)
    assert second[1] < SLOT.measured


TRUTHS = {
    truth.__name__: truth
    for truth in (
        *(table_1, lengths, jacobian, workspace, determinant, table_2, figure_5, figure_6, figure_7, figure_8),
        *(photographs, measured_maps, nine_points, table_3, figure_13, force, predicted, from_map, machined),
    )
}


@pytest.mark.parametrize("statement", STATEMENTS, ids=lambda statement: statement.code)
def test_statement(statement, rows, evidence):
    row = rows[statement.code]
    assert row.holds
    TRUTHS[statement.code](row.numbers, evidence)
    printed = " ".join(quoted for other in STATEMENTS for quoted in other.quotations)
    for number in re.findall(r"\d\.\d+ mm", statement.gives):
        assert number in printed, "what it gives is what the paper prints"


# ---- the table ------------------------------------------------------------------------------------------------------
def test_codes_are_one_to_one():
    codes = [statement.code for statement in STATEMENTS]
    assert len(set(codes)) == len(codes)
    assert set(codes) == set(CHECKS) == set(TRUTHS)


@pytest.mark.parametrize(("kind", "last"), [("Table", 3), ("Fig", 16)])
def test_every_table_and_figure_is_there(kind, last):
    named = " ".join(statement.where for statement in STATEMENTS)
    there = {int(n) for group in re.findall(rf"{kind}s?\.? ([\d, ]+)", named) for n in re.findall(r"\d+", group)}
    assert set(range(1, last + 1)) <= there


def test_quotations_are_short_and_gaps_give_their_reason(rows):
    for row in rows.values():
        assert row.statement.quotations
        assert all(1 <= len(re.findall(r"[.](?=\s|$)", quoted)) <= 2 for quoted in row.statement.quotations)
        assert row.reason.endswith(".")
        assert "{" not in row.reason
        if row.statement.status == "gap":
            assert re.search(r"not printed|measured", row.reason)


def test_readings_are_filled_in_with_what_was_computed(rows):
    soft = C_3 / C_2
    assert numbers(rows["from_map"].reason)[-4:] == [round(soft[2], 2), round(soft[4], 2), 0.246, 0.276]
    share = [100 * at_the_slot(c)[1] / SLOT.measured for c in (C_2, C_3)]
    np.testing.assert_allclose(numbers(rows["machined"].reason), share, atol=3)


def test_a_changed_robot_is_found_out(evidence):
    """The checks are checks: other lengths, another table or a swapped sign turn rows red."""

    def red(**fields):
        changed = dataclasses.replace(evidence, given=evidence.robot.replace(**fields))
        return {row.statement.code for row in reproduction(changed) if not row.holds}

    assert {"workspace", "lengths"} & red(a=[0.0, 0.6, 0.0, 0.0, 0.3]) == {"workspace"}
    assert "table_1" in red(sign=np.ones(5))
    sets = {**evidence.robot.compliance_sets, "table_2": C_2 * 1.01, "table_3": C_3 * 1.01}
    assert {"table_2", "table_3"} <= red(compliance_sets=sets)


def test_table_and_sentence(rows):
    listed = list(rows.values())
    table = columns(listed)
    assert {len(column) for column in table.values()} == {len(listed)}
    assert set(table["status"]) <= set(WORDS.values())
    statuses = [row.statement.status for row in listed]
    counts = [statuses.count(status) for status in ("reproduced", "assumed", "gap", "not computed")]
    assert numbers(summary(listed)) == [len(listed), *counts]
