"""The toolpath: what the tool is told to do, in the part frame {W}. Units, arcs and modes are gone."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asked, asking
from robomill.arrays import FARTHEST, BoolArray, FloatArray, IntArray, Rows, as_floats, digest, frozen
from robomill.errors import ToolpathError
from robomill.frames import Columns
from robomill.lazy import cached_property
from robomill.provenance import Finding
from robomill.quantities import Quantity
from robomill.spelled import one_of
from robomill.units import format_count, format_many, format_si, format_significant, from_si, to_si
from robomill.values import Tabled

SAME_WAY = 1e-6  # sine of the angle between two directions that count as one
NO_SPINDLE = "no-spindle"  # the finding of a program that never turns its spindle
ROTARY_ASKED = "rotary-asked"  # the finding of a program that turns an axis far, or C beside a lean
TABLES = ("", "A", "-A", "B", "-B", "C", "-C")
"""Rotary axes that turn the part: none, or one, whose positive sense turns the tool about the part (-: or the part)."""
UNIT = 4.0 * float(np.finfo(np.float64).eps)  # rounding of a length that is 1
ON_LINE = 1e-6  # m: cuts this close to a line lie on it
PER_MOVE: dict[str, type] = {
    "v_f": float,
    "cutting": bool,
    "block": int,
    "n_s": float,
    "tool": int,
    "ccw": bool,
    "thread": bool,
    "dwell": float,
}
"""Arrays of a path with one value a move, and their types."""
POINTS = Quantity("Points", "mm", "array", name="p", key="p_mm", slip=10.0)
SLOWEST = to_si(1.0, "mm/min")  # hardly a tool is fed as slowly: was it meant in m/s?
SMALLEST = 0.1e-3  # m: hardly a path is as small: was it meant in m?
MOST_FEED = to_si(600_000.0, "mm/min")  # no machine is fed as fast: was it meant in um/min?
TURNING = to_si(1.0, "1/min")  # no mill turns as slowly: was it meant in 1/s?
FEED = Quantity(
    "Feed", "mm/min", "array", name="v_f", key="feed_mm_min", least=0.0, most=MOST_FEED, slip=1.0, tiny=SLOWEST
)
SPINDLE = Quantity(
    "Spindle speed", "1/min", "array", name="n_s", key="spindle_1_min", least=0.0, slip=1000.0, tiny=TURNING
)


def far_off(p: FloatArray, block: IntArray) -> tuple[int, str] | None:
    """Line (of ``block``, one a point or one for all) and reason where a point p (m, 3) m is beyond any machine."""
    far = np.flatnonzero(~(np.abs(p) <= FARTHEST).all(axis=1))
    if not len(far):
        return None
    found, most = format_significant(float(np.abs(p[far[0]]).max())), format_si(FARTHEST, "m", 0)
    why = f"a point lies {found} m from part zero, expected at most {most}; mend the number, or the unit it is in."
    return int(np.broadcast_to(block, len(p))[far[0]]), why


@asking
@dataclass(frozen=True, eq=False, repr=False)
class Toolpath(Tabled):
    r"""Tool tip positions in {W}; entry i describes the move from point i - 1 to point i, entry 0 the start.

    p        (m, 3) m        tool tip
    k        (m, 3)          unit tool axis z_T, out of the part towards the spindle
    v_f      (m,) m/s        feed rate of the move (0 on rapids)
    cutting  (m,) bool       True on feed moves, False on rapids and at the start
    block    (m,) int        1-based source line of the move (row of a table, shape of a sketch, point)
    n_s      (m,) 1/s        spindle revolutions per second, 0 where stopped or not stated, NaN where they are
                             not known (G96)
    tool     (m,) int        tool number, 0 where not stated
    ccw      (m,) bool       True where the spindle turns counter-clockwise (M4), False where not stated
    thread   (m,) bool       True where a tap or a thread cutter is led in step with the spindle
    dwell    (m,) s          time that the tool stands still before the move
    counts                   rapid moves, straight cuts and arcs of the program, None where there is none
    block_name               what ``block`` counts: "line" of a program, "row" of a table, "shape" or "point"

    Raises
    ------
    ToolpathError
        For points, axes or feeds that cannot be.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.read_gcode("G21 G90 G1 X0 Y0 Z-2 F600\nG1 X50\n").to_dataframe()["feed_mm_min"].tolist()
    [0.0, 600.0, 600.0]
    """

    p: FloatArray
    k: FloatArray
    v_f: FloatArray
    cutting: BoolArray
    block: IntArray
    n_s: FloatArray
    tool: IntArray
    ccw: BoolArray = field(default_factory=lambda: np.zeros(1, dtype=bool))
    thread: BoolArray = field(default_factory=lambda: np.zeros(1, dtype=bool))
    dwell: FloatArray = field(default_factory=lambda: np.zeros(1))
    findings: tuple[Finding, ...] = field(default=(), compare=False)
    units: str = "mm"
    counts: tuple[int, int, int] | None = field(default=None, compare=False)
    block_name: str = field(default="line", compare=False)

    def __post_init__(self) -> None:
        p = as_floats(self.p, "toolpath points", (None, 3), error=ToolpathError)
        m = len(p)
        if m == 0:
            raise ToolpathError("Toolpath: found no points; a path needs at least one.")
        k = as_floats(np.broadcast_to(self.k, (m, 3)), "tool axis", (m, 3), error=ToolpathError)
        length = np.linalg.norm(k, axis=1, keepdims=True)
        if (np.abs(length - 1.0) > 1e-6).any():
            raise ToolpathError("Tool axis: expected unit vectors, found a length that is not 1.")
        exact = (np.abs(length - 1.0) <= UNIT).all()  # what was made one stays as it is, so that files give it back
        values: dict[str, Any] = {"p": frozen(p), "k": frozen(k if exact else k / length)}
        for name, dtype in PER_MOVE.items():
            values[name] = frozen(np.broadcast_to(getattr(self, name), (m,)), dtype)
        if not np.isfinite(values["v_f"]).all() or (values["v_f"] < 0).any():
            raise ToolpathError("Toolpath: a feed rate is negative or not a number; feeds must be 0 or more.")
        if far := far_off(p, values["block"]):
            raise ToolpathError("{} {}: {}".format(self.block_name.capitalize(), *far))
        for name, value in values.items():
            object.__setattr__(self, name, value)

    @classmethod
    @asked
    def from_points(
        cls,
        p: Rows | None = None,
        v_f: ArrayLike | None = None,
        *,
        p_mm: Rows | None = None,
        feed_mm_min: ArrayLike | None = None,
        n_s: ArrayLike | None = None,
        spindle_1_min: ArrayLike | None = None,
        k: ArrayLike = (0.0, 0.0, 1.0),
        cutting: ArrayLike | None = None,
        tool: ArrayLike = 0,
    ) -> Toolpath:
        """A path through points of the part frame {W}, the first one its start; ``block`` counts the points from 1.

        Parameters
        ----------
        p, p_mm : (m, 3) points of the tool tip, in m or in mm
        v_f, feed_mm_min : feed of every move, one or (m,) (entry i is of the move that ends at point i), m/s or mm/min
        n_s, spindle_1_min : spindle speed, one or (m,), in 1/s or 1/min; not stated unless given
        k : (3,) or (m, 3) tool axis, out of the part towards the spindle, of any length
        cutting : (m,) bool, False on rapids; every move cuts unless it has no feed
        tool : tool number, one or (m,)

        Raises
        ------
        ToolpathError
            for points, feeds or axes that cannot be, and for numbers that were meant in another unit

        Examples
        --------
        >>> import robomill as rm
        >>> path = rm.Toolpath.from_points(p_mm=[[0, 0, -2], [100, 0, -2]], feed_mm_min=1800)
        >>> len(path), float(path.s[-1]), round(float(path.v_f[-1]), 6)
        (2, 0.1, 0.03)
        """
        points = _points(one_of(POINTS, p, p_mm, ToolpathError, "Toolpath"), p is None)
        m = len(points)
        if m < 2:
            raise ToolpathError(f"Points: found {format_count(m, 'point')}, expected two at least: a start and an end.")
        feed = _each(FEED, one_of(FEED, v_f, feed_mm_min, ToolpathError, "Toolpath"), m)
        speed = one_of(SPINDLE, n_s, spindle_1_min, ToolpathError, "Toolpath", 0.0)
        axis = as_floats(k, "Tool axis", (3,), error=ToolpathError)
        _check_count(axis.shape[:-1], "Tool axis", m)
        length = np.linalg.norm(axis, axis=-1, keepdims=True)
        if not (length > 0.0).all():
            raise ToolpathError("Tool axis: found one without length; expected the way out of the part, e.g. 0, 0, 1.")
        cuts = feed > 0.0 if cutting is None else np.array(np.broadcast_to(_switches(cutting, m), (m,)))
        cuts[:1] = False
        return cls(
            p=points,
            k=axis / length,
            v_f=np.where(cuts, feed, 0.0),
            cutting=cuts,
            block=np.arange(1, m + 1),
            n_s=_each(SPINDLE, speed, m),
            tool=_numbers_of_tools(tool, m),
            block_name="point",
        )

    def __len__(self) -> int:
        return len(self.p)

    @cached_property
    def step_length(self) -> FloatArray:
        """(m,) m: length of the move that ends at each point; 0 at the start."""
        return frozen(np.concatenate([[0.0], np.linalg.norm(np.diff(self.p, axis=0), axis=1)]))

    @cached_property
    def s(self) -> FloatArray:
        """(m,) m: length travelled at feed (rapids do not count)."""
        return frozen(np.cumsum(np.where(self.cutting, self.step_length, 0.0)))

    @cached_property
    def t(self) -> FloatArray:
        """(m,) s: time spent at feed."""
        with np.errstate(divide="ignore", invalid="ignore"):
            dt = np.where(self.cutting & (self.v_f > 0), self.step_length / self.v_f, 0.0)
        return frozen(np.cumsum(dt))

    @property
    def turns(self) -> bool:
        """Whether the spindle is ever said to turn, however fast."""
        return bool(self.n_s.any())

    @cached_property
    def extents(self) -> tuple[FloatArray, FloatArray]:
        """Smallest and largest corner (3,) m over all points of feed moves (of all points without any)."""
        ends = self._feed_ends if self.cutting.any() else self.p
        return frozen(ends.min(axis=0)), frozen(ends.max(axis=0))

    @property
    def _feed_ends(self) -> FloatArray:
        """(q, 3) m: all points that feed moves begin or end at."""
        return np.asarray(self.p[self.cutting | np.append(self.cutting[1:], False)])

    @cached_property
    def goes_one_way(self) -> bool:
        """Whether every cut goes the same way (or back): a form error can then be told from a shift and a turn."""
        step = np.diff(self.p, axis=0)[self.cutting[1:]]
        length = np.linalg.norm(step, axis=1)
        along = step[length > 0] / length[length > 0, None]
        return bool(len(along) and np.abs(np.cross(along, along[0])).max() < SAME_WAY)

    @cached_property
    def on_one_line(self) -> bool:
        """Whether all cuts lie on one line, seen from above, and one goes along it: then, and only then, there is one
        groove to speak of (holes in a row are none)."""
        ways = np.diff(self.p[:, :2], axis=0)[self.cutting[1:]]
        if not (np.linalg.norm(ways, axis=1) >= ON_LINE).any():
            return False
        points = self._feed_ends[:, :2] - self._feed_ends[0, :2]
        length = np.linalg.norm(points, axis=1)
        x, y = points[np.argmax(length)] / length.max()
        return bool(np.abs(points @ np.array([-y, x])).max() <= ON_LINE)

    @cached_property
    def _digest(self) -> str:
        return digest((self.p, self.k, *(getattr(self, name) for name in PER_MOVE)))  # findings do not count

    def columns(self) -> Columns:
        """One row a point, with what is told of the move that ends there; the first is the start."""
        found: Columns = {self.block_name: self.block, "tool": self.tool, "cutting": self.cutting}
        found["station_mm"] = from_si(self.s, "mm")
        found |= {f"{axis}_mm": from_si(self.p[:, i], "mm") for i, axis in enumerate("XYZ")}
        found |= {f"k_{axis}": self.k[:, i] for i, axis in enumerate("xyz")}
        found["feed_mm_min"] = from_si(self.v_f, "mm/min")
        found["spindle_1_min"] = from_si(self.n_s, "1/min")
        return found

    def _said(self) -> str:
        low, high = self.extents
        size = format_many(high - low, "mm", 1, between=" × ")
        length = format_si(float(self.s[-1]), "mm", 1)
        return f"{format_count(len(self), 'point')}, {length} at feed within {size}"


def _check_count(shape: tuple[int, ...], name: str, m: int) -> None:
    """Refuse what is neither one for all nor one a point."""
    if shape not in ((), (m,)):
        found = " x ".join(map(str, shape))
        raise ToolpathError(f"{name}: found {found}, expected one for all, or {m}, one a point.")


def _switches(cutting: ArrayLike, m: int) -> BoolArray:
    """Whether each move cuts, as True and False or 1 and 0."""
    found = np.asarray(cutting)
    _check_count(found.shape, "Cutting", m)
    if found.dtype.kind not in "biuf" or not np.isin(found, (0, 1)).all():
        raise ToolpathError(f"Cutting: expected True or False for every move, found {np.ravel(found)[:1].tolist()}.")
    return found.astype(bool)


def _numbers_of_tools(tool: ArrayLike, m: int) -> IntArray:
    """Whole numbers from 0."""
    found = np.asarray(tool)
    _check_count(found.shape, "Tool", m)
    if found.dtype.kind not in "iuf" or not (np.isfinite(found) & (found >= 0) & (found == np.round(found))).all():
        raise ToolpathError(f"Tool: expected whole numbers from 0, found {np.ravel(found)[:1].tolist()}.")
    return found.astype(np.int64)


def _points(given: Any, in_mm: bool) -> FloatArray:
    """(m, 3) m; refused is what is no list of points, and ``in_mm`` a whole path as small as none is."""
    p = as_floats(given, "Points", (), error=ToolpathError)
    if p.ndim != 2 or p.shape[1] != 3:
        shape = " x ".join(map(str, p.shape)) or "one number"
        ask = "; is it transposed?" if p.ndim == 2 and len(p) == 3 else "."
        raise ToolpathError(f"Points: expected a row of three numbers (X, Y, Z) for each point, found {shape}{ask}")
    size = float(np.ptp(p, axis=0).max()) if len(p) else 0.0
    if in_mm and 0.0 < size < SMALLEST:
        raise ToolpathError(
            f"Points: the whole path lies within {format_significant(from_si(size, 'mm'))} mm: p_mm is in mm. If m are "
            "meant, give p; so you do where a path as small is meant.",
            where="p",
        )
    return p


def _each(declared: Quantity, value: Any, m: int) -> FloatArray:
    """One number or one a point, as (m,)."""
    found = as_floats(value, declared.label, (), error=ToolpathError)
    _check_count(found.shape, declared.label, m)
    refused = found[~declared.allows(found)]
    if refused.size:
        raise ToolpathError(f"{declared.label}: found {declared.short(refused[0])}; expected {declared.expected}.")
    return np.array(np.broadcast_to(found, (m,)))


def toolpath_from_lines(
    start: ArrayLike,
    end: ArrayLike,
    v_f: ArrayLike,
    n_s: ArrayLike = 0.0,
    *,
    k: ArrayLike = (0.0, 0.0, 1.0),
) -> Toolpath:
    """A path from straight cuts: start, end (r, 3) m in {W}, v_f (r,) m/s; rapids join lines that do not touch.

    ``block`` is the 1-based row. Raises ToolpathError naming the row that has no length or no feed.
    """
    a = as_floats(np.atleast_2d(np.asarray(start, dtype=float)), "line starts", (None, 3), error=ToolpathError)
    b = as_floats(np.atleast_2d(np.asarray(end, dtype=float)), "line ends", (len(a), 3), error=ToolpathError)
    feed = np.broadcast_to(np.asarray(v_f, dtype=float), (len(a),))
    speed = np.broadcast_to(np.asarray(n_s, dtype=float), (len(a),))
    if len(a) == 0:
        raise ToolpathError("Table of lines: found no rows; add at least one line.")
    points: list[FloatArray] = [a[0]]
    rows, cutting, v, n = [1], [False], [0.0], [float(speed[0])]
    for i in range(len(a)):
        if not feed[i] > 0:
            found = format_si(feed[i], "mm/min")
            raise ToolpathError(f"Row {i + 1}: feed is {found}; a cut needs more than 0.", where=f"row {i + 1}")
        if np.linalg.norm(b[i] - a[i]) < 1e-9:
            raise ToolpathError(
                f"Row {i + 1}: start and end are the same point; give the line a length.", where=f"row {i + 1}"
            )
        jump = np.linalg.norm(points[-1] - a[i]) > 1e-9
        for point, is_cut in ((a[i], False), (b[i], True)) if jump else ((b[i], True),):
            points.append(point)
            rows.append(i + 1)
            cutting.append(is_cut)
            v.append(float(feed[i]) if is_cut else 0.0)
            n.append(float(speed[i]))
    return Toolpath(
        p=np.array(points),
        k=np.asarray(k, dtype=float),
        v_f=np.array(v),
        cutting=np.array(cutting),
        block=np.array(rows),
        n_s=np.array(n),
        tool=np.zeros(len(points), dtype=np.int64),
        block_name="row",
    )
