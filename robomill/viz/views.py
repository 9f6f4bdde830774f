"""From a result to what the figures need: plain arrays in the frame and unit of the picture."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.kinematics.forward import joint_frames
from robomill.simulation.result import SimulationResult
from robomill.surface.deviation import deviation
from robomill.surface.groove import GrooveSection
from robomill.surface.stock import stock_grid
from robomill.surface.zmap import ZMap, cut
from robomill.units import format_si, from_si
from robomill.viz.arm import ArmScene
from robomill.viz.scene import Camera, SurfacePicture
from robomill.viz.sections import SectionDrawing

PICTURE_CELLS = 160_000


@dataclass(frozen=True, eq=False)
class Exaggerated:
    """The machined surface with the deflection enlarged ``times`` times, beside the ideal one, on a grid for pictures.

    ``error`` (nx, ny) m is the true signed error at each cell: of a floor in height, of a wall sideways. NaN where
    nothing was cut.
    """

    ideal: ZMap
    drawn: ZMap
    error: FloatArray
    times: float


def exaggerated(result: SimulationResult, times: float) -> Exaggerated:
    """Cut again with the tip ``times`` times as far off its path; ``times`` = 1 is the machined surface itself.

    Raises SurfaceError for a cell size that does not fit and for a path that misses the stock.
    """
    setup, path = result.setup, result.path
    size = setup.stock_block.upper - setup.stock_block.lower
    cell = max(setup.cell, float(np.sqrt(size[0] * size[1] / PICTURE_CELLS)))

    def at(factor: float) -> ZMap:
        p = path.p + factor * (result.p_machined - path.p)
        return cut(setup.stock_block, cell, setup.cutter, p, path.k, result.removes, must_touch=factor == 0.0)

    stock_grid(setup.stock_block, setup.cell)  # the surface itself must fit, not just its picture
    ideal, drawn = at(0.0), at(times)
    if times <= 1.0:
        reach = 1.3 * float(np.nanmax(result.deviation, initial=0.0)) + 2 * cell
        return Exaggerated(ideal, drawn, deviation(ideal, drawn, reach=reach).error / (times or 1.0), times)
    error = enlarged_error(result, ideal, drawn, times)
    return Exaggerated(ideal, drawn, np.where(ideal.cut_mask | drawn.cut_mask, error, np.nan), times)


def enlarged_error(result: SimulationResult, ideal: ZMap, drawn: ZMap, times: float) -> FloatArray:
    """True signed error (nx, ny) m, told by an enlarged picture.

    Where the heights differ by no more than the enlarged path rises or sinks it is an error of height. Where they
    differ by more a wall has moved, by as much as the tip did sideways at the nearest sample: material is left beside
    the commanded path (+) and cut away beside the deflected one (-).
    """
    from scipy.spatial import cKDTree

    error = (drawn.z - ideal.z) / times
    i = np.flatnonzero(result.judged)
    if not len(i):
        return error
    told, moved = result.path.p[i], (result.p_machined - result.path.p)[i]
    aside, slack = np.linalg.norm(moved[:, :2], axis=1), drawn.cell / times
    far = (error > 1.02 * max(moved[:, 2].max(), 0.0) + slack) | (error < 1.02 * min(moved[:, 2].min(), 0.0) - slack)
    x, y = np.meshgrid(drawn.x, drawn.y, indexing="ij")
    for sign, points in ((1.0, told), (-1.0, told + times * moved)):
        cells = far & (np.sign(error) == sign)
        if cells.any():
            nearest = cKDTree(points[:, :2]).query(np.column_stack([x[cells], y[cells]]))[1]
            error[cells] = sign * aside[nearest]
    return error


def so_far(result: SimulationResult, shown: Exaggerated, index: int) -> Exaggerated:
    """``shown`` as it stands once sample ``index`` is reached; what is not cut yet carries no error."""
    setup, path = result.setup, result.path
    if index < 1 or not result.removes[1 : index + 1].any():
        heights = np.broadcast_to(shown.ideal.z_stock, shown.ideal.z.shape)
        return replace(shown, drawn=replace(shown.drawn, z=heights), error=np.full(heights.shape, np.nan))
    upto = slice(0, index + 1)

    def at(p: FloatArray) -> ZMap:
        return cut(
            setup.stock_block,
            shown.drawn.cell,
            setup.cutter,
            p[upto],
            path.k[upto],
            result.removes[upto],
            must_touch=False,
        )

    drawn, told = at(path.p + shown.times * (result.p_machined - path.p)), at(path.p)
    done = (drawn.z == shown.drawn.z) & (told.z == shown.ideal.z)
    return replace(shown, drawn=drawn, error=np.where(done, shown.error, np.nan))


def tip_drawn(result: SimulationResult, shown: Exaggerated, index: int) -> FloatArray:
    """(3,) m in {W}: the tool's tip at sample ``index`` as the picture shows it, its displacement enlarged."""
    p = result.path.p[index]
    moved = shown.times * (result.p_machined[index] - p)
    return np.asarray(p + np.where(np.isfinite(moved), moved, 0.0))


def surface_picture(
    result: SimulationResult,
    shown: Exaggerated,
    *,
    camera: Camera,
    dark: bool,
    station: float | None,
    size: tuple[int, int] = (1280, 720),
    words: bool = True,
    at: float | None = None,
    **more: Any,
) -> SurfacePicture:
    """What the drawing process needs for the machined surface; ``station`` (m of length cut) marks the section.

    ``words=False`` leaves the captions out, where they stand beside the picture; ``at`` (m of length cut, default the
    station or the middle) gives the direction that the camera presets go by; ``more`` are fields of SurfacePicture.
    """
    setup = result.setup
    middle = 0.5 * float(result.path.s[-1])
    where, along = place(result, station if station is not None else middle)
    if station is None and at is not None:
        along = place(result, at)[1]
    if np.hypot(along[0], along[1]) < 1e-9:
        along = np.array([1.0, 0.0, 0.0])
    if more.get("solids") and "headroom" not in more:
        more["headroom"] = 4.0 * float(from_si(setup.cutter.diameter, "mm"))
    direction = along[:2] / (np.linalg.norm(along[:2]) or 1.0)
    captions = [
        f"Displacement shown x {shown.times:g}" if shown.times != 1 else "True displacement",
        "Thin line: the ideal cut. Parallel projection.",
    ]
    return SurfacePicture(
        x=from_si(shown.drawn.x, "mm"),
        y=from_si(shown.drawn.y, "mm"),
        z=from_si(shown.drawn.z, "mm"),
        ideal=from_si(shown.ideal.z, "mm"),
        error_um=from_si(shown.error, "um"),
        limit_um=float(from_si(setup.tolerance, "um")),
        bottom=float(from_si(setup.stock_block.lower[2], "mm")),
        camera=camera,
        dark=dark,
        size=size,
        direction=(float(direction[0]), float(direction[1])),
        station=None if station is None else tuple(from_si(where, "mm").tolist()),
        captions=tuple(captions) if words else (),
        **more,
    )


def place(result: SimulationResult, station: float) -> tuple[FloatArray, FloatArray]:
    """Point and unit direction (3,), (3,) in {W} of the commanded path at ``station`` (m of length cut)."""
    path = result.path
    i = int(np.clip(np.searchsorted(path.s, station - 1e-12), 1, len(path) - 1))
    while i < len(path) - 1 and not path.cutting[i]:
        i += 1
    step = path.p[i] - path.p[i - 1]
    length = float(np.linalg.norm(step))
    share = 1.0 - (float(path.s[i]) - station) / length if length > 0 else 1.0
    return path.p[i - 1] + np.clip(share, 0.0, 1.0) * step, step / length if length > 0 else np.array([1.0, 0.0, 0.0])


def sample_at(result: SimulationResult, station: float) -> int:
    """Index of the sample nearest to ``station`` (m of length cut) among those judged; the worst one where none is."""
    judged = np.flatnonzero(result.judged)
    if len(judged) == 0:
        return result.worst
    return int(judged[np.argmin(np.abs(result.path.s[judged] - station))])


def arm_scene(result: SimulationResult, index: int, **more: Any) -> ArmScene:
    """The arm at sample ``index`` of the run, with part, path, force and displacement."""
    setup = result.setup
    R, t = setup.T_MW[:3, :3], setup.T_MW[:3, 3]
    path = result.path
    keep = path.cutting | np.append(path.cutting[1:], False)
    F, delta = result.F[index], result.delta[index]
    return ArmScene(
        frames=joint_frames(setup.robot, result.theta[index]),
        T_MW=setup.T_MW,
        part=(setup.stock_block.lower, setup.stock_block.upper),
        path=path.p[keep] @ R.T + t,
        path_reached=result.reached[keep],
        force=F if np.isfinite(F).all() else None,
        displacement=delta if np.isfinite(delta).all() else None,
        force_label=format_si(float(np.linalg.norm(F)), "N", 0),
        displacement_label=format_si(float(np.linalg.norm(delta)), "mm", 2),
        cutter_radius=setup.cutter.radius,
        **more,
    )


def section_drawing(section: GrooveSection, unit: str) -> SectionDrawing:
    """A measured section in display units; the drawing shows the groove and a few millimetres beside it."""

    def shown(value: Any) -> Any:
        return from_si(value, unit)

    walls = np.array([section.wall_left, section.wall_right, section.wall_left_ideal, section.wall_right_ideal])
    w = section.w
    if np.isfinite(walls).all():
        beside = 0.45 * float(np.ptp(walls))
        w = np.clip(w, walls.min() - beside, walls.max() + beside)
    keep = w == section.w
    w_machined = _upright(section.w, section.z_machined, (section.wall_left, section.wall_right), section.depth)
    w_ideal = _upright(section.w, section.z_ideal, (section.wall_left_ideal, section.wall_right_ideal), section.depth)
    return SectionDrawing(
        u=shown(w_machined[keep]),
        machined=shown(section.z_machined[keep]),
        u_ideal=shown(w_ideal[keep]),
        ideal=shown(section.z_ideal[keep]),
        wall_left=shown(section.wall_left),
        wall_right=shown(section.wall_right),
        width=shown(section.width),
        depth=shown(section.depth),
        centre_offset=shown(section.centre_offset),
        floor_error=shown(section.floor_error),
        top=shown(section.floor + section.depth),
        floor=shown(section.floor),
        unit=unit,
    )


def _upright(w: FloatArray, z: FloatArray, walls: tuple[float, float], depth: float) -> FloatArray:
    """Positions with the two samples beside an upright wall put on the wall itself, where it was measured."""
    placed = w.copy()
    for wall in walls:
        i = int(np.searchsorted(w, wall)) if np.isfinite(wall) else 0
        if 0 < i < len(w) and abs(z[i] - z[i - 1]) > 0.6 * depth:
            placed[i - 1 : i + 1] = wall
    return placed


def plan_view(result: SimulationResult, quantity: str, unit: str) -> dict[str, Any]:
    """Arguments of ``plan_figure``: the path from above coloured by "deviation" or by room to the joint "limits"."""
    path, setup = result.path, result.setup
    if quantity == "limits":
        limits = setup.robot.limits
        room = np.minimum(result.theta - limits[:, 0], limits[:, 1] - result.theta).min(axis=1)
        value, title, shown_unit, limit = from_si(room, "deg"), "Room to the nearest limit", "°", None
    else:
        value, title, shown_unit = from_si(result.deviation, unit), "Deviation", unit
        limit = float(from_si(setup.tolerance, unit))
    stock = setup.stock_block
    return {
        "points": from_si(path.p, unit),
        "cutting": path.cutting,
        "reached": result.reached,
        "value": value,
        "title": title,
        "unit": shown_unit,
        "block": path.block,
        "limit": limit,
        "length_unit": unit,
        "stock": (from_si(stock.lower, unit), from_si(stock.upper, unit)),
    }
