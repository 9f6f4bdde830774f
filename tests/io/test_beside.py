"""Every key of every file that names another file: what may be named, and that nothing else is even looked for."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from robomill.errors import ProjectError, RobomillError
from robomill.files import TABLE
from robomill.io import beside
from robomill.io.beside import ALONE, Beside
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup, setup_from_toml
from robomill.io.tables import Table
from robomill.simulation.setup import SimulationSetup
from robomill.ui.project import project_from_toml

TEXT = (samples_dir() / "paper_flute" / "setup.toml").read_text()
PROGRAM = "G21 F600\nG1 X1\nG1 X2\n"
ROW = (samples_dir() / "materials" / "al7075_carbide_ref47.toml").read_text()
RECORD = "t_s,F_feed_N\n" + "".join(f"{k},{50 + k}\n" for k in range(20))
STL = (
    "solid s\n"
    + "".join(
        "facet normal 0 0 1\nouter loop\n" + "".join(f"vertex {p}\n" for p in face) + "endloop\nendfacet\n"
        for face in (
            ("0 0 0", "0 90 0", "90 0 0"),
            ("0 0 0", "90 0 0", "0 0 90"),
            ("0 0 0", "0 0 90", "0 90 0"),
            ("90 0 0", "0 90 0", "0 0 90"),
        )
    )
    + "endsolid s\n"
)


def _of(block: str, lines: str) -> str:
    """The sample with one table replaced."""
    head, found, rest = TEXT.partition(f"[{block}]\n")
    assert found
    return head + f"[{block}]\n{lines}\n\n[" + rest.partition("\n[")[2]


# Each key that may name a file: the set-up with %s for the name, what a good file holds, and how it ends.
KEYS = {
    "path.program": (_of("path", 'program = "%s"'), PROGRAM, ".nc"),
    "robot.name": (_of("robot", 'name = "%s"'), (samples_dir() / "robots/slavkovic_5r.toml").read_text(), ".toml"),
    "stock.stl": (_of("stock", 'stl = "%s"'), STL, ".stl"),
    "force.material": (_of("force", 'kind = "mechanistic"\nmaterial = "%s"'), ROW, ".toml"),
    "force.file": (_of("force", 'kind = "measured"\nfile = "%s"'), RECORD, ".csv"),
    "measured_map.file": (
        TEXT + '\n[measured_map]\nfile = "%s"\n',
        (samples_dir() / "load_tests" / "nine_points_compliances.csv").read_text(),
        ".csv",
    ),
    "tools": ('tools = "%s"\n' + TEXT, "T1 P1 D3.0 Z12.5\n", ".tbl"),
}
HOSTILE = [
    "/etc/passwd",
    "/proc/self/environ",
    "/dev/zero",
    "/dev/stdin",
    "../../../../../../../etc/passwd",
    "sub/../../secret",
    "~/.bashrc",
    "~root/.bashrc",
    "file:///etc/passwd",
    "https://example.org/x",
    r"\\\\server\\share\\x",
    "C:/Windows/win.ini",
    "CON",
    "a\\u0000b",
    "x" * 5000,
    "",
    ".",
    "..",
]


def setup_text(key: str, name: str) -> str:
    text, _, end = KEYS[key]
    if key != "path.program":
        text = text.replace('program = "path.nc"', 'program_text = "G21 F600\\nG1 X1\\nG1 X2"')
    return text.replace("%s", name)


def read(key: str, name: str, where: Beside = ALONE) -> SimulationSetup:
    return setup_from_toml(setup_text(key, name), "setup.toml", where)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a good file for each key, and a secret beside the folder."""
    own = tmp_path / "own"
    (own / "below").mkdir(parents=True)
    for key, (_, good, end) in KEYS.items():
        (own / f"{key}{end}").write_text(good)
        (own / "below" / f"{key}{end}").write_text(good)
        (tmp_path / f"{key}{end}").write_text(good)
        (own / f"link-{key}{end}").symlink_to(tmp_path / f"{key}{end}")
    (tmp_path / "secret").write_text("nobody's business\n")
    return own


@pytest.mark.parametrize("key", KEYS)
def test_own_files_are_read_and_no_others(key: str, folder: Path) -> None:
    end, here = KEYS[key][2], Beside(folder)
    for name in (f"{key}{end}", f"below/{key}{end}", f"below/../{key}{end}", str(folder / f"{key}{end}")):
        assert read(key, name, here).name
    for name in (f"../{key}{end}", f"link-{key}{end}", str(folder.parent / f"{key}{end}")):
        with pytest.raises(ProjectError, match="not in the folder of the set-up nor below it.*--allow-outside"):
            read(key, name, here)
        assert read(key, name, Beside(folder, outside=True)).name
    with pytest.raises(ProjectError, match="cannot be opened"):
        read(key, f"lost{end}", here)


@pytest.mark.parametrize("key", KEYS)
@pytest.mark.parametrize("name", HOSTILE, ids=lambda name: name[:20] or "nothing")
def test_hostile_names_are_refused_on_the_command_line(key: str, name: str, folder: Path) -> None:
    with pytest.raises(ProjectError) as refused:
        read(key, name, Beside(folder))
    assert "root:" not in str(refused.value)
    assert len(str(refused.value)) < 500


@pytest.mark.parametrize("key", KEYS)
def test_a_name_as_windows_writes_it_is_read_everywhere(key: str, folder: Path) -> None:
    end, here = KEYS[key][2], Beside(folder)
    assert read(key, rf"below\\{key}{end}", here).name
    with pytest.raises(ProjectError, match="not in the folder of the set-up|cannot be opened"):
        read(key, rf"..\\{key}{end}", here)
    with pytest.raises(ProjectError, match=r"is no name of a file\. A path is written with / or in single quotes"):
        read(key, rf"below\table{end}", here)  # a tab, as TOML reads it


@pytest.mark.parametrize("key", KEYS)
def test_a_pipe_a_device_and_a_folder_are_no_files(key: str, folder: Path) -> None:
    end = KEYS[key][2]
    os.mkfifo(folder / f"pipe{end}")
    (folder / f"endless{end}").symlink_to("/dev/zero")
    (folder / f"folder{end}").mkdir()
    for name in (f"pipe{end}", f"folder{end}"):
        with pytest.raises(ProjectError, match="a pipe or a device|Is a directory"):
            read(key, name, Beside(folder))
    with pytest.raises(ProjectError, match="a pipe or a device|Is a directory"):
        read(key, f"endless{end}", Beside(folder, outside=True))


@pytest.mark.parametrize("key", KEYS)
def test_what_comes_through_a_browser_names_no_file(key: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same sentence whether the file is there or not, and nothing on the disk is asked."""
    end = KEYS[key][2]
    there, lost = str(folder / f"{key}{end}"), str(folder / f"{'x' * len(key)}{end}")
    read(key, there, Beside(folder))  # whatever is loaded late is loaded now

    def watched(asked: Callable[..., object]) -> Callable[..., object]:
        def ask(*given: object, **more: object) -> object:
            assert str(folder) not in str(given), "a file was looked for"
            return asked(*given, **more)

        return ask

    for owner, asks in ((os, ("stat", "lstat", "open", "readlink", "scandir")), (os.path, ("realpath", "abspath"))):
        for name in asks:
            monkeypatch.setattr(owner, name, watched(getattr(owner, name)))
    monkeypatch.setattr(beside, "read_file", watched(beside.read_file))
    said = []
    for name in (there, lost):
        with pytest.raises(RobomillError) as refused:
            read(key, name)
        said.append(str(refused.value).replace(name[:60], "NAME").replace(name[:80], "NAME"))
    assert said[0] == said[1]
    assert "names no files" in said[0]


@pytest.mark.parametrize("key", KEYS)
@pytest.mark.parametrize("name", HOSTILE, ids=lambda name: name[:20] or "nothing")
def test_hostile_names_are_refused_in_the_browser(key: str, name: str) -> None:
    with pytest.raises(ProjectError) as refused:
        project_from_toml(setup_text(key, name))
    assert "root:" not in str(refused.value)
    assert "No such file" not in str(refused.value)


def test_robots_and_materials_are_names_in_the_browser() -> None:
    for key, name in (("robot.name", "kuka_kr270/../kuka_kr270"), ("force.material", "../robots/kuka_kr270")):
        with pytest.raises(ProjectError, match=r"is not known|there is no robot|names no files"):
            read(key, name)


def test_samples_are_everybodys(tmp_path: Path) -> None:
    """A sample names files of another sample, and a set-up elsewhere may name theirs."""
    assert load_setup(samples_dir() / "paper_flute" / "setup_measured_map.toml").measured_map is not None
    table = Table({"file": str(samples_dir() / "load_tests" / "grid_45x6.csv")}, "[measured_map]")
    assert Beside(tmp_path).read(table, "file", TABLE)[1] == "grid_45x6.csv"


def test_a_set_up_is_read_by_its_path_with_or_without_what_lies_outside(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "part.nc").write_text(PROGRAM)
    (tmp_path / "a" / "setup.toml").write_text(TEXT.replace("path.nc", "../part.nc"))
    with pytest.raises(ProjectError, match="allow-outside"):
        load_setup(tmp_path / "a")
    assert load_setup(tmp_path / "a", allow_outside=True).source.text == PROGRAM
