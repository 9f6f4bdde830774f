"""Which poses are left out together in cross-validation."""

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.errors import LoadTestError

FOLDS = 10
LEAVE_OUT = {"pose": "poses anywhere, fixed shuffle", "neighbours": "neighbouring poses together"}


def folds_of(by: str, pose: IntArray, theta: FloatArray | None) -> IntArray:
    """(m,) fold of each test, tests of a pose together; ``by`` names one of ``LEAVE_OUT``.

    pose (m,) number of each test's pose, theta (m, n) its configuration (None: nothing lies beside anything).
    """
    if by not in LEAVE_OUT:
        raise LoadTestError(f"Leaving out {by!r}: expected one of {', '.join(LEAVE_OUT)}.")
    if by == "pose" or theta is None:
        return fold_of_pose(int(pose.max()) + 1)[pose]
    return fold_of_neighbours(theta[np.unique(pose, return_index=True)[1]])[pose]


def fold_of_pose(poses: int, folds: int = FOLDS) -> IntArray:
    """(poses,) fold of each pose: at most ``folds``, of equal size, spread by a fixed shuffle."""
    order = np.random.default_rng(2013).permutation(poses)
    fold = np.empty(poses, dtype=np.int64)
    fold[order] = np.arange(poses) % min(folds, poses)
    return fold


def fold_of_neighbours(theta: FloatArray, folds: int = FOLDS) -> IntArray:
    """(poses,) fold of each configuration (poses, n): at most ``folds`` blocks of near equal size, each of neighbours.

    The joint space, each joint counted by its spread, is cut across its longest side again and again.
    """
    spread = theta.std(axis=0)
    place = theta / np.where(spread > 0, spread, np.inf)
    fold = np.zeros(len(theta), dtype=np.int64)
    made = 1

    def split(members: IntArray, parts: int) -> None:
        nonlocal made
        if parts < 2:
            return
        along = place[members, np.argmax(np.ptp(place[members], axis=0))]
        order = members[np.argsort(along, kind="stable")]
        first = parts // 2
        cut = round(len(order) * first / parts)
        fold[order[cut:]] = made
        made += 1
        split(order[:cut], first)
        split(order[cut:], parts - first)

    split(np.arange(len(theta)), min(folds, len(theta)))
    return fold
