"""Both walls of the exported solid, sliced at depths and stations, against the envelope of the deflected tool."""

import io
from pathlib import Path

import numpy as np
import pytest
import shapely
import trimesh

from robomill.cutting.tool import Cutter
from robomill.io.meshes import mesh_bytes
from robomill.io.setups.projects import load_setup
from robomill.simulation.run import simulate
from robomill.surface.stock import Stock
from robomill.surface.zmap import cut

SAMPLE = Path(__file__).parents[2] / "samples" / "paper_flute" / "setup_process.toml"
RADIUS = 4e-3
FLOOR = 3e-5  # m above the tip: what lies lower is floor, and slopes where the tool sinks
DEPTHS = (-0.2e-3, -0.7e-3, -1.084e-3, -1.5e-3, -2.1e-3)
BLOCK = Stock((-0.015, -0.015, -0.01), (0.015, 0.015, 0.0))
TO = np.arange(-20, 21) * 1e-3
TURN = np.linspace(0.3, 4.2, 250)


def pushed(plan, push=0.3e-3):
    """Tips 2 mm deep along ``plan`` (m, 2), pushed aside and down as in the sample: quickly at first, then slowly."""
    way = np.append(0.0, np.cumsum(np.hypot(*np.diff(plan, axis=0).T)))
    slow, quick = 0.1 * way / way[-1], 1.0 - np.exp(-way / 0.8e-3)
    aside = push * quick[:, None] * np.stack([-0.25 + 0 * way, 0.9 + slow, -0.5 - slow], axis=1)
    return np.column_stack([plan, np.full(len(plan), -2e-3)]) + aside


def line(degrees, offset=0.0):
    along = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    return TO[:, None] * along + offset * np.array([-along[1], along[0]])


PATHS = {
    "a slot along Y": [pushed(line(90, 0.3e-3))],
    "a slot at 30 degrees": [pushed(line(30))],
    "an arc": [pushed(9e-3 * np.column_stack([np.cos(TURN), np.sin(TURN)]))],
    "a shoulder in two passes": [pushed(line(0, 2e-3)), pushed(line(0, -3e-3), 0.12e-3)],
}


def part(name):
    """The solid that is cut, its block, tips (m, 3) and which of the moves to them cut (m,)."""
    if name == "sample":
        result = simulate(load_setup(SAMPLE))
        tips = result.path.p + result.delta
        return result.machined, result.setup.stock, np.where(result.reached[:, None], tips, np.nan), result.path.cutting
    tips = np.vstack(PATHS[name])
    cutting = np.concatenate([np.arange(len(p)) > 0 for p in PATHS[name]])
    return cut(BLOCK, 1e-4, Cutter("flat", 2 * RADIUS), tips, cutting=cutting), BLOCK, tips, cutting


def moves_below(tips, cutting, height):
    """The parts of the moves, ends (n, 2, 2) m in plan, on which the tip runs lower than ``height``."""
    start, span = tips[:-1][cutting[1:]], np.diff(tips, axis=0)[cutting[1:]]
    with np.errstate(divide="ignore", invalid="ignore"):
        passes = np.clip((height - start[:, 2]) / span[:, 2], 0.0, 1.0)
    first = np.where(start[:, 2] < height, 0.0, passes)
    last = np.where(start[:, 2] + span[:, 2] < height, 1.0, passes)
    below = np.minimum(start[:, 2], start[:, 2] + span[:, 2]) < height
    ends = np.stack([start + first[:, None] * span, start + last[:, None] * span], axis=1)
    return ends[below][:, :, :2]


def cleared(moves, places):
    """(q,) bool: whether a place (q, 2) lies within the tool's radius of a move."""
    start, span = moves[:, 0], moves[:, 1] - moves[:, 0]
    square = np.einsum("ij,ij->i", span, span)
    off = places[:, None] - start
    share = np.clip(np.einsum("qij,ij->qi", off, span) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    return np.linalg.norm(off - share[..., None] * span, axis=2).min(axis=1) < RADIUS


def envelope(moves, centre, across):
    """How far (q,) m what is cleared goes on from ``centre`` along ``across`` (q, 2); NaN beyond 16 mm."""
    far = np.full(len(centre), np.nan)
    for reach in np.arange(16e-3, 3e-3, -0.1e-3):  # the nearest of 0.1 mm where nothing is cleared any more
        far = np.where(cleared(moves, centre + reach * across), far, reach)
    near = far - 0.1e-3
    for _ in range(40):
        middle = 0.5 * (near + far)
        inner = cleared(moves, centre + middle[:, None] * across)
        near, far = np.where(inner, middle, near), np.where(inner, far, middle)
    return near


def volume(block, tips, cutting):
    """m^3 that the envelope takes from the block: its level areas, added up from the deepest tip upwards."""
    plan = shapely.box(*block.lower[:2], *block.upper[:2])

    def area(height):
        track = shapely.MultiLineString(list(moves_below(tips, cutting, height))).buffer(RADIUS, quad_segs=100)
        return track.intersection(plan).area

    deepest = tips[cutting, 2].min()
    edges = np.linspace(deepest, -2e-3, 41)
    floor = sum(area(height) for height in 0.5 * (edges[1:] + edges[:-1])) * (edges[1] - edges[0])
    return floor + 2e-3 * area(-2e-3 + 1e-9)


def sliced(corners, height):
    """Segments (n, 2, 2) m in which triangles (f, 3, 3) m meet a level plane."""
    up = corners[:, :, 2] > height
    some = up.any(axis=1) & ~up.all(axis=1)
    corners, up = corners[some], up[some]
    turned = np.roll(corners, -1, axis=1)
    met = up != np.roll(up, -1, axis=1)
    share = (height - corners[met][:, 2]) / (turned[met][:, 2] - corners[met][:, 2])
    points = corners[met] + share[:, None] * (turned[met] - corners[met])
    return points[:, :2].reshape(-1, 2, 2)


def standing(segments, centre, across):
    """Where (n,) m along ``across`` from ``centre`` segments meet the line."""
    along = np.array([across[1], -across[0]])
    off, reach = (segments - centre) @ along, (segments - centre) @ across
    met = (off[:, 0] > 0.0) != (off[:, 1] > 0.0)
    off, reach = off[met], reach[met]
    return reach[:, 0] - off[:, 0] * (reach[:, 1] - reach[:, 0]) / (off[:, 1] - off[:, 0])


def stations(tips, cutting, count=149):
    """Tips (q, 3) m along the moves that cut and the directions (q, 2) across them in plan."""
    at = np.linspace(0.0, len(tips) - 1.001, count)
    i, share = at.astype(int), at % 1.0
    span = tips[i + 1] - tips[i]
    kept = cutting[i + 1] & (np.hypot(span[:, 0], span[:, 1]) > 1e-5)
    place = (tips[i] + share[:, None] * span)[kept]
    ahead = span[kept, :2] / np.linalg.norm(span[kept, :2], axis=1, keepdims=True)
    return place, np.column_stack([-ahead[:, 1], ahead[:, 0]])


@pytest.mark.parametrize("name", ["sample", *PATHS])
def test_both_walls_of_the_solid_stand_where_the_deflected_tool_ran(name):
    surface, block, tips, cutting = part(name)
    solid = trimesh.load_mesh(io.BytesIO(mesh_bytes(surface, "stl")), file_type="stl")
    assert solid.is_watertight
    assert solid.is_winding_consistent
    corners = np.asarray(solid.triangles, dtype=float) * 1e-3
    removed = block.size.prod() - solid.volume * 1e-9
    assert removed == pytest.approx(volume(block, tips, cutting), rel=5e-5)
    tip, left = stations(tips, cutting)
    place = tip[:, :2]
    for height in DEPTHS:
        segments, moves = sliced(corners, height), moves_below(tips, cutting, height)
        for across in (left, -left):
            wall = place + envelope(moves, place, across)[:, None] * across
            met = np.logical_and(wall > block.lower[:2] + 5e-4, wall < block.upper[:2] - 5e-4).all(axis=1)
            met &= np.logical_and(place > block.lower[:2], place < block.upper[:2]).all(axis=1)
            met &= tip[:, 2] < height - FLOOR
            assert met.sum() > 20, (name, height)
            away = [
                np.abs(standing(segments, *line) - line[1] @ (stood - line[0])).min()
                for *line, stood in zip(place[met], across[met], wall[met], strict=True)
            ]
            assert max(away) < 0.5e-6, (height, int(np.argmax(away)))
