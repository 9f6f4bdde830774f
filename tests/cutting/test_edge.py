"""Milling force: closed forms against brute force over the tooth angle, symmetries, and the paper's six rows."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from robomill.cutting.conditions import CutConditions
from robomill.cutting.edge import (
    MOMENTS,
    EdgeTerm,
    arc_moments,
    mean_force,
    moments,
    push,
)
from robomill.cutting.force import force_on_tool
from robomill.cutting.forces.along_path import PathForce
from robomill.cutting.forces.kienzle import KienzleForce
from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.cutting.materials import alternatives
from robomill.cutting.profile_kernels import depth_moment
from robomill.cutting.sines import sine_integral
from robomill.cutting.tool import Cutter
from robomill.io.materials import load_material, sample_materials
from tests.cutting.cutters import CHIP, CUTTERS, MILL, REF190, SLOT

GAUSS, WEIGHT = np.polynomial.legendre.leggauss(40)


def gauss(low, high, panels=40):
    """Nodes and weights of a composite rule on [low, high], graded towards both ends (sin^p is not smooth there)."""
    share = np.linspace(0, 1, panels + 1)
    for _ in range(2):
        share = np.sin(0.5 * np.pi * share) ** 2
    edges = low + (high - low) * share
    half, middle = 0.5 * np.diff(edges), 0.5 * (edges[1:] + edges[:-1])
    return (middle[:, None] + half[:, None] * GAUSS).ravel(), (half[:, None] * WEIGHT).ravel()


def brute_force(terms, cutter, c, a_p, phi_st, phi_ex):
    """Add up the force vectors of every bit of one tooth's edge over a turn (right-hand cutters), without moments."""
    total = np.zeros(3)
    nose = min(a_p, cutter.nose_height)
    pieces = []
    if nose > 0.0 and cutter.kind == "chamfer":
        slope = math.atan2(nose, float(cutter.radius_at(nose)) - cutter.flat_radius)
        pieces.append((np.array([slope]), np.array([nose / math.sin(slope)])))  # angle of the flank, length of edge
    elif nose > 0.0:
        kappa, w = gauss(0.0, math.acos(1.0 - nose / cutter.corner_radius))
        pieces.append((kappa, cutter.corner_radius * w))
    if a_p > nose:
        pieces.append((np.array([math.pi / 2]), np.array([a_p - nose])))
    phi, w_phi = gauss(phi_st, phi_ex)
    zero = np.zeros_like(phi)
    outward = np.stack([np.sin(phi), np.cos(phi), zero], -1)
    motion = np.stack([np.cos(phi), -np.sin(phi), zero], -1)
    up = np.array([0.0, 0.0, 1.0])
    for kappas, lengths in pieces:
        for kappa, length in zip(kappas, lengths, strict=True):
            normal = math.sin(kappa) * outward - math.cos(kappa) * up
            down_the_edge = -math.sin(kappa) * up - math.cos(kappa) * outward
            h = np.maximum(c * np.sin(phi) * math.sin(kappa), 0.0)
            for term in terms:
                pushes = -term.Kt * motion - term.Kr * normal + cutter.pull * term.Ka * down_the_edge
                total += length * ((w_phi * h**term.exponent) @ pushes)
    return total * cutter.flutes / (2 * np.pi)


@pytest.mark.parametrize("q", [0.0, 0.3, 0.75, 1.0, 1.75, 2.0, 2.4])
def test_sine_integral_by_quadrature(q):
    for angle in (1e-4, 0.3, np.pi / 2 - 1e-8, np.pi / 2, 2.0, np.pi):
        x, w = gauss(0.0, angle)
        assert sine_integral(q, angle) == pytest.approx(w @ np.sin(x) ** q, rel=1e-10)


def test_beta_integral_meets_the_closed_forms():
    phi = np.linspace(0, np.pi, 61)
    for q in (1.0, 2.0):
        np.testing.assert_allclose(sine_integral(q + 1e-13, phi), sine_integral(q, phi), atol=1e-12)


@pytest.mark.parametrize("cutter", CUTTERS, ids=lambda c: c.kind)
@pytest.mark.parametrize("arc", [(0, np.pi), (0, np.pi / 2), (np.pi / 2, np.pi), (0.4, 2.9), (1.0, 1.01)])
@pytest.mark.parametrize("name", ["al7075_t6_carbide_ref190", "al_wrought_cured_kienzle"])
def test_mean_force_equals_brute_force(cutter, arc, name):
    material = load_material(name)
    if material.kind == "kienzle":
        material = material.replace(radial_ratio=0.4, axial_ratio=0.15)
    for depth in (0.3e-3, 2e-3, 6e-3):
        exact = mean_force(material.terms, cutter, CHIP, depth, *arc)
        brute = brute_force(material.terms, cutter, CHIP, depth, *arc)
        np.testing.assert_allclose(exact, brute, rtol=1e-9, atol=1e-9 * np.linalg.norm(brute))


@settings(max_examples=60, deadline=None)
@given(
    start=st.floats(0, np.pi),
    end=st.floats(0, np.pi),
    e=st.sampled_from([0.0, 1.0, 0.75, 0.6]),
    depth=st.floats(1e-5, 8e-3),
    chip=st.floats(1e-6, 3e-4),
    cutter=st.sampled_from(CUTTERS),
)
def test_mean_force_equals_brute_force_for_any_arc(start, end, e, depth, chip, cutter):
    arc = min(start, end), max(start, end)
    terms = (EdgeTerm(e, 7.0, 3.0, 2.0),)
    exact = mean_force(terms, cutter, chip, depth, *arc)
    scale = 10 * cutter.flutes * depth * chip**e * cutter.radius / max(depth, 1e-5)
    np.testing.assert_allclose(exact, brute_force(terms, cutter, chip, depth, *arc), rtol=1e-9, atol=1e-9 * scale)


# N a (Ktc c/4 + Kte/pi) to the tenth; in whole newtons 110, 79, 93, 136, 33, 72.
PAPER_ROWS = {
    "al7075_t6_carbide_ref190": 110.4,
    "al7075_t6_carbide_ref160": 79.2,
    "al7075_hss_ref156": 92.6,
    "al7075_carbide_ref47": 136.5,
    "al6061_t6_carbide_ref160": 32.7,
    "al6082_t6_carbide_ref189": 72.2,
}


@pytest.mark.parametrize(("name", "F_y"), PAPER_ROWS.items())
def test_paper_slot_by_formula_and_by_brute_force(name, F_y):
    row = load_material(name)
    N, a, c = 3, 2e-3, CHIP
    by_hand = [
        -N * a * (row.Krc * c / 4 + row.Kre / np.pi),
        N * a * (row.Ktc * c / 4 + row.Kte / np.pi),
        -N * a * ((row.Kac or 0) * c / np.pi + (row.Kae or 0) / 2),
    ]
    force = MechanisticForce(MILL, row).components(SLOT)[0]
    np.testing.assert_allclose(force, by_hand, rtol=1e-12)
    np.testing.assert_allclose(force, brute_force(row.terms, MILL, CHIP, 2e-3, 0, np.pi), rtol=1e-9, atol=1e-12)
    assert force[1] == pytest.approx(F_y, abs=0.1)


def test_first_row_of_the_paper_has_its_axial_pull():
    force = MechanisticForce(MILL, REF190).components(SLOT)[0]
    assert force[1] == pytest.approx(110.4, abs=0.05)
    assert force[2] == pytest.approx(-23.3, abs=0.05)
    assert MechanisticForce(MILL, REF190, axial=False).components(SLOT)[0] == pytest.approx([*force[:2], 0.0])
    left = MechanisticForce(MILL.replace(helix="left"), REF190).components(SLOT)[0]
    assert left == pytest.approx(force * [1, 1, -1])


def test_left_hand_cutter_is_the_mirror_image():
    arc = (0.2, 1.7)
    mirrored = (np.pi - arc[1], np.pi - arc[0])
    left = MILL.replace(hand="left", helix="left")
    right = mean_force(REF190.terms, MILL, CHIP, 2e-3, *arc)
    np.testing.assert_allclose(mean_force(REF190.terms, left, CHIP, 2e-3, *mirrored), right * [1, -1, 1], rtol=1e-12)


def test_climb_pushes_away_from_the_wall_and_conventional_less_or_towards():
    # Half immersion with this row: climb has the part on the right and is pushed left, away from it.
    climb = mean_force(REF190.terms, MILL, CHIP, 2e-3, np.pi / 2, np.pi)
    conventional = mean_force(REF190.terms, MILL, CHIP, 2e-3, 0.0, np.pi / 2)
    assert climb[1] > conventional[1]
    assert climb[1] > 0
    assert climb[0] > conventional[0]  # climb pulls the tool into the cut
    slot = mean_force(REF190.terms, MILL, CHIP, 2e-3, 0.0, np.pi)
    np.testing.assert_allclose(climb + conventional, slot, rtol=1e-12)


def test_band_spans_the_alternative_rows_of_the_same_alloy():
    rows = alternatives(REF190, sample_materials())
    assert {row.name for row in rows} == {"al7075_hss_ref156", "al7075_carbide_ref47", "al7075_t6_carbide_ref160"}
    force = MechanisticForce(MILL, REF190, rows)
    feed_normal = [F[0, 1] for _, F in force.by_material(SLOT)]
    assert min(feed_normal) == pytest.approx(79.2, abs=0.1)
    assert max(feed_normal) == pytest.approx(136.5, abs=0.1)
    assert force.by_material(SLOT)[0][0].name == "al7075_t6_carbide_ref190"


def test_batch_equals_loop_and_rest_is_zero_in_air():
    rng = np.random.default_rng(5)
    m = 40
    start = rng.uniform(0, 2, m)
    values = {
        "v_f": rng.uniform(0.005, 0.05, m),
        "n_s": rng.uniform(50, 300, m),
        "a_p": rng.uniform(0, 3e-3, m),
        "phi_st": start,
        "phi_ex": np.minimum(start + rng.uniform(0, 1.5, m), np.pi),
        "cutting": rng.random(m) < 0.8,
        "s": np.arange(m),
        "t": np.arange(m),
        "across": rng.uniform(0.2, 1, m),
    }
    values["a_p"][:5] = 0.0
    values["n_s"][:5] = 0.0  # the spindle may stand in air
    force = KienzleForce(MILL, load_material("al_wrought_cured_kienzle"))
    many = force.components(CutConditions(**values))
    for i in range(m):
        one = force.components(CutConditions(**{key: value[i] for key, value in values.items()}))
        np.testing.assert_allclose(many[i], one[0], rtol=1e-12)
    idle = ~values["cutting"] | (values["a_p"] == 0)
    np.testing.assert_array_equal(many[idle], 0.0)
    assert (np.abs(many[~idle]).sum(1) > 0).all()
    np.testing.assert_array_equal(force.peak(CutConditions(**values)).high[idle], 0.0)


@pytest.mark.parametrize("cutter", CUTTERS, ids=lambda c: c.kind)
@pytest.mark.parametrize("slope", [-90.0, -40.0, -3.0, 25.0])
def test_ramps_and_plunges_make_the_chip_of_the_whole_feed(cutter, slope):
    """Every bit of surface that faces the feed, in a full slot: added up point by point, the end face with it."""
    v = np.array([np.cos(np.radians(slope)), 0.0, np.sin(np.radians(slope))])
    conditions = CutConditions.steady(0.03, 200.0, 2e-3, across=v[0], along=v[2])
    expected = push_of_surface(REF190, cutter, 0.03 / 200.0 / cutter.flutes, 2e-3, v)
    found = MechanisticForce(cutter, REF190).components(conditions)[0]
    np.testing.assert_allclose(found, expected, atol=4e-3 * np.linalg.norm(expected))


def push_of_surface(row, cutter, c, depth, v, pieces=600):
    """Mean force of a right-hand cutter buried to a depth and fed along v: a cloud of points with their normals."""
    r = np.concatenate([np.linspace(0, cutter.radius, 4 * pieces + 1), np.full(pieces, cutter.radius)])
    nose = np.linspace(0, cutter.radius, 4 * pieces + 1)
    z = np.concatenate([cutter.profile(nose), np.linspace(cutter.nose_height, max(depth, cutter.nose_height), pieces)])
    dr, dz = np.diff(r), np.diff(z)
    ds = np.hypot(dr, dz)
    keep = (ds > 0) & (0.5 * (z[1:] + z[:-1]) < depth)
    sine, cosine, ds = (dz[keep] / ds[keep]), (dr[keep] / ds[keep]), ds[keep]
    total, turns = np.zeros(3), 360
    for phi in (np.arange(turns) + 0.5) * 2 * np.pi / turns:
        e, motion = np.array([np.sin(phi), np.cos(phi), 0]), np.array([np.cos(phi), -np.sin(phi), 0])
        n = sine[:, None] * e - cosine[:, None] * np.array([0, 0, 1.0])
        down = -sine[:, None] * np.array([0, 0, 1.0]) - cosine[:, None] * e
        facing = n @ v
        h, bit = c * facing, np.where(facing > 1e-6, ds, 0.0)[:, None]
        K = [np.asarray(a * h + b)[:, None] for a, b in ((row.Ktc, row.Kte), (row.Krc, row.Kre), (row.Kac, row.Kae))]
        total += np.sum(bit * (-K[0] * motion - K[1] * n + cutter.pull * K[2] * down), axis=0)
    return total * cutter.flutes / turns


def test_the_whole_end_of_a_mill_cuts_only_beyond_its_dish():
    """Teeth are ground hollow: on a slope of 0.04 degrees the face does not rub, at 1 degree all of it does."""
    thrust = [
        MechanisticForce(MILL, REF190).components(
            CutConditions.steady(0.03, 200.0, 2e-3, across=np.cos(a), along=-np.sin(a))
        )[0, 2]
        for a in np.radians([0.0, 0.04, 1.0])
    ]
    assert thrust[1] == pytest.approx(thrust[0], rel=1e-4)
    assert thrust[2] - thrust[0] > 3 * 4e-3 * REF190.Kre


def test_a_drill_pushes_as_the_handbook_says():
    """F_f = 0.5 k_c f (D / 2) sin(kappa_r), k_c = kc1.1 h^-mc with h = f_z sin(kappa_r) in mm; full point engaged."""
    row = load_material("al_wrought_cured_kienzle")
    drill = Cutter("drill", 6e-3, tip_angle=math.radians(118.0), flutes=2)
    conditions = CutConditions.steady(0.005, 50.0, 10e-3, across=0.0, along=-1.0)
    f, kappa = 0.1e-3, math.radians(59.0)
    k_c = row.kc11 * (0.5 * f * math.sin(kappa) * 1e3) ** -row.mc
    expected = 0.5 * k_c * f * 3e-3 * math.sin(kappa)
    assert KienzleForce(drill, row).components(conditions)[0] == pytest.approx([0, 0, expected], rel=1e-6)
    assert 50.0 < expected < 500.0


def reasons(force, **changes):
    conditions = CutConditions.steady(0.03, 200.0, 2e-3, **changes)
    frame = np.eye(3)[None]
    found = {unknown.code for unknown in force.unjudged(conditions)}
    assert np.isnan(force_on_tool(force, conditions, frame)).all() == bool(found)
    return found


def test_what_has_no_model_is_said_and_not_a_number():
    mill, drill = MechanisticForce(MILL, REF190), MechanisticForce(Cutter("drill", 8e-3, tip_angle=2.0), REF190)
    assert reasons(mill) == set()
    assert reasons(mill, ccw=True) == {"spindle_sense"}
    assert reasons(MechanisticForce(MILL.replace(hand="left"), REF190), ccw=True) == set()
    assert reasons(MechanisticForce(MILL.replace(hand="left"), REF190)) == {"spindle_sense"}
    assert reasons(MechanisticForce(MILL.replace(flute_length=2e-3), REF190)) == set()
    assert reasons(MechanisticForce(MILL.replace(flute_length=1.9e-3), REF190)) == {"shank"}
    assert reasons(drill) == {"drill_sideways"}
    assert reasons(drill, across=0.0, along=-1.0) == set()
    assert reasons(PathForce(feed=1.0), across=0.0, along=-1.0) == {"plunge_stated"}
    assert reasons(PathForce(feed=1.0)) == set()
    unknown = CutConditions(
        **{**{n: getattr(SLOT, n) for n in ("v_f", "a_p", "phi_st", "phi_ex", "cutting", "s", "t")}, "n_s": np.nan}
    )
    assert [each.code for each in mill.unjudged(unknown)] == ["spindle_speed"]


def test_a_bit_of_edge_pushes_along_its_three_directions():
    """Each coefficient alone against its direction: the tooth's motion, the normal, and down the edge."""
    phi, kappa = 0.7, 0.4
    outward, up = np.array([math.sin(phi), math.cos(phi), 0.0]), np.array([0.0, 0.0, 1.0])
    motion = np.array([math.cos(phi), -math.sin(phi), 0.0])  # of a right-hand tooth, clockwise from the left
    normal = math.sin(kappa) * outward - math.cos(kappa) * up
    down = -math.sin(kappa) * up - math.cos(kappa) * outward
    sums = moments(2.0, 2.0 * math.sin(kappa), 2.0 * math.cos(kappa), math.sin(phi), math.cos(phi))
    assert len(sums) == MOMENTS
    for hand, helix in itertools.product(("right", "left"), repeat=2):
        cutter, turns = MILL.replace(hand=hand, helix=helix), 1.0 if hand == "right" else -1.0
        pulls = 1.0 if hand == helix else -1.0
        for K, way in (("Kt", -turns * motion), ("Kr", -normal), ("Ka", pulls * down)):
            term = EdgeTerm(1.0, **{"Kt": 0.0, "Kr": 0.0, "Ka": 0.0, K: 5.0})
            np.testing.assert_allclose(push(term, cutter, sums), 10.0 * way, atol=1e-15)
    straight = push(EdgeTerm(1.0, 0.0, 0.0, 5.0), MILL.replace(helix_angle=0.0), sums)
    np.testing.assert_array_equal(straight, 0.0)


def test_moments_of_an_empty_arc_and_of_no_depth():
    assert np.all(np.array(arc_moments(0.0, np.array(1.2), np.array(1.2))) == 0.0)
    assert all(depth_moment(cutter.solid, 0.0, -1.0, q) == 0.0 for cutter in CUTTERS for q in (0, 1))
