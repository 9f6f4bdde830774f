"""Work is handed over in no time and written soon, the newest of each tab, large projects seldom."""

from __future__ import annotations

import errno
import threading
import time
from dataclasses import replace
from pathlib import Path

import pytest

from robomill.errors import ProjectError
from robomill.ui.keeping import writer as module
from robomill.ui.keeping.settings import Settings
from robomill.ui.keeping.shelf import Shelf
from robomill.ui.keeping.writer import Line, Work, Writer
from robomill.ui.project import DEFAULT_PRESET, Project, preset_setup, project_from_toml

KEY, PLACE = "a1" * 32, "tab-" + "0" * 16


class Slow(Shelf):
    """A shelf whose writing takes ``slow_s``; it counts."""

    slow_s = 0.0
    written = 0

    def put(self, *args: object, **more: object) -> object:  # type: ignore[override]
        time.sleep(self.slow_s)
        self.written += 1
        return super().put(*args, **more)  # type: ignore[arg-type]


@pytest.fixture
def shelf(tmp_path: Path) -> Slow:
    return Slow(Settings(folder=tmp_path / "work"))


def named(name: str) -> Project:
    return Project(preset_setup(DEFAULT_PRESET).replace(name=name))


def test_what_was_handed_over_last_is_what_is_read(shelf: Slow) -> None:
    writer, line = Writer(shelf), Line(KEY, PLACE)
    for i in range(5):
        writer.hand(line, Work(named(f"state {i}")))
    assert writer.flush(10.0)
    project = project_from_toml(shelf.get(KEY, PLACE)[1][0])
    assert project.setup.name == "state 4"
    assert project.digest() == named("state 4").digest()
    assert line.saved == pytest.approx(time.time(), abs=10.0)


def test_handing_over_is_not_in_the_way(shelf: Slow) -> None:
    shelf.slow_s = 0.2
    writer, line, project = Writer(shelf), Line(KEY, PLACE), named("mine")
    took = []
    for _ in range(50):
        began = time.perf_counter()
        writer.hand(line, Work(project, (project,) * 60))
        took.append(time.perf_counter() - began)
    assert sorted(took)[25] < 5e-3


def test_a_project_that_takes_long_is_not_written_at_every_step_of_a_slider(shelf: Slow) -> None:
    shelf.slow_s = 0.1
    writer, line = Writer(shelf), Line(KEY, PLACE)
    for i in range(40):
        writer.hand(line, Work(named(f"step {i}")))
        time.sleep(0.02)
    assert shelf.written <= 2, "0.8 s of dragging, and each writing is followed by a rest ten times as long"
    assert writer.flush(10.0), "what waits is written when the server ends"
    assert project_from_toml(shelf.get(KEY, PLACE)[1][0]).setup.name == "step 39"


def test_earlier_states_are_kept_with_it_the_newest_first_and_bounded(
    shelf: Slow, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "EARLIER", 3)
    writer, line = Writer(shelf), Line(KEY, PLACE)
    past = [named(f"state {i}") for i in range(2)]
    writer.hand(line, Work(named("state 2"), past, ["oldest", "before"]))
    assert writer.flush(10.0)
    texts = shelf.get(KEY, PLACE)[1]
    assert [project_from_toml(text).setup.name for text in texts[:3]] == ["state 2", "state 1", "state 0"]
    assert texts[3:] == ["before"]


def test_who_comes_second_is_told_and_goes_on_at_a_place_of_its_own(shelf: Slow) -> None:
    writer, first, second = Writer(shelf), Line(KEY, PLACE), Line(KEY, PLACE)
    writer.hand(first, Work(named("first")))
    assert writer.flush(10.0)
    writer.hand(second, Work(named("second")))
    assert writer.flush(10.0)
    assert first.overtaken is None
    assert second.overtaken is not None
    assert second.overtaken.name == "first"
    assert second.moved == (PLACE, second.place)
    names = [project_from_toml(shelf.get(KEY, line.place)[1][0]).setup.name for line in (first, second)]
    assert names == ["first", "second"]


@pytest.mark.parametrize("failure", [ProjectError("The disk is full."), RuntimeError("a bug")])
def test_a_writing_that_fails_is_said_until_the_next_that_succeeds(
    shelf: Slow, monkeypatch: pytest.MonkeyPatch, failure: Exception
) -> None:
    def fails(*_: object, **__: object) -> None:
        raise failure

    writer, line = Writer(shelf), Line(KEY, PLACE)
    monkeypatch.setattr(shelf, "put", fails)
    writer.hand(line, Work(named("mine")))
    assert writer.flush(10.0)
    assert line.trouble
    if isinstance(failure, ProjectError):
        assert line.trouble == "The disk is full."
    monkeypatch.undo()
    writer.hand(line, Work(named("mine")))
    assert writer.flush(10.0)
    assert line.trouble == ""
    assert shelf.has(KEY, PLACE)


def test_many_tabs_at_once_are_all_written(shelf: Slow) -> None:
    writer = Writer(shelf)
    lines = [Line(f"{i:02x}" * 32, PLACE) for i in range(30)]

    def work(line: Line) -> None:
        for i in range(5):
            writer.hand(line, Work(named(f"{line.key[:2]} {i}")))

    threads = [threading.Thread(target=work, args=(line,)) for line in lines]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert writer.flush(30.0)
    assert [project_from_toml(shelf.get(line.key, PLACE)[1][0]).setup.name for line in lines] == [
        f"{line.key[:2]} 4" for line in lines
    ]


def test_nothing_is_written_before_the_tab_has_said_which_it_is(shelf: Slow) -> None:
    writer = Writer(shelf)
    writer.hand(Line(KEY, ""), Work(named("mine")))
    writer.hand(Line("", PLACE), Work(named("mine")))
    assert writer.flush(5.0)
    assert shelf.heads(KEY) == []


def test_a_store_that_cannot_be_written_is_everyones_trouble_and_is_logged_once(
    shelf: Slow, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    writer, line = Writer(shelf), Line(KEY, PLACE)
    monkeypatch.setattr(shelf, "_write", full)
    for name in ("first", "second"):
        writer.hand(line, Work(named(name)))
        assert writer.flush(10.0)
    assert line.trouble == writer.trouble == "Your work could not be kept on the server: no space left on device."
    assert [each.levelname for each in caplog.records] == ["WARNING"]
    assert str(shelf.settings.folder) in caplog.text
    assert Writer(shelf).trouble == writer.trouble, "a server that begins so knows it at once"
    monkeypatch.undo()
    writer.hand(line, Work(named("third")))
    assert writer.flush(10.0)
    assert line.trouble == writer.trouble == ""


def test_a_project_that_is_too_large_is_nobody_elses_trouble(shelf: Slow, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shelf, "settings", replace(shelf.settings, entry_MB=1e-4))
    writer, line = Writer(shelf), Line(KEY, PLACE)
    writer.hand(line, Work(named("large")))
    assert writer.flush(10.0)
    assert "at most" in line.trouble
    assert writer.trouble == ""


def test_who_waits_for_the_writing_waits_no_longer_than_it_takes(shelf: Slow) -> None:
    writer, line = Writer(shelf), Line(KEY, PLACE)
    writer.hand(line, Work(named("mine")))
    writer.settle(line, 10.0)
    assert shelf.has(KEY, PLACE)
    line.rests_until = time.monotonic() + 60.0
    writer.hand(line, Work(named("again")))
    began = time.monotonic()
    writer.settle(line, 10.0)
    assert time.monotonic() - began < 5.0
