"""Speed of the cut, beside peers, and how time grows. Run with -m benchmark -s to see the figures."""

import resource
import time
from itertools import pairwise

import numpy as np
import pytest
import shapely

from robomill.cutting.tool import Cutter
from robomill.surface.contact.engagement import engage
from robomill.surface.contact.march import March
from robomill.surface.sections.groove import groove_sections
from robomill.surface.stock import Stock
from robomill.surface.swept import CutPath
from robomill.surface.zmap import cut

pytestmark = pytest.mark.benchmark

FLAT = Cutter("flat", 0.008)
STOCK = Stock((0.0, 0.0, -0.01), (0.2, 0.1, 0.0))


def best_of(job, times=5):
    spent = []
    for _ in range(times):
        start = time.perf_counter()
        job()
        spent.append(time.perf_counter() - start)
    return min(spent)


def connected(n=100, length=0.05, seed=1):
    rng, points = np.random.default_rng(seed), [np.array([0.1, 0.05])]
    while len(points) <= n:
        angle = rng.uniform(0, 2 * np.pi)
        point = points[-1] + length * np.array([np.cos(angle), np.sin(angle)])
        if 0.005 < point[0] < 0.195 and 0.005 < point[1] < 0.095:
            points.append(point)
    return np.column_stack([points, np.full(len(points), -0.002)])


def wander(n, step=1e-3, seed=1):
    def fold(v, length):
        v = np.mod(v, 2 * length)
        return np.where(v > length, 2 * length - v, v)

    turn = np.cumsum(np.random.default_rng(seed).normal(0, 0.2, n))
    p = np.cumsum(np.column_stack([np.cos(turn), np.sin(turn)]) * step, axis=0)
    return np.column_stack([0.005 + fold(p[:, 0], 0.19), 0.005 + fold(p[:, 1], 0.09), np.full(n, -0.002)])


def peer_boxes(p, cell=1e-4, R=0.004):
    """The usual NumPy way: every cell of each segment's bounding box, by its centre."""
    z = np.zeros((2000, 1000))
    x, y = (np.arange(2000) + 0.5) * cell, (np.arange(1000) + 0.5) * cell
    for a, b in pairwise(p):
        i = slice(*np.searchsorted(x, [min(a[0], b[0]) - R, max(a[0], b[0]) + R]))
        j = slice(*np.searchsorted(y, [min(a[1], b[1]) - R, max(a[1], b[1]) + R]))
        X, Y, d = x[i, None] - a[0], y[None, j] - a[1], (b - a)[:2]
        t = np.clip((X * d[0] + Y * d[1]) / (d @ d), 0, 1)
        inside = (X - t * d[0]) ** 2 + (Y - t * d[1]) ** 2 <= R * R
        z[i, j] = np.where(inside, np.minimum(z[i, j], a[2]), z[i, j])
    return -z.sum() * cell * cell


def peer_manifold(p, R=0.004):
    import manifold3d

    tool = manifold3d.Manifold.cylinder(0.02, R, R, 128)
    passes = [manifold3d.Manifold.batch_hull([tool.translate(a), tool.translate(b)]) for a, b in pairwise(p)]
    block = manifold3d.Manifold.cube([0.2, 0.1, 0.01]).translate([0, 0, -0.01])
    return block.volume() - (block - manifold3d.Manifold.batch_boolean(passes, manifold3d.OpType.Add)).volume()


def test_hundred_connected_segments(capsys):
    p = connected()
    lines = [shapely.LineString(p[i : i + 2, :2]).buffer(0.004, quad_segs=4096) for i in range(100)]
    exact = shapely.union_all(lines).area * 0.002
    mine = best_of(lambda: cut(STOCK, 1e-4, FLAT, p), 9)
    boxes = best_of(lambda: peer_boxes(p), 2)
    solids = best_of(lambda: peer_manifold(p), 1)
    error = cut(STOCK, 1e-4, FLAT, p).removed_volume / exact - 1
    with capsys.disabled():
        print(f"\n200 x 100 mm at 0.1 mm, 100 segments of 50 mm: {mine * 1e3:.1f} ms, volume {error:+.1e}")
        print(f"  NumPy boxes {boxes * 1e3:.0f} ms,", end=" ")
        print(f"volume {peer_boxes(p) / exact - 1:+.1e}; manifold3d {solids * 1e3:.0f} ms (a general solid modeller)")
    assert abs(error) < 1e-5
    assert mine < 0.02
    assert mine < boxes


def test_growth(capsys):
    """Time grows no faster than the cells and the segments do; a third to spare for what else the machine does."""
    p, by_cell, by_segment = connected(), [], []
    with capsys.disabled():
        print()
        for cell in (4e-4, 2e-4, 1e-4, 5e-5):
            spent = best_of(lambda cell=cell: cut(STOCK, cell, FLAT, p), 3)
            cells = round(0.02 / cell**2)
            by_cell.append(spent / cells)
            print(f"  cells {cells / 1e6:6.2f} M: {spent * 1e3:8.1f} ms")
        for n in (1000, 4000, 16000, 64000):
            walk = wander(n)
            spent = best_of(lambda walk=walk: cut(STOCK, 1e-4, FLAT, walk), 2)
            by_segment.append(spent / n)
            print(f"  segments of 1 mm {n:6d}: {spent * 1e3:8.1f} ms, {spent / n * 1e6:.1f} us each")
        for diameter in (0.002, 0.004, 0.008, 0.016):
            tool = Cutter("flat", diameter)
            spent = best_of(lambda tool=tool: cut(STOCK, 1e-4, tool, wander(4000)), 2)
            print(f"  cutter {diameter * 1e3:4.0f} mm, 4000 segments: {spent * 1e3:8.1f} ms")
        for kind, extra in (("ball", {}), ("bull", {"corner_radius": 0.001}), ("chamfer", {"tip_angle": 1.5})):
            tool = Cutter(kind, 0.008, **extra)
            ramp = wander(4000) - np.outer(np.sin(np.arange(4000) / 300), [0, 0, 1e-3])
            spent = best_of(lambda tool=tool, ramp=ramp: cut(STOCK, 1e-4, tool, ramp), 1)
            print(f"  {kind} 8 mm ramping, 4000 segments: {spent * 1e3:8.1f} ms")
    assert by_cell[-1] < 1.33 * by_cell[0]
    assert by_segment[-1] < 1.33 * by_segment[0]


def test_a_million_segments(capsys):
    p = wander(1_000_000)
    start = time.perf_counter()
    cut(STOCK, 1e-4, FLAT, p)
    spent = time.perf_counter() - start
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    with capsys.disabled():
        print(f"\n1 000 000 segments of 1 mm: {spent:.1f} s, {memory:.2f} GiB at most")
    assert memory < 2.0
    assert spent < 30.0  # 12 s on a quiet machine; loaded ones are slower


def test_paper_slot_sections_and_engagement(capsys):
    x = np.linspace(-0.05, 0.05, 101)
    p = np.column_stack([x, 0 * x, 0 * x])
    stock = Stock((-0.06, -0.02, -0.01), (0.06, 0.02, 0.002))
    moved = p + np.array([0, 0.2295e-3, -0.1024e-3])
    stations = np.linspace(0.005, 0.095, 19)
    sections = best_of(lambda: groove_sections(stock, FLAT, CutPath(p, moved, x > -0.05), stations), 3)
    both = best_of(lambda: [cut(stock, 1e-4, FLAT, q) for q in (p, moved)], 3)
    arcs = best_of(lambda: engage(March(stock, 1e-4, FLAT, p)), 2)
    with capsys.disabled():
        print(f"\nPaper's slot: both surfaces {both * 1e3:.0f} ms,", end=" ")
        print(f"19 sections {sections * 1e3:.0f} ms, engagement {arcs * 1e3:.1f} ms")
    assert sections < 1.0


def curved(chord=7e-4, turns=4, R=0.03):
    """A closed contour, 1 mm further in with every turn, in chords: each a run of its own."""
    t = np.linspace(0, 2 * np.pi * turns, 40_000)
    r = R * (1 + 0.25 * np.sin(5 * t)) - 1e-3 * np.floor(t / (2 * np.pi))
    p = np.column_stack([0.1 + r * np.cos(t), 0.05 + r * np.sin(t), np.full(len(t), -0.003)])
    s = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1)))
    return np.column_stack([np.interp(np.arange(0, s[-1], chord), s, column) for column in p.T])


def raster(step=1e-3, over=1e-3):
    rows = []
    for n, y in enumerate(np.arange(0.02, 0.08, over)):
        x = np.arange(0.03, 0.17, step)[:: 1 if n % 2 == 0 else -1]
        rows.append(np.column_stack([x, np.full(len(x), y), np.full(len(x), -0.002)]))
    return np.vstack(rows)


@pytest.mark.parametrize("path", [curved, raster], ids=["contour", "raster"])
@pytest.mark.parametrize(
    ("kind", "extra", "most"),
    [
        ("flat", {}, 4.0),
        ("ball", {}, 4.0),
        ("bull", {"corner_radius": 1.5e-3}, 4.0),
        ("chamfer", {"tip_angle": 1.5}, 4.0),
    ],
)
def test_engagement_beside_the_cut_alone(path, kind, extra, most, capsys):
    """Steps a second, and what is met beside what it costs to cut the same moves one by one, in the same run."""
    tool = Cutter(kind, 0.008, **extra)
    p = path()
    march = March(STOCK, 1e-4, tool, p)
    met = best_of(lambda: engage(March(STOCK, 1e-4, tool, p)), 4)

    def cut_alone():
        for i in march.steps:
            march.cut(int(i), p[i - 1], p[i])

    cut_alone()
    alone = best_of(cut_alone, 1)
    with capsys.disabled():
        print(f"\n{kind:8s} {path.__name__:7s} {len(p):6d} steps: {len(p) / met:8.0f} a second", end="")
        print(f", {met / len(p) * 1e6:.1f} us each ({alone / len(p) * 1e6:.1f} us to cut one alone)")
    assert met < most * alone
