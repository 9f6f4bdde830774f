"""The search for lengths that the paper's claims allow: by plane geometry, over a grid, nothing drawn at random.

Tried: a_2 and d_4 from 0.80 to 1.60 m every 40 mm, a_5 from 0.10 to 0.60 m every 16 mm: 14 112 geometries. One is as
good as ours if

- the whole box is within its links' reach (Fig. 3), and |det J| is at least 0.1 m^3 all over it (Fig. 4);
- 100 N move the tip by 0.23 mm in Y at (0, -1300, 0) mm, as printed (0.225 to 0.235 mm);
- over the plane Z = 0, C_xx and C_zz fall with Y and grow with |X|, and C_yy falls with |X| (Fig. 5): all trends but
  one, C_yy growing with Y, which no geometry has all over the plane;
- joints 1, 3, 5 make at least 90 % of the mean size of C_xx, C_yy and C_xy (Figs. 6, 7).

``python -m tests.paper.lengths`` prints them as ``robomill/report/paper_lengths.py`` holds them.
"""

from __future__ import annotations

import itertools
from unittest import mock

import numpy as np

from robomill.report.paper import TABLES
from tests.paper import arm

LONG = np.arange(800, 1601, 40)
SHORT = np.arange(100, 601, 16)
C_THETA = np.array(TABLES["table_2"]) * 1e-7
X, Y = np.meshgrid(np.linspace(-0.6, 0.6, 13), np.linspace(-1.6, -1.0, 7), indexing="ij")
RIGHT = X[:, 0] > -1e-9
BOX = np.meshgrid(np.linspace(0, 0.6, 5), np.linspace(-1.6, -1, 5), np.linspace(-0.4, 0.1, 5), indexing="ij")
JOINTS_1_3_5 = [0, 2, 4]


def with_lengths(a_2, d_4, a_5):
    """The plane arm with other lengths, m."""
    return mock.patch.multiple(arm, A_2=a_2, D_4=d_4, A_5=a_5)


def as_good(a_2, d_4, a_5) -> bool:
    """Whether the paper allows these lengths, m, as it does ours."""
    with with_lengths(a_2, d_4, a_5):
        reach = np.hypot(np.hypot(BOX[0], BOX[1]), BOX[2] + a_5)
        if reach.max() >= a_2 + d_4 or reach.min() <= abs(a_2 - d_4) or arm.determinant(*BOX).min() < 0.1:
            return False
        if not 0.225e-3 <= 100 * arm.shares(0.0, -1.3, 0.0, C_THETA).sum(0)[1, 1] <= 0.235e-3:
            return False
        shares = arm.shares(X, Y, 0.0, C_THETA)
    C = shares.sum(axis=2)
    for i in (0, 2):
        if not ((np.diff(C[..., i, i], axis=1) < 0).all() and (np.diff(C[RIGHT, ..., i, i], axis=0) > 0).all()):
            return False
    if not (np.diff(C[RIGHT, ..., 1, 1], axis=0) < 0).all():
        return False
    sizes = np.abs(shares).mean(axis=(0, 1))
    return all(sizes[JOINTS_1_3_5, i, j].sum() >= 0.9 * sizes[:, i, j].sum() for i, j in ((0, 0), (1, 1), (0, 1)))


def search() -> list[tuple[int, int, int]]:
    """(a_2, d_4, a_5) mm of all that are as good."""
    tried = itertools.product(LONG.tolist(), LONG.tolist(), SHORT.tolist())
    return [each for each in tried if as_good(*(length * 1e-3 for length in each))]


if __name__ == "__main__":
    for a_2, group in itertools.groupby(search(), key=lambda each: each[0]):
        rows = [(d_4, [a for _, _, a in same]) for d_4, same in itertools.groupby(group, key=lambda each: each[1])]
        print(f"    {a_2}: {{{', '.join(f'{d}: {tuple(a)}' for d, a in rows)}}},")
