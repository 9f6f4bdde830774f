"""Turning the spindle about its axis, which six and seven axes leave free: what it changes along a path, and the best
course of the spin."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from robomill.arguments import asked, made_by
from robomill.arrays import BoolArray, FloatArray
from robomill.errors import SetupError
from robomill.frames import Columns
from robomill.improve.area import today
from robomill.improve.judged import check_improvable, check_joints_known
from robomill.improve.map_check import LONG, agrees
from robomill.improve.placed import Place, place_of
from robomill.improve.screening import ASKED, MOST_SAMPLES, Asked, Screen, screen, uncoupled
from robomill.improve.spin_course import best_course
from robomill.kinematics.choice import every, overshoot, spun, turn as within
from robomill.kinematics.decoupled import LIMIT_SLACK, decoupled
from robomill.kinematics.dexterity import NEAR, determinant, largest_determinant
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.spin import spin_matters
from robomill.kinematics.steadiness import hasty_turns
from robomill.lazy import cached_property
from robomill.progress import step
from robomill.provenance import Finding
from robomill.quantities import Quantity
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import along, simulate
from robomill.simulation.setup import SimulationSetup
from robomill.spelled import one_of
from robomill.units import format_percent, format_si, from_si, to_si
from robomill.values import Tabled

WHO = "Spindle"
ANGLES = 72
RATE = to_si(1.0, "deg/mm")  # how fast the spin may change along the path
SAME = 1e-6  # of a share: what differs by no more is the same
TRIED, COARSE = 3, 3  # constant spins that are simulated in full; every third where the map is off, then those near
RATE_ASKED = Quantity("rate", "deg/mm", name="rate", key="rate_deg_mm", above=0.0)
_Try = tuple[Place, SimulationResult, float]
ONE_SPIN, NOT_TAKEN, HASTE = "spin-course", "spin-not-taken", "spin-haste"


@made_by("rm.turn(setup)")
@dataclass(frozen=True, eq=False, repr=False)
class Turning(Tabled):
    """What the turn of the tool about its axis does along a path, and the best course of it.

    ``now``, ``constant`` and ``course`` are full simulations: as it is, at the best ``spin`` (rad) for the whole path,
    and along the course, at one part zero. ``angle`` (a,) rad and ``station`` (s,) m are the axes of the map, spin and
    way of the tool; ``share`` (s, a) of the tolerance and ``deviation`` (s, a) m of the tip are NaN beyond the limits
    and close to singular configurations. ``way`` (m,) m and ``turn`` (m,) rad are the course, spin by the way of the
    tool, which changes by at most ``rate`` rad/m. ``findings`` are what a reader of the numbers must know.

    ``turned`` is the set-up with the best constant spin; a set-up holds no course, which is for the controller.

    Examples
    --------
    >>> import robomill as rm
    >>> found = rm.turn(rm.load_setup("paper_flute").replace(robot=rm.load_robot("fanuc_r2000ic")))
    >>> found.course.share <= found.constant.share <= found.now.share
    True
    """

    setup: SimulationSetup
    measure: Asked
    now: Place
    constant: Place
    course: Place
    spin: float
    angle: FloatArray
    station: FloatArray
    share: FloatArray
    deviation: FloatArray
    way: FloatArray
    turn: FloatArray
    rate: float
    findings: tuple[Finding, ...] = ()

    @cached_property
    def turned(self) -> SimulationSetup:
        """The set-up with the best constant spin."""
        return self.setup.replace(spin=self.spin)

    def columns(self) -> Columns:
        """The course: spin by the way of the tool."""
        return {"way_mm": from_si(self.way, "mm"), "spin_deg": from_si(self.turn, "deg")}

    def _said(self) -> str:
        named = (("now", self.now), (f"at {format_si(self.spin, 'deg', 0)}", self.constant), ("turning", self.course))
        said = ", ".join(f"{format_si(each.max_deviation, 'mm', missing='not reached')} {name}" for name, each in named)
        return f"{self.setup.name}: {said}"


@asked
def turn(
    setup: SimulationSetup,
    *,
    measure: Asked = "verdict",
    rate: float | None = None,
    rate_deg_mm: float | None = None,
) -> Turning:
    """How the tool should be turned about its axis along a path, on arms of six and seven axes.

    Parameters
    ----------
    setup : SimulationSetup
        The cut; its spin is "now".
    measure : str
        What is made small, as of ``place``: "verdict", "wall", "floor", "tip" or "feed".
    rate, rate_deg_mm : float, rad/m, or degrees a mm
        How much the spin may change along the way of the tool; 1 degree a mm where it is left out.

    Returns
    -------
    Turning
        A map of the path against the spin, the best constant spin and the best course, before and after.

    Raises
    ------
    SetupError
        Where nothing is left to turn: arms of up to five axes, and tools that lie along the last axis; where a measured
        map is in force, which holds for one turn.

    Notes
    -----
    The course is found by dynamic programming over 72 angles and both sides of the wrist, of which none is left on the
    way; shoulder and elbow stand as in a run. By the map its largest share is the least there is at this rate. It is
    checked by inverse kinematics and a full simulation along the interpolated course, and not taken where that shows it
    to be no better than one spin (at a corner the map knows one spin for both cuts); without the coupling of force and
    deflection.

    Examples
    --------
    >>> import robomill as rm
    >>> found = rm.turn(rm.load_setup("paper_flute").replace(robot=rm.load_robot("fanuc_r2000ic"), step_mm=10))
    >>> found.constant.share <= found.now.share
    True
    """
    check_improvable(setup)
    if setup.robot.n < 6:
        raise SetupError(f"{WHO}: an arm of {setup.robot.n} joints holds the tool in one way; nothing is left to turn.")
    if not spin_matters(setup.robot):
        raise SetupError(
            f"{WHO}: the tool lies along the last axis, which turns it and moves nothing else; nothing is left to turn."
        )
    check_joints_known(setup, "to turn the spindle")  # a map is that of one turn, and the same at every other
    if measure not in ASKED:
        raise SetupError(f"{WHO}, measure: found {measure!r:.40}; expected {', '.join(ASKED)}.", where="measure")
    most = one_of(RATE_ASKED, rate, rate_deg_mm, SetupError, WHO, default=RATE)
    return _Turned(uncoupled(setup), measure, RATE_ASKED.settled(most, SetupError, WHO)).run(setup)


@dataclass(frozen=True, eq=False)
class _Turned:
    """A cut without coupling, what is asked of it, and the bound on the rate."""

    setup: SimulationSetup
    measure: Asked
    rate: float

    def run(self, asked_of: SimulationSetup) -> Turning:
        now, base = self._simulated(self.setup)
        angle = np.asarray(2.0 * np.pi / ANGLES * np.arange(ANGLES), dtype=np.float64)
        reference = base if now.known else self._reached(angle)
        looking = screen(reference, most=MOST_SAMPLES)
        cost, deviation = self._map(looking, angle)
        share = cost.min(axis=2)
        constant, spin, result = self._constant(cost, angle, now, base)
        way = np.cumsum(reference.path.step_length)
        turned, course = self._course(looking, cost, angle, way), constant
        said: list[Finding] = []
        if turned is None:
            said.append(
                Finding("info", "No course of the spin leads along the whole path at this rate.", code=ONE_SPIN)
            )
        else:
            after = along(self.setup, result.path, spin=turned)
            found = place_of(after, today(self.setup), self.measure)
            haste = hasty_turns(after.ik)
            if haste:
                said.append(Finding("warning", f"Along the course {haste[0].sentence()}", code=HASTE))
            if found.known and found.share < constant.share and not haste:
                course = found
            else:
                turned = None
                said.append(_no_better(found, constant))
        turned = np.full(len(way), spin) if turned is None else turned
        known = np.isfinite(share)
        return Turning(
            setup=asked_of,
            measure=self.measure,
            now=now,
            constant=constant,
            course=course,
            spin=spin,
            angle=angle,
            station=way[looking.at],
            share=np.where(known, share, np.nan),
            deviation=np.where(known, deviation, np.nan),
            way=way,
            turn=turned,
            rate=self.rate,
            findings=tuple(said),
        )

    def _simulated(self, setup: SimulationSetup) -> tuple[Place, SimulationResult]:
        result = simulate(setup)
        return place_of(result, today(setup), self.measure), result

    def _reached(self, angle: FloatArray) -> SimulationResult:
        """A run at a spin at which all of the path is reached."""
        for k, each in enumerate(angle[:: ANGLES // 24]):
            with step(k, 24, "A spin that reaches the path"):
                found, result = self._simulated(self.setup.replace(spin=float(each)))
            if found.known:
                return result
        raise SetupError(f"{WHO}: no spin reaches all of the path. {found.reason}")

    def _map(self, looking: Screen, angle: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(s, a, b) share of the tolerance at every sample, spin and branch, infinite where the arm cannot stand, and
        (s, a) m deviation of the tip in the best branch."""
        robot = self.setup.robot
        shares, tips = [], []
        for k, each in enumerate(angle):
            with step(k, len(angle), "Spins tried"):
                T_MT = spun(self.setup.T_MW @ looking.T_WT, float(each))
                theta, possible = self._standings(looking, T_MT)
                det = np.abs(determinant(robot, theta)) / largest_determinant(robot)
                T_MW = np.broadcast_to(self.setup.T_MW, (theta.shape[0], 4, 4))
                d = looking.in_cut(T_MW, np.where(possible[..., None], theta, np.nan))
                share = looking.shares(self.measure, d)
            shares.append(np.where(possible & (det > NEAR) & np.isfinite(share), share, np.inf))
            tips.append(np.linalg.norm(d, axis=-1))
        cost = np.stack(shares, axis=0).transpose(2, 0, 1)
        tip = np.stack(tips, axis=0).transpose(2, 0, 1)
        return cost, np.take_along_axis(tip, cost.argmin(axis=2)[..., None], axis=2)[..., 0]

    def _standings(self, looking: Screen, T_MT: FloatArray) -> tuple[FloatArray, BoolArray]:
        """(b, s, n) configurations for poses (s, 4, 4), and whether they are within limits (b, s): with shoulder and
        elbow as a run has them, and both sides of the wrist."""
        robot, arm = self.setup.robot, decoupled(self.setup.robot)
        if arm is None:
            ik = inverse_kinematics(robot, T_MT, near="path", spin="fixed")
            return ik.theta[None], ik.reached[None]
        theta, sound = every(robot, arm, T_MT)
        theta = within(robot, theta, robot.home)
        inside = (np.abs(overshoot(robot, theta)) <= LIMIT_SLACK).all(axis=-1)
        index = looking.reference.ik.branch_index
        same = np.arange(8) // 2 == np.bincount(index[index >= 0] // 2, minlength=4).argmax()
        return theta[:, same].transpose(1, 0, 2), (sound & inside)[:, same].T

    def _constant(
        self, cost: FloatArray, angle: FloatArray, now: Place, base: SimulationResult
    ) -> tuple[Place, float, SimulationResult]:
        """The best spin for the whole path by full simulations; today's where no other is better."""
        largest = cost.max(axis=0).min(axis=1)
        best_first = [int(k) for k in np.argsort(largest, kind="stable")[:TRIED] if np.isfinite(largest[k])]
        tried = self._tried(best_first, angle, {})
        if now.known:
            chosen = base.ik.spin
            tried[-1] = (now, base, 0.0 if chosen is None else float(chosen[0]))
        off = any(tried[k][0].known and not agrees(tried[k][0].share, largest[k]) for k in best_first)
        if off and len(base.path) <= LONG:  # as at corners: then one does not go by the map
            tried = self._tried(range(0, ANGLES, COARSE), angle, tried)
            known = [k for k, each in tried.items() if k >= 0 and each[0].known and each[0].det > NEAR]
            near = min(known, key=lambda k: tried[k][0].share, default=0)
            tried = self._tried([(near + k) % ANGLES for k in range(1 - COARSE, COARSE)], angle, tried)
        sound = [each for k, each in tried.items() if each[0].known and (k in (-1, *best_first) or each[0].det > NEAR)]
        if not sound:
            raise SetupError(f"{WHO}: no spin reaches all of the path with room to singular configurations.")
        place, result, spin = min(sound, key=lambda each: each[0].share)
        return place, spin, result

    def _tried(self, numbers: Iterable[int], angle: FloatArray, tried: dict[int, _Try]) -> dict[int, _Try]:
        """``tried`` with the spins ``angle`` of these numbers, by full simulations."""
        fresh = [k for k in numbers if k not in tried]
        found = dict(tried)
        for n, k in enumerate(fresh):
            with step(n, len(fresh), "Spins by full simulations"):
                found[k] = (*self._simulated(self.setup.replace(spin=float(angle[k]))), float(angle[k]))
        return found

    def _course(self, looking: Screen, cost: FloatArray, angle: FloatArray, way: FloatArray) -> FloatArray | None:
        """(m,) rad spin at every sample of the path; None where no course leads through."""
        size = float(angle[1])
        apart = size / self.rate  # the way in which the spin may change by one angle
        stage = np.floor(way[looking.at] / apart).astype(np.int64)
        numbers, which = np.unique(stage, return_inverse=True)
        worst = np.zeros((len(numbers), *cost.shape[1:]))
        np.maximum.at(worst, which.ravel(), cost)
        chosen, _ = best_course(worst, np.diff(numbers))
        if chosen[0] < 0:
            return None
        whole = np.unwrap(angle[chosen])
        return np.interp(way, (numbers + 0.5) * apart, whole)


def _no_better(course: Place, constant: Place) -> Finding:
    """That one spin stays: since the best course is none better, or since it only looked so on the map."""
    used = [format_percent(each.share) for each in (course, constant)]
    if not course.known:
        why = f"does not hold in a full simulation: {course.reason}"
    elif course.share > constant.share * (1.0 + SAME):
        why = f"uses {used[0]} of the tolerance in a full simulation, one spin for all {used[1]}"
    elif course.share < constant.share * (1.0 - SAME):
        why = f"uses {used[0]} of the tolerance instead of {used[1]}, and asks too much of a joint"
    else:
        return Finding("info", "No course of the spin is better than one spin for all.", code=ONE_SPIN)
    text = f"The course of the spin that looks best on the map {why}: one spin stays. Another course may be better."
    return Finding("info", text, code=NOT_TAKEN)
