"""A film of the cut, made beside the page: progress, cancel, then GIF or MP4 to watch and to take away."""

from dataclasses import dataclass
from functools import partial
from typing import Any

import streamlit as st

from robomill.progress import checkpoint
from robomill.simulation.result import SimulationResult
from robomill.ui import pieces, rendered, session
from robomill.ui.entry import inputs
from robomill.ui.work import cached, job as jobs
from robomill.ui.work.job import Job
from robomill.units import format_bytes, format_times
from robomill.viz.rendered.animation import FRAMES, Kind, absent, encode, film_frame, film_samples
from robomill.viz.views import headroom, surface_picture

KEY, COUNT = "milling.film", "milling.film.pictures"
SIZE = (960, 544)
KINDS = {"gif": "GIF", "mp4": "MP4"}


@dataclass(frozen=True, eq=False)
class Film:
    """What a film shows, how many frames it has and how it is kept."""

    result: SimulationResult
    kind: Kind
    frames: int
    times: float
    camera: str
    dark: bool

    def make(self) -> bytes:
        """The film's bytes; its pictures wait their turn with those of the pages."""
        pictures: list[bytes] = []
        shown = cached.pictured(self.result.setup, self.times)
        how: dict[str, Any] = {"camera": self.camera, "dark": self.dark, "size": SIZE}
        still = surface_picture(self.result, shown, headroom=headroom(self.result), **how)
        queue, owner = rendered.queue(), f"film.{id(self)}"
        try:
            for index in film_samples(self.result, self.frames).tolist():
                checkpoint(len(pictures) / self.frames, "pictures")
                frame = partial(film_frame, self.result, shown, still, index)
                pictures.append(rendered.wait(queue.order(owner, (owner, len(pictures)), frame)))
        finally:
            queue.drop(owner)
        checkpoint(1.0)
        return encode(pictures, self.kind, max(self.frames / 6.0, 4.0))


def panel(result: SimulationResult, dark: bool) -> None:
    """Choose, make, watch, take away."""
    view = session.project().view
    kind, frames, make = st.columns([1, 2, 1.2], vertical_alignment="bottom")
    with kind:
        chosen: Any = inputs.pick("Film as", "milling.film.kind", KINDS)
    with frames:
        count = int(session.kept(COUNT, 36))
        inputs.slider("Pictures", COUNT, inputs.Span(*FRAMES, 4, "%d"), count, partial(session.keep, COUNT))
    with make:
        film, refusal = Film(result, chosen, count, view.exaggeration, view.camera, dark), absent(chosen)
        how: dict[str, Any] = {"width": "stretch", "disabled": refusal is not None}
        inputs.button("Make the film", "milling.film.make", "movie", _begin, film, **how)
    if refusal is not None:
        pieces.note(str(refusal))
    _progress()


def _begin(film: Film) -> None:
    jobs.begin(KEY, Job(film.make, film))


def _progress() -> None:
    done = jobs.finished(KEY)
    if done is not None:
        _finished(done)
    elif session.kept(KEY) is not None:
        jobs.waiting(KEY, _words)
    else:
        pieces.note("The cut from its first to its last move, in the camera and the exaggeration of the picture above.")


def _words(job: Job) -> str:
    frames, share = job.about.frames, job.progress.share
    return f"Picture {round(share * frames)} of {frames}" if share < 1 else "Writing the file"


def _finished(job: Job) -> None:
    film: Film = job.about
    if job.error is not None:
        pieces.error(job.error)
        return
    if film.result.setup.digest() != session.project().setup.digest():
        pieces.note("The film shows the set-up before the last change; make it again for this one.")
    if film.kind == "gif":
        st.image(job.made, width="stretch")
    else:
        st.video(job.made, autoplay=True, loop=True, muted=True)
    pieces.download(f"Film {KINDS[film.kind]}", job.made, pieces.named(f"cut.{film.kind}"), "milling.get.film")
    size = format_bytes(len(job.made))
    pieces.note(f"{film.frames} pictures, {size}, displacement shown {format_times(film.times, 6)}.")
