"""The cut as a film: frames are drawn one by one by the drawing process, which then writes GIF or MP4.

``FilmStart``, ``FilmFrame`` and ``FilmEnd`` are sent to the worker in this order; each answers with bytes (empty for
the first two), so that the sender can count, show progress and stop between any two frames.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.simulation.enlarged import Enlarged, so_far, tip_drawn
from robomill.simulation.result import SimulationResult
from robomill.units import from_si
from robomill.viz.picture import Solid, SurfacePicture
from robomill.viz.posed import posed

Kind = Literal["gif", "mp4"]
MIME = {"gif": "image/gif", "mp4": "video/mp4"}
FRAMES = (12, 120)
_films: dict[str, tuple[SurfacePicture, list[Any]]] = {}


@dataclass(frozen=True, eq=False)
class FilmStart:
    """Opens film ``key``; ``picture`` is what does not change from frame to frame."""

    key: str
    picture: SurfacePicture

    def draw(self) -> bytes:
        """In the worker: forget other films, so that a film that was given up does not stay."""
        _films.clear()
        _films[self.key] = (self.picture, [])
        return b""


@dataclass(frozen=True, eq=False)
class FilmFrame:
    """One frame: heights (nx, ny) mm and errors so far, the tool."""

    key: str
    z: FloatArray
    error_um: FloatArray
    solids: tuple[Solid, ...]
    caption: str

    def draw(self) -> bytes:
        """In the worker."""
        from robomill.viz.scene import image

        picture, frames = _films[self.key]
        frames.append(
            image(
                replace(
                    picture,
                    z=self.z,
                    error_um=self.error_um,
                    solids=self.solids,
                    captions=(*picture.captions, self.caption),
                )
            )
        )
        return b""


@dataclass(frozen=True)
class FilmEnd:
    """Writes film ``key`` and closes it; answers with the file's bytes."""

    key: str
    kind: Kind
    frames_per_s: float

    def draw(self) -> bytes:
        """In the worker."""
        _, frames = _films.pop(self.key)
        return encode(frames, self.kind, self.frames_per_s)


def encode(frames: list[Any], kind: Kind, frames_per_s: float) -> bytes:
    """Frames (h, w, 3) uint8 as the bytes of a GIF (looping) or an MP4; the last one is held for a second."""
    import tempfile
    from pathlib import Path

    import imageio.v2 as imageio

    held = [*frames, *([frames[-1]] * max(1, round(frames_per_s)))]
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / f"cut.{kind}"
        if kind == "gif":
            imageio.mimwrite(target, held, format="GIF", duration=1000.0 / frames_per_s, loop=0)  # type: ignore[arg-type]
        else:
            imageio.mimwrite(target, held, format="FFMPEG", fps=frames_per_s, quality=8, macro_block_size=16)  # type: ignore[arg-type]
        return target.read_bytes()


def film_samples(result: SimulationResult, frames: int) -> IntArray:
    """Samples (frames,) at which the film shows the cut, evenly along the length cut, the last one at its end."""
    cutting = np.flatnonzero(result.removes)
    stations = np.linspace(0.0, float(result.path.s[-1]), frames + 1)[1:]
    place = np.searchsorted(result.path.s[cutting], stations - 1e-12)
    return cutting[np.minimum(place, len(cutting) - 1)]


def film_frame(result: SimulationResult, shown: Enlarged, key: str, index: int, solids: bool = True) -> FilmFrame:
    """The part as cut up to sample ``index``, the displacement enlarged as in ``shown``."""
    now = so_far(result, shown, index)
    tip = tip_drawn(result, shown, index)
    return FilmFrame(
        key,
        from_si(now.drawn.z, "mm"),
        from_si(now.error, "um"),
        posed(result, index, tip, arm=False) if solids else (),
        f"Line {result.path.block[index]}",
    )
