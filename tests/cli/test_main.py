"""The process of the command line: interrupts, crashes, code pages, pipes."""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import TextIO

import pytest

from robomill import __main__, cli, console
from robomill.errors import RobomillError
from robomill.progress import checkpoint

POSE = ["pose", "slavkovic_5r", "--theta-deg", "0,0,0,0,0"]


@pytest.fixture(autouse=True)
def signals() -> Iterator[None]:
    """The signal handlers of the tests' own process come back."""
    before = signal.getsignal(signal.SIGINT)
    yield
    signal.signal(signal.SIGINT, before)


def started(*words: str, **more) -> subprocess.Popen:
    environment = {**os.environ, **more.pop("env", {})}
    command = [sys.executable, *more.pop("python", ()), "-m", "robomill", *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment, **more)


class Interrupted(ModuleType):
    """A module during whose loading somebody presses Ctrl-C."""

    def __getattr__(self, name: str) -> None:
        raise KeyboardInterrupt


def test_an_interrupt_while_it_loads_has_the_exit_code_of_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "robomill.cli", Interrupted("robomill.cli"))
    assert __main__.main() == 130


def test_ctrl_c_in_the_midst_of_an_import_ends_it_quietly() -> None:
    process = started("simulate", "paper_flute", python=("-X", "importtime"))
    assert process.stderr is not None
    said = b""
    while b"numpy.linalg" not in said:
        said += process.stderr.readline()
    process.send_signal(signal.SIGINT)
    out, rest = process.communicate(timeout=30)
    assert process.returncode == 130
    assert b"Traceback" not in rest
    assert out == b""


def test_an_interrupt_that_a_library_makes_something_else_of_stays_one(monkeypatch, capsys) -> None:
    def run(words: list[str]) -> int:
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            raise ImportError("half a module") from None
        return 0

    monkeypatch.setattr(cli, "main", run)
    assert __main__.main() == 130
    assert capsys.readouterr().err == ""


def test_an_interrupt_that_gets_lost_ends_the_work_at_its_next_step(monkeypatch, capsys) -> None:
    """Python drops what is raised while it clears away: here, in a finalizer."""

    class Gone:
        def __del__(self) -> None:
            signal.raise_signal(signal.SIGINT)

    def run(arguments: object) -> int:
        Gone()
        checkpoint()
        pytest.fail("the work went on")

    monkeypatch.setattr("sys.unraisablehook", lambda lost: None)
    monkeypatch.setattr("robomill.cli.verbs.run_robots", run)
    monkeypatch.setattr(sys, "argv", ["robomill", "robots"])
    assert __main__.main() == 130
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("error", [ZeroDivisionError("no"), MemoryError(), RecursionError("deep")])
def test_a_crash_is_a_sentence_and_its_details_are_in_a_file(error, monkeypatch, capsys, tmp_path: Path) -> None:
    def run(words: list[str]) -> int:
        raise error

    monkeypatch.setattr(cli, "main", run)
    monkeypatch.setattr(sys, "argv", ["robomill", "robots"])
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.delenv("ROBOMILL_DEBUG", raising=False)
    assert __main__.main() == 70
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "Traceback" not in said
    (details,) = tmp_path.iterdir()
    assert str(details) in said
    assert "Traceback" in details.read_text()
    assert "['robomill', 'robots']" in details.read_text()


def test_the_traceback_of_a_crash_is_shown_to_whoever_asks(monkeypatch, capsys, tmp_path: Path) -> None:
    seen = []

    def run(words: list[str]) -> int:
        seen.append(words)
        raise ZeroDivisionError

    monkeypatch.setattr(cli, "main", run)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr(sys, "argv", ["robomill", "--debug", "robots"])
    assert __main__.main() == 70
    monkeypatch.setattr(sys, "argv", ["robomill", "robots"])
    monkeypatch.setenv("ROBOMILL_DEBUG", "1")
    assert __main__.main() == 70
    assert capsys.readouterr().err.count("Traceback") == 2
    assert seen == [["robots"], ["robots"]]
    assert not list(tmp_path.iterdir())


def test_help_and_refusals_of_the_parser_keep_their_codes(monkeypatch, capsys) -> None:
    for words, code in ((["--help"], 0), (["simulate"], 2), (["mill"], 2), (["--version"], 0)):
        monkeypatch.setattr(sys, "argv", ["robomill", *words])
        assert __main__.main() == code
    capsys.readouterr()


def test_a_redirected_console_of_any_code_page_gets_its_text(tmp_path: Path) -> None:
    """What a Windows console's redirection does: the code page of the machine, strictly."""
    file = tmp_path / "Fräse θ \x1b[31m.nc"
    processes = [started(*POSE, env={"PYTHONIOENCODING": page}) for page in ("ascii:strict", "cp1252")]
    c = {"PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "LC_ALL": "C", "LANG": "C"}
    processes.append(started("gcode", str(file), env=c))
    outs = [process.communicate(timeout=60) for process in processes]
    assert [process.returncode for process in processes] == [0, 0, 2]
    for (out, err), unit in zip(outs, (b"m^3", "m³".encode("cp1252")), strict=False):
        assert err == b""
        assert b"det(J)  1.4762 " + unit in out
    refusal = outs[-1][1].decode("ascii")
    assert refusal.startswith("robomill: ")
    assert "\\x1b[31m.nc: cannot be opened" in refusal
    assert refusal.count("\n") == 1


def test_whoever_reads_no_further_hears_nothing_and_the_code_stays() -> None:
    words = [
        "map",
        "slavkovic_5r",
        "--quantity",
        "C_yy",
        "--z",
        "0",
        "--x",
        "-600:600:10",
        "--y",
        "-1600:-1000:5",
        "--json",
    ]
    process = started(*words)
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.read(1)
    process.stdout.close()
    assert process.stderr.read() == b""
    process.stderr.close()
    assert process.wait(60) == 0


def test_a_place_that_cannot_be_written_to_is_a_sentence() -> None:
    with open("/dev/full", "w") as full:
        command = [sys.executable, "-m", "robomill", "robots"]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, timeout=60, check=False)
    assert done.returncode == 2
    assert done.stderr == (
        "robomill: standard output: cannot be written (No space left on device); give it another place.\n"
    )


@pytest.mark.skipif(sys.platform == "win32", reason="no shell that closes a stream")
def test_a_closed_standard_output_is_a_sentence_and_no_success() -> None:
    """Python has no stream at all then, and what is written to none would be lost without a word."""
    for words, shell in (("robots", ">&-"), ("pose slavkovic_5r --theta-deg 0,0,0,0,0 --json", ">&-")):
        command = f"{shlex.quote(sys.executable)} -m robomill {words} {shell}"
        done = subprocess.run(["sh", "-c", command], capture_output=True, text=True, timeout=60, check=False)
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr == "robomill: standard output: it is closed, so nothing can be written; give it a place.\n"
    done = subprocess.run(["sh", "-c", f"{command} 2>&-"], timeout=60, check=False)
    assert done.returncode == 2


def test_a_refusal_that_nobody_can_hear_keeps_its_code() -> None:
    with open("/dev/full", "w") as full:
        command = [sys.executable, "-m", "robomill", "pose", "nobody", "--theta-deg", "0"]
        done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=full, timeout=60, check=False)
    assert done.returncode == 2


def test_a_refusal_while_the_last_words_go_out_is_said(monkeypatch, capsys) -> None:
    put = console.put

    def full(text: str, stream: TextIO | None) -> None:
        if stream is sys.stdout:
            raise RobomillError("the disk is full.")
        put(text, stream)

    monkeypatch.setattr(console, "put", full)
    monkeypatch.setattr(sys, "argv", ["robomill", "--version"])
    assert __main__.main() == 2
    assert "the disk is full" in capsys.readouterr().err
