"""A Toolpath as a G-code program: line numbers, and words only where something changes."""

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import ToolpathError
from robomill.kinematics.transforms import tilt_from_axis
from robomill.toolpath.path import Toolpath
from robomill.units import format_plain, from_si

DECIMALS = {"mm": 6, "in": 7}
"""Digits after the point of lengths, so that a program says where to go to about a nanometre."""

STEP = 10  # from one line number to the next
_FEED_DECIMALS = 4
_ANGLE_DECIMALS = 6


def toolpath_to_gcode(path: Toolpath, *, units: str = "mm", title: str = "") -> str:
    """The program of a path in {W}, in ``units`` ``"mm"`` (G21) or ``"in"`` (G20).

    Read again, it gives the same points, feeds and cutting moves. A start other than zero, or one that a cut begins at,
    becomes a first rapid; the first move names every axis.
    A tilted tool axis becomes A and B: k = (sin B, -sin A cos B, cos A cos B). Raises ToolpathError for a cut
    without feed, a spindle speed that is not known or an unknown unit.
    """
    if units not in DECIMALS:
        raise ToolpathError(f"G-code: the unit is {units!r}; expected 'mm' or 'in'.")
    slow = np.flatnonzero(path.cutting & ~(path.v_f > 0))
    if len(slow):
        raise ToolpathError(f"G-code: point {slow[0]} is cut with a feed of 0; give the path a feed above 0.")
    writer = _Writer(units)
    if title:
        writer.raw("(" + "".join(c for c in title if c.isprintable() and c not in "();") + ")")
    writer.line(["G21" if units == "mm" else "G20", "G90", "G94", "G17"])
    lengths = np.round(from_si(path.p, units), DECIMALS[units])
    angles = np.round(_angles(path.k), _ANGLE_DECIMALS)
    tilted = bool(np.abs(angles).max() > 0)
    feeds = np.round(from_si(path.v_f, f"{units}/min"), _FEED_DECIMALS)
    unknown = np.flatnonzero(np.isnan(path.n_s))
    if len(unknown):
        raise ToolpathError(
            f"G-code: the spindle speed of point {unknown[0]} is not known (G96 lets it follow the diameter); "
            "give the program a speed (G97 S)."
        )
    speeds = np.round(from_si(path.n_s, "1/min"), _FEED_DECIMALS)
    for i in range(len(path)):
        if i == 0 and not lengths[0].any() and not angles[0].any() and not path.cutting[1:2].any():
            writer.spindle(int(path.tool[0]), float(speeds[0]), bool(path.ccw[0]))
            continue
        writer.spindle(int(path.tool[i]), float(speeds[i]), bool(path.ccw[i]))
        if path.dwell[i] > 0:
            writer.line(["G4", "P" + format_plain(float(path.dwell[i]), _FEED_DECIMALS)])
        position = [float(v) for v in lengths[i]] + ([float(v) for v in angles[i]] if tilted else [])
        writer.move(position, bool(path.cutting[i]), float(feeds[i]))
    writer.line(["M5"] if writer.speed else [])
    writer.line(["M2"])
    return "\n".join(writer.lines) + "\n"


def _angles(k: FloatArray) -> FloatArray:
    """(m, 2) deg: A and B of tool axes (m, 3); A goes on smoothly, and stays where the axis lies along X."""
    a, b = from_si(tilt_from_axis(k), "deg").T
    free = np.hypot(k[:, 1], k[:, 2]) < 1e-9
    known = np.maximum.accumulate(np.where(free, 0, np.arange(len(a))))
    return np.stack([np.unwrap(np.where(free[known], 0.0, a[known]), period=360.0), b], axis=1)


class _Writer:
    """Remembers what the machine knows, and writes only what is new to it."""

    def __init__(self, units: str) -> None:
        self.digits = DECIMALS[units]
        self.lines: list[str] = []
        self.count = 0
        self.at = [float("nan")] * 5  # nobody knows where the machine stands: the first move says all of it
        self.motion = ""
        self.feed = 0.0
        self.speed, self.ccw = 0.0, False
        self.tool = 0

    def raw(self, text: str) -> None:
        self.lines.append(text)

    def line(self, words: list[str]) -> None:
        if words:
            self.count += 1
            self.lines.append(" ".join([f"N{self.count * STEP}", *words]))

    def spindle(self, tool: int, speed: float, ccw: bool) -> None:
        """Change the tool and the spindle's speed and sense where they change."""
        if tool != self.tool:
            self.line([f"T{tool}", "M6"])
            self.tool, self.speed = tool, 0.0
        if speed != self.speed or (speed and ccw != self.ccw):
            self.line([f"S{format_plain(speed, _FEED_DECIMALS)}", "M4" if ccw else "M3"] if speed else ["M5"])
            self.speed, self.ccw = speed, ccw

    def move(self, position: list[float], cutting: bool, feed: float) -> None:
        """G0 or G1 to a position; the words that do not change are left out."""
        motion = "G1" if cutting else "G0"
        digits = [self.digits] * 3 + [_ANGLE_DECIMALS] * 2
        words = [
            letter + format_plain(value, d)
            for letter, value, before, d in zip("XYZAB", position, self.at, digits)
            if value != before
        ]
        if motion != self.motion or not words:
            words.insert(0, motion)
        if cutting and feed != self.feed:
            words.append("F" + format_plain(feed, _FEED_DECIMALS))
            self.feed = feed
        self.motion, self.at = motion, position + self.at[len(position) :]
        self.line(words)
