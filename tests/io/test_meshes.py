"""Meshes out and back in: closed solids, right volume, refusals of broken stocks."""

import sys

import numpy as np
import pytest
import pyvista
import trimesh

from robomill.cutting.tool import Cutter
from robomill.errors import MissingExtraError, SurfaceError
from robomill.io import meshes
from robomill.io.meshes import mesh_bytes, read_stl_stock
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
    path = tmp_path / f"part.{kind}"
    path.write_bytes(mesh_bytes(zmap, kind))
    back = trimesh.load(path, force="mesh")
    assert back.volume == pytest.approx(1e9 * (np.prod(STOCK.size) - zmap.removed_volume), rel=2e-3)


def test_vtp_carries_the_error_field(tmp_path):
    pyvista = pytest.importorskip("pyvista")
    zmap = part()
    error = np.full(zmap.z.shape, 1e-5)
    error[0, 0] = 3e-5
    path = tmp_path / "part.vtp"
    path.write_bytes(mesh_bytes(zmap, ".VTP", error=error))
    back = pyvista.read(path)
    shown = back.point_data["error_um"]
    assert np.nanmax(shown) == pytest.approx(30.0)
    assert np.nanmedian(shown) == pytest.approx(10.0)
    first = np.nanargmax(shown)  # the corner of the first cell, in millimetres
    np.testing.assert_allclose(back.points[first][:2], [STOCK.lower[0] * 1e3, STOCK.lower[1] * 1e3], atol=0.51)
    assert np.isnan(shown).any(), "walls and floor have no error"
    assert back.volume == pytest.approx(1e9 * (np.prod(STOCK.size) - zmap.removed_volume), rel=2e-3)
    plain = tmp_path / "plain.vtp"
    plain.write_bytes(mesh_bytes(zmap, "vtp", max_faces=600))
    assert "error_um" not in pyvista.read(plain).point_data
    assert pyvista.read(plain).n_cells < 1000
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
    with pytest.raises(SurfaceError, match=r"not watertight \(3 open edges\)"):
        read_stl_stock(stl(open_box), name="open.stl")
    with pytest.raises(SurfaceError, match="the file is empty"):
        read_stl_stock(b"")
    with pytest.raises(SurfaceError, match=r"no triangles|not an STL"):
        read_stl_stock(b"solid nothing\nendsolid nothing\n")
    with pytest.raises(SurfaceError, match=r"no triangles|not an STL"):
        read_stl_stock(b"G1 X0 Y0\n" * 30)
    _, findings = read_stl_stock(stl(trimesh.creation.box((0.03, 0.02, 0.01))))
    assert "30.000 mm if they are metres" in findings[0].message
    stock, findings = read_stl_stock(stl(trimesh.creation.box((0.03, 0.02, 0.01))), unit="m")
    assert findings == ()
    assert stock.size[0] == pytest.approx(0.03)
    assert mesh_bytes(part()) == mesh_bytes(part(), "stl")


def test_a_stock_that_is_no_file_or_in_no_unit_is_refused(tmp_path):
    with pytest.raises(SurfaceError, match=r"^none.stl: cannot be opened \(No such file or directory\)"):
        read_stl_stock(tmp_path / "none.stl")
    with pytest.raises(SurfaceError, match=r"^STL: the unit is 'ft'; expected one of mm, in, cm, m\.$"):
        read_stl_stock(stl(trimesh.creation.box((30.0, 20.0, 10.0))), unit="ft")


@pytest.mark.parametrize(
    ("unit", "longest", "said"),
    [
        ("mm", 1.9, "only 1.900 mm long if its numbers are millimetres"),
        ("mm", 4.0, "102 mm if they are inches or 40 mm if they are centimetres"),
        ("mm", 26.0, ""),
        ("cm", 1.9, ""),
        ("in", 1.9, ""),
        ("m", 1.9e-3, ""),
        ("mm", 4900.0, ""),
        ("mm", 5100.0, "is 5100 mm long if its numbers are mm; check the unit"),
        ("in", 190.0, ""),
        ("in", 200.0, "is 5080 mm long if its numbers are in; check the unit"),
        ("m", 5.1, "is 5100 mm long if its numbers are m; check the unit"),
    ],
)
def test_sizes_that_were_hardly_meant_are_said(unit, longest, said, tmp_path):
    file = tmp_path / "stock.stl"
    file.write_bytes(stl(trimesh.creation.box((longest, longest / 2, longest / 4))))
    one = {"mm": 1e-3, "cm": 1e-2, "in": 25.4e-3, "m": 1.0}[unit]
    stock, findings = read_stl_stock(file, unit=unit)
    np.testing.assert_allclose(stock.size, np.array([1, 0.5, 0.25]) * longest * one, rtol=1e-6)
    if said:
        assert len(findings) == 1
        assert findings[0].message.startswith("stock.stl: ")
        assert said in findings[0].message
    else:
        assert findings == ()


def test_a_corner_that_is_no_number_is_refused():
    mesh = trimesh.creation.box((30.0, 20.0, 10.0))
    raw = bytearray(stl(mesh))
    raw[84 + 12 : 84 + 16] = np.float32(np.inf).tobytes()
    with pytest.raises(SurfaceError, match=r"not numbers|not watertight|cannot be read|can be read"):
        read_stl_stock(bytes(raw))


@pytest.mark.parametrize("kind", ["stl", "ply", "glb", "vtp"])
def test_a_slice_at_half_depth_shows_the_groove_where_it_is(kind, tmp_path):
    """The paper's groove stands 0.2295 mm beside its programmed middle, 8 mm wide, whatever the cells are."""
    stock = Stock((0.0, -0.01, -0.006), (0.03, 0.01, 0.0))
    p = np.array([[-0.01, 0.2295e-3, -0.002], [0.04, 0.2295e-3, -0.002]])
    file = tmp_path / f"part.{kind}"
    file.write_bytes(mesh_bytes(cut(stock, 1e-4, Cutter("flat", 8e-3), p), kind))
    if kind == "vtp":
        solid = pyvista.read(file)
        points = solid.slice(normal="z", origin=(0.0, 0.0, -1.0)).points
    else:
        solid = trimesh.load(file, force="mesh")
        points = solid.section(plane_origin=[0.0, 0.0, -1.0], plane_normal=[0.0, 0.0, 1.0]).vertices
    walls = points[(np.abs(points[:, 1]) < 9.9) & (points[:, 0] > 0.1) & (points[:, 0] < 29.9), 1]
    left, right = walls[walls > 0], walls[walls < 0]
    assert left == pytest.approx(4.2295, abs=3e-4)
    assert right == pytest.approx(-3.7705, abs=3e-4)


def test_every_triangle_of_an_stl_says_which_way_is_out():
    """Square to all its edges, of length one, and on a block (faced to its sides) away from its middle."""
    raw = mesh_bytes(cut(STOCK, 2e-3, Cutter("flat", 0.08), np.array([[0.0, 0.01, -0.001], [0.03, 0.01, -0.001]])))
    records = np.frombuffer(raw[84:], dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("unused", "<u2")])
    assert len(records) == np.frombuffer(raw[80:84], "<u4")[0]
    normal, corners = records["normal"].astype(float), records["corners"].astype(float)
    edges = np.roll(corners, -1, axis=1) - corners
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1.0, atol=1e-6)
    np.testing.assert_allclose(np.einsum("ti,tei->te", normal, edges), 0.0, atol=1e-4)
    out = corners.mean(axis=1) - 500.0 * (STOCK.lower + STOCK.upper)
    assert np.einsum("ti,ti->t", normal, out).min() > 0.0


def test_what_a_format_needs_beyond_the_core_is_named_before_anything_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyvista", None)
    monkeypatch.setattr(meshes, "_solid", lambda *_, **__: pytest.fail("a solid was made for nothing"))
    with pytest.raises(MissingExtraError, match=r"A surface as VTP needs pyvista, .*robomill\[render\]"):
        mesh_bytes(part(), "vtp")
