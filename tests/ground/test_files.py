"""Files are read up to a limit and written whole or not at all."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from robomill.errors import ProjectError, RobomillError
from robomill.files import (
    FileKind,
    check_folder_there,
    check_no_folder,
    check_size,
    read_file,
    shown_place,
    write_whole,
    written,
)

SMALL = FileKind("a few words", 1, smaller="; say less")
MB = 1_000_000


def test_a_file_is_read_up_to_its_limit(tmp_path: Path) -> None:
    file = tmp_path / "words"
    file.write_bytes(b"x" * MB)
    assert len(read_file(file, SMALL, ProjectError)) == MB
    with file.open("ab") as more:
        more.truncate(3 * MB)
    with pytest.raises(
        ProjectError, match=r"words: found 3[.]0 MB, expected a few words of at most 1 MB; say less[.]$"
    ):
        read_file(file, SMALL, ProjectError)
    with pytest.raises(ProjectError, match="^mine: found more than 1 MB"):
        check_size(MB + 1, SMALL, ProjectError, "mine")


def test_what_is_no_file_is_refused_unread_where_a_file_names_it(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for place in (tmp_path, tmp_path / "pipe", Path("/dev/zero"), Path("/dev/null")):
        with pytest.raises(ProjectError, match="a pipe or a device|Is a directory"):
            read_file(place, SMALL, ProjectError, regular=True)


def test_a_pipe_that_is_named_by_hand_is_read_and_an_endless_one_is_cut_off(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    writer = threading.Thread(target=lambda: (tmp_path / "pipe").write_bytes(b"words"))
    writer.start()
    assert read_file(tmp_path / "pipe", SMALL, ProjectError) == b"words"
    writer.join()
    with pytest.raises(ProjectError, match="/dev/zero: found more than 1 MB"):
        read_file("/dev/zero", SMALL, ProjectError)


@pytest.mark.parametrize("place", ["lost", ".", "a\0b", "x" * 5000])
def test_what_cannot_be_opened_is_named(place: str) -> None:
    with pytest.raises(ProjectError, match=r"cannot be opened \(.*\); expected a few words") as refused:
        read_file(place, SMALL, ProjectError)
    assert len(str(refused.value)) < 200
    assert shown_place(place)[-70:] in str(refused.value)
    with pytest.raises(ProjectError, match="^mine: cannot be opened"):
        read_file(place, SMALL, ProjectError, said="mine")


def test_a_file_is_put_in_place_when_it_is_complete(tmp_path: Path) -> None:
    target = tmp_path / "part.csv"
    target.write_text("old")
    with written(target, ProjectError) as place:
        place.write_text("new")
        assert place.suffix == ".csv"
        assert target.read_text() == "old"
    assert target.read_text() == "new"
    with pytest.raises(TypeError), written(target, ProjectError) as place:
        place.write_text(1)  # type: ignore[arg-type]
    assert target.read_text() == "new"
    assert os.listdir(tmp_path) == ["part.csv"]


def test_a_link_stays_a_link_and_a_device_is_written_to(tmp_path: Path) -> None:
    (tmp_path / "real").write_text("old")
    (tmp_path / "link").symlink_to(tmp_path / "real")
    with written(tmp_path / "link", ProjectError) as place:
        place.write_text("new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_text() == "new"
    with written("/dev/null", ProjectError) as place:
        place.write_text("nothing")


@pytest.mark.parametrize("target", ["no/such/folder/x.csv", ".", "a\0b"])
def test_a_place_that_cannot_be_written_is_named(target: str) -> None:
    with pytest.raises(ProjectError, match="cannot be written"), written(target, ProjectError) as place:
        place.write_text("x")


FULL = """
import resource, sys
from pathlib import Path
from robomill.cli import main
words, full = sys.argv[2:], sys.argv[1]
main([word.replace("OUT", full + "/..") for word in words])  # whatever is compiled is kept now
resource.setrlimit(resource.RLIMIT_FSIZE, (1_000, 1_000))
sys.exit(main([word.replace("OUT", full) for word in words]))
"""


@pytest.mark.parametrize(
    "words",
    [
        ["simulate", "samples/paper_flute", "--out", "OUT"],
        ["gcode", "samples/pocket_arcs/pocket.nc", "--moves", "OUT/out.jsonl"],
        ["map", "planar_2r", "--quantity", "C_yy", "--x=0:1500:10", "--y=0:900:10", "--z=0", "--out", "OUT/out.csv"],
    ],
    ids=lambda words: words[0],
)
def test_on_a_full_disk_nothing_cut_off_is_left(words: list[str], tmp_path: Path) -> None:
    """The limit of a file's size stands for a disk that is full: what stood there before stays."""
    old = {"machined.stl": "old part", "out.jsonl": "old moves", "out.csv": "old map", "result.json": "old result"}
    full = tmp_path / "full"
    full.mkdir()
    for name, text in old.items():
        (full / name).write_text(text)
    root = Path(__file__).resolve().parents[2]
    command = [sys.executable, "-c", FULL, str(full), *words]
    done = subprocess.run(command, capture_output=True, text=True, cwd=root, timeout=300)
    assert done.returncode == 2, done.stderr
    assert "cannot be written (File too large)" in done.stderr
    assert "Traceback" not in done.stderr
    assert {name: (full / name).read_text() for name in os.listdir(full)} == old


def test_a_file_is_written_whole_and_text_as_utf_8(tmp_path: Path) -> None:
    place = tmp_path / "a.txt"
    assert write_whole(place, "½ mm\n", RobomillError) == place
    assert place.read_bytes() == "½ mm\n".encode()
    write_whole(place, b"\x00\xff", RobomillError)
    assert place.read_bytes() == b"\x00\xff"
    with pytest.raises(RobomillError, match="cannot be written"):
        write_whole(tmp_path / "no" / "a.txt", "", RobomillError)
    assert [each.name for each in tmp_path.iterdir()] == ["a.txt"]


def test_a_folder_and_a_place_in_no_folder_are_refused_with_the_place_and_what_to_do(tmp_path: Path) -> None:
    check_no_folder(tmp_path / "a.txt", "here", RobomillError)
    check_folder_there(tmp_path / "a.txt", "here", RobomillError)
    with pytest.raises(RobomillError, match="^here: this is a folder; give the name of a file.$"):
        check_no_folder(tmp_path, "here", RobomillError)
    with pytest.raises(RobomillError, match="^here: the folder .*no is not there; make it first.$"):
        check_folder_there(tmp_path / "no" / "a.txt", "here", RobomillError)
