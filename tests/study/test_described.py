"""Studies as they are written, and what is refused of them in which words."""

from pathlib import Path

import pytest

import robomill as rm
from robomill.errors import StudyError

PARAMETERS = {"cutter.diameter_mm": {"values": [6, 8]}}


def study(**more: object) -> rm.Study:
    return rm.load_study({"setup": "paper_flute", "parameters": PARAMETERS, **more})


def test_the_sample_is_a_study() -> None:
    found = rm.load_study("paper_flute/study")
    assert (found.kind, len(found.points), len(found.keys)) == ("grid", 60, 3)


def test_a_file_names_a_set_up_beside_it(tmp_path: Path) -> None:
    rm.write_setup(tmp_path / "mine.toml", rm.load_setup("paper_flute").replace(name="mine"))
    place = tmp_path / "study.toml"
    place.write_text('setup = "mine.toml"\n[parameters."tolerance_mm"]\nvalues = [0.1, 0.2]\n')
    assert rm.load_study(place).setup.name == "mine"


def test_a_design_is_in_the_digest_and_a_name_is_not() -> None:
    assert study(name="x").digest() == study(name="y").digest()
    assert study().digest() != study(responses=["wall_mm"]).digest()
    drawn = [study(design={"kind": "sobol", "points": 4, "seed": seed}).digest() for seed in (1, 2)]
    assert drawn[0] != drawn[1]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"parameters": {"cutter.diametr_mm": {"values": [6]}}}, "Parameter cutter.diametr_mm: .*not known here"),
        ({"responses": ["wal_mm"]}, "responses: 'wal_mm' is not known; known are max_deviation_mm"),
        ({"responses": []}, "responses: there is none"),
        ({"parameters": {}}, "parameters: there is none; give at least one"),
        ({"setup": "nothing_like_it"}, "setup: 'nothing_like_it' is neither a file beside the study nor a sample"),
        ({"design": {"kind": "random"}}, "kind: expected one of grid, latin_hypercube, sobol, found 'random'"),
        ({"design": {"kind": "sobol", "points": 0}}, "points: expected a whole number from 1"),
        ({"desing": {}}, "desing: this key is not known here"),
        ({"parameters": {"tolerance_mm": {"low": 0.3, "high": 0.1, "steps": 2}}}, "the bounds contradict each other"),
        ({"parameters": {"tolerance_mm": {"low": 0.1, "high": 0.3}}}, "steps: missing; say how many values"),
        ({"parameters": {"tolerance_mm": {}}}, "give one of values, low and high, or distribution"),
        ({"parameters": {"tolerance_mm": {"values": [0.1, "x"]}}}, "do not stand in one list"),
        (
            {"parameters": {"tolerance_mm": {"distribution": "normal", "mean": 0.3, "std": 0.0, "steps": 3}}},
            "std: expected a number above zero",
        ),
        ({"parameters": {"tolerance_mm": {"distribution": "cauchy"}}}, "expected one of normal, uniform"),
        ({"format": "robomill-setup"}, "format: expected 'robomill-study'"),
    ],
)
def test_what_is_wrong_is_named(given: dict, words: str) -> None:
    with pytest.raises(StudyError, match=words):
        study(**given)


def test_a_file_that_is_not_there_is_refused() -> None:
    with pytest.raises(StudyError, match="cannot be opened"):
        rm.load_study("nowhere/study.toml")


def test_a_study_reaches_its_own_folder_and_below(tmp_path: Path) -> None:
    """As a set-up does: what lies elsewhere is not even looked for, unless that is allowed."""
    rm.write_setup(tmp_path / "other.toml", rm.load_setup("paper_flute"))
    (tmp_path / "study").mkdir()
    place = tmp_path / "study" / "study.toml"
    head = 'format = "robomill-study"\nversion = 1\n'
    rest = '[parameters."part.zero_mm[2]"]\nvalues = [-1300.0]\n'
    for named in ("../other.toml", str(tmp_path / "other.toml"), "../missing.toml"):
        place.write_text(f"{head}setup = {named!r}\n{rest}", encoding="utf-8")
        with pytest.raises(StudyError, match="not in the folder of the study nor below it"):
            rm.load_study(place)
    place.write_text(f"{head}setup = '../other.toml'\n{rest}", encoding="utf-8")
    assert rm.load_study(place, allow_outside=True).setup == rm.load_setup(tmp_path / "other.toml")


def test_a_list_alone_is_what_a_parameter_takes():
    given = {"setup": "paper_flute", "parameters": {"cutter.diameter_mm": [6, 8], "tolerance_mm": (0.1, 0.2)}}
    told = {key: {"values": list(values)} for key, values in given["parameters"].items()}
    assert rm.load_study(given).points == rm.load_study(given | {"parameters": told}).points
    with pytest.raises(StudyError, match="do not stand in one list"):
        rm.load_study(given | {"parameters": {"tolerance_mm": [0.1, "x"]}})
