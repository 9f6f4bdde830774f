"""A rendered picture as a value: everything that the drawing process needs, as plain arrays in mm."""

from dataclasses import dataclass
from typing import Literal

from robomill.arrays import FloatArray

CAMERAS = {"iso": "Angled", "along": "Along the cut", "top": "From above", "front": "From the front"}
Layout = Literal["one", "pair"]
Role = Literal["cutter", "shank", "spindle", "link", "joint"]


@dataclass(frozen=True, eq=False)
class Solid:
    """points (v, 3) mm in {W}, faces (f, 3); ``role`` picks its colour."""

    points: FloatArray
    faces: FloatArray
    role: Role
    opacity: float = 1.0


@dataclass(frozen=True, eq=False)
class SurfacePicture:
    """x (nx,), y (ny,) mm; z, ideal (nx, ny) mm heights, NaN where there is no material; error (nx, ny), in ``unit``.

    ``z`` is drawn (it may be exaggerated; then ``captions`` say by how much), ``error`` colours it between
    +-``limit``, and ``wall`` (nx, ny) the steep faces between its points, NaN beside none; ``camera`` is one of
    ``CAMERAS``. ``direction`` (2,) is the way of the cut at ``station`` (3,) mm, where a section plane is drawn or,
    with ``cutaway``, what lies before it is taken away. ``layout`` "pair" shows ideal and machined side by side under
    one camera; ``ghost`` lays the ideal over the machined; ``solids`` stand beside them (tool, arm), ``headroom`` mm
    above the block stays in the picture for them, with ``whole`` they are seen from end to end. Without ``scale`` the
    page says what the colours mean.
    """

    x: FloatArray
    y: FloatArray
    z: FloatArray
    ideal: FloatArray
    error: FloatArray
    limit: float
    bottom: float
    unit: str = "mm"
    camera: str = "iso"
    dark: bool = False
    size: tuple[int, int] = (1280, 720)
    direction: tuple[float, float] = (1.0, 0.0)
    station: tuple[float, float, float] | None = None
    ghost: bool = False
    captions: tuple[str, ...] = ()
    layout: Layout = "one"
    cutaway: bool = False
    solids: tuple[Solid, ...] = ()
    headroom: float = 0.0
    whole: bool = False
    scale: bool = True
    wall: FloatArray | None = None
