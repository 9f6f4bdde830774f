"""Rendering out of process: one long-lived worker, one picture at a time, a crash costs one second.

VTK without a usable OpenGL library ends its process without an exception, and it is not safe to use from several
threads. So pictures are drawn by a child process that is spoken to in pickles over its stdin and stdout. It draws a
small picture first and says when that worked: an end before it is the test for OpenGL, a later one has another reason.
Whoever waits for it waits in plain reads and writes, which every system has; time is up when an alarm ends the
process, and with it the wait. One worker, not two: a second takes half a gigabyte, and two drawing on two cores were
no faster than one (software OpenGL uses all cores by itself).
"""

import contextlib
import hashlib
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from robomill.errors import MissingExtraError, RenderError, RobomillError
from robomill.extras import missing
from robomill.viz.rendered import graphics

TIMEOUT_S = 40.0
NO_OPENGL = graphics.no_opengl()
NICE = 10  # by so much the drawing process gives way
FREE_DEATHS = 2  # in a row, after which the next attempt has to wait
LONGEST_PAUSE_S = 60.0
REMEMBERED = 64  # pictures that ended the process
OUT_OF_MEMORY = 12  # exit code of a drawing process that could not have the memory it asked for
LOADED, READY = "loaded", "ready"  # what the process says: libraries are in, a first picture is drawn
SIGKILL = 9  # Windows has no name for it
WINDOWS_FAULT = 0xC0000000  # exit codes from here on are faults there: memory that is not its own, a missing part ...


@dataclass
class Failures:
    """Deaths in a row of what is tried again, after a pause that grows with each. ``reason`` is that of the last."""

    deaths: int = 0
    reason: str = ""
    until: float = 0.0

    def note(self, reason: str) -> None:
        """One more."""
        self.deaths, self.reason = self.deaths + 1, reason
        over = self.deaths - FREE_DEATHS
        pause = min(2.0 ** min(over, 16), LONGEST_PAUSE_S) if over >= 0 else 0.0
        self.until = time.monotonic() + pause

    @property
    def left_s(self) -> float:
        """Seconds until the next attempt."""
        return max(0.0, self.until - time.monotonic())

    def refusal(self) -> RenderError:
        """What is said while the pause lasts."""
        again = max(self.left_s, 0.1)
        return RenderError(f"{self.reason} It is tried again in {again:.0f} s.", again_s=again)


class RenderWorker:
    """A handle on the drawing process. Calls from several threads wait for each other.

    ``render(picture)`` returns PNG bytes (``picture`` is a dataclass of ``scene.py``). A process that ends is started
    again, at once or, after repeated deaths, with growing pauses: of starting it, and of each picture that ended it,
    so that one picture keeps no other waiting. Raises RenderError with the true reason and when to ask again.
    """

    def __init__(self, timeout_s: float = TIMEOUT_S, command: tuple[str, ...] | None = None) -> None:
        self._timeout_s = timeout_s
        self._command = command or (sys.executable, "-m", "robomill.viz.rendered.worker")
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._said: IO[bytes] | None = None  # what the process writes to stderr
        self._stage, self._killed = "", 0
        self._starts = Failures()
        self._pictures: dict[bytes, Failures] = {}

    @property
    def down(self) -> bool:
        """True when the last attempts to start the process failed."""
        return self._starts.deaths >= FREE_DEATHS

    @property
    def refusal(self) -> RobomillError | None:
        """Why nothing can be drawn just now; None where a picture may be asked for."""
        return absent() or (self._starts.refusal() if self._starts.left_s > 0.0 else None)

    def render(self, picture: Any) -> bytes:
        """PNG bytes of ``picture``; where the process ends, a second attempt is made at once."""
        refusal = absent()
        if refusal is not None:
            raise refusal
        message = pickle.dumps(picture, protocol=5)
        name = hashlib.blake2b(message).digest()
        while True:
            with self._lock:
                failures = self._pictures.get(name, Failures())
                for each in (self._starts, failures):
                    if each.left_s > 0.0:
                        raise each.refusal()
                answer = self._attempt(message, failures)
                if answer is None:
                    self._pictures.pop(name, None)
                    self._pictures[name] = failures
                    self._pictures = dict(list(self._pictures.items())[-REMEMBERED:])
                    continue
                self._pictures.pop(name, None)
            kind, value = answer
            if kind == "png":
                return bytes(value)
            raise RenderError(f"Picture: {value}")

    def _attempt(self, message: bytes, failures: Failures) -> tuple[str, Any] | None:
        """The answer of the process, or None where it ended and ``failures``, or those of its start, say why."""
        late = threading.Event()
        try:
            process = self._running()
            with _ended_in(process, self._timeout_s, late):
                answer = self._exchange(process, message)
        except (OSError, EOFError, pickle.UnpicklingError):  # it is not there, or its end cut a message off
            slow = f"drawing took longer than {self._timeout_s:g} s and was stopped"
            reason = slow if late.is_set() else self._why_ended()
            if self._stage == READY:
                failures.note(f"Picture: {reason}.")
                if late.is_set():
                    failures.note(f"Picture: {reason}.")  # no second attempt at once: it would take as long again
            else:
                self._starts.note(reason if reason == NO_OPENGL else f"Pictures: {reason}.")
            self._stop()
            return None
        return answer

    def start(self) -> None:
        """Start the process without waiting for it, so that the first picture comes sooner."""
        if not self._lock.acquire(blocking=False):
            return  # someone is being served, so it is up
        try:
            if self._process is None and self.refusal is None:
                with contextlib.suppress(OSError):
                    self._start()
        finally:
            self._lock.release()

    def close(self) -> None:
        """Stop the process; the next call starts it again."""
        with self._lock:
            self._stop()

    def _running(self) -> subprocess.Popen[bytes]:
        """The process, started if there is none. Raises OSError where that fails."""
        if self._process is not None and self._process.poll() is not None and self._stage == READY:
            self._stop()  # ended while nobody asked for anything
        return self._process or self._start()

    def _exchange(self, process: subprocess.Popen[bytes], message: bytes) -> tuple[str, Any]:
        """What the process answers, once it is ready. Raises OSError, EOFError or UnpicklingError where it ends."""
        stdin, stdout = _pipes(process)
        while self._stage != READY:
            self._stage = pickle.load(stdout)[0]
        self._starts = Failures()
        stdin.write(message)
        stdin.flush()
        kind, value = pickle.load(stdout)
        return kind, value

    def _start(self) -> subprocess.Popen[bytes]:
        self._stage, self._killed = "", _ended_for_memory()
        self._said = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the process
        self._process = subprocess.Popen(
            self._command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._said,
            env={**os.environ, **graphics.environment()},
        )
        return self._process

    def _stop(self) -> None:
        process, self._process = self._process, None
        said, self._said = self._said, None
        if said is not None:
            said.close()
        if process is None:
            return
        process.kill()
        process.wait()
        for pipe in _pipes(process):
            with contextlib.suppress(OSError):
                pipe.close()

    def _why_ended(self) -> str:
        """Why the process ended, in words."""
        if self._process is None:
            return "the drawing process could not be started"
        try:
            code = self._process.wait(timeout=5.0)
        except subprocess.TimeoutExpired:
            return "the drawing process closed its pipe"
        if code == OUT_OF_MEMORY:
            return "the drawing process ran out of memory"
        graphic = self._stage == LOADED  # its first picture is what tries the graphics library
        if code >= WINDOWS_FAULT:
            return NO_OPENGL if graphic else f"the drawing process crashed (code {code:#x}){self._last_words()}"
        if code >= 0:
            return f"the drawing process ended with code {code}{self._last_words()}"
        if -code == SIGKILL:
            if _ended_for_memory() > self._killed:
                return "the drawing process ran out of memory and was killed by the system (signal 9)"
            return "the drawing process was killed (signal 9)"
        if graphic and -code in (signal.SIGSEGV, signal.SIGABRT):
            return NO_OPENGL
        name = signal.Signals(-code).name if -code in set(signal.Signals) else "unknown"
        return f"the drawing process crashed (signal {-code}, {name}){self._last_words()}"

    def _last_words(self) -> str:
        if self._said is None:
            return ""
        end = self._said.seek(0, os.SEEK_END)
        self._said.seek(max(0, end - 2000))
        lines = self._said.read().decode(errors="replace").strip().splitlines()
        return f": {lines[-1].strip():.160}" if lines else ""


def absent() -> MissingExtraError | None:
    """Why nothing can be drawn where the extra is not installed."""
    return missing("A rendered picture", "render", "pyvista", "matplotlib", "PIL")


def _ended_for_memory() -> int:
    """How many processes the system has ended since it was short of memory, as far as it says so."""
    count = 0
    for file in (Path("/proc/vmstat"), Path("/sys/fs/cgroup/memory.events")):
        with contextlib.suppress(OSError, ValueError):
            words = dict(line.split() for line in file.read_text().splitlines())
            count += int(words.get("oom_kill", 0))
    return count


def _pipes(process: subprocess.Popen[bytes]) -> tuple[IO[bytes], IO[bytes]]:
    """What it reads, and what it writes."""
    assert process.stdin is not None and process.stdout is not None  # noqa: PT018 - both were asked for
    return process.stdin, process.stdout


@contextlib.contextmanager
def _ended_in(process: subprocess.Popen[bytes], seconds: float, late: threading.Event) -> Iterator[None]:
    """End the process after so many seconds, unless what is done with it is done by then; ``late`` says that it was."""

    def end() -> None:
        late.set()
        process.kill()

    alarm = threading.Timer(seconds, end)
    alarm.daemon = True
    alarm.start()
    try:
        yield
    finally:
        alarm.cancel()


def main() -> None:
    """The worker's loop: draw a first picture, then read one, draw it, answer with PNG bytes or with a sentence."""
    # The pipe is taken away from file descriptor 1, so that whatever VTK prints cannot break a message.
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)

    def say(kind: str, value: Any = None) -> None:
        pickle.dump((kind, value), out, protocol=5)
        out.flush()

    with contextlib.suppress(AttributeError, OSError):  # pages go first: they are complete before their pictures come
        os.nice(NICE)
    from robomill.viz.rendered import scene

    scene.load()
    say(LOADED)
    scene.first()
    say(READY)
    try:
        with contextlib.suppress(EOFError):  # whoever asked is gone
            while True:
                say(*_answer(pickle.load(sys.stdin.buffer)))
    except MemoryError:
        os._exit(OUT_OF_MEMORY)


def _answer(picture: Any) -> tuple[str, Any]:
    """PNG bytes, or what went wrong: a drawing error is answered, it must not end the loop."""
    from robomill.viz.rendered import scene

    try:
        return "png", scene.draw(picture)
    except MemoryError:
        raise
    except Exception as exc:
        return "error", f"{type(exc).__name__}: {exc}"


if __name__ == "__main__":
    main()
