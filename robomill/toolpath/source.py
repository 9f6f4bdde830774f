"""Where a toolpath comes from: a program, a table of lines, a sketch or points. Sources are values; ``read`` reads.

Each says what it is (``kind``), what a number in ``Toolpath.block`` counts (``block_name``), and what stands there
(``block_texts``).
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from copy import copy
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asking
from robomill.arrays import FloatArray, Rows, digest, frozen, of_kind
from robomill.errors import GCodeError, ToolpathError
from robomill.provenance import Finding
from robomill.quantities import again, quantity, settle
from robomill.spelled import in_units
from robomill.toolpath.arcs import CHORD_ERROR
from robomill.toolpath.corrected import Mark, key_of, mark_of
from robomill.toolpath.path import (
    FEED,
    NO_SPINDLE,
    POINTS,
    ROTARY_ASKED,
    SPINDLE,
    TABLES,
    Toolpath,
    toolpath_from_lines,
)
from robomill.toolpath.sketch import Sketch
from robomill.toolpath.text import is_apt, split_lines
from robomill.toolpath.tools import Tools
from robomill.units import format_count, format_si, format_significant, from_si
from robomill.values import Said, Value

MAX_KEPT = 4
TOLD = 0.3 * CHORD_ERROR
"""m: a corrected program is told to within a hundredth of what it was: chords of 1 um would be a third of the rest."""
VERY_LONG = 200_000
"""Points of a path that is not read more finely."""
LEANS = "tool"
"""What a program's ``table`` says where its rotary axes lean the tool, however far."""


@in_units(ToolpathError, "Program")
@dataclass(frozen=True, repr=False)
class GCodeSource(Said):
    r"""A program as written: its text, the file's name and the dialect ("auto": guessed and said).

    ``table`` is the rotary axis that turns the part ("A", "-A" ...); "" where the tool leans, or nobody has said;
    "tool" where it is said that the tool leans.
    ``n_s`` (1/s) is how fast the spindle turns of a program that never says; 0 where that is not known.
    ``wanted`` is where the tool is wanted of a program that was corrected for the push on it: the source of that path,
    which deviations are then told from; None: this program's own.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.GCodeSource("G21 G90 G1 X0 Y0 Z-2 F600\nG1 X50\n", "slot.nc").read()
    <Toolpath 3 points, 52.0 mm at feed within 50.0 x 0.0 x 2.0 mm>
    """

    text: str
    name: str = "program.nc"
    dialect: str = "auto"
    n_s: float = again(
        SPINDLE, default=0.0, hint="The program turns its spindle nowhere; how fast does it turn at the machine?"
    )
    table: str = ""
    wanted: PathSource | None = None

    if TYPE_CHECKING:

        def __init__(
            self,
            text: str,
            name: str = ...,
            dialect: str = ...,
            n_s: float = ...,
            table: str = ...,
            wanted: PathSource | None = ...,
            *,
            spindle_1_min: float = ...,
        ) -> None: ...

    kind: ClassVar[Literal["program"]] = "program"
    block_name: ClassVar[str] = "line"

    def _said(self) -> str:
        return f"{self.name}, {format_count(len(split_lines(self.text)), 'line')}"

    def __post_init__(self) -> None:
        settle(self, ToolpathError, "Program")
        of_kind(self.text, str, "Program, text", 'rm.read_program("part.nc"), or its text', ToolpathError)
        for name in ("name", "dialect"):
            of_kind(getattr(self, name), str, f"Program, {name}", "a text", ToolpathError)
        if isinstance(self.wanted, Toolpath):
            object.__setattr__(self, "wanted", PointsSource(self.wanted))
        if self.wanted is not None and not hasattr(self.wanted, "read"):
            raise ToolpathError(
                f"Program, wanted: found {self.wanted!r:.60}; expected the path that was meant, as rm.read_program "
                "gives it.",
                where="wanted",
            )
        if self.table not in (*TABLES, LEANS):
            raise ToolpathError(
                f"Program: rotary axis {self.table!r}; expected one of {', '.join((*TABLES[1:], LEANS))}."
            )

    @property
    def mark(self) -> Mark | None:
        """What the program's head says it was corrected for; None where it says nothing."""
        return mark_of(self.text)

    def block_texts(self) -> list[str]:
        """Its lines, as every reader counts them."""
        return split_lines(self.text)

    def read(self, tools: Tools | None = None, chord_error: float = CHORD_ERROR) -> Toolpath:
        """The path, arcs within ``chord_error`` (m); raises GCodeError naming the line that cannot be read.

        ``tools`` is the table that its T, H and D words mean; none or an empty one accepts every tool, of unknown size.
        The last few programs are kept, so that a set-up that is changed elsewhere does not read its program again, and
        what one was refused with: that may take as long.
        """
        tools = tools or None
        key = (self, digest((tools, chord_error)))
        with _LOCK:
            if key in _KEPT:
                _KEPT.move_to_end(key)
                found = _KEPT[key]
                if isinstance(found, GCodeError):
                    raise copy(found)
                return found
        try:
            if self.n_s == 0.0:
                path = self._read(tools, chord_error)
            else:
                path = _turning(replace(self, n_s=0.0).read(tools, chord_error), self.n_s)
        except GCodeError as exc:
            _keep(key, copy(exc))
            raise
        _keep(key, path)
        return path

    def _read(self, tools: Tools | None, chord_error: float) -> Toolpath:
        from robomill.toolpath.apt import read_apt  # the readers load only where a program is read
        from robomill.toolpath.gcode import read_gcode

        data = self.text.encode()
        if is_apt(data):
            return read_apt(data)
        table = self.table.removeprefix(LEANS)
        path = read_gcode(data, chord_error=chord_error, dialect=self.dialect, tools=tools, table=table)
        if self.table != LEANS:
            return path
        return replace(path, findings=tuple(each for each in path.findings if each.code != ROTARY_ASKED))


def _turning(path: Toolpath, n_s: float) -> Toolpath:
    """The path with its spindle at ``n_s`` (1/s) wherever it cuts; itself where the program says how fast."""
    if path.turns:
        return path
    said = Finding("info", f"the spindle turns at {format_si(n_s, '1/min')}, as the set-up says", code="spindle-stated")
    findings = (*(each for each in path.findings if each.code != NO_SPINDLE), said)
    return replace(path, n_s=frozen(np.where(path.cutting, n_s, 0.0)), findings=findings)


_KEPT: OrderedDict[tuple[GCodeSource, str], Toolpath | GCodeError] = OrderedDict()
_LOCK = threading.Lock()


def _keep(key: tuple[GCodeSource, str], found: Toolpath | GCodeError) -> None:
    with _LOCK:
        _KEPT[key] = found
        while len(_KEPT) > MAX_KEPT:
            _KEPT.popitem(last=False)


@in_units(ToolpathError, "Lines")
@dataclass(frozen=True, eq=False, repr=False)
class LinesSource(Said, Value):
    """A table of straight cuts: start, end (r, 3) m in {W}; v_f (r,) m/s; n_s spindle 1/s for the whole table.

    Examples
    --------
    >>> import robomill as rm
    >>> lines = rm.LinesSource([[0.0, 0.0, -2e-3]], [[0.05, 0.0, -2e-3]], [0.03])
    >>> lines.read()
    <Toolpath 2 points, 50.0 mm at feed within 50.0 x 0.0 x 0.0 mm>
    """

    start: FloatArray = quantity("start", "mm", shape=(None, 3), slip=POINTS.slip)
    end: FloatArray = quantity("end", "mm", shape=(None, 3), slip=POINTS.slip)
    v_f: FloatArray = quantity(
        "feed", "mm/min", shape=(None,), most=FEED.most, key=FEED.key, slip=FEED.slip, tiny=FEED.tiny
    )
    n_s: float = again(SPINDLE, default=0.0)
    name: str = field(default="table of lines", compare=False)

    if TYPE_CHECKING:

        def __init__(
            self,
            start: Rows = ...,
            end: Rows = ...,
            v_f: ArrayLike = ...,
            n_s: float = ...,
            name: str = ...,
            *,
            start_mm: Rows = ...,
            end_mm: Rows = ...,
            feed_mm_min: ArrayLike = ...,
            spindle_1_min: float = ...,
        ) -> None: ...

    kind: ClassVar[Literal["lines"]] = "lines"
    block_name: ClassVar[str] = "row"

    def _said(self) -> str:
        return f"{self.name}, {format_count(len(self.v_f), 'row')}"

    def __post_init__(self) -> None:
        settle(self, ToolpathError, "Lines")

    def read(self, tools: Tools | None = None) -> Toolpath:
        """The path, which names no ``tools``; raises ToolpathError naming the row that cannot be cut."""
        return toolpath_from_lines(self.start, self.end, self.v_f, self.n_s)

    def block_texts(self) -> list[str]:
        """Its rows: from where to where (mm) and how fast."""
        ends = zip(from_si(self.start, "mm"), from_si(self.end, "mm"), self.v_f, strict=True)
        return [f"({_point(a)}) → ({_point(b)})  {format_si(v, 'mm/min')}" for a, b, v in ends]


@asking
@dataclass(frozen=True, repr=False)
class SketchSource(Said):
    """A path drawn by hand.

    Examples
    --------
    >>> import robomill as rm
    >>> ring = rm.Element("circle", [[0.0, 0.0], [0.02, 0.0]], depth=2e-3, v_f=0.03)
    >>> rm.SketchSource(rm.Sketch((ring,))).read().cutting.any()
    np.True_
    """

    sketch: Sketch
    name: str = field(default="sketch", compare=False)
    kind: ClassVar[Literal["sketch"]] = "sketch"
    block_name: ClassVar[str] = "shape"

    def __post_init__(self) -> None:
        of_kind(self.sketch, Sketch, "SketchSource, sketch", "rm.Sketch((rm.Element(...),))", ToolpathError)

    def _said(self) -> str:
        return f"{self.name}, {format_count(len(self.sketch.elements), 'shape')}"

    def read(self, tools: Tools | None = None) -> Toolpath:
        """The path, which names no ``tools``; raises ToolpathError where nothing is drawn."""
        return self.sketch.toolpath()

    def block_texts(self) -> list[str]:
        """Its shapes: how many points, how deep and how fast."""
        return [
            f"{e.shape}, {len(e.points)} points, {format_si(e.depth, 'mm', 2)} deep, {format_si(e.v_f, 'mm/min', 0)}"
            for e in self.sketch.elements
        ]


@asking
@dataclass(frozen=True)
class PointsSource:
    """A path that is given as it is, point by point.

    Examples
    --------
    >>> import robomill as rm
    >>> path = rm.Toolpath.from_points(p_mm=[[0, 0, -2], [50, 0, -2]], feed_mm_min=1800)
    >>> rm.PointsSource(path).read() == path
    True
    """

    path: Toolpath
    name: str = field(default="points", compare=False)
    kind: ClassVar[Literal["points"]] = "points"
    block_name: ClassVar[str] = "point"

    def __post_init__(self) -> None:
        if self.path.units != "mm":  # which only says how a program was written
            object.__setattr__(self, "path", replace(self.path, units="mm"))

    def read(self, tools: Tools | None = None) -> Toolpath:
        """The path itself."""
        return self.path

    def block_texts(self) -> list[str]:
        """Where each move ends (mm) and how fast; of a path that was read from somewhere, by its last move."""
        ends = zip(self.path.block.tolist(), from_si(self.path.p, "mm"), self.path.v_f, strict=True)
        said = {row: f"({_point(p)})  {format_si(v, 'mm/min') if v else 'rapid'}" for row, p, v in ends}
        return [said.get(row, "") for row in range(1, max(said) + 1)]


def _point(p: FloatArray) -> str:
    return ", ".join(format_significant(v) for v in np.round(p, 3))


PathSource = GCodeSource | LinesSource | SketchSource | PointsSource


def wanted_of(source: PathSource) -> PathSource | None:
    """The source of the path that was meant, of a corrected program that says it; None of any other."""
    return source.wanted if isinstance(source, GCodeSource) else None


def finely(source: PathSource, tools: Tools) -> Toolpath:
    """The path of a ``source`` from which errors are told: a program's arcs within ``TOLD``, unless it is very long."""
    path = source.read(tools)
    return source.read(tools, TOLD) if isinstance(source, GCodeSource) and len(path) < VERY_LONG else path


def meant_by(corrected: PathSource, known: PathSource) -> PathSource:
    """A program that says it was ``corrected`` for the path of ``known`` (or for what that was corrected for), with
    that as what is wanted; any other as it is."""
    if not isinstance(corrected, GCodeSource) or corrected.wanted is not None or corrected.mark is None:
        return corrected
    for each in (known, wanted_of(known)):
        if each is not None and key_of(each.block_texts()) == corrected.mark.key:
            return replace(corrected, wanted=each)
    return corrected
