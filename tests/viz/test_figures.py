"""Every figure builds in both themes, names its axes with units and keeps its camera."""

from __future__ import annotations

import json

import numpy as np
import plotly.graph_objects as go
import pytest

from robomill.io.projects import load_setup
from robomill.io.samples import samples_dir
from robomill.kinematics.forward import joint_frames
from robomill.simulation.enlarged import enlarged
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import simulate
from robomill.units import from_si
from robomill.viz.along import MAX_POINTS, thin
from robomill.viz.arm import ArmScene, arm_figure, displacement_scale
from robomill.viz.deviation import Components, Shares, components_figure, shares_figure
from robomill.viz.sections import section_figure
from robomill.viz.surfaces import MAX_CELLS, surface_figure, thinned
from robomill.viz.theme import diverging, joint_colours
from robomill.viz.views import arm_scene, section_drawing


@pytest.fixture(scope="module")
def result() -> SimulationResult:
    return simulate(load_setup(samples_dir() / "paper_flute" / "setup.toml"))


def figures(result: SimulationResult, dark: bool) -> dict[str, go.Figure]:
    s, delta = from_si(result.path.s, "mm"), from_si(result.delta, "mm")
    shown = enlarged(result, 10.0)
    groove = result.groove(0.5 * float(result.path.s[-1]))
    names = [f"joint {i}" for i in range(1, 6)]
    shares = Shares(s, from_si(result.delta_joint[:, :, 1], "mm"), names, delta[:, 1], "y", "mm")
    return {
        "arm": arm_figure(arm_scene(result, result.worst), dark=dark),
        "components": components_figure(Components(s, delta, result.path.block, 0.3, "mm"), dark=dark, station=50.0),
        "shares": shares_figure(shares, dark=dark),
        "section": section_figure(section_drawing(groove, "mm"), dark=dark),
        "surface": surface_figure(shown, 0.3e-3, "mm", dark=dark),
    }


@pytest.mark.parametrize("dark", [False, True])
def test_axes_have_units_and_views_are_kept(result: SimulationResult, dark: bool) -> None:
    for name, figure in figures(result, dark).items():
        layout = json.loads(figure.to_json())["layout"]
        assert layout["height"] > 200, name
        assert layout["uirevision"], name
        holder = layout.get("scene", layout)
        if "scene" in layout:
            assert holder["uirevision"], name
            assert holder["camera"]["projection"]["type"] == "orthographic", name
        for axis in ("xaxis", "yaxis"):
            text = holder[axis]["title"]["text"]
            assert any(f", {unit}" in text for unit in ("m", "mm")), (name, text)


def test_two_themes_differ(result: SimulationResult) -> None:
    for name, light in figures(result, False).items():
        assert light.to_json() != figures(result, True)[name].to_json(), name
        break


def test_signed_colours_are_symmetric_about_zero(result: SimulationResult) -> None:
    for dark in (False, True):
        assert [stop for stop, _ in diverging(dark)] == [0.0, 0.25, 0.5, 0.75, 1.0]
        surface = figures(result, dark)["surface"].data[0]
        assert surface.cmin == -surface.cmax


def test_joint_colours_are_distinct() -> None:
    for dark in (False, True):
        assert len(set(joint_colours(7, dark))) == 7


def test_drawn_displacement_says_its_scale(result: SimulationResult) -> None:
    scene = arm_scene(result, result.worst)
    assert scene.displacement is not None
    assert 500 < displacement_scale(scene.displacement, scene.frames) < 5000


def test_the_arm_stands_where_its_kinematics_put_it(result: SimulationResult) -> None:
    """The tip against the pose the path asked for; every joint turned about {M}'s upright axis as joint 1 turns."""
    robot, i = result.setup.robot, result.worst
    told = result.setup.T_MW @ np.append(result.path.p[i], 1.0)

    def joints(theta: np.ndarray) -> np.ndarray:
        fig = arm_figure(ArmScene(frames=joint_frames(robot, theta)), dark=False)
        (hover,) = [t for t in fig.data if t.type == "scatter3d" and t.mode == "markers"]
        assert hover.text[-1] == "tool tip {T}"
        return np.stack([hover.x, hover.y, hover.z], axis=1).astype(float)

    here = joints(result.theta[i])
    assert len(here) == robot.n + 1
    np.testing.assert_allclose(here[-1], told[:3], atol=1e-6)
    turn = np.array(result.theta[i])
    turn[0] += 0.3
    there = joints(turn)
    np.testing.assert_allclose(there[:, 2], here[:, 2], atol=1e-9)
    np.testing.assert_allclose(np.hypot(*there[:, :2].T), np.hypot(*here[:, :2].T), atol=1e-9)
    angle = np.angle((there[-1, 0] + 1j * there[-1, 1]) / (here[-1, 0] + 1j * here[-1, 1]))
    assert abs(angle) == pytest.approx(0.3)


def test_the_components_drawn_are_the_deflection_and_the_worst_point_is_among_them(result: SimulationResult) -> None:
    delta = from_si(result.delta, "mm")
    s = from_si(result.path.s, "mm")
    fig = components_figure(Components(s, delta, result.path.block, 0.3, "mm"), dark=False)
    curves = {t.name: np.asarray(t.y, dtype=float) for t in fig.data}
    total = sum(curves[f"δ<sub>{a}</sub>"] ** 2 for a in "XYZ")
    np.testing.assert_allclose(np.sqrt(total), curves["size"], equal_nan=True)
    assert np.nanmax(curves["size"]) == pytest.approx(1e3 * np.nanmax(np.linalg.norm(result.delta, axis=1)))


def test_section_is_upright_at_the_measured_walls(result: SimulationResult) -> None:
    drawing = section_drawing(result.groove(0.05), "mm")
    steep = np.abs(np.diff(drawing.machined)) > 1.0
    assert steep.sum() == 2
    assert np.diff(drawing.u)[steep] == pytest.approx(0.0)
    walls = sorted(drawing.u[:-1][steep])
    assert walls == pytest.approx(sorted([drawing.wall_left, drawing.wall_right]))
    assert drawing.centre_offset == pytest.approx(0.2295, abs=5e-4)


def test_large_runs_are_thinned_for_the_screen_only() -> None:
    keep = thin(1_000_000, [123_457])
    assert len(keep) <= MAX_POINTS + 1
    assert 123_457 in keep
    x, y = np.arange(1000.0), np.arange(900.0)
    _, _, z = thinned(x, y, np.zeros((1000, 900)))
    assert z.size <= MAX_CELLS
