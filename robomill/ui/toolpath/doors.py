"""One box for whatever a path comes in, told apart by its ending: a program, a table of points, a drawing."""

from pathlib import PurePath

from robomill.files import PROGRAM
from robomill.io import point_tables
from robomill.io.drawing import drawings
from robomill.toolpath.text import SUFFIXES
from robomill.ui import session
from robomill.ui.entry import inputs
from robomill.ui.toolpath import drawing, points
from robomill.ui.toolpath.program import brought, take_program

HINT = (
    f"Programs: {', '.join(SUFFIXES)} or no ending. Points: {', '.join(point_tables.SUFFIXES)}. Drawings: "
    f"{', '.join(drawings.SUFFIXES)}. Upper or lower case."
)


def file_inputs(dark: bool) -> None:
    """The box, and what is asked of a file that does not say all."""
    look, fresh = inputs.Look(hint=HINT), session.store().revision
    inputs.upload(
        "Program, points or drawing", "toolpath.file", take_file, most_MB=PROGRAM.most_MB, look=look, fresh=fresh
    )
    brought(dark)
    points.panel()
    drawing.panel()


def take_file(data: bytes, name: str) -> None:
    """A dropped file to whom it is for. Raises the refusal of what is none of these."""
    suffix = PurePath(name).suffix.lower()
    if suffix in drawings.SUFFIXES:
        drawing.take(data, name)
    elif suffix in point_tables.SUFFIXES:
        points.take(data, name)
    else:
        take_program(data, name)
