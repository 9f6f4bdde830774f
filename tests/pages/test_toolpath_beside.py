"""A program that goes round in a loop without an end: read beside the page, given up at once, refused in a sentence."""

from __future__ import annotations

import itertools
import threading
import time

import pytest
from conftest import errors, go, store, words
from streamlit.testing.v1 import AppTest

from robomill import progress
from robomill.errors import GCodeError
from robomill.progress import checkpoint
from robomill.toolpath.gcode import interpreter
from robomill.toolpath.source import GCodeSource
from robomill.ui.work import beside
from robomill.ui.work.job import Job

ENDLESS = "o100 while [1 GT 0]\n G1 X1 F100\n G1 X0\no100 endwhile\nM2\n"
SLOW = "o100 while [1 GT 0]\n M8\n G4 P0\no100 endwhile\nM2\n"
"""Makes no move, and is followed line by line."""
NUMBER = itertools.count()


def opened(app: AppTest, page: str, text: str = ENDLESS) -> AppTest:
    """A project whose program never ends, on one of the pages."""
    held = store(app)
    source = GCodeSource(f"{text}({next(NUMBER)})\n", "endless.nc")  # nobody has read it, nor was it refused
    held.put(held.project.replace(setup=held.project.setup.replace(source=source)))
    return go(app, page)


def without_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing but cancel ends a reading: a loop is not refused for its length."""
    monkeypatch.setattr(beside, "FIRST_S", 0.05)
    monkeypatch.setattr(interpreter, "MAX_STEPS", 1 << 40)
    monkeypatch.setattr(interpreter, "LOOPING", 1e9)


def reading(app: AppTest) -> AppTest:
    """The page once it reads the program: what else it makes beside itself before takes what it takes."""
    for _ in range(100):
        if any(button.key == "run.path.cancel" for button in app.button):
            break
        app.run()
    assert not app.exception
    return app


@pytest.mark.parametrize("page", ["app", "1_Robot", "5_Toolpath", "6_Milling", "7_Improve"])
def test_the_page_stays_alive_and_cancel_ends_the_reading(
    app: AppTest, monkeypatch: pytest.MonkeyPatch, page: str
) -> None:
    without_limit(monkeypatch)
    reading(opened(app, page, SLOW))
    job = store(app).values["run.path"]
    assert isinstance(job, Job)
    app.button(key="run.path.cancel").click().run()
    began = time.process_time()
    assert job.done.wait(60)
    assert job.made is None
    assert time.process_time() - began < 2.0
    assert not app.exception
    assert app.button(key="run.path.ask")
    assert "Reading the program: not computed yet" in words(app)


def test_it_is_refused_with_its_line(app: AppTest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interpreter, "MAX_STEPS", 5000)
    opened(app, "5_Toolpath")
    assert not app.exception
    assert any("the program may not end" in said for said in errors(app))


@pytest.mark.parametrize("page", ["3_Compliance", "4_Identification", "5_Toolpath", "6_Milling"])
def test_nothing_on_the_page_reads_it_a_second_time(app: AppTest, monkeypatch: pytest.MonkeyPatch, page: str) -> None:
    """What would read the program in the page's own thread stands still there until it is refused."""
    reads: list[str] = []

    def endless(*_: object, **__: object) -> object:
        reads.append(threading.current_thread().name)
        if progress._watching.get() is None:
            raise AssertionError("an endless program in the page's own thread")
        while True:
            checkpoint(0.1, "Reading")
            time.sleep(0.01)

    monkeypatch.setattr(beside, "FIRST_S", 0.05)
    monkeypatch.setattr(GCodeSource, "read", endless)
    reading(opened(app, page))
    app.button(key="run.path.cancel").click().run()
    assert not app.exception
    assert app.button(key="run.path.ask")
    app.run()
    assert not app.exception
    assert len(reads) == 1


def test_a_program_that_is_not_read_yet_is_not_converted(app: AppTest, monkeypatch: pytest.MonkeyPatch) -> None:
    without_limit(monkeypatch)
    reading(opened(app, "5_Toolpath", SLOW))
    app.button_group(key="toolpath.kind").set_value("lines").run()
    assert not app.exception
    assert store(app).project.setup.source.kind == "program"
    assert any("not read yet" in said for said in errors(app))


def test_a_refused_program_is_not_read_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interpreter, "MAX_STEPS", 5000)
    source = GCodeSource(ENDLESS + "(once)\n", "once.nc")
    with pytest.raises(GCodeError) as first:
        source.read()
    monkeypatch.setattr(interpreter, "MAX_STEPS", 1 << 40)  # it would never end
    with pytest.raises(GCodeError) as second:
        source.read()
    assert (str(second.value), second.value.line, second.value.where) == (
        str(first.value),
        first.value.line,
        first.value.where,
    )
    assert second.value is not first.value
