"""Workspace and compliance pages: every picture, every kind of robot, every refusal in one sentence."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

import numpy as np
import pytest
from conftest import errors, go, number, store, words
from random_arms import seven
from streamlit.testing.v1 import AppTest

import robomill as rm
from robomill.cutting.forces import model_of
from robomill.io.materials import sample_materials
from robomill.io.robot.robots import load_robot
from robomill.quantities import quantities
from robomill.robot.model import Robot
from robomill.toolpath.source import GCodeSource
from robomill.ui.project import MapView, preset_setup
from robomill.workspace.quantities import map_quantities, map_quantity

ROBOT, WORKSPACE, COMPLIANCE, LEARN = "1_Robot", "2_Workspace", "3_Compliance", "8_Learn"


def put(app: AppTest, robot: Robot) -> None:
    """Another robot in the project."""
    kept = store(app)
    kept.project = dataclasses.replace(kept.project, setup=kept.project.setup.replace(robot=robot))


def view(app: AppTest) -> MapView:
    now = store(app).project
    return now.maps.of(now.setup.robot)


def look(app: AppTest, **fields: object) -> AppTest:
    """Change what the map pages look at, and run."""
    store(app).project = store(app).project.replace(maps=dataclasses.replace(view(app), **fields))
    return app.run()


def board(app: AppTest) -> dict[str, Any]:
    """What the browser gets to draw the maps of a page."""
    sent = [json.loads(each.proto.json) for each in app.get("bidi_component") if each.proto.json]
    codes, shown = ([each for each in sent if name in each] for name in ("codes", "panels"))
    assert len(codes) == len(shown) == 1
    assert codes[0]["rev"] == shown[0]["rev"]
    return codes[0] | shown[0]


def titles(app: AppTest) -> list[str]:
    return [panel["title"] for panel in board(app)["panels"]]


def charts(app: AppTest) -> list[dict[str, object]]:
    return [json.loads(chart.proto.spec) for chart in app.get("plotly_chart")]


@pytest.mark.parametrize("picture", ["plane", "pair", "solid"])
def test_workspace_pictures(app: AppTest, picture: str) -> None:
    go(app, WORKSPACE)
    look(app, picture=picture)
    assert not app.exception
    assert errors(app) == []
    assert len(app.get("plotly_chart")) == (picture == "solid")
    if picture != "solid":
        assert len(titles(app)) == len(board(app)["at"]) == (2 if picture == "pair" else 1)
    assert "reaches all of this region and meets no singularity" in words(app)


@pytest.mark.parametrize("quantity", map_quantities(load_robot("slavkovic_5r"), "geometry"))
def test_every_quantity_says_its_formula_and_meaning(app: AppTest, quantity: str) -> None:
    go(app, WORKSPACE)
    look(app, quantity=quantity)
    assert not app.exception
    assert "<br>" in words(app)
    assert titles(app) == [map_quantity(load_robot("slavkovic_5r"), quantity).title]


def test_two_planes_are_those_of_fig_4_on_one_scale(app: AppTest) -> None:
    go(app, WORKSPACE)
    look(app, picture="pair")
    shown = board(app)
    assert [shown["w"]["drawn"][k] for k in shown["at"]] == ["-400", "100"]
    assert {panel["scale"] for panel in shown["panels"]} == {0}


def test_headline_and_tile_say_the_same_of_singularities(app: AppTest) -> None:
    """Of an arm whose det(J) has both signs the headline said "passes a singularity", the tile "no singularity"."""
    for robot in ("slavkovic_5r", "fanuc_r2000ic"):
        go(app, WORKSPACE)
        put(app, load_robot(robot))
        app.run()
        said = words(app)
        told = [fit for fit in ("passes a", "comes close to a", "meets no") if f"{fit} singularity there." in said]
        assert f"least |det(J)|; the arm {told[0]} singularity<" in said


def test_the_box_stands_beside_the_papers(app: AppTest) -> None:
    go(app, WORKSPACE)
    assert "1200 × 600 × 500 mm" in words(app)
    said = words(app)
    assert "the volume of the reference box, which stands partly outside" in said, "it ends at Y = -1537"
    assert '<div class="rm-value rm-long">2148 × 1054 × 1036<small>mm' in said, "three sides in one line"
    assert "100 × 0 × 0 mm" in said
    assert "from (−50, −1300, 0), all reached" in said


@pytest.mark.parametrize("sheet", quantities(MapView)["sheet"].options)
def test_compliance_sheets(app: AppTest, sheet: str) -> None:
    go(app, COMPLIANCE)
    look(app, sheet=sheet)
    assert not app.exception
    assert errors(app) == []
    assert len(app.get("plotly_chart")) == 3 + (sheet == "lines")  # the arm, the shares, what stiffness saves
    assert sheet == "lines" or board(app)["w"]["drawn"][board(app)["at"][0]] == "0"


def test_the_milling_point_in_words(app: AppTest) -> None:
    go(app, COMPLIANCE)
    said = words(app)
    assert "100 N on the tool moves the tip by +0.230 mm along Y, −0.102 mm along Z." in said
    assert "Of these 0.251 mm, 70 % come from joint 3 and 30 % from joint 5. At line 7 of the cut, which" in said
    assert "2.295" in said
    assert "1.134" in said


def test_nine_maps_of_six_boxes(app: AppTest) -> None:
    """C is symmetric: what stands on either side of the diagonal goes to the browser once."""
    go(app, COMPLIANCE)
    shown = board(app)
    assert titles(app) == [f"C_{i}{j}" for i in "xyz" for j in "xyz"]
    assert len(shown["codes"]) == 6
    by_title = {panel["title"]: panel["codes"] for panel in shown["panels"]}
    assert by_title["C_xy"] == by_title["C_yx"] != by_title["C_xz"]


def test_a_picked_cell_becomes_the_point(app: AppTest) -> None:
    go(app, COMPLIANCE)
    look(app, point=(0.2, -1.1, 0.0))
    assert "At the selected point (200, −1100, 0) mm" in [s.value for s in app.header]


def test_stiffer_joints_leave_a_ghost_and_can_be_put_into_the_robot(app: AppTest) -> None:
    go(app, COMPLIANCE)
    before = store(app).project.setup.robot.C_theta.copy()
    look(app, factors=(1.0, 1.0, 2.0, 1.0, 1.0))
    said = words(app)
    assert '<span class="rm-was">2.295' in said
    names = [t.get("name") for chart in charts(app) for t in chart["data"]]  # type: ignore[attr-defined]
    assert "sum before" in names
    app.button(key="maps.adopt").click().run()
    after = store(app).project.setup.robot.C_theta
    np.testing.assert_allclose(after, before / [1, 1, 2, 1, 1])
    assert view(app).factors is None
    app.button(key="undo").click().run()
    np.testing.assert_allclose(store(app).project.setup.robot.C_theta, before)


def test_table_2_against_table_3_is_one_click(app: AppTest) -> None:
    go(app, COMPLIANCE)
    look(app, sheet="compare")
    assert "Table 3 − Table 2" in titles(app)
    assert "+16 % against Table 2" in words(app)


def test_three_robots_side_by_side(app: AppTest) -> None:
    go(app, COMPLIANCE)
    look(app, sheet="compare", against=("set:table_2", "robot:kuka_kr500", "robot:planar_2r"))
    assert not app.exception
    assert len(titles(app)) == 5


@pytest.mark.parametrize("normal", ["x", "y"])
def test_upright_planes_and_tilted_tools(app: AppTest, normal: str) -> None:
    go(app, COMPLIANCE)
    look(app, normal=normal, at=None, A=np.radians(15), B=np.radians(-20))
    assert not app.exception
    assert errors(app) == []
    go(app, WORKSPACE)
    assert not app.exception


@pytest.mark.parametrize("page", [WORKSPACE, COMPLIANCE, LEARN])
@pytest.mark.parametrize("name", ["planar_2r", "kuka_kr500", "seven"])
def test_any_robot_gives_a_page(app: AppTest, page: str, name: str) -> None:
    put(app, seven() if name == "seven" else load_robot(name))
    go(app, page)
    assert not app.exception
    assert errors(app) == []
    assert page == LEARN or board(app)


def test_a_planar_arm_has_one_plane(app: AppTest) -> None:
    put(app, load_robot("planar_2r"))
    go(app, COMPLIANCE)
    assert "only XY can be shown" in words(app)
    look(app, sheet="lines")
    assert not app.exception


def test_a_robot_that_reaches_nothing_here(app: AppTest) -> None:
    go(app, COMPLIANCE)
    look(app, region="own", lower=(5.0, 5.0, 5.0), upper=(6.0, 6.0, 6.0))
    assert not app.exception
    assert any("Nothing of this region is reached" in i.value for i in app.info)
    assert "does not get to" in words(app)
    go(app, WORKSPACE)
    assert not app.exception
    assert "reaches nothing of this region" in words(app)


def test_a_tilt_nothing_reaches(app: AppTest) -> None:
    robot = load_robot("slavkovic_5r")
    put(app, robot.replace(limits=np.radians([[-5, 5]] * 5)))
    for page in (WORKSPACE, COMPLIANCE, LEARN):
        go(app, page)
        if page == WORKSPACE:
            look(app, region="largest", A=np.radians(170.0))
        assert not app.exception
        if page != LEARN:
            assert any("brings its tool nowhere at A = 170.0°" in e for e in errors(app))


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"lower": (0.5, -1.6, -0.4), "upper": (-0.5, -1.0, 0.1)}, "X ends before it begins"),
        ({"step": 0.0005}, "is more than a picture takes"),
        ({"step": 1e-6}, "use a larger step"),
    ],
)
def test_bad_regions_are_one_sentence(app: AppTest, fields: dict[str, object], sentence: str) -> None:
    go(app, COMPLIANCE)
    look(app, region="own", **fields)
    assert not app.exception
    assert any(sentence in e for e in errors(app))


def test_the_region_is_kept_over_a_page_change_and_made_anew_with_another_robot(app: AppTest) -> None:
    go(app, WORKSPACE)
    look(app, A=0.1)
    go(app, COMPLIANCE)
    assert view(app).A == 0.1
    put(app, load_robot("kuka_kr500"))
    app.run()
    assert view(app).A == 0.0
    assert view(app).region == "cut"


def test_inches(app: AppTest) -> None:
    kept = store(app)
    kept.project = dataclasses.replace(kept.project, view=dataclasses.replace(kept.project.view, units="in"))
    go(app, COMPLIANCE)
    assert "(0.00, −51.18, 0.00) in" in words(app)
    assert not app.exception


def test_a_region_of_ones_own_is_typed_in_the_unit_of_lengths(app: AppTest) -> None:
    go(app, COMPLIANCE)
    look(app, region="own")
    number(app, "maps.lower[0]:mm").set_value(-500.0).run()
    app.text_input(key="maps.step:mm").set_value("40").run()
    number(app, "maps.A:deg").set_value(10.0).run()
    assert view(app).lower.tolist() == [-0.5, -1.6, -0.4]
    assert (view(app).step, view(app).A) == (0.04, pytest.approx(np.radians(10.0)))
    app.text_input(key="maps.step:mm").set_value("").run()
    assert view(app).step is None
    app.text_input(key="maps.step:mm").set_value("0").run()
    assert any("Step: found 0 mm; expected more than 0 mm" in e for e in errors(app))
    assert not app.exception


@pytest.mark.parametrize("name", ["kuka_kr500", "kuka_kr270", "fanuc_r2000ic"])
def test_another_robot_is_looked_at_where_the_project_cuts(app: AppTest, name: str) -> None:
    """The paper's cut lies at (0, -1300, 0) mm; the largest box of these arms is elsewhere, behind a KUKA's back."""
    put(app, load_robot(name))
    result = rm.simulate(store(app).project.setup)
    deciding = result.verdict.deciding
    assert deciding is not None
    x, y, z = result.setup.in_base(result.path.p[deciding[1].worst]) * 1e3
    go(app, COMPLIANCE)
    assert f"At the selected point ({x:.0f}, {y:.0f}, {z:.0f}) mm".replace("-", "−") in [s.value for s in app.header]
    shown = board(app)
    assert shown["point"] == pytest.approx([x, y, z], abs=0.01)
    assert shown["u"]["span"][0] < 0.0 < shown["u"]["span"][1]
    assert shown["v"]["span"][0] < -1300.0 < shown["v"]["span"][1]
    cuts = [line["points"] for line in shown["outlines"] if line["kind"] == "cut"]
    assert np.mean(np.concatenate(cuts), axis=0) == pytest.approx([0.0, -1300.0], abs=1.0)


def test_what_a_stiffer_joint_saves_is_what_the_cut_simulated_anew_saves(app: AppTest) -> None:
    """Joint 3 ten per cent stiffer, by a run of its own: the tile's number, to its digits."""
    go(app, COMPLIANCE)
    setup = store(app).project.setup
    stiffer = np.array(setup.robot.C_theta)
    stiffer[2] /= 1.1
    after = rm.simulate(setup.replace(robot=setup.robot.replace(C_theta=stiffer))).max_deviation
    saved = (rm.simulate(setup).max_deviation - after) * 1e3
    chart = next(c for c in charts(app) if c["data"][0].get("y", [""])[0] == "joint 3")  # type: ignore[index]
    assert chart["data"][0]["text"][0] == f"{saved:.3f} mm"  # type: ignore[index]
    assert "of the 0.251 mm of this cut at line 7" in words(app)
    assert f"10 % stiffer saves {saved:.3f} mm of this cut at line 7" in words(app)


@pytest.fixture(scope="module")
def pocket() -> rm.SimulationSetup:
    """A rectangular pocket cut with a force from the material: its verdict is decided far from the paper's place."""
    base = preset_setup("paper_flute")
    text = "G21 G90 S12000 M3\nG0 X-20 Y-10 Z5\nG1 Z-3 F600\nG1 X20 F1800\nG1 Y10\nG1 X-20\nG1 Y-10\nG0 Z5\nM2\n"
    row = next(row for row in sample_materials() if "7075" in row.title)
    force = model_of(row)(cutter=base.cutter, material=row)
    return base.replace(source=GCodeSource(text, "pocket.ngc"), force=force, engagement=True, stock=None)


def test_every_page_names_the_joint_and_the_force_of_the_place_that_decides(
    app: AppTest, pocket: rm.SimulationSetup
) -> None:
    """Force, displacement and joint by the run itself; Start, Robot and Compliance say them in the same words."""
    kept = store(app)
    kept.project = kept.project.replace(setup=pocket)
    result = rm.simulate(pocket)
    deciding = result.verdict.deciding
    assert deciding is not None
    i = deciding[1].worst
    F, delta = result.F[i], result.delta[i]
    share = result.delta_joint[i] @ delta / (delta @ delta)
    best = int(np.argmax(share)) + 1
    said = f"{np.linalg.norm(F):.0f} N on the tool moves the tip by "
    where = f"line {result.path.block[i]} of the cut, which decides its verdict"
    assert abs(F[1]) < 0.95 * np.linalg.norm(F), "not the paper's push along Y"
    for page in ("app", ROBOT, COMPLIANCE):
        shown = words(go(app, page))
        assert not app.exception
        assert said in shown
        assert f"{100 * share[best - 1]:.0f} % come from joint {best}" in shown
        assert page == "app" or where in shown
        assert "along Y moves" not in shown
    assert f'<div class="rm-value">joint {best}</div>' in shown
    theta = number(go(app, ROBOT), "pose.box.1:deg").value
    assert theta == pytest.approx(np.degrees(result.theta[i, 1]), abs=5e-4)


def test_a_push_along_an_axis_is_chosen(app: AppTest, pocket: rm.SimulationSetup) -> None:
    kept = store(app)
    kept.project = kept.project.replace(setup=pocket)
    go(app, ROBOT)
    app.selectbox(key="view.push").set_value("x").run()
    assert "100 N along X moves the tip by " in words(app)
    assert "100 N along X moves the tip by " in words(go(app, COMPLIANCE))
    assert not store(app).past, "looking is no step to undo"
