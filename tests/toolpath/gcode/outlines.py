"""Outlines of lines and arcs for a cutter to go beside, their programs, and how far its path is from them."""

from __future__ import annotations

import math

import numpy as np

from robomill.toolpath.gcode import interpret
from robomill.toolpath.gcode.chords import to_toolpath

R = 1.0  # mm


class Outline:
    """Lines and arcs one after the other, mm: ``pieces`` holds (kind, start, end, centre or None, turns left)."""

    def __init__(self, start, heading):
        self.at, self.heading, self.pieces = complex(*start), heading, []

    def line(self, length):
        end = self.at + length * np.exp(1j * self.heading)
        self.pieces.append(("line", self.at, end, None, 0))
        self.at = end

    def arc(self, radius, sweep):
        side = 1 if sweep > 0 else -1
        centre = self.at + radius * side * 1j * np.exp(1j * self.heading)
        end = centre + (self.at - centre) * np.exp(1j * sweep)
        self.pieces.append(("arc", self.at, end, centre, side))
        self.at, self.heading = end, self.heading + sweep

    def program(self, code):
        entry = self.pieces[0][1] - 5.0 * np.exp(1j * self.entry)
        lines = ["G21 G90 G17 F600", f"G0 {xy(entry)} Z0", f"{code} D{2 * R}", f"G1 {xy(self.pieces[0][1])}"]
        for kind, start, end, centre, side in self.pieces:
            if kind == "line":
                lines.append(f"G1 {xy(end)}")
            else:
                to = centre - start
                lines.append(f"G{3 if side > 0 else 2} {xy(end)} I{to.real:.12f} J{to.imag:.12f}")
        beyond = self.at + 6.0 * np.exp(1j * self.heading)
        return "\n".join([*lines, "G40", f"G1 {xy(beyond)}", "M2\n"])

    @property
    def entry(self):
        _, start, end, centre, side = self.pieces[0]
        return np.angle(end - start) if centre is None else np.angle((start - centre) * 1j * side)


def xy(point):
    return f"X{point.real:.12f} Y{point.imag:.12f}"


def distance(points, piece):
    """Of points (m,) complex to one piece, and on which side of it they are (+1 left, 0 beyond its ends)."""
    kind, start, end, centre, side = piece
    if kind == "line":
        along = (end - start) / abs(end - start)
        local = (points - start) * np.conj(along)
        inside = (local.real > 0) & (local.real < abs(end - start))
        nearest = np.where(inside, abs(local.imag), np.minimum(abs(points - start), abs(points - end)))
        return nearest, np.where(inside, np.sign(local.imag), 0)
    turned = np.angle((points - centre) / (start - centre)) * side % (2 * np.pi)
    inside = turned < np.angle((end - centre) / (start - centre)) * side % (2 * np.pi)
    radial = abs(points - centre) - abs(start - centre)
    nearest = np.where(inside, abs(radial), np.minimum(abs(points - start), abs(points - end)))
    return nearest, np.where(inside, -side * np.sign(radial), 0)


def moves_of(program):
    """(points (m,) mm complex, source line (m,)) of the moves, arcs as fine chords; each move's end only for lines."""
    path = to_toolpath(interpret(program), chord_error=2e-8)
    return (path.p[:, 0] + 1j * path.p[:, 1]) * 1e3, path.block


def check(outline, code):
    points, line = moves_of(outline.program(code))
    right_side = 1 if code.startswith("G41") else -1
    first = 5  # the line of the outline's first piece
    last = first + len(outline.pieces) - 1
    assert {*range(first, last + 1)} <= {*line.tolist()}
    for k, _ in enumerate(outline.pieces):
        where = np.flatnonzero(line == first + k)
        # Between the points of a straight move too.
        p = np.concatenate([points[where], 0.5 * (points[where] + points[where - 1])])
        near = outline.pieces[max(k - 1, 0) : k + 2]
        away, side = map(np.array, zip(*(distance(p, piece) for piece in near), strict=True))
        np.testing.assert_allclose(away.min(axis=0), R, atol=5e-5)
        assert ((away < R + 5e-5) & ((side == 0) | (side == right_side))).any(axis=0).all()


def room(outline):
    """Least distance between two places of an outline that are further apart along it than a corner needs."""
    points = []
    for _, start, end, centre, side in outline.pieces:
        t = np.linspace(0.0, 1.0, 60)[1:]
        sweep = 0.0 if centre is None else np.angle((end - centre) / (start - centre)) * side % (2 * np.pi) * side
        points.append(
            start + t * (end - start) if centre is None else centre + (start - centre) * np.exp(1j * sweep * t)
        )
    points = np.concatenate(points)
    along = np.concatenate([[0.0], np.cumsum(abs(np.diff(points)))])
    far = abs(along[:, None] - along) > 7.0 * R
    return abs(points[:, None] - points)[far].min()


def random_outline(seed, sharp):
    rng = np.random.default_rng(seed)
    while True:
        outline = Outline(rng.uniform(-5, 5, 2), rng.uniform(-math.pi, math.pi))
        for _ in range(7):
            if rng.random() < 0.5:
                outline.line(rng.uniform(8.0, 12.0))
            else:
                outline.arc(rng.uniform(5.0, 8.0), rng.uniform(1.0, 2.0) * rng.choice([-1, 1]))
            # Corners of less than a twentieth of a radian go straight on, and miss the path by as little.
            outline.heading += rng.uniform(0.1, sharp) * rng.choice([-1, 1]) if rng.random() < 0.8 else 0.0
        if room(outline) > 2.1 * R:  # the cutter fits between
            return outline
