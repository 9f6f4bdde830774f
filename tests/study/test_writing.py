"""A study written as one file is the same study when it is read back, whatever its set-up has come from."""

from pathlib import Path

import pytest

import robomill as rm
from robomill.errors import StudyError
from robomill.study.described import Study, load_study
from robomill.study.writing import study_to_toml

RANGE = {"part.zero_mm[2]": {"low": -1400.0, "high": -1200.0, "steps": 3}}
NORMAL = {"robot.joint[2].a_mm": {"distribution": "normal", "mean": 1220.0, "std": 2.0}}


def study(**more: object) -> Study:
    return load_study({"setup": rm.load_setup("heart"), "parameters": RANGE, "name": "mine", **more})


@pytest.mark.parametrize(
    "found",
    [
        study(),
        study(design={"kind": "sobol", "points": 8, "seed": 3}, parameters={**RANGE, **NORMAL}),
        study(parameters={"tolerance_mm": {"values": [0.1, 0.2]}, "path.feed_percent": {"values": [50, 100]}}),
        study(parameters={"tolerance_mm": {"low": 0.1, "high": 0.4, "log": True, "steps": 4}}, responses=["wall_mm"]),
    ],
    ids=["range", "drawn", "values", "log"],
)
def test_what_is_written_is_read_back_with_the_same_points_and_digest(found: Study, tmp_path: Path) -> None:
    place = tmp_path / "study.toml"
    place.write_text(study_to_toml(found), encoding="utf-8")
    again = load_study(place)
    assert (again.name, again.points, again.digest()) == ("mine", found.points, found.digest())


def test_a_set_up_within_that_is_wrong_is_refused_by_its_own_sentence() -> None:
    with pytest.raises(StudyError, match="setup: .*expected 'robomill-setup', found 'other'"):
        load_study({"setup": {"format": "other"}, "parameters": RANGE})
