"""The arm as a turnable figure: links as tubes, frames {M}, {W}, {T}, the part, the path, force and displacement."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from robomill.arrays import BoolArray, FloatArray
from robomill.units import format_many, format_significant, from_si, to_si, unit_label
from robomill.viz import solids
from robomill.viz.chart import Chart, Trace, drawn, xyz
from robomill.viz.ellipsoid import ellipsoid_scale, ellipsoid_traces
from robomill.viz.rendered import framing
from robomill.viz.theme import axis3d, axis_colours, figure, palette

EYE = (1.30, -0.95, 0.62)
# Of arrows: the size at which one is half as long as it gets, and how long that is, in the arm's yardstick.
FORCE, MOVED = (50.0, 0.30), (0.125e-3, 0.255)  # N, m
WORD = (0.24, 0.09)  # of the arm's yardstick: what a word takes, wide and high


@dataclass(frozen=True, eq=False)
class ArmScene:
    """What to draw, in m and in {M}; parts left at None are not drawn. ``unit`` is what the axes and words count in.

    frames (n+1, 4, 4): the frame before each joint (the joint turns about its z), then {T}.
    offset (n,): travel along each joint's z before the link goes across (the D-H d).
    joints (n,): the joints' numbers, 1 to n where they are not given.
    C (3, 3) m/N: the compliance at the tip, drawn as a body with its longest half axis at 0.16 of the arm's yardstick.
    aspect: width over height of the frame that the arm fills, seen from ``eye`` and without axes; None: in its axes.
    part (lower (3,), upper (3,)) in {W}; path (m, 3) with reached (m,); force, displacement (3,) at the tip.
    """

    frames: FloatArray
    T_MW: FloatArray | None = None
    part: tuple[FloatArray, FloatArray] | None = None
    path: FloatArray | None = None
    path_reached: BoolArray | None = None
    force: FloatArray | None = None
    displacement: FloatArray | None = None
    force_label: str = ""
    displacement_label: str = ""
    C: FloatArray | None = None
    cutter_radius: float = 0.004
    ghost: FloatArray | None = None
    joints: tuple[int, ...] = ()
    bench: bool = True
    unit: str = "m"
    aspect: float | None = None
    eye: tuple[float, float, float] = EYE


def arm_figure(scene: ArmScene, *, dark: bool, height: int = 460, revision: str = "arm", zoom: float = 1.0) -> Chart:
    """The arm with everything in ``scene``; the camera stays while ``revision`` does.

    ``zoom`` below 1 suits a narrow column.
    """
    p = palette(dark)
    reach = solids.yardstick(scene.frames)
    fig = figure(dark=dark, height=height, revision=revision, margin={"l": 0, "r": 0, "t": 0, "b": 0})
    if scene.ghost is not None:
        links, joints = solids.limbs(scene.ghost)
        fig.add_traces([solids.trace([*links, *joints], p.muted, "before", opacity=0.18)])
    tip, width, name_colour = scene.frames[-1][:3, 3], 0.0065 * reach, axis_colours(dark)["z"]
    opaque = [*_arm(scene, dark), *_foot(scene, reach, dark), *solids.frame(np.eye(4), 0.16 * reach, dark)]
    far = (1.12, 1.12) if scene.aspect is None else (1.28, 1.6)  # of force and displacement: words beside the arrows
    said: list[solids.Said] = [(np.array([0.0, 0.0, 0.208 * reach]), "{M}", name_colour)]
    if scene.T_MW is not None:
        opaque += solids.frame(scene.T_MW, 0.075 * reach, dark)
        beside = scene.T_MW @ np.array([-0.1275 * reach, -0.045 * reach, 0.0, 1.0])
        said.append((beside[:3], "{W}", name_colour))
    if scene.force is not None:
        vector = scene.force * _drawn(float(np.linalg.norm(scene.force)), FORCE, reach)
        opaque += solids.arrow(tip - vector, vector * 0.96, p.accent, width)
        upright = max(float(vector[2]), 0.0) / (0.20 * reach)  # its words stand over their point, and the arrow too
        said.append((tip - (far[0] + 0.25 * upright) * vector, scene.force_label, p.accent))
    if scene.displacement is not None:
        vector = scene.displacement * displacement_scale(scene.displacement, scene.frames)
        opaque += solids.arrow(tip, vector, p.warm, width)
        said.append((tip + far[1] * vector, scene.displacement_label, p.warm))
    if scene.C is not None:
        grown = ellipsoid_scale(scene.C, 0.16 * reach)
        body, words = ellipsoid_traces(scene.C, tip, grown, dark=dark, width=width, away=scene.displacement)
        fig.add_traces(body)
        said += words
    if scene.aspect is not None:
        fig.add_traces([solids.painted(opaque), _joint_hover(scene, p.text), *_part_traces(scene, reach, dark)])
        across = [i for i in (0, 1) if abs(scene.eye[i]) < 0.9 * np.linalg.norm(scene.eye)]
        said += [(0.19 * reach * np.eye(3)[i], "XYZ"[i], axis_colours(dark)["xyz"[i]]) for i in across]
        return _filling(fig, scene, said, dark)
    fig.add_traces([solids.painted(opaque), _joint_hover(scene, p.text)])
    fig.add_traces([solids.words(said, textposition=_beside(said, tip, scene))])
    fig.add_traces(_part_traces(scene, reach, dark))
    fig.lay_out(scene=_scene_layout(_bounds(fig, reach), scene.unit, dark, revision, zoom), showlegend=False)
    return fig


def _beside(said: list[solids.Said], tip: FloatArray, scene: ArmScene) -> list[str]:
    """Where each word stands: that of the force away from the tip, that of the displacement over its point; where the
    two would meet, on both sides and one above the other."""
    place = dict.fromkeys(range(len(said)), "middle center")
    right, up = framing.screen(np.asarray(scene.eye, dtype=float))
    at = {word: (k, np.array([right, up]) @ (point - tip)) for k, (point, word, _) in enumerate(said) if word}
    if scene.force_label not in at:
        return list(place.values())
    k, force = at[scene.force_label]
    side, other = ("left", "right") if force[0] < 0.0 else ("right", "left")
    place[k] = f"middle {side}"
    if scene.displacement_label in at:
        n, moved = at[scene.displacement_label]
        wide, high = np.array(WORD) * solids.yardstick(scene.frames)
        between = moved[0] - force[0] + 0.5 * (wide if side == "left" else -wide)
        if abs(between) < wide and abs(moved[1] - force[1]) < high:
            upper, lower = ("top", "bottom") if moved[1] > force[1] else ("bottom", "top")
            place |= {k: f"{lower} {side}", n: f"{upper} {other}"}
    return list(place.values())


def _filling(fig: Chart, scene: ArmScene, said: list[solids.Said], dark: bool) -> Chart:
    """The arm on most of its frame, its words on a ground of their own."""
    drawn_points = [np.stack([np.asarray(t[a], dtype=float) for a in "xyz"], axis=1) for t in fig.traces]
    points = np.vstack([*drawn_points, *(np.asarray(at, dtype=float)[None] for at, word, _ in said if word)])
    ground = "rgba(17,24,29,0.8)" if dark else "rgba(255,255,255,0.8)"
    layout = framing.framed(points[np.isfinite(points).all(axis=1)], scene.eye, scene.aspect or 1.0)
    words = {"annotations": framing.signs(said, ground)}
    return fig.lay_out(
        scene={**layout, **words, "uirevision": fig.layout["uirevision"], "dragmode": "turntable"}, showlegend=False
    )


def displacement_scale(displacement: FloatArray, frames: FloatArray) -> float:
    """How many times larger than true ``arm_figure`` draws the displacement (for its caption)."""
    size = float(np.linalg.norm(displacement))
    return _drawn(size, MOVED, solids.yardstick(frames)) if size > 0 else 1.0


def _scene_layout(bounds: FloatArray, unit: str, dark: bool, revision: str, zoom: float) -> dict[str, Any]:
    span = np.ptp(bounds, axis=0)
    ratio = 2.3 * zoom * span / np.linalg.norm(span)
    axes = {
        f"{name}axis": axis3d(
            f"{name.upper()}<sub>M</sub>, {unit_label(unit)}",
            dark=dark,
            range=bounds[:, i].tolist(),
            **_ticks(bounds[:, i], unit),
        )
        for i, name in enumerate("xyz")
    }
    return {
        **axes,
        "uirevision": revision,
        "dragmode": "turntable",
        "aspectmode": "manual",
        "aspectratio": dict(zip("xyz", ratio.tolist(), strict=True)),
        "camera": {
            "eye": dict(zip("xyz", EYE, strict=True)),
            "center": {"x": -0.03, "y": -0.04, "z": -0.04},
            "projection": {"type": "orthographic"},
        },
    }


def _ticks(ends: FloatArray, unit: str) -> dict[str, Any]:
    """Round numbers of ``unit`` along an axis whose coordinates are in m; the figure finds its own where that is m."""
    if unit == "m":
        return {}
    low, high = from_si(ends, unit)
    step = next(step for step in (0.5, 1, 2, 5, 10, 20, 50, 100, 500, math.inf) if (high - low) / step < 5)
    at = np.arange(math.ceil(low / step), math.floor(high / step) + 1) * step
    return {"tickvals": to_si(at, unit).tolist(), "ticktext": [format_significant(v) for v in at]}


def _bounds(fig: Chart, reach: float) -> FloatArray:
    """(2, 3): what is drawn, with a small margin; the same box while the arm moves inside it."""
    points = [np.stack([np.asarray(t[a], dtype=float) for a in "xyz"], axis=1) for t in fig.traces]
    every = np.vstack(points)
    low, high = np.nanmin(every, axis=0), np.nanmax(every, axis=0)
    step = 0.08 * reach
    return np.stack([np.floor(low / step - 0.2), np.ceil(high / step + 0.2)]) * step


def _arm(scene: ArmScene, dark: bool) -> list[solids.Painted]:
    p, frames = palette(dark), scene.frames
    reach, tip, k = solids.yardstick(frames), frames[-1][:3, 3], frames[-1][:3, 2]
    links, joints = solids.limbs(frames)
    spindle = solids.tube(tip + 0.035 * reach * k, tip + 0.13 * reach * k, 0.016 * reach, 0.024 * reach)
    cutter = solids.tube(tip, tip + 0.04 * reach * k, max(scene.cutter_radius, 0.004 * reach))
    return [*((m, p.link) for m in links), *((m, p.joint) for m in joints), (spindle, p.joint), (cutter, p.warm)]


def _joint_hover(scene: ArmScene, colour: str) -> Trace:
    joints = scene.joints or range(1, len(scene.frames))
    names = [*(f"joint {number}" for number in joints), "tool tip {T}"]
    places = [format_many(point, scene.unit, 3) for point in scene.frames[:, :3, 3]]
    return drawn(
        "scatter3d",
        **xyz(scene.frames[:, :3, 3]),
        mode="markers",
        showlegend=False,
        marker={"size": 9, "opacity": 0.0, "color": colour},
        text=[f"{name}<br>{place}" for name, place in zip(names, places, strict=True)],
        hovertemplate="%{text}<extra></extra>",
    )


def _foot(scene: ArmScene, reach: float, dark: bool) -> list[solids.Painted]:
    """A foot under {M}; drawn for orientation only, no dimension of it is used."""
    axis, base, colour = np.array([0.0, 0.0, 1.0]), scene.frames[0][:3, 3], palette(dark).link
    if abs(scene.frames[0][2, 2]) < 0.5:
        return []
    foot = base - 0.19 * reach * axis
    column = solids.tube(base - 0.05 * reach * axis, foot, 0.045 * reach, 0.07 * reach)
    return [(column, colour), (solids.tube(foot, foot - 0.02 * reach * axis, 0.115 * reach), colour)]


def _part_traces(scene: ArmScene, reach: float, dark: bool) -> list[Any]:
    """What is clear or a line: part, table and path."""
    p = palette(dark)
    traces: list[Any] = []
    if scene.part is not None and scene.T_MW is not None:
        lower, upper = (np.asarray(corner, dtype=float) for corner in scene.part)
        traces.append(
            solids.trace([solids.box(lower, upper, scene.T_MW)], p.metal, "part", opacity=0.9, flatshading=True)
        )
        if scene.bench:
            traces.append(_bench(lower, upper, scene.T_MW, reach, dark))
    if scene.path is not None and len(scene.path) > 1:
        reached = np.ones(len(scene.path), bool) if scene.path_reached is None else scene.path_reached
        for mask, colour, name in ((reached, p.accent, "path"), (~reached, p.muted, "out of reach")):
            if mask.any():
                points = np.where(mask[:, None], scene.path, np.nan)
                traces.append(
                    drawn(
                        "scatter3d",
                        **xyz(points),
                        mode="lines",
                        name=name,
                        showlegend=False,
                        line={"color": colour, "width": 5, "dash": "solid" if name == "path" else "dot"},
                        hovertemplate=name + "<extra></extra>",
                    )
                )
    return traces


def _bench(lower: FloatArray, upper: FloatArray, T_MW: FloatArray, reach: float, dark: bool) -> Trace:
    """The table under the part; drawn for orientation only."""
    p = palette(dark)
    centre = 0.5 * (lower + upper)
    half = np.maximum(0.5 * (upper - lower) + 0.03 * reach, [0.16 * reach, 0.10 * reach, 0.0])
    low, high = centre - half, centre + half
    low[2], high[2] = lower[2] - 0.016 * reach, lower[2]
    return solids.trace([solids.box(low, high, T_MW)], p.link, "table", opacity=0.28, flatshading=True)


def _drawn(size: float, law: tuple[float, float], reach: float) -> float:
    """How many times its size an arrow is long: longer for more, so that an edit is seen, and never beyond its most."""
    half, most = law
    return most * reach / (size + half)
