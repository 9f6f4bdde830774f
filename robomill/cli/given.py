"""What a command is given by name: a file, a sample, or what comes in by standard input (``-``)."""

import re
import sys
from pathlib import Path
from typing import Any

from robomill.errors import (
    GCodeError,
    LoadTestError,
    ProjectError,
    RobomillError,
    RobotError,
    SetupError,
    ToolpathError,
)
from robomill.files import (
    DRAWING,
    PROGRAM,
    ROBOT,
    SETUP,
    STUDY,
    TABLE,
    TOOLS,
    FileKind,
    check_folder_there,
    check_no_folder,
    check_size,
    name_of,
    read_file,
)
from robomill.io.samples import find_sample, sample_or_file
from robomill.toolpath.text import check_program_name
from robomill.wording import listed

STDIN, CALLED = "-", "standard input"
BEGINNING = b"\xef\xbb\xbf \t\r\n"  # what may stand before the first word of a text


def check_once(arguments: Any) -> None:
    """Refuse standard input for two things, and as a place to write to. Raises RobomillError."""
    said = {name for name, value in vars(arguments).items() if value == STDIN}
    if said & {"out", "sheet", "moves", "copy"}:
        raise RobomillError(f"{STDIN!r} is standard input, which cannot be written to; give the name of a file.")
    if len(said) > 1:
        raise RobomillError(f"{STDIN!r} stands for standard input, which can be read once; name a file for the others.")


def check_kept(arguments: Any) -> None:
    """Refuse to write over what is read, and to write nowhere. Raises RobomillError."""
    said = vars(arguments)
    read = ("robot", "tests", "file", "setup", "program", "wanted", "tools")
    reads = [Path(said[name]) for name in read if said.get(name)]
    written: list[Path] = []
    for name in ("out", "sheet", "moves"):
        if said.get(name) is None:
            continue
        if not said[name].strip():
            raise RobomillError(f"--{name}: the name is empty; give one, or leave the option out.")
        place = Path(said[name])
        if any(_same(place, each) for each in reads):
            raise RobomillError(
                f"--{name} {place}: what this run reads stands there and would be replaced; give another."
            )
        if any(place.resolve() == each.resolve() for each in written):
            raise RobomillError(f"--{name} {place}: another option writes there already; give another.")
        if name in arguments.writes:
            _check_name(f"--{name} {place}", place, arguments.writes[name])
        if not arguments.makes:
            check_folder_there(place, f"--{name} {place}", RobomillError)
        written.append(place)


def _check_name(given: str, place: Path, written: Any) -> None:
    """Refuse a name by which nobody would find again what is written. Raises RobomillError."""
    check_no_folder(place, given, RobomillError)
    if not written.ends:
        check_program_name(place)
    elif place.suffix.lower() not in written.ends:
        told = listed(written.ends, "or")
        raise RobomillError(f"{given}: {written.what} is written there; give a name that ends in {told}.")


def _same(place: Path, read: Path) -> bool:
    """Whether a place to write to is a file that is read, whatever it is called there; a device may be both."""
    try:
        return read.is_file() and (place.resolve() == read.resolve() or place.samefile(read))
    except (OSError, ValueError):
        return False


def stdin(kind: FileKind, error: type[RobomillError]) -> bytes:
    """All that comes in, up to what its ``kind`` may hold."""
    stream = getattr(sys.stdin, "buffer", None)
    data: bytes = b"" if stream is None else stream.read(kind.most + 1)
    check_size(len(data), kind, error, CALLED)
    if not data.strip():
        raise error(f"{CALLED}: nothing came in; expected {kind.expected}.")
    return data


def check_tip(arguments: Any) -> None:
    """Refuse a link where no robot is named: it would change nothing, without a word."""
    if arguments.tip and not arguments.robot:
        raise RobotError("--tip: it is a link of the URDF that --robot names; give both, or leave it out.")


def robot(name: str, tip: str | None = None) -> Any:
    """The robot called so, of a file, or of standard input; of a URDF up to the link ``tip``."""
    from robomill.io.robot.robots import load_robot, read_robot

    if name != STDIN:
        return load_robot(name, tip=tip)
    data = stdin(ROBOT, RobotError)
    return read_robot(data, "stdin.urdf" if data.lstrip().startswith(b"<") else "stdin.toml", tip)


def setup(name: str, allow_outside: bool) -> Any:
    """The set-up of a sample, a file, or standard input, which names files in the folder in which one stands."""
    from robomill.io.beside import Beside
    from robomill.io.setups.projects import load_setup, setup_from_toml
    from robomill.io.texts import read_text

    if name != STDIN:
        return load_setup(name, allow_outside)
    text, _ = read_text(stdin(SETUP, ProjectError), ProjectError, SETUP, CALLED)
    return setup_from_toml(text, CALLED, Beside(Path.cwd(), allow_outside))


def study(name: str, allow_outside: bool) -> Any:
    """The study of a sample, a file, or standard input, which names a set-up in the folder in which one stands."""
    from robomill.errors import StudyError
    from robomill.io.beside import Beside
    from robomill.io.texts import read_text
    from robomill.study.described import load_study, study_from_toml

    if name != STDIN:
        return load_study(name, allow_outside)
    text, _ = read_text(stdin(STUDY, StudyError), StudyError, STUDY, CALLED)
    return study_from_toml(text, CALLED, Beside(Path.cwd(), allow_outside))


def come_in(name: str) -> bytes | None:
    """What comes in by standard input in place of a program's or a table's file; None where a file is named."""
    return stdin(PROGRAM, GCodeError) if name == STDIN else None


def program(name: str) -> Path | bytes:
    """The file of a program; where that is a stream, which can be read once, what comes out of it."""
    file = sample_or_file("program", name, GCodeError)
    if file.suffix.lower() == ".toml":
        raise GCodeError(
            f"{name_of(file)}: this is TOML (a set-up, a robot, a material), not a program; give its program."
        )
    return file if file.is_file() else read_file(file, PROGRAM, GCodeError)


def source(name: str, unit: str = "", feed_mm_min: float | None = None) -> Any:
    """A program, or points, as the path of a set-up."""
    from robomill.io.drawing.drawings import SUFFIXES
    from robomill.io.programs import program_from_bytes, read_program

    data = come_in(name)
    if Path(name).suffix.lower() in SUFFIXES:
        raise ProjectError(f"{name}: this is a drawing; make a program of it with 'robomill drawing', and name that.")
    found = points(name, unit, feed_mm_min, data)
    if found:
        return found
    check_points_options(name if data is None else CALLED, unit, feed_mm_min)
    return read_program(name) if data is None else program_from_bytes(data, "stdin.nc")


def check_points_options(name: str, unit: str, feed_mm_min: float | None) -> None:
    """Refuse what is said of points where ``name`` names none: it would change nothing, without a word."""
    said = "--feed" if feed_mm_min is not None else "--unit" if unit else ""
    if said:
        what = f"{name} is a program, which says its own" if name else "the set-up's own path says its own"
        raise ProjectError(f"{said}: this is for a table of points (.csv, .parquet); {what}.")


def points(name: str, unit: str = "", feed_mm_min: float | None = None, data: bytes | None = None) -> Any:
    """A table of points as the path of a set-up; None where the name ends otherwise, or ``data`` begin otherwise."""
    from robomill.files import POINTS
    from robomill.io.point_tables import SUFFIXES, points_from_bytes
    from robomill.spelled import one_of
    from robomill.toolpath.path import FEED

    if not (Path(name).suffix.lower() in SUFFIXES if data is None else is_table(data)):
        return None
    feed = None if feed_mm_min is None else one_of(FEED, None, feed_mm_min, ToolpathError, "--feed")
    if data is not None:
        return points_from_bytes(data, "stdin.csv", unit, feed)
    return points_from_bytes(read_file(name, POINTS, ToolpathError), name_of(name), unit, feed)


def is_table(data: bytes) -> bool:
    """Whether a text begins as a table of points does: with a row that names X, Y and Z."""
    head = next((line for line in data[:10_000].splitlines() if line.strip(BEGINNING) and line[:1] != b"#"), b"")
    words = re.split(r"[,;\t]", head.decode("utf-8-sig", "replace").lower())
    return {"x", "y", "z"} <= {re.split(r"[^a-z]", word.strip().strip('"'))[0] for word in words}


def load_tests(name: str, robot: Any) -> tuple[Any, str]:
    """Load tests, and what they are called."""
    from robomill.io.measured.load_tests import read_load_tests
    from robomill.io.texts import read_text

    if name == STDIN:
        text, _ = read_text(stdin(TABLE, LoadTestError), LoadTestError, TABLE, CALLED)
        return read_load_tests(f"{text}\n", robot), CALLED
    return read_load_tests(name, robot), name_of(find_sample("load tests", name) or name)


def drawing(name: str, unit: str) -> Any:
    """A drawing; what comes in by standard input is told by how it begins."""
    from robomill.io.drawing.drawings import drawing_from_bytes, read_drawing

    if name != STDIN:
        return read_drawing(name, unit=unit)
    data = stdin(DRAWING, ToolpathError)
    return drawing_from_bytes(data, f"stdin{'.svg' if data.lstrip(BEGINNING).startswith(b'<') else '.dxf'}", unit)


def tools(name: str, unit: str) -> Any:
    """A tool table."""
    from robomill.errors import CuttingError
    from robomill.io.setups.tool_tables import read_tool_table

    if name == STDIN:
        return read_tool_table(stdin(TOOLS, CuttingError), unit=unit, name=CALLED)
    return read_tool_table(name, unit=unit)


def is_apt(source: Path | bytes) -> bool:
    """Whether a program is a cutter location file."""
    from robomill.toolpath import text

    if isinstance(source, bytes):
        return text.is_apt(source)
    try:
        with source.open("rb") as stream:
            return text.is_apt(stream.read(200_000))
    except OSError:
        return False  # the interpreter says what is wrong with the file


def another_robot(arguments: Any, setup: Any) -> Any:
    """The robot that ``--robot`` names in the place of the set-up's. Raises SetupError where that one was measured."""
    if setup.measured_map is not None:
        raise SetupError("--robot: the set-up's compliances were measured on its own robot ([measured_map]).")
    return robot(arguments.robot, arguments.tip)
