"""The corrected program: the tool is sent elsewhere, so that it goes where it was meant to, and what then remains."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from robomill.arguments import made_by
from robomill.arrays import FloatArray, digest
from robomill.errors import CompensationError
from robomill.frames import Columns
from robomill.identification.fit.confidence import LEVEL
from robomill.identification.knowledge import Knowledge
from robomill.improve.correction import COMPONENTS, Correction, correct
from robomill.improve.errors import Errors, errors_of, graver, is_measured_whole, level_of, measured
from robomill.improve.finer import closer
from robomill.improve.judged import check_improvable
from robomill.improve.springs import Springs, springs
from robomill.improve.trusted import check_found, check_reached, check_trusted
from robomill.improve.written import WriteGCode, Written, writing
from robomill.lazy import cached_property
from robomill.progress import step
from robomill.provenance import Finding, named
from robomill.simulation.band import deviation_band
from robomill.simulation.judging.gauge import Gauge
from robomill.simulation.judging.verdict import judge
from robomill.simulation.judging.verdict_words import LEVELS, NO_NUMBER, Level, Verdict, level_of_share
from robomill.simulation.meant import untold_notes
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import along, ran, spin_of
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath
from robomill.toolpath.source import GCodeSource, PathSource
from robomill.units import format_count, format_percent, format_si, from_si
from robomill.values import Tabled

BOUND = 2e-6  # m
FITTED = 0.9  # of the bound: the rest is for the digits that are written
FINEST, COARSEST = 0.2e-6, 1e-3  # m: bounds that can be asked for
WRONG = 1.2  # how much softer or stronger than is known
STILL = 1e-7  # rad: a joint that turns no further rests


@made_by("rm.compensate(setup)")
@dataclass(frozen=True, eq=False, repr=False)
class Compensation(Tabled):
    """A corrected program with what it leaves.

    text          the program; ``source`` is it as the path of a set-up
    components    what was corrected: normal to the path, axial, feed
    bound         m: the program keeps so near to the corrected path
    before        what the program leaves as it is; ``after`` what the corrected one leaves, both ``Errors``
    softer, stronger   what it leaves if all that gives is 20 % softer, or the force 20 % stronger, than was computed
                  with: the larger of that and of as much stiffer, or weaker
    half          m: half the 95 % interval of what remains, by linear propagation; NaN where nobody has said how sure
                  the compliances are
    change        m: by how much the correction still changed at each iteration
    wanted, led   runs of the program as it is, and of the corrected one's text, told from the path that was meant
    c             (m, 3) m in {W}: the correction at the samples of the path as it is, as written
    unrolled      what was written out: loops and subprograms, canned cycles, ...
    findings      what a reader must know
    sprung        where the force jumps, and how far the tip springs there, which no program can take away; not in
                  ``after``

    Examples
    --------
    >>> import robomill as rm
    >>> found = rm.compensate(rm.load_setup("paper_flute"))
    >>> found.text.splitlines()[6]
    'N30 G0 X-50 Y-0.2293 Z20'
    """

    setup: SimulationSetup
    components: tuple[str, ...]
    bound: float
    text: str
    before: Errors
    after: Errors
    softer: Errors
    stronger: Errors
    half: float
    change: tuple[float, ...]
    wanted: SimulationResult
    led: SimulationResult
    c: FloatArray
    lines_in: int
    unrolled: tuple[str, ...] = ()
    findings: tuple[Finding, ...] = ()
    sprung: tuple[Springs, ...] = ()

    @property
    def iterations(self) -> int:
        """Runs that it took, each from where the one before had sent the tool."""
        return len(self.change)

    @property
    def lines_out(self) -> int:
        """Lines of the corrected program."""
        return len(self.text.splitlines())

    @property
    def name(self) -> str:
        """A name for the program's file."""
        return self.source.name

    @property
    def doubted(self) -> Errors:
        """What it is graded by: what it leaves if stiffness or force is 20 % off, whichever uses more of the tolerance.
        What is left inside the model is next to nothing, and nobody should believe in that."""
        return graver(self.softer, self.stronger, self.setup)

    @property
    def share(self) -> float:
        """Of the tolerance that is used then."""
        return self.doubted.share(self.setup)

    @cached_property
    def level(self) -> Level:
        """The verdict's level then; no better than that of what is predicted."""
        return max(level_of(self.led), level_of_share(self.share), key=LEVELS.index)

    @cached_property
    def source(self) -> GCodeSource:
        """The corrected program as a source: ``setup.replace(source=...)`` runs it as any other, and its deviation is
        told from the path that was meant."""
        return _source(self.setup.source, self.text)

    @cached_property
    def _digest(self) -> str:
        return digest((self.setup.digest(), self.components, self.bound, self.text))

    def columns(self) -> Columns:
        """One row a sample of the corrected program: its line, how far along the path that was meant; the correction in
        {W}, and the deviation before and after in its cut's axes."""
        path, ahead = self.led.path, self.led.ahead
        assert ahead is not None
        found: Columns = {path.block_name: path.block, "cutting": path.cutting, "station_mm": from_si(path.s, "mm")}
        c = self.setup.to_part(ahead)
        found |= {f"correction_{axis}_mm": from_si(c[:, i], "mm") for i, axis in enumerate("xyz")}
        before = beside(path, self.wanted.path, self.wanted.delta_in_cut)
        for when, delta in (("before", before), ("after", self.led.delta_in_cut)):
            parts = from_si(delta, "mm")
            found |= {f"{when}_{name}_mm": parts[:, i] for i, name in enumerate(("feed", "normal", "axial"))}
        return found

    def _said(self) -> str:
        was, now = (format_si(each.max, "mm", 4) for each in (self.before, self.after))
        return f"{self.setup.name}: {was} before, {now} after {format_count(self.iterations, 'iteration')}"

    def _facts(self) -> list[tuple[str, str]]:
        told = [("Before", self.before), ("After", self.after)]
        told += [("Compliances 20 % wrong", self.softer), ("Force 20 % wrong", self.stronger)]
        lines = f"{self.lines_in} in, {self.lines_out} out"
        return [*((name, each._said()) for name, each in told), ("Lines", lines)]


def compensation(
    setup: SimulationSetup,
    components: Iterable[str],
    bound: float,
    write_gcode: WriteGCode,
    known: Knowledge | None = None,
) -> Compensation:
    """The corrected program of a set-up; ``write_gcode`` writes paths that are no program. See ``rm.compensate``."""
    chosen = checked_components(components)
    if not FINEST <= bound <= COARSEST:
        ends = f"{format_si(FINEST, 'um', 1)} to {format_si(COARSEST, 'mm', 0)}"
        raise CompensationError(f"Bound: found {format_si(bound, 'um', 3)}; expected {ends}.", where="bound")
    check_improvable(setup)
    with step(0, 4, "The program as it is"):
        back = writing(setup, write_gcode)
        back.components = chosen
        wanted = along(setup, back.moves.wanted)
        before = measured(wanted)
        check_trusted(wanted, before)
        back.moves = back.moves.finer(wanted)
        if back.moves.wanted is not wanted.path:
            wanted = along(setup, back.moves.wanted, spin=spin_of(wanted.ik))
            before = measured(wanted)
    with step(1, 4, "Correcting the path"):
        found = correct(setup, wanted, chosen)
        check_found(found, wanted)
    with step(2, 4, "Writing the program"):
        written = back.write(found.c, FITTED * bound)
        check_reached(found.run, wanted)
    with step(3, 4, "What remains"):
        led = ran(_corrected(setup, written.text))  # of the text, as anybody runs it: what is told is what that gives
        return _measured(found, (led, before), written, chosen, (bound, known))


def _source(given: PathSource, text: str) -> GCodeSource:
    """The corrected ``text`` of a source, with that as what is wanted."""
    if not isinstance(given, GCodeSource):
        return GCodeSource(text, "corrected.nc", wanted=given)
    stem, dot, end = given.name.rpartition(".")
    return replace(given, text=text, name=f"{stem}_corrected.{end}" if dot else "corrected.nc", wanted=given)


def _corrected(setup: SimulationSetup, text: str) -> SimulationSetup:
    """The set-up with the corrected text in the place of its program."""
    return setup.replace(source=_source(setup.source, text), provenance=dict(setup.provenance))


def beside(path: Toolpath, other: Toolpath, values: FloatArray) -> FloatArray:
    """(n, k): values (m, k) at the samples of the ``other`` path where samples of a ``path`` along it are: cut by cut,
    by how much of it has been gone."""
    found = np.zeros((len(path), values.shape[1]))
    here, there = (np.cumsum(~each.cutting & (each.step_length > 0.0)) for each in (path, other))
    for cut in np.unique(here[path.cutting]):
        a, b = (np.flatnonzero((of == cut) & each.cutting) for of, each in ((here, path), (there, other)))
        if len(b):
            s, t = (
                each.s[some] - each.s[some[0]] + each.step_length[some[0]] for each, some in ((path, a), (other, b))
            )
            s = s * (t[-1] / s[-1]) if s[-1] > 0.0 else s
            found[a] = np.column_stack([np.interp(s, t, values[b, i]) for i in range(values.shape[1])])
    return found


def _measured(
    found: Correction,
    seen: tuple[SimulationResult, Gauge],
    written: Written,
    chosen: tuple[str, ...],
    asked: tuple[float, Knowledge | None],
) -> Compensation:
    """``seen``: the run along the corrected path, and what was measured on the one along the wanted path."""
    wanted, (led, gauge) = found.first, seen
    bound, known = asked
    left = measured(led)
    before, after, verdict = errors_of(wanted, gauge), errors_of(led, left), judge(led, left)
    if not after.max < before.max:
        raise CompensationError(_no_better(before, after, verdict, chosen))
    softer, stronger = _wrong(led)
    sprung = springs(led)
    findings = (
        *_met(after, graver(softer, stronger, led.setup), led.setup, verdict),
        *(each for each in untold_notes(led.setup, led.judged, led.judged_along) if each.level == "warning"),
        *closer(led, after),
        *_findings(found, led, written, sprung),
    )
    return Compensation(
        setup=wanted.setup,
        components=chosen,
        bound=bound,
        text=written.text,
        before=before,
        after=after,
        softer=softer,
        stronger=stronger,
        half=_half(led, known),
        change=found.change,
        wanted=wanted,
        led=led,
        c=written.q - wanted.path.p,
        lines_in=written.lines_in,
        unrolled=written.unrolled,
        findings=findings,
        sprung=sprung,
    )


def _no_better(before: Errors, after: Errors, verdict: Verdict, chosen: tuple[str, ...]) -> str:
    """Why there is no corrected program that leaves less, by what the best one would leave, with its ``verdict``."""
    became = f"{format_si(before.max, 'mm', 4)} would become {format_si(after.max, 'mm', 4)}"
    if not {"normal", "axial"} <= set(chosen):
        why = "since what is pushed aside here is not what was chosen to be corrected; choose other components."
        return f"The path is not corrected: {became}, {why}"
    return f"The path is not corrected: {became}. {verdict.sentence}"


def checked_components(components: Iterable[str]) -> tuple[str, ...]:
    """The components in their order. Raises CompensationError for others, and for none."""
    listed = components.split(",") if isinstance(components, str) else components
    given = [str(each).strip() for each in (listed if isinstance(listed, Iterable) else (listed,))]
    unknown = [each for each in given if each not in COMPONENTS]
    if unknown or not given:
        what = f"found {unknown[0]!r}" if unknown else "found none"
        raise CompensationError(f"Components: {what}; expected some of {', '.join(COMPONENTS)}.", where="components")
    return tuple(each for each in COMPONENTS if each in given)


def reversals(run: SimulationResult) -> int:
    """How often a joint turns back while the tool cuts."""
    turn = np.diff(run.theta, axis=0)[run.path.cutting[1:]]
    count = 0
    for each in turn.T:
        way = np.sign(each[np.abs(each) > STILL])
        count += int((way[1:] != way[:-1]).sum())
    return count


def _wrong(led: SimulationResult) -> tuple[Errors, Errors]:
    """What is left where compliances, or the force, are wrong by 20 % to either side, whichever uses more of the
    tolerance."""
    setup = led.setup
    if not setup.add_sag and not setup.coupling:  # then the deflection is wrong by as much, whichever it is
        assert led.ahead is not None
        more = (WRONG - 1.0) * (led.delta - led.ahead)
        one, other = (errors_of(replace(led, delta=led.delta + sign * more)) for sign in (1.0, -1.0))
        worse = graver(one, other, setup)
        return worse, worse
    found = []
    for name in ("softer", "stronger"):
        one, other = (errors_of(ran(setup, **{name: by})) for by in (WRONG, 2.0 - WRONG))
        found.append(graver(one, other, setup))
        if not setup.add_sag:  # nothing but the force bends the arm: C times a wrong F is a wrong C times F
            break
    return found[0], found[-1]


def _half(led: SimulationResult, known: Knowledge | None) -> float:
    """Half the 95 % interval (m) of what remains across the path or along the axis, where it is widest."""
    if known is None or not led.judged.any():
        return float("nan")
    band = deviation_band(led, known)
    halves = [band.half_along(led.R_MF[..., i], LEVEL)[led.judged] for i in (1, 2)]
    return float(np.nanmax(halves))


def _met(after: Errors, wrong: Errors, setup: SimulationSetup, verdict: Verdict) -> tuple[Finding, ...]:
    """Whether the corrected program keeps the tolerance, and whether it still does if the numbers are ``wrong``."""
    if verdict.level in NO_NUMBER:
        text = f"whether the corrected program keeps the tolerance is not known. {verdict.sentence}"
        return (Finding("warning", text, code="not-known"),)
    if after.share(setup) > 1.0:
        text = f"the tolerance is not kept by the corrected program either. {verdict.sentence}"
        return (Finding("warning", text, code="not-met"),)
    if wrong.share(setup) <= 1.0:
        return ()
    text = (
        f"the tolerance is kept only if the numbers are right: if compliances or force are 20 % wrong, "
        f"{format_percent(wrong.share(setup))} of it is used ({format_si(wrong.decides(setup)[1], 'mm')})."
    )
    return (Finding("warning", text, code="met-if-right"),)


def _findings(
    found: Correction, led: SimulationResult, written: Written, sprung: tuple[Springs, ...]
) -> tuple[Finding, ...]:
    wanted, told = found.first, []
    if written.unrolled:
        told.append(Finding("info", f"written out: {', '.join(written.unrolled)}.", code="unrolled"))
    if found.held.any():
        lines = named(sorted(set(wanted.path.block[found.held].tolist())))
        text = (
            f"{wanted.path.block_name} {lines}: the tool just touches there, and no correction agrees with the force; "
        )
        told.append(Finding("warning", text + "what is left is in the numbers.", code="held"))
    told += [each.finding for each in sprung]
    known = {(each.code, each.line) for each in wanted.steadiness}
    told += [each for each in led.steadiness if (each.code, each.line) not in known]
    if is_measured_whole(led):
        told += led.uncoupled
    before, after = reversals(wanted), reversals(led)
    if after > before:
        text = (
            f"joints turn back {format_count(after, 'time')} while cutting, {before} as it was: backlash shows there."
        )
        told.append(Finding("info", text, code="joint-reversals"))
    text = "the deflection is taken back as it is predicted; measure one cut before the part."
    return (*told, Finding("info", text, code="predicted"))
