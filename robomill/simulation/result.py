"""What one run says: deflection and its shares, force, both surfaces, groove sections, the verdict."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asked, made_by
from robomill.arrays import FloatArray, digest
from robomill.compliance.deflection import displacement
from robomill.errors import RobomillError, SurfaceError
from robomill.frames import Columns
from robomill.lazy import cached_property
from robomill.provenance import Finding
from robomill.simulation.columns import path_columns
from robomill.simulation.cut import cut_notes, suspicions
from robomill.simulation.edges import edge_notes
from robomill.simulation.judging.finished import Finished, finished
from robomill.simulation.judging.gauge import Gauge, gauge
from robomill.simulation.judging.seen import Run
from robomill.simulation.judging.strays import Stray, stray
from robomill.simulation.judging.verdict import decided, judge, resting_on, thin_wall_notes
from robomill.simulation.judging.verdict_words import Deciding, Verdict
from robomill.simulation.mapped import map_notes
from robomill.simulation.meant import corrected_notes, jump_notes, untold_notes
from robomill.simulation.origin.assumptions import Assumed, assumed_of_setup
from robomill.simulation.origin.doubts import frame_notes, known_notes, rigid_tool_notes, unit_doubts
from robomill.simulation.posture import posture_notes
from robomill.simulation.steadiness import steadiness
from robomill.simulation.tools import feed_notes, tool_notes
from robomill.simulation.uncoupled import coupling_notes, left_open, met_where_pushed, moves_a_reading
from robomill.surface.deviation import Deviation, deviation
from robomill.surface.sections.groove import GrooveSection, GrooveSections, groove_sections
from robomill.surface.swept import CutPath
from robomill.surface.zmap import ZMap, cut
from robomill.units import format_si


@made_by("rm.simulate(setup)")
@dataclass(frozen=True, eq=False, repr=False)
class SimulationResult(Run):
    """Arrays over the m samples of the path, SI, in {M} unless said otherwise; NaN where not reached.

    path           the sampled Toolpath, in {W}
    theta          (m, n) rad          C_joint      (m, n, 3, 3) m/N, joint shares of the compliance
    reached        (m,) bool           C_spring     (m, k, 3, 3), springs beside the joints
    C              (m, 3, 3), what the deflection was computed with: their sum, or the measured map
    F              (m, 3) N, force on the tool        R_MF (m, 3, 3) feed, feed-normal, axial
    delta          (m, 3) m            delta_joint  (m, n, 3), delta_spring (m, k, 3): the shares
    sag            (m, n, 3) m, joint shares of the sag under gravity; None where no masses are given
    conditions     feed, speed, engagement at each sample
    coupling       how force and deflection were brought to agree; None for a one-pass run
    unjudged       steps that have no number, each group with its reason: their delta is NaN
    ahead          (m, 3) m, of a corrected program: how far it sends the tool beside the path that was meant, which is
                   ``path`` then; delta is this and what the tool is pushed. None of any other
    untold         (m,) samples of a program that was corrected along its feed, of which nobody knows how far along the
                   path they were meant to be: there delta is what leads across it. None of any other

    Examples
    --------
    >>> import robomill as rm
    >>> result = rm.simulate(rm.load_setup("paper_flute"))
    >>> result.verdict.level, round(result.max_deviation * 1e3, 3)
    ('ok', 0.251)
    >>> frame = result.to_dataframe()
    >>> float(frame["deviation_mm"].max().round(3))
    0.251
    """

    @cached_property
    def delta_component(self) -> FloatArray:
        """(m, 3, 3) m: the deflection that the feed, feed-normal and axial force components each cause, in {M}."""
        return displacement(self.C[:, None], np.swapaxes(self.R_MF * self.force_components[:, None], 1, 2))

    @cached_property
    def rms_deviation(self) -> float:
        """m: root mean square over the length cut."""
        if not self.judged.any():
            return float("nan")
        weight = np.where(self.judged, self.path.step_length, 0.0)
        if weight.sum() == 0:
            return self.max_deviation
        squares = np.where(self.judged, np.nan_to_num(self.deviation) ** 2, 0.0)
        return float(np.sqrt((weight * squares).sum() / weight.sum()))

    @cached_property
    def notes(self) -> tuple[Finding, ...]:
        """What a reader of the numbers must know."""
        found = [
            *corrected_notes(self.setup),
            *jump_notes(self.path, self.ahead),
            *untold_notes(self.setup, self.judged, self.judged_along),
            *cut_notes(self.setup, self.conditions, ~self.not_judged),
            *tool_notes(self.setup, self.path),
            *edge_notes(self.setup, self.path),
        ]
        found += [*feed_notes(self.setup, self.path), *map_notes(self.setup, self.path)]
        pushed = self.judged & self.conditions.engaged
        found += suspicions(self.setup, self.force_components[pushed])
        found += [*unit_doubts(self.setup, self.path, self.F, pushed), *known_notes(self.setup)]
        found += frame_notes(self.setup.robot)
        found += rigid_tool_notes(self.setup, self.tooling, self.force_components)
        if self.coupling is not None:
            found.append(self.coupling.finding)
        found += self.uncoupled
        if self.setup.add_sag:
            text = (
                "the sag under the arm's own weight is in the deviation; a part that is zeroed on the arm has lost it."
            )
            found.append(Finding("info", text, code="sag"))
        found += self.steadiness
        if self.worst >= 0:
            found += posture_notes(self.setup.robot, self.ik.T_MT[self.worst], self.F[self.worst])
        return self._placed([*found, *self.why_unreached])

    @cached_property
    def uncoupled(self) -> tuple[Finding, ...]:
        """Whether a green verdict rests on taking the tool to cut where it is told to."""
        return () if self._pushed is None else coupling_notes(self.as_told, *self._pushed)

    @cached_property
    def _pushed(self) -> tuple[Verdict, str] | None:
        """Of a green run without coupling whose readings what the deflected tool meets would move: the verdict of that,
        and where it is decided."""
        follows = self.setup.engagement and self.setup.force.follows_cut and self.coupling is None
        if not follows or self.as_told.level not in ("ok", "tight"):
            return None
        met, F = met_where_pushed(self)
        pushed = replace(self, conditions=met, F=F, delta=self.delta + displacement(self.C, F - self.F))
        if not moves_a_reading(self, pushed):
            return None
        sample = decided(pushed, pushed.as_told).sample
        return pushed.as_told, f"{self.path.block_name} {self.path.block[sample]}"

    @cached_property
    def steadiness(self) -> tuple[Finding, ...]:
        """Where a joint must run or the arm passes a singular configuration, by the program's lines."""
        return steadiness(self.path, self.ik)

    @cached_property
    def ideal(self) -> ZMap:
        """The surface a rigid robot would leave."""
        return self._cut(self.path.p)

    @cached_property
    def machined(self) -> ZMap:
        """The surface the deflected robot leaves."""
        return self._cut(self.p_machined)

    @cached_property
    def error(self) -> Deviation:
        """Signed error of the machined surface against the ideal one: + material left, - cut too deep."""
        return deviation(self.ideal, self.machined)

    @property
    def area_out(self) -> tuple[float, float]:
        """(out of tolerance, all) m^2 of the walls and floors that the verdict judges, each against its own tolerance:
        those that are finished in the end, each place once, however many passes have come by."""
        walls = self.finished.walls.out(self.verdict.wall.tolerance)
        floors = self.finished.floors.out(self.verdict.floor.tolerance)
        return walls[0] + floors[0], walls[1] + floors[1]

    @cached_property
    def surface_notes(self) -> tuple[Finding, ...]:
        """What the surfaces say beside ``notes``: undercuts, cuts through the bottom, rapids through material, thin
        walls."""
        thin = thin_wall_notes(self.path.block[self.gauge.thin])
        return self._placed(self.machined.notes() + self._crashes.notes() + thin)

    def _cut(self, p: FloatArray) -> ZMap:
        setup = self.setup
        touches = bool(self.removes.any()) and not self.not_judged.any()  # what is not reached or judged is not cut
        return cut(setup.stock_block, setup.cell, self.tooling, p, self.path.k, self.removes, must_touch=touches)

    @asked
    def groove(self, station: float) -> GrooveSection:
        """The groove's section at ``station`` (m, length travelled at feed); NaN where that was not reached."""
        if np.ndim(station) > 0:
            raise SurfaceError(f"Groove: expected one station, found {np.size(station)}; give several to grooves.")
        return self.grooves([station])[0]

    def grooves(self, stations: ArrayLike) -> GrooveSections:
        """The groove's sections at ``stations`` (q,) m."""
        path = self.path
        moved = np.where(self.answered[:, None], self.p_machined, np.nan)
        who = np.where(self.reached, "measured map", "tool")
        outside = [f"the {name} does not reach this point" for name in who]
        why = np.where(self.not_judged, "not judged here", outside)
        run = CutPath(path.p, moved, path.cutting, path.k, path.block, why.tolist())
        return groove_sections(self.setup.stock_block, self.tooling, run, stations)

    @cached_property
    def stations(self) -> FloatArray:
        """(9,) m: stations shown by default, from 10 % to 90 % of the length cut."""
        return np.linspace(0.1, 0.9, 9) * float(self.path.s[-1])

    @cached_property
    def sections(self) -> GrooveSections:
        """The groove's sections at ``stations``."""
        return self.grooves(self.stations)

    @cached_property
    def gauge(self) -> Gauge:
        """What a gauge would read on the walls, floors and ends that the run leaves."""
        return gauge(self)

    @cached_property
    def finished(self) -> Finished:
        """The errors that the gauge read, with the area of finished surface that each stands for."""
        return finished(self, self.gauge)

    @cached_property
    def stray(self) -> Stray | None:
        """Where the tip is off its path most, and what of that is on the part; None where nothing is judged."""
        return stray(self, self.gauge)

    @cached_property
    def as_told(self) -> Verdict:
        """Walls and floors against their tolerances, by the forces that the run has."""
        return judge(self, self.gauge)

    @cached_property
    def verdict(self) -> Verdict:
        """Walls and floors against their tolerances, in one sentence. Of a run without coupling it is open where what
        the deflected tool meets would clearly make it red."""
        told = self.as_told
        return told if self._pushed is None else resting_on(self, told, left_open(told, *self._pushed))

    @property
    def decided(self) -> Deciding:
        """What the verdict rests on: its kind, its size and the sample where it is."""
        return decided(self, self.verdict)

    @cached_property
    def assumed(self) -> tuple[Assumed, ...]:
        """What the run rests on that nobody measured or stated: ``what`` it is, its ``value`` in short, and ``why``."""
        return tuple(assumed_of_setup(self.setup))

    @cached_property
    def _digest(self) -> str:
        return digest((self.setup.digest(), self.ik.theta, self.F, self.delta))

    def columns(self) -> Columns:
        """One row a sample of the path: see ``path_columns``."""
        return path_columns(self, self.gauge)

    def _said(self) -> str:
        try:
            level, sentence = self.verdict.level, self.verdict.sentence
        except RobomillError as refusal:  # what cannot be judged says why
            level, sentence = "unjudged", str(refusal)
        largest = format_si(self.max_deviation, "mm", missing="no deviation")
        return f"{self.setup.name}: {largest}, {level}: {sentence}"

    def _facts(self) -> list[tuple[str, str]]:
        shown = [("Largest deviation", self.max_deviation), ("Root mean square", self.rms_deviation)]
        return [
            ("Set-up", self.setup._said()),
            *((name, format_si(value, "mm")) for name, value in shown),
            (f"{self.path.block_name.capitalize()} of the largest", str(self.worst_block)),
            ("Samples reached", f"{int(self.reached.sum())} of {len(self.path)}"),
            ("Assumed", "; ".join(each.what for each in self.assumed) or "nothing"),
        ]
