"""A film of the cut, made beside the page: progress, cancel, then GIF or MP4 to watch and to take away."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import streamlit as st

from robomill.errors import RobomillError
from robomill.simulation.result import SimulationResult
from robomill.ui import cached, inputs, pieces, session
from robomill.units import format_times
from robomill.viz.animation import FRAMES, MIME, FilmEnd, FilmStart, Kind, film_frame, film_samples
from robomill.viz.picture import Camera
from robomill.viz.views import headroom, surface_picture
from robomill.viz.worker import RenderWorker

KEY, COUNT = "milling.film", "milling.film.pictures"
SIZE = (960, 544)
EVERY_S = 0.5
KINDS = {"gif": "GIF", "mp4": "MP4"}


@dataclass(eq=False)
class Film:
    """One film being made in a thread of its own, with a drawing process of its own; the thread touches no page."""

    result: SimulationResult
    kind: Kind
    frames: int
    times: float
    camera: Camera
    dark: bool
    done_frames: int = 0
    data: bytes = b""
    error: RobomillError | None = None
    bug: BaseException | None = None
    stop: threading.Event = field(default_factory=threading.Event)
    done: threading.Event = field(default_factory=threading.Event)

    @property
    def digest(self) -> str:
        """What the film shows."""
        return self.result.setup.digest()

    def start(self) -> None:
        """Begin."""
        threading.Thread(target=self._run, daemon=True, name="film").start()

    def _run(self) -> None:
        worker = RenderWorker()
        try:
            self._make(worker)
        except RobomillError as exc:
            self.error = exc
        except Exception as exc:  # shown by the page that asked: a thread has nobody to raise to
            self.bug = exc
        finally:
            worker.close()
            self.done.set()

    def _make(self, worker: RenderWorker) -> None:
        shown = cached.pictured(self.result.setup, self.times)
        picture = surface_picture(
            self.result,
            shown,
            camera=self.camera,
            dark=self.dark,
            size=SIZE,
            headroom=headroom(self.result),
        )
        worker.render(FilmStart("cut", picture))
        for index in film_samples(self.result, self.frames):
            if self.stop.is_set():
                return
            worker.render(film_frame(self.result, shown, "cut", int(index)))
            self.done_frames += 1
        self.data = worker.render(FilmEnd("cut", self.kind, max(self.frames / 6.0, 4.0)))


def current() -> Film | None:
    """The film of this session, being made or done."""
    found = session.kept(KEY)
    return found if isinstance(found, Film) else None


def give_up() -> None:
    """Stop and forget the film."""
    film = current()
    if film is not None:
        film.stop.set()
        session.drop(KEY)


def panel(result: SimulationResult, dark: bool) -> None:
    """Choose, make, watch, take away."""
    view = session.project().view
    kind, frames, make = st.columns([1, 2, 1.2], vertical_alignment="bottom")
    with kind:
        chosen: Any = inputs.pick("Film as", "milling.film.kind", KINDS)
    with frames:
        count = int(session.kept(COUNT, 36))
        inputs.slider("Pictures", COUNT, inputs.Span(*FRAMES, 4, "%d"), count, partial(session.keep, COUNT))
    camera: Any = view.camera
    make.button(
        "Make the film",
        icon=":material/movie:",
        key="milling.film.make",
        width="stretch",
        on_click=lambda: _begin(Film(result, chosen, count, view.exaggeration, camera, dark)),
    )
    _progress()


def _begin(film: Film) -> None:
    give_up()
    session.keep(KEY, film)
    film.start()


def _progress() -> None:
    film = current()
    if film is None:
        pieces.note("The cut from its first to its last move, in the camera and the exaggeration of the picture above.")
    elif film.done.is_set():
        _finished(film)
    else:
        _waiting()


@st.fragment(run_every=EVERY_S)
def _waiting() -> None:
    film = current()
    if film is None or film.done.is_set():
        st.rerun()
        return
    words = "Writing the file" if film.done_frames == film.frames else f"Picture {film.done_frames} of {film.frames}"
    bar, cancel = st.columns([4, 1], vertical_alignment="center")
    bar.progress(film.done_frames / film.frames, words)
    if cancel.button("Cancel", icon=":material/close:", key="milling.film.cancel", width="stretch"):
        give_up()
        st.rerun()


def _finished(film: Film) -> None:
    if film.bug is not None:
        raise film.bug
    if film.error is not None:
        pieces.error(film.error)
        return
    if film.digest != session.project().setup.digest():
        pieces.note("The film shows the set-up before the last change; make it again for this one.")
    if film.kind == "gif":
        st.image(film.data, width="stretch")
    else:
        st.video(film.data, autoplay=True, loop=True, muted=True)
    pieces.download(f"Film {KINDS[film.kind]}", film.data, f"cut.{film.kind}", MIME[film.kind], key="milling.get.film")
    pieces.note(
        f"{film.frames} pictures, {len(film.data) / 1e6:.1f} MB, displacement shown {format_times(film.times, 6)}."
    )
