"""What the command line refuses it says in its own words: by options, in the units that they are given in."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from robomill.cli import main

IN_CODE = re.compile(r"\b(rad|a name alone|numpy|\w+_mm|\w+_deg|\w+_um|\w+=|None)\b(?<!feed_mm_min)")
POINTS = "X_mm,Y_mm,Z_mm\n0,0,0\n10,0,0\n"
MAP = "map slavkovic_5r --quantity C_yy --z 0 --x "
REFUSED = {
    "a tilt of turns": ("ik slavkovic_5r --pose 0,-1300,0,0,400", "found 400°; expected at most 360°"),
    "a place in m": ("ik slavkovic_5r --pose 0,-1.3,0,0,0", "in the middle of the robot's foot; X, Y, Z are in mm"),
    "a joint of a million turns": (
        "pose slavkovic_5r --theta-deg=0,0,0,0,1e9",
        "at 1e+09°, far beyond its limits of −120°",
    ),
    "a tolerance in m": ("simulate paper_flute --tol 0.0003", "found 0.0003 mm; expected at least 0.001 mm"),
    "a tolerance in um": ("simulate paper_flute --tol 300", "found 300 mm; expected more than 0 mm to 50 mm"),
    "a tolerance of a design in um": ("design paper_flute --tolerance-mm 300", "found 300 mm; expected"),
    "a box in m": ("place paper_flute --x -.3:.3", "found 0.3 mm; expected at least 2 mm"),
    "a yaw in rad": ("place paper_flute --yaw -1.57:1.57", "1.57 rad are 89.954°"),
    "a map in m": (
        "map slavkovic_5r --quantity C_yy --x -.6:.6:.1 --y -1.3 --z 0",
        "found 0.6 mm; expected at least 2 mm",
    ),
    "a map in m as mm": (MAP + "0 --y 1e9", "expected 200 m at most"),
    "a map to a folder": (
        MAP + "0 --y -1300 --out .",
        "folder; give the name of a file",
    ),
    "no feed": ("gcode points.csv", "or give --feed."),
    "no unit": ("gcode silent.csv --feed 600", "or give --unit."),
    "a feed in m/s": ("gcode points.csv --feed 0.01", "found 0.01 mm/min; expected at least 1 mm/min"),
    "a feed that is none": ("gcode points.csv --feed nan", "is no number; expected more than 0"),
    "a rate backwards": (
        "turn paper_flute --robot fanuc_r2000ic --rate -1",
        "found −1 °/mm; expected more than 0",
    ),
    "a cutter in m": ("drawing bracket --cut slots:inside:3 --feed 600 --diameter 0.008", "expected at least 0.05 mm"),
    "ends of a URDF": ("pose two_ends.urdf --theta-deg 0", "give --tip of the branch you want."),
    "a mimic joint": ("pose gripper.urdf --theta-deg 0", "If the arm ends before it, give --tip."),
}
LINK = '<link name="{}"/>'
JOINT = (
    '<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin xyz="0.5 0 0"/>'
    '<axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/>{3}</joint>'
)


def urdf(*joints: tuple[str, str, str, str]) -> str:
    links = dict.fromkeys(link for _, parent, child, _ in joints for link in (parent, child))
    return (
        f'<robot name="own">{"".join(map(LINK.format, links))}{"".join(JOINT.format(*each) for each in joints)}</robot>'
    )


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("points.csv").write_text(POINTS)
    Path("silent.csv").write_text(POINTS.replace("_mm", ""))
    arm = ("1", "base", "arm", "")
    Path("two_ends.urdf").write_text(urdf(arm, ("2", "arm", "left", ""), ("3", "arm", "right", "")))
    Path("gripper.urdf").write_text(urdf(arm, ("2", "arm", "hand", ""), ("3", "hand", "finger", '<mimic joint="2"/>')))
    return tmp_path


@pytest.mark.parametrize("case", REFUSED)
def test_a_refusal_speaks_of_options_and_their_units(case: str, capsys: pytest.CaptureFixture[str]) -> None:
    words, said = REFUSED[case]
    assert main(words.split()) == 2
    sentence = capsys.readouterr().err
    assert said in sentence
    assert not IN_CODE.findall(sentence.replace(said, "").replace("_mm,", "").replace("mm_min", ""))


def test_the_tip_of_a_urdf_is_an_option(capsys: pytest.CaptureFixture[str]) -> None:
    """Two joints 0.5 m apart, the tip at the second link's frame."""
    assert main(["pose", "two_ends.urdf", "--tip", "left", "--theta-deg", "0,0", "--json"]) == 0
    T_MT = json.loads(capsys.readouterr().out)["T_MT"]
    assert [row[3] for row in T_MT[:3]] == pytest.approx([1.0, 0.0, 0.0], abs=1e-12)
    assert main(["pose", "slavkovic_5r", "--tip", "left", "--theta-deg", "0,0,0,0,0"]) == 2
    assert "only a URDF has links" in capsys.readouterr().err


def test_a_program_that_starts_no_spindle_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    cut = ["drawing", "bracket", "--cut", "slots:inside:3", "--feed", "600", "--diameter", "8", "--json"]
    codes = []
    for more in ([], ["--spindle", "8000"]):
        assert main([*cut, *more]) == 0
        codes.append({each["code"] for each in json.loads(capsys.readouterr().out)["findings"]})
    assert "no-spindle" in codes[0]
    assert "no-spindle" not in codes[1]
