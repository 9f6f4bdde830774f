"""A program that goes round in a loop without an end: read beside the page, given up at once, refused in a sentence."""

from __future__ import annotations

import time

import pytest
from conftest import errors, go, store, words
from streamlit.testing.v1 import AppTest

from robomill.toolpath.gcode import interpreter
from robomill.toolpath.source import GCodeSource
from robomill.ui import beside
from robomill.ui.job import Job

ENDLESS = "o100 while [1 GT 0]\n G1 X1 F100\n G1 X0\no100 endwhile\nM2\n"


def opened(app: AppTest, page: str) -> AppTest:
    """A project whose program never ends, on one of the pages."""
    held = store(app)
    held.put(held.project.replace(setup=held.project.setup.replace(source=GCodeSource(ENDLESS, "endless.nc"))))
    return go(app, page)


@pytest.mark.parametrize("page", ["app", "1_Robot", "5_Toolpath", "6_Milling", "7_Improve"])
def test_the_page_stays_alive_and_cancel_ends_the_reading(
    app: AppTest, monkeypatch: pytest.MonkeyPatch, page: str
) -> None:
    monkeypatch.setattr(beside, "FIRST_S", 0.05)
    opened(app, page)
    assert not app.exception
    job = store(app).values["run.path"]
    assert isinstance(job, Job)
    app.button(key="run.path.cancel").click().run()
    began = time.process_time()
    assert job.done.wait(60)
    assert job.made is None
    assert time.process_time() - began < 2.0  # a reading to its end takes ten seconds and more
    assert not app.exception
    assert app.button(key="run.path.ask")
    assert "Reading the program: not computed yet" in words(app)


def test_it_is_refused_with_its_line(app: AppTest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interpreter, "MAX_STEPS", 5000)
    opened(app, "5_Toolpath")
    assert not app.exception
    assert any("the program may not end" in said for said in errors(app))
