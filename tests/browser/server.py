"""The app's server as the browser tests have it: on one port of this machine, killed and started at will."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


class Server:
    """``python -m robomill serve`` with its work kept in ``folder``; or one ``page`` that is not the app's."""

    def __init__(self, folder: Path, *words: str, page: Path | None = None) -> None:
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = int(probe.getsockname()[1])
        self.folder, self.words, self.page = folder, words, page
        self.url = f"http://127.0.0.1:{self.port}"
        self.process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start it, and wait until it says that it is well."""
        command = [sys.executable, "-m", "robomill", "serve", f"--port={self.port}", *self.words]
        if self.page is not None:
            alone = ("--server.headless=true", "--server.address=127.0.0.1", f"--server.port={self.port}")
            command = [sys.executable, "-m", "streamlit", "run", str(self.page), *alone]
        given = {**os.environ, "ROBOMILL_AUTOSAVE_FOLDER": str(self.folder)}
        quiet = subprocess.DEVNULL
        self.process = subprocess.Popen(
            command, cwd=ROOT, env=given, stdout=quiet, stderr=quiet, start_new_session=True
        )
        for _ in range(300):
            with contextlib.suppress(OSError), urllib.request.urlopen(f"{self.url}/_stcore/health", timeout=1):
                return
            time.sleep(0.2)
        raise TimeoutError("the server does not say that it is well")

    def send(self, what: signal.Signals) -> None:
        """A signal to the server and what it started."""
        assert self.process is not None
        os.killpg(self.process.pid, what)

    def kill(self) -> None:
        """End it as a power cut would."""
        if self.process is not None and self.process.poll() is None:
            self.send(signal.SIGKILL)
            self.process.wait(timeout=20)

    def stop(self) -> None:
        """End it as Ctrl+C does."""
        if self.process is not None and self.process.poll() is None:
            self.send(signal.SIGTERM)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.process.wait(timeout=20)
            self.kill()
