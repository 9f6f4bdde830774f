"""Maps: every quantity against the law at one configuration, NaN where unreachable, budgets, names."""

import dataclasses
import pickle

import numpy as np
import pytest

import robomill as rm
from robomill.errors import WorkspaceError
from robomill.kinematics import dexterity
from robomill.workspace.fields import compliance_map
from robomill.workspace.grid import PAPER_BOX, Grid, axis_points, box_grid, plane_grid
from robomill.workspace.quantities import map_quantities, map_quantity
from robomill.workspace.reach import reach


def singular_values(robot, theta):
    """Falling, from the eigenvalues of the task Jacobian times its transpose."""
    J = dexterity.task_matrix(robot, theta)
    return np.sqrt(np.maximum(np.linalg.eigvalsh(J @ J.T)[::-1], 0.0))


MEASURES = {
    "det_J": dexterity.determinant,
    "manipulability": dexterity.manipulability,
    "inverse_condition": lambda robot, theta: np.divide(*singular_values(robot, theta)[[-1, 0]]),
    "smallest_singular_value": lambda robot, theta: singular_values(robot, theta)[-1],
    "limit_distance": dexterity.limit_distance,
}


@pytest.mark.parametrize(("name", "A", "B"), [("slavkovic_5r", 0.2, -0.3), ("fanuc_r2000ic", 0.0, 0.0)])
def test_every_quantity_is_the_law_at_its_configuration(name, A, B):
    robot = rm.load_robot(name)
    grid = (
        box_grid([-0.5, -2.4, -0.2], [0.5, -1.0, 0.0], 0.2) if robot.n == 5 else box_grid([1, -1, 0], [3, 1, 0.4], 0.4)
    )
    field = compliance_map(robot, grid, A, B)
    assert 0 < (~field.reached).sum() < grid.cells
    for index in np.argwhere(field.reached)[::5]:
        cell = tuple(index)
        theta = field.theta[cell]
        np.testing.assert_allclose(
            rm.world_from_pose(rm.tool_pose(robot, theta)), [*grid.points()[cell], A, B], atol=1e-9
        )
        C_joint = rm.joint_contributions(rm.geometric_jacobian(robot, theta)[:3], robot.C_theta)
        np.testing.assert_allclose(field.C_joint()[cell], C_joint, atol=1e-18)
        np.testing.assert_allclose(field.C()[cell], C_joint.sum(axis=0), atol=1e-18)
        for key, law in MEASURES.items():
            assert field.values(key)[cell] == pytest.approx(float(law(robot, theta)), rel=1e-9, abs=1e-9)
        assert field.values("C_xz")[cell] == pytest.approx(C_joint.sum(axis=0)[0, 2], abs=1e-18)
        assert field.values("C_zx_2")[cell] == pytest.approx(C_joint[1, 0, 2], abs=1e-18)
        assert field.values("dominant_C_xx")[cell] == 1 + np.argmax(C_joint[:, 0, 0])
        shares = [field.values(f"share_C_yy_{j}")[cell] for j in range(1, robot.n + 1)]
        assert sum(shares) == pytest.approx(1)
        soft, stiff = field.values("C_soft")[cell], field.values("C_stiff")[cell]
        np.testing.assert_allclose([stiff, soft], np.linalg.eigvalsh(C_joint.sum(axis=0))[[0, 2]], rtol=1e-9)


def test_unreachable_is_nan_and_counted_for_every_name():
    robot = rm.load_robot("slavkovic_5r")
    grid = plane_grid("z", 0.0, [-1, -3, 0], [1, -1, 0], 0.25)
    field = compliance_map(robot, grid)
    for name in map_quantities(robot):
        values = field.values(name)
        assert values.shape == grid.shape
        if name == "reach":
            assert set(np.unique(values)) == {0.0, 1.0}
        else:
            np.testing.assert_array_equal(np.isnan(values), ~field.reached, err_msg=name)
        assert map_quantity(robot, name).formula
        assert field.field(name).reached == field.reached.sum()


def test_a_grid_out_of_reach_is_all_nan():
    robot = rm.load_robot("slavkovic_5r")
    field = compliance_map(robot, plane_grid("z", 9.0, *PAPER_BOX, 0.3)).field("smallest_singular_value")
    assert field.reached == 0
    assert np.isnan(field.values).all()


def test_a_singular_arm_gives_zero_not_an_error():
    robot = rm.load_robot("planar_3r").replace(C_theta=np.zeros(3))
    field = compliance_map(robot, plane_grid("z", 0.0, [0.3, 0, 0], [0.9, 0.4, 0], 0.2))
    assert field.reached.all()
    np.testing.assert_array_equal(field.values("C_xx"), 0.0)
    np.testing.assert_array_equal(field.values("share_C_xx_1"), 0.0)


def test_a_field_is_a_value_of_its_own():
    field = compliance_map(rm.load_robot("slavkovic_5r"), box_grid([0.0, -1.3, 0.0], [0.1, -1.2, 0.0], 0.1))
    for value, name in ((field, "theta"), (field.field("C_yy"), "values")):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(value, name, None)
        assert value == dataclasses.replace(value)
    assert field != compliance_map(field.robot, field.grid, A=0.1)
    assert field.field("C_yy") != field.field("C_xx")


def test_the_budget_counts_what_a_field_holds_and_one_quantity_of_it(monkeypatch):
    asked = []
    monkeypatch.setattr(Grid, "check_budget", lambda grid, bytes_per_cell, *more: asked.append(bytes_per_cell))
    for name in ("slavkovic_5r", "fanuc_r2000ic"):
        field = compliance_map(rm.load_robot(name), box_grid([1.0, -1.2, 0.0], [1.2, -1.0, 0.0], 0.1))
        held = (field.theta, field.reached, field.J, field.shares, field.det_J, field.total, field.values("C_xx"))
        assert asked.pop() == sum(array.nbytes for array in held) / field.grid.cells


def test_budget_names_the_step_that_fits():
    robot = rm.load_robot("slavkovic_5r")
    with pytest.raises(WorkspaceError, match="GiB.*step of") as error:
        compliance_map(robot, box_grid(*PAPER_BOX, 0.001))
    step = float(str(error.value).split("step of ")[1].split(" mm")[0]) * 1e-3
    box_grid(*PAPER_BOX, step).check_budget(8 * (13 * 5 + 8) + 1)


def test_grids():
    np.testing.assert_allclose(axis_points(-0.6, 0.6, 0.01), np.linspace(-0.6, 0.6, 121), atol=1e-15)
    assert box_grid(*PAPER_BOX, 0.01).shape == (121, 61, 51)
    assert plane_grid("x", 0.1, *PAPER_BOX, 0.1).shape == (1, 7, 6)
    for bad in ((0, 1, 0), (0, 1, -1), (1, 0, 0.1), (0, np.nan, 0.1), (0, 1, 1e-9)):
        with pytest.raises(WorkspaceError):
            axis_points(*bad)
    with pytest.raises(WorkspaceError, match="must rise"):
        Grid(x=[0, 0], y=[0], z=[0])
    with pytest.raises(WorkspaceError, match="normal"):
        plane_grid("w", 0.0, *PAPER_BOX, 0.1)


def test_a_planar_arm_keeps_its_elbow_side_over_a_map():
    robot = rm.load_robot("planar_2r")
    field = compliance_map(robot, plane_grid("z", 0.0, [-0.8, -0.8, 0], [0.8, 0.8, 0], 0.1))
    theta = field.theta[field.reached]
    other = theta[theta[:, 1] < 0]
    # Where the elbow is on the other side, the first joint would be past its limit with it on this one.
    mirrored = other[:, 0] + 2 * np.arctan2(0.4 * np.sin(other[:, 1]), 0.5 + 0.4 * np.cos(other[:, 1]))
    mirrored = (mirrored + np.pi) % (2 * np.pi) - np.pi
    assert (np.abs(mirrored) > robot.limits[0, 1] - 1e-9).all()


@pytest.mark.parametrize("block", [1, 7, 16, 48, 100])
def test_a_grid_in_blocks_is_the_grid_at_once(monkeypatch, block):
    """48 points in blocks that end with it and blocks that do not."""
    robot, grid = rm.load_robot("slavkovic_5r"), box_grid([-0.5, -2.4, -0.2], [0.4, -1.5, 0.4], 0.3)
    assert grid.shape == (4, 4, 3)
    whole, mask = compliance_map(robot, grid, 0.1, -0.2), reach(robot, grid, [(0.1, -0.2), (0.0, 0.3)])
    for module in ("solve", "reach"):
        monkeypatch.setattr(f"robomill.workspace.{module}.BLOCK", block)
    parts = compliance_map(robot, grid, 0.1, -0.2)
    for name in ("theta", "reached", "J", "shares", "det_J"):
        np.testing.assert_array_equal(getattr(parts, name), getattr(whole, name))
    np.testing.assert_array_equal(reach(robot, grid, [(0.1, -0.2), (0.0, 0.3)]), mask)
    assert 0 < mask.sum() < grid.cells


def test_a_row_of_a_table_is_a_cell_and_says_what_holds_there():
    """x slowest, z fastest; each number by the laws of the one pose, in the unit that its column names."""
    robot = rm.load_robot("slavkovic_5r")
    found = compliance_map(robot, Grid(x_mm=[-100, 0, 9000], y_mm=[-1300, -1200], z_mm=[0, 50]), 0.1, -0.2)
    table, alone = found.columns(), found.field("C_yy").columns()
    cells = [(x, y, z) for x in (-100, 0, 9000) for y in (-1300, -1200) for z in (0, 50)]
    for columns in (table, alone):
        np.testing.assert_allclose(np.transpose([columns[f"{axis}_mm"] for axis in "XYZ"]), cells)
    assert list(alone) == ["X_mm", "Y_mm", "Z_mm", "C_yy_um/N"]
    assert len(table) == 3 + len(map_quantities(robot))
    for n, cell in enumerate(cells):
        theta = rm.inverse_kinematics(robot, rm.pose_from_world([*np.array(cell) * 1e-3, 0.1, -0.2])).theta
        C = rm.cartesian_compliance(robot, theta)
        for columns in (table, alone):
            assert columns["C_yy_um/N"][n] == pytest.approx(C[1, 1] * 1e6, rel=1e-6, nan_ok=True)
        assert table["C_soft_um/N"][n] == pytest.approx(
            np.linalg.eigvalsh(C)[2] * 1e6 if n < 8 else np.nan, rel=1e-6, nan_ok=True
        )
    assert np.isnan(alone["C_yy_um/N"]).sum() == 4


def test_a_field_goes_through_pickle_and_into_xarray_with_its_places_and_unit():
    xarray = pytest.importorskip("xarray")
    found = compliance_map(rm.load_robot("slavkovic_5r"), box_grid([0.0, -1.3, -0.1], [0.2, -1.2, 0.0], 0.1), 0.1, 0.3)
    field = found.field("C_yy")
    again = pickle.loads(pickle.dumps(field))
    assert again == field
    assert again.quantity.law(found) is not None
    np.testing.assert_array_equal(again.values, field.values)
    cube = field.to_xarray()
    assert cube.dims == ("x", "y", "z")
    at = cube.sel(x=0.1, y=-1.3, z=-0.1, method="nearest")
    here = rm.at_pose(
        found.robot, rm.inverse_kinematics(found.robot, rm.pose_from_world([0.1, -1.3, -0.1, 0.1, 0.3])).theta
    )
    assert float(at) == pytest.approx(here.C[1, 1], rel=1e-9)
    assert (float(at.x), float(at.y), float(at.z)) == pytest.approx((0.1, -1.3, -0.1))
    assert (float(cube.A), float(cube.B), cube.attrs["units"]) == (0.1, 0.3, "m/N")
    assert {name: cube[name].attrs["units"] for name in "xyzAB"} == {
        **dict.fromkeys("xyz", "m"),
        "A": "rad",
        "B": "rad",
    }
    both = found.to_xarray(["C_yy", "reach"])
    assert list(both) == ["C_yy", "reach"]
    xarray.testing.assert_equal(both["C_yy"], cube)
    assert set(found.to_xarray()) == set(map_quantities(found.robot))


@pytest.mark.parametrize("tilt", [(np.nan, 0.0), (0.0, np.inf)])
def test_a_tilt_that_is_no_angle_is_refused(tilt):
    with pytest.raises(WorkspaceError, match="must be finite angles"):
        compliance_map(rm.load_robot("slavkovic_5r"), box_grid([0.0, -1.3, 0.0], [0.1, -1.2, 0.0], 0.1), *tilt)


def test_a_map_in_words_says_between_which_numbers_its_quantities_lie():
    """The first numbers of each fact are the least and the largest of what is reached; of nothing there are none."""
    robot = rm.load_robot("slavkovic_5r")
    found = compliance_map(robot, plane_grid("z", 0.0, [-1, -3, 0], [1, -1, 0], 0.25))
    facts = dict(found._facts())
    for c in ("xx", "yy", "zz"):
        field = found.field(f"C_{c}")
        low, high = (np.nanmin(field.values) * 1e6, np.nanmax(field.values) * 1e6)
        for said in (facts[field.quantity.title], field._said().partition(": ")[2]):
            least, _, largest = said.split()[:3]
            assert (float(least), float(largest)) == pytest.approx((low, high), rel=2e-3)
    nowhere = compliance_map(robot, plane_grid("z", 9.0, *PAPER_BOX, 0.3))
    for said in dict(nowhere._facts()).values():
        assert not any(each in said.partition(" over ")[0] for each in "0123456789")
