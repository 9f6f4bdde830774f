"""Pictures of the surface and films, each kind drawn by the worker."""

from __future__ import annotations

import dataclasses
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


def test_a_wall_is_seen_in_its_own_colour(worker: RenderWorker, result: SimulationResult) -> None:
    """The slot's walls are 2 mm high; floor and rim are told to be right, so what is seen blue or orange are they."""
    x, y = np.linspace(-30.0, 30.0, 241), np.linspace(-20.0, 20.0, 161)
    floor = np.broadcast_to(np.abs(y) < 10.0, (len(x), len(y)))
    beside = np.broadcast_to(np.abs(np.abs(y) - 10.0) < 0.3, floor.shape)
    plain = dataclasses.replace(
        picture(result, scale=False, captions=()),
        x=x,
        y=y,
        z=np.where(floor, -6.0, 0.0),
        ideal=np.where(floor, -6.0, 0.0),
        error=np.where(floor, 0.0, np.nan),
        wall=None,
        station=None,
    )

    def seen(share: float | None) -> tuple[int, int]:
        """How many pixels are orange, and blue."""
        wall = None if share is None else np.where(beside, share * plain.limit, np.nan)
        red, _, blue = np.moveaxis(pixels(worker.render(dataclasses.replace(plain, wall=wall))), -1, 0)
        return int((red > blue + 40).sum()), int((blue > red + 60).sum())

    nothing, left, deep = seen(None), seen(0.7), seen(-0.7)
    assert left[0] > nothing[0] + 500
    assert left[1] == pytest.approx(nothing[1], abs=50)
    assert deep[1] > nothing[1] + 500
    assert deep[0] == pytest.approx(nothing[0], abs=50)
