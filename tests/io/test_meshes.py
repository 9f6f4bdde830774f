"""Meshes out and back in: closed solids, right volume, refusals of broken stocks."""

import io

import numpy as np
import pytest
import trimesh

from robomill.cutting.tool import Cutter
from robomill.errors import SurfaceError
from robomill.io.meshes import mesh_bytes, read_stl_stock, write_mesh
from robomill.surface.mesh import to_mesh
from robomill.surface.stock import Stock
from robomill.surface.zmap import cut

STOCK = Stock((0, 0, -0.01), (0.03, 0.02, 0))


def part(cell=5e-4):
    return cut(STOCK, cell, Cutter("ball", 0.008), np.array([[0.005, 0.01, -0.002], [0.03, 0.012, -0.003]]))


def test_mesh_is_a_closed_solid_of_the_right_volume():
    zmap = part()
    mesh = to_mesh(zmap)
    solid = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert solid.is_watertight
    assert solid.is_winding_consistent
    assert solid.volume == pytest.approx(np.prod(STOCK.size) - zmap.removed_volume, rel=2e-3)
    np.testing.assert_allclose(solid.bounds, [STOCK.lower, STOCK.upper], atol=1e-12)
    thin = to_mesh(zmap, max_faces=600)
    assert len(thin.faces) < 1000
    assert trimesh.Trimesh(thin.vertices, thin.faces).is_watertight


@pytest.mark.parametrize("kind", ["stl", "ply", "glb"])
def test_files_hold_the_part_in_millimetres(kind, tmp_path):
    zmap = part()
    path = write_mesh(tmp_path / f"part.{kind}", zmap)
    back = trimesh.load(path, force="mesh")
    assert back.volume == pytest.approx(1e9 * (np.prod(STOCK.size) - zmap.removed_volume), rel=2e-3)


def test_vtp_carries_the_error_field(tmp_path):
    pyvista = pytest.importorskip("pyvista")
    zmap = part()
    error = np.full(zmap.z.shape, 1e-5)
    path = write_mesh(tmp_path / "part.vtp", zmap, error=error)
    back = pyvista.read(path)
    assert np.nanmax(back.point_data["error_um"]) == pytest.approx(10.0)
    with pytest.raises(SurfaceError, match="not known: use stl"):
        mesh_bytes(zmap, "obj")


def stl(mesh):
    return mesh.export(file_type="stl")


def test_stock_from_stl_has_its_heights():
    box = trimesh.creation.box((30.0, 20.0, 10.0))
    stock, findings = read_stl_stock(stl(box))
    assert findings == ()
    np.testing.assert_allclose(stock.size, [0.03, 0.02, 0.01], atol=1e-9)
    surface = cut(stock, 5e-4, Cutter("flat", 0.008), np.array([[-0.03, 0, 0.003], [0.03, 0, 0.003]]))
    assert surface.removed_volume == pytest.approx(0.03 * 0.008 * 0.002, rel=1e-6)
    ball = trimesh.creation.icosphere(subdivisions=4, radius=15.0)
    stock, _ = read_stl_stock(stl(ball))
    surface = cut(stock, 2e-4, Cutter("flat", 0.008), np.array([[-0.03, 0, 0.014], [0.03, 0, 0.014]]))
    h = 1e-3
    assert surface.z_stock.max() == pytest.approx(0.015, rel=1e-3)
    assert surface.removed_volume < np.pi * h * h * (0.045 - h) / 3
    assert surface.removed_volume > 0.5 * np.pi * h * h * (0.045 - h) / 3


def test_broken_stocks_are_refused_or_questioned():
    open_box = trimesh.creation.box((30.0, 20.0, 10.0))
    open_box.update_faces(np.arange(len(open_box.faces)) > 0)
    with pytest.raises(SurfaceError, match="not watertight"):
        read_stl_stock(stl(open_box), name="open.stl")
    with pytest.raises(SurfaceError, match="the file is empty"):
        read_stl_stock(b"")
    with pytest.raises(SurfaceError, match=r"no triangles|not an STL"):
        read_stl_stock(b"solid nothing\nendsolid nothing\n")
    with pytest.raises(SurfaceError, match=r"no triangles|not an STL"):
        read_stl_stock(b"G1 X0 Y0\n" * 30)
    _, findings = read_stl_stock(stl(trimesh.creation.box((0.03, 0.02, 0.01))))
    assert "looks like metres" in findings[0]
    stock, findings = read_stl_stock(stl(trimesh.creation.box((0.03, 0.02, 0.01))), unit="m")
    assert findings == ()
    assert stock.size[0] == pytest.approx(0.03)
    assert io.BytesIO(mesh_bytes(part())).read(5)
