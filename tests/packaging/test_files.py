"""The files that say how robomill is installed, tried, run and cited agree with what it is."""

from __future__ import annotations

import os
import re
import tomllib
from pathlib import Path

import pytest
import yaml

from robomill import __version__

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def test_whoever_cites_it_finds_this_version_and_the_paper() -> None:
    said = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert said["cff-version"] == "1.2.0"
    assert {"message", "title", "authors"} <= set(said)  # what the format asks for
    assert (said["title"], said["type"], said["version"]) == (PROJECT["name"], "software", __version__)
    assert (said["license"], said["repository-code"]) == (PROJECT["license"], PROJECT["urls"]["Source"])
    assert set(said["keywords"]) == set(PROJECT["keywords"])
    (paper,) = said["references"]
    assert (paper["journal"], paper["volume"], paper["start"], paper["year"]) == ("FME Transactions", 41, 83, 2013)


def test_what_is_pushed_is_tried_as_everywhere_else() -> None:
    said = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text())
    steps = [step for job in said["jobs"].values() for step in job["steps"]]
    assert any(step.get("run") == "bash .ci/run" for step in steps)
    systems = said["jobs"]["core"]["strategy"]["matrix"]
    named = [line.rpartition(" ")[2] for line in PROJECT["classifiers"] if "Python :: 3." in line]
    assert systems["python"] == named
    assert [each.partition("-")[0] for each in systems["os"]] == ["ubuntu", "macos", "windows"]
    assert os.access(ROOT / ".ci/run", os.X_OK)
    script = (ROOT / ".ci/run").read_text()
    assert "python3 run.py test" in script
    assert "python3 .ci/core.py" in script


def test_the_container_installs_everything_and_runs_as_a_plain_user() -> None:
    lines = (ROOT / "Dockerfile").read_text().splitlines()
    words = [line.split(maxsplit=1)[0] for line in lines if line.strip()]
    assert 'pip install --no-cache-dir -c constraints.txt -e ".[all]"' in "\n".join(lines)
    assert words.index("USER") < words.index("ENTRYPOINT")
    (user,) = (line for line in lines if line.startswith("USER"))
    assert user.split()[1] not in ("root", "0")
    for line in lines:
        for source in line.split()[1:-1] if line.startswith("COPY") else ():
            assert (ROOT / source).exists(), source


@pytest.mark.parametrize("line", PROJECT["dependencies"])
def test_the_core_says_from_which_version_on_and_not_up_to_which(line: str) -> None:
    assert re.fullmatch(r"[\w-]+>=\d+(\.\d+)+(; sys_platform != 'emscripten')?", line)


def test_the_core_is_what_it_says() -> None:
    core = {re.split("[>=]", line)[0] for line in PROJECT["dependencies"]}
    assert core == {"numpy", "scipy", "numba", "trimesh", "tomli-w", "argcomplete", "clarabel", "lazy-loader"}
