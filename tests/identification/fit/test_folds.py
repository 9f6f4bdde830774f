"""Blocks of neighbours: of near equal size, each cut by a plane from the rest, however joints are scaled."""

import numpy as np
import pytest

from robomill.errors import LoadTestError
from robomill.identification.fit.folds import fold_of_neighbours, folds_of


@pytest.mark.parametrize("poses", [1, 3, 7, 40, 101])
@pytest.mark.parametrize("folds", [1, 2, 5])
def test_blocks_are_of_near_equal_size_whatever_a_joints_range_is(poses, folds):
    rng = np.random.default_rng(poses)
    theta = rng.normal(size=(poses, 4))
    found = fold_of_neighbours(theta, folds)
    sizes = np.bincount(found)
    assert len(sizes) == min(folds, poses)
    assert sizes.min() >= poses // folds - 1
    assert sizes.max() <= poses / min(folds, poses) + 2
    np.testing.assert_array_equal(
        fold_of_neighbours(theta * [1e-3, 1.0, 50.0, 7.0] + [9.0, 0.0, -4.0, 1.0], folds), found
    )
    for value in (0.0, 0.7):  # a joint that stands still says nothing of who is near
        still = np.insert(theta, 2, value, axis=1)
        np.testing.assert_array_equal(fold_of_neighbours(still, folds), found)


def test_poses_along_one_joint_are_cut_in_their_order():
    theta = np.random.default_rng(3).permutation(30)[:, None] * 0.1
    found = fold_of_neighbours(np.concatenate([theta, np.zeros((30, 2))], axis=1), 5)
    in_order = found[np.argsort(theta[:, 0])]
    assert (np.diff(in_order) != 0).sum() == 4
    assert np.bincount(found).tolist() == [6] * 5


def test_what_is_left_out_together_is_as_it_is_asked():
    """Forty poses along one joint, three tests each: anywhere, or blocks that no other one comes between."""
    pose = np.tile(np.arange(40), 3)
    theta = np.outer(0.1 * pose, [1.0, 0.0])
    anywhere, near = folds_of("pose", pose, theta), folds_of("neighbours", pose, theta)
    for fold in (anywhere, near):
        assert np.bincount(fold).tolist() == [12] * 10
        np.testing.assert_array_equal(fold.reshape(3, 40), [fold[:40]] * 3)
    assert (np.diff(near[:40]) != 0).sum() == 9
    assert (np.diff(anywhere[:40]) != 0).sum() > 25
    np.testing.assert_array_equal(folds_of("pose", pose, np.sin(9.0 * theta)), anywhere)
    np.testing.assert_array_equal(folds_of("neighbours", pose, None), anywhere)
    with pytest.raises(LoadTestError, match="expected one of pose, neighbours"):
        folds_of("row", pose, theta)
