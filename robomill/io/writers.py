"""Values as files, the place first: ``write_robot("arm.toml", robot)``. Each is written whole or not at all."""

from pathlib import Path
from typing import Any

from robomill.cutting.materials import Material
from robomill.errors import CuttingError, ProjectError, RobomillError, RobotError, SurfaceError, ToolpathError
from robomill.files import written
from robomill.io.gcode_out import toolpath_to_gcode
from robomill.io.materials import material_to_toml
from robomill.io.meshes import mesh_bytes
from robomill.io.projects import setup_to_toml
from robomill.io.robots import is_urdf, robot_to_toml
from robomill.io.urdf_writer import robot_to_urdf
from robomill.robot.model import Robot
from robomill.simulation.setup import SimulationSetup
from robomill.surface.zmap import ZMap
from robomill.toolpath.path import Toolpath

MOST_FACES = 2_000_000


def write_robot(path: str | Path, robot: Robot) -> Path:
    """A robot as TOML that ``load_robot`` reads back equal; as ``.urdf`` its geometry alone. Raises RobotError."""
    _check(path, robot, Robot, RobotError)
    return _write(path, robot_to_urdf(robot) if is_urdf(str(path)) else robot_to_toml(robot), RobotError)


def write_setup(path: str | Path, setup: SimulationSetup) -> Path:
    """A set-up as one self-contained TOML that ``load_setup`` reads back to the same digest. Raises ProjectError."""
    _check(path, setup, SimulationSetup, ProjectError)
    return _write(path, setup_to_toml(setup), ProjectError)


def write_material(path: str | Path, material: Material) -> Path:
    """A material row as TOML that ``load_material`` reads back equal. Raises CuttingError."""
    _check(path, material, Material, CuttingError)
    return _write(path, material_to_toml(material), CuttingError)


def write_gcode(path: str | Path, toolpath: Toolpath, *, units: str = "mm", title: str = "") -> Path:
    """A toolpath as a G-code program, in ``units`` "mm" (G21) or "in" (G20); read again, it gives the same path.

    Raises ToolpathError for a cut without feed or a spindle speed that is not known.
    """
    _check(path, toolpath, Toolpath, ToolpathError)
    return _write(path, toolpath_to_gcode(toolpath, units=units, title=title), ToolpathError)


def write_stl(path: str | Path, surface: ZMap, *, max_faces: int = MOST_FACES) -> Path:
    """A part (``result.machined`` or ``result.ideal``) as a closed solid in millimetres, binary STL.

    About ``max_faces`` triangles at most, 50 bytes each: a finer surface is thinned out. Raises SurfaceError.
    """
    _check(path, surface, ZMap, SurfaceError)
    return _write(path, mesh_bytes(surface, "stl", max_faces=max_faces), SurfaceError)


def _check(path: Any, value: Any, kind: type, error: type[RobomillError]) -> None:
    if not isinstance(path, str | Path) or not isinstance(value, kind):
        found = f"{type(path).__name__}, {type(value).__name__}"
        raise error(f"Write: expected a file's name and then a {kind.__name__}, found {found}.")


def _write(path: str | Path, content: str | bytes, error: type[RobomillError]) -> Path:
    with written(path, error) as place:
        place.write_bytes(content.encode() if isinstance(content, str) else content)
    return Path(path)
