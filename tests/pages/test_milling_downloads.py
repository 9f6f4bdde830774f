"""Files that take long to be made are made beside the page when a button asks for them: progress, cancel, then to take
away; short ones are there at once."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest
from conftest import errors, go, store
from streamlit.testing.v1 import AppTest

from robomill.errors import SurfaceError
from robomill.progress import checkpoint
from robomill.ui import shell
from robomill.ui.milling import pictures
from robomill.ui.work import beside, cached
from robomill.ui.work.job import Job

STL = "milling.get.stl"


class Slow:
    """A file that is written for as long as it is not let go or given up."""

    def __init__(self) -> None:
        self.go, self.ended, self.count, self.ended_at = threading.Event(), threading.Event(), 0, 0.0

    def __call__(self, *_: Any, **__: Any) -> bytes:
        self.count += 1
        self.ended.clear()
        try:
            while not self.go.wait(0.01):
                checkpoint(0.5, "Triangles")
            return b"a solid"
        finally:
            self.ended_at = time.perf_counter()
            self.ended.set()


@pytest.fixture
def slow(app: AppTest, monkeypatch: pytest.MonkeyPatch) -> Iterator[Slow]:
    """The Milling page whose surfaces take long to be written."""
    made = Slow()
    cached.commons.clear()
    go(app, "6_Milling")
    monkeypatch.setattr(pictures, "_mesh_seconds", lambda *_: 5.0)
    monkeypatch.setattr(pictures, "mesh_bytes", made)
    monkeypatch.setattr(beside, "FIRST_S", 0.2)
    app.run()
    yield made
    made.go.set()


def downloads(app: AppTest) -> list[str]:
    """The labels of the buttons that hand out a file."""
    return [element.proto.label for element in app.get("download_button")]


def test_a_long_file_is_asked_for_and_then_taken(app: AppTest, slow: Slow) -> None:
    assert "Surface STL" not in downloads(app)
    app.button(key=f"{STL}.ask").click().run()
    assert not app.exception
    assert app.button(key="file.cancel")
    assert store(app).values["file"].progress.stage == "Triangles"
    slow.go.set()
    assert store(app).values["file"].done.wait(30)
    app.run()
    assert not app.exception
    assert "Save surface.stl" in downloads(app)
    assert not [button for button in app.button if button.key == "file.cancel"]
    app.run()
    assert slow.count == 1
    assert "Save surface.stl" in downloads(app)


def test_cancel_is_heard_within_a_fifth_of_a_second_and_the_button_is_back(app: AppTest, slow: Slow) -> None:
    took = []
    while not took or (took[-1] >= 0.2 and len(took) < 5):  # a machine that is busy with other things is asked again
        app.button(key=f"{STL}.ask").click().run()
        assert isinstance(store(app).values["file"], Job)
        began = time.perf_counter()
        app.button(key="file.cancel").click().run()
        assert slow.ended.wait(30)
        took.append(slow.ended_at - began)
        assert not app.exception
        assert app.button(key=f"{STL}.ask")
        assert "Save surface.stl" not in downloads(app)
        assert slow.count == len(took)
    assert took[-1] < 0.2
    slow.go.set()
    app.button(key=f"{STL}.ask").click().run()
    assert "Save surface.stl" in downloads(app)


def test_another_file_takes_the_place_of_the_first(app: AppTest, slow: Slow) -> None:
    app.button(key=f"{STL}.ask").click().run()
    first = store(app).values["file"]
    app.button(key="milling.get.ply.ask").click().run()
    assert first.done.wait(30)
    assert first.made is None
    assert app.button(key=f"{STL}.ask")
    slow.go.set()
    assert store(app).values["file"].done.wait(30)
    app.run()
    assert "Save surface.ply" in downloads(app)


def test_a_refusal_is_said_and_the_file_can_be_asked_for_again(
    app: AppTest, slow: Slow, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuses(*_: Any, **__: Any) -> bytes:
        raise SurfaceError("There is no such solid.")

    monkeypatch.setattr(pictures, "mesh_bytes", refuses)
    app.button(key=f"{STL}.ask").click().run()
    assert "There is no such solid." in errors(app)
    app.run()
    assert app.button(key=f"{STL}.ask")
    assert not app.exception


def test_a_short_file_is_one_click_away(app: AppTest) -> None:
    go(app, "6_Milling")
    assert {"Deviation CSV", "Surface STL", "Surface PLY", "Save"} <= set(downloads(app))


def test_a_heavy_project_is_written_beside_the_page(app: AppTest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shell, "BYTE_S", 1.0)
    monkeypatch.setattr(beside, "FIRST_S", 30.0)
    app.run()
    assert "Save" not in downloads(app)
    app.button(key="save.ask").click().run()
    assert not app.exception
    assert [label for label in downloads(app) if label.startswith("Save ") and label.endswith(".toml")]
    held = store(app)
    held.put(held.project.replace(setup=held.project.setup.replace(tolerance=0.2e-3)))
    app.run()
    assert app.button(key="save.ask"), "what was made is of another project"
