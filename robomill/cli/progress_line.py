"""How far long work has come, on one line of a terminal that is taken away at the end."""

import time
from typing import TextIO

from robomill.progress import Progress
from robomill.units import format_percent

FIRST_S, EACH_S = 0.5, 0.2  # nothing is said of what is done sooner


class ProgressLine:
    """A line on ``stream``, if that is a terminal; elsewhere only what is announced is said, on a line of its own."""

    def __init__(self, stream: TextIO | None) -> None:
        self._log = stream
        self._stream = stream if stream is not None and stream.isatty() else None
        self._next = time.monotonic() + FIRST_S
        self._shown = 0

    def announce(self, words: str) -> None:
        """Say at once what is about to take long."""
        if self._stream is None and self._log is not None:
            print(f"{words} ...", file=self._log, flush=True)
        self._put(f"{words} ...")

    def say(self, now: Progress) -> None:
        """Show the stage and its share, at most some times a second."""
        if time.monotonic() >= self._next:
            self._next = time.monotonic() + EACH_S
            beside = f", {now.beside}" if now.beside else ""
            self._put(f"{now.stage}: {format_percent(now.share)}{beside}")

    def _put(self, text: str) -> None:
        if self._stream is not None:
            self._stream.write(f"\r{text:<{self._shown}}")
            self._stream.flush()
            self._shown = len(text)

    def clear(self) -> None:
        """Take the line away."""
        if self._shown:
            self._put("")
            print(end="\r", file=self._stream, flush=True)
            self._shown = 0
