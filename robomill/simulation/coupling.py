"""Force and deflection that depend on each other, solved step by step: the deflected step is cut, then comes the next.

At a step the tip stands off its path by delta, the cutter meets what earlier, deflected steps have left, the force
follows from what it meets, and C times the force is delta again. Where a deflection draws the tool in (climb cuts on a
soft arm) going round and round does not settle, so the equation is solved as one: by Broyden's steps from the
deflection of the step before.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from robomill.arrays import FloatArray
from robomill.provenance import Finding, named
from robomill.units import format_si

TOLERANCE = 0.5e-6  # m: force and deflection agree to this
MOST = 40  # evaluations of the force at a step
RESTART = 12  # evaluations after which Broyden's matrix is begun anew from the best place so far
TURNS = 8  # of the way on which a bracket is halved
COUPLING = "coupling"
LONGEST = 0.5e-3  # m: no correction goes further at once
SURE = 0.02 * TOLERANCE  # m: so near to a root on a line nobody looks further
NARROW = 0.1e-9  # m: to that a jump is found; beside it g may change a thousand times as fast as the tool's place
CLOSE, NEAR = 0.5 * TOLERANCE, 16.0 * TOLERANCE  # m: so far off are forces of which shares are taken, last and first
AROUND = np.array([*product((-1.0, 0.0, 1.0), repeat=3), *product((-0.3, 0.3), repeat=3)])
"""(35, 3): places around one, of half a cube's edge."""
STRAIGHT = np.linalg.pinv(np.column_stack([np.ones(len(AROUND)), AROUND]))
"""(4, 35): of values ``AROUND`` a place the one there, and how they change along x, y and z, by least squares."""
Push = Callable[[FloatArray], FloatArray]
"""Where the force that acts with the tool at a place (3,) m bends it to, (3,) m."""


@dataclass(frozen=True, eq=False)
class Settled:
    """Where g(x) = x: the place x (3,) m, what is left of g(x) - x (m), how often g was asked, and how many times as
    fast g changed as x did (``gain``, NaN where it was asked once).

    ``mix`` are the places whose forces act there, with their weights: one, or more where the force jumps at x (the end
    of a tool that just touches the part) and so much of each holds the tool there.
    """

    x: FloatArray
    rest: float
    evaluations: int
    gain: float
    mix: tuple[tuple[FloatArray, float], ...]

    @property
    def agreed(self) -> bool:
        return self.rest <= TOLERANCE

    @property
    def is_open(self) -> bool:
        """Whether something is left, and known: a g that is no number leaves nothing to settle."""
        return bool(np.isfinite(self.rest)) and not self.agreed


def settle(g: Push, start: FloatArray, free: FloatArray, axis: FloatArray) -> Settled:
    """Solve g(x) = x near ``start`` (3,) m, to ``TOLERANCE`` in every component; ``free`` (3,) m is x without a force,
    ``axis`` (3,) the unit vector along the tool.

    Broyden's method on g(x) - x, whose first step is x <- g(x). Where it does not close in, the height at which the
    end of the tool rests, then a bracket between where the force bends the tool from ``free`` and from there, and last
    the forces that act around the best place so far, near it and a little further off. A g that is no number ends it.
    """
    found = _by_broyden(g, start)
    gain = found.gain
    ways: tuple[Callable[[], Settled], ...] = (
        lambda: _by_height(g, free, axis),
        lambda: _by_bracket(g, free),
        lambda: _by_shares(g, found.x, CLOSE, TURNS),
        lambda: _by_shares(g, found.x, NEAR, 4 * TURNS),
    )
    for otherwise in ways:
        if not found.is_open:
            break
        held = otherwise()
        better = held if held.rest < found.rest else found
        found = replace(better, evaluations=found.evaluations + held.evaluations, gain=gain)
    return found


def _by_broyden(g: Push, start: FloatArray) -> Settled:
    x, H = np.array(start, dtype=float), -np.eye(3)
    f = g(x) - x
    best, gain, count = (x, f), float("nan"), 1
    while np.isfinite(f).all() and np.abs(f).max() > TOLERANCE and count < MOST:
        step = -H @ f
        step *= min(1.0, LONGEST / max(float(np.linalg.norm(step)), LONGEST))
        after = g(x + step) - (x + step)
        change = after - f
        gain = float(np.linalg.norm(change + step) / np.linalg.norm(step))
        x, f, count = x + step, after, count + 1
        if np.isfinite(f).all() and np.abs(f).max() < np.abs(best[1]).max():
            best = x, f
        along = step @ H @ change
        if abs(along) > 1e-12 * float(step @ step):
            H = H + np.outer(step - H @ change, step @ H) / along
        if count % RESTART == 0:
            (x, f), H = best, -np.eye(3) / (1.0 + count / RESTART)
    if np.isfinite(f).all():
        x, f = best
    return Settled(x, float(np.abs(f).max()), count, gain, ((x, 1.0),))


def _by_height(g: Push, free: FloatArray, axis: FloatArray) -> Settled:
    """Where g falls by a jump along ``axis``, as it does where the end of a tool rests on its floor: above it nothing
    pushes, below it all of the end. The height of the jump is found for a place aside; the shares of its two sides that
    hold the tool at that height say how far aside they push it, and there the height is found anew."""
    first = g(free)
    found = Settled(free, float("nan"), 1, float("nan"), ((free, 1.0),))
    aside, ends = first, (float(free @ axis), float(first @ axis))
    for _ in range(TURNS):
        aside = aside - (aside @ axis) * axis
        low, high, asked = _bounds(g, aside, axis, (min(ends), max(ends)))
        found = replace(found, evaluations=found.evaluations + asked)
        if not low < high:
            break
        after, at_low, at_high = _halved(g, aside + low * axis, (high - low) * axis)
        closes = np.isnan(found.rest) or after.rest < 0.5 * found.rest
        found = replace(after if closes else found, evaluations=found.evaluations + after.evaluations)
        if found.agreed or not closes:
            break
        share, height = after.mix[0][1], float(after.x @ axis)
        aside, ends = share * at_low + (1.0 - share) * at_high, (height - TOLERANCE, height + TOLERANCE)
    return found


def _bounds(g: Push, aside: FloatArray, axis: FloatArray, ends: tuple[float, float]) -> tuple[float, float, int]:
    """Heights (m) around ``ends`` of which g leads up from the lower one and down from the upper one, and how often g
    was asked; NaN where there are none as far as a tool is corrected at once."""
    (low, high), step, rises, count = ends, TOLERANCE, False, 0
    while step <= LONGEST:
        at, count = high if rises else low, count + 1
        over = float(g(aside + at * axis) @ axis) - at
        if rises and over < 0.0:
            return low, high, count
        if not rises and over > 0.0:
            rises = True
        else:
            low, high = (high, high + step) if rises else (low - step, low)
            step *= 2.0
    return float("nan"), float("nan"), count


def _by_bracket(g: Push, free: FloatArray) -> Settled:
    """Halve the way between two places that bend the tool to each other: where it is bent to from ``free``, and where
    from there. Its ends become one place, which may push differently on its two sides; then comes the way between what
    the sides push to, on which the place lies where both together hold the tool."""
    start = g(free)
    way, found = g(start) - start, Settled(free, float("nan"), 2, float("nan"), ((free, 1.0),))
    for _ in range(TURNS):
        if not (np.isfinite(way).all() and way.any()):
            break
        after, at_low, at_high = _halved(g, start, way)
        better = found if after.rest >= found.rest else after
        found = replace(better, evaluations=found.evaluations + after.evaluations)
        if found.agreed or not np.isfinite(after.rest):
            break
        apart = at_high - at_low
        start, way = (at_low, apart) if np.abs(apart).max() > TOLERANCE else (after.x, at_low - after.x)
    return found


def _by_shares(g: Push, x: FloatArray, far: float, turns: int) -> Settled:
    """Where a force jumps in more ways than one: shares of the forces around x that together hold the tool in their
    midst. They are sought up to ``far`` (m) off first, where more of them are met, then around that midst by half as
    far, until none is further from it than they have to agree. Where none hold it, the next are sought a little further
    apart, around where the straight law that fits them best has its root, or on the way there."""
    from scipy.optimize import nnls

    found = Settled(x, float("nan"), 0, float("nan"), ((x, 1.0),))
    for _ in range(turns):
        places = x + far * AROUND
        apart = np.array([g(place) for place in places]) - places
        found = replace(found, evaluations=found.evaluations + len(places))
        if not np.isfinite(apart).all():
            break
        rows = np.vstack([apart.T, np.full(len(places), np.abs(apart).max())])
        share = nnls(rows, np.append(np.zeros(3), rows[3, 0]))[0]
        if not share.any():  # they all push alike
            break
        share /= share.sum()
        left = float(np.abs(share @ apart).max())
        if far <= CLOSE and (np.isnan(found.rest) or left < found.rest):
            mix = tuple((places[i], float(share[i])) for i in np.flatnonzero(share))
            found = replace(found, x=share @ places, rest=left, mix=mix)
        if found.agreed:
            break
        if left <= TOLERANCE:
            x, far = share @ places, 0.5 * far
        else:
            here, *law = STRAIGHT @ apart
            way = -np.linalg.lstsq(np.array(law).T / far, here, rcond=1e-6)[0]
            x = x + way * min(1.0, 2.0 * far / max(float(np.linalg.norm(way)), far))
            far *= 1.1
    return found


def _halved(g: Push, start: FloatArray, way: FloatArray) -> tuple[Settled, FloatArray, FloatArray]:
    """The place on a straight way (3,) m from ``start`` where g falls behind, and where its two sides push to.

    By interpolation, truncation and projection (Oliveira and Takahashi 2020): where g goes on it closes in as fast as
    secants do, and where it jumps as fast as by halving, but for one look.
    """
    length = float(np.linalg.norm(way))
    along, low, high = way / length, 0.0, length
    at_low, at_high, count = g(start), g(start + way), 2
    over_low, over_high = float((at_low - start) @ along), float((at_high - start) @ along) - length
    room = NARROW * 2.0 ** np.ceil(np.log2(max(length / NARROW, 1.0)))  # twice the way, at most: a look to spare
    while high - low > NARROW and count < MOST:
        at = _between((low, over_low), (high, over_high), room, length)
        place = start + at * along
        there = g(place)
        over = float((there - place) @ along)
        count, room = count + 1, 0.5 * room
        if abs(over) <= SURE:
            rest = float(np.abs(there - place).max())
            return Settled(place, rest, count, float("nan"), ((place, 1.0),)), there, there
        if over > 0.0:
            low, at_low, over_low = at, there, over
        else:
            high, at_high, over_high = at, there, over
    x = start + 0.5 * (low + high) * along
    apart = float((at_low - at_high) @ along)
    weight = float(np.clip((x - at_high) @ along / apart, 0.0, 1.0)) if apart > 0.0 else 1.0
    pushed = weight * at_low + (1.0 - weight) * at_high
    mix = ((start + low * along, weight), (start + high * along, 1.0 - weight))
    return Settled(x, float(np.abs(pushed - x).max()), count, float("nan"), mix), at_low, at_high


def _between(low: tuple[float, float], high: tuple[float, float], room: float, length: float) -> float:
    """Where to look between two ends, each its place (m) and how far g leads beyond it (m): where a straight line
    through both is nothing, drawn a little to the middle, and so near to that that half the ``room`` (m) is enough for
    what is left; in the middle where it leads out."""
    (a, over), (b, under) = low, high
    middle, wide = 0.5 * (a + b), b - a
    if not over > 0.0 > under:
        return middle
    to_middle = middle - (a + wide * over / (over - under))
    drawn = middle - to_middle + np.copysign(min(0.2 * wide * wide / length, abs(to_middle)), to_middle)
    radius = max(room - 0.5 * wide, 0.0)
    return float(np.clip(drawn, middle - radius, middle + radius))


@dataclass(frozen=True, eq=False)
class Coupling:
    """How force and deflection were brought to agree along a path.

    settled       by step, in order     steps    (n,) their samples
    lines         source lines where they do not agree
    difference    m, largest difference of any component from the answer without coupling
    judged        share of the steps in the material that are judged
    """

    settled: tuple[Settled, ...]
    lines: tuple[int, ...]
    difference: float
    judged: float = 1.0

    @property
    def converged(self) -> bool:
        """Whether they agree at every step."""
        return not self.lines

    @property
    def iterations(self) -> int:
        """Most evaluations of the force that a step took."""
        return max((each.evaluations for each in self.settled), default=0)

    @property
    def mean_iterations(self) -> float:
        """Evaluations of the force a step."""
        return float(np.mean([each.evaluations for each in self.settled])) if self.settled else 0.0

    @property
    def finding(self) -> Finding:
        """For the notes of the result."""
        if self.lines:
            return Finding("warning", f"Coupling: on line {named(self.lines)} {self.why}.", code=COUPLING)
        if self.judged == 0.0:
            text = "Coupling: no step in the material is judged, so there is no force that deflection could agree with."
            return Finding("info", text, code=COUPLING)
        steps = "every step" if self.judged == 1.0 else "every step that is judged"
        text = (
            f"Coupling: force and deflection agree to {format_si(TOLERANCE, 'um', 1)} at {steps} "
            f"({self.mean_iterations:.1f} evaluations a step, at most {self.iterations}); against one pass the "
            f"deflection differs by at most {format_si(self.difference, 'um')}."
        )
        return Finding("info", text, code=COUPLING)

    @property
    def why(self) -> str:
        """What is left where they do not agree, and how the force changes there: by a jump where its last change was
        slower than the tool's, which alone would have settled."""
        open_ = [each for each in self.settled if each.is_open]
        worst = max(open_, key=lambda each: each.rest)
        steep = f"the force, times the compliance, changes {worst.gain:.1f} times as fast as the tool's place"
        jumps = "the tool just touches, and its force jumps from one place to the next"
        return (
            f"force and deflection do not agree: {format_si(worst.rest, 'um')} remain after {worst.evaluations} "
            f"evaluations, since there {jumps if worst.gain < 1.0 else steep}"
        )
