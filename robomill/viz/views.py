"""From a result to what the figures need: plain arrays in the frame and unit of the picture."""

from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.kinematics.forward import joint_frames
from robomill.simulation.enlarged import Enlarged
from robomill.simulation.result import SimulationResult
from robomill.simulation.stations import place_at
from robomill.surface.sections.groove import GrooveSection
from robomill.units import format_si, from_si, unit_label
from robomill.viz.arm import ArmScene
from robomill.viz.rendered.picture import SurfacePicture
from robomill.viz.sections import SectionDrawing


def surface_picture(
    result: SimulationResult,
    shown: Enlarged,
    *,
    station: float | None = None,
    at: float | None = None,
    error_unit: str = "mm",
    **more: Any,
) -> SurfacePicture:
    """What the drawing process needs for the machined surface; ``station`` (m of length cut) marks the section.

    ``at`` (m of length cut, default the station or the middle) gives the direction that the camera presets go by;
    ``more`` are fields of SurfacePicture, as camera, theme and size. The colours count in ``error_unit``.
    """
    setup = result.setup
    middle = 0.5 * float(result.path.s[-1])
    where, along = place_at(result.path, station if station is not None else middle)
    if station is None and at is not None:
        along = place_at(result.path, at)[1]
    if np.hypot(along[0], along[1]) < 1e-9:
        along = np.array([1.0, 0.0, 0.0])
    if more.get("solids") and "headroom" not in more:
        more["headroom"] = headroom(result)
    direction = along[:2] / (np.linalg.norm(along[:2]) or 1.0)
    captions = (
        f"Displacement shown x {shown.times:g}" if shown.times != 1 else "True displacement",
        "Thin line: the ideal cut. Parallel projection.",
    )
    return SurfacePicture(
        x=from_si(shown.drawn.x, "mm"),
        y=from_si(shown.drawn.y, "mm"),
        z=from_si(shown.drawn.z, "mm"),
        ideal=from_si(shown.ideal.z, "mm"),
        error=from_si(shown.error, error_unit),
        wall=from_si(shown.wall, error_unit),
        limit=float(from_si(setup.tolerance, error_unit)),
        unit=unit_label(error_unit),
        bottom=float(from_si(setup.stock_block.lower[2], "mm")),
        direction=(float(direction[0]), float(direction[1])),
        station=None if station is None else tuple(from_si(where, "mm").tolist()),
        **{"captions": captions, **more},
    )


def headroom(result: SimulationResult) -> float:
    """mm above the part that its tools need in a picture."""
    return 4.0 * float(from_si(max(cutter.diameter for cutter in result.tooling.cutters), "mm"))


def arm_scene(result: SimulationResult, index: int, length: str = "mm") -> ArmScene:
    """The arm at sample ``index`` of the run, with part, path, force and displacement; its words in ``length``."""
    setup = result.setup
    path = result.path
    keep = path.cutting | np.append(path.cutting[1:], False)
    F, delta = result.F[index], result.delta[index]
    return ArmScene(
        frames=joint_frames(setup.robot, result.theta[index]),
        joints=setup.robot.joint_numbers,
        T_MW=setup.T_MW,
        part=(setup.stock_block.lower, setup.stock_block.upper),
        path=setup.in_base(path.p[keep]),
        path_reached=result.reached[keep],
        force=F if np.isfinite(F).all() else None,
        displacement=delta if np.isfinite(delta).all() else None,
        force_label=format_si(float(np.linalg.norm(F)), "N", 0),
        displacement_label=format_si(float(np.linalg.norm(delta)), length),
        cutter_radius=result.tooling.at(index).radius,
    )


def section_drawing(section: GrooveSection, unit: str) -> SectionDrawing:
    """A measured section in display units; of a groove the drawing shows a few millimetres beside it."""

    def shown(value: Any) -> Any:
        return from_si(value, unit)

    walls = np.array([section.wall_left, section.wall_right, section.wall_left_ideal, section.wall_right_ideal])
    w = section.w
    if section.kind == "groove" and np.isfinite(walls).all():
        beside = 0.45 * float(np.ptp(walls))
        w = np.clip(w, walls.min() - beside, walls.max() + beside)
    keep = w == section.w
    w_machined = _upright(section.w, section.z_machined, (section.wall_left, section.wall_right))
    w_ideal = _upright(section.w, section.z_ideal, (section.wall_left_ideal, section.wall_right_ideal))
    walls_of = [f"wall_{side}{what}" for side in ("left", "right") for what in ("", "_ideal", "_error")]
    same = (*walls_of, "width", "depth", "centre_offset", "floor_error", "flatness", "error_mean", "error_max", "floor")
    return SectionDrawing(
        kind=section.kind,
        near=section.near,
        u=shown(w_machined[keep]),
        machined=shown(section.z_machined[keep]),
        u_ideal=shown(w_ideal[keep]),
        ideal=shown(section.z_ideal[keep]),
        **{name: shown(getattr(section, name)) for name in same},
        slope=float(from_si(section.slope, "deg")),
        unit=unit,
        note=section.note,
    )


def _upright(w: FloatArray, z: FloatArray, walls: tuple[float, float]) -> FloatArray:
    """Positions with the two samples beside an upright wall put on the wall itself, where it was measured."""
    placed, depth = w.copy(), float(np.ptp(z))
    for wall in walls:
        i = int(np.searchsorted(w, wall)) if np.isfinite(wall) else 0
        if 0 < i < len(w) and abs(z[i] - z[i - 1]) > 0.6 * depth:
            placed[i - 1 : i + 1] = wall
    return placed
