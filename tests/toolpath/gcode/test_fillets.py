"""Arcs in corners beside arcs, against walking along the first cut and measuring."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robomill.toolpath.gcode.fillets import Cut, tangents_turn, touching


def drawn(rng: np.random.Generator, way: int, arc: bool) -> tuple[Cut, complex, complex]:
    """A cut that ends (-1) or begins (+1) in the origin, its direction there, and its centre (complex; 0 of a line)."""
    along = np.exp(1j * rng.uniform(-np.pi, np.pi))
    if not arc:
        return Cut(way, (along.real, along.imag), rng.uniform(0.5, 3.0)), along, 0j
    turn, radius = int(rng.choice([-1, 1])), rng.uniform(0.3, 2.0)
    centre = 1j * turn * radius * along
    cut = Cut(way, (along.real, along.imag), rng.uniform(0.3, 5.0), (centre.real, centre.imag), radius, turn)
    return cut, along, centre


def walked(cut: Cut, along: complex, centre: complex, points: int) -> tuple[np.ndarray, np.ndarray]:
    """Places on a cut from the corner to its other end, and the directions of travel there."""
    share = np.linspace(0.0, 1.0, points)
    if cut.turn == 0:
        return cut.way * share * cut.length * along, np.full(points, along)
    turned = np.exp(1j * cut.turn * cut.way * share * cut.length)
    return centre * (1.0 - turned), along * turned


@pytest.mark.parametrize("arcs", [(True, False), (False, True), (True, True)])
@pytest.mark.parametrize("seed", range(40))
def test_an_arc_fits_where_a_place_on_the_first_cut_is_as_far_from_the_other(
    arcs: tuple[bool, bool], seed: int
) -> None:
    """From every place of the first cut, its radius aside: where that is its radius from the other cut, too, the arc
    fits; and the one that is found touches both within their ends, without a kink."""
    rng = np.random.default_rng(seed)
    (first, a, _), (then, b, other) = drawn(rng, -1, arcs[0]), drawn(rng, 1, arcs[1])
    radius, side = rng.uniform(0.05, 1.5), math.copysign(1.0, (a.conjugate() * b).imag)
    assert tangents_turn(first, then) == pytest.approx(np.angle(b / a))
    places, ways = walked(first, a, first.centre[0] + 1j * first.centre[1], 4001)
    centres = places + 1j * side * radius * ways
    if then.turn == 0:
        miss = (centres / b).imag - side * radius
        touched = (centres / b).real
        within = (touched > 0.0) & (touched < then.length)
    else:
        reach = then.radius - then.turn * side * radius
        miss = abs(centres - other) - reach if reach > 0.0 else np.ones(len(centres))
        turned = np.angle((centres - other) / -other) * then.turn % (2.0 * np.pi)
        within = (turned < then.length) & (abs(centres - other) > 0.0)
    crossed = (miss[1:] * miss[:-1] < 0.0) & within[1:] & within[:-1]
    found = touching((0.0, 0.0), first, then, radius)
    if found is None:
        assert not crossed.any()
        return
    leaves, joins, centre = (complex(*each) for each in found)
    assert abs(leaves - centre) == pytest.approx(radius)
    assert abs(joins - centre) == pytest.approx(radius)
    for place, cut, along, middle in ((leaves, first, a, complex(*first.centre)), (joins, then, b, other)):
        near, way = walked(cut, along, middle, 4001)
        k = np.argmin(abs(near - place))
        assert abs(near[k] - place) <= cut.length * max(cut.radius, 1.0) / 4000
        assert ((centre - place) / (1j * side * way[k])).real == pytest.approx(radius, rel=2e-3)
    at = places[:-1][crossed]
    assert not crossed.any() or abs(at + 1j * side * radius * ways[:-1][crossed]).min() > abs(centre) - 0.01
