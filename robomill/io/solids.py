"""Closed solids from files: STL, OBJ, PLY by trimesh, which follows nothing outside them, and 3MF by its own words.

A 3MF is an archive of XML: how large it unpacks and how often its parts are placed is looked at first.
"""

from __future__ import annotations

import io
import re
import zipfile
from array import array
from collections.abc import Iterator
from pathlib import PurePath
from typing import Any, Literal, get_args
from xml.etree import ElementTree

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import SurfaceError
from robomill.units import format_count, from_si, rounded, to_si

Kind = Literal["stl", "obj", "ply", "3mf"]
KINDS: tuple[Kind, ...] = get_args(Kind)
MOST_UNPACKED = 300_000_000  # bytes of the models in a 3MF
MOST_TRIANGLES = 1_600_000  # as in an STL of 80 MB
MOST_PLACED, DEEPEST = 10_000, 16
MOST_OTHERS = 100_000  # elements of a 3MF beside corners and triangles
PIECE, STILL = 1 << 20, 8  # bytes that are unpacked at a time, and how often without any element that begins
_FACE, _ELEMENTS = re.compile(rb"^[ \t]*f[ \t](.*)$", re.MULTILINE), re.compile(rb"element\s+\w+\s+(\d{1,18})")
UNITS_OF_3MF = {"micron": "um", "millimeter": "mm", "centimeter": "cm", "inch": "in", "foot": "ft", "meter": "m"}


def kind_of(name: str) -> Kind:
    """What a file is by its ending; an STL where that says nothing."""
    suffix = PurePath(name).suffix.lower().lstrip(".")
    return next((kind for kind in KINDS if kind == suffix), "stl")


def solid_of(data: bytes, kind: Kind, label: str) -> tuple[FloatArray, Any]:
    """Triangles (t, 3, 3) in the numbers of the file (of a 3MF in mm), and the solid as trimesh has it, merged at its
    corners. Raises SurfaceError for a file that is none."""
    import trimesh

    try:
        if kind == "3mf":
            solid = trimesh.Trimesh(**_of_3mf(data, label))
        else:
            _look_over(data, kind, label)
            solid = trimesh.load_mesh(io.BytesIO(data), file_type=kind)
        if kind != "stl":  # corners stand there once for each normal and each colour
            solid.merge_vertices(merge_tex=True, merge_norm=True)
        return np.asarray(solid.triangles, dtype=float), solid
    except SurfaceError:
        raise
    except Exception as exc:  # each reader has its own words for a file that is damaged
        name = kind.upper()
        text = f"{label}: this is no {name} file, or one that is damaged or cut off; export the stock again as {name}."
        raise SurfaceError(text) from exc


def _look_over(data: bytes, kind: Kind, label: str) -> None:
    """Refuse what has more triangles, or corners, than are read: an OBJ or PLY takes many times its size of memory."""
    found = [0]
    if kind == "obj":
        found += [data.count(b"\nv ") // 2, sum(max(len(face[1].split()) - 2, 0) for face in _FACE.finditer(data))]
    elif kind == "ply":
        found += [int(count) // 2 for count in _ELEMENTS.findall(data[: data.find(b"end_header")])]
    if max(found) > MOST_TRIANGLES:
        raise SurfaceError(
            f"{label}: the {kind.upper()} has more than {format_count(MOST_TRIANGLES)} triangles; export it coarser."
        )


def _of_3mf(data: bytes, label: str) -> dict[str, Any]:
    """Vertices in mm and faces of all that the build of a 3MF places."""
    models, meshes = _models(data, label)
    root = next((name for name in models if name.lower() == "3d/3dmodel.model"), next(iter(models), ""))
    if not root:
        raise SurfaceError(f"{label}: the 3MF holds no model; export the stock again as 3MF.")
    objects = {
        (name, each.get("id", "")): each
        for name, model in models.items()
        for each in model.iter()
        if _is(each, "object")
    }
    unit = UNITS_OF_3MF.get(models[root].get("unit", "millimeter"))
    if unit is None:
        raise SurfaceError(f"{label}: the unit of the 3MF is {models[root].get('unit')!r:.40}; expected millimeter.")
    scale = rounded(from_si(to_si(1.0, unit), "mm"))
    vertices: list[FloatArray] = []
    faces: list[Any] = []
    count = triangles = 0
    for item in (each for each in models[root].iter() if _is(each, "item")):
        for placed, mesh in _placed(objects, root, item, np.eye(4), label):
            corners, own = _mesh(*meshes[mesh])
            triangles += len(own)
            if triangles > MOST_TRIANGLES:
                raise SurfaceError(
                    f"{label}: the 3MF has more than {format_count(MOST_TRIANGLES)} triangles; export it coarser."
                )
            vertices.append((corners @ placed[:3, :3] + placed[3, :3]) * scale)
            faces.append((own if np.linalg.det(placed[:3, :3]) > 0 else own[:, ::-1]) + count)
            count += len(corners)
    if not faces:
        return {"vertices": np.zeros((0, 3)), "faces": np.zeros((0, 3), dtype=np.int64)}
    return {"vertices": np.vstack(vertices), "faces": np.vstack(faces)}


class _Model:
    """Takes the elements of a model as they are read: corners and triangles as numbers, the others as a tree."""

    def __init__(self, label: str) -> None:
        self.label, self.others, self.begun = label, 0, 1
        self.tree = ElementTree.TreeBuilder()
        self.meshes: dict[ElementTree.Element, tuple[array[float], array[int]]] = {}
        self.corners, self.faces = array("d"), array("q")

    def start(self, tag: str, said: dict[str, str]) -> None:
        """An element begins."""
        name = tag.rpartition("}")[2]
        self.begun += 1
        if name == "vertex":
            self.corners.extend([float(said["x"]), float(said["y"]), float(said["z"])])
        elif name == "triangle":
            self.faces.extend([int(said["v1"]), int(said["v2"]), int(said["v3"])])
        else:
            self.others += 1
            element = self.tree.start(tag, said)
            if name == "mesh":
                self.corners, self.faces = self.meshes[element] = array("d"), array("q")
        if max(len(self.corners), len(self.faces)) > 3 * MOST_TRIANGLES or self.others > MOST_OTHERS:
            raise SurfaceError(
                f"{self.label}: the 3MF has more than {format_count(MOST_TRIANGLES)} triangles or corners, "
                f"or more than {format_count(MOST_OTHERS)} other elements; export it coarser."
            )

    def end(self, tag: str) -> None:
        """It ends."""
        if tag.rpartition("}")[2] not in ("vertex", "triangle"):
            self.tree.end(tag)

    def doctype(self, _name: str, _public: str, _system: str) -> None:
        """What may declare entities."""
        raise SurfaceError(f"{self.label}: the 3MF declares entities, which no model needs; export it again.")

    def close(self) -> tuple[ElementTree.Element, dict[ElementTree.Element, tuple[array[float], array[int]]]]:
        """The tree, and what its meshes hold."""
        return self.tree.close(), self.meshes


def _models(data: bytes, label: str) -> tuple[dict[str, ElementTree.Element], dict[ElementTree.Element, Any]]:
    """The models by name, and the corners and triangles of each mesh in them."""
    left, found = MOST_UNPACKED, {}
    meshes: dict[ElementTree.Element, Any] = {}
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        for entry in (each for each in archive.infolist() if each.filename.lower().endswith(".model")):
            model = _Model(label)
            parser = ElementTree.XMLParser(target=model)
            begun = [0] * STILL
            with archive.open(entry) as stream:
                while piece := stream.read(PIECE):
                    left -= len(piece)
                    if left < 0:
                        raise SurfaceError(
                            f"{label}: the 3MF unpacks to more than {MOST_UNPACKED // 1_000_000} MB; "
                            "export the stock coarser."
                        )
                    parser.feed(piece)
                    begun = [*begun[1:], model.begun]
                    if begun[0] == begun[-1] and begun[0]:
                        raise SurfaceError(f"{label}: the 3MF holds a word of megabytes; export the stock again.")
            read: Any = parser.close()
            found[entry.filename] = read[0]
            meshes.update(read[1])
            if sum(len(faces) for _, faces in meshes.values()) > 3 * MOST_TRIANGLES:
                raise SurfaceError(
                    f"{label}: the 3MF has more than {format_count(MOST_TRIANGLES)} triangles; export it coarser."
                )
    return found, meshes


def _placed(
    objects: dict[tuple[str, str], ElementTree.Element],
    model: str,
    item: ElementTree.Element,
    T: FloatArray,
    label: str,
) -> Iterator[tuple[FloatArray, ElementTree.Element]]:
    """Every mesh of an item with where it is placed (rows of points times the matrix)."""
    waiting, placed = [(model, item, T, 0)], 0
    while waiting:
        model, item, T, depth = waiting.pop()
        placed += 1
        if depth > DEEPEST or placed > MOST_PLACED:
            raise SurfaceError(f"{label}: parts of the 3MF are placed in each other too often; export one solid.")
        named = next((value.lstrip("/") for key, value in item.attrib.items() if key.endswith("}path")), model)
        whole = objects[named, item.get("objectid", "")]
        T = _matrix(item.get("transform", "")) @ T
        for each in whole.iter():
            if _is(each, "mesh"):
                yield T, each
            elif _is(each, "component"):
                waiting.append((named, each, T, depth + 1))


def _matrix(text: str) -> FloatArray:
    T = np.eye(4)
    if text.strip():
        T[:, :3] = np.array([float(word) for word in text.split()]).reshape(4, 3)
    return T


def _mesh(corners: array[float], faces: array[int]) -> tuple[FloatArray, Any]:
    points, own = np.array(corners, dtype=float).reshape(-1, 3), np.array(faces, dtype=np.int64).reshape(-1, 3)
    if len(own) and not 0 <= own.min() <= own.max() < len(points):
        raise ValueError("a triangle names a corner that is not there")
    return points, own


def _is(element: ElementTree.Element, name: str) -> bool:
    return isinstance(element.tag, str) and element.tag.rpartition("}")[2] == name
