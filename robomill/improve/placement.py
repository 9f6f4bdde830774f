"""Where the part should lie: the place and yaw of part zero at which this program comes out best."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asked
from robomill.arrays import FloatArray, IntArray
from robomill.errors import SetupError
from robomill.improve.area import MOST_CANDIDATES, WHO, Area, area, grid, today
from robomill.improve.judged import check_improvable
from robomill.improve.map_check import LONG, agrees, checked
from robomill.improve.placed import (
    FINE,
    FINEST,
    KEPT_OUT,
    NO_ROOM,
    SINGULAR,
    UNKNOWN,
    UNREACHED,
    WHY,
    Place,
    Placement,
    findings,
    place_of,
)
from robomill.improve.screening import (
    ASKED,
    Asked,
    Screen,
    Screened,
    Standing,
    configurations,
    screen,
    standing,
    uncoupled,
)
from robomill.kinematics.dexterity import NEAR
from robomill.progress import checkpoint, step
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import simulate, tool_frames
from robomill.simulation.samples import sampled
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.tools import farther
from robomill.units import format_count, format_many, format_percent, to_si

ROOM = 0.05  # of a joint's half range: how much it keeps to its limits
WRITTEN = np.array([1e-4, 1e-4, 1e-4, to_si(0.01, "deg")])  # to which a place is rounded
STARTS = 4  # places from which the coarse map is refined
ROUNDS = 3  # of looking again, with what the full simulation of the best place found worst
POLISHED = 8  # steps by full simulations


@asked
def place(
    setup: SimulationSetup,
    *,
    x: ArrayLike | None = None,
    x_mm: ArrayLike | None = None,
    y: ArrayLike | None = None,
    y_mm: ArrayLike | None = None,
    z: ArrayLike | None = None,
    z_mm: ArrayLike | None = None,
    yaw: ArrayLike | None = None,
    yaw_deg: ArrayLike | None = None,
    keep_out: Sequence[Any] | None = None,
    keep_out_mm: Sequence[Any] | None = None,
    measure: Asked = "verdict",
    room: float = ROOM,
    candidates: int = 1000,
) -> Placement:
    """Where in a box the part should lie so that this program comes out best.

    Parameters
    ----------
    setup : SimulationSetup
        The cut; its part zero is "now".
    x, x_mm, y, y_mm, z, z_mm : (2,) m, or mm
        Least and largest coordinate of part zero in {M}. x and y left out: today's, 15 % of the arm's length (all its
        links in a row) to each side; z left out: as it is.
    yaw, yaw_deg : (2,) rad, or degrees
        Least and largest turn of the part about z_M, as ``part_rotation_z`` has it; left out: as it is.
    keep_out, keep_out_mm : (b, 2, 3) m, or mm
        Boxes in {M}, lower and upper corner, that the block of the stock keeps out of.
    measure : str
        What is minimised: "verdict" (the largest share of its tolerance that walls or floors use, and the feed where it
        has a tolerance of its own), "tip" (the tip's distance from its path), "wall", "floor" or "feed".
    room : float
        What every joint keeps to its limits, as a share of its half range.
    candidates : int
        How many places the coarse map has, about.

    Returns
    -------
    Placement
        ``best``, ``now``, ``median`` and ``worst``, each simulated in full, and the coarse map.

    Raises
    ------
    SetupError
        For contradictory bounds, and where the part fits nowhere in the box, with the nearest reason.

    Notes
    -----
    The coarse map moves every reading of one full simulation as the tip moves there, with the compliance of eqs. (11)
    to (14) at every sample; without coupling, which the full simulations have. Some of its places are simulated in
    full; where these differ (at corners, where one pass cleans up another), more are, and the map is moved along with
    them, but for coupled and long programs. From its best places the search
    goes on in halved steps to 1 mm and 0.25 degrees. A place is allowed where the arm reaches all of the path, keeps
    ``room``, passes no singular configuration and stays away from one (2 % of its largest |det(J)|). Whether the arm
    itself meets the part is not checked.

    Examples
    --------
    >>> import robomill as rm
    >>> found = rm.place(rm.load_setup("paper_flute"), x_mm=(-200, 200), y_mm=(-1400, -1200), candidates=50)
    >>> found.best.level
    'ok'
    """
    check_improvable(setup)
    given = {"x": x, "x_mm": x_mm, "y": y, "y_mm": y_mm, "z": z, "z_mm": z_mm, "yaw": yaw, "yaw_deg": yaw_deg}
    where = area(setup, {**given, "keep_out": keep_out, "keep_out_mm": keep_out_mm})
    if measure not in ASKED:
        raise SetupError(f"{WHO}, measure: found {measure!r:.40}; expected {', '.join(ASKED)}.", where="measure")
    if not 0.0 <= room < 1.0:
        raise SetupError(f"{WHO}, room: found {room!r:.40}; expected a share from 0 to less than 1.", where="room")
    if not 1 <= candidates <= MOST_CANDIDATES:
        raise SetupError(
            f"{WHO}, candidates: found {candidates!r:.40}; expected 1 to {MOST_CANDIDATES}.", where="candidates"
        )
    return _Search(setup, where, measure, float(room)).run(int(candidates))


@dataclass(frozen=True, eq=False)
class _Search:
    """What is asked of every place."""

    setup: SimulationSetup
    area: Area
    measure: Asked
    room: float

    def run(self, candidates: int) -> Placement:
        axes = self.area.axes(candidates)
        places = grid(axes)
        here, now, result = self._now()
        if not now.known:
            result = self._reference(places)
        looking = screen(result)
        screened, why = self._look(looking, places)
        if not (why == FINE).any():
            raise self._nowhere(places, screened.standing, why)
        share = np.where(why == FINE, screened.share(self.measure, self.setup), np.nan)
        known = [(now, here)] if now.known and self.area.contains(here) and self.allows(now, here) else []
        if not self._long(looking):
            full = checked(lambda at: self.simulated(at)[0], places, share, _spacing(axes))
            known += [(found, places[i]) for i, found in full.items() if self.allows(found, places[i])]
        best, looking = self._best(looking, axes, share, known)
        median, worst = self._compared(places, share, why)
        shape = tuple(map(len, axes))
        found = Placement(
            setup=self.setup,
            measure=self.measure,
            now=now,
            best=best,
            median=median,
            worst=worst,
            axes=(axes[0], axes[1], axes[2], axes[3]),
            keep_out=self.area.keep_out,
            share=share.reshape(shape),
            why=why.reshape(shape),
            screened=(len(looking.at), len(result.path)),
        )
        return replace(found, findings=findings(found, self.area, result))

    def simulated(self, at: FloatArray) -> tuple[Place, SimulationResult]:
        """A place (4,) by a full simulation."""
        result = simulate(self.setup.replace(T_MW=self.area.T_MW(at)))
        return place_of(result, at, self.measure), result

    def _now(self) -> tuple[FloatArray, Place, SimulationResult]:
        """Where the part lies, with its yaw as the area counts it, and the run there, without coupling."""
        here = today(self.setup)
        whole = np.ceil((self.area.lower[3] - here[3]) / (2.0 * np.pi) - 1e-12) * 2.0 * np.pi
        if here[3] + whole <= self.area.upper[3] + 1e-9:
            here[3] += whole
        checkpoint(0.0, "The cut where it is")
        result = simulate(self.setup)
        found = place_of(result, here, self.measure)
        if result.verdict.level == "missed" or (found.reason == "" and not found.known):
            raise SetupError(f"{WHO}: nothing is judged that places could be compared by. {result.verdict.sentence}")
        return here, found, simulate(uncoupled(self.setup)) if self.setup.coupling else result

    def _reference(self, places: FloatArray) -> SimulationResult:
        """A full run, without coupling, at the place that is reached with most room."""
        setup = uncoupled(self.setup)
        path = sampled(setup.toolpath, setup.step)
        few = np.unique(np.linspace(0, len(path) - 1, 48).astype(np.int64))
        T_WT = tool_frames(path.p[few], path.k[few], farther(setup, path)[few])
        stands = []
        for begin in range(0, len(places), 64):
            checkpoint(begin / len(places), "Places that are reached")
            some = self.area.T_MW(places[begin : begin + 64])
            stands.append(standing(configurations(setup, some[:, None] @ T_WT)))
        every = Standing(*(np.concatenate(parts) for parts in zip(*stands, strict=True)))
        order = np.lexsort((-np.nan_to_num(every.room, nan=-1.0), every.missed))
        for i in order[:8]:
            if every.missed[i] == 0:
                result = simulate(setup.replace(T_MW=self.area.T_MW(places[i])))
                if place_of(result, places[i], self.measure).known:
                    return result
        raise self._nowhere(places, every, np.where(every.missed > 0, UNREACHED, UNKNOWN))

    def _look(self, looking: Screen, places: FloatArray) -> tuple[Screened, IntArray]:
        """Places (k, 4) screened, and why each is not allowed (k,)."""
        screened = looking.over(self.area.T_MW(places))
        stands = screened.standing
        why = np.where(np.isnan(screened.share(self.measure, self.setup)), UNKNOWN, FINE)
        why[~(np.abs(stands.det) > NEAR) | (stands.det < 0.0)] = SINGULAR
        why[~(stands.room >= self.room)] = NO_ROOM
        why[stands.missed > 0] = UNREACHED
        why[self.area.meets(places)] = KEPT_OUT
        return screened, why

    def allows(self, found: Place, at: FloatArray) -> bool:
        """Whether a place that was simulated in full is one."""
        return found.known and found.room >= self.room and found.det > NEAR and not self.area.meets(at[None])[0]

    def _best(
        self, looking: Screen, axes: Sequence[FloatArray], share: FloatArray, known: list[tuple[Place, FloatArray]]
    ) -> tuple[Place, Screen]:
        """The best place by full simulation, of which some are ``known``; what it shows that the screen has not seen is
        looked at again."""
        known = sorted(known, key=lambda each: each[0].share)
        starts = [*self._starts(axes, share), *(at for _, at in known[:2])]
        reference = looking.reference
        rounds = 1 if self.setup.coupling else ROUNDS
        for turn in range(rounds):
            ends: list[FloatArray] = []
            for k, start in enumerate(starts):
                with step(turn * len(starts) + k, rounds * len(starts), "Refined"):
                    ends.append(self._refined(looking, start, axes))
            ends = [np.array(each) for each in dict.fromkeys(tuple(end) for end in ends)]
            unseen: list[int] = []
            for end in ends:
                found, result = self.simulated(end)
                if self.allows(found, end):
                    known.append((found, end))
                screened = float(self._look(looking, end[None])[0].share(self.measure, self.setup)[0])
                if not found.known or not agrees(found.share, screened):
                    unseen += _worst_samples(result)
            if not (fresh := np.setdiff1d(np.array(unseen, dtype=np.int64), looking.at)).size:
                break
            looking = screen(reference, np.union1d(looking.at, fresh))
        if not known:
            at = grid(axes)[int(np.nanargmin(share))]
            raise SetupError(
                f"{WHO}: of the places that looked possible none holds in a full simulation; the best one, "
                f"{format_many(at[:3], 'mm', 1)}, does not: {self.simulated(at)[0].reason or WHY[NO_ROOM]}."
            )
        best, at = min(known, key=lambda each: each[0].share)
        return self._polished(best, at, looking, axes), looking

    def _polished(self, best: Place, at: FloatArray, looking: Screen, axes: Sequence[FloatArray]) -> Place:
        """Where the screen is no good measure (a surface that another pass has made), a few steps along the axes by
        full runs; none of a coupled or a long program, each of whose runs takes its time."""
        screened = float(self._look(looking, at[None])[0].share(self.measure, self.setup)[0])
        if self._long(looking) or agrees(best.share, screened):
            return best
        size = _spacing(axes) / 2.0
        for turn in range(POLISHED):
            if (size < FINEST).all():
                break
            around = [each for each in self._around(at, size) if (np.abs(each - at) > 0.0).sum() == 1]
            with step(turn, POLISHED, "Refined by full simulations"):
                tried = [(self.simulated(each)[0], each) for each in around]
            better = [each for each in tried if self.allows(*each) and each[0].share < best.share]
            if better:
                best, at = min(better, key=lambda each: each[0].share)
            else:
                size = size / 2.0
        return best

    def _long(self, looking: Screen) -> bool:
        """Whether a full run takes so long that few are made."""
        return self.setup.coupling or len(looking.reference.path) > LONG

    def _starts(self, axes: Sequence[FloatArray], share: FloatArray) -> list[FloatArray]:
        """The best places of the coarse map that are no neighbours of a better one."""
        places, spacing = grid(axes), _spacing(axes)
        found: list[FloatArray] = []
        for i in np.argsort(share, kind="stable"):
            if np.isnan(share[i]) or len(found) == STARTS:
                break
            apart = [np.abs(places[i] - other) > 1.5 * spacing for other in found]
            if all(each.any() for each in apart):
                found.append(places[i])
        return found

    def _refined(self, looking: Screen, start: FloatArray, axes: Sequence[FloatArray]) -> FloatArray:
        """A place (4,) none of whose neighbours at the finest steps is better, rounded to what is written."""
        at, size = self._written(start), _spacing(axes) / 2.0
        screened, why = self._look(looking, at[None])
        best = float(screened.share(self.measure, self.setup)[0]) if why[0] == FINE else np.inf
        while (size >= FINEST).any():
            around = np.array(list(self._around(at, size)))
            screened, why = self._look(looking, around)
            share = np.where(why == FINE, screened.share(self.measure, self.setup), np.inf)
            if share.min() < best:
                at, best = around[share.argmin()], float(share.min())
            else:
                size = size / 2.0
        return at

    def _around(self, at: FloatArray, size: FloatArray) -> Iterator[FloatArray]:
        """The neighbours of a place (4,) at steps ``size`` (4,), within the area, in every direction that is free."""
        ways = [[-1.0, 0.0, 1.0] if each > 0.0 else [0.0] for each in self.area.upper - self.area.lower]
        for way in grid([np.array(each) for each in ways]):
            if way.any():
                yield self._written(at + way * size)

    def _written(self, at: FloatArray) -> FloatArray:
        """A place (4,) within the area, rounded where its bounds allow it."""
        return np.clip(np.round(at / WRITTEN) * WRITTEN, self.area.lower, self.area.upper)

    def _compared(self, places: FloatArray, share: FloatArray, why: IntArray) -> tuple[Place, Place]:
        """The median and the worst of the places that are allowed, in full; places that turn out not to be reached
        lose their share."""
        found = []
        for rank in (0.5, 1.0):
            while True:
                order = np.argsort(share, kind="stable")[: int(np.isfinite(share).sum())]
                i = int(order[int(rank * (len(order) - 1))])
                place_, _ = self.simulated(places[i])
                if place_.known or len(order) == 1:
                    break
                share[i], why[i] = np.nan, UNREACHED
            found.append(place_)
        return found[0], found[1]

    def _nowhere(self, places: FloatArray, stands: Standing, why: IntArray) -> SetupError:
        """The refusal where no place is allowed: how many for which reason, and the nearest one."""
        counts = [f"{int((why == code).sum())} {WHY[code]}" for code in WHY if code != FINE and (why == code).any()]
        open_ = np.flatnonzero(why != KEPT_OUT)
        nearest = ""
        if len(open_):
            order = np.lexsort((-np.nan_to_num(stands.room[open_], nan=-9.0), stands.missed[open_]))
            at = places[open_[order[0]]]
            found, _ = self.simulated(at)
            code = int(why[open_[order[0]]])
            words = found.reason or WHY[code]
            if code == NO_ROOM:
                words = f"a joint keeps {format_percent(found.room)} of its half range"
            nearest = f" Nearest is {format_many(at[:3], 'mm', 1)}: {words}."
        return SetupError(
            f"{WHO}: the part fits nowhere in the box; of {format_count(len(places), 'place')} tried "
            f"{', '.join(counts)}.{nearest} Give a larger box, another yaw, or ask for less room."
        )


def _worst_samples(result: SimulationResult) -> list[int]:
    """Samples at which a run is worst, or not reached."""
    verdict = result.verdict
    found = [reading.worst for reading in (verdict.wall, verdict.floor, verdict.feed, verdict.end)]
    found += [result.worst, *np.flatnonzero(result.missed)[:1].tolist()]
    return [i for i in found if i >= 0]


def _spacing(axes: Sequence[FloatArray]) -> FloatArray:
    """(4,) distance of neighbours on each axis; of an axis of one coordinate 0."""
    return np.array([float(np.diff(axis).max()) if len(axis) > 1 else 0.0 for axis in axes])
