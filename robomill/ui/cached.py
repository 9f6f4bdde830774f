"""Results and pictures kept by fingerprint: computed once for everyone on the server, and bounded in number."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import streamlit as st

from robomill.errors import RenderError
from robomill.kinematics.spin import OverSpin
from robomill.simulation.enlarged import Enlarged, enlarged
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import deviation_over_spin, simulate
from robomill.simulation.samples import sampled
from robomill.simulation.setup import SimulationSetup
from robomill.surface.groove import GrooveSection
from robomill.ui import session
from robomill.viz.picture import SurfacePicture
from robomill.viz.worker import RenderWorker

if TYPE_CHECKING:
    import plotly.graph_objects as go

SPIN_SAMPLES = 400


def result(setup: SimulationSetup) -> SimulationResult:
    """``simulate(setup)``, from the cache where it was computed before. Raises the refusal of ``simulate``."""
    return _result(setup.digest(), setup)


@st.cache_resource(max_entries=24, show_spinner=False)
def _result(digest: str, _setup: SimulationSetup) -> SimulationResult:
    found = simulate(_setup)
    _ = found.verdict  # so that what cannot be judged is refused here, where a page expects it
    return found


def over_spin(setup: SimulationSetup) -> OverSpin:
    """What the free spin about the tool does to the largest deviation, at ``SPIN_SAMPLES`` points of the path."""
    return _over_spin(setup.digest(), setup)


@st.cache_resource(max_entries=16, show_spinner=False)
def _over_spin(digest: str, _setup: SimulationSetup) -> OverSpin:
    path = _setup.toolpath
    return deviation_over_spin(_setup, sampled(path, max(_setup.step, float(path.s[-1]) / SPIN_SAMPLES)))


def groove(setup: SimulationSetup, station: float) -> GrooveSection:
    """The groove's section at ``station`` (m of length cut)."""
    return result(setup).groove(station)


def pictured(setup: SimulationSetup, times: float) -> Enlarged:
    """The surfaces for pictures with the displacement ``times`` times enlarged, from the cache."""
    return _pictured((setup.digest(), times), result(setup))


@st.cache_resource(max_entries=16, show_spinner=False)
def _pictured(key: tuple[str, float], _result: SimulationResult) -> Enlarged:
    return enlarged(_result, key[1])


def kept_figure(name: str, key: Sequence[Any], make: Callable[[], go.Figure]) -> go.Figure:
    """The figure of ``make``, built once for equal ``key`` (digests, view, theme); do not change it afterwards.

    Building a figure costs more than computing what it shows; a classroom sees the same ones.
    """
    return _kept_figure(name, tuple(key), make)


@st.cache_resource(max_entries=96, show_spinner=False)
def _kept_figure(name: str, key: tuple[Any, ...], _make: Callable[[], go.Figure]) -> go.Figure:
    return _make()


@st.cache_resource(show_spinner=False)
def worker() -> RenderWorker:
    """The drawing process of this server, on its way up."""
    made = RenderWorker()
    made.start()
    return made


@st.cache_resource(max_entries=64, show_spinner=False)
def _png(key: tuple[object, ...], _picture: SurfacePicture) -> bytes:
    return worker().render(_picture)


def picture(key: tuple[object, ...], scene: SurfacePicture) -> bytes | None:
    """PNG bytes of ``scene``; ``key`` is what it depends on (digests and view). None where nothing can be drawn.

    The reason is said once a session, with the command that mends it.
    """
    if worker().down and session.kept("picture.said"):
        return None
    try:
        return _png((*key, scene.dark, scene.camera, scene.size), scene)
    except RenderError as exc:
        if not session.kept("picture.said"):
            session.keep("picture.said", worker().down)
            st.info(str(exc), icon=":material/info:")
        return None
