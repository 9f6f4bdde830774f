"""Results and pictures kept by fingerprint: computed once for everyone on the server, and bounded in number."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import wraps
from typing import TYPE_CHECKING, Any, TypeVar, cast

import streamlit as st

from robomill.arrays import digest
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
Function = TypeVar("Function", bound=Callable[..., Any])


def shared(entries: int, key: Callable[..., Any], spinner: str | bool = False) -> Callable[[Function], Function]:
    """Keeps the last answers of a function for everyone on the server, by the fingerprint of ``key(*arguments)``.

    ``spinner`` are the words while one is made; a refusal is not kept.
    """

    def keep(function: Function) -> Function:
        def made(fingerprint: str, _arguments: Any) -> Any:
            return function(*_arguments)

        # Streamlit knows a cache by the name of its function.
        made.__module__, made.__qualname__ = function.__module__, function.__qualname__
        held = st.cache_resource(max_entries=entries, show_spinner=spinner)(made)

        @wraps(function)
        def asked(*arguments: Any) -> Any:
            return held(digest(key(*arguments)), arguments)

        return cast("Function", asked)

    return keep


def by_setup(setup: SimulationSetup) -> str:
    """The fingerprint of a set-up."""
    return setup.digest()


def by_result(result: SimulationResult) -> str:
    """The fingerprint of the set-up that was run."""
    return result.setup.digest()


@shared(24, by_setup)
def result(setup: SimulationSetup) -> SimulationResult:
    """``simulate(setup)``, from the cache where it was computed before. Raises the refusal of ``simulate``."""
    found = simulate(setup)
    _ = found.verdict  # so that what cannot be judged is refused here, where a page expects it
    return found


@shared(16, by_setup)
def over_spin(setup: SimulationSetup) -> OverSpin:
    """What the free spin about the tool does to the largest deviation, at ``SPIN_SAMPLES`` points of the path."""
    path = setup.toolpath
    return deviation_over_spin(setup, sampled(path, max(setup.step, float(path.s[-1]) / SPIN_SAMPLES)))


def groove(setup: SimulationSetup, station: float) -> GrooveSection:
    """The groove's section at ``station`` (m of length cut)."""
    return result(setup).groove(station)


@shared(16, lambda setup, times: (setup.digest(), times))
def pictured(setup: SimulationSetup, times: float) -> Enlarged:
    """The surfaces for pictures with the displacement ``times`` times enlarged, from the cache."""
    return enlarged(result(setup), times)


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
