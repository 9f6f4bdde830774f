"""Straight passes moved by known deviations, and the section across one of them."""

from __future__ import annotations

import numpy as np

from robomill.cutting.tool import Cutter
from robomill.surface.sections.groove import groove_sections
from robomill.surface.stock import Stock
from robomill.surface.swept import CutPath

FLAT, THIN = Cutter("flat", 0.008, flutes=3), Cutter("flat", 0.003)
BALL, CONE = Cutter("ball", 0.008), Cutter("chamfer", 0.01, tip_angle=np.radians(90.0), tip_diameter=1e-3)
BULL = Cutter("bull", 0.008, corner_radius=1e-3)
STOCK = Stock((-0.06, -0.03, -0.01), (0.06, 0.03, 0.0))
MOVED = np.array([0.0, 0.15e-3, -0.06e-3])  # feed, feed-normal, up
EXACT = 1e-8  # m: a ten-thousandth of a usual cell


def passes(*lines, step=1e-3, angle=0.0):
    """Straight passes (x0, y0, z0, x1, y1, z1) mm at feed with rapids between them: points m, cutting (m,), which pass
    (m,); turned by ``angle`` degrees about Z."""
    points, cutting, which = [], [], []
    for number, line in enumerate(lines):
        a, b = 1e-3 * np.array(line[:3], dtype=float), 1e-3 * np.array(line[3:], dtype=float)
        count = max(int(np.ceil(np.linalg.norm(b - a) / step)), 1)
        points.append(a + np.linspace(0, 1, count + 1)[:, None] * (b - a))
        cutting += [False] + [True] * count
        which += [number] * (count + 1)
    turn = np.radians(angle)
    R = np.array([[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    return np.vstack(points) @ R.T, np.array(cutting), np.array(which), R


def middle_of(p, cutting, which, number):
    """Station (m) in the middle of a pass."""
    s = np.cumsum(np.append(0.0, np.where(cutting[1:], np.linalg.norm(np.diff(p, axis=0), axis=1), 0.0)))
    own = s[which == number]
    return 0.5 * (own[0] + own[-1])


def section(lines, cutter, *, number=0, moved=MOVED, stock=STOCK, angle=0.0, k=None, off=0.0):
    """The section in the middle of pass ``number`` (``off`` m further); ``moved`` (3,) or one for each pass, along the
    shape's own axes."""
    p, cutting, which, R = passes(*lines, angle=angle)
    delta = (np.broadcast_to(moved, (len(lines), 3))[which]) @ R.T
    station = middle_of(p, cutting, which, number) + off
    return groove_sections(stock, cutter, CutPath(p, p + delta, cutting, k), [station])[0]


def slot(y=0.0, z=-2.0, x=50.0):
    return (-x, y, z, x, y, z)


def degrees(angle):
    return float(np.degrees(angle))
