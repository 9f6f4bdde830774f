"""The quantities of a map: each against its law written down again, what it says of itself, names that are refused."""

import numpy as np
import pytest

import robomill as rm
from robomill.errors import WorkspaceError
from robomill.units import UNITS
from robomill.workspace.fields import ComplianceMap, compliance_map
from robomill.workspace.grid import box_grid
from robomill.workspace.quantities import COMPONENTS, map_quantities, map_quantity

AXES = "xyz"


@pytest.fixture(scope="module", params=["slavkovic_5r", "fanuc_r2000ic", "planar_3r"])
def field(request) -> ComplianceMap:
    low, high = {
        "slavkovic_5r": ([-0.5, -2.2, -0.2], [0.7, -1.0, 0.1]),
        "fanuc_r2000ic": ([1.2, -1, 0], [3.4, 1, 0.4]),
        "planar_3r": ([-0.1, -0.4, 0], [1.4, 0.5, 0]),
    }[request.param]
    robot = rm.load_robot(request.param)
    tilt = (0.0, 0.0) if robot.n != 5 else (0.1, -0.2)
    found = compliance_map(robot, box_grid(low, high, 0.3), *tilt)
    assert 0 < found.reached.sum() < found.grid.cells
    return found


def six(field: ComplianceMap) -> np.ndarray:
    """(nx, ny, nz, n, 6): C_theta J_a J_b for every joint, from the Jacobian at each cell's own joints."""
    out = np.full((*field.reached.shape, field.robot.n, 6), np.nan)
    for cell in map(tuple, np.argwhere(field.reached)):
        J = rm.geometric_jacobian(field.robot, field.theta[cell])
        for k, c in enumerate(COMPONENTS):
            out[*cell, :, k] = field.robot.C_theta * J[AXES.index(c[0])] * J[AXES.index(c[1])]
    return out


def by_cell(field: ComplianceMap, law) -> np.ndarray:
    """(nx, ny, nz) from a law of one cell's joints, NaN where not reached."""
    out = np.full(field.reached.shape, np.nan)
    for cell in map(tuple, np.argwhere(field.reached)):
        out[cell] = law(field.theta[cell])
    return out


def test_components_and_joints(field):
    parts = six(field)
    sizes = np.abs(parts).sum(axis=-2)
    for k, c in enumerate(COMPONENTS):
        np.testing.assert_allclose(field.values(f"C_{c}"), parts[..., k].sum(axis=-1), atol=1e-18)
        for j in range(field.robot.n):
            np.testing.assert_allclose(field.values(f"C_{c}_{j + 1}"), parts[..., j, k], atol=1e-18)
            with np.errstate(invalid="ignore"):
                share = np.where(
                    sizes[..., k] > 1e-20, parts[..., j, k] / sizes[..., k], np.where(field.reached, 0, np.nan)
                )
            np.testing.assert_allclose(field.values(f"share_C_{c}_{j + 1}"), share, atol=1e-9)


def test_who_gives_most(field):
    parts = six(field)
    trace = parts[..., :3].sum(axis=-1)
    columns = {"dominant": trace, **{f"dominant_C_{c}": np.abs(parts[..., k]) for k, c in enumerate(COMPONENTS)}}
    for name, size in columns.items():
        values = field.values(name)
        np.testing.assert_array_equal(np.isnan(values), ~field.reached, err_msg=name)
        for cell in map(tuple, np.argwhere(field.reached)):
            joint = field.robot.joint_numbers.index(int(values[cell]))
            assert size[cell][joint] == pytest.approx(size[cell].max(), rel=1e-9, abs=1e-20), name


def test_joints_keep_their_numbers_where_one_is_blocked():
    robot = rm.load_robot("slavkovic_5r")
    whole = compliance_map(robot, box_grid([0.0, -1.4, 0.0], [0.2, -1.2, 0.0], 0.2))
    names = [f"C_yy_{j}" for j in (1, 2, 3, 4, 5)]
    assert [map_quantity(robot, n).title for n in names] == [f"joint {j} in C_yy" for j in (1, 2, 3, 4, 5)]
    largest = np.argmax([whole.values(n) for n in names], axis=0) + 1
    np.testing.assert_array_equal(whole.values("dominant_C_yy"), largest)


def test_softest_and_stiffest_direction(field):
    C = six(field).sum(axis=-2)[..., [[0, 3, 4], [3, 1, 5], [4, 5, 2]]]
    for cell in map(tuple, np.argwhere(field.reached)):
        soft, stiff = field.values("C_soft")[cell], field.values("C_stiff")[cell]
        roots = np.sort(np.roots(np.poly(C[cell] * 1e6)).real) * 1e-6  # the characteristic polynomial
        assert soft == pytest.approx(roots[-1], rel=1e-6)
        assert stiff == pytest.approx(roots[0], rel=1e-4, abs=1e-12)


def test_room_to_the_limits(field):
    low, high = field.robot.limits.T

    def room(theta):
        return min(min(t - a, b - t) / ((b - a) / 2) for t, a, b in zip(theta, low, high))

    np.testing.assert_allclose(field.values("limit_distance"), by_cell(field, room), atol=1e-12)


def test_reach_is_one_where_the_tool_comes_and_zero_elsewhere(field):
    np.testing.assert_array_equal(field.values("reach"), np.where(np.isfinite(field.theta[..., 0]), 1.0, 0.0))


def test_determinant_and_its_kin(field):
    """Singular values by the eigenvalues of J J^T; their product is the size of the determinant."""
    robot = field.robot

    def values(theta):
        J = rm.task_jacobian(robot, theta) if robot.n == 5 else rm.geometric_jacobian(robot, theta)
        rows = list(range(6)) if robot.n == 6 else list(range(5)) if robot.n == 5 else [0, 1, 5]
        return np.sqrt(np.maximum(np.linalg.eigvalsh(J[rows] @ J[rows].T), 0.0))

    least = by_cell(field, lambda t: values(t)[0])
    np.testing.assert_allclose(field.values("smallest_singular_value"), least, atol=1e-7)
    np.testing.assert_allclose(
        field.values("inverse_condition"), least / by_cell(field, lambda t: values(t)[-1]), atol=1e-7
    )
    np.testing.assert_allclose(field.values("manipulability"), by_cell(field, lambda t: values(t).prod()), atol=1e-7)
    np.testing.assert_array_equal(np.abs(field.values("det_J")), field.values("manipulability"))


def test_every_quantity_says_what_it_is(field):
    robot = field.robot
    known = map_quantities(robot)
    for name, what in known.items():
        assert map_quantity(robot, name).name == what.name == name
        assert what.unit in UNITS
        assert what.formula
        assert what.meaning.endswith(".")
        assert what.label == f"{what.title}, {UNITS[what.unit].label}".removesuffix(", ")
        values = field.values(name)
        seen = values[field.reached]
        if what.colours == "joints":
            assert set(seen) <= set(robot.joint_numbers)
        elif what.colours == "sequential":  # a size
            assert (seen >= -1e-15).all(), name
    signed = {name for name, what in known.items() if what.colours == "diverging"}
    assert {"det_J", "C_xy", "C_xz", "C_yz", "C_yz_2", "share_C_xz_1"} <= signed
    assert not {"C_yy", "C_yy_1", "share_C_xx_2", "manipulability"} & signed
    assert known["reach"].colours == "reach"


def test_what_rests_on_compliance_changes_with_it_and_the_rest_does_not(field):
    stiff = field.robot.replace(C_theta=field.robot.C_theta * np.linspace(0.2, 3.0, field.robot.n))
    other = compliance_map(stiff, field.grid, field.A, field.B)
    for name, what in map_quantities(field.robot).items():
        same = np.array_equal(field.values(name), other.values(name), equal_nan=True)
        if what.rests_on == "geometry":
            assert same, name
        elif what.colours != "joints" and np.nanmax(np.abs(field.values(name))) > 1e-12 and what.unit != "%":
            assert not same, name


def test_units_and_headers():
    robot, planar = rm.load_robot("slavkovic_5r"), rm.load_robot("planar_3r")
    assert [map_quantity(r, "det_J").unit for r in (robot, planar, rm.load_robot("fanuc_r2000ic"))] == [
        "m3",
        "m2",
        "m3",
    ]
    assert [map_quantity(robot, n).column for n in ("C_yy", "reach", "limit_distance", "det_J", "share_C_xx_1")] == [
        "C_yy_um/N",
        "reach",
        "limit_distance_percent",
        "det_J_m3",
        "share_C_xx_1_percent",
    ]
    assert map_quantity(robot, "det_J").label == "det(J), m³"
    assert map_quantity(robot, "reach").label == "reach WS"
    assert map_quantity(robot, "C_xy").title == "cross-compliance C_xy"
    assert map_quantity(robot, "C_xx").title == "direct-compliance C_xx"
    assert map_quantity(robot, "C_xy").meaning == "How far the tip moves in X under 1 N in Y."


@pytest.mark.parametrize(
    ("written", "meant"), [("C_zy", "C_yz"), ("C_zx_2", "C_xz_2"), ("dominant_C_yx", "dominant_C_xy")]
)
def test_components_may_be_written_either_way(written, meant):
    assert map_quantity(rm.load_robot("slavkovic_5r"), written).name == meant


@pytest.mark.parametrize(
    "name", ["C_qq", "share_C_xx", "C_xx_6", "C_xx_0", "share_det_J", "dominant_C_xx_1", "", "stiffness"]
)
def test_unknown_quantities_are_refused(name):
    with pytest.raises(WorkspaceError) as refusal:
        map_quantity(rm.load_robot("slavkovic_5r"), name)
    offered = str(refusal.value).removeprefix(f"Quantity {name!r}: expected ").partition("; did you mean")[0]
    offered = offered.removesuffix(".")
    listed = offered.replace(" or ", ", ").split(", ")
    names = list(map_quantities(rm.load_robot("slavkovic_5r")))
    # Alone, or first and last of those that differ by component or joint; together they are all there is.
    ends = [words.split(" ... ") for words in listed]
    spans = [names[names.index(end[0]) : names.index(end[-1]) + 1] for end in ends]
    assert [name for span in spans for name in span] == names
    assert len(listed) < len(names) / 3


def test_what_a_rigid_joint_does_to_direct_and_to_cross_terms():
    """A direct share is what vanishes with the joint; a cross-compliance may grow instead, where parts cancel."""
    robot = rm.load_robot("slavkovic_5r")
    grid = box_grid([-0.5, -1.5, 0.0], [0.5, -1.1, 0.0], 0.1)
    known = compliance_map(robot, grid)
    larger = 0
    for joint in range(5):
        C_theta = np.where(np.arange(5) == joint, 0.0, robot.C_theta)
        rigid = compliance_map(robot.replace(C_theta=C_theta), grid)
        for c in ("xx", "yy", "zz"):
            vanished = 1 - rigid.values(f"C_{c}") / known.values(f"C_{c}")
            np.testing.assert_allclose(known.values(f"share_C_{c}_{joint + 1}"), vanished, atol=1e-12)
        larger += int((np.abs(rigid.values("C_xy")) > np.abs(known.values("C_xy")) + 1e-12).sum())
    assert larger > 0


def test_a_quantity_that_was_meant_is_named() -> None:
    with pytest.raises(WorkspaceError, match=r"^Quantity 'Cyy': expected reach, .*; did you mean 'C_yy'\?$"):
        map_quantity(rm.load_robot("slavkovic_5r"), "Cyy")
