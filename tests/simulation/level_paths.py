"""Level paths of lines and arcs under a flat mill, and the force at every sample by an integration of its own. mm, N.

The rim of the mill is strewn with points; one cuts where it moves outwards, in the block, farther than the radius from
all that the tool's axis has passed so far (segments and arcs by their own distance, no chords).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

import robomill as rm
from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.io.materials import load_material
from robomill.surface.stock import Stock
from robomill.toolpath.source import GCodeSource
from tests.simulation.cuts import AL7075, FEED, FLAT, MM, Floats

DEEP, HALF, RADIUS = 2.0, 20.0, 4.0
POINTS = 3600
JUST = 3e-4  # a sample is looked at so far before its end (after its start), what stands there so far outside the rim
OUTSIDE = 2e-5


class Piece(Protocol):
    """A line or an arc."""

    def code(self) -> str: ...
    def way(self, p: Floats) -> Floats: ...
    def up_to(self, p: Floats) -> Piece | None: ...
    def distance(self, q: Floats) -> Floats: ...


@dataclass(frozen=True)
class Line:
    """From a to b."""

    a: tuple[float, float]
    b: tuple[float, float]

    def code(self) -> str:
        return f"G1 X{self.b[0]:.6f} Y{self.b[1]:.6f}"

    def way(self, p: Floats) -> Floats:
        span = np.subtract(self.b, self.a)
        return np.asarray(span / np.linalg.norm(span))

    def up_to(self, p: Floats) -> Line | None:
        s = float((p - self.a) @ self.way(p))
        return Line(self.a, tuple(self.a + s * self.way(p))) if s > 1e-9 else None

    def distance(self, q: Floats) -> Floats:
        span = np.subtract(self.b, self.a)
        s = np.clip((q - self.a) @ span / (span @ span), 0.0, 1.0)
        return np.asarray(np.linalg.norm(q - self.a - np.outer(s, span), axis=1))


@dataclass(frozen=True)
class Arc:
    """From a to b about c, counter-clockwise or (sense -1) clockwise."""

    a: tuple[float, float]
    b: tuple[float, float]
    c: tuple[float, float]
    sense: int = 1

    def code(self) -> str:
        i, j = np.subtract(self.c, self.a)
        return f"G{3 if self.sense > 0 else 2} X{self.b[0]:.6f} Y{self.b[1]:.6f} I{i:.6f} J{j:.6f}"

    def _turned(self, q: Floats) -> Floats:
        x, y = np.moveaxis(np.subtract(q, self.c), -1, 0)
        start = math.atan2(self.a[1] - self.c[1], self.a[0] - self.c[0])
        return np.asarray((self.sense * (np.arctan2(y, x) - start)) % (2.0 * np.pi))

    def way(self, p: Floats) -> Floats:
        x, y = np.subtract(p, self.c) / np.linalg.norm(np.subtract(p, self.c))
        return self.sense * np.array([-y, x])

    def up_to(self, p: Floats) -> Arc | None:
        return (
            replace(self, b=(float(p[0]), float(p[1]))) if 1e-6 < float(self._turned(p)) < 2.0 * np.pi - 1e-6 else None
        )

    def distance(self, q: Floats) -> Floats:
        radius = np.linalg.norm(np.subtract(self.a, self.c))
        on = np.abs(np.linalg.norm(q - self.c, axis=1) - radius)
        ends = np.minimum(np.linalg.norm(q - self.a, axis=1), np.linalg.norm(q - self.b, axis=1))
        return np.where(self._turned(q) <= (self._turned(np.array(self.b)) or 2.0 * np.pi), on, ends)


def force(tip: Floats, way: Floats, before: list[Piece]) -> Floats:
    """(3,) N on the tool in {W} with its axis at ``tip``, fed along a unit ``way``."""
    phi = (np.arange(POINTS) + 0.5) * np.pi / POINTS
    e = np.outer(np.sin(phi), way) + np.outer(np.cos(phi), [-way[1], way[0]])
    q = tip + (RADIUS + OUTSIDE) * e
    cuts = (np.abs(q) <= HALF).all(axis=1)
    for piece in before:
        cuts[cuts] = piece.distance(q[cuts]) >= RADIUS
    e, total = e[cuts], np.zeros(3)
    for term in AL7075:
        load = (FEED * np.sin(phi[cuts])) ** term.exponent
        total[:2] += load @ (-term.Kt * np.column_stack([e[:, 1], -e[:, 0]]) - term.Kr * e)
        total[2] -= term.Ka * load.sum()
    return np.asarray(total * FLAT.flutes / (2.0 * np.pi) * np.pi / POINTS * DEEP * MM)


@dataclass(frozen=True)
class LevelCut:
    """Passes one after the other, each begun from above; the last one is asked about, at every sample."""

    name: str
    passes: tuple[tuple[Piece, ...], ...]

    def setup(self, step: float) -> rm.SimulationSetup:
        """The run of it."""
        lines = ["G21 G90 G17", "M3 S12000"]
        for pieces in self.passes:
            x, y = pieces[0].a  # type: ignore[attr-defined]
            lines += ["G0 Z20", f"G0 X{x:.6f} Y{y:.6f}", f"G0 Z{-DEEP}"]
            lines += [f"{piece.code()} F{FEED / MM * FLAT.flutes * 12000}" for piece in pieces]
        T_MW = np.eye(4)
        T_MW[1, 3] = -1.3
        return rm.SimulationSetup(
            name=self.name,
            robot=rm.load_robot("slavkovic_5r"),
            source=GCodeSource("\n".join([*lines, "G0 Z20", "M2", ""])),
            T_MW=T_MW,
            cutter=FLAT,
            force=MechanisticForce(FLAT, load_material("al7075_t6_carbide_ref190")),
            stock=Stock((-HALF * MM, -HALF * MM, -12 * MM), (HALF * MM, HALF * MM, 0.0)),
            step=step * MM,
            cell=0.1 * MM,
            engagement=True,
        )

    def off(self, step: float, most: int = 400) -> float:
        """The largest error of a sample of the last pass, as a share of the largest force there; of ``most`` of them,
        those that begin a cut or end a piece always among them."""
        result = rm.simulate(self.setup(step))
        path, line, owner, pieces = result.path, 3, {}, []
        for each in self.passes:
            line += 3
            for piece in each:
                owner[line], line = len(pieces), line + 1
                pieces.append(piece)
        first = len(pieces) - len(self.passes[-1])
        asked = np.flatnonzero(path.cutting & np.isin(path.block, [n for n, k in owner.items() if k >= first]))
        ends = np.append(path.block[1:] != path.block[:-1], True) | (path.step_length == 0.0)
        asked = asked[(np.arange(len(asked)) % (len(asked) // most + 1) == 0) | ends[asked]]
        error, size = [], 1.0
        for i in asked:
            k, p, starts = owner[int(path.block[i])], path.p[i, :2] / MM, path.step_length[i] == 0.0
            way = pieces[k].way(p)
            tip = p + way * (JUST if starts else -JUST)
            own = None if starts else pieces[k].up_to(tip)
            truth = force(tip, way, pieces[:k] + ([own] if own else []))
            size = max(size, float(np.linalg.norm(truth)))
            error.append(float(np.linalg.norm(result.F[i] - truth)))
        return max(error) / size
