"""Pictures of a report: the section with its tolerance, the errors along the path, which joint gives. SVG, in print
colours that hold without colour, too."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.deflection import shares_along
from robomill.report.drawn import Axes, svg
from robomill.report.tags import Html, joined, tag
from robomill.simulation.result import SimulationResult
from robomill.surface.sections.groove import GrooveSection
from robomill.units import format_limit, format_percent, format_si, format_value, from_si

WIDE, HALF = 720, 352  # units of a picture over the whole width, and of one beside another
BESIDE = 0.3  # of what is cut: how much of the part is drawn on each side
MOST = 4.0  # tolerances that a picture reaches to at most


def section_picture(section: GrooveSection, result: SimulationResult) -> Html:
    """The section to scale: metal that is left, the ideal outline, and around it what the tolerances allow."""
    w, ideal, left = (from_si(each, "mm") for each in (section.w, section.z_ideal, section.z_machined))
    lowest, top = min(ideal.min(), left.min()), max(ideal.max(), left.max())
    shown = _about_the_cut(w, ideal)
    w, ideal, left = (each[shown][::-1] for each in (w, ideal, left))  # + is left of the feed, and stands to the left
    width, height = HALF - 50, 190
    tall = max(1.25 * (top - lowest), (w[0] - w[-1]) * height / width)
    wide = tall * width / height
    middle, base = 0.5 * (w[0] + w[-1]), lowest - 0.45 * (tall - (top - lowest))
    axes = Axes(40, 18, width, height, (middle + 0.5 * wide, middle - 0.5 * wide), (base, base + tall))
    edge = np.concatenate([[axes.x[0]], w, [axes.x[1]]])
    outlines = [np.concatenate([z[:1], z, z[-1:]]) for z in (ideal, left)]
    across, up = axes.at(edge, outlines[1])
    metal = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(across, up, strict=True))
    metal += f" {axes.right:.1f},{axes.bottom:.1f} {axes.left:.1f},{axes.bottom:.1f}"
    verdict, box = result.verdict, tag("rect", x=axes.left, y=axes.top, width=axes.width, height=axes.height)
    said = (
        f"Section across the feed after {format_si(section.station, 'mm', 1)} of cut: the part that is left, the ideal "
        f"outline, and the tolerances {format_limit(verdict.wall.tolerance, 'mm')} (walls) and "
        f"{format_limit(verdict.floor.tolerance, 'mm')} (floors) about it."
    )
    return svg(
        HALF,
        240,
        said,
        tag("clipPath", box, id="cut"),
        axes.frame("across the feed, mm (+ is left of it)", "height, mm"),
        tag(
            "g",
            tag("polygon", points=metal, class_="metal"),
            _allowed(axes, edge, outlines[0], (verdict.wall.tolerance, verdict.floor.tolerance)),
            axes.line(edge, outlines[1], "left"),
            axes.line(edge, outlines[0], "ideal"),
            clip_path="url(#cut)",
        ),
    )


def _about_the_cut(w: FloatArray, z: FloatArray) -> slice:
    """What of a section is drawn: where it is cut, and some of the part beside."""
    cut = np.flatnonzero(z < z.max() - 0.02 * (z.max() - z.min()))
    if not len(cut):
        return slice(None)
    beside = BESIDE * (w[cut[-1]] - w[cut[0]])
    low, high = np.searchsorted(w, [w[cut[0]] - beside, w[cut[-1]] + beside])
    return slice(max(int(low) - 1, 0), int(high) + 1)


def _allowed(axes: Axes, w: FloatArray, z: FloatArray, tolerances: tuple[float, float]) -> Html:
    """All that is within the tolerances of walls (across) and floors (up) of an outline: a line as thick as they are,
    in a picture that is stretched by each."""
    (x_0, x_1), (y_0, y_1) = axes.x, axes.y
    across = from_si(tolerances[0], "mm") * axes.width / abs(x_1 - x_0)
    up = from_si(tolerances[1], "mm") * axes.height / (y_1 - y_0)
    x, y = axes.at(w, z)
    points = " ".join(f"{a:.3f},{b:.3f}" for a, b in zip(x / across, y / up, strict=True))
    line = tag("polyline", points=points, class_="allowed")
    return tag("g", line, transform=f"scale({across:.5f} {up:.5f})")


def path_picture(result: SimulationResult) -> Html:
    """How far the tip is off across the feed and along the tool, over the length cut, with what is allowed."""
    path, verdict = result.path, result.verdict
    at = np.flatnonzero(path.cutting)
    s = from_si(path.s[at], "mm")
    known = result.judged[at]
    off = np.where(known[:, None], from_si(result.delta_in_cut[at], "mm"), np.nan)
    first = np.append(True, np.diff(at) > 1)  # a rapid parts two cuts
    gap = np.flatnonzero(first)[1:]
    limits = {"wall": verdict.wall.tolerance, "floor": verdict.floor.tolerance}
    largest = max(from_si(limit, "mm") for limit in limits.values())
    size = min(max(1.25 * largest, 1.08 * float(np.nanmax(np.abs(off[:, 1:]), initial=0.0))), MOST * largest)
    beyond = int((np.abs(off[:, 1:]) > size).any(axis=1).sum())
    axes = Axes(48, 18, WIDE - 58, 150, (0.0, max(float(s[-1]), 1e-9)), (-size, size))
    parts = [
        axes.frame("length cut, mm", "deviation of the tip, mm"),
        axes.stretches(s, (result.not_judged | result.missed)[at], "lost"),
    ]
    for name, limit in limits.items():
        if name == "floor" and limit == limits["wall"]:
            continue
        only = f" ({name}s)" if limits["wall"] != limits["floor"] else ""
        for sign in (1, -1):
            words = f"± {format_limit(limit, 'mm')} allowed{only}" if (sign > 0) == (name == "wall") else ""
            parts.append(axes.level(sign * from_si(limit, "mm"), words, "limit"))
    box = tag("rect", x=axes.left, y=axes.top, width=axes.width, height=axes.height)
    lines = [
        axes.line(np.insert(s, gap, np.nan), np.insert(np.clip(off[:, k], -2 * size, 2 * size), gap, np.nan), look)
        for k, look in ((1, "wall"), (2, "floor"))
    ]
    parts += [tag("clipPath", box, id="along"), tag("g", *lines, clip_path="url(#along)"), _changes(result, axes)]
    said = "Deviation of the tip over the length cut, across the feed (whole line) and along the tool (broken line)."
    more = tag("text", f"{beyond} points lie beyond the picture", x=52, y=axes.bottom - 6, class_="b") if beyond else ""
    return svg(WIDE, 200, said, *parts, more)


def _changes(result: SimulationResult, axes: Axes) -> Html:
    """Where another tool goes on."""
    path = result.path
    at = np.flatnonzero(path.cutting)
    tools = path.tool[at]
    parts = []
    for i in np.flatnonzero(np.append(True, tools[1:] != tools[:-1]))[:40] if len(set(tools.tolist())) > 1 else ():
        x, _ = axes.at(from_si(path.s[at[i]], "mm"), 0.0)
        where = f"{float(x):.1f}"
        parts.append(tag("line", x1=where, x2=where, y1=axes.top, y2=axes.bottom, class_="tool"))
        parts.append(tag("text", f"T{tools[i]}", x=f"{float(x) + 3:.1f}", y=axes.top + 11, class_="b"))
    return joined(parts)


def joints_picture(record: Mapping[str, Any]) -> Html | None:
    """Each joint's and spring's part of the largest deviation, along it; None where there are no such parts."""
    parts = joint_parts(record)
    if not parts:
        return None
    row, size = 21, max(abs(value) for _, value in parts) or 1.0
    left, width = 104.0, HALF - 104.0 - 110.0
    zero = left + (0.25 * width if min(value for _, value in parts) < -1e-3 * size else 0.0)
    scale = (left + width - zero) / size
    whole = record["max_deviation_mm"]
    shown = []
    for n, (name, value) in enumerate(parts):
        y, end, look = 22 + n * row, zero + value * scale, "bar" if value >= 0.0 else "bar back"
        words = f"{format_value(value, 'mm', sign=True)}, {format_percent(value / whole)}" if whole else "none"
        shown += [
            tag("text", name[:18], x=left - 6, y=y + 11, class_="e"),
            tag(
                "rect", x=f"{min(zero, end):.1f}", y=y, width=f"{max(abs(end - zero), 0.5):.1f}", height=14, class_=look
            ),
            tag("text", words, x=f"{max(zero, end) + 5:.1f}", y=y + 11, class_="b"),
        ]
    high = 34 + len(parts) * row
    said = "Parts of the largest deviation along it: " + "; ".join(
        f"{name} {format_value(value, 'mm', sign=True)}" for name, value in parts
    )
    axis = tag("line", x1=f"{zero:.1f}", x2=f"{zero:.1f}", y1=18, y2=high - 10, class_="z")
    return svg(HALF, high, said, *shown, axis)


def joint_parts(record: Mapping[str, Any]) -> list[tuple[str, float]]:
    """Of a run's record: each joint and spring with its part of the largest deviation along that, mm."""
    if not record["joint_shares_add_up"] or not record["worst_block"]:
        return []
    names = [f"joint {number}" for number in record["joints"]]
    vectors = [*record["joint_share_mm"], *record["spring_share_mm"].values()]
    names += list(record["spring_share_mm"])
    if record["sag_added"] and record["sag_mm"] is not None:
        names, vectors = [*names, "own weight"], [*vectors, record["sag_mm"]]
    shares = shares_along(np.array(vectors, dtype=float), np.array(record["deviation_mm"], dtype=float))
    return list(zip(names, (shares * record["max_deviation_mm"]).tolist(), strict=True))
