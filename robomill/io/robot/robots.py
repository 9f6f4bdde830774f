"""Robots by name or from a file: the presets under samples/robots, TOML and URDF files."""

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

from robomill.arguments import asked
from robomill.errors import RobotError
from robomill.files import ROBOT, name_of, read_file
from robomill.io.robot.reader import robot_from_toml
from robomill.io.robot.urdf import read_urdf
from robomill.io.samples import sample_names, sample_or_file
from robomill.io.texts import read_text
from robomill.robot.model import Robot


def robot_names() -> list[str]:
    """Names of the robots that come with robomill, as ``load_robot`` takes them.

    Returns
    -------
    list of str
        Sorted.

    Examples
    --------
    >>> import robomill as rm
    >>> "slavkovic_5r" in rm.robot_names()
    True
    """
    return sample_names("robot")


@lru_cache(maxsize=1)
def robot_titles() -> Mapping[str, str]:
    """What the robots that come with robomill are called, by name."""
    return {name: load_robot(name).title or name for name in robot_names()}


@asked
def load_robot(name_or_path: str | Path, *, tip: str | None = None) -> Robot:
    """A robot by the name of a preset, or from a file.

    Parameters
    ----------
    name_or_path : str or Path
        One of ``robot_names()``, or a ``.toml`` or ``.urdf`` file.
    tip : str, optional
        Of a URDF, the link at which the arm ends (default: its only end link).

    Returns
    -------
    Robot
        In SI; of a URDF compliances are assumed, and its provenance says so.

    Raises
    ------
    RobotError
        For a name that is no preset and no file, and with file and key for what cannot be a robot.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.load_robot("slavkovic_5r")
    <Robot slavkovic_5r: 5 joints, standard D-H, compliance set 'table_2'>
    """
    path = sample_or_file("robot", name_or_path, RobotError)
    data, name = read_file(path, ROBOT, RobotError), name_of(path)
    return read_robot(data, name, tip)


def is_urdf(name: str) -> bool:
    """Whether a file of this name is read as a URDF."""
    return Path(name).suffix.lower() in (".urdf", ".xml", ".xacro")


def read_robot(data: bytes, name: str, tip: str | None = None) -> Robot:
    """The robot of a file's bytes: URDF or TOML, as its ``name`` ends. Raises RobotError."""
    if is_urdf(name):
        return read_urdf(data, tip=tip, where=name)
    if tip is not None:
        raise RobotError(f"Robot {name!r:.80}: only a URDF has links; leave the tip {tip!r:.40} out.", where="tip")
    return robot_from_toml(*read_text(data, RobotError, ROBOT, name))
