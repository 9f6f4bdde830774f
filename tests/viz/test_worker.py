"""The drawing process: pictures come back, a crash or a hang is survived, and a machine without GL says so."""

from __future__ import annotations

import io
import sys

import numpy as np
import pytest

from robomill.errors import RenderError
from robomill.viz.picture import SurfacePicture
from robomill.viz.worker import RenderWorker

ECHO = """
import os, pickle, struct, sys, time
out = os.fdopen(os.dup(1), "wb"); os.dup2(2, 1)
while header := sys.stdin.buffer.read(8):
    wish = pickle.loads(sys.stdin.buffer.read(struct.unpack("<Q", header)[0]))
    if wish == "die": os.abort()
    if wish == "hang": time.sleep(60)
    answer = pickle.dumps(("error", "no such thing") if wish == "refuse" else ("png", ("got " + wish).encode()))
    out.write(struct.pack("<Q", len(answer)) + answer); out.flush()
"""


def fake(timeout_s: float = 20.0) -> RenderWorker:
    return RenderWorker(timeout_s, (sys.executable, "-c", ECHO))


def test_messages_of_any_size_come_back() -> None:
    worker = fake()
    for wish in ("a", "b" * 3_000_000, "c"):
        assert worker.render(wish) == ("got " + wish).encode()
    worker.close()


def test_a_drawing_error_is_a_sentence_and_the_process_lives_on() -> None:
    worker = fake()
    with pytest.raises(RenderError, match="no such thing"):
        worker.render("refuse")
    assert worker.render("again") == b"got again"
    worker.close()


def test_a_crash_twice_in_a_row_names_the_command_that_mends_it() -> None:
    worker = fake()
    assert worker.render("before") == b"got before"
    with pytest.raises(RenderError, match="apt-get install -y libegl1 libgl1-mesa-dri"):
        worker.render("die")
    assert worker.down
    with pytest.raises(RenderError, match="apt-get"):
        worker.render("fine")
    worker.close()


def test_a_hang_is_ended_and_the_next_picture_comes() -> None:
    worker = fake(timeout_s=1.5)
    with pytest.raises(RenderError, match="longer than 1.5 s"):
        worker.render("hang")
    assert worker.render("next") == b"got next"
    worker.close()


def groove(dark: bool, camera: str) -> SurfacePicture:
    x, y = np.linspace(-30, 30, 121), np.linspace(-10, 10, 81)
    X, Y = np.meshgrid(x, y, indexing="ij")
    ideal = np.where((np.abs(Y) < 4) & (np.abs(X) < 20), -2.0, 0.0)
    z = np.where((np.abs(Y - 1) < 4) & (np.abs(X) < 20), -2.1, 0.0)
    error = np.where((z < 0) | (ideal < 0), 1e3 * (z - ideal), np.nan)
    return SurfacePicture(
        x=x,
        y=y,
        z=z,
        ideal=ideal,
        error_um=error,
        limit_um=300.0,
        bottom=-8.0,
        camera=camera,
        dark=dark,  # type: ignore[arg-type]
        size=(480, 320),
        station=(0.0, 0.0, -2.0),
        captions=("Displacement shown x 10",),
    )


@pytest.fixture(scope="module")
def worker() -> RenderWorker:
    made = RenderWorker()
    try:
        made.render(groove(False, "iso"))
    except RenderError as exc:
        if made.down:
            pytest.skip(str(exc))
        raise
    return made


@pytest.mark.parametrize(("dark", "camera"), [(False, "iso"), (True, "along"), (False, "top"), (True, "front")])
def test_the_surface_is_drawn_in_its_colours(worker: RenderWorker, dark: bool, camera: str) -> None:
    from PIL import Image

    image = np.asarray(Image.open(io.BytesIO(worker.render(groove(dark, camera)))).convert("RGB")).astype(int)
    assert image.shape == (320, 480, 3)
    corner = image[2, 2]
    assert (corner < 60).all() if dark else (corner > 240).all()
    part = image[:, : int(0.8 * 480)]
    red, blue = part[..., 0], part[..., 2]
    if camera != "front":  # the front hides the groove
        assert ((red - blue) > 80).sum() > 100, "material left is orange"
        assert ((blue - red) > 60).sum() > 100, "cut too deep is blue"
    assert (np.abs(part - corner).max(axis=-1) > 25).mean() > 0.1, "the block fills the picture"
