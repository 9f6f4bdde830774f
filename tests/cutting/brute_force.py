"""The mean cutting force by brute force: points all over the cutter, each asked whether metal stands before it.

Shares nothing with the product but the values it is asked about (``Cutter``, ``EdgeTerm``). The cutter's surface is
strewn with points; one is engaged where it moves outwards (n . v > 0) and the point just outside it lies in the
stock and in none of the bodies swept by earlier moves. It then carries, averaged over the turn of N teeth,

    dF = N / (2 pi) K h^e db dphi      with h = c (v . n) and db the length along the profile (dr on the end face)

against the tooth's motion (Kt), into the tool along its normal (Kr) and along the profile towards the tip (Ka, where
the helix pulls). Lengths in m, directions in {W}. A solid is a function of points (..., 3) that says which are in it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robomill.cutting.edge import EdgeTerm
from robomill.cutting.tool import Cutter

Floats = NDArray[np.float64]
Solid = Callable[[Floats], NDArray[np.bool_]]

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
#: How far outside the cutter's surface the stock is asked for, m.
JUST_OUTSIDE = 1e-10
#: Sine of the slope from which a flat end cuts: its teeth are ground hollow, so on less only their corners touch.
DISH = math.sin(math.radians(0.5))
UPRIGHT = np.array([0.0, 0.0, 1.0])


def axis(A: float = 0.0, B: float = 0.0) -> Floats:
    """Tool axis for the tilts A, B in degrees."""
    a, b = math.radians(A), math.radians(B)
    return np.array([math.sin(b), -math.sin(a) * math.cos(b), math.cos(a) * math.cos(b)])


def box(low: Iterable[float], high: Iterable[float]) -> Solid:
    """A block between two corners, m."""
    lowest, highest = np.array([*low]), np.array([*high])
    return lambda x: np.all((x >= lowest) & (x <= highest), axis=-1)


def _nose(cutter: Cutter) -> tuple[float, float, float]:
    """Radius of the end face, and height and length of the profile of the nose."""
    R, rho = cutter.diameter / 2, cutter.corner_radius
    if cutter.kind == "chamfer":
        half, tip = cutter.tip_angle / 2, cutter.tip_diameter / 2
        return tip, (R - tip) / math.tan(half), (R - tip) / math.sin(half)
    return R - rho, rho, 0.5 * math.pi * rho


def _lowest(cutter: Cutter, r: Floats) -> Floats:
    """Height of the body's underside at radius r <= R."""
    face, height, _ = _nose(cutter)
    out = np.clip(r - face, 0.0, cutter.diameter / 2 - face)
    if cutter.kind == "chamfer":
        return out / math.tan(cutter.tip_angle / 2)
    return height - np.sqrt(np.maximum(height**2 - out**2, 0.0))


@dataclass(frozen=True)
class Move:
    """A cutter carried straight from one tip position to another, its axis k held."""

    cutter: Cutter
    start: Floats
    end: Floats
    k: Floats

    @property
    def way(self) -> Floats:
        """Unit vector."""
        way = np.subtract(self.end, self.start)
        return np.asarray(way / np.linalg.norm(way))

    def sweeps(self, x: Floats) -> NDArray[np.bool_]:
        """Which points (n, 3) the body passes through: underside minus height is convex along the way."""
        R, way = self.cutter.diameter / 2, np.subtract(self.end, self.start)
        w = x - self.start
        z, dz = w @ self.k, float(way @ self.k)
        across, d = w - np.outer(z, self.k), way - dz * self.k
        # Squared distance from the axis: a s^2 - 2 b s + c + R^2, at most R^2 from low to high.
        a, b, c = float(d @ d), across @ d, np.einsum("ij,ij->i", across, across) - R**2
        if a > 1e-24:
            root = np.sqrt(np.maximum(b * b - a * c, 0.0))
            low, high = np.clip((b - root) / a, 0.0, 1.0), np.clip((b + root) / a, 0.0, 1.0)
            near = (b * b > a * c) & (b + root >= 0.0) & (b - root <= a)
        else:
            low, high, near = np.zeros(len(x)), np.ones(len(x)), c <= 0.0
        near &= z >= min(dz, 0.0)
        b, c, z, low, high = b[near], c[near], z[near], low[near], high[near]

        def gap(s: Floats) -> Floats:
            r = np.sqrt(np.maximum(c + R**2 - 2.0 * b * s + a * s * s, 0.0))
            return _lowest(self.cutter, r) - (z - s * dz)

        for _ in range(40):
            left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
            falls = gap(right) < gap(left)
            low, high = np.where(falls, left, low), np.where(falls, high, right)
        near[near] = np.minimum(np.minimum(gap(low), gap(high)), gap(0.5 * (low + high))) <= 0.0
        return near


def _surface(cutter: Cutter, reach: float, n: int) -> Iterable[tuple[Floats, Floats, Floats, Floats, float]]:
    """(angle, kappa, radius, height) of n points of the end face, the nose and the side, and db dphi of each."""
    R, (face, nose, arc) = cutter.diameter / 2, _nose(cutter)
    i = np.arange(n) + 0.5
    phi, part = 2.0 * np.pi * ((i * GOLDEN) % 1.0), i / n
    flat, full = np.zeros(n), np.ones(n)
    if face > 0.0:
        yield phi, flat, part * face, flat, face * 2.0 * np.pi / n
    if arc > 0.0 and cutter.kind == "chamfer":
        half = cutter.tip_angle / 2
        yield phi, full * (0.5 * np.pi - half), face + part * (R - face), part * nose, arc * 2.0 * np.pi / n
    elif arc > 0.0:
        kappa, rho = part * 0.5 * np.pi, cutter.corner_radius
        radius, height = face + rho * np.sin(kappa), rho * (1.0 - np.cos(kappa))
        yield phi, kappa, radius, height, arc * 2.0 * np.pi / n
    if reach > nose:
        length = reach - nose
        yield phi, full * 0.5 * np.pi, R * full, nose + part * length, length * 2.0 * np.pi / n


@dataclass(frozen=True)
class Bite:
    """Points where the cutter cuts: chip thickness, radius, height, angle (clockwise), directions, and db dphi each."""

    h: Floats
    r: Floats
    z: Floats
    turn: Floats
    e_r: Floats
    normal: Floats
    towards_tip: Floats
    share: float


@dataclass(frozen=True)
class Cut:
    """What stands before the cutter: the stock, the moves made before, and how far up the flutes metal can reach."""

    stock: Solid
    before: tuple[Move, ...] = ()
    reach: float = 10e-3
    points: int = 40_000

    def solid(self, x: Floats) -> NDArray[np.bool_]:
        """Which points (n, 3) still are metal."""
        there = self.stock(x)
        for move in self.before:
            there[there] = ~move.sweeps(x[there])
        return there

    def engaged(self, cutter: Cutter, tip: Floats, feed: Floats, k: Floats = UPRIGHT) -> Iterable[Bite]:
        """The pieces of the cutter's surface that metal stands before, at a tip position."""
        x = np.cross([0.0, 1.0, 0.0], k) if abs(k[1]) < 0.9 else np.cross([1.0, 0.0, 0.0], k)
        x /= np.linalg.norm(x)
        y = np.cross(k, x)
        for phi, kappa, r, z, share in _surface(cutter, self.reach, self.points):
            e_r = np.outer(np.cos(phi), x) + np.outer(np.sin(phi), y)
            normal = np.sin(kappa)[:, None] * e_r - np.outer(np.cos(kappa), k)
            h = normal @ feed
            cuts = h > np.where(kappa == 0.0, DISH, 1e-9) * np.linalg.norm(feed)
            q = tip + r[:, None] * e_r + np.outer(z, k) + JUST_OUTSIDE * normal
            cuts[cuts] = self.solid(q[cuts])
            towards_tip = -np.cos(kappa)[:, None] * e_r - np.outer(np.sin(kappa), k)
            yield Bite(h[cuts], r[cuts], z[cuts], -phi[cuts], e_r[cuts], normal[cuts], towards_tip[cuts], share)

    def over_pitch(
        self, cutter: Cutter, terms: Iterable[EdgeTerm], tip: Floats, feed: Floats, k: Floats = UPRIGHT
    ) -> Floats:
        """Force ON the tool in {W}, (60, 3) N, as it turns by one pitch: the edge lags with height."""
        instants, pitch = 60, 2.0 * np.pi / cutter.flutes
        hand, pull = (1.0 if cutter.hand == "right" else -1.0), (1.0 if cutter.helix == cutter.hand else -1.0)
        lead = math.tan(cutter.helix_angle) / (0.5 * cutter.diameter) * pull
        force = np.zeros((instants, 3))
        for bite in self.engaged(cutter, tip, feed, k):
            load = np.zeros_like(bite.e_r)
            for term in terms:
                push = (
                    hand * term.Kt * np.cross(k, bite.e_r) - term.Kr * bite.normal + pull * term.Ka * bite.towards_tip
                )
                load += bite.h[:, None] ** term.exponent * push
            when = ((hand * bite.turn + bite.z * lead) % pitch / pitch * instants).astype(int) % instants
            for n in range(3):
                force[:, n] += np.bincount(when, load[:, n] * bite.share, instants) * instants / pitch
        return force

    def mean_force(
        self, cutter: Cutter, terms: Iterable[EdgeTerm], tip: Floats, feed: Floats, k: Floats = UPRIGHT
    ) -> Floats:
        """Mean force ON the tool in {W}, N, at a tip position; ``feed`` is the vector of the feed per tooth."""
        turn = -1.0 if cutter.hand == "right" else 1.0
        pull = 0.0 if cutter.helix_angle == 0.0 else 1.0 if cutter.helix == cutter.hand else -1.0
        force = np.zeros(3)
        for bite in self.engaged(cutter, tip, feed, k):
            motion = turn * np.cross(k, bite.e_r)
            for term in terms:
                load = -term.Kt * motion - term.Kr * bite.normal + pull * term.Ka * bite.towards_tip
                force += cutter.flutes / (2.0 * np.pi) * bite.share * (bite.h**term.exponent @ load)
        return force


def in_tool_axes(force: Floats, feed: Floats, k: Floats) -> Floats:
    """A force in {W} as (feed, left of the feed, axial): across the tool axis, and along it."""
    across = np.subtract(feed, np.dot(feed, k) * k)
    across /= np.linalg.norm(across)
    return np.array([force @ across, force @ np.cross(k, across), force @ k])
