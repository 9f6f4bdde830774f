"""A coupled run: each step is solved for its deflection, cut where it stands, and the next meets what is left."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.deflection import displacement
from robomill.cutting.conditions import CutConditions
from robomill.cutting.engaged import sinks
from robomill.cutting.force import force_on_tool
from robomill.cutting.unjudged import Unjudged
from robomill.progress import checkpoint
from robomill.simulation.coupling import Coupling, Settled, settle
from robomill.simulation.cut import Led, met_conditions, through_stock
from robomill.simulation.setup import SimulationSetup
from robomill.surface.contact.engagement import engagement
from robomill.surface.contact.march import March
from robomill.toolpath.path import Toolpath


@dataclass(frozen=True, eq=False)
class Bent:
    """What bends the tool along a path: compliance C (m, 3, 3) m/N, feed frames R_MF (m, 3, 3) and a displacement
    ``offset`` (m, 3) m that the force does not cause, all in {M}; ``told`` are the conditions by the program alone, and
    ``stronger`` is what the force is multiplied by; ``led`` says where it goes if not as it is told.
    """

    setup: SimulationSetup
    path: Toolpath
    told: CutConditions
    C: FloatArray
    R_MF: FloatArray
    offset: FloatArray
    stronger: float = 1.0
    led: Led | None = None

    def force(self, conditions: CutConditions, R_MF: FloatArray) -> FloatArray:
        """Force on the tool (k, 3) N in {M}; a stated force ends with the material."""
        force = force_on_tool(self.setup.force, conditions, R_MF)
        if self.setup.engagement and self.setup.force.ends_with_material:
            force = np.where(conditions.engaged[:, None], force, 0.0)
        return force if self.stronger == 1.0 else self.stronger * force

    def delta(self, F: FloatArray) -> FloatArray:
        """(m, 3) m: C F, eq. (15), and the offset."""
        return np.asarray(displacement(self.C, F) + self.offset)


@dataclass(frozen=True, eq=False)
class Coupled:
    """Conditions and force F (m, 3) N of a coupled run, how they were found, and where they were not."""

    conditions: CutConditions
    F: FloatArray
    coupling: Coupling
    unjudged: tuple[Unjudged, ...]


def march_coupled(bent: Bent, one_pass: FloatArray) -> Coupled:
    """March the path with every step where its own force bends it to; ``one_pass`` (m, 3) m is the answer without."""
    path, told = bent.path, bent.told
    march = through_stock(bent.setup, path, told, bent.led)
    walk = _Walk(bent, march, np.zeros((len(path), 3)), told.sinks.copy())
    rows, sectors, settled = walk.every_step()
    found = engagement(march.exponents, rows, sectors)
    told = replace(told, steep=walk.steep)
    conditions = met_conditions(told, found)
    F = bent.force(conditions, bent.R_MF)
    open_ = np.zeros(len(path), dtype=bool)
    for i, each in settled.items():
        open_[i] = each.is_open
    lines = tuple(sorted(set(path.block[open_].tolist())))
    with np.errstate(invalid="ignore"):
        difference = float(np.nanmax(np.abs(bent.delta(F) - one_pass)[told.cutting], initial=0.0))
    coupling = Coupling(tuple(settled.values()), lines, difference)
    reasons = (Unjudged("coupling", open_, coupling.why),) if lines else ()
    return Coupled(conditions, F, coupling, reasons)


@dataclass(frozen=True, eq=False)
class _Walk:
    """The steps of a march one after the other; ``moved`` (m, 3) m in {M} is where each sample went, ``steep`` (m,) how
    its end really ``sinks`` there."""

    bent: Bent
    march: March
    moved: FloatArray
    steep: FloatArray

    def every_step(self) -> tuple[FloatArray, FloatArray, dict[int, Settled]]:
        """Rows and sectors of what each step meets, and how it was settled."""
        first = self.march.meet(int(self.march.steps[0]), *self.march.points[[0, 0]]) if len(self.march.steps) else None
        m = len(self.bent.path)
        rows = np.zeros((m, 0 if first is None else len(first[0])))
        sectors = np.zeros((m, *(first[1].shape if first is not None else (0, 4))))
        settled: dict[int, Settled] = {}
        for n, i in enumerate(map(int, self.march.steps)):
            checkpoint(n / len(self.march.steps), "Force and deflection, step by step")
            settled[i], rows[i], sectors[i] = self._step(i)
        return rows, sectors, settled

    def _step(self, i: int) -> tuple[Settled, FloatArray, FloatArray]:
        """Solve step i and cut it: how it was settled, and what it meets, row and sectors."""
        bent, p, to_part = self.bent, self.bent.path.p, self.bent.setup.to_part
        told = bent.told.at(i)

        def pushed(row: FloatArray, sectors: FloatArray) -> FloatArray:
            met = met_conditions(told, engagement(self.march.exponents, row[None], sectors[None]))
            return bent.force(met, bent.R_MF[i : i + 1])[0]

        seen: dict[bytes, tuple[FloatArray, FloatArray, FloatArray]] = {}

        goes = self._way_down(i)

        def meets(delta: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
            if (key := delta.tobytes()) not in seen:
                shift = to_part(np.where(np.isnan(delta), 0.0, delta))
                fed = None if goes is None else goes.to(p[i] + shift)
                row, sectors = self.march.meet(i, p[i - 1] + shift, p[i] + shift, fed)
                seen[key] = row, sectors, pushed(row, sectors)
            return seen[key]

        def bends(delta: FloatArray) -> FloatArray:
            return np.asarray(bent.C[i] @ meets(delta)[2] + bent.offset[i])

        found = settle(bends, self.moved[i - 1], np.nan_to_num(bent.offset[i]), bent.R_MF[i, :, 2])
        met = [meets(place) for place, _ in found.mix]
        row, sectors, F = met[0]
        if len(met) > 1:
            row = sum((weight * row for (_, weight), (row, *_) in zip(found.mix, met)), start=np.zeros(len(row)))
            F = pushed(row, sectors)
        self.moved[i] = np.nan_to_num(displacement(bent.C[i], F) + bent.offset[i])
        if goes is not None:
            self.steep[i] = goes.to(p[i] + to_part(found.x))[1]
        if not bent.path.cutting[i - 1] and (
            goes is None or goes.length == 0.0
        ):  # a rapid arrives where the cut begins
            self.moved[i - 1] = self.moved[i]
        self.march.cut(i, p[i - 1] + to_part(self.moved[i - 1]), p[i] + to_part(self.moved[i]))
        return found, row, sectors

    def _way_down(self, i: int) -> WayDown | None:
        """How step ``i`` goes down, if it is told to with an end that cuts; else it goes as it is told to."""
        bent, told = self.bent, self.bent.told
        assert told.tooling is not None
        goes = bent.path.p if bent.led is None else bent.led.meant
        length = float(np.linalg.norm(goes[i] - goes[i - 1]))
        ends = told.tooling.each("flat_radius")[i] > 0.0 or told.tooling.drills[i]
        if not (bent.setup.force.follows_cut and ends and sinks(told.along[i]) > 0.0 and (length > 0.0 or bent.led)):
            return None
        way = (goes[i] - goes[i - 1]) / length if bent.led is None else bent.led.way[i]
        before = self.moved[i - 1] if bent.path.cutting[i - 1] else bent.offset[i - 1]  # after a rapid nothing pushes
        start = bent.path.p[i - 1] + bent.setup.to_part(np.nan_to_num(before))
        return WayDown(start, bent.path.k[i], way, length)


@dataclass(frozen=True, eq=False)
class WayDown:
    """The way of a tip down along its axis, as it really goes: from ``start`` (3,) m, with an axis ``k`` (3,), on a
    step of this ``length`` (m) that is told to go along a unit ``way`` (3,).

    The end of a tool cuts what it sinks by. On its way down an arm is pushed up the more the deeper it is in, so that
    it sinks by less than it is told to until its force has grown, which takes some millimetres of a ramp. A chip as
    thick as it is told at once would make the force a step, on which the tool would stand at one height for long.
    """

    start: FloatArray
    k: FloatArray
    way: FloatArray
    length: float

    def to(self, tip: FloatArray) -> tuple[FloatArray, float]:
        """To a ``tip`` (3,) m: how far it goes (3,) for each length that it is told to, and how steeply its end
        ``sinks``. Beside the axis it goes as it is told."""
        if self.length == 0.0:  # where a corrected cut begins, sent so deep that it stands on the part
            return self.way, float(sinks(self.way @ self.k))
        fall = float((self.start - tip) @ self.k) / self.length
        across = self.way - (self.way @ self.k) * self.k
        slope = np.hypot(fall, np.linalg.norm(across))
        return across - fall * self.k, float(sinks(-fall / slope)) if fall > 0.0 else 0.0
