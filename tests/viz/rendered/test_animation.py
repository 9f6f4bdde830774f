"""Films written as GIF and as MP4."""

from __future__ import annotations

import io

import numpy as np

from robomill.viz.rendered.animation import encode


def test_a_film_is_written_as_gif_and_as_mp4() -> None:
    from PIL import Image

    frames = []
    for k in range(4):
        stream = io.BytesIO()
        Image.fromarray(np.full((96, 160, 3), 40 * k, dtype=np.uint8)).save(stream, "PNG")
        frames.append(stream.getvalue())
    gif = encode(frames, "gif", 4.0)
    opened = Image.open(io.BytesIO(gif))
    assert opened.n_frames >= 4
    assert opened.size == (160, 96)
    mp4 = encode(frames, "mp4", 4.0)
    assert mp4[4:8] == b"ftyp"
