"""The load tests of a project: a value that is saved, undone and read back with it."""

from __future__ import annotations

import dataclasses

import pytest

from robomill.errors import ProjectError
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup, setup_to_toml
from robomill.ui.bench import MOST_KEPT, OWN, SAMPLE_ROBOT, SAMPLES, Bench, sample_text
from robomill.ui.project import Project, project_from_toml, project_to_toml

PROJECT = Project(load_setup(samples_dir() / "paper_flute" / "setup.toml"))
DECIDED = Bench(
    robot="kuka_kr270",
    model="joints+bending",
    bending=(2, 4),
    bending_auto=True,
    robust=True,
    fit_points="both",
    weights="size",
    leave_out="neighbours",
    excluded=(3, 9),
    goal="path",
    goal_joint=4,
    count=7,
    load=120.0,
    tilt=0.25,
    band="noise",
    force_unsure=3.0,
    length_unsure=0.5e-3,
).with_map("a,b\r\n1,2", "my map.csv")


def through_a_file(bench: Bench) -> Bench:
    return project_from_toml(project_to_toml(PROJECT.replace(bench=bench))).bench


@pytest.mark.parametrize("bench", [Bench(), DECIDED, Bench().with_tests('x;"y"\n1;2\n', "mine.csv", "another arm")])
def test_it_goes_through_a_projects_file(bench: Bench) -> None:
    assert through_a_file(bench).digest() == bench.digest()


def test_every_field_that_was_decided_is_in_the_file() -> None:
    own = DECIDED.with_tests("a,b", "b.csv", "c")
    assert all(
        getattr(own, each.name) != each.default
        for each in dataclasses.fields(Bench)
        if each.name not in ("excluded", "fit_points")
    )  # which other tests forget
    assert through_a_file(own).digest() == own.digest()


def test_a_text_that_is_too_long_is_left_out_of_the_file_alone() -> None:
    long = Bench(model="joints+tool").with_tests("1" * (MOST_KEPT + 1), "long.csv", SAMPLE_ROBOT)
    assert len(project_to_toml(PROJECT.replace(bench=long))) < MOST_KEPT
    back = through_a_file(long)
    assert (back.sample, back.name, back.text, back.model) == (OWN, "long.csv", "", "joints+tool")


def test_a_bare_set_up_keeps_the_tests_in_force() -> None:
    assert project_from_toml(setup_to_toml(PROJECT.setup), bench=DECIDED).bench is DECIDED


def test_what_is_decided_is_part_of_what_undo_remembers() -> None:
    assert PROJECT.replace(bench=DECIDED).digest() != PROJECT.digest() == PROJECT.replace(bench=Bench()).digest()


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ('sample = "mine"', "sample: expected one of"),
        ("bending = [2.5]", "bending: expected a list of whole numbers"),
        ("count = 31", "count: Load tests, More tests: found 31; expected 1 to 30"),
        ("tilt_deg = 91.0", "Tilt up to: found 91°; expected 0° to 90°"),
        ("wishes = 1", "wishes: this key is not known"),
    ],
)
def test_a_file_that_cannot_be_is_refused_with_its_place(line: str, words: str) -> None:
    with pytest.raises(ProjectError, match=words) as refused:
        project_from_toml(f"{project_to_toml(PROJECT)}\n[experiments]\n{line}\n")
    assert "[experiments]" in str(refused.value)


def test_a_sample_is_measured_with_the_robot_it_was_made_for() -> None:
    for sample in SAMPLES:
        made_for = "kuka_kr270" if sample == "cable_six_axis" else "slavkovic_5r"
        bench = DECIDED.with_sample(sample)
        assert bench.text == sample_text(sample)
        assert (bench.robot_name("another"), bench.robot_name(made_for)) == (made_for, "")
        assert (bench.excluded, bench.fit_points) == ((), "none")
    edited = Bench().with_tests("rows", "pasted rows", "another")
    assert edited.robot_name("another") == SAMPLE_ROBOT
    assert DECIDED.with_tests("rows", "pasted rows", "another").robot_name("another") == "kuka_kr270"
