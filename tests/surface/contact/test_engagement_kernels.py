"""How the turn is divided and a profile searched, as plain Python: by a made-up cut whose ends are known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robomill.cutting.edge import MOMENTS
from robomill.cutting.engaged import PANELS, end_of, full_slot, sector_edges, sinks
from robomill.cutting.profile_kernels import END, FLANK, NOSE, on_profile, stretch_ends
from robomill.cutting.tool import DISH, PRESSED, Cutter
from robomill.surface.contact import division_kernels as division, engagement_kernels as kernels
from robomill.surface.contact.division_kernels import (
    GAPS,
    HALVINGS,
    REACH,
    REST,
    ROWS,
    SIZE,
    add_part,
    divide,
    follow_jumps,
)
from robomill.surface.contact.engagement_kernels import LENGTH, SUMS, Ray, Room, lay_out, measure_stretch
from robomill.surface.contact.material_kernels import Bounds, Dexels, Facets, World
from robomill.surface.contact.relief_kernels import Relief
from robomill.surface.contact.rib_kernels import COLUMNS
from robomill.surface.contact.step_kernels import step_at
from robomill.surface.contact.turn_kernels import ANGLES, PHI, half_turn, jumps, panel_end

MM = 1e-3
NO_RELIEF = Relief(np.zeros((0, 0, 3)), 0.0, 0.0, 1.0, 1.0, 0.0, 0.0)
CUTTERS = {
    "flat": Cutter("flat", 8 * MM),
    "ball": Cutter("ball", 8 * MM),
    "bull": Cutter("bull", 8 * MM, corner_radius=1.5 * MM),
    "chamfer": Cutter("chamfer", 8 * MM, tip_angle=np.radians(80), tip_diameter=1 * MM),
}


def room_for(halves=1):
    """Room as a march gives it, its first rows at the angles of one half turn or two."""
    rows, gaps = np.zeros((ROWS, SUMS + 6)), GAPS
    for half in range(2):
        phi = half * np.pi + half_turn()
        rows[half * ANGLES : (half + 1) * ANGLES, :LENGTH] = np.stack([phi, np.sin(phi), np.cos(phi)], axis=1)
    return Room(
        np.array([1.0, 0.0]),
        np.zeros((3, 4)),
        np.zeros((130, 5)),
        rows,
        np.zeros((gaps, 7)),
        np.zeros((gaps * (2 * HALVINGS + 2), 4)),
        np.zeros((4 * PANELS * halves, 5)),
        np.zeros((12, COLUMNS)),
        np.zeros(1),
    )


def test_panels_and_the_angles_in_them():
    """Ends of the panels, and in each of them the two nodes of Gauss' rule; a thousandth off the sides."""
    ends = np.pi * np.sin(np.pi * np.arange(PANELS + 1) / (2 * PANELS)) ** 2
    found = [panel_end(n) for n in range(2 * PANELS)]
    np.testing.assert_allclose(found, [*ends[:-1], *(np.pi + ends[:-1])], atol=1e-12)
    nodes = 0.5 + 0.5 * np.polynomial.legendre.leggauss(2)[0]
    phi = half_turn()
    assert len(phi) == ANGLES
    np.testing.assert_allclose(phi[3:-1:3], ends[1:-1], atol=1e-12)
    for n in range(PANELS):
        np.testing.assert_allclose(phi[3 * n + 1 : 3 * n + 3], ends[n] + np.diff(ends)[n] * nodes, atol=1e-12)
    assert (phi[0], phi[-1]) == (1e-3, np.pi - 1e-3)


@pytest.mark.parametrize(
    ("a", "b", "jump"), [(1.0, 1.0, False), (1.0, 0.81, False), (0.79, 1.0, True), (0.0, 1e-9, True), (0.0, 0.0, False)]
)
def test_lengths_that_differ_by_a_fifth_of_the_longer_are_a_jump(a, b, jump):
    assert jumps(a, b) == jumps(b, a) == jump


def lengths_of(angle):
    """A made-up engaged length: three parts of the turn, each smooth by itself."""
    return np.where(angle < 0.7, 0.0, np.where(angle < 2.0, 1.0 + 0.05 * angle, np.where(angle < 4.4, 0.0, 2.0)))


def made_up(room, world, shape, step, first, end):
    """What ``measure`` does, for the made-up cut."""
    for row in room.rows[first:end]:
        assert (row[1], row[2]) == (pytest.approx(math.sin(row[PHI])), pytest.approx(math.cos(row[PHI])))
        row[LENGTH] = lengths_of(row[PHI])


@pytest.mark.parametrize("halves", [1, 2])
def test_pieces_of_the_turn_lie_side_by_side_in_their_sectors_and_follow_jumps(monkeypatch, halves):
    monkeypatch.setattr(division, "measure", made_up)
    room = room_for(halves)
    made_up(room, None, None, None, 0, ANGLES * halves)
    count = follow_jumps(room, None, None, None, divide(room, None, None, None, (36 * halves, 0)))
    row, middle, width, sector = room.pieces[:count].T
    order = np.argsort(middle)
    low, high = (middle - 0.5 * width)[order], (middle + 0.5 * width)[order]
    # Gauss' nodes carry the weight of their half of a panel; pieces beside a jump are cut out evenly.
    np.testing.assert_allclose(width.sum(), halves * np.pi, rtol=1e-12)
    assert low[0] > -0.05
    assert high[-1] < halves * np.pi + 0.05
    assert (middle[order][1:] > middle[order][:-1]).all()
    measured = room.rows[row.astype(int)]
    assert (np.abs(measured[:, PHI] - middle) <= 1.01 * width).all()
    edges = sector_edges(4 * PANELS * halves)
    inside = (edges[sector.astype(int)] <= middle + 1e-12) & (middle <= edges[sector.astype(int) + 1] + 1e-12)
    assert inside.all()
    # The integral, off by no more than the smallest gap at each jump.
    found = float(measured[:, LENGTH] @ width)
    fine = (np.arange(400_000) + 0.5) / 400_000 * halves * np.pi
    panel = np.diff([*map(panel_end, range(PANELS))]).max()
    assert found == pytest.approx(lengths_of(fine).mean() * halves * np.pi, abs=2 * panel / 2**HALVINGS)
    # Every jump is closed in upon, between rows of either side.
    for jump in (0.7, 2.0, 4.4)[: 2 if halves == 1 else 3]:
        angles = np.sort(room.rows[np.unique(row.astype(int)), PHI])
        at = np.searchsorted(angles, jump)
        assert angles[at] - angles[at - 1] < panel / 2**HALVINGS


def test_a_cut_without_jumps_has_gauss_nodes_and_no_gap():
    room = room_for()
    room.rows[:, LENGTH] = 1.0 + 0.1 * np.cos(room.rows[:, PHI])
    count, gaps, _ = divide(room, None, None, None, (36, 0))
    assert (count, gaps) == (2 * PANELS, 0)
    row, middle, width, sector = room.pieces[:count].T
    np.testing.assert_allclose(middle, room.rows[row.astype(int), PHI])
    np.testing.assert_allclose(width @ np.sin(middle), 2.0, atol=1e-4)
    np.testing.assert_array_equal(sector, [4 * n + s for n in range(PANELS) for s in (0, 3)])


def block_world(layers=1, dx=0.5 * MM):
    """A block from -10 mm to 0 in few cells, all of them passed through by the side of the step's own run."""
    dexels = Dexels(
        np.zeros((2, 2, layers)), np.ones((2, 2, layers + 1), np.int32), np.zeros(1, np.int64), 0, 0, dx, dx, dx
    )
    nothing = np.zeros(0, dtype=np.int64)
    bounds = Bounds(-1.0, -1.0, -10 * MM, 1.0, 1.0, 0.0)
    return World(dexels, np.zeros((2, 21)), bounds, Facets(np.zeros((0, 3, 3)), nothing, nothing, 1.0), NO_RELIEF)


def fed_at(depth, along=0.0, axis=(0.0, 0.0, 1.0)):
    v = np.array([math.sqrt(1.0 - along**2), 0.0, along])
    return step_at(
        np.array([0, 0, -depth]), np.array(axis), v, np.array([1.0, 0.0, 0.0]), (float(sinks(along)), 1), np.zeros(3)
    )


@pytest.mark.parametrize("name", CUTTERS)
@pytest.mark.parametrize("along", [0.0, -PRESSED, -1.01 * DISH])
@pytest.mark.parametrize("depth", [0.5 * MM, 3 * MM, 20 * MM])
def test_places_lie_on_the_profile_as_far_up_as_the_material(name, along, depth):
    """Of three layers: the flank is looked at too. Ends of a stretch a hundredth of a piece inside of it; then they
    themselves."""
    cutter, room, world = CUTTERS[name], room_for(), block_world(layers=6)
    shape, step = cutter.solid, fed_at(depth, along)
    lay_out(room, shape, step, world)
    first = 0
    for stretch, most in ((END, 8), (NOSE, 9), (FLANK, 96)):
        begin, stop, pieces, start = room.stretches[stretch]
        expected = stretch_ends(shape, stretch, depth)
        if stretch == END and -along <= PRESSED:
            expected = (0.0, 0.0)
        assert (begin, max(stop, begin)) == pytest.approx((expected[0], max(expected)))
        if stop <= begin:
            continue
        if stretch == FLANK:
            most = int(np.clip((stop - begin) / world.dexels.dx, 8, 96))
        assert (pieces, start) == (most, first)
        s = np.linspace(begin, stop, most + 1)
        s[[0, -1]] += np.array([1, -1]) * 0.01 * (stop - begin) / most
        for place, at in zip(room.places[first:], s, strict=False):
            np.testing.assert_allclose(place[1:], on_profile(shape, stretch, at)[1:], atol=1e-12)
        np.testing.assert_allclose(room.places[first : first + most + 1, 0], np.linspace(begin, stop, most + 1))
        for place, at in zip(room.places[first + most + 1 :], (begin, stop), strict=False):
            np.testing.assert_allclose(place, on_profile(shape, stretch, at), atol=1e-12)
        first += most + 3
    assert not room.places[first:].any()


def test_the_flank_of_an_upright_tool_in_one_layer_is_not_looked_at_in_places():
    room = room_for()
    lay_out(room, CUTTERS["flat"].solid, fed_at(2 * MM), block_world())
    assert not room.places.any()
    lay_out(room, CUTTERS["flat"].solid, fed_at(2 * MM, axis=(0.0, 0.6, 0.8)), block_world())
    assert room.places.any()
    reach = (2 * MM + 4 * MM * 0.6) / 0.8  # the rim that leans towards the material meets its top from further down
    assert room.stretches[FLANK, 1] == pytest.approx(reach)


SPANS = [[(0.4, 1.3)], [(0.0, 0.7), (1.9, 2.6)], [(0.9, 9.9)], [(-1.0, 9.9)], [(0.5, 2.2)]]


@pytest.mark.parametrize("faces", [(-1.0, 9.0), (0.7, 9.0), (-1.0, 1.6), (0.2, 2.9), (1.0, 1.2)])
@pytest.mark.parametrize("spans", SPANS)
@pytest.mark.parametrize("stretch", [NOSE, FLANK])
def test_what_is_engaged_of_a_stretch_between_known_heights(monkeypatch, stretch, spans, faces):
    """Material in layers of known heights along the axis (mm), as deep as the nearest end of its layer; as far as the
    stretch faces the feed, from a height to another."""
    cutter, depth = CUTTERS["ball" if stretch == NOSE else "flat"], 3 * MM
    shape, step = cutter.solid, fed_at(depth)
    room, world = room_for(), block_world(layers=6, dx=0.25 * MM)
    lay_out(room, shape, step, world)

    def deep(world, step, ray, at):
        z = at.height / MM
        nearest = min(abs(z - end) for span in spans for end in span) * MM
        return nearest if any(low < z < high for low, high in spans) else -nearest

    monkeypatch.setattr(kernels, "engaged_at", deep)
    monkeypatch.setattr(kernels, "about_at", deep)
    row = room.rows[5]
    row[LENGTH:] = 0.0
    row[kernels.LOWEST] = math.inf
    low, high = np.clip(faces, 0.0, 3.0)
    facing = (4 * MM * np.arccos(1.0 - np.array([low, high]) / 4.0)) if stretch == NOSE else np.array([low, high]) * MM
    measure_stretch(room, row, world, (shape, step, Ray(1.0, 0.0, 0.0, 0.0)), (stretch, *facing))
    ends = [np.clip(span, low, high) for span in spans]
    ends = [end for end in ends if end[1] > end[0]]
    if not ends:
        assert row[LENGTH] == 0.0
        return
    if stretch == NOSE:
        length = sum(4.0 * np.diff(np.arccos(1.0 - end / 4.0))[0] for end in ends)
    else:
        length = sum(np.diff(end)[0] for end in ends)
    assert row[LENGTH] / MM == pytest.approx(length, abs=2e-3)
    assert row[kernels.HEIGHT] / MM == pytest.approx(sum(np.diff(end)[0] for end in ends), abs=2e-3)
    assert row[kernels.LOWEST] / MM == pytest.approx(ends[0][0], abs=2e-3)
    assert row[kernels.HIGHEST] / MM == pytest.approx(ends[-1][1], abs=2e-3)
    highest = ends[-1][1]
    radius = math.sqrt(highest * (8.0 - highest)) if stretch == NOSE else 4.0
    assert row[kernels.WIDEST] / MM == pytest.approx(radius, abs=2e-3)
    assert row[kernels.FACE] == 0.0
    assert row[SUMS + 3] / MM == pytest.approx(length, abs=2e-3)  # of exponent 0: the length by itself


def met(cutter, depth, along=0.0, low=-1.0, high=1.0, turn=0):
    """What a step along X meets in a block from ``low`` to ``high`` (m) in Y, 10 mm thick: row and sectors; ``turn``
    turns step and block by so many right angles."""
    way = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)][turn])
    v = np.append(math.sqrt(1.0 - along**2) * way, along)
    step = step_at(
        np.array([0, 0, -depth]),
        np.array([0.0, 0.0, 1.0]),
        v,
        np.array([1.0, 0.0, 0.0]),
        (float(sinks(along)), 1),
        np.zeros(3),
    )
    if turn in (1, 2):  # the left of Y is -X, that of -X is -Y
        low, high = -high, -low
    limits = {"x_low": low, "x_high": high} if turn % 2 else {"y_low": low, "y_high": high}
    world = block_world()
    world = world._replace(bounds=world.bounds._replace(**limits))
    halves = 2 if along < -1e-6 else 1
    total, sectors = np.zeros(2 * MOMENTS + REST), np.zeros(4 * 4 * PANELS * halves, dtype=np.float32)
    add_part(room_for(halves), world, cutter.solid, step, total, sectors)
    return total[: 2 * MOMENTS].reshape(2, MOMENTS), total[2 * MOMENTS :], sectors.reshape(-1, 4)


@pytest.mark.parametrize("name", CUTTERS)
@pytest.mark.parametrize("along", [0.0, 0.3, -0.004, -0.5])
@pytest.mark.parametrize("depth", [0.7 * MM, 6 * MM])
def test_in_the_midst_of_a_block_a_full_slot_is_met(name, along, depth):
    cutter = CUTTERS[name]
    moments, rest, sectors = met(cutter, depth, along)
    expected = full_slot(cutter, (1.0, 0.0), np.array([depth]), np.array([along])).moments[0]
    for n in range(2):
        np.testing.assert_allclose(moments[n], expected[n], atol=8e-3 * np.abs(expected[n]).max())
    if along > 0.0:  # drawn out: less than a half turn of a nose faces the feed
        return
    phi_st, phi_ex, a_p, a_e, reach, size = rest[:6]
    assert (phi_st, phi_ex) == pytest.approx((0.0, np.pi), abs=2e-3)
    assert a_p == pytest.approx(depth, rel=2e-3)
    assert reach == pytest.approx(depth, rel=1e-6)
    assert a_e == pytest.approx(2 * float(cutter.radius_at(depth)), rel=2e-3)
    ahead = sectors[: 4 * PANELS]
    np.testing.assert_allclose(ahead[:, 0], depth, rtol=2e-2)
    np.testing.assert_allclose(ahead[:, 1], 0.0, atol=2e-2 * depth)
    np.testing.assert_allclose(ahead[:, 2], depth, rtol=1e-5)
    if sinks(along) in (0.0, 1.0):  # all of the end, or none
        np.testing.assert_allclose(sectors[:, 3], cutter.flat_radius * sinks(along), rtol=2e-2)
    else:  # its heel, behind
        assert (sectors[4 * PANELS + 1 : -1, 3] >= 0.0).all()
        assert sectors[6 * PANELS, 3] == pytest.approx(float(end_of(cutter, sinks(along), -1.0)), rel=2e-2)
    turns = np.pi * (depth - cutter.nose_height) if depth > cutter.nose_height else 0.0
    assert size >= turns


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("share", [0.07, 0.5, -0.5])
def test_beside_a_face_of_the_block_the_arc_ends_at_it(side, share):
    """The face stands at ``share`` of the radius to the left: material to its left (+1) or to its right (-1)."""
    R, depth = 4 * MM, 2 * MM
    low, high = (share * R, 1.0) if side > 0 else (-1.0, share * R)
    moments, rest, sectors = met(CUTTERS["flat"], depth, 0.0, low, high)
    edge = math.acos(share)  # from the left
    first, last = (0.0, edge) if side > 0 else (edge, math.pi)
    assert rest[:2] == pytest.approx([first, last], abs=3e-3)
    assert rest[2] == pytest.approx(depth, rel=5e-3)
    assert rest[3] == pytest.approx(R - share * R if side > 0 else R + share * R, rel=5e-3)
    assert rest[5] == pytest.approx(depth * (last - first), rel=5e-3)

    def integral(f):
        """Of f over the arc, by its antiderivative's values: (sine, -cosine, squares)."""
        return f(last) - f(first)

    sine2, cosine2 = integral(lambda q: 0.5 * q - 0.25 * math.sin(2 * q)), integral(lambda q: 0.5 * math.sin(q) ** 2)
    chip = depth * np.array([cosine2, sine2, sine2, cosine2, 0, 0, 0, integral(lambda q: -math.cos(q))])
    sine, one = integral(lambda q: -math.cos(q)), last - first
    edge_sums = depth * np.array([integral(math.sin), sine, sine, integral(math.sin), 0, 0, 0, one])
    np.testing.assert_allclose(moments, [chip, edge_sums], atol=1e-2 * depth)
    middles = 0.5 * (sector_edges(48)[1:] + sector_edges(48)[:-1])
    inside = (middles > first) & (middles < last)
    near = np.abs(middles - edge) < 0.05
    np.testing.assert_allclose(sectors[inside & ~near, 0], depth, rtol=5e-3)
    np.testing.assert_allclose(sectors[~inside & ~near], 0.0, atol=1e-9)


def test_above_a_block_and_below_it_nothing_is_met():
    for depth in (-1 * MM, 0.0):
        moments, rest, sectors = met(CUTTERS["flat"], depth)
        assert not moments.any()
        assert not rest.any()
        assert not sectors.any()
    # Deeper than the block is thick: as much of the flank as stands in it.
    _, rest, sectors = met(CUTTERS["flat"], 14 * MM)
    assert rest[2] == pytest.approx(10 * MM, rel=2e-3)
    np.testing.assert_allclose(sectors[:, :3], [[10 * MM, 4 * MM, 14 * MM]] * 48, rtol=1e-5)


@pytest.mark.parametrize("turn", [1, 2, 3])
@pytest.mark.parametrize(("name", "along"), [("flat", 0.0), ("ball", 0.0), ("bull", -0.4)])
def test_a_scene_that_is_turned_meets_the_same(turn, name, along):
    """Material from half a radius to the left of the tool on; step and block by right angles about the axis."""
    place = 2 * MM
    here = met(CUTTERS[name], 3 * MM, along, place, 1.0)
    there = met(CUTTERS[name], 3 * MM, along, place, 1.0, turn)
    for found, expected in zip(there, here, strict=True):
        np.testing.assert_allclose(found, expected, atol=1e-3 * np.abs(expected).max())


@pytest.mark.parametrize("name", CUTTERS)
@pytest.mark.parametrize("seed", range(4))
def test_a_leaning_tool_fed_anywhere_meets_what_its_surface_has_in_the_material(name, seed):
    """The material is all below the tool's highest reach; the cutter's surface in points, summed up."""
    rng = np.random.default_rng(seed)
    cutter, depth = CUTTERS[name], rng.uniform(1.0, 5.0) * MM
    shape = cutter.solid
    k = np.array([*rng.uniform(-0.4, 0.4, 2), 1.0])
    k /= np.linalg.norm(k)
    v = np.append(rng.normal(size=2), rng.uniform(-0.6, 0.2))
    v /= np.linalg.norm(v)
    along = float(v @ k)
    f = (v - along * k) / math.sqrt(1.0 - along**2)
    left = np.cross(k, f)
    world, halves = block_world(layers=6, dx=0.2 * MM), 2 if along < 0.0 else 1
    tip = np.array([2.0, -3.0, -depth / MM]) * MM
    total, sectors = np.zeros(2 * MOMENTS + REST), np.zeros(4 * 4 * PANELS * halves, dtype=np.float32)
    add_part(
        room_for(halves), world, shape, step_at(tip, k, v, f, (float(sinks(along)), 1), np.zeros(3)), total, sectors
    )

    phi = (np.arange(720) + 0.5) * np.pi / 360
    e = np.sin(phi)[:, None] * f + np.cos(phi)[:, None] * left
    expected, size, reach = np.zeros((2, MOMENTS)), 0.0, 0.0
    for stretch in (END, NOSE, FLANK):
        begin, stop = stretch_ends(shape, stretch, 20 * MM)
        if stop <= begin or (stretch == END and along >= -DISH):  # no seed gives a slope between pressed and dish
            continue
        ds = (stop - begin) / 200
        for s in begin + (np.arange(200) + 0.5) * ds:
            _, r, t, sine, cosine = on_profile(shape, stretch, s)
            facing = math.sqrt(1.0 - along**2) * np.sin(phi) * sine - along * cosine
            cuts = ((tip + r * e + t * k)[:, 2] < 0.0) & (facing > 0.0)
            size += cuts.sum() * ds * np.pi / 360
            reach = max(reach, t) if cuts.any() else reach
            for n, w in enumerate((facing * cuts, 1.0 * cuts)):
                w = w * ds * np.pi / 360
                expected[n] += [
                    w @ np.cos(phi),
                    w @ np.sin(phi),
                    sine * w @ np.sin(phi),
                    sine * w @ np.cos(phi),
                    cosine * w.sum(),
                    cosine * w @ np.sin(phi),
                    cosine * w @ np.cos(phi),
                    sine * w.sum(),
                ]
    for n in range(2):
        np.testing.assert_allclose(total[n * MOMENTS : (n + 1) * MOMENTS], expected[n], atol=2e-2 * expected[n].max())
    rest = total[2 * MOMENTS :]
    assert rest[SIZE] == pytest.approx(size, rel=2e-2)
    assert rest[REACH] == pytest.approx(reach, abs=0.1 * MM)
