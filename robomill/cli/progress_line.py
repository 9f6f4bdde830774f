"""How far long work has come, on one line of a terminal that is taken away at the end."""

import time
from typing import TextIO

from robomill.progress import Progress
from robomill.units import format_percent

FIRST_S, EACH_S = 0.5, 0.2  # nothing is said of what is done sooner


class ProgressLine:
    """A line on ``stream``, if that is a terminal."""

    def __init__(self, stream: TextIO) -> None:
        self._stream, self._next = stream, time.monotonic() + FIRST_S
        self._shown = 0

    def say(self, now: Progress) -> None:
        """Show the stage and its share, at most some times a second."""
        if time.monotonic() < self._next or not self._stream.isatty():
            return
        self._next = time.monotonic() + EACH_S
        text = f"{now.stage}: {format_percent(now.share)}"
        self._stream.write(f"\r{text:<{self._shown}}")
        self._stream.flush()
        self._shown = len(text)

    def clear(self) -> None:
        """Take the line away."""
        if self._shown:
            self._stream.write(f"\r{'':<{self._shown}}\r")
            self._stream.flush()
            self._shown = 0
