"""Pictures of the surface and films, each kind drawn by the worker."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest

from robomill.errors import RenderError
from robomill.simulation.enlarged import enlarged
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import simulate
from robomill.simulation.stations import nearest_feed
from robomill.toolpath.source import GCodeSource
from robomill.viz.rendered.animation import encode, film_frame, film_samples
from robomill.viz.rendered.posed import posed
from robomill.viz.rendered.worker import RenderWorker
from robomill.viz.views import surface_picture


@pytest.fixture(scope="module")
def worker(result: SimulationResult) -> Any:
    made = RenderWorker()
    try:
        made.render(picture(result))
    except RenderError as exc:
        if made.down:
            pytest.skip(str(exc))
        raise
    yield made
    made.close()


def picture(result: SimulationResult, **changes: Any) -> Any:
    """A small picture of the slot at mid-cut."""
    values: dict[str, Any] = {"camera": "iso", "dark": False, "station": 0.05, "size": (480, 320), **changes}
    return surface_picture(result, enlarged(result, 10.0), **values)


def pixels(data: bytes) -> Any:
    """PNG bytes as numbers."""
    from PIL import Image

    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB")).astype(int)


def test_every_kind_of_picture_is_drawn(worker: RenderWorker, process_result: SimulationResult) -> None:
    i = nearest_feed(process_result, 0.05)
    plain = pixels(worker.render(picture(process_result)))
    tool = posed(process_result, i, process_result.path.p[i], arm=False)
    for name, changes in {
        "pair": {"layout": "pair"},
        "cutaway": {"cutaway": True},
        "ghost": {"ghost": True},
        "tool": {"solids": tool},
        "arm": {"solids": posed(process_result, i, process_result.path.p[i], arm=True), "whole": True},
    }.items():
        shot = pixels(worker.render(picture(process_result, **changes)))
        assert shot.shape == plain.shape, name
        assert (np.abs(shot - plain).max(axis=-1) > 20).mean() > 0.005, f"{name} changes the picture"
        assert len(np.unique(shot.reshape(-1, 3), axis=0)) > 200, name


def test_a_film_of_an_arc_in_the_worker(worker: RenderWorker, process_result: SimulationResult) -> None:
    text = "G21 G90 G17\nS12000 M3\nG0 X-12 Y0 Z5\nG1 Z-2 F600\nG2 X12 Y0 I12 J0 F1800\nG0 Z5\nM2\n"
    arc = simulate(process_result.setup.replace(source=GCodeSource(text), step=2e-3))
    shown = enlarged(arc, 10.0)
    still = picture(arc, size=(320, 192), headroom=30.0)
    frames = [worker.render(film_frame(arc, shown, still, int(index))) for index in film_samples(arc, 4)]
    gif = encode(frames, "gif", 4.0)
    from PIL import Image

    opened = Image.open(io.BytesIO(gif))
    assert opened.size == (320, 192)
    opened.seek(0)
    first = np.asarray(opened.convert("RGB")).astype(int)
    opened.seek(opened.n_frames - 1)
    assert (np.abs(np.asarray(opened.convert("RGB")).astype(int) - first).max(axis=-1) > 20).mean() > 0.02
