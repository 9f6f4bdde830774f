"""The notebooks run from top to bottom with what ``pip install robomill`` brings, and are kept without outputs."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from robomill.extras import BROUGHT_BY

NOTEBOOKS = sorted((Path(__file__).resolve().parents[2] / "docs/notebooks").glob("*.ipynb"))


def test_there_are_six() -> None:
    assert len(NOTEBOOKS) == 6


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_is_written_without_what_it_printed(path: Path) -> None:
    book = json.loads(path.read_text(encoding="utf-8"))
    assert (book["nbformat"], book["nbformat_minor"]) == (4, 5)
    assert len({cell["id"] for cell in book["cells"]}) == len(book["cells"])
    for cell in book["cells"]:
        assert cell["cell_type"] in ("code", "markdown")
        if cell["cell_type"] == "code":
            assert cell["outputs"] == []
            assert cell["execution_count"] is None


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_runs_cell_by_cell_with_the_core_alone(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for module in BROUGHT_BY:
        monkeypatch.setitem(sys.modules, module, None)
    names: dict[str, object] = {"__name__": "__main__"}
    cells = [cell for cell in json.loads(path.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]
    for k, cell in enumerate(cells):
        code = compile("".join(cell["source"]), f"{path.name}, code cell {k + 1}", "exec")
        exec(code, names)  # as a notebook does it
        assert capsys.readouterr().out, "every cell shows something"


RUN = """
import json, sys
for module in sys.argv[2:]:
    sys.modules[module] = None
names = {"__name__": "__main__"}
for cell in json.load(open(sys.argv[1], encoding="utf-8"))["cells"]:
    if cell["cell_type"] == "code":
        exec("".join(cell["source"]), names)
"""


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_prints_the_same_where_there_is_no_compiler(path: Path, tmp_path: Path) -> None:
    """As in a Python that runs in a browser, for which nobody builds one."""

    def printed(*without: str) -> str:
        command = [sys.executable, "-c", RUN, str(path), *without]
        return subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True).stdout

    assert printed("numba", "llvmlite", *BROUGHT_BY) == printed()
