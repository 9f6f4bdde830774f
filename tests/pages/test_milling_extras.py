"""The app without its extras: everything else works, and what is missing is named where it would be pressed."""

from __future__ import annotations

import sys
from html import unescape

import pytest
from conftest import errors, go, words
from streamlit.testing.v1 import AppTest

from robomill.ui import rendered
from robomill.viz.rendered.render_queue import RenderQueue
from robomill.viz.rendered.worker import RenderWorker

RENDER = 'which is not installed here; get it with: pip install "robomill[render]"'
FILM = 'A film as MP4 needs imageio-ffmpeg, which is not installed here; get it with: pip install "robomill[film]"'


def off(app: AppTest, key: str) -> bool:
    """Whether a button cannot be pressed."""
    for kind in ("download_button", "button"):
        for one in app.get(kind):
            if one.proto.id.endswith(key):
                return bool(one.proto.disabled)
    raise AssertionError(key)


@pytest.fixture
def milling(app: AppTest, monkeypatch: pytest.MonkeyPatch) -> AppTest:
    """The milling page, its pictures drawn as anywhere."""
    queue = RenderQueue(RenderWorker())
    monkeypatch.setattr(rendered, "queue", lambda: queue)
    return app


def test_without_renderings_the_page_stands_and_names_the_extra(
    milling: AppTest, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in ("pyvista", "vtk", "matplotlib", "imageio_ffmpeg"):
        monkeypatch.setitem(sys.modules, module, None)
    go(milling, "6_Milling")
    assert not milling.exception
    assert not errors(milling)
    said = unescape(words(milling))
    assert f"A rendered picture needs pyvista, {RENDER}" in said
    assert f"A surface as VTP needs pyvista, {RENDER}" in said
    for key in ("milling.get.png", "milling.get.vtp", "milling.film.make"):
        assert off(milling, key)
    for key in ("milling.get.stl", "milling.get.ply", "milling.get.deviation"):
        assert not off(milling, key)


def test_an_mp4_alone_needs_its_encoder(milling: AppTest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    monkeypatch.setattr(rendered, "picture", lambda *_: None)
    go(milling, "6_Milling")
    assert FILM not in unescape(words(milling))
    assert not off(milling, "milling.film.make")
    milling.button_group(key="milling.film.kind").set_value("mp4").run()
    assert FILM in unescape(words(milling))
    assert off(milling, "milling.film.make")


def test_the_start_page_stands_without_renderings(milling: AppTest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyvista", None)
    milling.run()
    assert not milling.exception
    assert not errors(milling)
