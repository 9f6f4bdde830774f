"""The drawn arm against its kinematics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.kinematics.forward import joint_frames
from robomill.simulation.result import SimulationResult
from robomill.viz.arm import ArmScene, arm_figure, displacement_scale
from robomill.viz.rendered.framing import screen
from robomill.viz.solids import yardstick
from robomill.viz.views import arm_scene


def test_drawn_displacement_says_its_scale(result: SimulationResult) -> None:
    scene = arm_scene(result, result.worst)
    assert scene.displacement is not None
    assert 500 < displacement_scale(scene.displacement, scene.frames) < 5000


@pytest.mark.parametrize("what", ["force", "displacement"])
def test_more_is_drawn_longer_and_nothing_beyond_a_third_of_the_arm(result: SimulationResult, what: str) -> None:
    scene = replace(arm_scene(result, result.worst), part=None, path=None, T_MW=None, aspect=1.1)
    given = getattr(scene, what)
    assert given is not None
    tip, other = scene.frames[-1][:3, 3], "displacement" if what == "force" else "force"

    def length(times: float) -> float:
        fig = arm_figure(replace(scene, **{what: times * given, other: None}), dark=False).figure
        bare = arm_figure(replace(scene, **{what: None, other: None}), dark=False).figure
        drawn, before = (np.stack([t.x, t.y, t.z], axis=1) for t in (fig.data[0], bare.data[0]))
        new = {tuple(point) for point in drawn.tolist()} - {tuple(point) for point in before.tolist()}
        return float(np.linalg.norm(np.array(sorted(new)) - tip, axis=1).max())

    lengths = [length(times) for times in (0.5, 1.0, 1.1, 3.0, 100.0)]
    assert lengths == sorted(lengths)
    assert min(np.diff(lengths)) > 0.02 * lengths[1] / 2
    assert lengths[-1] < 0.34 * yardstick(scene.frames)


def test_the_joints_of_an_arm_with_a_held_axis_keep_their_numbers() -> None:
    robot = rm.load_robot("slavkovic_5r").replace(blocked=np.array([np.nan, 0.1, np.nan, np.nan, np.nan]))
    fig = arm_figure(ArmScene(joint_frames(robot, np.zeros(4)), joints=robot.joint_numbers), dark=False)
    (hover,) = [t for t in fig.figure.data if t.type == "scatter3d" and t.mode == "markers"]
    assert [text.partition("<br>")[0] for text in hover.text] == [
        "joint 1",
        "joint 3",
        "joint 4",
        "joint 5",
        "tool tip {T}",
    ]


def test_an_arm_in_feet_stands_in_the_same_place_between_round_numbers_of_feet() -> None:
    robot = rm.load_robot("slavkovic_5r")
    scene = ArmScene(joint_frames(robot, np.zeros(5)), joints=robot.joint_numbers)
    metric, feet = (arm_figure(replace(scene, unit=unit), dark=False).figure for unit in ("m", "ft"))
    for one, other in zip(metric.data, feet.data, strict=True):
        np.testing.assert_array_equal(one.x, other.x)
    axis = feet.layout.scene.zaxis
    assert axis.title.text == "Z<sub>M</sub>, ft"
    assert len(axis.tickvals) >= 2
    np.testing.assert_allclose([0.3048 * float(text.replace("−", "-")) for text in axis.ticktext], axis.tickvals)
    assert all(metric.layout.scene.zaxis.range[0] <= v <= metric.layout.scene.zaxis.range[1] for v in axis.tickvals)
    (hover,) = [t for t in feet.data if t.type == "scatter3d" and t.mode == "markers"]
    tip = [float(v.replace("−", "-")) for v in hover.text[-1].partition("<br>")[2].removesuffix(" ft").split(", ")]
    np.testing.assert_allclose(0.3048 * np.array(tip), [hover.x[-1], hover.y[-1], hover.z[-1]], atol=2e-4)


def test_the_arm_stands_where_its_kinematics_put_it(result: SimulationResult) -> None:
    """The tip against the pose the path asked for; every joint turned about {M}'s upright axis as joint 1 turns."""
    robot, i = result.setup.robot, result.worst
    told = result.setup.T_MW @ np.append(result.path.p[i], 1.0)

    def joints(theta: np.ndarray) -> np.ndarray:
        fig = arm_figure(ArmScene(frames=joint_frames(robot, theta)), dark=False)
        (hover,) = [t for t in fig.figure.data if t.type == "scatter3d" and t.mode == "markers"]
        assert hover.text[-1].startswith("tool tip {T}<br>")
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


@pytest.mark.parametrize("force", [(0, 1, 0), (0, -1, 0), (1, 0.2, -0.5), (0, 0, 1), (0.3, -1, 0.4)])
@pytest.mark.parametrize("moved", [(0, 1, -0.4), (0, -1, 0.2), (-1, 0, 0), (0.3, 1, -0.6)])
def test_the_words_of_force_and_displacement_never_cross_each_other(force: tuple, moved: tuple) -> None:
    """On the screen, as wide and high as they are set in the narrowest picture."""
    arrows = {"force": np.array(force, dtype=float), "displacement": np.array(moved, dtype=float)}
    labels = {"force_label": "1429 N", "displacement_label": "3.73 mm"}
    scene = ArmScene(joint_frames(rm.load_robot("slavkovic_5r"), np.zeros(5)), **arrows, **labels)
    (words,) = [t for t in arm_figure(scene, dark=False).figure.data if t.name == "words"]
    right, up = screen(np.array(scene.eye))
    boxes = {}
    for k, (word, place) in enumerate(zip(words.text, words.textposition, strict=True)):
        point = np.array([words.x[k], words.y[k], words.z[k]])
        beside, above = {"left": -1, "center": 0, "right": 1}, {"bottom": -1, "middle": 0, "top": 1}
        level, side = place.split()
        size = np.array([0.2, 0.06]) * yardstick(scene.frames)
        boxes[word] = np.array([point @ right, point @ up]) + 0.5 * size * [beside[side], above[level]]
    apart = np.abs(boxes["1429 N"] - boxes["3.73 mm"])
    assert (apart >= 0.999 * size).any()


@pytest.mark.parametrize("dark", [True, False])
def test_an_arm_that_fills_its_frame_shows_the_part_too_and_has_no_axes_that_could_be_cut(
    result: SimulationResult, dark: bool
) -> None:
    fig = arm_figure(replace(arm_scene(result, result.worst), aspect=1.1), dark=dark).figure
    (part,) = [t for t in fig.data if t.name == "part"]
    corners = np.stack([part.x, part.y, part.z], axis=1)
    tip = (result.setup.T_MW @ np.append(result.path.p[result.worst], 1.0))[:3]
    assert (corners.min(axis=0) - 1e-3 <= tip).all()
    assert (tip <= corners.max(axis=0) + 1e-3).all()
    assert not any(fig.layout.scene[f"{axis}axis"].visible for axis in "xyz")
    assert {"100 N", "0.251 mm", "{W}", "{M}"} <= {each.text for each in fig.layout.scene.annotations}
