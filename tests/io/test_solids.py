"""Stocks from OBJ, PLY and 3MF: sizes and volumes of boxes, units, several bodies, and files that mean harm."""

from __future__ import annotations

import io
import zipfile

import numpy as np
import pytest
import trimesh

from robomill.errors import SurfaceError
from robomill.io import solids
from robomill.io.meshes import read_stl_stock

BOX = trimesh.creation.box((30.0, 20.0, 10.0))
SPACE = 'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"'


def volume(stock) -> float:
    a, b, c = np.moveaxis(np.asarray(stock.triangles), 1, 0)
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


def mesh(solid) -> str:
    corners = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in solid.vertices)
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in solid.faces)
    return f"<mesh><vertices>{corners}</vertices><triangles>{faces}</triangles></mesh>"


def packed(objects: str, build: str, unit: str = "millimeter", before: str = "") -> bytes:
    out = io.BytesIO()
    model = f'{before}<model unit="{unit}" {SPACE}><resources>{objects}</resources><build>{build}</build></model>'
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("3D/3dmodel.model", model)
    return out.getvalue()


ONE = f'<object id="1">{mesh(BOX)}</object>'


def exported(solid, kind: str) -> bytes:
    data = solid.export(file_type=kind)
    return data if isinstance(data, bytes) else data.encode()


@pytest.mark.parametrize("kind", ["stl", "obj", "ply"])
def test_a_box_in_any_format_is_the_box_and_two_are_both(kind) -> None:
    two = trimesh.util.concatenate([BOX, BOX.copy().apply_translation((100, 0, 0))])
    for solid, length in ((BOX, 30), (two, 130)):
        stock, findings = read_stl_stock(exported(solid, kind), name=f"a.{kind.upper()}")
        np.testing.assert_allclose(stock.size * 1e3, [length, 20, 10], atol=1e-5)
        assert volume(stock) * 1e9 == pytest.approx(solid.volume, rel=1e-5)
        assert findings == ()


def test_an_obj_with_faces_of_four_corners_and_normals_of_their_own_is_closed_and_follows_no_file() -> None:
    corners = "".join(f"v {x} {y} {z}\n" for z in (0, 30) for x, y in ((0, 0), (30, 0), (30, 30), (0, 30)))
    faces = ((4, 3, 2, 1), (5, 6, 7, 8), (1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8))
    lines = "".join("f " + " ".join(f"{v}//{n}" for v in face) + "\n" for n, face in enumerate(faces, 1))
    normals = "vn 0 0 -1\nvn 0 0 1\nvn 0 -1 0\nvn 1 0 0\nvn 0 1 0\nvn -1 0 0\n"
    stock, _ = read_stl_stock(f"mtllib /etc/hosts\n{corners}{normals}{lines}".encode(), name="a.obj")
    assert volume(stock) * 1e9 == pytest.approx(27_000.0)


@pytest.mark.parametrize(
    ("unit", "times"), [("millimeter", 1.0), ("inch", 25.4), ("centimeter", 10.0), ("micron", 1e-3)]
)
def test_a_3mf_says_its_unit(unit, times) -> None:
    stock, _ = read_stl_stock(packed(ONE, '<item objectid="1"/>', unit), unit="in", name="a.3mf")
    np.testing.assert_allclose(stock.size * 1e3, np.array([30, 20, 10]) * times)


def test_three_bodies_of_a_3mf_of_different_corners_keep_their_own() -> None:
    ball, bar = trimesh.creation.icosphere(1, 8.0), trimesh.creation.cylinder(4.0, 12.0, sections=7)
    bodies = [BOX, ball.apply_translation((60, 0, 0)), bar.apply_translation((0, 60, 0))]
    objects = "".join(f'<object id="{n}">{mesh(each)}</object>' for n, each in enumerate(bodies, 1))
    build = "".join(f'<item objectid="{n}"/>' for n in (1, 2, 3))
    stock, _ = read_stl_stock(packed(objects, build), name="a.3mf")
    assert volume(stock) * 1e9 == pytest.approx(sum(each.volume for each in bodies), rel=1e-5)


def test_items_and_components_of_a_3mf_are_placed() -> None:
    pair = '<object id="2"><components><component objectid="1"/>'
    pair += '<component objectid="1" transform="0 1 0 -1 0 0 0 0 1 100 0 0"/></components></object>'
    stock, _ = read_stl_stock(
        packed(ONE + pair, '<item objectid="2" transform="1 0 0 0 1 0 0 0 1 0 0 5"/>'), name="a.3mf"
    )
    np.testing.assert_allclose(stock.lower * 1e3, [-15, -15, 0], atol=1e-9)
    np.testing.assert_allclose(stock.upper * 1e3, [110, 15, 10], atol=1e-9)
    assert volume(stock) * 1e9 == pytest.approx(12_000.0)


ROUND = '<object id="1"><components><component objectid="1"/></components></object>'
MANY = ONE + "".join(
    f'<object id="{k}"><components>' + f'<component objectid="{k - 1}"/>' * 20 + "</components></object>"
    for k in range(2, 12)
)
OPEN = trimesh.Trimesh(BOX.vertices, BOX.faces[1:], process=False)


@pytest.mark.parametrize(
    ("data", "name", "said"),
    [
        (packed(ROUND, '<item objectid="1"/>'), "a.3mf", "placed in each other too often"),
        (packed(MANY, '<item objectid="11"/>'), "a.3mf", "placed in each other too often"),
        (
            packed(ONE, '<item objectid="1"/>', before="<!DOCTYPE model [<!ENTITY a 'b'>]>"),
            "a.3mf",
            "declares entities",
        ),
        (packed(ONE, '<item objectid="7"/>'), "a.3mf", "this is no 3MF file"),
        (packed(ONE, ""), "a.3mf", "the 3MF holds no triangles"),
        (packed(f'<object id="1">{mesh(OPEN)}</object>', '<item objectid="1"/>'), "a.3mf", "not watertight"),
        (b"PK\3\4 and nothing", "a.3mf", "this is no 3MF file"),
        (b"G1 X0\n", "a.obj", "the OBJ holds no triangles|this is no OBJ"),
        (b"ply\nformat ascii 1.0\nelement vertex 3\nend_header\n", "a.ply", "this is no PLY|holds no triangles"),
        (exported(OPEN, "obj"), "a.obj", r"not watertight \(3 open edges\)"),
    ],
)
def test_what_is_no_closed_solid_is_refused(data, name, said) -> None:
    with pytest.raises(SurfaceError, match=said):
        read_stl_stock(data, name=name)


def test_an_archive_that_unpacks_to_too_much_is_refused(monkeypatch) -> None:
    monkeypatch.setattr("robomill.io.solids.MOST_UNPACKED", 10_000)
    with pytest.raises(SurfaceError, match="unpacks to more than"):
        read_stl_stock(packed(ONE + " " * 100_000, '<item objectid="1"/>'), name="a.3mf")


PLY = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face {}\n"
PLY += "property list uchar int vertex_indices\nend_header\n0 0 0\n"


@pytest.mark.parametrize(
    ("kind", "data", "said"),
    [
        ("3mf", packed("<a/>" * 150_000, ""), "100.000 other elements"),
        ("3mf", packed("<a>" * 150_000, ""), "100.000 other elements"),
        ("3mf", packed('<vertex x="1" y="1" z="1"/>' * 1_100, ""), "more than 1000 triangles or corners"),
        ("3mf", packed(f'<a b="{"x" * 12_000_000}"/>', ""), "a word of megabytes"),
        ("obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf " + b"1 2 3 " * 400, "more than 1000 triangles"),
        ("obj", b"v 0 0 0\n" * 2_100, "more than 1000 triangles"),
        ("ply", PLY.format(999_999_999_999).encode(), "more than 1000 triangles"),
    ],
)
def test_what_inflates_is_refused_before_it_takes_much_memory(monkeypatch, kind, data, said) -> None:
    monkeypatch.setattr(solids, "MOST_TRIANGLES", 1_000)
    with pytest.raises(SurfaceError, match=said):
        read_stl_stock(data, name=f"a.{kind}")
