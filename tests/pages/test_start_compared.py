"""A and B: what a page says of the project beside the one in force is what it says once that is in force, and is true
by a run of each apart."""

from __future__ import annotations

import dataclasses
import json
import re
from pathlib import Path

import numpy as np
import pytest
from conftest import PAGES, ROOT, go, store, words
from streamlit.testing.v1 import AppTest

import robomill as rm
from robomill.ui import session
from robomill.ui.comparing import other
from robomill.ui.keeping import autosave
from robomill.ui.keeping.settings import Settings
from robomill.ui.keeping.shelf import Shelf
from robomill.ui.keeping.writer import Line
from robomill.ui.maps.sides import SIDES, WHOSE
from robomill.ui.project import Project, View, preset_setup, project_from_toml, project_to_toml
from robomill.ui.session import Store
from robomill.ui.work import running
from robomill.units import format_si, to_si

WITH_TILES = ("app", "1_Robot", "2_Workspace", "3_Compliance", "5_Toolpath", "6_Milling")
A = preset_setup("paper_flute")
SOFTER = A.replace(robot=A.robot.with_compliance_set("table_3"))


def beside(app: AppTest, setup: rm.SimulationSetup) -> AppTest:
    """Hold the project in force against ``setup``, as if it had come by a file."""
    held = store(app)
    held.values[other.HELD] = other.Other(setup.name, Project(setup))
    held.project = held.project.replace(view=_look(held, other.HERE))
    return app.run()


def _look(held: Store, which: str) -> View:
    return dataclasses.replace(held.project.view, beside=which)


def values(app: AppTest, mark: str) -> list[str]:
    """What the tiles show of A, or of B."""
    text = words(app)
    if mark == "B":
        found = re.findall(r'<div class="rm-other"><i>B</i>(.*?)</div>', text)
    else:
        found = re.findall(r'<div class="rm-value(?: rm-long)?">(?:<i>A</i>)?(.*?)</div>', text)
    return [re.sub(r"<[^>]+>", " ", each).replace("\u00a0", " ").replace("  ", " ").strip() for each in found]


def pressed(app: AppTest, key: str) -> AppTest:
    return app.button(key=key).click().run()


@pytest.mark.parametrize("page", WITH_TILES)
def test_what_is_said_of_b_is_what_is_said_once_b_is_in_force(app: AppTest, page: str) -> None:
    go(app, page)
    alone = values(app, "A")
    beside(app, SOFTER)
    assert not app.exception
    own, theirs = values(app, "A"), values(app, "B")
    assert own == alone
    assert len(theirs) == len(own) == 4
    pressed(app, "other.take")
    assert not app.exception
    assert store(app).project.setup.digest() == SOFTER.digest()
    assert values(app, "A") == theirs
    assert "B is the same set-up as A" in words(app)
    pressed(app, "undo")
    assert store(app).project.setup.digest() == A.digest()
    assert values(app, "B") == theirs
    pressed(app, "other.end")
    assert values(app, "B") == []


def test_the_tiles_of_both_are_those_of_two_runs(app: AppTest) -> None:
    beside(app, SOFTER)
    for mark, setup in (("A", A), ("B", SOFTER)):
        verdict = rm.simulate(setup).verdict
        wall, floor, *_ = values(app, mark)
        assert wall == format_si(verdict.wall.value, "mm", sign=True)
        assert floor == format_si(verdict.floor.value, "mm", sign=True)


def test_both_stand_on_every_page_with_a_way_to_take_b(app: AppTest) -> None:
    beside(app, SOFTER)
    for page in PAGES:
        go(app, page)
        assert not app.exception
        text = words(app)
        assert 'aria-label="Verdict of B"' in text
        assert {"Take B", "End"} <= {each.label for each in app.button}


@pytest.mark.parametrize("name", ["heart", "two_tools"])
def test_another_program_is_compared_on_every_page(app: AppTest, name: str) -> None:
    beside(app, preset_setup(name))
    for page in PAGES:
        go(app, page)
        assert not app.exception, page
        assert preset_setup(name).name in words(app)


def test_an_arm_of_six_joints_is_compared_on_every_page(app: AppTest) -> None:
    """Its maps lie over the region of A; quantities of a joint that it has not are A's alone."""
    beside(app, A.replace(robot=rm.load_robot("kuka_kr500")))
    for page in PAGES:
        go(app, page)
        assert not app.exception, page
    go(app, "3_Compliance")
    for side in SIDES:
        app.button_group(key="maps.side").set_value(side).run()
        assert not app.exception


def test_a_b_that_is_refused_says_why_and_a_stays(app: AppTest) -> None:
    far = A.T_MW.copy()
    far[0, 3] += 9.0
    beside(app, A.replace(T_MW=far))
    for page in PAGES:
        go(app, page)
        assert not app.exception
        assert store(app).project.setup.digest() == A.digest()
    assert 'aria-label="Verdict of B"' in words(app)


def test_an_example_is_chosen_by_name_and_comes_back_with_the_project(app: AppTest) -> None:
    held = store(app)
    held.project = held.project.replace(view=_look(held, "example:heart"))
    app.run()
    assert preset_setup("heart").name in words(app)
    held.project = held.project.replace(view=_look(held, "example:../../etc/passwd"))
    app.run()
    assert not app.exception
    assert "Verdict of B" not in words(app)


def test_one_door_keeps_and_compares(app: AppTest) -> None:
    """B is chosen behind the button that keeps projects: an example by its name, or the project as it stands now."""
    pressed(app, "snapshots")
    app.selectbox(key="other.which").set_value("example:heart").run()
    assert not app.exception
    assert store(app).project.view.beside == "example:heart"
    assert preset_setup("heart").name in words(app)
    pressed(app, "snapshots")
    pressed(app, "other.pin")
    assert not app.exception
    assert store(app).project.view.beside.startswith(f"{other.KEPT}:")
    assert "B is the same set-up as A" in words(app)
    pressed(app, "snapshots")
    app.selectbox(key="other.which").set_value("").run()
    assert store(app).project.view.beside == ""


def test_the_maps_are_of_a_of_b_or_of_their_difference(app: AppTest) -> None:
    beside(app, SOFTER)
    go(app, "3_Compliance")
    for side, said in WHOSE.items():
        app.button_group(key="maps.side").set_value(side).run()
        assert not app.exception
        assert said in words(app)
    pressed(app, "other.end")
    assert not [each for each in app.button_group if each.key == "maps.side"]


def test_the_sections_of_both_are_drawn_to_one_scale(app: AppTest) -> None:
    beside(app, A.replace(cutter=A.cutter.replace(diameter=to_si(12.0, "mm"))))
    go(app, "6_Milling")
    assert not app.exception
    ends = {}
    for key in ("linked-section", "linked-section-of-b"):
        spec = next(json.loads(each.proto.spec) for each in app.get("plotly_chart") if each.proto.id.endswith(key))
        ends[key] = [np.ptp(spec["layout"][f"{axis}axis"]["range"]) for axis in "xy"]
    own, theirs = ends.values()
    np.testing.assert_allclose(own, theirs)


def test_a_long_run_of_b_is_asked_for_and_a_is_there_meanwhile(app: AppTest, monkeypatch: pytest.MonkeyPatch) -> None:
    longer = SOFTER.replace(tolerance=to_si(0.31, "mm"))
    monkeypatch.setattr(running, "run_seconds", lambda setup: 300.0)
    beside(app, longer)
    assert not app.exception
    assert "not computed yet" in words(app)
    assert values(app, "B") == []
    assert len(values(app, "A")) == 4
    pressed(app, f"{other.RUN}.ask")
    assert not app.exception
    assert len(values(app, "B")) == 4


def test_what_is_compared_with_is_kept_with_the_project() -> None:
    project = Project(A, View(beside="example:heart"))
    assert project_from_toml(project_to_toml(project)).view.beside == "example:heart"


def test_a_b_from_a_file_is_there_after_a_reload(app: AppTest, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Another session of the same browser, which has the project in force alone, finds B where it was kept."""
    shelf = Shelf(Settings(folder=tmp_path))
    monkeypatch.setattr(autosave, "line", lambda: Line("a1" * 32))
    monkeypatch.setattr(autosave, "shelf", lambda: shelf)
    pinned: list[str] = []

    def pin() -> None:
        other.pin("A softer arm", Project(SOFTER))
        pinned.append(session.project().view.beside)

    with monkeypatch.context() as patched:
        patched.setattr(session, "store", lambda: store(app))
        pin()
    again = AppTest.from_file(str(ROOT / "app.py"), default_timeout=60).run()
    held = store(again)
    held.project = held.project.replace(view=_look(held, pinned[0]))
    again.run()
    assert not again.exception
    assert values(again, "B")[0] == format_si(rm.simulate(SOFTER).verdict.wall.value, "mm", sign=True)
    pressed(again, "other.take")
    assert store(again).project.setup.digest() == SOFTER.digest()
