"""Other ways to cut what a path cuts: faster or slower, the other way round, in passes, once more."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import ToolpathError
from robomill.toolpath.path import PER_MOVE, Toolpath
from robomill.units import to_si

CLEAR = 2e-3  # m above the stock: where rapids between passes go
DOWN = 1e-9  # m
PLUNGE_FEED = to_si(300.0, "mm/min")


def fed(path: Toolpath, factor: float) -> Toolpath:
    """Every feed times ``factor``."""
    return replace(path, v_f=path.v_f * factor, counts=None)


def turned_round(path: Toolpath, top: float) -> Toolpath:
    """From its end to its beginning, so that up milling becomes down milling; what was a rapid out of the material
    (below ``top``, m) goes in, from ``CLEAR`` above that on, with the lowest feed of the program, at most
    ``PLUNGE_FEED``."""
    path = _stopped_above(path, top + CLEAR)
    m = len(path)
    moves = np.concatenate([[0], np.arange(m - 1, 0, -1)])  # the move to a point was the one from it
    each = {name: np.array(getattr(path, name))[moves] for name in PER_MOVE}
    p = path.p[::-1]
    each["block"][0] = path.block[-1]
    rapid = ~each["cutting"]
    rapid[0] = False
    into = rapid & (p[:, 2] < np.roll(p[:, 2], 1) - DOWN) & (p[:, 2] < top)
    slow = path.v_f[path.cutting & (path.v_f > 0.0)].min(initial=PLUNGE_FEED)
    each["cutting"] = each["cutting"] | into
    each["v_f"] = np.where(into, slow, each["v_f"])
    return replace(path, p=p, k=path.k[::-1], **each, counts=None)


def _stopped_above(path: Toolpath, height: float) -> Toolpath:
    """The same path with a stop at ``height`` (m) on rapids that rise through it."""
    i = np.flatnonzero(~path.cutting[1:] & (path.p[1:, 2] > height) & (path.p[:-1, 2] < height)) + 1
    if not len(i):
        return path
    low, high = path.p[i - 1], path.p[i]
    share = ((height - low[:, 2]) / (high[:, 2] - low[:, 2]))[:, None]
    each = {name: np.insert(getattr(path, name), i, getattr(path, name)[i], axis=0) for name in PER_MOVE}
    each["dwell"][i + np.arange(len(i)) + 1] = 0.0
    p, k = np.insert(path.p, i, low + share * (high - low), axis=0), np.insert(path.k, i, path.k[i - 1], axis=0)
    return replace(path, p=p, k=k, **each, counts=None)


def in_levels(path: Toolpath, raised: FloatArray, top: float) -> Toolpath:
    """The path once for each height (j,) m that it is raised by, with rapids ``CLEAR`` above ``top`` (m) between; cuts
    that would lie above the stock then are rapids. Raises ToolpathError where the tool leans."""
    if (path.k[:, 2] < 1.0 - 1e-9).any():
        raise ToolpathError("The tool leans on this path: passes one above the other are not known for it.")
    over = max(top, float(path.p[:, 2].max())) + CLEAR
    parts: list[dict[str, FloatArray]] = []
    for height in raised:
        p = path.p + np.array([0.0, 0.0, height])
        each = {name: np.array(getattr(path, name)) for name in PER_MOVE}
        air = each["cutting"] & (np.minimum(p[:, 2], np.roll(p[:, 2], 1)) >= top)
        each["cutting"] = each["cutting"] & ~air
        each["v_f"] = np.where(air, 0.0, each["v_f"])
        if parts:
            before = parts[-1]
            off, above = [*before["p"][-1][:2], over], [*p[0][:2], over]
            way: dict[str, Any] = {name: np.zeros(3, dtype=kind) for name, kind in PER_MOVE.items()}
            for name in ("block", "n_s", "tool", "ccw"):
                way[name][:] = each[name][0] if name == "block" else before[name][-1]
            parts.append({"p": np.array([off, above, p[0]]), "k": np.tile(path.k[0], (3, 1)), **way})
            p, each = p[1:], {name: values[1:] for name, values in each.items()}
            parts.append({"p": p, "k": path.k[1:], **each})
        else:
            parts.append({"p": p, "k": np.array(path.k), **each})
    joined: dict[str, Any] = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return replace(path, **joined, counts=None)
