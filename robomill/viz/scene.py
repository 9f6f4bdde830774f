"""The rendered machined surface: a solid block cut from a height map, coloured by its signed error.

``SurfacePicture`` is everything a picture needs, as plain arrays in mm; ``draw`` turns it into PNG bytes and is called
in the worker process only (``worker.py``). The pieces are in ``stage``, the camera in ``camera``.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from robomill.arrays import FloatArray
from robomill.viz import camera as cameras
from robomill.viz import stage
from robomill.viz.posed import Solid
from robomill.viz.theme import diverging, palette

Camera = Literal["iso", "top", "front", "along"]
CAMERAS: dict[str, str] = {"iso": "Angled", "along": "Along the cut", "top": "From above", "front": "From the front"}
Layout = Literal["one", "pair"]
# Share of a picture's width that the colour bar takes.
ROOM, ROOM_PAIR = 0.21, 0.30


@dataclass(frozen=True, eq=False)
class SurfacePicture:
    """x (nx,), y (ny,) mm; z, ideal (nx, ny) mm heights, NaN where there is no material; error_um (nx, ny).

    ``z`` is drawn (it may be exaggerated; then ``captions`` say by how much), ``error_um`` colours it between
    +-``limit_um``. ``direction`` (2,) is the way of the cut at ``station`` (3,) mm, where a section plane is drawn or,
    with ``cutaway``, what lies before it is taken away. ``layout`` "pair" shows ideal and machined side by side under
    one camera; ``ghost`` lays the ideal over the machined; ``solids`` stand beside them (tool, arm), ``headroom`` mm
    above the block stays in the picture for them, with ``whole`` they are seen from end to end.
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
    layout: Layout = "one"
    cutaway: bool = False
    solids: tuple[Solid, ...] = ()
    headroom: float = 0.0
    whole: bool = False


def load() -> None:
    """Import the graphics library ahead of the first picture."""
    import matplotlib.colors  # noqa: F401
    import pyvista  # noqa: F401


def draw(picture: Any) -> bytes:
    """PNG bytes of a SurfacePicture; anything else draws itself. Without a working OpenGL library the process ends."""
    import io

    from PIL import Image

    if not isinstance(picture, SurfacePicture):
        return bytes(picture.draw())
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
        cameras.look(plotter, picture, aspect=aspect, room=ROOM_PAIR, beside=False)
        plotter.subplot(0, 1)
    _fill(plotter, picture, colours, ideal=False)
    stage.colour_bar(plotter, picture, colours, 0.74 if pair else 0.835)
    stage.words(plotter, replace(picture, captions=()) if pair else picture, "Machined" if pair else "")
    cameras.look(plotter, picture, aspect=aspect, room=ROOM_PAIR if pair else ROOM)
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
        stage.block(plotter, picture, picture.z, picture.error_um, colours)
    stage.ideal_lines(plotter, picture)
    if picture.ghost:
        stage.ghost(plotter, picture)
    if picture.station is not None and not picture.cutaway:
        stage.section_plane(plotter, picture)
    stage.solids(plotter, picture)
