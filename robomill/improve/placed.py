"""Places of a part, compared: what a full simulation says of each, and the map that they were found on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomill.arguments import made_by
from robomill.arrays import FloatArray, IntArray
from robomill.frames import Columns
from robomill.improve.area import Area, turned_back
from robomill.improve.screening import Asked, share_of, standing
from robomill.kinematics.transforms import rotation_z, transform
from robomill.lazy import cached_property
from robomill.provenance import Finding, Provenance
from robomill.simulation.judging.verdict_words import Level
from robomill.simulation.mapped import MAP_SPIN
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.units import format_many, format_si, from_si, to_si
from robomill.values import Tabled, Value

FINE, UNREACHED, NO_ROOM, SINGULAR, KEPT_OUT, UNKNOWN = range(6)
WHY = {
    FINE: "",
    UNREACHED: "not reached",
    NO_ROOM: "too close to a joint limit",
    SINGULAR: "close to a singular configuration",
    KEPT_OUT: "meets a keep-out box",
    UNKNOWN: "no deviation is known there",
}


FINEST = np.array([1e-3, 1e-3, 1e-3, to_si(0.25, "deg")])  # m and rad: the last steps of the refinement
GROWN = 0.05  # of the tip's deviation: by how much more is told
MARKED = {"verdict": "walls and floors", "wall": "walls", "floor": "floors", "feed": "what was asked for"}
EDGE, TIP, IN_ROBOT, SCREENED, COUPLED, PARTLY = (
    "place-at-edge",
    "place-tip",
    "force-in-robot",
    "places-screened",
    "places-coupled",
    "places-partly",
)


@made_by("rm.place(setup)")
@dataclass(frozen=True, eq=False, repr=False)
class Place(Value):
    """A place of part zero and what a full simulation says of it.

    zero (3,) m in {M}, yaw rad; ``share`` of the tolerance used by what was asked for; the largest deviation of the
    tip and the readings ``wall`` (left +), ``floor`` (up +) and ``feed``, m; the verdict's level and sentence; room to
    the joint limits (share of the half range) and the smallest |det(J)| as a share of the arm's largest. NaN where the
    path is not reached, and ``reason`` says why.

    Examples
    --------
    >>> import robomill as rm
    >>> placement = rm.place(rm.load_setup("paper_flute"), x_mm=(-200, 200), y_mm=(-1400, -1200), candidates=50)
    >>> placement.now
    <Place 0.0, -1300.0, 2.0 mm, yaw 0.00 deg: 0.251 mm, ok>
    """

    zero: FloatArray
    yaw: float
    share: float
    max_deviation: float
    wall: float
    floor: float
    feed: float
    level: Level
    sentence: str
    room: float
    det: float
    reason: str = ""

    def _said(self) -> str:
        at = f"{format_many(self.zero, 'mm', 1)}, yaw {format_si(self.yaw, 'deg', 2)}"
        return f"{at}: {format_si(self.max_deviation, 'mm', missing='not reached')}, {self.level}"

    @property
    def known(self) -> bool:
        """Whether it can be compared: all of the path is reached, and something is judged."""
        return bool(np.isfinite(self.share))


@made_by("rm.place(setup)")
@dataclass(frozen=True, eq=False, repr=False)
class Placement(Tabled):
    """The best place found, and what it was compared with.

    setup    as it was; ``moved`` is the one with the part at the best place
    measure  what is minimised: one of ``ASKED``
    now, best, median, worst   places, each simulated in full; median and worst of those that are allowed
    axes     x, y, z m and yaw rad of the coarse map; ``keep_out`` (b, 2, 3) m
    share    (nx, ny, nz, nyaw) of the tolerance, screened; NaN where ``why`` (of the same shape) is not 0, see ``WHY``
    screened  how much of the path was looked at everywhere: samples, and all of them
    findings  what a reader of the numbers must know

    Examples
    --------
    >>> import robomill as rm
    >>> placement = rm.place(rm.load_setup("paper_flute"), x_mm=(-300, 300), y_mm=(-1500, -1100), candidates=100)
    >>> placement.best.max_deviation < placement.now.max_deviation
    True
    >>> placement.moved.T_MW[:3, 3].round(4).tolist() == placement.best.zero.tolist()
    True
    """

    setup: SimulationSetup
    measure: Asked
    now: Place
    best: Place
    median: Place
    worst: Place
    axes: tuple[FloatArray, FloatArray, FloatArray, FloatArray]
    keep_out: FloatArray
    share: FloatArray
    why: IntArray
    screened: tuple[int, int]
    findings: tuple[Finding, ...] = ()

    @cached_property
    def moved(self) -> SimulationSetup:
        """The set-up with the part at the best place."""
        R = rotation_z(self.best.yaw) @ turned_back(self.setup)
        said = Provenance("computed", "the best place found for this cut")
        return self.setup.replace(T_MW=transform(R, self.best.zero), provenance={"part": said})

    @property
    def tried(self) -> int:
        """Places of the coarse map."""
        return int(self.why.size)

    @property
    def reached(self) -> int:
        """Those of them at which the arm reaches the path."""
        return int(np.isin(self.why, (FINE, NO_ROOM, SINGULAR, UNKNOWN)).sum())

    @property
    def allowed(self) -> int:
        """Those of them that were compared."""
        return int((self.why == FINE).sum())

    @cached_property
    def plane(self) -> FloatArray:
        """(nx, ny) share of the tolerance at the best height and yaw of each point; NaN where none is allowed."""
        share = np.where(np.isnan(self.share), np.inf, self.share).min(axis=(2, 3))
        return np.where(np.isinf(share), np.nan, share)

    def columns(self) -> Columns:
        """One row a place of the coarse map: where, the share of the tolerance there, and why it is none."""
        x, y, z, yaw = (found.ravel() for found in np.meshgrid(*self.axes, indexing="ij"))
        return {
            "x_mm": from_si(x, "mm"),
            "y_mm": from_si(y, "mm"),
            "z_mm": from_si(z, "mm"),
            "yaw_deg": from_si(yaw, "deg"),
            "share": self.share.ravel(),
            "why": np.array([WHY[code] for code in range(len(WHY))])[self.why.ravel()],
        }

    def _said(self) -> str:
        now, best = (format_si(each.max_deviation, "mm", missing="not reached") for each in (self.now, self.best))
        return f"{self.setup.name}: {now} here, {best} at {format_many(self.best.zero, 'mm', 1)}"

    def _facts(self) -> list[tuple[str, str]]:
        named = (("Now", self.now), ("Best", self.best), ("Median", self.median), ("Worst", self.worst))
        said = [(name, each._said()) for name, each in named]
        return [*said, ("Places", f"{self.allowed} allowed, {self.reached} reached, {self.tried} tried")]


def errors_of(result: SimulationResult) -> dict[str, float]:
    """m: the largest errors of a run by their names, as ``share_of`` takes them; NaN where there are none."""
    verdict = result.verdict
    named = {name: abs(getattr(verdict, name).value) for name in ("wall", "floor", "feed", "end")}
    return named | {"tip": result.max_deviation}


def place_of(result: SimulationResult, at: FloatArray, measure: Asked) -> Place:
    """What a run says of the place (4,) it was made at."""
    verdict, stands = result.verdict, standing(result.ik)
    missed = bool(result.missed.any())
    errors = {name: np.array(value) for name, value in errors_of(result).items()}
    reason = ""
    if missed:
        lost = int(np.flatnonzero(result.missed)[0])
        outside = "outside the measured map, or the tool stands off its axis"
        reason = f"{result.path.block_name} {result.path.block[lost]}: {result.ik.reason(lost) or outside}"
    nan = float("nan")
    return Place(
        zero=at[:3].copy(),
        yaw=float(at[3]),
        share=nan if missed else float(share_of(measure, result.setup, errors)),
        max_deviation=nan if missed else result.max_deviation,
        wall=nan if missed else verdict.wall.value,
        floor=nan if missed else verdict.floor.value,
        feed=nan if missed else verdict.feed.value,
        level=verdict.level,
        sentence=verdict.sentence,
        room=float(stands.room),
        det=float(stands.det),
        reason=reason,
    )


def findings(found: Placement, where: Area, result: SimulationResult) -> tuple[Finding, ...]:
    """What a reader of the numbers must know."""
    said = list(where.doubts)
    setup, at = found.setup, np.append(found.best.zero, found.best.yaw)
    around = where.upper[3] - where.lower[3] >= 2.0 * np.pi - 1e-9
    free = (where.upper > where.lower) & ~np.array([False, False, False, around])
    on_edge = free & ((at - where.lower < FINEST) | (where.upper - at < FINEST))
    if on_edge.any():
        names = " and ".join(name for name, there in zip(("x", "y", "z", "yaw"), on_edge, strict=True) if there)
        text = f"The best place lies at the edge of the box in {names}: a larger one may hold a better one."
        said.append(Finding("info", text, code=EDGE))
    grown = found.best.max_deviation - found.now.max_deviation
    if found.measure != "tip" and grown > GROWN * found.now.max_deviation:
        sizes = [format_si(each.max_deviation, "mm") for each in (found.now, found.best)]
        text = (
            f"The tip itself strays further there, {sizes[1]} instead of {sizes[0]}, where that leaves no mark on "
            f"{MARKED[found.measure]}; measure='tip' minimises it."
        )
        said.append(Finding("info", text, code=TIP))
    if setup.force.frame == "M" and not setup.force.turns_with_part and free[3]:
        text = (
            "The force is fixed in the robot's axes: at every yaw it is the same, and only the walls turn against it; "
            "a force that the cut makes would turn with the part."
        )
        said.append(Finding("warning", text, code=IN_ROBOT))
    said += [note for note in result.notes if note.code == MAP_SPIN]  # another place or yaw is another turn of the tool
    if setup.coupling:
        text = "The map is without the coupling of force and deflection; now, best, median and worst are with it."
        said.append(Finding("info", text, code=COUPLED))
    if found.screened[0] < found.screened[1]:
        few, all_ = found.screened
        text = (
            f"The map looks at {few} of {all_} samples of the path; now, best, median and worst are full "
            "simulations of all."
        )
        said.append(Finding("info", text, code=SCREENED))
    if result.not_judged.any():
        text = "Some of the cut is not judged; places are compared by the rest."
        said.append(Finding("warning", text, code=PARTLY))
    return tuple(said)
