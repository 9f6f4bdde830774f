"""The same part cut otherwise: with another feed, the other way round, in passes, or once more; each by a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from robomill.arguments import asked, made_by
from robomill.arrays import FloatArray, digest
from robomill.errors import RobomillError, SetupError, ToolpathError
from robomill.frames import Columns
from robomill.improve.judged import check_improvable
from robomill.improve.ways import fed, in_levels, turned_round
from robomill.lazy import cached_property
from robomill.progress import step
from robomill.simulation.judging.verdict_words import NO_NUMBER
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import Simulate, chooses_spin, simulate, spin_of
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath
from robomill.toolpath.source import PointsSource
from robomill.units import format_percent, format_si, from_si
from robomill.values import Said, Tabled

SLOWEST, FASTEST, HALVED = 0.1, 4.0, 9  # times the feed, and how often the way between is halved
MOST_LEVELS = 4
ALLOWANCE = 0.1  # of the depth: what roughing leaves for a last pass
AGAIN = ("allowance", "once more")  # ways whose last pass cuts what the one before was too far off to take away
MARCHED = 5_000  # samples of a path: of longer ones no such way is run step by step
DEEPEST_FIRST = (
    "The path goes down in layers, and turned round it would cut the deepest one first; turn each layer round in the "
    "program."
)
NO_THINNER = "these passes would not make them thinner; divide each layer in the program."
TOLD = " (met as it was told)"  # by a last pass, where that is too long a run


@dataclass(frozen=True, eq=False, repr=False)
class Way(Said):
    """One way to cut it: its ``name`` and ``title``; the ``run`` (None where it does not apply, with the reason in
    ``refused``); ``factor`` times the feed, 1 where that stays."""

    name: str
    title: str
    run: SimulationResult | None
    refused: str = ""
    factor: float = 1.0

    def _said(self) -> str:
        return f"{self.title}: {self.refused or (self.run.verdict.sentence if self.run else 'not run')}"

    @property
    def seconds(self) -> float:
        """s at feed and standing still; rapids are not counted."""
        path = None if self.run is None else self.run.setup.toolpath
        return float("nan") if path is None else float(path.t[-1] + path.dwell.sum())

    @property
    def removal_rate(self) -> float:
        """m^3/s removed on average while at feed."""
        if self.run is None:
            return float("nan")
        return float(self.run.ideal.removed_volume) / self.seconds if self.seconds > 0.0 else float("nan")

    @property
    def share(self) -> float:
        """Of the tolerance that is used; NaN where nothing is known."""
        return float("nan") if self.run is None else self.run.verdict.share

    @property
    def keeps(self) -> bool:
        """Whether the run's verdict is green."""
        return self.run is not None and not self.run.verdict.red


@made_by("rm.advise(setup)")
@dataclass(frozen=True, eq=False, repr=False)
class Advice(Tabled):
    """Ways to cut the same part as ``setup`` does, which is the first (``ways[0]``); each number is that of a run.

    Examples
    --------
    >>> import robomill as rm
    >>> advice = rm.advise(rm.load_setup("paper_flute/setup_process"))
    >>> [way.name for way in advice.ways][:3]
    ['now', 'feed', 'turned round']
    """

    setup: SimulationSetup
    ways: tuple[Way, ...]

    @property
    def best(self) -> Way:
        """The quickest of those that keep the tolerance; the truest where none does."""
        kept = [way for way in self.ways if way.keeps]
        if kept:
            return min(kept, key=lambda way: way.seconds)
        return self.truest

    @property
    def truest(self) -> Way:
        """The way that uses least of the tolerance."""
        known = [way for way in self.ways if way.run is not None]
        return min(known, key=lambda way: way.share if np.isfinite(way.share) else np.inf)

    def columns(self) -> Columns:
        """One row a way: its name, how long it takes, what it leaves; NaN where it does not apply."""

        def of(value: Callable[[SimulationResult], float]) -> FloatArray:
            return np.array([float("nan") if way.run is None else value(way.run) for way in self.ways])

        return {
            "way": np.array([way.name for way in self.ways], dtype=object),
            "minutes": from_si(np.array([way.seconds for way in self.ways]), "min"),
            "removal_cm3_min": from_si(np.array([way.removal_rate for way in self.ways]), "cm3/min"),
            "wall_mm": from_si(of(lambda run: abs(run.verdict.wall.value)), "mm"),
            "floor_mm": from_si(of(lambda run: abs(run.verdict.floor.value)), "mm"),
            "max_deviation_mm": from_si(of(lambda run: run.max_deviation), "mm"),
            "used_%": 100.0 * np.array([way.share for way in self.ways]),
            "verdict": np.array(["" if way.run is None else way.run.verdict.level for way in self.ways], dtype=object),
        }

    @cached_property
    def _digest(self) -> str:
        return digest([(way.name, way.refused, way.run.digest() if way.run else "") for way in self.ways])

    def _said(self) -> str:
        kept = sum(way.keeps for way in self.ways)
        return f"{len(self.ways)} ways to cut it, {kept} of them within tolerance"


@asked
def advise(setup: SimulationSetup, run: Simulate | None = None) -> Advice:
    """The same part cut otherwise: the largest feed that keeps the tolerance, the other way round, in passes, with a
    last pass for what roughing leaves, and once more.

    Parameters
    ----------
    setup : SimulationSetup
        The cut. Its force has to follow the cut; the material that is left is used for it (``engagement``).
    run : callable, optional
        What simulates a set-up and may keep results; left out it is ``rm.simulate``.

    Returns
    -------
    Advice
        One run for each way, with its time and what it leaves; why a way does not apply.

    Raises
    ------
    SetupError
        Where the force is stated and does not follow the cut, or the cut has no number.

    Notes
    -----
    A last pass, after roughing or once more, meets the stock as the deflected pass before it has left it: these ways
    are coupled runs. Of a path of more than some thousand samples they are not, and their titles say that what they met
    was the stock as it was told.

    An arm that chooses how it turns about its tool is held as it is held now in every way.

    Examples
    --------
    >>> import robomill as rm
    >>> advice = rm.advise(rm.load_setup("paper_flute/setup_process"))
    >>> [(way.name, round(way.share, 2)) for way in advice.ways if "passes" in way.name]
    [('2 passes', 0.47), ('3 passes', 0.31), ('4 passes', 0.23)]
    """
    check_improvable(setup)
    if not setup.force.follows_cut:
        raise SetupError(
            "The force of this set-up is stated and does not follow the cut: no other feed, way or number of passes "
            "would change it. State a force from the material first.",
            where="force",
        )
    if not setup.engagement:
        setup = setup.replace(engagement=True, provenance=setup.provenance)
    run = run or simulate
    now = run(setup)
    if now.verdict.level in NO_NUMBER:
        raise SetupError(f"There is no number to improve: {now.verdict.sentence}")
    asked_for = [*_ways(now)]
    found = [Way("now", "As it is", now)]
    with step(0, len(asked_for) + 1, "The largest feed"):
        found.append(_feed(now, run))
    for k, (name, title, path) in enumerate(asked_for, 1):
        with step(k, len(asked_for) + 1, title):
            if name in AGAIN:
                found.append(_again(name, title, now, path, run))
            else:
                found.append(_way(name, title, partial(_run_along, held(now), path, run)))
    return Advice(setup, tuple(found))


def _ways(now: SimulationResult) -> Iterator[tuple[str, str, Callable[[], Toolpath]]]:
    """Name, title and path of each way."""
    path, top = now.setup.toolpath, float(now.setup.stock_block.upper[2])
    depth = max(top - float(path.extents[0][2]), 0.0)
    layer = _layer(now, top)
    back = partial(turned_round, path, top)
    yield "turned round", "The other way round", back if np.isinf(layer) else partial(_refused, DEEPEST_FIRST)
    for count in range(2, MOST_LEVELS + 1):
        levels = depth * (1.0 - np.arange(1, count + 1) / count)
        thin = partial(in_levels, path, levels, top)
        why = f"The path goes down in layers of {format_si(layer, 'mm')} already, and {NO_THINNER}"
        as_thick = layer * count < depth * (1.0 + 1e-6)
        yield f"{count} passes", f"In {count} passes", partial(_refused, why) if as_thick else thin
    rest = np.array([ALLOWANCE * depth, 0.0])
    said = f"Roughing, {format_si(rest[0], 'mm')} left for a last pass"
    yield "allowance", said, partial(in_levels, path, rest, top)
    yield "once more", "The same path once more", partial(in_levels, path, np.zeros(2), top)


def _layer(now: SimulationResult, top: float) -> float:
    """m: how thick the layers are in which the path goes down from ``top`` (m); infinite where it goes to its depth at
    once. A cut that is thinner by no more than the tip is off is such a one: its deflection may have made it so."""
    met = now.conditions
    level = now.path.cutting & met.engaged & ~met.mostly_axial
    if not level.any():
        return float("inf")
    thickest, deepest = float(np.nanmax(met.a_p[level])), top - float(now.path.p[level, 2].min())
    return thickest if thickest + now.max_deviation < deepest else float("inf")


def _refused(why: str) -> Toolpath:
    raise ToolpathError(why)


def held(now: SimulationResult) -> SimulationSetup:
    """The set-up of a run with its arm held about the tool as it was held there: ways to cut are compared in one
    posture, and not with the one that each would choose."""
    setup = now.setup
    if not chooses_spin(setup):
        return setup
    return setup.replace(spin=spin_of(now.ik), provenance=dict(setup.provenance))


def _along(setup: SimulationSetup, path: Toolpath) -> SimulationSetup:
    """The set-up along another path that cuts the same part."""
    said, source = dict(setup.provenance), PointsSource(path, setup.source.name)
    return setup.replace(source=source, stock=setup.stock_block, provenance=said)


def _run_along(setup: SimulationSetup, path: Callable[[], Toolpath], run: Simulate) -> SimulationResult:
    return run(_along(setup, path()))


def _way(name: str, title: str, run: Callable[[], SimulationResult], factor: float = 1.0) -> Way:
    try:
        return Way(name, title, run(), factor=factor)
    except RobomillError as refusal:
        return Way(name, title, None, str(refusal))


def _again(name: str, title: str, now: SimulationResult, path: Callable[[], Toolpath], run: Simulate) -> Way:
    """A way whose last pass meets what the one before, deflected, has left: a coupled run, unless that is too long."""
    setup = held(now)
    if not setup.coupling and len(now.path) > MARCHED:
        return _way(name, f"{title}{TOLD}", partial(_run_along, setup, path, run))
    coupled = setup.replace(coupling=True, provenance=dict(setup.provenance))
    return _way(name, title, partial(_run_along, coupled, path, run))


def _feed(now: SimulationResult, run: Simulate) -> Way:
    """The largest feed that keeps the tolerance, by halving between one that does and one that does not."""
    setup, path = held(now), now.setup.toolpath

    def at(factor: float) -> Way:
        title = f"{format_percent(factor)} of the feed"
        return _way("feed", title, partial(_run_along, setup, partial(fed, path, factor), run), factor)

    slow, fast = (1.0, FASTEST) if not now.verdict.red else (SLOWEST, 1.0)
    kept, other = at(slow), at(fast)
    if other.keeps:
        return replace(other, title=f"{other.title}, the most that is tried")
    if not kept.keeps:
        return replace(kept, title=f"{kept.title}: no feed keeps the tolerance")
    for _ in range(HALVED):
        middle = at(float(np.sqrt(kept.factor * other.factor)))
        kept, other = (middle, other) if middle.keeps else (kept, middle)
    return replace(kept, title=f"{kept.title}, the most that keeps the tolerance")
