"""The rendered machined surface: a solid block cut from a height map, coloured by its signed error.

``draw`` turns a picture into PNG bytes and is called in the worker process only (``worker.py``). The camera stands by
presets in parallel projection, fitted to the block and to what stands on it; the pieces are in ``stage``.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.viz.rendered import stage
from robomill.viz.rendered.picture import SurfacePicture
from robomill.viz.theme import diverging, palette

# Share of the picture's height that the block may fill: the rest is for words.
HIGH = 0.84
UP = np.array([0.0, 0.0, 1.0])
# Share of a picture's width that the colour bar takes.
ROOM, ROOM_PAIR = 0.21, 0.30


def load() -> None:
    """Import the graphics library ahead of the first picture."""
    import matplotlib.colors  # noqa: F401
    import pyvista  # noqa: F401


def first() -> None:
    """Draw something small: without a working OpenGL library the process ends here."""
    import pyvista as pv

    plotter = pv.Plotter(off_screen=True, window_size=[16, 16])
    plotter.add_mesh(pv.Box())
    plotter.screenshot(return_img=True)
    plotter.close()


def draw(picture: SurfacePicture) -> bytes:
    """PNG bytes of a picture."""
    import io

    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(image(picture)).save(stream, "PNG", compress_level=3)
    return stream.getvalue()


def image(picture: SurfacePicture) -> Any:
    """The picture as (h, w, 3) uint8."""
    import pyvista as pv
    from matplotlib.colors import LinearSegmentedColormap

    pair = picture.layout == "pair"
    plotter = pv.Plotter(
        off_screen=True, window_size=list(picture.size), lighting="none", shape=(1, 2) if pair else (1, 1), border=False
    )
    colours = LinearSegmentedColormap.from_list("signed", [(v, c) for v, c in diverging(False)])
    aspect = picture.size[0] / picture.size[1] / (2 if pair else 1)
    if pair:
        plotter.subplot(0, 0)
        _fill(plotter, replace(picture, solids=(), ghost=False), colours, ideal=True)
        stage.words(plotter, picture, "Ideal")
        look(plotter, picture, aspect=aspect, room=ROOM_PAIR, beside=False)
        plotter.subplot(0, 1)
    _fill(plotter, picture, colours, ideal=False)
    if picture.scale:
        stage.colour_bar(plotter, picture, colours, 0.74 if pair else 0.835)
    stage.words(plotter, replace(picture, captions=()) if pair else picture, "Machined" if pair else "")
    look(plotter, picture, aspect=aspect, room=ROOM_PAIR if pair else ROOM if picture.scale else 0.0)
    plotter.enable_anti_aliasing("ssaa")
    shot = np.asarray(plotter.screenshot(return_img=True))
    plotter.close()
    return shot[..., :3]


def _fill(plotter: Any, picture: SurfacePicture, colours: Any, *, ideal: bool) -> None:
    """Background, lights, the block and what stands about it, in the plotter's current renderer."""
    plotter.set_background(palette(picture.dark).background)
    stage.lights(plotter)
    if ideal:
        stage.block(plotter, picture, picture.ideal, None, colours)
    else:
        stage.block(plotter, picture, picture.z, picture.error, colours)
    stage.ideal_lines(plotter, picture)
    if picture.ghost:
        stage.ghost(plotter, picture)
    if picture.station is not None and not picture.cutaway:
        stage.section_plane(plotter, picture)
    stage.solids(plotter, picture)


def look(plotter: Any, picture: SurfacePicture, *, aspect: float, room: float, beside: bool = True) -> None:
    """Point the camera of the plotter's current renderer, whose width is ``aspect`` times its height.

    ``room`` is the share of the width kept free, for a colour bar; with ``beside`` it lies on the right.
    """
    along = np.array([picture.direction[0], picture.direction[1], 0.0])
    across = np.array([-along[1], along[0], 0.0])
    low, high = bounds(picture)
    wide = 1.0 - room
    view = {
        "iso": best_angle(high - low, along, across, aspect, wide),
        "along": -1.0 * along + 0.32 * UP,
        "top": UP,
        "front": -across + 0.02 * UP,
    }[picture.camera]
    view_up = across if picture.camera == "top" else UP
    centre = 0.5 * (low + high)
    view = view / np.linalg.norm(view)
    distance = 4.0 * float(np.linalg.norm(high - low))
    right = np.cross(view_up, view)
    right /= np.linalg.norm(right)
    upward = np.cross(view, right)
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
    half_w = float(np.abs((corners - centre) @ right).max())
    half_h = float(np.abs((corners - centre) @ upward).max())
    scale = max(half_h / HIGH, half_w / aspect / wide)
    shift = (0.5 * room * scale * aspect if beside else 0.0) * right
    if picture.captions:
        scale *= 1.07
        shift = shift - 0.07 * scale * upward  # the block moves up to make room for the words below it
    plotter.camera_position = [centre + shift + distance * view, centre + shift, view_up]
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = scale
    plotter.camera.clipping_range = (0.05 * distance, 6.0 * distance)


def bounds(picture: SurfacePicture) -> tuple[FloatArray, FloatArray]:
    """Corners (3,), (3,) mm of what must be seen: the block with ``headroom`` above it, or ``whole`` all solids too."""
    low = np.array([picture.x[0], picture.y[0], picture.bottom])
    high = np.array([picture.x[-1], picture.y[-1], float(np.nanmax(picture.z)) + picture.headroom])
    if picture.cutaway and picture.station is not None:
        for i, along in enumerate(picture.direction):  # what is taken away needs no room
            if abs(along) > 0.99:
                (low if along > 0 else high)[i] = picture.station[i]
    if picture.whole:
        every = np.concatenate([np.asarray(solid.points) for solid in picture.solids])
        low, high = np.minimum(low, every.min(axis=0)), np.maximum(high, every.max(axis=0))
    return low, high


def best_angle(size: FloatArray, along: FloatArray, across: FloatArray, aspect: float, wide: float) -> FloatArray:
    """The angled view from the front left under which a block of ``size`` (3,) fills the picture best."""
    views = []
    for degrees in range(25, 70, 5):
        turn = np.radians(degrees)
        view = -np.cos(turn) * along - np.sin(turn) * across + 0.72 * UP
        view /= np.linalg.norm(view)
        right = np.cross(UP, view)
        right /= np.linalg.norm(right)
        upward = np.cross(view, right)
        need = max(float(np.abs(upward) @ size) / HIGH, float(np.abs(right) @ size) / aspect / wide)
        views.append((need, degrees, view))
    return min(views, key=lambda v: (round(v[0], 6), v[1]))[2]
