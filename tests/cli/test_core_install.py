"""What ``pip install robomill`` brings is enough for every verb, or the verb names the extra that it needs.

Where the extras are installed they are hidden; where they are not (``.ci/core.py``) there is nothing to hide.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import pytest

from robomill.cli import main
from robomill.cli.parser import make_parser
from robomill.extras import BROUGHT_BY
from robomill.io.samples import samples_dir

SLOT = samples_dir() / "paper_flute"
TESTS = samples_dir() / "load_tests"
PLANE = ("--z", "0", "--x", "-200:200:200", "--y", "-1400:-1200:200")
MAP = ("map", "slavkovic_5r", "--quantity", "C_yy", *PLANE)

WORKS = {
    "robots": ("robots",),
    "pose": ("pose", "slavkovic_5r", "--theta-deg", "0,0,0,0,0"),
    "ik": ("ik", "slavkovic_5r", "--pose", "0,-1300,0,0,0"),
    "gcode": ("gcode", str(SLOT / "path.nc")),
    "map": (*MAP, "--out", "map.csv"),
    "identify": ("identify", "slavkovic_5r", str(TESTS / "one_joint_at_a_time.csv")),
    "simulate": ("simulate", str(SLOT / "setup.toml"), "--out", "result"),
    "report": ("report", str(SLOT), "--out", "report.html"),
    "advise": ("advise", "paper_flute/setup_process"),
    "turn": ("turn", "paper_flute", "--robot", "fanuc_r2000ic"),
    "place": ("place", "paper_flute", "--candidates", "9"),
    "design": ("design", "paper_flute", "--tolerance-mm", "0.2"),
    "compensate": ("compensate", str(SLOT / "setup.toml"), "--out", "corrected.nc"),
    "grade": ("grade", "answers", "--out", "marks.csv"),
    "samples": ("samples",),
    "reproduce": ("reproduce",),
    "completion": ("completion", "bash"),
}
NEEDS = {
    "serve": (("serve",), "The app needs streamlit", "app"),
    "": ((), "The app needs streamlit", "app"),
    "drawing": (("drawing", "bracket"), "A DXF drawing needs ezdxf", "drawing"),
    "drawing as SVG": (("drawing", "bracket.svg"), "An SVG drawing needs svgelements", "drawing"),
    "study": (("study", "paper_flute/study", "--out", "study"), "A study needs pyarrow", "study"),
    "map as Parquet": ((*MAP, "--out", "map.parquet"), "A map as Parquet needs pyarrow", "data"),
    "map as VTI": ((*MAP, "--out", "map.vti"), "A map as VTI needs pyvista", "render"),
}


@pytest.fixture(autouse=True)
def _core_only(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    for module in BROUGHT_BY:
        monkeypatch.setitem(sys.modules, module, None)


def test_every_verb_is_tried_here() -> None:
    (verbs,) = (action for action in make_parser()._actions if isinstance(action, argparse._SubParsersAction))
    assert set(verbs.choices) == {*WORKS, *NEEDS} - {name for name in NEEDS if name not in verbs.choices}


@pytest.mark.parametrize("verb", WORKS)
def test_it_works_without_any_extra(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    code = main(list(WORKS[verb]))
    said = capsys.readouterr()
    assert code in (0, 1), said.err
    assert said.out
    if "--out" in WORKS[verb]:
        assert Path(WORKS[verb][-1]).exists()


@pytest.mark.parametrize("case", NEEDS)
def test_it_names_the_extra_that_it_needs(case: str, capsys: pytest.CaptureFixture[str]) -> None:
    words, said, extra = NEEDS[case]
    assert main(list(words)) == 2
    told = capsys.readouterr().err.strip().splitlines()[-1]
    assert told == f'robomill: {said}, which is not installed here; get it with: pip install "robomill[{extra}]"'
    assert not list(Path().iterdir())  # nothing half written
