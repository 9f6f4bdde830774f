"""Maps as files: CSV and Parquet tables in display units, VTK image data in SI; NaN where a pose is not reached."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from robomill.arguments import asked
from robomill.arrays import FloatArray, of_kind
from robomill.csv_text import csv_text
from robomill.errors import WorkspaceError
from robomill.extras import needed
from robomill.files import check_no_folder, check_place, shown_place, written
from robomill.workspace.fields import Field, map_columns
from robomill.workspace.grid import Grid

SUFFIXES = (".csv", ".parquet", ".vti")


@asked
def write_map(path: str | Path, fields: Sequence[Field]) -> Path:
    """Quantities of a map as a file; the suffix says the format.

    Parameters
    ----------
    path : str or Path
        ``.csv`` or ``.parquet``: one row a cell, columns X_mm, Y_mm, Z_mm and one a quantity with its unit in the name;
        ``.vti``: image data in m and SI, which needs evenly spaced axes.
    fields : sequence of Field
        One or more, over the same grid.

    Returns
    -------
    Path
        The file. NaN marks cells that are not reached.

    Raises
    ------
    WorkspaceError
        For another suffix, fields over different grids, or a place that cannot be written.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import robomill as rm
    >>> found = rm.compliance_map(rm.load_robot("slavkovic_5r"), rm.Grid(x_mm=0, y_mm=-1300, z_mm=0))
    >>> file = rm.write_map(pathlib.Path(tempfile.mkdtemp()) / "map.csv", [found.field("C_yy")])
    >>> file.read_text().splitlines()[0]
    'X_mm,Y_mm,Z_mm,C_yy_um/N'
    """
    path = map_place(path)
    fields = (fields,) if isinstance(fields, Field) else fields
    for field in fields if isinstance(fields, Sequence) else (fields,):
        of_kind(field, Field, "Map", 'a list of fields, [found.field("C_yy")]', WorkspaceError)
    if not fields:
        raise WorkspaceError("Map: there is no quantity to write.")
    if any(field.grid is not fields[0].grid for field in fields):
        raise WorkspaceError("Map: the quantities of one file must share one grid.")
    names = [field.quantity.name for field in fields]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice:
        raise WorkspaceError(f"Map: {twice} is there {names.count(twice)} times; a file has one column of each.")
    with written(path, WorkspaceError) as place:
        suffix = path.suffix.lower()
        if suffix == ".vti":
            _write_vti(place, fields)
        elif suffix == ".parquet":
            _write_parquet(place, map_columns(fields))
        else:
            place.write_text(map_csv(fields), encoding="utf-8")
    return path


def map_place(path: str | Path) -> Path:
    """Where a map is written. Raises WorkspaceError for a folder, and for a name that says no format."""
    check_place(path, f"a file that ends in {', '.join(SUFFIXES)}", WorkspaceError)
    place = Path(path)
    check_no_folder(place, shown_place(path), WorkspaceError)
    suffix = place.suffix.lower()
    if suffix not in SUFFIXES:
        raise WorkspaceError(f"Map: {place.name!r} ends in {suffix or 'nothing'!r}; expected {', '.join(SUFFIXES)}.")
    return place


def map_csv(fields: Sequence[Field]) -> str:
    """The CSV text of ``write_map``."""
    return csv_text(map_columns(fields), 10, "NaN")


def _write_parquet(path: Path, columns: Mapping[str, FloatArray]) -> None:
    with needed("A map as Parquet"):
        import pyarrow as pa
        import pyarrow.parquet as pq

    pq.write_table(pa.table({name: pa.array(values) for name, values in columns.items()}), path)


def _write_vti(path: Path, fields: Sequence[Field]) -> None:
    with needed("A map as VTI"):
        import pyvista as pv

    grid = fields[0].grid
    image = pv.ImageData(
        dimensions=grid.shape,
        spacing=tuple(_even_spacing(grid, axis) for axis in "xyz"),
        origin=(grid.x[0], grid.y[0], grid.z[0]),
    )
    for field in fields:
        image.point_data[field.quantity.name] = field.values.ravel(order="F")
    image.save(path)


def _even_spacing(grid: Grid, name: str) -> float:
    axis = getattr(grid, name)
    if len(axis) == 1:
        return 1.0
    steps = np.diff(axis)
    if np.abs(steps - steps[0]).max() > 1e-9:
        raise WorkspaceError(
            f"Map: a .vti file needs evenly spaced points, and axis {name} is not; write .csv or .parquet."
        )
    return float(steps[0])
