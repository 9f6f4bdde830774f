"""Values as files, the place first: ``write_robot("arm.toml", robot)``. Each is written whole or not at all."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from robomill.arguments import asked
from robomill.cutting.materials import Material
from robomill.errors import CuttingError, ProjectError, RobomillError, RobotError, SurfaceError, ToolpathError
from robomill.files import shown_place, write_whole
from robomill.io.gcode_out import toolpath_to_gcode
from robomill.io.materials import material_to_toml
from robomill.io.meshes import MOST_TRIANGLES, mesh_bytes
from robomill.io.robot.robots import is_urdf
from robomill.io.robot.urdf_writer import robot_to_urdf
from robomill.io.robot.writer import robot_to_toml
from robomill.io.setups.projects import setup_to_toml
from robomill.robot.model import Robot
from robomill.simulation.setup import SimulationSetup
from robomill.surface.zmap import ZMap
from robomill.toolpath.path import Toolpath
from robomill.toolpath.text import check_program_name

FEWEST_FACES = 12  # of a box
WHOSE = {
    Robot: "a Robot",
    SimulationSetup: "a SimulationSetup",
    Toolpath: "a Toolpath (of a set-up: setup.toolpath)",
    Material: "a material row",
    ZMap: "a ZMap (of a run: result.machined or result.ideal)",
}
"""What is written, and where it is found."""


@asked
def write_robot(path: str | Path, robot: Robot) -> Path:
    """A robot as a file that ``load_robot`` reads.

    Parameters
    ----------
    path : str or Path
        ``.toml`` reads back equal; ``.urdf`` holds the geometry alone.
    robot : Robot
        The arm.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    RobotError
        For a place that cannot be written.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import robomill as rm
    >>> robot = rm.load_robot("slavkovic_5r")
    >>> rm.load_robot(rm.write_robot(pathlib.Path(tempfile.mkdtemp()) / "arm.toml", robot)) == robot
    True
    """
    _check(path, robot, Robot, RobotError, (".toml", ".urdf"))
    return write_whole(path, robot_to_urdf(robot) if is_urdf(str(path)) else robot_to_toml(robot), RobotError)


@asked
def write_setup(path: str | Path, setup: SimulationSetup) -> Path:
    """A set-up as one self-contained TOML file.

    Parameters
    ----------
    path : str or Path
        Where it shall stand.
    setup : SimulationSetup
        The set-up.

    Returns
    -------
    Path
        The file; ``load_setup`` reads it back equal.

    Raises
    ------
    ProjectError
        For a place that cannot be written.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import robomill as rm
    >>> setup = rm.load_setup("paper_flute")
    >>> rm.load_setup(rm.write_setup(pathlib.Path(tempfile.mkdtemp()) / "copy.toml", setup)) == setup
    True
    """
    _check(path, setup, SimulationSetup, ProjectError, (".toml",))
    return write_whole(path, setup_to_toml(setup), ProjectError)


@asked
def write_material(path: str | Path, material: Material) -> Path:
    """A material row as a TOML file.

    Parameters
    ----------
    path : str or Path
        Where it shall stand.
    material : Material
        The row.

    Returns
    -------
    Path
        The file; ``load_material`` reads it back equal.

    Raises
    ------
    CuttingError
        For a place that cannot be written.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import robomill as rm
    >>> row = rm.load_material("al7075_t6_carbide_ref190")
    >>> rm.load_material(rm.write_material(pathlib.Path(tempfile.mkdtemp()) / "row.toml", row)) == row
    True
    """
    _check(path, material, Material, CuttingError, (".toml",))
    return write_whole(path, material_to_toml(material), CuttingError)


@asked
def write_gcode(path: str | Path, toolpath: Toolpath, *, units: str = "mm", title: str = "") -> Path:
    """A toolpath as a G-code program.

    Parameters
    ----------
    path : str or Path
        Where it shall stand.
    toolpath : Toolpath
        The path.
    units : str
        "mm" (G21) or "in" (G20).
    title : str
        A remark at the top.

    Returns
    -------
    Path
        The file; read again it gives the same path.

    Raises
    ------
    ToolpathError
        For a cut without feed, or a spindle speed that is not known; GCodeError, one of them, for a name that ends as
        another file's.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import robomill as rm
    >>> path = rm.Toolpath.from_points(p_mm=[[0, 0, -2], [50, 0, -2]], feed_mm_min=600)
    >>> file = rm.write_gcode(pathlib.Path(tempfile.mkdtemp()) / "slot.nc", path)
    >>> float(rm.read_gcode(file).s[-1])
    0.05
    """
    _check(path, toolpath, Toolpath, ToolpathError)
    check_program_name(Path(path))
    return write_whole(path, toolpath_to_gcode(toolpath, units=units, title=title), ToolpathError)


@asked
def write_stl(path: str | Path, surface: ZMap, *, max_faces: int = MOST_TRIANGLES) -> Path:
    """A part as a closed solid in millimetres, binary STL.

    Parameters
    ----------
    path : str or Path
        Where it shall stand.
    surface : ZMap
        ``result.machined`` or ``result.ideal``.
    max_faces : int
        About so many triangles, 50 bytes each: a finer surface is thinned out to them.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    SurfaceError
        For a place that cannot be written or whose name does not end in ``.stl``, and for a surface of which nothing
        is cut: a path that is not reached leaves the stock as it was.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import robomill as rm
    >>> from robomill.surface.zmap import cut
    >>> stock = rm.Stock(lower_mm=(-10, -10, -5), upper_mm=(30, 10, 0))
    >>> part = cut(stock, 1e-3, rm.Cutter("flat", diameter_mm=8, flutes=3), [[0.0, 0.0, -2e-3], [0.02, 0.0, -2e-3]])
    >>> rm.write_stl(pathlib.Path(tempfile.mkdtemp()) / "part.stl", part).stat().st_size > 1000
    True
    """
    _check(path, surface, ZMap, SurfaceError)
    if Path(path).suffix.lower() != ".stl":
        raise SurfaceError(f"{shown_place(path)}: this is written as STL; give it a name that ends in .stl.")
    if not isinstance(max_faces, int | np.integer) or max_faces < FEWEST_FACES:
        raise SurfaceError(f"Write: max_faces is {max_faces!r:.40}; expected a whole number, {FEWEST_FACES} or more.")
    if surface.removed_volume <= 0.0:
        raise SurfaceError(
            f"{shown_place(path)}: nothing is cut from this surface, it is the stock as it was; see the verdict of the "
            "run for what is not reached, or not touched."
        )
    return write_whole(path, mesh_bytes(surface, "stl", max_faces=max_faces), SurfaceError)


def _check(path: Any, value: Any, kind: type, error: type[RobomillError], ends: Sequence[str] = ()) -> None:
    if not isinstance(path, str | Path) or not isinstance(value, kind):
        found = f"{type(path).__name__}, {type(value).__name__}"
        raise error(f"Write: expected a file's name and then {WHOSE[kind]}, found {found}.")
    if ends and Path(path).suffix.lower() not in ends:
        raise error(f"{shown_place(path)}: expected a name that ends in {' or '.join(ends)}.")
