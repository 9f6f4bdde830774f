"""The cut as a film: pictures of the part as far as it is cut, drawn one by one, then written as GIF or MP4."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from robomill.arrays import IntArray
from robomill.errors import MissingExtraError
from robomill.extras import missing, needed
from robomill.simulation.enlarged import Enlarged, so_far, tip_drawn
from robomill.simulation.result import SimulationResult
from robomill.units import from_si
from robomill.viz.rendered import worker
from robomill.viz.rendered.picture import SurfacePicture
from robomill.viz.rendered.posed import posed

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
        error=now.error * (picture.limit / result.setup.tolerance),  # in the unit of its limit
        wall=now.wall * (picture.limit / result.setup.tolerance),
        solids=posed(result, index, tip_drawn(result, shown, index), arm=False),
        captions=(*picture.captions, f"Line {result.path.block[index]}"),
    )


def absent(kind: Kind) -> MissingExtraError | None:
    """Why no film of this kind can be made where an extra is not installed."""
    return worker.absent() or (missing("A film as MP4", "film", "imageio_ffmpeg") if kind == "mp4" else None)


def encode(pictures: Sequence[bytes], kind: Kind, frames_per_s: float) -> bytes:
    """Pictures (PNG) as the bytes of a GIF (looping) or an MP4; the last one is held for a second."""
    import io

    with needed("A film of the cut"):
        from PIL import Image
    frames = [Image.open(io.BytesIO(png)).convert("RGB") for png in pictures]
    return (_gif if kind == "gif" else _mp4)(frames, frames_per_s)


def _gif(frames: Sequence[Any], frames_per_s: float) -> bytes:
    import io

    stream = io.BytesIO()
    each = 1000.0 / frames_per_s
    durations = [*[each] * (len(frames) - 1), each + 1000.0]
    frames[0].save(stream, "GIF", save_all=True, append_images=frames[1:], duration=durations, loop=0)
    return stream.getvalue()


def _mp4(frames: Sequence[Any], frames_per_s: float) -> bytes:
    import tempfile
    from pathlib import Path

    with needed("A film as MP4"):
        import imageio_ffmpeg
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "cut.mp4"
        writer = imageio_ffmpeg.write_frames(str(target), frames[0].size, fps=frames_per_s, quality=8)
        writer.send(None)
        for frame in [*frames, *([frames[-1]] * max(1, round(frames_per_s)))]:
            writer.send(frame.tobytes())
        writer.close()
        return target.read_bytes()
