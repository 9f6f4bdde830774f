"""Feed frames, constant and path-following forces: directions, plunges, rapids, rotation of the whole scene."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.spatial.transform import Rotation

from robomill.cutting.conditions import CutConditions
from robomill.cutting.force import (
    feed_along,
    feed_frame,
    feed_share,
    force_at_ends,
    force_by_material,
    force_on_tool,
)
from robomill.cutting.forces.along_path import PathForce
from robomill.cutting.forces.constant import ConstantForce
from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.cutting.tool import Cutter
from robomill.errors import CuttingError
from robomill.io.materials import load_material

UP = np.array([0.0, 0.0, 1.0])


def moves(p):
    """Of a path (m, 3): the move to each point, the first one none."""
    return np.diff(p, axis=0, prepend=p[:1])


def steady(m, **changes):
    return CutConditions.steady(**{"v_f": 0.03, "n_s": 200.0, "a_p": 2e-3, "cutting": np.arange(m) > 0, **changes})


def test_feed_normal_is_the_left_of_the_feed():
    p = np.array([[0, 0, 0], [1, 0, 0], [1, 2, 0], [0, 2, 0]], float)
    frames = feed_frame(moves(p), np.tile(UP, (4, 1)))
    np.testing.assert_allclose(frames[:, :, 1], [[0, 1, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]], atol=1e-15)
    np.testing.assert_allclose(frames[:, :, 2], np.tile(UP, (4, 1)))


def test_plunges_and_standstill_keep_the_last_direction_and_the_first_takes_the_next():
    p = np.array([[0, 0, 5], [0, 0, 0], [0, 3, 0], [0, 3, 4], [0, 3, 4], [1, 3, 4]], float)
    frames = feed_frame(moves(p), np.tile(UP, (6, 1)))
    np.testing.assert_allclose(frames[:, :, 0], [[0, 1, 0]] * 5 + [[1, 0, 0]], atol=1e-15)
    np.testing.assert_allclose(feed_share(moves(p), np.tile(UP, (6, 1))), [1, 0, 1, 0, 1, 1])


def test_a_path_without_any_level_move_takes_a_fixed_axis():
    p = np.array([[0, 0, 1], [0, 0, 0]], float)
    np.testing.assert_allclose(feed_frame(moves(p), [UP, UP])[1], np.eye(3))
    along_x = feed_frame(moves(p)[:, ::-1], [[1.0, 0, 0]] * 2)[1]
    np.testing.assert_allclose(along_x[:, 0], [0, 1, 0])


def test_a_direction_carried_to_a_turned_axis_stays_a_frame():
    # Feed along x, then the tool turns to lie along x and plunges: no direction is left to carry.
    p = np.array([[0, 0, 0], [1, 0, 0], [0.5, 0, 0]], float)
    frames = feed_frame(moves(p), [UP, UP, [1.0, 0, 0]])
    np.testing.assert_allclose(np.swapaxes(frames, 1, 2) @ frames, np.tile(np.eye(3), (3, 1, 1)), atol=1e-12)


def test_ramp_uses_the_level_part_of_its_feed():
    p = np.array([[0, 0, 0], [3, 0, -4]], float)
    np.testing.assert_allclose(feed_frame(moves(p), [UP, UP])[1], np.eye(3), atol=1e-15)
    assert feed_share(moves(p), [UP, UP])[1] == pytest.approx(0.6)


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_frames_are_rotations_and_turn_with_the_scene(seed):
    rng = np.random.default_rng(seed)
    p, k = rng.normal(size=(7, 3)), rng.normal(size=(7, 3))
    k /= np.linalg.norm(k, axis=1, keepdims=True)
    p[3] = p[2]
    p[5] = p[4] + k[5]
    frames = feed_frame(moves(p), k)
    np.testing.assert_allclose(np.swapaxes(frames, 1, 2) @ frames, np.tile(np.eye(3), (7, 1, 1)), atol=1e-9)
    np.testing.assert_allclose(np.linalg.det(frames), 1.0, atol=1e-9)
    turn = Rotation.random(random_state=seed).as_matrix()
    np.testing.assert_allclose(feed_frame(moves(p) @ turn.T, k @ turn.T), turn @ frames, atol=1e-7)


def test_force_on_tool_is_zero_on_rapids_and_turns_with_the_path():
    p = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 0]], float)
    frames = feed_frame(moves(p), np.tile(UP, (4, 1)))
    conditions = steady(4, cutting=[False, True, True, False])
    along = force_on_tool(PathForce(feed=-1.0, feed_normal=100.0, axial=-20.0), conditions, frames)
    np.testing.assert_allclose(along, [[0, 0, 0], [-1, 100, -20], [-100, -1, -20], [0, 0, 0]], atol=1e-12)
    constant = force_on_tool(ConstantForce([0.0, 100.0, 0.0]), conditions, frames)
    np.testing.assert_array_equal(constant, [[0, 0, 0], [0, 100, 0], [0, 100, 0], [0, 0, 0]])


def test_process_force_in_the_robot_frame():
    p = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0]], float)
    model = MechanisticForce(Cutter("flat", 8e-3, flutes=3), load_material("al7075_t6_carbide_ref190"))
    F = force_on_tool(model, steady(3), feed_frame(moves(p), np.tile(UP, (3, 1))))
    np.testing.assert_allclose(F, [[0, 0, 0], [-63.46, 110.43, -23.30], [-110.43, -63.46, -23.30]], atol=0.01)


@pytest.mark.parametrize("seed", range(3))
def test_other_materials_and_assumed_shares_push_in_the_robot_frame_too(seed):
    """Each as a force of its own that has that row alone; 0 on rapids."""
    mill, frames = Cutter("flat", 8e-3, flutes=3), Rotation.random(4, random_state=seed).as_matrix()
    conditions = steady(4, cutting=[False, True, True, False])
    row, other = load_material("al7075_t6_carbide_ref190"), load_material("al6061_t6_carbide_ref160")
    model = MechanisticForce(mill, row, alternatives=(other,))
    known = force_by_material(model, conditions, frames)
    filled = other.replace(Kac=row.Kac, Kae=row.Kae)  # its source does not give them
    for (_, F), alike in zip(known, (row, filled), strict=True):
        alone = MechanisticForce(mill, alike).components(conditions)
        expected = [R @ f for R, f in zip(frames, alone, strict=True)]
        np.testing.assert_allclose(F, expected * conditions.cutting[:, None], atol=1e-9)
    assumed = MechanisticForce(mill, other, axial_share=0.2)
    ends = force_at_ends(assumed, conditions, frames)
    assert len(ends) > 1
    for F, own in zip(ends, assumed.at_ends(conditions), strict=True):
        expected = [R @ f for R, f in zip(frames, own, strict=True)]
        np.testing.assert_allclose(F, expected * conditions.cutting[:, None], atol=1e-9)
    assert {term.exponent for row, _ in known for term in row.terms} == set(model.exponents)


def test_refusals():
    with pytest.raises(CuttingError, match=r"expected shape \(3, 3, 3\), found \(2, 3, 3\)"):
        force_on_tool(PathForce(), steady(3), np.tile(np.eye(3), (2, 1, 1)))
    with pytest.raises(CuttingError, match=r"should both be \(m, 3\)"):
        feed_frame(np.zeros((4, 3)), np.zeros((3, 3)))
    with pytest.raises(CuttingError, match="finite numbers"):
        ConstantForce([0, np.nan, 0])
    with pytest.raises(CuttingError, match=r"expected shape \(..., 3\), found \(2,\)"):
        ConstantForce([0, 1])
    with pytest.raises(CuttingError, match="Path force, Feed-normal: found"):
        PathForce(feed_normal="much")


def test_the_part_of_a_way_along_the_axis_is_its_cosine_and_nothing_where_nothing_moves():
    rng = np.random.default_rng(4)
    way, k = rng.normal(size=(9, 3)), rng.normal(size=(9, 3))
    k /= np.linalg.norm(k, axis=1, keepdims=True)
    way[[0, 4]] = 0.0
    found, moves = feed_along(way, k), [1, 2, 3, 5, 6, 7, 8]
    assert (found[0], found[4]) == (0.0, 0.0)
    for i in moves:
        assert found[i] == pytest.approx(way[i] @ k[i] / np.linalg.norm(way[i]))
    np.testing.assert_allclose(np.hypot(found, feed_share(way, k))[moves], 1.0)
    np.testing.assert_allclose(feed_along([[0, 0, 0], [0, 0, -1], [0, 0, 2], [1, 0, 0]], [UP] * 4), [0, -1, 1, 0])


def test_tool_axes_of_any_length_give_the_same_frames():
    p = np.array([[0, 0, 0], [1.0, 0.2, 0.3], [1.0, 2.0, 0.1], [1.5, 2.0, 0.1]])
    k = np.array([[0, 0, 1.0], [0.1, 0, 1.0], [0.0, 0.3, 1.0], [0.2, 0.2, 1.0]])
    unit = k / np.linalg.norm(k, axis=1, keepdims=True)
    np.testing.assert_allclose(feed_frame(moves(p), 3.0 * k), feed_frame(moves(p), unit), atol=1e-14)
    np.testing.assert_allclose(feed_share(moves(p), 0.2 * k), feed_share(moves(p), unit), atol=1e-14)
    step = p[1] - p[0]
    along = (step @ unit[1]) / np.linalg.norm(step)
    assert feed_share(moves(p), 5.0 * k)[1] == pytest.approx(np.sqrt(1.0 - along**2))


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e3])
def test_frames_are_the_same_however_long_the_ways_are(scale):
    """Steps of a micrometre as those of a metre, with plunges that carry a direction on to an axis that has turned."""
    rng = np.random.default_rng(12)
    way, k = rng.normal(size=(12, 3)), rng.normal(size=(12, 3))
    k /= np.linalg.norm(k, axis=1, keepdims=True)
    way[[0, 6]] = 0.0
    way[[3, 4, 9]] = -2.0 * k[[3, 4, 9]]
    np.testing.assert_allclose(feed_frame(scale * way, k), feed_frame(way, k), atol=1e-9)
    np.testing.assert_allclose(feed_share(scale * way, k), feed_share(way, k), atol=1e-9)
    np.testing.assert_allclose(feed_along(scale * way, k), feed_along(way, k), atol=1e-9)
