"""Serving the app: on this machine for whoever sits at it, or for others, with what that asks for."""

import argparse
import os
import socket
import subprocess
import sys
from collections.abc import Sequence
from functools import partial
from typing import Any

from robomill.cli.options import whole
from robomill.errors import RobomillError
from robomill.extras import missing

LOOPBACK = "127.0.0.1"
# What a server for others has: no file or line of the code is shown to visitors (its owner's log has them), forms and
# sockets of other sites are refused, and nothing is watched or opened on the machine that serves.
SHARED = (
    "--server.headless=true",
    "--server.fileWatcherType=none",
    "--server.enableXsrfProtection=true",
    "--server.enableCORS=true",
    "--client.showErrorDetails=none",
    "--browser.gatherUsageStats=false",
)

# Arrays come and go with every edit. Left to itself, glibc keeps the holes that they leave in many heaps, and a server
# of many threads grows by a hundred megabytes that nobody holds: few heaps, and each large array a mapping of its own.
ALLOCATOR = {"MALLOC_ARENA_MAX": "2", "MALLOC_MMAP_THRESHOLD_": "1048576", "MALLOC_TRIM_THRESHOLD_": "33554432"}


def start_app(words: Sequence[str] = ()) -> int:
    """Serve the app on this machine only and open it; further words go to Streamlit."""
    _must_be_installed()
    own = () if any(word.startswith("--server.address") for word in words) else (f"--server.address={LOOPBACK}",)
    try:
        return subprocess.call(_command(*own, "--browser.gatherUsageStats=false", *words))
    except KeyboardInterrupt:
        return 130


def serve_options(serve: argparse.ArgumentParser) -> None:
    """The options of ``robomill serve``."""
    serve.add_argument("--address", default=LOOPBACK, help=f"address to listen on (default {LOOPBACK}: this machine)")
    serve.add_argument("--port", type=partial(whole, 65535), default=8501, help="port to listen on (default 8501)")
    serve.add_argument("--host-name", metavar="NAME", help="name by which browsers reach it, behind a reverse proxy")
    serve.add_argument("--base-path", metavar="PATH", help="path under which a reverse proxy offers it")
    serve.add_argument(
        "--max-upload-mb", type=partial(whole, 100_000), default=100, metavar="MB", help="largest file (default 100)"
    )
    serve.add_argument(
        "--metrics", choices=("on", "off"), help="answer /_stcore/metrics with figures of the server (default off)"
    )
    serve.add_argument("--autosave", choices=("on", "off"), help="keep people's work beyond the page (default on)")
    serve.add_argument("--autosave-folder", metavar="DIR", help="where, in a folder that nobody else can read")
    serve.add_argument("--autosave-mb", metavar="MB", help="of all together (default 1000); the oldest goes first")
    serve.add_argument("--autosave-days", metavar="DAYS", help="after which it goes (default 30)")


def run_serve(arguments: Any) -> int:
    """Serve until told to stop. Raises RobomillError where a bound of what is kept is none."""
    _must_be_installed()
    from robomill.ui.keeping.settings import METRICS, PREFIX, Settings
    from robomill.ui.keeping.shelf import Shelf, StoreError

    environment = ALLOCATOR | os.environ
    for option, name in (("", ""), ("_folder", "_FOLDER"), ("_mb", "_ALL_MB"), ("_days", "_DAYS")):
        said = getattr(arguments, f"autosave{option}")
        if said is not None:
            environment[f"{PREFIX}{name}"] = said
    if arguments.metrics:
        environment[METRICS] = arguments.metrics
    settings = Settings.of(environment)
    if settings.on:
        try:
            Shelf(settings).check()
        except StoreError as exc:
            print(f"robomill: nothing can be kept in {settings.folder}; every page says so. {exc}", file=sys.stderr)
    _can_listen(arguments.address, arguments.port)
    words = [
        f"--server.address={arguments.address}",
        f"--server.port={arguments.port}",
        f"--server.maxUploadSize={arguments.max_upload_mb}",
    ]
    if arguments.host_name:
        words.append(f"--browser.serverAddress={arguments.host_name}")
    if arguments.base_path:
        words.append(f"--server.baseUrlPath={arguments.base_path.strip('/')}")
    return _become(_command(*SHARED, *words), environment)


def _must_be_installed() -> None:
    refusal = missing("The app", "app", "streamlit", "plotly", "pandas", "pyarrow")
    if refusal is not None:
        raise refusal


def _command(*words: str) -> list[str]:
    from robomill.io.samples import app_dir

    return [sys.executable, "-m", "streamlit", "run", str(app_dir() / "app.py"), *words]


def _become(command: list[str], environment: dict[str, str]) -> int:
    """Be the server rather than its parent: what stops this process stops the server."""
    if os.name != "nt":
        os.execve(command[0], command, environment)
    return subprocess.call(command, env=environment)


def _can_listen(address: str, port: int) -> None:
    """Raise RobomillError where nothing can listen there: the server itself would say so in many lines."""
    try:
        family = socket.getaddrinfo(address, port, type=socket.SOCK_STREAM)[0][0]
        socket.create_server((address, port), family=family).close()
    except (OSError, UnicodeError) as exc:
        why = getattr(exc, "strerror", None) or "it is no name of a machine"
        raise RobomillError(
            f"--address {address:.80}, --port {port}: nothing can listen there ({why}); give an address of this "
            "machine and a port that is free."
        ) from None
