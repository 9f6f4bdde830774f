"""The milling page's figures and pictures: axes with units, true errors in enlarged pictures, tool and film frames."""

from __future__ import annotations

import io
import json
from typing import Any

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.errors import RenderError
from robomill.io.projects import load_setup
from robomill.io.samples import samples_dir
from robomill.simulation.enlarged import enlarged
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import simulate
from robomill.simulation.spread import peak_force
from robomill.simulation.stations import nearest_feed
from robomill.toolpath.source import GCodeSource
from robomill.units import from_si
from robomill.viz.along import MAX_PICKS, add_picks
from robomill.viz.animation import FilmEnd, FilmStart, encode, film_frame, film_samples
from robomill.viz.dial import Dial, dial_figure
from robomill.viz.engagement import ArcCurves, ForceCurves, engagement_figure, force_figure
from robomill.viz.evidence import Claim, evidence_figure
from robomill.viz.metrology import ProfileCurves, histogram_figure, profile_figure
from robomill.viz.posed import posed, tool_solids
from robomill.viz.theme import figure
from robomill.viz.views import surface_picture
from robomill.viz.worker import RenderWorker


@pytest.fixture(scope="module")
def result() -> SimulationResult:
    """The paper's slot from process data."""
    return simulate(load_setup(samples_dir() / "paper_flute" / "setup_process.toml"))


CLAIMS = (Claim("a", "paper", 0.23), Claim("b", "computed", 0.28, 0.2, 0.4))


def every(result: SimulationResult, dark: bool) -> dict[str, Any]:
    """One figure of each kind."""
    s = from_si(result.path.s, "mm")
    peak = peak_force(result)
    assert peak is not None
    c = result.conditions
    curves = ForceCurves(s, result.force_components, "mm", peak=(peak.low, peak.high))
    q = np.linspace(0.0, 100.0, 21)
    profile = ProfileCurves(
        q,
        0.2 + 0 * q,
        -0.1 + 0 * q,
        "mm",
        0.3,
        band=np.stack([0.1 + 0 * q, 0.3 + 0 * q]),
        fit=0.2 + 0 * q,
        measured=(q, 0.29 + 0 * q),
    )
    arc = [from_si(v, "deg") for v in (c.phi_st, c.phi_ex)]
    return {
        "force": force_figure(curves, dark=dark, station=50.0),
        "engagement": engagement_figure(ArcCurves(s, *arc, from_si(c.a_p, "mm"), "mm"), dark=dark),
        "profile": profile_figure(profile, dark=dark, station=50.0),
        "histogram": histogram_figure(np.linspace(-300, 300, 11), np.full(10, 10.0), 300.0, "µm", dark=dark),
        "evidence": evidence_figure(CLAIMS, "mm", dark=dark),
    }


@pytest.mark.parametrize("dark", [False, True])
def test_axes_have_units_and_views_are_kept(result: SimulationResult, dark: bool) -> None:
    for name, made in every(result, dark).items():
        layout = json.loads(made.to_json())["layout"]
        assert layout["uirevision"], name
        titles = [layout[a].get("title", {}).get("text", "") for a in ("xaxis", "yaxis")]
        assert any(f", {unit}" in titles[0] for unit in ("mm", "µm")), (name, titles)


def dial(**changes: Any) -> dict[str, Any]:
    """The dial of a full slot as JSON."""
    values: dict[str, Any] = {
        "phi_st": 0.0,
        "phi_ex": 180.0,
        "depth": 2.0,
        "unit": "mm",
        "force": np.array([-63.5, 110.4, -23.3]),
        "scale": 100.0,
        **changes,
    }
    return dict(json.loads(dial_figure(Dial(**values), dark=False).to_json())["layout"])


def test_the_dial_has_the_feed_up_and_its_left_on_the_left() -> None:
    arrow = next(a for a in dial()["annotations"] if a.get("arrowwidth") == 3.4)
    assert arrow["x"] == pytest.approx(-1.104), "feed-normal is the left of the feed"
    assert arrow["y"] == pytest.approx(-0.635), "the feed force holds the tool back"
    texts = [a.get("text", "") for a in dial()["annotations"]]
    assert "180°" in texts
    assert "127 N across, 23 N into the part" in texts
    assert "in air" in [a.get("text") for a in dial(force=np.zeros(3), engaged=False)["annotations"]]


def test_what_can_be_clicked_is_thinned_and_finite() -> None:
    fig = figure(dark=False, height=200)
    s = np.arange(5000.0)
    add_picks(fig, s, np.where(s > 100, 1.0, np.nan), [str(v) for v in s])
    assert len(fig.data[0].x) == MAX_PICKS
    assert fig.data[0].x.min() > 100
    assert fig.layout.clickmode == "event+select"


@pytest.mark.parametrize(
    "cutter",
    [
        Cutter("flat", 0.008),
        Cutter("ball", 0.008),
        Cutter("bull", 0.008, corner_radius=0.001),
        Cutter("chamfer", 0.008, tip_angle=np.pi / 2),
    ],
)
def test_the_drawn_tool_is_closed_and_stands_on_its_tip(cutter: Cutter) -> None:
    trimesh = pytest.importorskip("trimesh")
    tip, k = np.array([0.01, 0.02, -0.002]), np.array([0.0, np.sin(0.3), np.cos(0.3)])
    for solid in tool_solids(cutter, tip, k, 0.09):
        mesh = trimesh.Trimesh(solid.points, solid.faces.astype(int))
        mesh.merge_vertices()
        mesh.update_faces(mesh.nondegenerate_faces())
        height = (np.asarray(solid.points) * 1e-3 - tip) @ k
        assert height.min() >= -1e-9
        if solid.role == "cutter":
            assert height.min() == pytest.approx(0.0, abs=1e-9)
            across = np.linalg.norm((np.asarray(solid.points) * 1e-3 - tip) - height[:, None] * k, axis=1)
            assert across.max() == pytest.approx(cutter.radius)
            assert (across <= cutter.radius_at(np.maximum(height, 0.0)) + 1e-9).all()
        assert mesh.is_watertight


def test_a_film_is_written_as_gif_and_as_mp4() -> None:
    from PIL import Image

    frames = [np.full((96, 160, 3), 40 * k, dtype=np.uint8) for k in range(4)]
    gif = encode(frames, "gif", 4.0)
    opened = Image.open(io.BytesIO(gif))
    assert opened.n_frames >= 4
    assert opened.size == (160, 96)
    mp4 = encode(frames, "mp4", 4.0)
    assert mp4[4:8] == b"ftyp"


@pytest.fixture(scope="module")
def worker() -> Any:
    made = RenderWorker()
    try:
        made.render(picture(simulate(load_setup(samples_dir() / "paper_flute" / "setup.toml"))))
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


def test_every_kind_of_picture_is_drawn(worker: RenderWorker, result: SimulationResult) -> None:
    i = nearest_feed(result, 0.05)
    plain = pixels(worker.render(picture(result)))
    tool = posed(result, i, result.path.p[i], arm=False)
    for name, changes in {
        "pair": {"layout": "pair"},
        "cutaway": {"cutaway": True},
        "ghost": {"ghost": True},
        "tool": {"solids": tool},
        "arm": {"solids": posed(result, i, result.path.p[i], arm=True), "whole": True},
    }.items():
        shot = pixels(worker.render(picture(result, **changes)))
        assert shot.shape == plain.shape, name
        assert (np.abs(shot - plain).max(axis=-1) > 20).mean() > 0.005, f"{name} changes the picture"
        assert len(np.unique(shot.reshape(-1, 3), axis=0)) > 200, name


def test_a_film_of_an_arc_in_the_worker(worker: RenderWorker, result: SimulationResult) -> None:
    text = "G21 G90 G17\nS12000 M3\nG0 X-12 Y0 Z5\nG1 Z-2 F600\nG2 X12 Y0 I12 J0 F1800\nG0 Z5\nM2\n"
    arc = simulate(result.setup.replace(source=GCodeSource(text), step=2e-3))
    shown = enlarged(arc, 10.0)
    worker.render(FilmStart("arc", picture(arc, size=(320, 192), headroom=30.0)))
    samples = film_samples(arc, 4)
    for index in samples:
        assert worker.render(film_frame(arc, shown, "arc", int(index))) == b""
    gif = worker.render(FilmEnd("arc", "gif", 4.0))
    from PIL import Image

    opened = Image.open(io.BytesIO(gif))
    assert opened.size == (320, 192)
    opened.seek(0)
    first = np.asarray(opened.convert("RGB")).astype(int)
    opened.seek(opened.n_frames - 1)
    assert (np.abs(np.asarray(opened.convert("RGB")).astype(int) - first).max(axis=-1) > 20).mean() > 0.02
