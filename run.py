#!/usr/bin/env python3
"""Set up robomill and start it, with nothing but Python 3.11+ and pip.

    python3 run.py            set up what is missing, then open the app
    python3 run.py test       set up what is missing, then run the whole test suite

Further words go on to the app's server or to pytest: ``python3 run.py test -m benchmark``.
Everything lives in ``.venv`` beside this file; delete that folder to start afresh.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent
VENV = ROOT / ".venv"
MARKER = VENV / ".robomill-ready"
PYTHON = VENV / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def main() -> int:
    if sys.version_info < (3, 11):
        print(f"robomill needs Python 3.11 or newer; this is {sys.version.split()[0]}.", file=sys.stderr)
        return 2
    words = sys.argv[1:]
    testing = words[:1] == ["test"]
    set_up(["all", "test"] if testing else ["all"])
    offer_graphics()
    if testing:
        workers = [] if any(w.startswith(("-n", "-m", "-k", "--pdb")) for w in words[1:]) else ["-n", "2"]
        # A library of linear algebra that spreads small systems over threads makes two workers wait for each other.
        alone = {f"{library}_NUM_THREADS": "1" for library in ("OPENBLAS", "OMP", "MKL")}
        command = [str(PYTHON), "-m", "pytest", *workers, *words[1:]]
        return subprocess.call(command, cwd=ROOT, env=alone | os.environ)
    return subprocess.call([str(PYTHON), "-m", "robomill", *words])


def set_up(extras: list[str]) -> None:
    """Make .venv and install robomill with these extras into it, unless a marker says that it stands."""
    wanted = fingerprint()
    done = MARKER.read_text().split() if MARKER.is_file() else []
    if done[:1] == [wanted] and set(extras) <= set(done[1:]) and PYTHON.exists():
        return
    began = time.monotonic()
    print("Setting up robomill in .venv (about a minute, once) ...", flush=True)
    installer = [sys.executable, "-m", "pip", "--python", str(PYTHON)]
    if not PYTHON.exists():
        # Debian's bare python3 has no ensurepip, so pip stays outside and is told where to install.
        run([sys.executable, "-m", "venv", "--without-pip", str(VENV)])
    if subprocess.run([*installer, "--version"], capture_output=True).returncode:
        run([sys.executable, "-m", "venv", str(VENV)])
        installer = [str(PYTHON), "-m", "pip"]
    extras = sorted({*extras, *done[1:]})
    target = f"{ROOT}[{','.join(extras)}]"
    quiet = ["install", "--quiet", "--disable-pip-version-check", "--no-warn-script-location"]
    run([*installer, *quiet, "-c", str(ROOT / "constraints.txt"), "-e", target])
    # Compiled once here, so that no screen waits for it; a failure only means that the first use compiles.
    command = [str(PYTHON), "-m", "robomill.compiled"]
    subprocess.run(command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    MARKER.write_text(" ".join([wanted, *extras]) + "\n")
    print(f"Set up in {time.monotonic() - began:.0f} s.", flush=True)


def fingerprint() -> str:
    state = hashlib.sha256(sys.version.encode())
    for name in ("pyproject.toml", "constraints.txt"):
        state.update((ROOT / name).read_bytes())
    return state.hexdigest()[:16]


def run(command: list[str]) -> None:
    """Run one set-up step; what it prints is shown if it fails."""
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if result.returncode:
        print(result.stdout, file=sys.stderr)
        raise SystemExit(f"Set-up stopped at: {' '.join(command)}")


def offer_graphics() -> None:
    """VTK draws off screen through EGL or OSMesa, which pip does not carry; Debian does."""
    if sys.platform != "linux" or loads("libEGL.so.1") or loads("libOSMesa.so.8"):
        return
    from robomill.viz.rendered.graphics import INSTALL, no_opengl  # needs the standard library only

    root = hasattr(os, "geteuid") and os.geteuid() == 0
    if root and shutil.which("apt-get"):
        print(f"Installing the off-screen graphics libraries: {INSTALL['debian']}", flush=True)
        for step in ("apt-get update", f"{INSTALL['debian']} --no-install-recommends"):
            if subprocess.run(step.split(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode:
                break
        else:
            return
    print(no_opengl(), file=sys.stderr)


def loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


if __name__ == "__main__":
    try:
        raise SystemExit(main())
    except KeyboardInterrupt:
        raise SystemExit(130) from None
