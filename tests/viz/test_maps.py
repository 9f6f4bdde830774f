"""Maps, voxels, ellipsoid and bars: the figures hold the numbers they are given."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.units import UNITS
from robomill.viz.arm import ArmScene, arm_figure
from robomill.viz.ellipsoid import ellipsoid_mesh, ellipsoid_scale, ellipsoid_traces
from robomill.viz.lesson import ray_figure
from robomill.viz.maps import Scale, symmetric_limit
from robomill.viz.shares import LinePanel, gain_bars, line_panels, share_bars
from robomill.viz.theme import JOINT_COLOURS
from robomill.viz.voxels import outer_faces, voxel_trace, widen, wire_box
from robomill.workspace.quantities import map_quantity


@pytest.mark.parametrize("name", ["det_J", "C_yy", "C_xy", "reach", "dominant", "limit_distance"])
def test_the_scale_of_a_quantity_holds_its_values(name: str) -> None:
    what = map_quantity(rm.load_robot("slavkovic_5r"), name)
    for shown in (np.array([[-2.0, 5.0], [np.nan, 1.0]]), np.array([[2.0, 5.0], [np.nan, 1.0]])):
        scale = Scale.of(what, shown, (1, 3))
        assert (scale.low, scale.high) == (np.nanmin(shown), np.nanmax(shown))
        assert scale.title == what.label
        assert scale.digits == UNITS[what.unit].digits
        signed = name in ("det_J", "C_xy")
        size = "able" if name in ("det_J", "limit_distance") else "sequential"
        expected = {"reach": "reach", "dominant": "joints"}.get(
            name, "diverging" if signed and shown[0, 0] < 0 else size
        )
        assert scale.kind == expected
        shades = scale.colours(dark=False)
        if expected == "diverging":
            assert -shades["cmin"] == shades["cmax"] == 5.0  # white is zero
        elif expected == size:
            assert (shades["cmin"], shades["cmax"]) == (scale.low, scale.high)
    nowhere = Scale.of(what, np.full((2, 2), np.nan), (1, 3))
    assert (nowhere.low, nowhere.high) == (0.0, 1.0)


def brightness(colour: str) -> float:
    return sum(share * int(colour[k : k + 2], 16) for share, k in zip((0.30, 0.59, 0.11), (1, 3, 5), strict=True))


def test_dark_is_stiff_and_dark_is_able() -> None:
    """One rule for every map of sizes: the bright end is the one to beware of."""
    robot = rm.load_robot("slavkovic_5r")
    soft = Scale.of(map_quantity(robot, "C_yy"), np.array([1.0, 4.0]), (1,)).colours(dark=False)["colorscale"]
    able = Scale.of(map_quantity(robot, "det_J"), np.array([0.2, 2.0]), (1,)).colours(dark=False)["colorscale"]
    turned = Scale.of(map_quantity(robot, "det_J"), np.array([-2.0, -0.2]), (1,)).colours(dark=False)["colorscale"]
    assert brightness(soft[0][1]) < brightness(soft[-1][1])
    assert brightness(able[0][1]) > brightness(able[-1][1])
    assert brightness(turned[0][1]) < brightness(turned[-1][1]), "the lowest is the largest by size"
    assert [share for share, _ in turned] == [share for share, _ in able]


def test_symmetric_limit_of_what_is_nowhere_reached() -> None:
    assert symmetric_limit([np.full((2, 2), np.nan)]) == 1.0
    assert symmetric_limit([np.array([1.0, -3.0, np.nan])]) == 3.0


def test_voxels_show_only_outer_faces() -> None:
    assert len(outer_faces(np.ones((1, 1, 1), bool))[0]) == 6
    assert len(outer_faces(np.ones((2, 3, 4), bool))[0]) == 2 * (2 * 3 + 3 * 4 + 2 * 4)
    hollow = np.ones((3, 3, 3), bool)
    hollow[1, 1, 1] = False
    assert len(outer_faces(hollow)[0]) == 54 + 6


def test_voxels_close_their_volume() -> None:
    """Divergence theorem over the triangles: the signed volume is that of the cells."""
    mask = np.random.default_rng(1).random((4, 5, 3)) > 0.4
    axes = tuple(np.arange(n) * step for n, step in zip(mask.shape, (0.1, 0.2, 0.3), strict=True))
    trace = voxel_trace(mask, axes, dark=False)  # type: ignore[arg-type]
    points = np.stack([trace[a] for a in "xyz"], axis=-1).astype(float)
    a, b, c = (points[np.asarray(trace[k])] for k in "ijk")
    volume = abs(np.einsum("fi,fi->f", a, np.cross(b, c)).sum()) / 6.0
    assert volume == pytest.approx(mask.sum() * 0.1 * 0.2 * 0.3, rel=1e-5)


def test_voxels_carry_the_values_of_their_cells() -> None:
    mask = np.ones((2, 1, 1), bool)
    shown = np.array([1.0, 2.0]).reshape(2, 1, 1)
    trace = voxel_trace(mask, (np.array([0.0, 1.0]), np.zeros(1), np.zeros(1)), (shown, Scale("", 1.0, 2.0)), dark=True)
    assert sorted(np.asarray(trace["intensity"]).tolist()) == [1.0] * 10 + [2.0] * 10


def test_a_box_has_twelve_edges_and_a_name() -> None:
    edges, word = wire_box(np.zeros(3), np.ones(3), "#123456", "the box")
    assert np.isnan(edges["x"]).sum() == 12
    assert word["text"] == ["the box"]


def test_a_widened_scene_holds_the_box_to_scale() -> None:
    frames = np.stack([np.eye(4), np.eye(4)])
    frames[1, :3, 3] = [0.0, -1.0, 0.5]
    fig = arm_figure(ArmScene(frames=frames), dark=False)
    widen(fig, np.array([-3.0, -3.0, -3.0]), np.array([1.0, 1.0, 4.0]))
    spans = [np.ptp(fig.figure.layout.scene[f"{a}axis"].range) for a in "xyz"]
    ratios = [fig.figure.layout.scene.aspectratio[a] for a in "xyz"]
    np.testing.assert_allclose(np.array(ratios) / spans, ratios[0] / spans[0])
    assert fig.figure.layout.scene.zaxis.range[1] >= 4.0


def test_every_point_of_the_ellipsoid_is_where_a_unit_force_leads() -> None:
    A = np.random.default_rng(2).normal(size=(3, 3))
    C = A @ A.T * 1e-6
    centre = np.array([0.1, -1.3, 0.2])
    times = ellipsoid_scale(C, 0.2)
    points, _ = ellipsoid_mesh(C, centre, times)
    forces = np.linalg.solve(C, (points - centre).T / times)
    np.testing.assert_allclose(np.linalg.norm(forces, axis=0), 1.0, atol=1e-9)
    assert np.linalg.norm(points - centre, axis=1).max() == pytest.approx(0.2, rel=0.02)


def test_no_ellipsoid_for_an_arm_that_does_not_give() -> None:
    assert ellipsoid_traces(np.zeros((3, 3)), np.zeros(3), 1.0, dark=False, width=0.01) == ([], [])


def test_share_bars_end_at_the_sum_and_show_the_ghost() -> None:
    shares = np.array([[1.0, -0.5], [0.3, 0.2]])
    fig = share_bars(["a", "b"], shares, (1, 3), "µm/N", dark=False, old=np.array([2.0, 0.0]))
    bars = [t for t in fig.figure.data if t.type == "bar"]
    np.testing.assert_allclose(np.sum([t.x for t in bars], axis=0), [1.3, -0.3])
    marks = {t.name: list(t.x) for t in fig.figure.data if t.type == "scatter"}
    assert marks == {"sum before": [2.0, 0.0], "sum": [1.3, -0.3]}
    assert [a.text for a in fig.figure.layout.annotations] == ["+1.300", "−0.300"]


def test_no_ghost_without_a_change() -> None:
    shares = np.array([[1.0], [0.3]])
    fig = share_bars(["a"], shares, (1, 2), "µm/N", dark=True, old=shares.sum(axis=0))
    assert "sum before" not in {t.name for t in fig.figure.data}


def test_gains_and_lines_are_drawn() -> None:
    gains = gain_bars(np.array([0.1, 2.0, -1.0]), "mm", 3, (1, 3, 4), dark=False, height=200)
    assert list(gains.figure.data[0].y) == ["joint 3", "joint 1", "joint 4"], "the best on top"
    assert list(gains.figure.data[0].marker.color) == [JOINT_COLOURS[k] for k in (1, 0, 2)], "in the joint's colour"
    s = np.linspace(0, 1, 5)
    by_joint = np.stack([s, 2 * s], axis=-1)
    panels = [LinePanel(f"line {i}", s, by_joint.sum(axis=1), by_joint, old=s) for i in range(6)]
    fig = line_panels(panels, (1, 2), ["X"] * 6, "mm", dark=False)
    assert len(fig.figure.data) == 6 * 4
    assert fig.figure.layout.yaxis.range == fig.figure.layout.yaxis6.range
    assert fig.figure.layout.xaxis.range == (-0.06, 1.06)
    assert fig.figure.layout.xaxis2.domain[0] - fig.figure.layout.xaxis.domain[1] >= 0.07
    empty = line_panels([LinePanel("", s, s * np.nan, by_joint * np.nan)], (1, 2), ["X"], "mm", dark=False)
    assert empty.figure.layout.yaxis.range is not None


def test_the_lesson_marks_where_the_arm_is() -> None:
    s = np.linspace(0, 1, 5)
    fig = ray_figure(s, 3, ("r", "det", "soft"), (s**2, 1 - s), dark=True)
    marks = [t for t in fig.figure.data if t.mode == "markers"]
    assert [(t.x[0], t.y[0]) for t in marks] == [(0.75, 0.5625), (0.75, 0.25)]
