"""The force over a pitch: its mean, its peak, and what the helix does to both."""

import math
import tracemalloc

import numpy as np
import pytest
from scipy.integrate import quad

from robomill.cutting.conditions import CutConditions
from robomill.cutting.course import Course, force_at
from robomill.cutting.edge import EdgeTerm, mean_force
from robomill.cutting.engaged import EngagedPart
from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.cutting.tool import DISH, MOST_FLUTES, PRESSED, Cutter
from tests.cutting.cutters import CHIP, CUTTERS, MILL, REF190, SLOT


def over_pitch(terms, cutter, course, instants):
    """The course of cuts over a pitch, (k, instants, 3) N."""
    pitch = 2.0 * np.pi / cutter.flutes
    return force_at(terms, cutter, course, (np.arange(instants) + 0.5)[None] / instants * pitch)


def force_over_pitch(terms, cutter, c, a_p, arc, instants=120):
    """The course of one arc over the whole depth, (instants, 3) N."""
    course = Course(np.array([c]), np.array([[1.0, 0.0]]), np.array([arc]), np.array([[[a_p, 0.0, a_p, 0.0]]]))
    return over_pitch(terms, cutter, course, instants)[0]


@pytest.mark.parametrize("cutter", CUTTERS, ids=lambda c: c.kind)
def test_mean_over_a_pitch_is_the_mean_force(cutter):
    turns = force_over_pitch(REF190.terms, cutter, CHIP, 2e-3, (0.3, 2.2), instants=720)
    exact = mean_force(REF190.terms, cutter, CHIP, 2e-3, 0.3, 2.2)
    assert np.linalg.norm(turns.mean(0) - exact) < 2e-3 * np.linalg.norm(exact)


def test_peak_of_one_straight_tooth_in_a_slot():
    """One straight tooth: F_y = a (Ktc c sin^2 + Kte sin - Krc c sin cos - Kre cos), searched on a fine grid."""
    mill = MILL.replace(flutes=1, helix_angle=0.0)
    conditions = CutConditions.steady(0.01, 200.0, 2e-3)
    peak = MechanisticForce(mill, REF190).peak(conditions)
    phi = np.linspace(0, np.pi, 20001)
    F_t = 2e-3 * (REF190.Ktc * CHIP * np.sin(phi) + REF190.Kte)
    F_r = 2e-3 * (REF190.Krc * CHIP * np.sin(phi) + REF190.Kre)
    F_y = F_t * np.sin(phi) - F_r * np.cos(phi)
    assert peak.high[0, 1] == pytest.approx(F_y.max(), rel=2e-3)
    assert np.linalg.norm(peak.at_peak[0]) == pytest.approx(np.hypot(F_t, F_r).max(), rel=2e-3)


@pytest.mark.parametrize("helix", [0.0, 0.3, 1.0, 10.0])
@pytest.mark.parametrize("hand", ["right", "left"])
@pytest.mark.parametrize("climb", [True, False])
@pytest.mark.parametrize("a_e", [0.05e-3, 0.1e-3, 0.2e-3, 0.5e-3, 2e-3, 3.7e-3])
def test_peak_of_a_finishing_pass_is_where_a_tooth_comes_or_goes(a_e, climb, hand, helix):
    """Brute force: the edges of all teeth as points, at every thirtieth of a degree; a straight one cuts its thickest
    chip as it meets the outside of the part, an instant before or after which there is none."""
    R, a_p, flutes = 4e-3, 2e-3, 3
    mill = MILL.replace(flutes=flutes, helix_angle=math.radians(helix), hand=hand, helix=hand)
    width = math.acos(1.0 - a_e / R)
    first, last = (np.pi - width, np.pi) if climb == (hand == "right") else (0.0, width)
    arc = CutConditions.steady(0.03, 200.0, a_p, arc=(first, last))
    force = MechanisticForce(mill, REF190)
    peak, mean = force.peak(arc), force.components(arc)[0]
    turn, heights = np.arange(0.0, 360.0 / flutes, 1 / 30), (np.arange(100) + 0.5) * a_p / 100
    sense, course = (1.0 if hand == "right" else -1.0), np.zeros((len(turn), 3))
    for tooth in range(flutes):
        lagging = np.radians(turn[:, None] + 360.0 / flutes * tooth) - heights * math.tan(mill.helix_angle) / R
        phi = (lagging if sense > 0 else np.pi - lagging) % (2 * np.pi)
        h, db = CHIP * np.sin(phi), np.where((phi >= first) & (phi <= last), a_p / 100, 0.0)
        F_t, F_r, F_a = (
            (K * h + edge) * db
            for K, edge in ((REF190.Ktc, REF190.Kte), (REF190.Krc, REF190.Kre), (REF190.Kac, REF190.Kae))
        )
        course[:, 0] += (-sense * F_t * np.cos(phi) - F_r * np.sin(phi)).sum(axis=1)
        course[:, 1] += (sense * F_t * np.sin(phi) - F_r * np.cos(phi)).sum(axis=1)
        course[:, 2] -= F_a.sum(axis=1) if helix else 0.0  # a straight edge pulls nowhere
    size = np.linalg.norm(course, axis=1).max()
    np.testing.assert_allclose(mean, course.mean(axis=0), atol=0.01 * size)
    assert np.linalg.norm(peak.at_peak[0]) == pytest.approx(size, rel=0.02)
    np.testing.assert_allclose(peak.high[0], course.max(axis=0), atol=0.02 * size)
    np.testing.assert_allclose(peak.low[0], course.min(axis=0), atol=0.02 * size)


@pytest.mark.parametrize("helix", [15.0, 45.0, 60.0])
@pytest.mark.parametrize(("first", "last"), [(1.0, 1.05), (0.0, 0.1), (3.0, np.pi), (0.3, 1.7)])
@pytest.mark.parametrize(("flutes", "a_p"), [(1, 5e-3), (3, 3e-3)])
def test_peak_of_a_steep_helix_in_a_narrow_arc(flutes, a_p, first, last, helix):
    """An edge over L of the turn carries a_p / L times the integral of its load over its part in the arc: from a table
    of that integral by angle, whatever the arc."""
    mill = MILL.replace(flutes=flutes, helix_angle=math.radians(helix))
    force = MechanisticForce(mill, REF190)
    arc = CutConditions.steady(0.03, 200.0, a_p, arc=(first, last))
    peak, mean = force.peak(arc), force.components(arc)[0]
    phi = np.linspace(first, last, 20001)
    h = 0.03 / 200.0 / flutes * np.sin(phi)
    F_t, F_r, F_a = REF190.Ktc * h + REF190.Kte, REF190.Krc * h + REF190.Kre, REF190.Kac * h + REF190.Kae
    loads = np.stack([-F_t * np.cos(phi) - F_r * np.sin(phi), F_t * np.sin(phi) - F_r * np.cos(phi), -F_a])
    steps = 0.5 * (loads[:, 1:] + loads[:, :-1]) * np.diff(phi)
    so_far = np.hstack([np.zeros((3, 1)), np.cumsum(steps, axis=1)])
    lag = a_p * math.tan(mill.helix_angle) / mill.radius
    turn = np.linspace(0.0, 2.0 * np.pi, 20001)[:-1]
    course = np.zeros((len(turn), 3))
    for tooth in range(2 * flutes):  # twice round: a long edge is in the arc more than a turn after its tip came in
        low, high = turn + 2.0 * np.pi * tooth / flutes - lag, turn + 2.0 * np.pi * tooth / flutes
        for n in range(3):
            course[:, n] += a_p / lag * (np.interp(high, phi, so_far[n]) - np.interp(low, phi, so_far[n]))
    course = course[: len(turn) // flutes] if flutes > 1 else course
    size = np.linalg.norm(course, axis=1).max()
    np.testing.assert_allclose(mean, course.mean(axis=0), atol=1e-3 * size)
    assert np.linalg.norm(peak.at_peak[0]) == pytest.approx(size, rel=0.03)
    np.testing.assert_allclose(peak.high[0], course.max(axis=0), atol=0.03 * size)
    np.testing.assert_allclose(peak.low[0], course.min(axis=0), atol=0.03 * size)


def test_peak_is_at_least_the_mean_and_helix_smooths_it():
    force = MechanisticForce(MILL, REF190)
    mean, peak = force.components(SLOT), force.peak(SLOT)
    assert (peak.high >= mean).all()
    assert (peak.low <= mean).all()
    steep = MechanisticForce(MILL.replace(helix_angle=math.radians(60)), REF190).peak(SLOT)
    assert steep.high[0, 1] < peak.high[0, 1]


def test_many_teeth_in_many_cuts_take_bounded_memory():
    """All cuts with all teeth at once would take much more."""
    force = MechanisticForce(MILL.replace(flutes=MOST_FLUTES), REF190)
    conditions = CutConditions.steady(0.03, 200.0, np.linspace(1e-3, 2e-3, 300))
    tracemalloc.start()
    try:
        peak = force.peak(conditions)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert most < 2.6e8
    assert len(np.unique(peak.high[:, 1])) > 100
    alone = force.peak(CutConditions.steady(0.03, 200.0, 1e-3))
    np.testing.assert_allclose(peak.high[0], alone.high[0], rtol=2e-3)


@pytest.mark.parametrize(("helix", "first", "last"), [("right", 1.0, 1.1 + 0.5774), ("left", 1.0 - 0.5774, 1.1)])
def test_the_upper_edge_lags_on_a_pulling_helix_and_leads_on_a_pushing_one(helix, first, last):
    mill = MILL.replace(flutes=1, helix=helix)  # 30 deg: the edge turns by tan(30 deg) over 4 mm
    force = force_over_pitch(REF190.terms, mill, CHIP, 4e-3, (1.0, 1.1), instants=1440)
    turn = (np.arange(1440) + 0.5) * 2 * np.pi / 1440
    cuts = turn[np.abs(force).sum(1) > 0]
    assert (cuts.min(), cuts.max()) == pytest.approx((first, last), abs=0.02)


def test_left_hand_cutter_is_the_mirror_image_at_every_instant():
    arc = (0.2, 1.7)
    mirrored = (np.pi - arc[1], np.pi - arc[0])
    left = MILL.replace(hand="left", helix="left")
    turns = [force_over_pitch(REF190.terms, *case) for case in ((MILL, CHIP, 2e-3, arc), (left, CHIP, 2e-3, mirrored))]
    np.testing.assert_allclose(turns[1], turns[0] * [1, -1, 1], atol=1e-12)


def edges_of(count):
    """Where sectors begin: half turns, or the quarters of twelve panels on a half turn, as their definition says."""
    if count <= 2:
        return np.pi * np.arange(count + 1)
    corners = np.pi * np.sin(np.pi * np.arange(13) / 24) ** 2
    half = np.interp(np.arange(49) / 4, np.arange(13), corners)
    return half if count == 48 else np.append(half, np.pi + half[1:])


def by_teeth(terms, cutter, c, feed, sectors, instants):
    """Every tooth at every instant as points along its edge, each a vector (feed, left, up)."""
    edges, R, flutes = edges_of(len(sectors)), cutter.diameter / 2, cutter.flutes
    v, force = np.array([feed[0], 0.0, feed[1]]), np.zeros((instants, 3))
    hand, pull = (1.0 if cutter.hand == "right" else -1.0), (1.0 if cutter.helix == cutter.hand else -1.0)
    top, nose = sectors[:, 2].max(), min(cutter.corner_radius, sectors[:, 2].max())
    points = [(0.0, 0.0, None)]  # height, angle of the normal, length; the end face has its length from the sector
    if nose > 0.0:
        rho, last = cutter.corner_radius, math.acos(1.0 - nose / cutter.corner_radius)
        points += [(rho * (1 - math.cos(k)), k, rho * last / 300) for k in (np.arange(300) + 0.5) * last / 300]
    if top > nose:
        points += [(z, math.pi / 2, (top - nose) / 300) for z in nose + (np.arange(300) + 0.5) * (top - nose) / 300]
    for i in range(instants):
        for tooth in range(flutes):
            turn = 2 * np.pi / flutes * ((i + 0.5) / instants + tooth)
            for z, kappa, length in points:
                lagging = turn - z * math.tan(cutter.helix_angle) / R * pull
                phi = (lagging if hand > 0 else np.pi - lagging) % (2 * np.pi)
                n = np.searchsorted(edges, phi) - 1
                if n >= len(sectors):
                    continue
                height, low, high, face = sectors[n]
                if length is None:
                    db = face
                else:
                    db = length * height / (high - low) if low < z < high else 0.0
                radial, up = np.array([math.sin(phi), math.cos(phi), 0.0]), np.array([0.0, 0.0, 1.0])
                motion = hand * np.array([math.cos(phi), -math.sin(phi), 0.0])
                normal = math.sin(kappa) * radial - math.cos(kappa) * up
                h = c * (normal @ v)
                if h > 1e-6 * c and db > 0.0:
                    for term in terms:
                        along = -math.cos(kappa) * radial - math.sin(kappa) * up
                        push = -term.Kt * motion - term.Kr * normal + pull * term.Ka * along
                        force[i] += h**term.exponent * db * push
    return force


def random_sectors(count, seed):
    """Sectors with material, with a gap in it, and without; those behind only part of the end face."""
    rng = np.random.default_rng(seed)
    low = rng.uniform(0.0, 0.6e-3, count)
    high = low + rng.uniform(0.5e-3, 2e-3, count)
    sectors = np.stack([(high - low) * rng.uniform(0.4, 1.0, count), low, high, rng.uniform(0.0, 1e-3, count)], axis=1)
    sectors[rng.random(count) < 0.2] = 0.0
    return sectors


@pytest.mark.parametrize(
    ("cutter", "count", "feed"),
    [
        (MILL, 48, (1.0, 0.0)),
        (MILL.replace(hand="left", helix="left", flutes=2), 48, (1.0, 0.0)),
        (MILL.replace(helix="left"), 96, (0.8, -0.6)),
        (Cutter("bull", 8e-3, corner_radius=1e-3, flutes=2), 96, (0.6, -0.8)),
        (Cutter("ball", 8e-3, flutes=1), 1, (1.0, 0.0)),
        (MILL, 2, (0.0, -1.0)),
    ],
    ids=["mill", "left-hand", "pushing", "bull-diving", "ball", "plunge"],
)
def test_sectors_over_a_pitch_as_points_along_every_tooth(cutter, count, feed):
    """Lengths of a slice are counted whole where its middle is: the mean of a few per cent of the largest is left."""
    sectors = random_sectors(count, seed=count)
    terms = (EdgeTerm(1.0, 8e8, 3e8, 2e8), EdgeTerm(0.0, 2e4, 3e4, 1e4))
    course = Course(np.array([CHIP]), np.array([feed]), np.array([[0.0, np.pi]]), sectors[None])
    found, expected = over_pitch(terms, cutter, course, 24)[0], by_teeth(terms, cutter, CHIP, feed, sectors, 24)
    largest = np.linalg.norm(expected, axis=1).max()
    assert np.abs(found - expected).mean() < 0.02 * largest
    assert np.abs(found.mean(axis=0) - expected.mean(axis=0)).max() < 0.01 * largest


def test_the_end_face_has_no_lag():
    """A sector about straight ahead, only the end face: the one tooth is there when it points ahead."""
    sectors = np.zeros((1, 48, 4))
    ahead = np.searchsorted(edges_of(48), 0.5 * np.pi) - 1
    sectors[0, ahead, 3] = 2e-3
    mill = MILL.replace(flutes=1, helix_angle=math.radians(60))
    course = Course(np.array([CHIP]), np.array([[0.6, -0.8]]), np.array([[0.0, np.pi]]), sectors)
    force = over_pitch(REF190.terms, mill, course, 3600)[0]
    phi = (np.arange(3600) + 0.5) * 2 * np.pi / 3600
    cuts = phi[np.abs(force).sum(axis=1) > 0.0]
    np.testing.assert_allclose([cuts.min(), cuts.max()], edges_of(48)[[ahead, ahead + 1]], atol=2e-3)


def with_part(sectors, arc, moments=None):
    """Steps whose engaged part has these sectors (m, s, 4) and, by itself, the sums of a full slot."""
    m = len(sectors)
    sums = np.ones((m, 1, 8)) if moments is None else moments
    conditions = CutConditions.steady(0.03, 200.0, np.full(m, 2e-3), arc=arc)
    return CutConditions(**{**vars(conditions), "part": EngagedPart((1.0,), sums, sectors)})


def test_sectors_at_the_ends_of_the_arc_are_as_full_as_their_part_within_it():
    sectors = np.zeros((1, 96, 4))
    sectors[0, :, 0], sectors[0, :, 2], sectors[0, :, 3] = 1e-3, 2e-3, 0.5e-3
    edges = edges_of(96)
    arc = (0.25 * edges[10] + 0.75 * edges[11], 0.5 * (edges[30] + edges[31]))
    found = Course.of(with_part(sectors, arc), MILL, np.array([0])).sectors[0]
    sectors = sectors.astype(np.float16).astype(float)[0]  # as a part keeps them
    np.testing.assert_allclose(found[10, [0, 3]], 4.0 * sectors[10, [0, 3]])
    np.testing.assert_allclose(found[30, [0, 3]], 2.0 * sectors[30, [0, 3]])
    np.testing.assert_array_equal(found[11:30], sectors[11:30])
    np.testing.assert_array_equal(found[48:], sectors[48:])  # behind: no arc is told there
    np.testing.assert_array_equal(found[:, 1:3], sectors[:, 1:3])


@pytest.mark.parametrize("count", [48, 96])
@pytest.mark.parametrize(("first", "last"), [((0, 0.75), (47, 0.5)), ((0, 0.0), (47, 0.25)), ((5, 0.2), (47, 1.0))])
def test_an_arc_may_end_in_the_last_sector_ahead(count, first, last):
    """Begun so far into one sector and ended so far into another: each is as full as its part within the arc."""
    sectors = np.zeros((1, count, 4))
    sectors[0, :, 0], sectors[0, :, 2], sectors[0, :, 3] = 1e-3, 2e-3, 0.5e-3
    edges = edges_of(count)
    arc = tuple(edges[n] + share * (edges[n + 1] - edges[n]) for n, share in (first, last))
    found = Course.of(with_part(sectors, arc), MILL, np.array([0])).sectors[0]
    kept = sectors.astype(np.float16).astype(float)[0]
    for (n, _), within in ((first, 1.0 - first[1]), (last, last[1])):
        np.testing.assert_allclose(found[n, [0, 3]] * within, kept[n, [0, 3]], rtol=1e-9)
    np.testing.assert_array_equal(found[first[0] + 1 : last[0]], kept[first[0] + 1 : last[0]])
    np.testing.assert_array_equal(found[48:], kept[48:])


def test_an_arc_without_a_part_is_two_half_turns_alike_with_the_end_face_beyond_the_dish():
    slopes = np.array([0.0, -PRESSED, -1.001 * DISH])
    conditions = CutConditions.steady(0.03, 200.0, [1e-3, 2e-3, 3e-3], along=slopes, arc=(0.5, 2.0))
    course = Course.of(conditions, MILL, np.array([0, 1, 2]))
    for n, (depth, face) in enumerate(((1e-3, 0.0), (2e-3, 0.0), (3e-3, MILL.radius))):
        np.testing.assert_allclose(course.sectors[n], [[depth, 0.0, depth, face]] * 2)
    np.testing.assert_allclose(course.arc, [[0.5, 2.0]] * 3)
    np.testing.assert_allclose(course.feed, np.stack([np.ones(3), slopes], axis=1))
    np.testing.assert_allclose(course.c, 0.03 / 200.0 / 3)


@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_on_a_gentle_slope_the_heel_alone_cuts_ahead_and_behind_by_its_ellipse(share):
    """Outside r = R (1 - s^2) / (1 - 2 s sin phi + s^2), s the slope over that of the dish, by adaptive quadrature."""
    pressed, dish = (math.tan(math.asin(each)) for each in (PRESSED, DISH))
    slope = pressed + share * (dish - pressed)
    along = -math.sin(math.atan(slope))
    conditions = CutConditions.steady(0.03, 200.0, 2e-3, across=math.cos(math.atan(slope)), along=along)
    found = Course.of(conditions, MILL, np.array([0])).sectors[0, :, 3]

    def cut(phi):
        r = MILL.radius * (1 - share**2) / (1 - 2 * share * math.sin(phi) + share**2)
        return max(MILL.radius - r, 0.0)

    means = [quad(cut, low, low + math.pi, limit=200)[0] / math.pi for low in (0.0, math.pi)]
    np.testing.assert_allclose(found, means, rtol=5e-3, atol=1e-6 * MILL.radius)


def test_cuts_alike_to_a_thousandth_are_one_kind():
    depth = 1e-3 * np.array([2.0, 2.0005, 1.0, 1.9, 2.0])
    conditions = CutConditions.steady(0.03, 200.0, depth)
    course = Course.of(conditions, MILL, np.arange(5))
    one_of_each, kind = Course.kinds(conditions, MILL, np.arange(5))
    assert len(one_of_each.c) == 3
    assert kind[0] == kind[1] == kind[4]
    assert len({kind[0], kind[2], kind[3]}) == 3
    for name in ("c", "feed", "arc", "sectors"):
        np.testing.assert_allclose(getattr(one_of_each, name)[kind], getattr(course, name), rtol=1e-3)
    np.testing.assert_array_equal(course.at(np.array([2])).sectors, course.sectors[[2]])


def test_the_range_is_about_the_mean_of_the_part():
    """Sums larger by any vector carry the whole course with them."""
    sectors = np.stack([random_sectors(48, seed=5)] * 2)
    moments = np.ones((2, 1, 8))
    moments[1, 0, :2] += 3e-4, -2e-4
    force = MechanisticForce(MILL, REF190)
    conditions = with_part(sectors, (0.0, np.pi), np.concatenate([moments, moments], axis=1) * 1e-3)
    part = EngagedPart((1.0, 0.0), conditions.part.moments, sectors)
    conditions = CutConditions(**{**vars(conditions), "part": part})
    mean, spread = force.components(conditions), force.peak(conditions)
    assert (np.abs(mean[1] - mean[0])[:2] > 1e-3).all()
    for ends in (spread.low, spread.high):
        np.testing.assert_allclose(ends[1] - ends[0], mean[1] - mean[0], atol=1e-9)
