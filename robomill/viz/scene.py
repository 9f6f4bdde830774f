"""The rendered machined surface: a solid block cut from a height map, coloured by its signed error.

``SurfacePicture`` is everything a picture needs, as plain arrays in mm; ``draw`` turns it into PNG bytes and is called
in the worker process only (``worker.py``).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from robomill.arrays import FloatArray
from robomill.viz.theme import diverging, palette

Camera = Literal["iso", "top", "front", "along"]
CAMERAS: dict[str, str] = {"iso": "Angled", "along": "Along the cut", "top": "From above", "front": "From the front"}
_METAL_LIGHT, _METAL_DARK = "#C4CCD2", "#66747E"


@dataclass(frozen=True, eq=False)
class SurfacePicture:
    """x (nx,), y (ny,) mm; z, ideal (nx, ny) mm heights, NaN where there is no material; error_um (nx, ny).

    ``z`` is drawn (it may be exaggerated; then ``shown`` says by how much), ``error_um`` colours it between
    +-``limit_um``. ``direction`` (2,) is the way of the cut at ``station`` (3,) mm, where a section plane is drawn.
    """

    x: FloatArray
    y: FloatArray
    z: FloatArray
    ideal: FloatArray
    error_um: FloatArray
    limit_um: float
    bottom: float
    camera: Camera = "iso"
    dark: bool = False
    size: tuple[int, int] = (1280, 720)
    direction: tuple[float, float] = (1.0, 0.0)
    station: tuple[float, float, float] | None = None
    ghost: bool = False
    captions: tuple[str, ...] = field(default=())


def load() -> None:
    """Import the graphics library ahead of the first picture."""
    import matplotlib.colors  # noqa: F401
    import pyvista  # noqa: F401


def draw(picture: SurfacePicture) -> bytes:
    """PNG bytes of the picture. Needs a working OpenGL library; without one the process ends."""
    import io

    import pyvista as pv
    from matplotlib.colors import LinearSegmentedColormap
    from PIL import Image

    p = palette(picture.dark)
    plotter = pv.Plotter(off_screen=True, window_size=list(picture.size), lighting="none")
    plotter.set_background(p.background)  # type: ignore[arg-type]
    _lights(plotter)
    colours = LinearSegmentedColormap.from_list("signed", [(v, c) for v, c in diverging(False)])
    metal = _METAL_DARK if picture.dark else _METAL_LIGHT
    plotter.add_mesh(
        _sheet(picture, picture.z, picture.error_um), scalars="error", cmap=colours,
        clim=(-picture.limit_um, picture.limit_um), nan_color=metal, show_scalar_bar=False,
        ambient=0.32, diffuse=0.72, specular=0.12, specular_power=20, interpolate_before_map=True,
    )  # fmt: skip
    plotter.add_mesh(_skirt(picture), color=metal, ambient=0.3, diffuse=0.7)
    for line in _ideal_lines(picture):
        plotter.add_mesh(line, color=p.text, line_width=2.2, lighting=False)
    if picture.ghost:
        plotter.add_mesh(_sheet(picture, picture.ideal, None), color=p.accent, opacity=0.25)
    if picture.station is not None:
        plotter.add_mesh(_section_plane(picture), color=p.accent, opacity=0.22, lighting=False)
    _colour_bar(plotter, picture, colours)
    _words(plotter, picture)
    _look(plotter, picture)
    plotter.enable_anti_aliasing("ssaa")
    image = plotter.screenshot(return_img=True)
    plotter.close()
    stream = io.BytesIO()
    Image.fromarray(np.asarray(image)).save(stream, "PNG", compress_level=3)
    return stream.getvalue()


def _lights(plotter: Any) -> None:
    import pyvista as pv

    for position, intensity in (((-0.5, -0.8, 1.4), 0.72), ((1.0, 0.2, 0.8), 0.30), ((0.0, 1.0, 0.35), 0.22)):
        light = pv.Light(position=position, focal_point=(0, 0, 0), intensity=intensity, light_type="camera light")
        if intensity > 0.5:
            light = pv.Light(position=position, focal_point=(0, 0, 0), intensity=intensity)
        plotter.add_light(light)


def _sheet(picture: SurfacePicture, z: FloatArray, error: FloatArray | None) -> Any:
    import pyvista as pv

    x, y = np.meshgrid(picture.x, picture.y, indexing="ij")
    sheet = pv.StructuredGrid(x, y, np.where(np.isfinite(z), z, picture.bottom))
    if error is not None:
        sheet["error"] = np.asarray(error, dtype=np.float32).ravel(order="F")
    return sheet


def _skirt(picture: SurfacePicture) -> Any:
    """The four sides of the block, from the surface's edge down to the bottom."""
    import pyvista as pv

    z = np.where(np.isfinite(picture.z), picture.z, picture.bottom)
    x, y = np.meshgrid(picture.x, picture.y, indexing="ij")
    sides = []
    for edge in (np.s_[:, 0], np.s_[-1, :], np.s_[::-1, -1], np.s_[0, ::-1]):
        top = np.stack([x[edge], y[edge], z[edge]], axis=-1)
        low = top.copy()
        low[:, 2] = picture.bottom
        points = np.stack([top, low])
        sides.append(pv.StructuredGrid(points[..., 0:1], points[..., 1:2], points[..., 2:3]))
    return pv.merge([side.extract_surface() for side in sides], merge_points=False)


def _ideal_lines(picture: SurfacePicture) -> list[Any]:
    """Outlines of the ideal cut: where it leaves the stock's top, where its floor begins."""
    ideal = np.where(np.isfinite(picture.ideal), picture.ideal, picture.bottom)
    top, low = float(ideal.max()), float(ideal.min())
    if top - low < 1e-6:
        return []
    sheet = _sheet(picture, ideal, None)
    sheet["height"] = sheet.points[:, 2]
    lines = []
    for level, lift in ((top - 0.02 * (top - low), 0.02), (low + 0.02 * (top - low), 0.02)):
        outline = sheet.contour([level], scalars="height")
        if outline.n_points:
            outline.points[:, 2] += lift * (top - low)
            lines.append(outline)
    return lines


def _section_plane(picture: SurfacePicture) -> Any:
    import pyvista as pv

    assert picture.station is not None
    top = float(np.nanmax(picture.z))
    height = 1.5 * (top - picture.bottom)
    centre = (picture.station[0], picture.station[1], picture.bottom + 0.6 * height)
    width = 0.55 * min(float(np.ptp(picture.x)), float(np.ptp(picture.y))) + 4.0
    # i_size runs along the plane's own x, which pyvista turns with the direction; both are made to fit.
    tangent = np.array([*picture.direction, 0.0])
    across = np.array([-tangent[1], tangent[0], 0.0])
    corners = [
        np.asarray(centre) + a * width * across + b * 0.5 * height * np.array([0.0, 0.0, 1.0])
        for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    return pv.PolyData(np.array(corners), faces=[4, 0, 1, 2, 3])


def _colour_bar(plotter: Any, picture: SurfacePicture, colours: Any) -> None:
    import pyvista as pv

    p = palette(picture.dark)
    carrier = pv.PolyData(np.zeros((2, 3)))
    carrier["signed"] = np.array([-picture.limit_um, picture.limit_um])
    actor = plotter.add_mesh(
        carrier, scalars="signed", cmap=colours, clim=(-picture.limit_um, picture.limit_um), opacity=0.0,
        show_scalar_bar=False, point_size=1,
    )  # fmt: skip
    plotter.add_scalar_bar(
        title="", mapper=actor.mapper, vertical=True, n_labels=5, fmt="%+.0f", color=p.text,
        position_x=0.900, position_y=0.22, width=0.035, height=0.56, label_font_size=_font(picture, 17),
    )  # fmt: skip


def _words(plotter: Any, picture: SurfacePicture) -> None:
    p = palette(picture.dark)
    size = _font(picture, 11)
    plotter.add_text("Error, \u00b5m", position=(0.835, 0.885), viewport=True, font_size=size, color=p.text)
    plotter.add_text("+ material left", position=(0.835, 0.815), viewport=True, font_size=size - 2, color=p.muted)
    plotter.add_text("\u2212 cut too deep", position=(0.835, 0.145), viewport=True, font_size=size - 2, color=p.muted)
    for i, caption in enumerate(picture.captions):
        plotter.add_text(
            caption, position=(0.02, 0.03 + 0.05 * (len(picture.captions) - 1 - i)), viewport=True,
            font_size=size, color=p.text if i == 0 else p.muted,
        )  # fmt: skip
    plotter.add_axes(
        line_width=3, labels_off=False, color=p.text, viewport=(0.0, 0.78, 0.13, 1.0),
        x_color="#D55E00", y_color="#009E73", z_color="#0072B2",
    )  # fmt: skip


def _best_angle(picture: SurfacePicture, along: FloatArray, across: FloatArray, up: FloatArray) -> FloatArray:
    """The angled view from the front left under which the block fills the picture best."""
    size = np.array([np.ptp(picture.x), np.ptp(picture.y), float(np.nanmax(picture.z)) - picture.bottom])
    aspect = picture.size[0] / picture.size[1]
    views = []
    for degrees in range(25, 70, 5):
        turn = np.radians(degrees)
        view = -np.cos(turn) * along - np.sin(turn) * across + 0.72 * up
        view /= np.linalg.norm(view)
        right = np.cross(up, view)
        right /= np.linalg.norm(right)
        upward = np.cross(view, right)
        need = max(float(np.abs(upward) @ size) / 0.84, float(np.abs(right) @ size) / aspect / 0.79)
        views.append((need, degrees, view))
    return min(views, key=lambda v: (round(v[0], 6), v[1]))[2]


def _font(picture: SurfacePicture, size: int) -> int:
    return max(9, round(size * picture.size[0] / 1150))


def _look(plotter: Any, picture: SurfacePicture) -> None:
    """Parallel projection, the block filling the left of the picture."""
    along = np.array([picture.direction[0], picture.direction[1], 0.0])
    across = np.array([-along[1], along[0], 0.0])
    up = np.array([0.0, 0.0, 1.0])
    view = {
        "iso": _best_angle(picture, along, across, up),
        "along": -1.0 * along + 0.32 * up - 0.0 * across,
        "top": up,
        "front": -across + 0.02 * up,
    }[picture.camera]
    view_up = across if picture.camera == "top" else up
    low = np.array([picture.x[0], picture.y[0], picture.bottom])
    high = np.array([picture.x[-1], picture.y[-1], float(np.nanmax(picture.z))])
    centre = 0.5 * (low + high)
    view = view / np.linalg.norm(view)
    distance = 4.0 * float(np.linalg.norm(high - low))
    plotter.camera_position = [centre + distance * view, centre, view_up]
    plotter.camera.parallel_projection = True
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
    right = np.cross(view_up, view)
    right /= np.linalg.norm(right)
    upward = np.cross(view, right)
    half_w = float(np.abs((corners - centre) @ right).max())
    half_h = float(np.abs((corners - centre) @ upward).max())
    aspect = picture.size[0] / picture.size[1]
    # 0.80 of the width is for the block, the rest for the colour bar; 0.86 of the height leaves room for words.
    scale = max(half_h / 0.84, half_w / aspect / 0.79)
    shift = 0.105 * scale * aspect * right
    if picture.captions:
        scale *= 1.07
        shift = shift - 0.07 * scale * upward  # the block moves up to make room for the words below it
    plotter.camera.parallel_scale = scale
    plotter.camera.focal_point = centre + shift
    plotter.camera.position = centre + shift + distance * view
    plotter.camera.clipping_range = (0.1 * distance, 3.0 * distance)
