"""The app served from the command line: on this machine, for others, and what its settings reach."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from robomill.cli import main, serve
from robomill.ui.keeping.settings import Settings


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ((), ["--server.address=127.0.0.1", "--browser.gatherUsageStats=false"]),
        (
            ("--server.port", "9"),
            ["--server.address=127.0.0.1", "--browser.gatherUsageStats=false", "--server.port", "9"],
        ),
        (("--server.address=0.0.0.0",), ["--browser.gatherUsageStats=false", "--server.address=0.0.0.0"]),
    ],
)
def test_without_a_verb_the_app_is_served_on_this_machine_only(monkeypatch, words, expected) -> None:
    called = []
    monkeypatch.setattr(subprocess, "call", lambda command: called.append(command) or 7)
    assert main(list(words)) == 7
    (command,) = called
    assert command[:4] == [sys.executable, "-m", "streamlit", "run"]
    assert Path(command[4]).name == "app.py"
    assert Path(command[4]).is_file()
    assert command[5:] == expected


def test_an_interrupted_app_exits_with_130(monkeypatch) -> None:
    def interrupted(command: list[str]) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr(subprocess, "call", interrupted)
    assert main([]) == 130


@pytest.fixture
def served(monkeypatch) -> list[tuple[list[str], dict[str, str]]]:
    """What ``robomill serve`` would have become."""
    became: list[tuple[list[str], dict[str, str]]] = []
    monkeypatch.setattr(serve, "_become", lambda command, environment: became.append((command, environment)) or 0)
    monkeypatch.setattr(serve, "_can_listen", lambda address, port: None)
    return became


def test_a_server_that_cannot_listen_says_so_in_a_sentence(capsys) -> None:
    """An address that is none, one of another machine (for documentation, by RFC 5737), and a port that is taken."""
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        for words in ("--address nohost.invalid", "--address 192.0.2.1", f"--port {port}"):
            assert main(["serve", *words.split()]) == 2
            said = capsys.readouterr().err
            assert said.startswith("robomill: --address ")
            assert said.count("\n") == 1


def test_a_server_for_others_shows_no_code_and_listens_on_this_machine_unless_told(served) -> None:
    assert main(["serve"]) == 0
    ((command, environment),) = served
    options = dict(word.split("=", 1) for word in command[5:])
    assert options["--server.address"] == "127.0.0.1"
    assert options["--client.showErrorDetails"] == "none"
    assert options["--server.enableXsrfProtection"] == options["--server.enableCORS"] == "true"
    assert options["--browser.gatherUsageStats"] == "false"
    assert Settings.of(environment) == Settings.of(dict(os.environ))


def test_a_folder_that_cannot_be_written_is_said_before_anything_is_served(served, capsys) -> None:
    assert main(["serve", "--autosave-folder", "/proc/robomill"]) == 0
    assert "nothing can be kept in /proc/robomill; every page says so" in capsys.readouterr().err
    assert main(["serve", "--autosave", "off", "--autosave-folder", "/proc/robomill"]) == 0
    assert capsys.readouterr().err == ""
    assert len(served) == 2


def test_a_server_keeps_few_heaps_unless_its_owner_says_otherwise(served, monkeypatch) -> None:
    monkeypatch.setenv("MALLOC_ARENA_MAX", "7")
    assert main(["serve"]) == 0
    ((_, environment),) = served
    assert environment["MALLOC_ARENA_MAX"] == "7"
    assert environment["MALLOC_MMAP_THRESHOLD_"] == "1048576"


def test_every_setting_of_a_server_reaches_it(served) -> None:
    said = "--address 0.0.0.0 --port 80 --host-name robomill.example.org --base-path /robomill/ --max-upload-mb 5"
    kept = "--autosave off --autosave-folder /srv/work --autosave-mb 50 --autosave-days 7"
    assert main(["serve", *said.split(), *kept.split()]) == 0
    ((command, environment),) = served
    for word in (
        "--server.address=0.0.0.0",
        "--server.port=80",
        "--browser.serverAddress=robomill.example.org",
        "--server.baseUrlPath=robomill",
        "--server.maxUploadSize=5",
    ):
        assert word in command
    settings = Settings.of(environment)
    assert (settings.on, settings.folder, settings.all_MB, settings.days) == (False, Path("/srv/work"), 50.0, 7.0)


@pytest.mark.parametrize(
    "words", ["--port 0", "--port 1e3", "--max-upload-mb -1", "--autosave-days never", "--autosave-mb 0"]
)
def test_a_setting_that_cannot_be_is_refused_before_anything_is_served(served, capsys, words) -> None:
    try:
        code = main(["serve", *words.split()])
    except SystemExit as left:  # argparse's own refusal
        code = left.code
    assert code == 2
    assert "expected" in capsys.readouterr().err
    assert served == []
