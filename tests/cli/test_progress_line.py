"""What long work says of itself: a line on a terminal, and elsewhere what would else be minutes of silence."""

from __future__ import annotations

import io

import pytest

from robomill.cli.progress_line import ProgressLine
from robomill.progress import Progress


def test_what_takes_minutes_is_announced_in_a_log_too() -> None:
    """A course's server redirects standard error; shares of the way would fill its log."""
    log = io.StringIO()
    line = ProgressLine(log)
    line.announce("Compiling once")
    line.say(Progress(stage="Cut", share=0.5))
    line.clear()
    assert log.getvalue() == "Compiling once ...\n"


def test_without_standard_error_nothing_is_said(capfd: pytest.CaptureFixture[str]) -> None:
    line = ProgressLine(None)
    line.announce("Compiling once")
    line.say(Progress(stage="Cut", share=0.5))
    line.clear()
    assert capfd.readouterr() == ("", "")
