"""The folder that keeps work: read and written as another program would, with every fault that a disk can have."""

from __future__ import annotations

import errno
import hashlib
import multiprocessing
import os
import random
import stat
import sys
import time
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from robomill.errors import ProjectError
from robomill.ui.keeping.settings import Settings
from robomill.ui.keeping.shelf import OvertakenError, Shelf, StoreError, place_of

KEY, OTHER = "a1" * 32, "b2" * 32
TAB, SECOND = "tab-" + "0" * 16, "tab-" + "1" * 16


@pytest.fixture
def shelf(tmp_path: Path) -> Shelf:
    return Shelf(Settings(folder=tmp_path / "work"))


def put(shelf: Shelf, text: str = "a = 1\n", key: str = KEY, place: str = TAB) -> str:
    return shelf.put(key, place, ("mine", 0.0), [text]).stamp


def files(shelf: Shelf) -> list[Path]:
    return sorted(p for p in shelf.settings.folder.rglob("*") if p.is_file())


def test_what_is_put_is_got_with_its_earlier_states_and_stands_in_a_file_that_people_can_read(shelf: Shelf) -> None:
    shelf.put(KEY, TAB, ("Größe", 0.0), ["a = 1\n", "a = 0\n"])
    head, texts = shelf.get(KEY, TAB)
    assert (head.name, texts) == ("Größe", ["a = 1\n", "a = 0\n"])
    assert abs(head.time - time.time()) < 5.0
    assert "\na = 1\n" in files(shelf)[0].read_text()


def test_neither_the_folder_nor_its_files_give_the_key_away_and_nobody_else_reads_them(shelf: Shelf) -> None:
    put(shelf)
    (file,) = files(shelf)
    assert hashlib.sha256(bytes.fromhex(KEY)).hexdigest() == file.parent.name
    assert KEY not in str(file) + file.read_text()
    assert [stat.S_IMODE(p.stat().st_mode) for p in (file, file.parent, file.parent.parent)] == [0o600, 0o700, 0o700]


def test_one_browser_sees_nothing_of_another(shelf: Shelf) -> None:
    put(shelf)
    assert shelf.heads(OTHER) == []
    with pytest.raises(ProjectError):
        shelf.get(OTHER, TAB)


@pytest.mark.parametrize("key", ["", "../../etc", "A1" * 32, KEY + "\n", "/" * 64])
def test_a_key_or_a_place_that_is_none_reaches_no_file(shelf: Shelf, key: str) -> None:
    for where in ((key, TAB), (KEY, key)):
        with pytest.raises(ProjectError):
            shelf.put(*where, ("mine", 0.0), ["a = 1\n"])
        with pytest.raises(ProjectError):
            shelf.get(*where)
    assert not shelf.settings.folder.exists() or files(shelf) == []


def test_two_that_write_one_entry_do_not_overwrite_each_other(shelf: Shelf) -> None:
    first = put(shelf, "first = 1\n")
    second = shelf.put(KEY, TAB, ("mine", 0.0), ["second = 1\n"], over=first).stamp
    with pytest.raises(OvertakenError) as told:
        shelf.put(KEY, TAB, ("mine", 0.0), ["third = 1\n"], over=first)
    assert told.value.head.stamp == second
    assert shelf.get(KEY, TAB)[1] == ["second = 1\n"]


def test_the_last_written_comes_first_even_where_the_clock_jumps_back(
    shelf: Shelf, monkeypatch: pytest.MonkeyPatch
) -> None:
    put(shelf)
    monkeypatch.setattr(time, "time", lambda: 1000.0)
    put(shelf, place=SECOND)
    assert [head.place for head in shelf.heads(KEY)] == [SECOND, TAB]
    shelf.sweep()
    assert len(files(shelf)) == 2, "what seems to be of the future is not too old"


@pytest.mark.parametrize(
    "damage", [lambda b: b[: len(b) // 2], lambda b: b[:-3], lambda b: b"", lambda b: b"\xff" * 90]
)
def test_a_damaged_entry_is_refused_in_one_sentence_and_set_aside(shelf: Shelf, damage: object) -> None:
    put(shelf, "a = 1\n" * 50)
    (file,) = files(shelf)
    file.write_bytes(damage(file.read_bytes()))  # type: ignore[operator]
    assert shelf.has(KEY, TAB)
    with pytest.raises(ProjectError, match=r"^[^\n/]+\.$"):
        shelf.get(KEY, TAB)
    assert not shelf.has(KEY, TAB)
    put(shelf, "b = 1\n")
    assert shelf.get(KEY, TAB)[1] == ["b = 1\n"]
    assert len(files(shelf)) == 2, "the damaged file is still there for whoever runs the server"


def test_a_full_disk_leaves_the_last_entry_whole_and_nothing_half_written(
    shelf: Shelf, monkeypatch: pytest.MonkeyPatch
) -> None:
    put(shelf, "a = 1\n")

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fdopen", lambda fd, mode: (os.close(fd), full()))
    with pytest.raises(ProjectError, match="no space left on device"):
        put(shelf, "b = 1\n")
    monkeypatch.undo()
    assert shelf.get(KEY, TAB)[1] == ["a = 1\n"]
    assert len(files(shelf)) == 1


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device that is always full")
def test_a_disk_that_is_full_once_it_is_written_to(shelf: Shelf, monkeypatch: pytest.MonkeyPatch) -> None:
    put(shelf)
    opened = os.fdopen
    monkeypatch.setattr(
        os, "fdopen", lambda fd, mode: (os.close(fd), opened(os.open("/dev/full", os.O_WRONLY), mode))[1]
    )
    with pytest.raises(ProjectError, match="no space left"):
        put(shelf, "b = 1\n")
    assert len(files(shelf)) == 1


def test_a_folder_that_cannot_be_made_is_said_without_its_path(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    shelf = Shelf(Settings(folder=tmp_path / "file" / "work"))
    assert shelf.heads(KEY) == []
    with pytest.raises(ProjectError, match="could not be kept") as told:
        put(shelf)
    assert str(tmp_path) not in str(told.value)


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root writes everywhere")
def test_a_read_only_home(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(ProjectError, match="permission denied"):
        put(Shelf(Settings(folder=tmp_path / "work")))


def test_an_entry_that_is_too_large_is_refused_and_the_last_one_stays(tmp_path: Path) -> None:
    shelf = Shelf(Settings(folder=tmp_path, entry_MB=0.001))
    put(shelf, "a = 1\n")
    with pytest.raises(ProjectError, match="at most"):
        put(shelf, "x" * 2000)
    assert shelf.get(KEY, TAB)[1] == ["a = 1\n"]


def test_the_oldest_go_first_where_there_are_too_many_bytes(tmp_path: Path) -> None:
    shelf = Shelf(Settings(folder=tmp_path, all_MB=0.01))
    for i in range(12):
        put(shelf, f"n = {i}\n" + "#" * 1500, key=f"{i:02x}" * 32)
        for file in files(shelf):
            os.utime(file, (time.time() - 60, file.stat().st_mtime - 60))
    sizes = [p.stat().st_size for p in files(shelf)]
    assert sum(sizes) <= 0.01e6
    there = [i for i in range(12) if shelf.has(f"{i:02x}" * 32, TAB)]
    assert there == list(range(12 - len(there), 12))
    assert len(there) >= 4


def test_what_is_too_old_goes_with_its_folder(shelf: Shelf) -> None:
    put(shelf)
    put(shelf, key=OTHER)
    (old,) = [p for p in files(shelf) if p.parent.name == hashlib.sha256(bytes.fromhex(KEY)).hexdigest()]
    before = time.time() - 31 * 86400
    os.utime(old, (before, before))
    shelf.sweep()
    assert not old.parent.exists()
    assert shelf.has(OTHER, TAB)


def test_a_browser_has_so_many_tabs_and_so_many_names(tmp_path: Path) -> None:
    shelf = Shelf(Settings(folder=tmp_path, tabs=3, names=2))
    for i in range(6):
        put(shelf, place=f"tab-{i:016x}")
    assert [h.place for h in shelf.heads(KEY, "tab")] == [f"tab-{i:016x}" for i in (5, 4, 3)]
    for i in range(6):
        put(shelf, place=f"side-{i:016x}")
    assert [h.place for h in shelf.heads(KEY, "side")] == [f"side-{i:016x}" for i in (5, 4, 3)]
    assert len(shelf.heads(KEY, "tab")) == 3
    for name in ("one", "two", "two"):
        put(shelf, place=place_of(name))
    with pytest.raises(ProjectError, match="delete one"):
        put(shelf, place=place_of("three"))
    shelf.drop(KEY, place_of("one"))
    put(shelf, place=place_of("three"))


def test_every_bound_can_be_set_and_nonsense_is_refused() -> None:
    given = Settings.of({"ROBOMILL_AUTOSAVE": "off", "ROBOMILL_AUTOSAVE_DAYS": "7", "ROBOMILL_AUTOSAVE_ALL_MB": "0.5"})
    assert (given.on, given.days, given.all_MB) == (False, 7.0, 0.5)
    assert Settings.of({}).on
    for name, word in (("", "perhaps"), ("_DAYS", "-1"), ("_DAYS", "nan"), ("_TABS", "0"), ("_ALL_MB", "1e9")):
        with pytest.raises(ProjectError, match="expected"):
            Settings.of({f"ROBOMILL_AUTOSAVE{name}": word})


def test_a_store_that_cannot_be_made_is_found_at_the_beginning_and_a_good_one_is_left_as_it_was(tmp_path: Path) -> None:
    for folder in (Path("/proc/robomill"), tmp_path / "file" / "work"):
        (tmp_path / "file").write_text("a file where a folder should be")
        with pytest.raises(StoreError, match="could not be kept on the server"):
            Shelf(Settings(folder=folder)).check()
    Shelf(Settings(folder=tmp_path / "work")).check()
    assert not (tmp_path / "work").exists()


def test_a_clock_set_a_year_ahead_and_back_makes_nothing_old(shelf: Shelf, monkeypatch: pytest.MonkeyPatch) -> None:
    put(shelf, "a = 1\n")
    real = time.time
    for years in (1, -1, 0):
        monkeypatch.setattr(time, "time", lambda years=years: real() + years * 365.25 * 86400)
        put(shelf, f"a = {years}\n", place=SECOND)
        shelf.sweep()
        assert shelf.get(KEY, TAB)[1] == ["a = 1\n"]
        assert shelf.get(KEY, SECOND)[1] == [f"a = {years}\n"]


def test_what_was_just_written_stays_where_the_clock_went_back_and_the_store_is_full(tmp_path: Path) -> None:
    shelf = Shelf(Settings(folder=tmp_path, all_MB=0.01))
    for k in range(4):
        put(shelf, "x" * 4000, place=f"tab-{k:016x}")
    later = time.time() + 86400
    for file in files(shelf):
        os.utime(file, (later, later))
    put(shelf, "y" * 4000, key=OTHER)
    assert shelf.get(OTHER, TAB)[1] == ["y" * 4000]
    assert sum(file.stat().st_size for file in files(shelf)) <= 10_000


def test_an_entry_larger_than_the_whole_store_is_refused_and_leaves_it_as_it_was(tmp_path: Path) -> None:
    shelf = Shelf(Settings(folder=tmp_path, all_MB=0.01))
    put(shelf)
    with pytest.raises(ProjectError, match=r"at most 0\.01 MB are kept"):
        put(shelf, "x" * 20_000, place=SECOND)
    assert shelf.get(KEY, TAB)[1] == ["a = 1\n"]


def keep_on_writing(shelf: Shelf, kept: Any) -> None:
    """Write one number after another, of 2 MB each, and tell those that are kept."""
    for number in count(1):
        put(shelf, f"a = {number}\n" * 200_000)
        kept.send(number)


@pytest.mark.skipif(sys.platform != "linux", reason="a process is forked to be killed")
def test_whatever_moment_its_writer_is_killed_at_the_last_work_that_was_kept_is_whole(shelf: Shelf) -> None:
    draw, fork = random.Random(9), multiprocessing.get_context("fork")
    for _ in range(12):
        told, kept = fork.Pipe(duplex=False)
        writer = fork.Process(target=keep_on_writing, args=(shelf, kept))
        writer.start()
        assert told.recv() == 1
        time.sleep(draw.uniform(0.0, 0.05))
        writer.kill()
        writer.join()
        last = 1
        while told.poll():
            last = told.recv()
        text = Shelf(shelf.settings).get(KEY, TAB)[1][0]
        number = int(text.split("\n")[0].removeprefix("a = "))
        assert number in (last, last + 1)
        assert text == f"a = {number}\n" * 200_000
