"""Drawings in: DXF and SVG as contours by layer, with the unit that the file says, or that somebody says for it."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path, PurePath

from robomill.arguments import asked
from robomill.errors import ToolpathError, UnitAskedError
from robomill.files import DRAWING, check_size, name_of, read_file
from robomill.io.drawing.dxf import Dxf
from robomill.io.drawing.reading import Read, metres
from robomill.io.drawing.svg import Svg
from robomill.io.samples import sample_or_file
from robomill.provenance import Finding
from robomill.spelled import to_give
from robomill.toolpath.chaining import GAP, joined
from robomill.toolpath.drawing import Drawing
from robomill.units import format_count, format_many, format_short
from robomill.wording import listed

SUFFIXES = (".dxf", ".svg")
ASKED = ("mm", "in", "cm", "m", "px", "pt")
"""Units that somebody may say; a pixel is 1/96 in, a point 1/72 in."""
SMALLEST, LARGEST = 1e-3, 5.0  # m: a drawing outside these was probably drawn in another unit


@asked
def read_drawing(path: str | Path, *, unit: str = "") -> Drawing:
    """The lines of a drawing, layer by layer.

    Parameters
    ----------
    path : str or Path
        A DXF or SVG file, or the name of a sample.
    unit : str
        Of the file's numbers, "mm", "in", "cm", "m", "px" or "pt", where it does not say it, or says it wrongly.

    Returns
    -------
    Drawing
        In m. X and Y are those of the DXF's model space; of an SVG, Y points up from the lower edge of the page.
        What was left out (text, dimensions) is in its ``findings``.

    Raises
    ------
    UnitAskedError
        A ToolpathError: the file does not say its unit, and nobody has.
    ToolpathError
        For a file that cannot be opened or read, holds no lines, or too much.
    MissingExtraError
        Without ``pip install "robomill[drawing]"``.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.read_drawing("bracket")
    <Drawing bracket.dxf: 5 contours on outline, slots, holes, 120.00 x 80.00 mm>
    """
    file = sample_or_file("drawing", path, ToolpathError)
    return drawing_from_bytes(read_file(file, DRAWING, ToolpathError), name_of(file), unit)


def drawing_from_bytes(data: bytes, name: str, unit: str = "") -> Drawing:
    """What a person dropped or named, as ``read_drawing``."""
    check_size(len(data), DRAWING, ToolpathError, name)
    suffix = PurePath(name).suffix.lower()
    if suffix not in SUFFIXES:
        raise ToolpathError(f"{name}: expected a drawing that ends in {' or '.join(SUFFIXES)} (any case).")
    if unit and unit not in ASKED:
        raise ToolpathError(f"{name}: the unit is {unit!r:.20}; expected one of {', '.join(ASKED)}.", where="unit")
    if not data.strip():
        raise ToolpathError(f"{name}: the file is empty; export the drawing again.")
    file = Dxf(data, name) if suffix == ".dxf" else Svg(data, name)
    taken = unit or file.unit
    read = file.read(file.scale(taken or "mm"))
    contours, twice, dots = joined(read.pieces)
    if not contours:
        raise ToolpathError(
            f"{name}: found no lines{_but(read)}; expected lines, arcs, circles or curves to cut along."
        )
    findings = (*_findings(read, twice, dots, file.unit, unit), *_unseen(read))
    drawing = Drawing(name, tuple(contours), taken or "mm", frozenset(read.hidden), findings)
    if not taken:
        give = to_give("unit", "say which")
        raise UnitAskedError(f"{name}: the drawing {file.unsaid}; {_sizes(drawing)}: {give}.", where="unit")
    return _doubted(drawing)


def _but(read: Read) -> str:
    unseen = Counter({f"invisible {what}": count for what, count in read.unseen.items()})
    return f" (only {_counted(read.left_out + unseen)})" if read.left_out or unseen else ""


def _counted(found: Counter[str]) -> str:
    return ", ".join(f"{format_count(count)} × {what}" for what, count in sorted(found.items()))


def _unseen(read: Read) -> Iterator[Finding]:
    """What a person does not see who opens the file."""
    if read.unseen:
        text = f"{_counted(read.unseen)}: made invisible in the file, left out"
        yield Finding("ignored", text, code="drawing-unseen")
    if read.partly:
        text = f"{_counted(read.partly)}: hidden in part in the file (clipping path or mask), the lines are taken "
        text += "whole, also where they are not seen"
        yield Finding("warning", text, code="drawing-clipped")
    hidden = sorted(read.hidden & {piece.layer for piece in read.pieces})
    if hidden:
        many = len(hidden) > 1
        text = f"the layer{'s' * many} {listed(hidden):.200} {'are' if many else 'is'} switched off or frozen in the "
        text += f"file: what {'they hold' if many else 'it holds'} is cut only where somebody asks for it by name"
        yield Finding("info", text, code="drawing-hidden")


def _sizes(drawing: Drawing) -> str:
    """How large it is in every unit that may have been meant; it was read in mm."""
    low, high = drawing.extents
    said = []
    for unit in ASKED:
        size = (high - low) * (metres(unit) / metres("mm"))
        said.append(f"{format_many(size, 'mm', 1, between=' × ')} in {unit}")
    return f"it would be {listed(said, 'or')}"


def _findings(read: Read, twice: int, dots: int, own: str, said: str) -> tuple[Finding, ...]:
    found = []
    if own and said and own != said:
        text = f"the file says that it is drawn in {own}; it was read in {said}, as was said"
        found.append(Finding("warning", text, code="drawing-unit"))
    if read.left_out:
        found.append(
            Finding("ignored", f"{_counted(read.left_out)}: no lines to cut along, left out", code="drawing-left-out")
        )
    if twice or dots:
        counts = ((twice, "drawn twice"), (dots, "without length"))
        said = listed(f"{format_count(count, 'line')} {what}" for count, what in counts if count)
        found.append(Finding("info", f"{said} left out", code="drawing-twice"))
    if len(read.pieces) > twice + dots:
        text = f"lines whose ends lie within {format_short(GAP, 'mm')} of each other were joined"
        found.append(Finding("info", text, code="drawing-joined"))
    return tuple(found)


def _doubted(drawing: Drawing) -> Drawing:
    low, high = drawing.extents
    longest = float((high - low).max())
    if SMALLEST <= longest <= LARGEST:
        return drawing
    text = f"the drawing is {format_short(longest, 'mm')} long in {drawing.unit}; check the unit of the file"
    return replace(drawing, findings=(*drawing.findings, Finding("suspicious", text, code="drawing-unit")))
