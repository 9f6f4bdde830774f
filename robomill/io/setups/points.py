"""A path given point by point, in the [path] table of a set-up; what ``Toolpath.from_points`` has too, is left out.

points_mm = [[0.0, 0.0, -2.0], [100.0, 0.0, -2.0]]
feed_mm_min = [0.0, 1800.0]
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import ToolpathError
from robomill.io.tables import Table, exactly
from robomill.toolpath.path import PER_MOVE, Toolpath
from robomill.toolpath.source import PointsSource

UPRIGHT = (0.0, 0.0, 1.0)
NOT_KNOWN = -1.0  # below 0, in any unit: a spindle speed that nobody knows (G96)
# Numbers by their field: the keys they may stand under, with their units; the writer takes the first that is exact.
POINTS = {"points_mm": "mm", "points_m": "1"}
NUMBERS = {
    "v_f": {"feed_mm_min": "mm/min", "feed_m_s": "1"},
    "n_s": {"spindle_1_min": "1/min", "spindle_1_s": "1"},
    "dwell": {"dwell_s": "s"},
}
WHOLES, FLAGS = ("block", "tool"), ("cutting", "ccw", "thread")


def points_from_table(table: Table) -> PointsSource:
    """The path; raises ProjectError naming the key."""
    (points,) = [key for key in POINTS if table.has(key)]
    p = table.rows(points, 3, POINTS[points])
    m = len(p)
    given: dict[str, Any] = {"k": table.rows("axis", 3, "1", m) if table.has("axis") else UPRIGHT}
    for name, keys in NUMBERS.items():
        key = next((key for key in keys if table.has(key)), "")
        if key:
            given[name] = np.array(table.numbers(key, m, keys[key]))
    if "n_s" in given:
        given["n_s"][given["n_s"] < 0.0] = np.nan
    for names, read in ((WHOLES, table.wholes), (FLAGS, table.flags)):
        given |= {name: np.array(_as_many(table, name, read, m)) for name in names if table.has(name)}
    if "v_f" not in given:
        raise table.refuse("feed_mm_min", "missing; give the feed of every point, 0 where the move to it is a rapid.")
    name = table.text("points_name", "points")
    table.finish()
    try:
        usual = _usual(p, given["v_f"])
        given |= {"block_name": "line"} if "block" in given else {}  # of a program that is not kept
        return PointsSource(Toolpath(**{**usual, **given, "p": p}), name)
    except ToolpathError as exc:
        raise table.refuse(points, str(exc)) from None


def points_to_table(source: PointsSource) -> dict[str, Any]:
    """What ``points_from_table`` reads back to the same digest."""
    path = source.path
    usual = _usual(path.p, path.v_f)
    out: dict[str, Any] = {**_written(path.p, POINTS), "points_name": source.name}
    if not np.array_equal(path.k, np.broadcast_to(UPRIGHT, path.k.shape)):
        out["axis"] = path.k.tolist()
    for name, keys in NUMBERS.items():
        value = getattr(path, name)
        if name == "v_f" or value.any():
            out |= _written(np.where(np.isnan(value), NOT_KNOWN, value), keys)
    for name in (*WHOLES, *FLAGS):
        value = getattr(path, name)
        if not np.array_equal(value, np.broadcast_to(usual[name], value.shape)):
            out[name] = value.tolist()
    return out


def _usual(p: FloatArray, v_f: FloatArray) -> dict[str, Any]:
    """What is left out of a file."""
    cutting = np.asarray(v_f > 0.0)
    cutting[:1] = False
    none: dict[str, Any] = {name: np.zeros(1, dtype=kind) for name, kind in PER_MOVE.items()}
    return {**none, "v_f": v_f, "cutting": cutting, "block": np.arange(1, len(p) + 1), "block_name": "point"}


def _as_many(table: Table, key: str, read: Callable[[str], Any], m: int) -> Any:
    values = read(key)
    if len(values) != m:
        raise table.refuse(key, f"expected {m} values, one a point; found {len(values)}.")
    return values


def _written(values: FloatArray, keys: dict[str, str]) -> dict[str, Any]:
    """Under the first key whose unit gives every number back to the last bit."""
    for key, unit in keys.items():
        found = [exactly(float(value), unit) for value in values.ravel()]
        if None not in found:
            return {key: np.reshape(np.array(found, dtype=float), values.shape).tolist()}
    raise AssertionError("SI is always exact")
