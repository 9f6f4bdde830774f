"""Rendered pictures: one worker process for the server, pictures cached by what they show."""

from __future__ import annotations

import streamlit as st

from robomill.errors import RenderError
from robomill.viz.picture import SurfacePicture
from robomill.viz.worker import RenderWorker


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
    if worker().down and st.session_state.get("render.said"):
        return None
    try:
        return _png((*key, scene.dark, scene.camera, scene.size), scene)
    except RenderError as exc:
        if not st.session_state.get("render.said"):
            st.session_state["render.said"] = worker().down
            st.info(str(exc), icon=":material/info:")
        return None
