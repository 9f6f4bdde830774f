"""The cut as a film: pictures of the part as far as it is cut, drawn one by one, then written as GIF or MP4."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from robomill.arrays import IntArray
from robomill.simulation.enlarged import Enlarged, so_far, tip_drawn
from robomill.simulation.result import SimulationResult
from robomill.units import from_si
from robomill.viz.picture import SurfacePicture
from robomill.viz.posed import posed

Kind = Literal["gif", "mp4"]
FRAMES = (12, 120)


def film_samples(result: SimulationResult, frames: int) -> IntArray:
    """Samples (frames,) at which the film shows the cut, evenly along the length cut, the last one at its end."""
    cutting = np.flatnonzero(result.removes)
    stations = np.linspace(0.0, float(result.path.s[-1]), frames + 1)[1:]
    place = np.searchsorted(result.path.s[cutting], stations - 1e-12)
    return cutting[np.minimum(place, len(cutting) - 1)]


def film_frame(result: SimulationResult, shown: Enlarged, picture: SurfacePicture, index: int) -> SurfacePicture:
    """``picture`` with the part as cut up to sample ``index`` and its tool, displaced as in ``shown``."""
    now = so_far(result, shown, index)
    return replace(
        picture,
        z=from_si(now.drawn.z, "mm"),
        error=from_si(now.error, "um"),
        solids=posed(result, index, tip_drawn(result, shown, index), arm=False),
        captions=(*picture.captions, f"Line {result.path.block[index]}"),
    )


def encode(pictures: Sequence[bytes], kind: Kind, frames_per_s: float) -> bytes:
    """Pictures (PNG) as the bytes of a GIF (looping) or an MP4; the last one is held for a second."""
    import tempfile
    from pathlib import Path

    import imageio.v2 as imageio

    frames = [imageio.imread(png, format="PNG") for png in pictures]  # type: ignore[arg-type]
    held = [*frames, *([frames[-1]] * max(1, round(frames_per_s)))]
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / f"cut.{kind}"
        if kind == "gif":
            imageio.mimwrite(target, held, format="GIF", duration=1000.0 / frames_per_s, loop=0)  # type: ignore[arg-type]
        else:
            imageio.mimwrite(target, held, format="FFMPEG", fps=frames_per_s, quality=8, macro_block_size=16)  # type: ignore[arg-type]
        return target.read_bytes()
