"""Where a tool must be sent so that, pushed off, it goes where it was meant to go: a fixed point on path and force.

At every sample of the wanted path p the tool is sent to q = p + c, where it meets the part, is pushed and stands at
q + delta(q). The correction c is sought with P (c + delta(p + c)) = 0, P being the directions that are corrected, so
with force, compliance and engagement of the corrected path. Samples at one place share one correction where that does
for all of them, as two offset lines meet; at a sharp corner each cut has its own, and a short link leads across.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from robomill.arrays import BoolArray, FloatArray, IntArray, next_true, stretches
from robomill.cutting.tool import DISH
from robomill.progress import checkpoint
from robomill.simulation.judging.places import cut_axes
from robomill.simulation.led import led_beside, plunges, tip_error
from robomill.simulation.meant import LINK
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import along, kept_to_path, spin_of
from robomill.simulation.samples import arrivals
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath
from robomill.toolpath.sampling import CORNER
from robomill.vectors import across, angle_between

COMPONENTS = ("normal", "axial", "feed")
AGREED = 0.5e-6  # m: corrections that change by no more have settled
NEARLY, LONG = 5e-6, 12  # m: after so many runs it is enough if no correction changes by more
MOST, PATIENCE = 40, 5  # runs, and after how many a place that comes no closer is given up
UPRIGHT = 2e-6  # m: along a plunge corrections that differ by no more are one
NEAR = 2.0  # times the largest deflection over the stock: corrected, nothing further off comes to lie in it
MITRE = 2.0  # times the larger deflection of two cuts that meet: no corner is moved further
SLOWEST = 0.1  # least share of a change that is taken where corrections overshoot


@dataclass(frozen=True, eq=False)
class Correction:
    """c (m, 3) m in {W} at the samples of the run ``first`` along the wanted path; ``run`` is the run along the
    corrected one, ``error`` (m, 3) m in {W} how far its tip is off the wanted path; ``change`` m is by how much
    the correction still changed in each iteration, save where it is ``held`` (m,) bool: no force agrees with
    the place there."""

    first: SimulationResult
    c: FloatArray
    run: SimulationResult
    change: tuple[float, ...]
    held: BoolArray

    @property
    def iterations(self) -> int:
        return len(self.change)

    @property
    def settled(self) -> bool:
        return _settled(self.change)

    @property
    def error(self) -> FloatArray:
        return tip_error(self.run, self.first.path)


def _settled(change: Sequence[float]) -> bool:
    return change[-1] <= (NEARLY if len(change) > LONG else AGREED)


def directions(run: SimulationResult, components: tuple[str, ...]) -> FloatArray:
    """P (m, 3, 3) in {W}: what of a deviation is corrected at each sample.

    Normal to the path is to the left of the feed; axial is across both, so the tool axis where the path is level. In a
    plunge normal is all around, and axial is along the way: a hole's bottom.
    """
    across, rise, steep = run.conditions.across, run.conditions.along, run.conditions.mostly_axial
    feed, normal, axis = np.moveaxis(cut_axes(run), 1, 0)
    way = across[:, None] * feed + rise[:, None] * axis
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    up = np.cross(way, normal)
    chosen = {name: name in components for name in COMPONENTS}
    share_way = np.where(steep, chosen["axial"] or chosen["feed"], chosen["feed"])
    share_up = np.where(steep, chosen["normal"], chosen["axial"])
    shares = zip((way, normal, up), (share_way, np.full(len(way), chosen["normal"]), share_up), strict=True)
    return sum(
        (share[:, None, None] * d[:, :, None] * d[:, None, :] for d, share in shares), np.zeros((len(way), 3, 3))
    )


def correct(setup: SimulationSetup, first: SimulationResult, components: tuple[str, ...]) -> Correction:
    """The fixed point from the run ``first`` along the wanted path.

    Where a force jumps with the place of the tool (it just touches) there may be none: there the correction is held
    that came closest, and what it leaves is part of the error.
    """
    wanted, places = first.path, Places.along(first)
    P, seeking = directions(first, components), _Seeking.begin(len(wanted))
    if {"normal", "axial"} <= set(components):  # where a plunge ends no step may be left, whichever way the cut goes on
        P[places.ends()] = np.eye(3)
    result = first
    if setup.coupling:  # a tip that goes as it was meant to meets what it was meant to
        result = kept_to_path(first)
    change: list[float] = []
    while True:
        checkpoint(min(len(change) / 6.0, 0.95), "Correcting the path")
        known = result.path.cutting & np.isfinite(result.delta).all(axis=1)
        asked = places.one_each(P, setup.to_part(np.where(known[:, None], result.delta, 0.0)), known)
        asked = places.held_outside(asked, known & (result.delta != 0.0).any(axis=1), ~result.over_stock)
        asked = places.upright(asked)
        seeking = seeking.looked(asked)
        change.append(seeking.change(asked))
        if _settled(change) or len(change) >= MOST or not np.isfinite(change[-1]):
            return Correction(first, seeking.c, result, tuple(change), seeking.held)
        if len(change) % PATIENCE == 0:
            seeking = seeking.giving_up(places.place)
        seeking = seeking.moved(asked)
        result = corrected_run(first, wanted.p + seeking.c)


@dataclass(frozen=True, eq=False)
class _Seeking:
    """Corrections c (m, 3) m on their way to a fixed point.

    Of the last change, ``before``, the ``share`` (m, 1) was taken (Aitken). ``least`` (m,) m is the smallest change
    that each sample was asked for since it was last looked at, ``best`` its correction then, ``lately`` the smallest
    until then; those that are ``held`` (m,) bool are given up.
    """

    c: FloatArray
    share: FloatArray
    before: FloatArray | None
    best: FloatArray
    least: FloatArray
    lately: FloatArray
    held: BoolArray

    @classmethod
    def begin(cls, m: int) -> "_Seeking":
        never = np.full(m, np.inf)
        nothing = np.zeros((m, 3))
        return cls(nothing, np.ones((m, 1)), None, nothing, never, never, np.zeros(m, dtype=bool))

    def change(self, asked: FloatArray) -> float:
        """m: the largest change that is still ``asked`` of those that are not held."""
        return float(np.where(self.held, 0.0, np.linalg.norm(asked - self.c, axis=1)).max(initial=0.0))

    def looked(self, asked: FloatArray) -> "_Seeking":
        """With the best corrections so far."""
        size = np.linalg.norm(asked - self.c, axis=1)
        better = size < self.least
        best = np.where(better[:, None], self.c, self.best)
        return replace(self, best=best, least=np.minimum(size, self.least))

    def giving_up(self, place: IntArray) -> "_Seeking":
        """Without those, and all samples at their place, that have not come closer by half since last time."""
        stuck = (self.least > AGREED) & (self.least > 0.5 * self.lately)
        stuck = np.bincount(place, stuck)[place] > 0
        least = np.where(self.held | stuck, self.least, np.inf)
        return replace(self, held=self.held | stuck, lately=self.least, least=least)

    def moved(self, asked: FloatArray) -> "_Seeking":
        """After the next change: all of it, but less where the last one overshot."""
        step, share = asked - self.c, self.share
        if self.before is not None:
            turned = self.before - step
            size = np.einsum("mi,mi->m", turned, turned)
            along = np.einsum("mi,mi->m", self.before, turned)
            fitting = np.divide(along, size, out=np.ones(len(step)), where=size > 0.0)
            share = np.clip(share * np.clip(fitting, SLOWEST, 1.0 / SLOWEST)[:, None], SLOWEST, 1.0)
        c = np.where(self.held[:, None], self.best, self.c + share * step)
        return replace(self, c=c, share=share, before=step)


def corrected_run(wanted: SimulationResult, p: FloatArray, **wrong: float) -> SimulationResult:
    """The run of the tool that is sent to p (m, 3) m in {W} to go along the path of the run ``wanted``; ``wrong`` as in
    ``along``."""
    path = wanted.path
    led = led_beside(path, p, plunges(path, wanted.conditions))
    return along(wanted.setup, replace(path, p=p), led=led, spin=spin_of(wanted.ik), **wrong)


@dataclass(frozen=True, eq=False)
class Places:
    """Where samples of a ``path`` stand: ``place`` (m,) counts the points on it; ``then`` (m,) is, for samples on the
    way down, the first one of the level cut that goes on from there, else -1; ``steep`` (m,) bool are plunges, and ways
    ``out``, along the tool. ``alone`` (m,) bool are those where a ramp ends and the cut goes straight on, or it is not
    as far to the next one as the tool is pushed: sent on along the feed there, it would have to go back. ``falling``
    (m,) bool are ramps of a run without coupling, whose end is not felt before it touches, and then at once. ``early``
    (m,) bool are those near the part, over a way down or in what is open already, that the tool goes to faster than it
    goes on: as a rapid, or with a higher feed."""

    path: Toolpath
    place: IntArray
    then: IntArray
    steep: BoolArray
    out: BoolArray
    alone: BoolArray
    falling: BoolArray
    early: BoolArray

    @classmethod
    def along(cls, run: SimulationResult) -> "Places":
        path = run.path
        place = np.cumsum(np.append(False, (np.diff(path.p, axis=0) != 0.0).any(axis=1)))
        then, steep = plunges(path, run.conditions)
        room = np.append(path.step_length[1:], 0.0) > np.linalg.norm(run.delta, axis=1)
        ramps = then[(then >= 0) & ~steep]
        feed = cut_axes(run)[:, 0]
        on = np.append(False, angle_between(feed[1:], feed[:-1]) < CORNER)
        alone = np.isin(place, place[ramps[~room[ramps] | on[ramps]]])
        slope = run.conditions.along
        falling = path.cutting & ~steep & (slope < -DISH) & (not run.setup.coupling)
        out = path.cutting & steep & (slope > 0.0)
        return cls(path, place, then, steep, out, alone, falling, _early(run, then, steep & ~out))

    def ends(self) -> IntArray:
        """Samples at which a level cut goes on from a plunge, or another way than its ramp and with room for that."""
        down = self.then >= 0
        then = self.then[down]
        return np.unique(then[self.steep[down] | ~self.alone[then]])

    def one_each(self, P: FloatArray, d: FloatArray, known: BoolArray) -> FloatArray:
        """c (m, 3): what undoes deflections d (m, 3) m in directions P; at one place one for all that are ``known``
        there, unless that would leave more than ``LINK`` of them beside the path: then each has its own, and a short
        link leads from one to the next.

        Along the axis a place has that of its highest cut, or none where one meets nothing there: what is left standing
        at one spot the tool takes away as it goes on. A plunge is not sent deeper than the level cut that goes on from
        there: the push ends with it. A ramp is, since its floor stays; a link leads from it to the level cut.
        """
        own = -np.einsum("mij,mj->mi", P, d)
        c, k, m = self._shared(P, d, known), self.path.k, len(own)
        several = np.bincount(self.place, known)[self.place] > 1
        axial = known & several & (self.then < 0) & (np.einsum("mij,mi,mj->m", P, k, k) > 0.5)
        highest = np.full(m, -np.inf)
        np.maximum.at(highest, self.place[axial], np.einsum("mi,mi->m", own, k)[axial])
        highest = highest[self.place]
        up = np.einsum("mi,mi->m", c, k)
        lifted = np.where(np.isfinite(highest), highest, up)
        i = np.flatnonzero(self.then >= 0)
        lifted[i] = np.where(self.steep[i], lifted[self.then[i]], up[i])
        c = c + (lifted - up)[:, None] * k
        return self._arriving(c)

    def _arriving(self, c: FloatArray) -> FloatArray:
        """c (m, 3) m with rapids that arrive where the cut begins, but no deeper than they were told to over the part
        or in it: what pushes the tool up in there does not yet, and a rapid would run into what it stands over."""
        arrives = arrivals(self.path)
        c = self._not_early(c)
        c[arrives] = c[arrives + 1]
        return self._not_early(c)

    def _not_early(self, c: FloatArray) -> FloatArray:
        """c (m, 3) m without what leads down where that is too ``early``."""
        k, early = self.path.k, self.early
        lower = np.where(early, np.minimum(np.einsum("mi,mi->m", c, k), 0.0), 0.0)
        return np.asarray(c - lower[:, None] * k)

    def held_outside(self, c: FloatArray, pushed: BoolArray, outside: BoolArray) -> FloatArray:
        """c (m, 3) m with that of the next sample of the cut that is ``pushed`` (m,), else of the last one, where the
        tool is ``outside`` (m,) the stock: where it first touches the force is there at once, and so has to be what
        undoes it. Not on a way out: that is behind its cut; nor on a ramp, where that would send the tool into the part
        before it touches, by all that its end is pushed up then."""
        path, every = self.path, np.arange(len(pushed))
        cut = np.cumsum(~path.cutting & (path.step_length > 0.0))
        after = next_true(pushed, len(every) - 1)
        before = np.maximum.accumulate(np.where(pushed, every, 0))
        of = every.copy()
        for near in (before, after):
            some = path.cutting & outside & ~pushed & ~self.out & ~self.falling & pushed[near] & (cut[near] == cut)
            of[some] = near[some]
        return self._arriving(c[of])

    def upright(self, c: FloatArray) -> FloatArray:
        """c (m, 3) m with one correction beside for all of a plunge whose own differ by no more than ``UPRIGHT``: along
        a wall that is not upright a tool cuts on its side, too."""
        path = self.path
        for begin, past in stretches(self.steep & path.cutting & ~self.out):
            some = slice(begin, past)
            aside = across(c[some], path.k[some])
            if np.abs(aside - aside[-1]).max() <= UPRIGHT:
                c[some] += aside[-1] - aside
        return self._arriving(c)

    def _shared(self, P: FloatArray, d: FloatArray, known: BoolArray) -> FloatArray:
        """c (m, 3) m, the same for all samples at a place where that does for them; else each undoes its own deflection
        in the directions of all of them, for where one cut ends another has its wall; where it is ``alone``, in its
        own."""
        own = -np.einsum("mij,mj->mi", P, d)
        count = np.bincount(self.place, known)
        found = np.zeros((len(count), 3))
        single = known & (count[self.place] == 1)
        found[self.place[single]] = own[single]
        some = np.flatnonzero(known & (count[self.place] > 1))
        if not len(some):
            return found[self.place]
        several, number = np.unique(self.place[some], return_inverse=True)
        every = np.zeros((len(several), 3, 3))
        np.add.at(every, number, P[some])
        inverse = np.asarray(np.linalg.pinv(every, rcond=1e-2, hermitian=True), dtype=np.float64)
        met = _meeting(inverse, own[some], number)
        found[several] = met
        c, k, off = found[self.place], self.path.k[some], met[number] - own[some]
        beside = np.linalg.norm(across(off, k), axis=1)
        most = np.zeros(len(several))
        np.maximum.at(most, number, beside)
        linked = most[number] > LINK
        U = np.einsum("qij,qjk->qik", inverse, every)
        at = some[linked]
        together = -np.einsum("mij,mj->mi", U[number[linked]], d[at])
        c[at] = np.where(self.alone[at, None], own[at], together)
        return np.asarray(c)


def _early(run: SimulationResult, then: IntArray, steep: BoolArray) -> BoolArray:
    """``Places.early`` along a ``run``, of plunges that are ``steep`` (m,) and ways down with a cut ``then`` (m,)."""
    path, down = run.path, run.path.cutting & steep
    most = float(np.nanmax(np.linalg.norm(run.delta, axis=1), initial=0.0))
    near = path.p[:, 2] < run.setup.stock_block.upper[2] + NEAR * most
    arrives = arrivals(path)
    early = np.zeros(len(path), dtype=bool)
    early[arrives] = near[arrives] & ((down | (then >= 0))[arrives + 1] | run.over_stock[arrives])
    early[arrives + 1] = early[arrives] & down[arrives + 1]  # other cuts are led to from there, a plunge need not be
    slows = down[1:] & down[:-1] & (path.v_f[1:] < path.v_f[:-1]) & near[:-1] & ~run.over_stock[:-1]
    begins = stretches(down)[:, 0]
    for i in np.flatnonzero(slows).tolist():
        early[begins[np.searchsorted(begins, i, "right") - 1] : i + 1] = True
    return early


def _meeting(inverse: FloatArray, own: FloatArray, number: IntArray) -> FloatArray:
    """(q, 3) m: the one correction at each of the places ``number`` (m,) that does what all of its own (m, 3) ask, as
    two offset lines meet; their mean where they meet too far off, or not at all. ``inverse`` (q, 3, 3) is that of the
    sum of their directions."""
    count = np.bincount(number)
    b, most = np.zeros((len(count), 3)), np.zeros(len(count))
    np.add.at(b, number, own)
    np.maximum.at(most, number, np.linalg.norm(own, axis=1))
    met = np.einsum("qij,qj->qi", inverse, b)
    near = np.linalg.norm(met, axis=1) <= MITRE * most
    return np.asarray(np.where(near[:, None], met, b / count[:, None]))
