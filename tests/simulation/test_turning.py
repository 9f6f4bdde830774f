"""The tool's axis turning while it cuts, against forces of teeth that move as they do."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest

import robomill as rm
from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.io.materials import load_material
from robomill.io.samples import samples_dir
from robomill.simulation.turning import AXIS_TURNS, turn_rate
from robomill.surface.stock import Stock
from robomill.toolpath.path import Toolpath
from robomill.toolpath.source import GCodeSource
from tests.cutting.brute_force import DISH, Cut, Floats, Move, _surface, axis, box
from tests.simulation.cuts import AL7075, BALL, BULL, FLAT

FEED = 0.05e-3


def forces(cutter, turning: Floats, k: Floats, side: tuple[float, float], points: int = 6000) -> tuple[Floats, Floats]:
    """Force ON the tool (3,) N, tip at the origin on its way along X through metal 1.5 mm deep between two y: as its
    teeth move (the axis k turns by ``turning`` rad per m of way), and as if all moved with the tip."""
    behind = np.concatenate([[0.0], 1e-9 * 1.3 ** np.arange(62)])
    before = []
    for a, b in itertools.pairwise(behind):
        was = k - 0.5 * (a + b) * np.cross(turning, k)
        before.append(Move(cutter, np.array([-b, 0, 0]), np.array([-a, 0, 0]), was / np.linalg.norm(was)))
    metal = Cut(box((-0.2, side[0], -0.01), (0.2, side[1], 1.5e-3)), tuple(before))
    x = np.cross([0.0, 1.0, 0.0], k) / np.linalg.norm(np.cross([0.0, 1.0, 0.0], k))
    y, way, found = np.cross(k, x), np.array([1.0, 0, 0]), [np.zeros(3), np.zeros(3)]
    for phi, kappa, r, z, share in _surface(cutter, 3e-3, points):
        e = np.outer(np.cos(phi), x) + np.outer(np.sin(phi), y)
        normal = np.sin(kappa)[:, None] * e - np.outer(np.cos(kappa), k)
        place = r[:, None] * e + np.outer(z, k)
        for force, velocity in zip(found, (way + np.cross(turning, place), way + 0.0 * place), strict=True):
            h = np.einsum("ij,ij->i", normal, velocity)
            cuts = h > np.where(kappa == 0.0, DISH, 1e-9)
            cuts[cuts] = metal.solid(place[cuts] + 1e-10 * normal[cuts])
            for term in AL7075:
                load = term.Kt * np.cross(k, e) - term.Kr * normal
                force += cutter.flutes / (2 * np.pi) * share * ((FEED * h[cuts]) ** term.exponent @ load[cuts])
    return found[0], found[1]


@pytest.mark.parametrize("cutter", [FLAT, BALL, BULL], ids=lambda cutter: cutter.kind)
@pytest.mark.parametrize("side", [(-10e-3, 10e-3), (2.2e-3, 20e-3), (-20e-3, -2.2e-3)], ids=["slot", "left", "right"])
@pytest.mark.parametrize("about", [(0, 1.0, 0), (0, -1.0, 0), (1.0, 0, 0), (-1.0, 0, 0)])
def test_slow_turns_change_the_force_by_less_than_five_per_cent(cutter, side, about):
    """At the most that is judged: the rim turns the direction of its feed by half a degree."""
    for lean in (0.0, 8.0):
        k = axis(A=lean) if about[0] else axis(B=lean)
        moved, still = forces(cutter, 2.1 * np.array(about), k, side)
        assert np.linalg.norm(moved - still) < 0.05 * np.linalg.norm(still)


def test_faster_turns_do_more():
    moved, still = forces(FLAT, np.array([4.4, 0, 0]), axis(), (-10e-3, 10e-3))
    assert np.linalg.norm(moved - still) > 0.5 * np.linalg.norm(still)  # the end face cuts on one side


def program(way: float, tilt: float, force=None):
    text = f"G21 G90 S8000 M3\nG0 X-40 Y0 Z5\nG0 Z-2\nG1 X-20 F1200\nG1 X{-20 + way} B{tilt}\nG1 X45\nM2\n"
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml")
    material = rm.load_setup(samples_dir() / "pocket_arcs" / "setup.toml").force
    stock = Stock([-30e-3, -20e-3, -10e-3], [30e-3, 20e-3, 0.0])
    changed = setup.replace(source=GCodeSource(text), stock=stock, cell=2e-4, cutter=FLAT, engagement=True)
    return rm.simulate(changed.replace(force=force or material))


@pytest.mark.parametrize(
    ("way", "tilt", "known"), [(40.0, 4.0, True), (40.0, 19.0, True), (40.0, 22.0, False), (10.0, -6.0, False)]
)
def test_a_turn_that_is_not_known_is_counted_and_never_green(way, tilt, known):
    """8 mm across: 0.51 degrees on every mm of way are the most that is judged."""
    result = program(way, tilt)
    turned = (result.path.block == 5) & (np.append(0.0, np.abs(np.diff(result.path.k[:, 0]))) > 0.0)
    assert turn_rate(result.path)[turned] == pytest.approx(np.radians(abs(tilt)) / (way * 1e-3), rel=1e-6)
    tolerant = dataclasses.replace(result, setup=result.setup.replace(tolerance=5e-3))
    assert tolerant.verdict.level == ("ok" if known else "unjudged")
    if not known:
        lost = next(each.where for each in result.unjudged if each.code == AXIS_TURNS)
        assert lost[turned].all()
        assert set(result.path.block[lost]) == {5}
        assert np.isnan(result.delta[lost]).all()


@pytest.mark.parametrize("cutter", [FLAT, BULL, BALL], ids=lambda cutter: cutter.kind)
@pytest.mark.parametrize("letter", ["A", "B"])
@pytest.mark.parametrize("rate", [0.5, -0.5])
def test_the_force_of_a_turning_axis_is_that_of_teeth_that_move_as_they_do(cutter, letter, rate):
    """Whole runs, half a degree on every mm of way, through a slot and beside a shoulder; straight flutes."""
    straight, about = cutter.replace(helix_angle=0.0), np.array([0.0, 1.0, 0.0] if letter == "B" else [1.0, 0.0, 0.0])
    text = f"G21 G90 S12000 M3\nG0 X-50 Y0 Z15\nG0 Z-1.5\nG1 X-10 F1800\nG1 X10 {letter}{20 * rate}\nM2\n"
    paper = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml")
    for side in ((-20e-3, 20e-3), (2.2e-3, 20e-3), (-20e-3, -2.2e-3)):
        setup = paper.replace(
            source=GCodeSource(text),
            stock=Stock([-40e-3, side[0], -10e-3], [40e-3, side[1], 0.0]),
            cell=2e-4,
            cutter=straight,
            engagement=True,
            force=MechanisticForce(straight, load_material("al7075_t6_carbide_ref190")),
        )
        result = rm.simulate(setup)
        assert not result.unjudged
        turned = np.flatnonzero(result.path.block == 5)
        for i in turned[[4, -3]]:
            truth, _ = forces(straight, np.radians(rate) * 1e3 * about, result.path.k[i], side, 20_000)
            off = np.linalg.norm(setup.to_part(result.F[i]) - truth)
            assert off < max(0.05 * np.linalg.norm(truth), 0.3)  # N, where a ball but grazes the shoulder


def test_a_stated_force_does_not_ask_how_the_teeth_move():
    stated = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").force
    assert program(10.0, 6.0, stated).unjudged == ()


def test_a_turn_on_the_spot_has_no_way():
    path = program(40.0, 4.0).path
    stands = dataclasses.replace(path, p=np.where(path.block[:, None] == 5, path.p[[-1]], path.p))
    turned = np.append(0.0, np.abs(np.diff(path.k[:, 0]))) > 1e-9
    assert np.isinf(turn_rate(stands)[turned][1:]).all()
    assert np.isfinite(turn_rate(stands)[~turned]).all()


def test_the_rate_of_a_move_is_that_of_its_start_too():
    """By hand, per millimetre: a still first sample of a cut has the rate of the move after it, a still rapid
    none, and a turn on the spot no end of it."""
    turns = np.radians([0.0, 0.0, 3.0, 0.0, 0.0, 4.0, 5.0, 0.0])
    way = np.array([0.0, 0.0, 2.0, 5.0, 0.0, 1.0, 0.0, 0.0]) * 1e-3
    cutting = np.array([False, True, True, True, False, True, True, False])
    angle, x = np.cumsum(turns), np.cumsum(way)
    k = np.column_stack([np.sin(angle), 0.0 * angle, np.cos(angle)])
    given = {"v_f": 0.01, "block": np.arange(8), "n_s": 200.0, "tool": 0}
    path = Toolpath(p=np.outer(x, [0.6, 0.8, 0.0]), k=k, cutting=cutting, **given)
    expected = np.radians([0.0, 1500.0, 1500.0, 0.0, 0.0, 4000.0, np.inf, 0.0])
    np.testing.assert_allclose(turn_rate(path), expected, atol=1e-6)
