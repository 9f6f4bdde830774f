"""Maps as CSV, Parquet and VTK."""

import numpy as np
import pytest

import robomill as rm
from robomill.errors import WorkspaceError
from robomill.io.maps import map_columns, write_map
from robomill.workspace.fields import compliance_map
from robomill.workspace.grid import Grid, box_grid


@pytest.fixture(scope="module")
def field():
    return compliance_map(rm.load_robot("slavkovic_5r"), box_grid([-0.2, -2.4, 0], [0.2, -1.2, 0.1], 0.1))


def test_csv(field, tmp_path):
    path = write_map(tmp_path / "map.csv", [field.field("C_yy"), field.field("share_C_yy_3")])
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[0] == "X_mm,Y_mm,Z_mm,C_yy_um/N,share_C_yy_3_percent"
    assert len(lines) == 1 + field.grid.cells
    table = np.genfromtxt(path, delimiter=",", skip_header=1)
    np.testing.assert_allclose(table[:, 3], field.values("C_yy").ravel() * 1e6, rtol=1e-9)
    np.testing.assert_allclose(table[:, :3], field.grid.points().reshape(-1, 3) * 1e3, atol=1e-6)
    assert np.isnan(table[:, 3]).sum() == (~field.reached).sum() > 0


def test_parquet(field, tmp_path):
    pq = pytest.importorskip("pyarrow.parquet")
    table = pq.read_table(write_map(tmp_path / "map.parquet", [field.field("det_J")]))
    assert table.column_names == ["X_mm", "Y_mm", "Z_mm", "det_J_m3"]
    np.testing.assert_array_equal(table["det_J_m3"].to_numpy(), field.det_J.ravel())


def test_vti(field, tmp_path):
    pv = pytest.importorskip("pyvista")
    image = pv.read(write_map(tmp_path / "map.vti", [field.field("C_yy"), field.field("reach")]))
    assert tuple(image.dimensions) == field.grid.shape
    np.testing.assert_array_equal(image["C_yy"].reshape(field.grid.shape, order="F"), field.values("C_yy"))
    index = np.ravel_multi_index((2, 3, 1), field.grid.shape, order="F")
    np.testing.assert_allclose(image.points[index], field.grid.points()[2, 3, 1], atol=1e-6)


def test_refusals(field, tmp_path):
    with pytest.raises(WorkspaceError, match=r"\.csv, \.parquet, \.vti"):
        write_map(tmp_path / "map.xlsx", [field.field("C_yy")])
    with pytest.raises(WorkspaceError, match="no quantity"):
        write_map(tmp_path / "map.csv", [])
    with pytest.raises(WorkspaceError, match="cannot be written"):
        write_map(tmp_path / "missing" / "map.csv", [field.field("C_yy")])
    uneven = compliance_map(field.robot, Grid(x=[0, 0.1, 0.3], y=[-1.3], z=[0]))
    with pytest.raises(WorkspaceError, match="evenly"):
        write_map(tmp_path / "map.vti", [uneven.field("C_yy")])


def test_rows_run_x_slowest_z_fastest_with_ten_digits(field, tmp_path):
    path = write_map(tmp_path / "MAP.CSV", [field.field("C_yy")])
    rows = path.read_text(encoding="utf-8").splitlines()[1:]
    expected = [
        (x * 1e3, y * 1e3, z * 1e3, field.values("C_yy")[i, j, k] * 1e6)
        for i, x in enumerate(field.grid.x)
        for j, y in enumerate(field.grid.y)
        for k, z in enumerate(field.grid.z)
    ]
    for row, numbers in zip(rows, expected, strict=True):
        for cell, number in zip(row.split(","), numbers, strict=True):
            assert cell == "NaN" if np.isnan(number) else abs(float(cell) - number) <= 1e-9 * max(abs(number), 1e-3)


def test_a_column_without_a_unit_has_the_bare_name(field):
    assert list(map_columns([field.field("reach")]))[-1] == "reach"


def test_quantities_of_one_file_share_one_grid(field, tmp_path):
    other = compliance_map(field.robot, Grid(x=[0], y=[-1.3], z=[0]))
    with pytest.raises(WorkspaceError, match="must share one grid"):
        write_map(tmp_path / "map.csv", [field.field("C_yy"), other.field("C_yy")])


def test_an_image_may_be_flat_and_stands_where_the_grid_does(field, tmp_path):
    pv = pytest.importorskip("pyvista")
    flat = compliance_map(field.robot, Grid(x=[0.05, 0.1, 0.15], y=[-1.4, -1.2], z=[0.02]))
    image = pv.read(write_map(tmp_path / "flat.vti", [flat.field("C_yy")]))
    np.testing.assert_allclose(image.origin, [0.05, -1.4, 0.02])
    np.testing.assert_allclose(image.spacing, [0.05, 0.2, 1.0])
    odd = compliance_map(field.robot, Grid(x=[0], y=[-1.4, -1.3, -1.2 + 2e-9], z=[0]))
    with pytest.raises(WorkspaceError, match=r"evenly spaced points, and axis y is not; write .csv or .parquet"):
        write_map(tmp_path / "map.vti", [odd.field("C_yy")])
    nearly = compliance_map(field.robot, Grid(x=[0], y=[-1.4, -1.3, -1.2 + 1e-10], z=[0]))
    assert write_map(tmp_path / "map.vti", [nearly.field("C_yy")]).is_file()


def test_one_quantity_has_one_column(field, tmp_path):
    with pytest.raises(WorkspaceError, match="C_yy is there 2 times"):
        write_map(tmp_path / "map.csv", [field.field("C_yy")] * 2)
    assert not list(tmp_path.iterdir())
