"""Rendering out of process: one long-lived worker, one picture at a time, a crash costs one second.

VTK without a usable OpenGL library ends its process without an exception, and it is not safe to use from several
threads. So pictures are drawn by a child process that is spoken to over its stdin and stdout in length-prefixed
messages; it is killed when it takes too long and started again on the next call.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import select
import struct
import subprocess
import sys
import threading
import time
from typing import IO, Any

from robomill.errors import RenderError

TIMEOUT_S = 40.0
MEND = "apt-get install -y libegl1 libgl1-mesa-dri"
_LENGTH = struct.Struct("<Q")


class RenderWorker:
    """A handle on the drawing process. Calls from several threads wait for each other.

    ``render(picture)`` returns PNG bytes (``picture`` is a dataclass of ``scene.py``). Raises RenderError with a
    sentence and the command that mends it; after two deaths in a row the worker stays down.
    """

    def __init__(self, timeout_s: float = TIMEOUT_S, command: tuple[str, ...] | None = None) -> None:
        self._timeout_s = timeout_s
        self._command = command or (sys.executable, "-m", "robomill.viz.worker")
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._deaths = 0

    @property
    def down(self) -> bool:
        """True when the last two attempts ended the process: this machine cannot draw."""
        return self._deaths >= 2

    def render(self, picture: Any) -> bytes:
        """PNG bytes of ``picture``; one restart is tried before giving up."""
        message = pickle.dumps(picture, protocol=5)
        with self._lock:
            while not self.down:
                try:
                    answer = self._ask(message)
                except (OSError, EOFError, TimeoutError) as exc:
                    self._deaths += 1
                    reason = str(exc) or type(exc).__name__
                    self._stop()
                    if isinstance(exc, TimeoutError):
                        raise RenderError(f"Picture: {reason}; the drawing process was stopped. Try again.") from exc
                    continue
                self._deaths = 0
                kind, value = answer
                if kind == "png":
                    return bytes(value)
                raise RenderError(f"Picture: {value}")
        raise RenderError(
            f"Rendered pictures need an OpenGL library that this machine lacks; as root, run: {MEND}. "
            "Everything else works without it."
        )

    def start(self) -> None:
        """Start the process without waiting for it, so that the first picture comes sooner."""
        with self._lock:
            if self._process is None and not self.down:
                with contextlib.suppress(OSError):
                    self._process = self._start()

    def close(self) -> None:
        """Stop the process; the next call starts it again."""
        with self._lock:
            self._stop()

    def _ask(self, message: bytes) -> tuple[str, Any]:
        if self._process is None or self._process.poll() is not None:
            self._process = self._start()
        stdin, stdout = self._process.stdin, self._process.stdout
        assert stdin is not None
        assert stdout is not None
        deadline = time.monotonic() + self._timeout_s
        write_message(stdin, message)
        return pickle.loads(_read_until(stdout, deadline, self._timeout_s))

    def _start(self) -> subprocess.Popen[bytes]:
        # EGL first, software as its fallback; VTK's own choice would go through X11 and end the process.
        environment = {**os.environ, "VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow", "PYVISTA_OFF_SCREEN": "true"}
        return subprocess.Popen(
            self._command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=environment,
            bufsize=0,
        )

    def _stop(self) -> None:
        process, self._process = self._process, None
        if process is None:
            return
        process.kill()
        process.wait()
        for pipe in (process.stdin, process.stdout):
            if pipe is not None:
                pipe.close()


def write_message(stream: IO[bytes], message: bytes) -> None:
    """Length as 8 bytes little endian, then the message."""
    data = memoryview(_LENGTH.pack(len(message)) + message)
    while data:
        written = stream.write(data)
        data = data[written if written is not None else 0 :]
    stream.flush()


def _read_until(stream: IO[bytes], deadline: float, timeout_s: float) -> bytes:
    def exactly(count: int) -> bytes:
        parts: list[bytes] = []
        while count:
            left = deadline - time.monotonic()
            if left <= 0 or not select.select([stream], [], [], left)[0]:
                raise TimeoutError(f"drawing took longer than {timeout_s:g} s")
            part = os.read(stream.fileno(), min(count, 1 << 20))
            if not part:
                raise EOFError("the drawing process ended")
            parts.append(part)
            count -= len(part)
        return b"".join(parts)

    return exactly(_LENGTH.unpack(exactly(_LENGTH.size))[0])


def main() -> None:
    """The worker's loop: read a picture, draw it, answer with PNG bytes or with a sentence."""
    # The pipe is taken away from file descriptor 1, so that whatever VTK prints cannot break a message.
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    stdin = sys.stdin.buffer
    from robomill.viz import scene

    scene.load()
    while header := stdin.read(_LENGTH.size):
        message = stdin.read(_LENGTH.unpack(header)[0])
        answer: tuple[str, Any]
        try:
            answer = ("png", scene.draw(pickle.loads(message)))
        except Exception as exc:  # a drawing error is answered, it must not end the loop
            answer = ("error", f"{type(exc).__name__}: {exc}")
        write_message(out, pickle.dumps(answer, protocol=5))


if __name__ == "__main__":
    main()
