#!/usr/bin/env python3
"""The core alone on the oldest versions that pyproject.toml admits: what it promises of them is tried.

    python3 .ci/lowest.py               in .venv-lowest, made if it is not there

No extra is installed, so this tries the core install, too: what `pip install robomill` brings, in its oldest form.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
VENV = ROOT / ".venv-lowest"
PYTHON = VENV / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
TOOLS = ["pytest", "hypothesis"]
# What works without an extra and without another library to compare with, and is quick.
PARTS = [
    "robot",
    "kinematics/test_forward.py",
    "kinematics/test_jacobian.py",
    "compliance",
    "identification/test_estimate.py",
    "cli/test_core_install.py",
]
NEWEST = (3, 12)  # of Python, for which there are wheels of all the oldest versions


def main() -> int:
    if sys.version_info[:2] > NEWEST:
        print(f"The oldest versions have no wheels for Python {sys.version.split()[0]}: nothing was tried.")
        return 0
    said = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dependencies"]
    lowest = [line.replace(">=", "==") for line in said]
    if not PYTHON.exists():
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(VENV)], check=True)
    pip = [sys.executable, "-m", "pip", "--python", str(PYTHON), "install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*pip, "-e", str(ROOT), *lowest, *TOOLS], check=True)
    print("On " + ", ".join(lowest), flush=True)
    parts = [str(ROOT / "tests" / part) for part in PARTS]
    marks = ["-m", "not slow and not benchmark", "--durations=5"]
    return subprocess.call([str(PYTHON), "-m", "pytest", *marks, *parts], cwd=ROOT)


if __name__ == "__main__":
    raise SystemExit(main())
