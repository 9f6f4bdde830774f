#!/usr/bin/env python3
"""The core alone, on the oldest versions that pyproject.toml admits or on the newest: what is promised of it is tried.

    python3 .ci/core.py                 on the oldest, in .venv-lowest, made if it is not there
    python3 .ci/core.py newest          on the newest, in .venv-newest

No extra is installed, so this tries the core install, too: what `pip install robomill` brings.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TOOLS = ["pytest", "hypothesis"]
# What works without an extra and without another library to compare with, and is quick.
PARTS = [
    "robot",
    "kinematics/test_forward.py",
    "kinematics/test_jacobian.py",
    "compliance",
    "identification/fit/test_estimate.py",
    "identification/fit/test_estimate_intervals.py",
    "cli/test_core_install.py",
    "docs/test_notebooks.py",
    "learn/test_marking.py",
]
NEWEST = (3, 12)  # of Python, for which there are wheels of all the oldest versions


def main() -> int:
    newest = sys.argv[1:] == ["newest"]
    if sys.version_info[:2] > NEWEST and not newest:
        print(f"The oldest versions have no wheels for Python {sys.version.split()[0]}: nothing was tried.")
        return 0
    said = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["dependencies"]
    wanted = said if newest else [line.replace(">=", "==") for line in said]
    venv = ROOT / (".venv-newest" if newest else ".venv-lowest")
    python = venv / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(venv)], check=True)
    pip = [sys.executable, "-m", "pip", "--python", str(python), "install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*pip, "-e", str(ROOT), *wanted, *TOOLS], check=True)
    print("On " + ", ".join(wanted), flush=True)
    subprocess.run([str(python), "-m", "robomill.compiled"], cwd=ROOT, check=True)
    parts = [str(ROOT / "tests" / part) for part in PARTS]
    marks = ["-m", "not slow and not benchmark", "--durations=5"]
    return subprocess.call([str(python), "-m", "pytest", *marks, *parts], cwd=ROOT)


if __name__ == "__main__":
    raise SystemExit(main())
