"""Removed volume converges to closed forms, for each cutter, with the order stated here.

Stated order in the cell size h: at least 1 for single cuts (observed 1.5 to 2, since cells at walls know the share
that is cut). The error is the root mean square over four places of the grid, so that no luck of a round number counts.
"""

import manifold3d
import numpy as np
import pytest
from scipy.integrate import quad

from robomill.cutting.tool import Cutter
from robomill.surface.stock import Stock
from robomill.surface.zmap import cut

CUTTERS = {
    "flat": Cutter("flat", 0.008),
    "ball": Cutter("ball", 0.008),
    "bull": Cutter("bull", 0.008, corner_radius=0.0015),
    "chamfer": Cutter("chamfer", 0.008, tip_angle=np.radians(90.0), tip_diameter=0.001),
}
DEPTH = 0.003
CELLS = (8e-4, 4e-4, 2e-4, 1e-4)
START, END = np.array([0.0103, 0.0107, -DEPTH]), np.array([0.0297, 0.0189, -DEPTH])
CENTRE, RING = np.array([0.0203, 0.0151]), 0.0072


def section_area(cutter):
    """Of the cut across the feed, m^2: twice the integral of depth - profile(r)."""
    reach = float(cutter.radius_at(DEPTH))
    return 2 * quad(lambda r: DEPTH - float(cutter.profile(r)), 0, reach, epsabs=1e-16)[0]


def stamp_volume(cutter):
    """Of the two half bodies of revolution at the ends of a straight cut, m^3."""
    reach = float(cutter.radius_at(DEPTH))
    return 2 * np.pi * quad(lambda r: r * (DEPTH - float(cutter.profile(r))), 0, reach, epsabs=1e-18)[0]


def ring_path(chords=1440):
    t = np.linspace(0, 2 * np.pi, chords + 1)
    return np.column_stack([CENTRE[0] + RING * np.cos(t), CENTRE[1] + RING * np.sin(t), np.full(len(t), -DEPTH)])


def volume_error(cutter, p, exact, cell, places=((0.0, 0.0), (0.31, 0.17), (0.53, 0.71), (0.79, 0.43))):
    errors = []
    for u, v in places:
        shift = cell * np.array([u, v, 0.0])
        stock = Stock(np.array([0.0, 0.0, -0.012]) - shift, np.array([0.04, 0.032, 0.0]) - shift)
        errors.append(cut(stock, cell, cutter, p).removed_volume / exact - 1)
    return float(np.sqrt(np.mean(np.square(errors))))


def order(errors):
    return float(np.polyfit(np.log(CELLS), np.log(np.maximum(errors, 1e-9)), 1)[0])


@pytest.mark.parametrize("kind", CUTTERS)
def test_straight_cut(kind):
    cutter = CUTTERS[kind]
    exact = section_area(cutter) * np.linalg.norm(END - START) + stamp_volume(cutter)
    errors = [volume_error(cutter, np.stack([START, END]), exact, cell) for cell in CELLS]
    assert order(errors) > 1.0, errors
    assert errors[-1] < 2e-4, errors


@pytest.mark.parametrize("kind", CUTTERS)
def test_circular_cut(kind):
    """Pappus: the section is symmetric about the ring, so the volume is its area times the ring's length."""
    cutter = CUTTERS[kind]
    exact = section_area(cutter) * 2 * np.pi * RING
    cells = CELLS[1:]
    errors = [volume_error(cutter, ring_path(), exact, cell, ((0.0, 0.0), (0.31, 0.17))) for cell in cells]
    assert np.polyfit(np.log(cells), np.log(np.maximum(errors, 2e-6)), 1)[0] > 1.0, errors
    assert errors[-1] < 4e-4, errors


@pytest.mark.parametrize("kind", CUTTERS)
def test_ramped_cut_against_a_solid_modeller(kind):
    cutter, top = CUTTERS[kind], 0.02
    p = np.array([[0.0103, 0.0107, -0.001], [0.0297, 0.0189, -0.0045]])
    angle = np.linspace(0, 2 * np.pi, 240, endpoint=False)
    phi = np.linspace(0, np.pi / 2, 60 if cutter.corner_radius else 2)  # even steps round the nose
    r = np.unique([0.0, cutter.radius, *(cutter.flat_radius + cutter.corner_radius * np.sin(phi))])
    ring = np.array([[q * np.cos(a), q * np.sin(a), float(cutter.profile(q))] for q in r for a in angle])
    rim = np.column_stack([cutter.radius * np.cos(angle), cutter.radius * np.sin(angle), np.full(240, top)])
    points = np.vstack([ring + p[0], ring + p[1], rim + p[0], rim + p[1]])
    body = manifold3d.Manifold.hull_points(points * 1e3)  # in mm: the modeller's tolerance is absolute
    block = manifold3d.Manifold.cube([40.0, 32.0, 12.0]).translate([0.0, 0.0, -12.0])
    exact = (block ^ body).volume() * 1e-9
    facets = 1 - np.sin(2 * np.pi / 240) / (2 * np.pi / 240)  # the modeller's circle lacks this much
    assert volume_error(cutter, p, exact, 1e-4, ((0.31, 0.17),)) < 2 * facets + 2e-4


def test_wall_position_in_the_map_is_better_than_first_order():
    """Width of a slot from the mean heights across it, at an angle to the grid; sections themselves are exact."""
    angle, errors = np.radians(37.0), []
    feed = np.array([np.cos(angle), np.sin(angle), 0.0])
    p = np.array([0.02, 0.016, -DEPTH]) + np.array([[-0.05], [0.05]]) * feed
    for cell in CELLS:
        stock = Stock((0.0, 0.0, -0.012), (0.04, 0.032, 0.0))
        surface = cut(stock, cell, CUTTERS["flat"], p)
        rows = slice(len(surface.x) // 2 - 2, len(surface.x) // 2 + 2)
        across = -surface.mean[rows].sum(axis=1) * surface.dy / DEPTH * np.cos(angle)
        errors.append(np.abs(across - 0.008).max())
    assert order(np.array(errors) / 0.008) > 1.0 or max(errors[-2:]) < 1e-6, errors
    assert errors[-1] < 2e-6, errors
