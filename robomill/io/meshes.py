"""Meshes in and out: the part as STL, PLY, GLB or VTP, a stock from a solid; in millimetres, as CAM expects."""

from pathlib import Path

import numpy as np

from robomill.arguments import asked
from robomill.arrays import FloatArray
from robomill.errors import MissingExtraError, SurfaceError
from robomill.extras import missing
from robomill.files import STL, check_size, read_file
from robomill.io.solids import kind_of, solid_of
from robomill.progress import slices
from robomill.provenance import Finding
from robomill.spelled import made
from robomill.surface.mesh import Mesh, kept_cells, to_mesh
from robomill.surface.stock import Stock
from robomill.surface.zmap import ZMap
from robomill.units import format_si, from_si, to_si

HEAD = b"robomill, millimetres".ljust(80)
FORMATS = ("stl", "ply", "glb", "vtp")
FEW_TRIANGLES, MOST_TRIANGLES = 150_000, 2_000_000  # of a solid that is taken away: an STL below 10 MB, and all of it
WALLS, TRIES = 1.33, 6  # with its walls a solid has at most so many times the triangles asked for: 199 500 are 9.98 MB
UNITS_OF_STL = {"mm": "millimetres", "in": "inches", "cm": "centimetres", "m": "metres"}
# A part shorter than this many numbers, or longer than this, was hardly meant: such a stock is questioned.
SMALLEST_MM, LARGEST = 25.0, 5.0  # mm, m


def absent(kind: str) -> MissingExtraError | None:
    """Why a solid cannot be written in this format where its extra is not installed."""
    return missing("A surface as VTP", "render", "pyvista") if kind == "vtp" else None


def mesh_bytes(
    zmap: ZMap, kind: str = "stl", *, error: FloatArray | None = None, max_faces: int = MOST_TRIANGLES
) -> bytes:
    """The part as a closed solid in a file's bytes; ``kind`` is one of FORMATS.

    ``error`` (nx, ny) m, if given, goes along as a field in um: as scalars in VTP, ignored by the other formats.
    Raises SurfaceError for a format that is not known.
    """
    name = kind.lower().lstrip(".")
    if name not in FORMATS:
        raise SurfaceError(f"Mesh format {kind!r} is not known: use {', '.join(FORMATS)}.")
    refusal = absent(name)
    if refusal is not None:
        raise refusal
    mesh, aimed = _solid(zmap, max_faces)
    if name == "vtp":
        return _vtp(zmap, mesh, error, aimed)
    if name == "stl":
        return _stl(mesh)
    import trimesh

    solid = trimesh.Trimesh(from_si(mesh.vertices, "mm"), mesh.faces, process=False)
    data = solid.export(file_type=name)
    return data if isinstance(data, bytes) else str(data).encode()


def _solid(zmap: ZMap, max_faces: int) -> tuple[Mesh, int]:
    """The solid, and the triangles aimed at in its skin: fewer than ``max_faces`` where its walls need many."""
    aimed, mesh = max_faces, to_mesh(zmap, max_faces=max_faces)
    for _ in range(TRIES):
        if len(mesh.faces) <= WALLS * max_faces:
            break
        aimed = int(0.95 * aimed * WALLS * max_faces / len(mesh.faces))
        mesh = to_mesh(zmap, max_faces=aimed)
    return mesh, aimed


def _stl(mesh: Mesh) -> bytes:
    """Binary STL: a head, how many triangles there are, and each with its normal; a bundle of them at a time."""
    vertices = from_si(mesh.vertices, "mm")
    records = np.zeros(len(mesh.faces), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("unused", "<u2")])
    for some in slices(len(mesh.faces), "Triangles"):
        a, b, c = (vertices[mesh.faces[some, k]] for k in range(3))
        normal = np.cross(b - a, c - a)
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        records["normal"][some] = normal / np.where(length > 0.0, length, 1.0)
        records["corners"][some] = np.stack([a, b, c], axis=1)
    return b"".join([HEAD, np.uint32(len(records)).astype("<u4").tobytes(), records.tobytes()])


def _vtp(zmap: ZMap, mesh: Mesh, error: FloatArray | None, max_faces: int) -> bytes:
    import tempfile

    import pyvista

    faces = np.column_stack([np.full(len(mesh.faces), 3), mesh.faces]).ravel()
    surface = pyvista.PolyData(from_si(mesh.vertices, "mm"), faces)
    if error is not None:
        of_cells = from_si(error[np.ix_(*kept_cells(zmap.z.shape, max_faces))], "um").ravel()
        field = np.where(mesh.owner >= 0, of_cells[mesh.owner], np.nan)
        surface.point_data["error_um"] = field
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "part.vtp"
        surface.save(target, compression="lz4")  # a quarter of the time, twice the size
        return target.read_bytes()


@asked
def read_stock(path: str | Path, *, unit: str = "mm") -> Stock:
    """The stock from a file of a solid: STL, OBJ, PLY or 3MF.

    Parameters
    ----------
    path : str or Path
        A closed mesh, of one body or several.
    unit : str
        Of its numbers: "mm", "in", "cm" or "m"; a 3MF says it itself.

    Returns
    -------
    Stock
        In m, in {W}. A size that makes the unit doubtful is said by ``warnings``, and among the findings of a run.

    Raises
    ------
    SurfaceError
        For a file that cannot be read, or a mesh that is not closed.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import robomill as rm
    >>> from robomill.surface.zmap import cut
    >>> block = rm.Stock(lower_mm=(-10, -10, -5), upper_mm=(30, 10, 0))
    >>> part = cut(block, 1e-3, rm.Cutter("flat", diameter_mm=8, flutes=3), [[0.0, 0.0, -2e-3], [0.02, 0.0, -2e-3]])
    >>> rm.read_stock(rm.write_stl(pathlib.Path(tempfile.mkdtemp()) / "part.stl", part)).size.round(6).tolist()
    [0.04, 0.02, 0.005]
    """
    return read_stl_stock(path, unit=unit)[0]


def read_stl_stock(
    source: str | Path | bytes, *, unit: str = "mm", name: str = ""
) -> tuple[Stock, tuple[Finding, ...]]:
    """A stock from an STL, OBJ, PLY or 3MF file (path or bytes, by the ending of its name), and what is odd about it.

    ``unit`` ("mm", "in", "cm" or "m") is what its numbers are taken as; a 3MF says its unit itself. Raises SurfaceError
    for a file that is empty, none of these, or not watertight.
    """
    label = name or (Path(source).name if isinstance(source, str | Path) else "STL")
    data = source if isinstance(source, bytes) else read_file(source, STL, SurfaceError, said=label)
    check_size(len(data), STL, SurfaceError, label)
    if unit not in UNITS_OF_STL:
        raise SurfaceError(f"{label}: the unit is {unit!r}; expected one of {', '.join(UNITS_OF_STL)}.")
    kind = kind_of(label)
    unit = "mm" if kind == "3mf" else unit
    if not data.strip():
        raise SurfaceError(f"{label}: the file is empty; export the stock again as {kind.upper()}.")
    numbers, solid = solid_of(data, kind, label)
    if len(numbers) == 0:
        raise SurfaceError(f"{label}: the {kind.upper()} holds no triangles; export the stock as a closed solid.")
    if not np.isfinite(solid.vertices).all():
        raise SurfaceError(f"{label}: the {kind.upper()} has corners that are not numbers; export it again.")
    if not solid.is_watertight:
        edges = int((np.bincount(solid.edges_unique_inverse) != 2).sum())
        raise SurfaceError(
            f"{label}: the mesh is not watertight ({edges} open edges); close it in CAD before using it as a stock."
        )
    triangles = to_si(numbers, unit)
    corners = triangles.reshape(-1, 3)
    known = {"lower": corners.min(axis=0), "upper": corners.max(axis=0), "triangles": triangles}
    return made(Stock, known), _size_findings(label, solid.extents, unit)


def _size_findings(label: str, extents: FloatArray, unit: str) -> tuple[Finding, ...]:
    longest = float(np.max(extents))
    shown = {name: format_si(float(to_si(longest, name)), "mm", 3 if longest < 2.0 else 0) for name in UNITS_OF_STL}
    if to_si(longest, unit) > LARGEST:
        text = f"{label}: the part is {shown[unit]} long if its numbers are {unit}; check the unit of the file."
    elif unit == "mm" and longest < SMALLEST_MM:
        others = " or ".join(f"{shown[name]} if they are {UNITS_OF_STL[name]}" for name in ("in", "cm", "m"))
        text = (
            f"{label}: the part is only {shown[unit]} long if its numbers are millimetres; it would be {others}: "
            "choose the unit that was meant."
        )
    else:
        return ()
    return (Finding("suspicious", text, code="stock-unit"),)
