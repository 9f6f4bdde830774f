"""Links: a project goes into an address and comes back the same; what is damaged, foreign or hostile is refused."""

from __future__ import annotations

import base64
import json
import zlib
from collections.abc import Callable

import numpy as np
import pytest

from robomill.errors import ProjectError
from robomill.toolpath.source import GCodeSource
from robomill.ui.project import Project, preset_setup, presets, project_from_toml, project_to_toml, with_field
from robomill.ui.sharing.address import EDITS, LARGEST, MOST, PRESET, opened, packed
from robomill.units import from_si, to_si

BASE = Project(preset_setup("paper_flute"))
Edit = Callable[[np.random.Generator, Project], Project]


def edited(path: str, draw: Callable[[np.random.Generator], float]) -> Edit:
    return lambda rng, project: project.replace(setup=with_field(project.setup, path, draw(rng)))


def stiffened(rng: np.random.Generator, project: Project) -> Project:
    robot = project.setup.robot
    typed = np.round(from_si(robot.C_theta, "1e-7 rad/(N m)") * rng.uniform(0.3, 3.0, robot.n), 3)
    C_theta = [to_si(each, "1e-7 rad/(N m)") for each in typed.tolist()]
    return project.replace(setup=project.setup.replace(robot=robot.replace(C_theta=C_theta)))


EDITS_OF: tuple[Edit, ...] = (
    edited("tolerance", lambda rng: to_si(round(rng.uniform(0.05, 2.0), 3), "mm")),
    edited("T_MW[0,3]", lambda rng: to_si(round(rng.uniform(-300.0, 300.0), 2), "mm")),
    edited("T_MW[2,3]", lambda rng: to_si(round(rng.uniform(-200.0, 200.0), 2), "mm")),
    edited("step", lambda rng: to_si(round(rng.uniform(0.5, 2.0), 2), "mm")),
    edited("cell", lambda rng: to_si(round(rng.uniform(0.1, 0.5), 3), "mm")),
    stiffened,
    lambda rng, project: project.replace(bench=project.bench.replace(count=int(rng.integers(1, 20)))),
    lambda rng, project: project.replace(view=type(project.view)(units="in", station=float(rng.uniform()))),
)


def state(seed: int) -> Project:
    rng = np.random.default_rng(seed)
    name = str(rng.choice(presets()))
    project = Project(preset_setup(name), preset=name)
    for k in rng.permutation(len(EDITS_OF))[: rng.integers(0, len(EDITS_OF) + 1)]:
        project = EDITS_OF[k](rng, project)
    return project


@pytest.mark.parametrize("seed", range(100))
def test_a_hundred_states_come_back_the_same(seed: int) -> None:
    project = state(seed)
    said = packed(project)
    assert said is not None
    assert len(said.get(EDITS, "")) <= MOST
    again = opened(said)
    assert again.digest() == project.digest()
    assert again.setup.digest() == project.setup.digest()
    assert again.preset == project.preset
    assert (again.view.units, again.view.station) == (project.view.units, project.view.station)


def test_numbers_that_no_float_of_millimetres_meets_come_back_the_same() -> None:
    for seed in range(30):
        rng = np.random.default_rng(seed)
        project = BASE.replace(setup=BASE.setup.replace(step=float(rng.uniform(1.28e-4, 2.5e-4))))
        said = packed(project)
        assert said is not None
        assert opened(said).digest() == project.digest() == project_from_toml(project_to_toml(project)).digest()
        assert opened(said).setup.step == project.setup.step


def test_an_example_as_it_is_takes_its_name_alone() -> None:
    assert packed(BASE) == {PRESET: "paper_flute"}
    assert opened({PRESET: "heart"}).setup.digest() == preset_setup("heart").digest()


def test_what_is_too_long_is_left_to_a_file() -> None:
    rng = np.random.default_rng(1)
    lines = "\n".join(f"G1 X{x:.4f} Y{y:.4f} F600" for x, y in rng.uniform(-40, 40, (400, 2)))
    source = GCodeSource(f"G21 G90\nG0 Z5\nG1 Z-1 F100\n{lines}\nM2\n", "own.nc")
    assert packed(BASE.replace(setup=BASE.setup.replace(source=source))) is None


def made(what: object, version: str = "1") -> dict[str, str]:
    data = what if isinstance(what, bytes) else json.dumps(what).encode()
    return {
        PRESET: "paper_flute",
        EDITS: version + base64.urlsafe_b64encode(zlib.compress(data, wbits=-15)).decode().rstrip("="),
    }


def edits(change: dict) -> dict[str, str]:
    return made([BASE.digest()[:8], change])


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ({PRESET: "../../etc/passwd"}, "not here"),
        ({PRESET: "nobody"}, "not here"),
        ({PRESET: "paper_flute", EDITS: "1"}, "damaged"),
        ({PRESET: "paper_flute", EDITS: "1!!!!"}, "damaged"),
        ({PRESET: "paper_flute", EDITS: "9abc"}, "version '9'"),
        ({PRESET: "paper_flute", EDITS: "1" + "A" * (MOST + 1)}, "damaged"),
        (made(b"\x00\xff"), "damaged"),
        (made(b" " * (LARGEST * 3)), "damaged"),
        (made(b"[" * 100_000), "damaged"),
        (made({"a": 1}), "damaged"),
        (made(["x", []]), "damaged"),
        (made([1, {}]), "damaged"),
        (edits({"!": {}}), "damaged"),
        (edits({"+": {"name": None}}), "damaged"),
        (edits({"-": 7}), "damaged"),
        (edits({"~": {"nothing": {}}}), "damaged"),
        (edits({"~": {"path": {"-": ["program_text"], "+": {"program": "/etc/passwd"}}}}), "name of a file"),
        (edits({"+": {"unknown_key": 1}}), "unknown_key"),
        (edits({"+": {"tolerance_mm": float("nan")}}), "tolerance"),
        (edits({"+": {"tolerance_mm": -1.0}}), "Tolerance: found"),
        (edits({"+": {"tolerance_mm": 0.4}}), "another version"),
        (edits({"+": {"a": json.loads("[" * 40 + "]" * 40)}}), "deep"),
    ],
)
def test_what_is_damaged_foreign_or_hostile_is_refused_in_one_sentence(said: dict[str, str], told: str) -> None:
    with pytest.raises(ProjectError, match=told) as refused:
        opened(said)
    assert len(str(refused.value).splitlines()) == 1


def test_a_link_that_was_cut_off_or_has_a_wrong_letter_is_never_another_project() -> None:
    project = state(3)
    said = packed(project)
    assert said is not None
    whole = said[EDITS]
    rng = np.random.default_rng(0)
    for _ in range(60):
        at = int(rng.integers(1, len(whole)))
        letter = "A" if whole[at] != "A" else "B"
        for wrong in (whole[:at], whole[:at] + letter + whole[at + 1 :]):
            try:
                assert opened({**said, EDITS: wrong}).digest() == project.digest()
            except ProjectError:
                continue
