"""A tilted cutter: against stamps of its surface, against a solid modeller, and what a height map cannot hold."""

import manifold3d
import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.errors import SurfaceError
from robomill.surface.stock import Stock
from robomill.surface.tilt_kernels import hull_gap, move_in_frame, tilted_interval, tool_frame, vertical_line
from robomill.surface.zmap import cut

STOCK = Stock((0.0, -0.02, -0.01), (0.04, 0.02, 0.0))
CUTTERS = {
    "flat": Cutter("flat", 0.008),
    "ball": Cutter("ball", 0.008),
    "bull": Cutter("bull", 0.008, corner_radius=0.0015),
    "chamfer": Cutter("chamfer", 0.008, tip_angle=np.radians(90.0), tip_diameter=0.001),
}


def axis(A, B):
    return np.array([np.sin(B), -np.sin(A) * np.cos(B), np.cos(A) * np.cos(B)])


def solid(cutter, p, k, length=0.05, facets=400):
    """manifold3d solid swept by a tilted cutter along one straight move: the hull of its two end places."""
    r = np.linspace(0, cutter.radius, 60)
    outline = [(0.0, length), *[(float(q), float(cutter.profile(q))) for q in r], (cutter.radius, length)]
    outline = [outline[0], *outline[1:]]
    section = manifold3d.CrossSection([[(x, y) for x, y in outline]])
    if section.area() < 0 or section.is_empty():
        section = manifold3d.CrossSection([[(x, y) for x, y in outline[::-1]]])
    tool = section.revolve(facets)
    x = np.cross([0.3, 0.9, 0.1], k)
    x /= np.linalg.norm(x)
    frame = np.column_stack([x, np.cross(k, x), k])
    return manifold3d.Manifold.batch_hull([tool.transform(np.column_stack([frame, q])) for q in p])


@pytest.mark.parametrize("kind", CUTTERS)
@pytest.mark.parametrize("angles", [(0.1, 0.0), (-0.15, 0.25), (0.0, 0.6)])
def test_heights_against_a_cloud_of_cutter_points(kind, angles):
    """Points of the body in small steps: at each cell the lowest body point agrees to the step's size."""
    cutter, k = CUTTERS[kind], axis(*angles)
    p = np.array([[0.012, -0.004, -0.002], [0.025, 0.003, -0.0035]])
    surface = cut(STOCK, 5e-4, cutter, p, k)
    body = solid(cutter, p, k).to_mesh()
    vertices, faces = np.asarray(body.vert_properties)[:, :3], np.asarray(body.tri_verts)
    low, high = crossing(vertices[faces], surface.x, surface.y)
    expected = np.where((low < 0) & (high >= 0), low, 0.0)
    overhang = (low < 0) & (high < 0)
    # the body's facets lie inside the true one, most of all where a line grazes it
    missing = (expected - surface.z)[~overhang]
    assert missing.min() > -5e-9  # the oracle looks 1 nm beside the cell
    assert (missing > 3e-6).mean() < 0.015
    assert missing.max() < 2e-4
    assert surface.overhang == pytest.approx(overhang.sum(), abs=0.06 * overhang.sum() + 3)
    assert (expected < -0.001).sum() > 300


def crossing(triangles, x, y):
    """Lowest and highest crossing of vertical lines with a closed convex mesh; (inf, -inf) outside."""
    low, high = np.full((len(x), len(y)), np.inf), np.full((len(x), len(y)), -np.inf)
    x, y = x + 1e-9, y + 1.3e-9
    for t in triangles.astype(float):
        i = slice(*np.searchsorted(x, [t[:, 0].min(), t[:, 0].max()]))
        j = slice(*np.searchsorted(y, [t[:, 1].min(), t[:, 1].max()]))
        (ax, ay, az), b, c = t[0], t[1] - t[0], t[2] - t[0]
        area = b[0] * c[1] - b[1] * c[0]
        if area == 0 or i.start == i.stop or j.start == j.stop:
            continue
        X, Y = (x[i] - ax)[:, None], (y[j] - ay)[None, :]
        u, v = (X * c[1] - Y * c[0]) / area, (Y * b[0] - X * b[1]) / area
        hit = (u >= 0) & (v >= 0) & (u + v <= 1)
        z = az + u * b[2] + v * c[2]
        low[i, j] = np.where(hit, np.minimum(low[i, j], z), low[i, j])
        high[i, j] = np.where(hit, np.maximum(high[i, j], z), high[i, j])
    return low, high


def test_a_slight_tilt_is_the_upright_cut_in_the_limit():
    p = np.array([[0.01, 0.0, -0.002], [0.03, 0.005, -0.002]])
    upright = cut(STOCK, 5e-4, CUTTERS["ball"], p)
    slight = cut(STOCK, 5e-4, CUTTERS["ball"], p, axis(1e-7, 0.0))
    np.testing.assert_allclose(slight.z, upright.z, atol=1e-8)


def test_ball_centre_decides_where_a_tilted_ball_cuts():
    """Below its centre a ball nose cuts the same wherever its axis leans, if its centre runs the same way."""
    centre = np.array([[0.01, 0.0, 0.002], [0.03, 0.005, 0.002]])
    heights = [
        cut(STOCK, 5e-4, CUTTERS["ball"], centre - 0.004 * axis(*angles), axis(*angles)).z
        for angles in ((0.0, 0.0), (0.2, 0.0), (0.1, -0.3))
    ]
    for other in heights[1:]:
        np.testing.assert_allclose(other, heights[0], atol=1e-9)


def test_undercut_is_reported():
    p = np.array([[0.0, 0.0, -0.006], [0.04, 0.0, -0.006]])
    surface = cut(STOCK, 5e-4, CUTTERS["flat"], p, axis(0.4, 0.0))
    assert surface.overhang > 50
    assert surface.notes()[0].code == "undercut"
    # seen from above the overhanging wall stays: nothing lower than the top beyond the lip
    assert surface.z.max() == 0.0


def test_an_axis_near_level_is_refused():
    with pytest.raises(SurfaceError, match="tilt the tool less"):
        cut(STOCK, 5e-4, CUTTERS["flat"], np.array([[0, 0, -0.002], [0.02, 0, -0.002]]), axis(1.5, 0.0))


def test_a_turning_axis_converges_with_its_pieces():
    p = np.array([[0.01, -0.005, -0.002], [0.03, 0.005, -0.002]])
    k = np.array([axis(-0.1, 0.1), axis(0.2, 0.0)])
    t = np.linspace(0, 1, 200)[:, None]
    fine_k = k[0] + t * (k[1] - k[0])
    fine_k /= np.linalg.norm(fine_k, axis=1, keepdims=True)
    coarse = cut(STOCK, 5e-4, CUTTERS["ball"], p, k)
    fine = cut(STOCK, 5e-4, CUTTERS["ball"], p[0] + t * (p[1] - p[0]), fine_k)
    assert np.abs(coarse.z - fine.z).max() < 0.3 * 5e-4


@pytest.mark.parametrize("kind", CUTTERS)
def test_a_line_that_only_grazes_the_body_is_found_inside_it(kind):
    """Against heights tried every 40 um, on lines farther and farther out until they miss."""
    cutter, k, short = CUTTERS[kind], axis(-0.5, 0.7), 0
    frame, ends = tool_frame(*k), np.array([0.012, -0.004, -0.002, 0.025, 0.003, -0.0035])
    move, z = move_in_frame(frame, ends), np.arange(-0.012, 0.004, 4e-5)
    for turn in np.arange(0.1, 2 * np.pi, 0.3):
        near, far = 0.0, 0.05
        for _ in range(12):
            out = 0.5 * (near + far)
            x, y = 0.0185 + out * np.cos(turn), out * np.sin(turn)
            line = vertical_line(frame, x, y)
            low, high = tilted_interval(cutter.solid, move, frame, line, 0.004)
            inside = z[np.array([hull_gap(cutter.solid, move, frame, line, at) <= 0.0 for at in z])]
            places = np.column_stack([np.full((len(inside), 2), (x, y)), inside])
            inside = inside[beside_the_axis(places, ends, k) <= cutter.radius]
            if inside.size:
                assert low == pytest.approx(inside[0], abs=5e-5)
                assert high == pytest.approx(inside[-1], abs=5e-5)
                short += high - low < 0.5e-3
            else:
                assert low > high or high - low < 5e-5
            near, far = (out, far) if inside.size else (near, out)
    assert short > 10


def beside_the_axis(p, ends, k):
    """How near the axis k comes to places p (m, 3) on its way between two ends (6,), m."""
    level = np.eye(3) - np.outer(k, k)
    begin, way = level @ ends[:3], level @ (ends[3:] - ends[:3])
    t = np.clip((p @ level - begin) @ way / (way @ way), 0.0, 1.0)
    return np.linalg.norm(p @ level - begin - t[:, None] * way, axis=1)
