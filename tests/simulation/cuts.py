"""Cuts whose force is known by brute force, and what a whole run says of them. Points in mm, tilts in degrees.

A cut is a few passes through a block, each run down beside it or from above; what is asked is the force along
``span`` (mm) of the last pass's last move, at every step; where it is not ``steady``, at a dozen steps, each its own.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

import robomill as rm
from robomill.cutting.edge import EdgeTerm
from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.cutting.tool import Cutter
from robomill.io.materials import load_material
from robomill.surface.stock import Stock
from robomill.toolpath.source import GCodeSource
from tests.cutting.brute_force import Cut, Floats, Move, Solid, axis, box

MM = 1e-3
FEED = 0.05 * MM
AL7075 = (EdgeTerm(1.0, 767.01e6, 168.8e6, 222e6), EdgeTerm(0.0, 27.7e3, 26.6e3, 0.7e3))
EVERY_STEP = (1.0, 0.5, 0.2, 0.1)
Point = tuple[float, float, float]

FLAT = Cutter("flat", 8 * MM, flutes=3)
BALL = Cutter("ball", 8 * MM, flutes=3)
BULL = Cutter("bull", 8 * MM, corner_radius=1.5 * MM, flutes=3)
ROUND = Cutter("bull", 8 * MM, corner_radius=3 * MM, flutes=3)
CHAMFER = Cutter("chamfer", 8 * MM, tip_angle=math.radians(90.0), flutes=3)
LEFT = FLAT.replace(hand="left", helix="left")


def skin_of(solid: Solid, corners: Floats) -> Floats:
    """Triangles (t, 3, 3) mm around a solid made of boxes with these corners (n, 3) mm, its voids' walls with it."""
    edges = [np.unique(corners[:, n]) for n in range(3)]
    middles = np.stack(np.meshgrid(*(0.5 * (e[1:] + e[:-1]) for e in edges), indexing="ij"), axis=-1)
    full = np.pad(solid(middles.reshape(-1, 3) * MM).reshape(middles.shape[:3]), 1)
    triangles = []
    for n in range(3):
        cuts = [edges[(n + i) % 3] for i in range(3)]
        turned = full.transpose([(n + i) % 3 for i in range(3)])
        for i, j, k in np.argwhere(turned[1:] != turned[:-1]):
            u, v = cuts[1][j - 1 : j + 1], cuts[2][k - 1 : k + 1]
            ring = np.array([[cuts[0][i], u[a], v[b]] for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))])
            ring = np.roll(ring, n, axis=1)[:: 1 if turned[i, j, k] else -1]
            triangles += [ring[[0, 1, 2]], ring[[0, 2, 3]]]
    return np.array(triangles)


@dataclass(frozen=True)
class Pass:
    """Tip positions at feed, with one tilt of the tool."""

    points: tuple[Point, ...]
    tilt: tuple[float, float] = (0.0, 0.0)


def along_x(y: float, z: float, end: float = 12.0, tilt: tuple[float, float] = (0.0, 0.0)) -> Pass:
    """From beside the block into it."""
    return Pass(((-30.0, y, z), (end, y, z)), tilt)


@dataclass(frozen=True)
class CutCase:
    """See the module."""

    name: str
    cutter: Cutter
    passes: tuple[Pass, ...]
    span: tuple[float, float] = (30.0, 36.0)
    low: Point = (-20.0, -20.0, -12.0)
    high: Point = (20.0, 20.0, 0.0)
    steady: bool = True
    steps: tuple[float, ...] = (1.0, 0.2)
    holes: tuple[tuple[Point, Point], ...] = ()

    def block(self) -> Solid:
        """Which points are stock."""
        whole, *holes = (box(np.array(a) * MM, np.array(b) * MM) for a, b in ((self.low, self.high), *self.holes))
        return lambda x: whole(x) & ~np.any([hole(x) for hole in holes] or [np.zeros(len(x), dtype=bool)], axis=0)

    def stock(self) -> Stock:
        """The same as the run is told it: corners, and a mesh where it has holes."""
        mesh = skin_of(self.block(), np.array([self.low, self.high, *(p for hole in self.holes for p in hole)])) * MM
        corners = np.array([self.low, self.high]) * MM
        return Stock(*corners, mesh if self.holes else None)

    def program(self) -> str:
        """The passes as G-code, 0.05 mm a tooth."""
        sense = "M3" if self.cutter.hand == "right" else "M4"
        feed = FEED / MM * self.cutter.flutes * 12000
        lines = ["G21 G90", f"{sense} S12000"]
        for each in self.passes:
            A, B = each.tilt
            x, y, z = each.points[0]
            lines += ["G0 Z40", f"G0 X{x:.6f} Y{y:.6f} A{A} B{B}", f"G0 Z{z:.6f}"]
            lines += [f"G1 X{p[0]:.6f} Y{p[1]:.6f} Z{p[2]:.6f} F{feed}" for p in each.points[1:]]
        return "\n".join([*lines, "G0 Z40", "M2", ""])

    def before(self, points: int) -> tuple[Cut, Move]:
        """The cut that the last move makes, and that move."""
        moves = [
            Move(self.cutter, np.array(a) * MM, np.array(b) * MM, axis(*each.tilt))
            for each in self.passes
            for a, b in itertools.pairwise(each.points)
        ]
        deepest = min(z for each in self.passes for _, _, z in each.points)
        reach = (1.2 * (self.high[2] - deepest) + 2.0) * MM
        return Cut(self.block(), tuple(moves[:-1]), reach, points), moves[-1]

    def truth(self, s: Floats) -> Floats:
        """(n, 3) N in {W} by brute force, the tip s (n,) mm along the last move."""
        cut, last = self.before(20_000 if len(s) == 1 else 6_000)
        tips = last.start + np.outer(s, last.way) * MM
        return np.array([cut.mean_force(self.cutter, AL7075, tip, FEED * last.way, last.k) for tip in tips])

    def setup(self, step: float, cell: float = 0.1) -> rm.SimulationSetup:
        """The run of it, step and cell in mm."""
        return rm.SimulationSetup(
            name=self.name,
            robot=rm.load_robot("slavkovic_5r"),
            source=GCodeSource(self.program()),
            T_MW=np.array([[1, 0, 0, 0], [0, 1, 0, -1.3], [0, 0, 1, 0], [0, 0, 0, 1]], dtype=float),
            cutter=self.cutter,
            force=MechanisticForce(self.cutter, load_material("al7075_t6_carbide_ref190")),
            stock=self.stock(),
            step=step * MM,
            cell=cell * MM,
            engagement=True,
        )

    def run(self, step: float, cell: float = 0.1) -> tuple[Floats, Floats]:
        """How far along the last move (n,) mm the tip is, and (n, 3) N in {W}, as a run finds it."""
        result = rm.simulate(self.setup(step, cell))
        path = result.path
        last = path.cutting & (path.block == path.block[path.cutting].max())
        start = np.flatnonzero(last)[0] - 1
        s = np.linalg.norm(path.p - path.p[start], axis=1) / MM
        a, b = self.span
        inside = last & (path.step_length > 0) & (s > a + 1e-6) & (s < b + 1e-6)
        assert result.ik.reached[inside].all()
        return s[inside], result.F[inside]

    def off(self, step: float, cell: float = 0.1, most: int = 12) -> float:
        """The largest error over the span, as a share of the largest force there (of 1 N at least)."""
        s, found = self.run(step, cell)
        some = np.linspace(0, len(s) - 1, min(len(s), most)).astype(int)
        if self.steady:
            truth = self.truth(np.array([np.mean(self.span)]))
        else:
            truth, found = self.truth(s[some]), found[some]
        size = max(np.linalg.norm(truth, axis=1).max(), 1.0)
        return float(np.linalg.norm(found - truth, axis=1).max() / size)


def shoulder(a_e: float, climb: bool = True, cutter: Cutter = FLAT, depth: float = 2.0, reach: float = 4.0) -> CutCase:
    """A pass along the block's side: the part on the right of a right-hand cutter is climb."""
    right = climb == (cutter.hand == "right")
    sense = "climb" if climb else "conventional"
    low, high = ((-20, -20, -12), (20, a_e - reach, 0)) if right else ((-20, reach - a_e, -12), (20, 20, 0))
    return CutCase(
        f"{cutter.hand} {cutter.kind}, {sense}, a_e {a_e}", cutter, (along_x(0, -depth),), low=low, high=high
    )


def slot(cutter: Cutter, A: float, B: float) -> CutCase:
    """A slot 2 mm deep with a tilted tool; the flat one at every step, the others' lean costs time."""
    steps = EVERY_STEP if cutter is FLAT else (1.0,)
    return CutCase(f"{cutter.kind} slot, A {A} B {B}", cutter, (along_x(0, -2, tilt=(A, B)),), steps=steps)


def drill(z: float, x: float = 0.0, y: float = 0.0) -> Pass:
    """Straight down from above."""
    return Pass(((x, y, 3.0), (x, y, z)))


def _helix(radius: float, pitch: float, turns: float, chord: float = 9.0) -> tuple[Point, ...]:
    t = np.arange(0.0, 360.0 * turns + 0.5 * chord, chord)
    rad = np.deg2rad(t)
    return tuple(zip(radius * np.cos(rad), radius * np.sin(rad), 0.5 - pitch * t / 360.0, strict=True))


RAMP = math.tan(math.radians(3.0))


def down(degrees: float, z: float = -4.0) -> Pass:
    """Down along x through the whole block and out of it, from depth z on."""
    return Pass(((-30, 0, z), (40, 0, z - 70 * math.tan(math.radians(degrees)))))


def way_out(name: str, cutter: Cutter, ramp: Pass, *before: Pass, span: tuple[float, float] = (44.0, 54.0)) -> CutCase:
    """A ramp's last millimetres in the material, where its flank has left it and the rear of its end has not."""
    return CutCase(name, cutter, (*before, ramp), span=span, steady=False, steps=(1.0,))


def ramp_in(cutter: Cutter, degrees: float, z: float) -> CutCase:
    """Down from the top, or from the floor z of a slot, once the end is in for a tool's width: its nose lifts it by
    more than half of what it is told to sink."""
    down_to = z - 36 * math.tan(math.radians(degrees))
    before = (along_x(0, z, 30),) if z < 0 else ()
    return CutCase(
        f"nose of {cutter.corner_radius / MM} mm ramps in by {degrees} degrees from {z} mm",
        cutter,
        (*before, Pass(((-18, 0, z), (18, 0, down_to)))),
        span=(9.5, 34.0),
        steady=False,
        steps=(1.0,),
    )


BESIDE_A_STEM: tuple[tuple[Point, Point], ...] = (((-20, -20, -12), (20, -2, -2)), ((-20, 2, -12), (20, 20, -2)))
CAVITY = (((-15.0, -12.0, -6.0), (15.0, 12.0, -1.0)),)
TUNNEL = (((-3.0, -20.0, -2.0), (3.0, 20.0, -1.0)),)
GROOVE = Pass(((2.0, -30.0, -1.0), (2.0, 30.0, -1.0)))

CASES = (
    *(shoulder(a_e, climb) for a_e in (0.05, 0.1, 0.2, 0.5, 5.0) for climb in (True, False)),
    *(shoulder(a_e, climb, LEFT) for a_e in (0.2, 3.0) for climb in (True, False)),
    shoulder(0.5, cutter=BALL, depth=6.0),
    shoulder(1.0, cutter=BULL, depth=4.0),
    shoulder(1.5, cutter=CHAMFER, depth=3.0, reach=3.0),
    CutCase("slot", FLAT, (along_x(0, -2),)),
    CutCase("slot, left-hand helix", FLAT.replace(helix="left"), (along_x(0, -2),)),
    CutCase("slot, left-hand cutter", LEFT, (along_x(0, -2),)),
    CutCase("right half open to half depth", FLAT, (along_x(-4.5, -1, 20), along_x(-3.5, -1, 20), along_x(0, -2))),
    CutCase("ball beside its own pass", BALL, (along_x(0.5, -1, 30), along_x(0, -1))),
    CutCase("ball, third pass of three", BALL, (along_x(1, -1, 30), along_x(0.5, -1, 30), along_x(0, -1))),
    replace(slot(BALL, 10, 0), name="tilted ball, every step", steps=EVERY_STEP[1:]),
    *(slot(BALL, A, B) for A, B in ((10, 0), (-10, 0), (0, 10), (0, -10), (0, 20), (7, 7))),
    *(slot(FLAT, A, B) for A, B in ((10, 0), (-10, 0), (0, 10), (0, 3), (0, 20), (8, 5))),
    *(slot(CHAMFER, A, B) for A, B in ((0, 0), (5, 0), (0, 5))),
    *(slot(BULL, A, B) for A, B in ((0, 0), (10, 0), (0, 6))),
    slot(FLAT, 0, -5),
    CutCase("own slot again", FLAT, (along_x(0, -2, 30), along_x(0, -2))),
    CutCase("own slot again, 0.3 mm to the left", FLAT, (along_x(0, -2, 30), along_x(0.3, -2))),
    CutCase("second depth of a slot", FLAT, (along_x(0, -1, 30), along_x(0, -2))),
    CutCase("second depth of a slot, ball", BALL, (along_x(0, -1, 30), along_x(0, -2))),
    CutCase("corner", FLAT, (Pass(((-30, -6, -2), (0, -6, -2), (0, 10, -2))),), span=(0.0, 4.0), steady=False),
    CutCase("after the corner", FLAT, (Pass(((-30, -6, -2), (0, -6, -2), (0, 10, -2))),), span=(9.0, 14.0)),
    CutCase("step-over 5 mm", FLAT, (along_x(0, -2, 16), along_x(5, -2))),
    CutCase("step-over 5 mm, the other side", FLAT, (along_x(0, -2, 16), along_x(-5, -2))),
    CutCase("entry", FLAT, (along_x(0, -2),), span=(4.0, 16.0), steady=False),
    CutCase("exit", FLAT, (along_x(0, -2, 30),), span=(44.0, 56.0), steady=False),
    CutCase("ramp down", FLAT, (Pass(((-14, 0, 0), (6, 0, -20 * RAMP))),), span=(4.0, 18.0), steady=False),
    CutCase("ramp up", FLAT, (Pass(((-30, 0, -3), (10, 0, -3 + 40 * RAMP))),), span=(20.0, 26.0), steady=False),
    CutCase("ramp down, ball", BALL, (Pass(((-14, 0, 0), (6, 0, -20 * RAMP))),), span=(4.0, 18.0), steady=False),
    CutCase("ramp up, ball", BALL, (Pass(((-30, 0, -3), (10, 0, -3 + 40 * RAMP))),), span=(20.0, 26.0), steady=False),
    *(ramp_in(cutter, degrees, z) for cutter, degrees, z in ((BULL, 0.51, 0), (ROUND, 0.55, 0), (BULL, 0.6, -1))),
    way_out("way out of a ramp of 0.6 degrees", FLAT, down(0.6)),
    way_out("way out of a ramp of 1 degree", FLAT, down(1)),
    way_out("way out of a ramp of 1 degree, bull", BULL, down(1)),
    way_out("way out of a ramp of 3 degrees", FLAT, down(3)),
    way_out(
        "ramp of 1 degree into an older, deeper groove",
        FLAT,
        down(1),
        Pass(((6, -30, -8), (6, 30, -8))),
        span=(26.0, 36.0),
    ),
    CutCase("plunge", FLAT, (drill(-5),), span=(4.0, 7.0)),
    CutCase("plunge, half over the edge", FLAT, (drill(-5, 20),), span=(4.0, 7.0)),
    CutCase("plunge, half over the left edge", FLAT, (drill(-5, 0, 20),), span=(4.0, 7.0)),
    CutCase("plunge of a ball, half over a corner's edge", BALL, (drill(-6, 12, -20),), span=(7.5, 8.5)),
    CutCase("plunge beside a hole", FLAT, (drill(-5), drill(-5, 0, 5)), span=(4.0, 7.0)),
    CutCase("plunge beside a hole, from aside", FLAT, (drill(-5), drill(-5, 12, 5), drill(-5, 0, 5)), span=(4.0, 7.0)),
    CutCase(
        "leaning plunge along its own axis",
        FLAT,
        (Pass(tuple((0.0, 3.0 - s * axis(20, 0)[1], 4.0 - s * axis(20, 0)[2]) for s in (0.0, 8.0)), (20, 0)),),
        span=(5.0, 8.0),
        steady=False,
    ),
    CutCase(
        "plunge into its own hole",
        FLAT,
        (Pass(((0, 0, 3), (0, 0, -3))), Pass(((0, 0, 3), (0, 0, -5)))),
        span=(0.0, 5.0),
    ),
    CutCase("plunge of a ball", BALL, (drill(-8),), span=(8.0, 10.0)),
    CutCase("short plunge of a ball, to its bottom", BALL, (drill(-1),), span=(3.5, 4.1), steady=False),
    CutCase("helical entry", FLAT, (Pass(_helix(3.0, 1.0, 1.6)),), span=(0.0, 0.472), steady=False),
    CutCase(
        "across an older groove",
        FLAT,
        (Pass(((2, -30, -1), (2, 30, -1))), along_x(0, -2, 16)),
        span=(20.0, 44.0),
        steady=False,
    ),
    CutCase("along the rim of an older groove", FLAT, (along_x(-6, -2, 30), along_x(0, -2))),
    CutCase("ball tilted on a wall", BALL, (along_x(-6.5, -3, 30), along_x(0, -3, tilt=(8, 0)))),
    CutCase(
        "T profile", FLAT, (along_x(0, -6),), holes=(((-20, -20, -12), (20, -2, -2)), ((-20, 2, -12), (20, 20, -2)))
    ),
    CutCase("over a cavity", FLAT, (along_x(0, -2),), holes=CAVITY),
    CutCase("ball over a cavity", BALL, (along_x(0, -3),), holes=(((-15, -12, -6), (15, 1, -1)),)),
    CutCase("tilted over a cavity", FLAT, (along_x(0, -2, tilt=(8, 6)),), holes=CAVITY),
    CutCase("chamfer of 1 mm along an edge", CHAMFER, (along_x(-22, -3),)),
    CutCase("skin of 0.05 mm, ball", BALL, (along_x(0, -0.05),)),
    CutCase(
        "ball down 30 degrees beside its own pass",
        BALL,
        (Pass(((-10, 1.5, 1), (7, 1.5, -9))), Pass(((-10, 0, 1), (7, 0, -9)))),
        span=(6.0, 18.0),
        steady=False,
    ),
    CutCase("across a tunnel", FLAT, (along_x(0, -3),), holes=TUNNEL, span=(20, 40), steady=False),
)
