"""Measured force: a record over time or path length, low-pass filtered without phase shift and laid on the path."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar, Literal, Self, get_args

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asked, asking
from robomill.arrays import FloatArray, as_floats, frozen, of_kind
from robomill.cutting.conditions import CutConditions
from robomill.cutting.force import ForceModel, Frame
from robomill.errors import CuttingError
from robomill.provenance import Finding, Kind, Provenance
from robomill.quantities import quantity
from robomill.units import format_count, format_si
from robomill.values import Said, Value

Axis = Literal["time", "path"]
RecordFrame = Literal["path", "M", "W"]
AXIS_UNITS: dict[Axis, str] = {"time": "s", "path": "mm"}
#: Cut-off of the paper's dynamometer filter, Hz (its milling test, section 5).
PAPER_CUTOFF = 50.0
#: Order of the Butterworth filter; run forwards and backwards it has twice that and no phase.
ORDER = 2
FEWEST = 4
FROM_ARRAYS = "force from arrays"
ROUNDING = 1e-6  # of a rate: instants written with a few digits are not spaced alike
SLIPPED = 100.0  # times the length cut: such a record over length was hardly given in m
LEFT_OVER = 0.2  # of a record over time: that much behind the last cut is suspected


@asking
@dataclass(frozen=True, eq=False, repr=False)
class ForceRecord(Said, Value):
    """Force ON the tool against time (s), or length (m) of path at feed from its start, rapids left out.

    x (k,) strictly increasing, F (k, 3) N in ``frame``: feed, feed-normal, axial ("path"); x, y, z of the robot ("M"),
    or of the part, where the sensor turns with it ("W"). Time counts from the first cut on, rapids and dwells included.
    Raises CuttingError for shapes that differ or an x that does not increase.

    Examples
    --------
    >>> import robomill as rm
    >>> t = [0.0, 0.1, 0.2, 0.3]
    >>> rm.ForceRecord(t, [[10.0, 20.0, -5.0]] * 4, "time", "path", "dynamometer").rate
    10.0
    """

    x: FloatArray
    F: FloatArray
    axis: Axis = "time"
    frame: RecordFrame = "path"
    source: str = "measured force"
    notes: tuple[str, ...] = ()
    kind: Kind = field(default="measured", compare=False)

    def _said(self) -> str:
        length = format_si(float(self.x[-1] - self.x[0]), AXIS_UNITS[self.axis])
        return f"{self.source}: {format_count(len(self.x), 'sample')} over {length}"

    def __post_init__(self) -> None:
        for name, known in (("axis", get_args(Axis)), ("frame", get_args(RecordFrame))):
            if getattr(self, name) not in known:
                expected, found = " or ".join(map(repr, known)), getattr(self, name)
                raise CuttingError(f"{self.source}: {name} is {found!r:.40}; expected {expected}.", where=name)
        x = as_floats(self.x, f"{self.source}, {self.axis}", (None,), error=CuttingError)
        F = as_floats(self.F, f"{self.source}, force (N)", (len(x), 3), error=CuttingError)
        if x.ndim != 1 or F.ndim != 2 or len(x) < FEWEST:
            raise CuttingError(f"{self.source}: found {len(x)} samples; a record needs at least {FEWEST}.")
        if (np.diff(x) <= 0.0).any():
            raise CuttingError(f"{self.source}: the {self.axis} does not increase at sample {np.diff(x).argmin() + 1}.")
        object.__setattr__(self, "x", frozen(x))
        object.__setattr__(self, "F", frozen(F))

    @property
    def rate(self) -> float:
        """Samples per second (per metre for a path record), from the median spacing."""
        return float(1.0 / np.median(np.diff(self.x)))

    def low_pass(self, cutoff: float) -> ForceRecord:
        """Without what oscillates faster than ``cutoff`` (Hz, or 1/m for a path record); evenly spaced, mean kept.

        Butterworth run forwards and backwards, so that nothing is shifted along the path; the gain at the cut-off is
        one half. Raises CuttingError where the record is sampled too slowly for it.
        """
        if not cutoff > 0.0:
            raise CuttingError(f"{self.source}: cut-off {cutoff:g}; it must be greater than 0.", where="cutoff")
        if self.rate <= 2.0 * cutoff * (1.0 + ROUNDING):
            unit = "per second" if self.axis == "time" else "per metre"
            raise CuttingError(
                f"{self.source}: {self.rate:.4g} samples {unit} are too few to filter at {cutoff:.4g} {unit}; "
                f"it takes more than {2.0 * cutoff:.4g} (another unit of {self.axis}?), or leave the filter out "
                "(cutoff_Hz = 0 in a file).",
                where="cutoff",
            )
        from scipy.signal import butter, sosfiltfilt

        even = np.linspace(self.x[0], self.x[-1], round((self.x[-1] - self.x[0]) * self.rate) + 1)
        F = np.stack([np.interp(even, self.x, column) for column in self.F.T], axis=1)
        rate = (len(even) - 1) / (even[-1] - even[0])
        sections = butter(ORDER, cutoff, fs=rate, output="sos")
        # The ends are mirrored over about one period of the cut-off, as far as the record goes.
        pad = min(len(even) - 1, max(3 * ORDER, round(rate / cutoff)))
        return replace(self, x=even, F=sosfiltfilt(sections, F, axis=0, padlen=pad))


@asking
@dataclass(frozen=True, eq=False, repr=False)
class MeasuredForce(ForceModel):
    """A record laid on the path. ``start`` is the record's time (s) or path length (m) at the start of the first cut.

    ``cutoff`` (Hz, None for no filter) applies in time; a path record is filtered at cutoff / feed, with the median
    feed of the cut, if it has samples enough for anything faster.

    Examples
    --------
    >>> import robomill as rm
    >>> force = rm.MeasuredForce.over_time([0.0, 0.1, 0.2, 0.3], [[10.0, 20.0, -5.0]] * 4)
    >>> force.in_time
    True
    """

    kind: ClassVar[str] = "measured"
    title: ClassVar[str] = "Measured, from a CSV file"
    rank: ClassVar[int] = 5
    ends_with_material: ClassVar[bool] = False
    stated: ClassVar[bool] = False
    of_milling: ClassVar[bool] = False

    record: ForceRecord
    cutoff: float | None = quantity(
        "Low-pass cut-off",
        "Hz",
        default=PAPER_CUTOFF,
        optional=True,
        above=0.0,
        written_none=0.0,
        boxed=False,
    )
    start: float = quantity("Path starts at", default=0.0, digits=3, boxed=False)
    R_MW: FloatArray = field(default_factory=lambda: np.eye(3))

    def __post_init__(self) -> None:
        of_kind(self.record, ForceRecord, "record", 'rm.read_forces("force.csv") or rm.ForceRecord(...)', CuttingError)
        super().__post_init__()

    @classmethod
    @asked
    def over_time(
        cls,
        t: ArrayLike,
        F: ArrayLike,
        *,
        frame: RecordFrame = "path",
        cutoff: float | None = None,
        start: float = 0.0,
        source: str = FROM_ARRAYS,
    ) -> MeasuredForce:
        """Forces ON the tool F (k, 3) N at the times t (k,) s, which count from the first cut on.

        ``frame`` is "path" (feed, feed-normal, axial), "M" (x, y, z of the robot) or "W" (of the part); ``cutoff`` Hz
        of a low-pass, None for none; ``start`` s of the record at which the first cut begins. Raises CuttingError.
        """
        return cls(ForceRecord(t, F, "time", frame, source, kind="user"), cutoff, start)  # type: ignore[arg-type]

    @classmethod
    @asked
    def along_path(
        cls, s: ArrayLike, F: ArrayLike, *, frame: RecordFrame = "path", start: float = 0.0, source: str = FROM_ARRAYS
    ) -> MeasuredForce:
        """Forces ON the tool F (k, 3) N at the lengths s (k,) m of path at feed; ``start`` m of it at the first cut.

        ``frame`` as in ``over_time``. Raises CuttingError.
        """
        return cls(ForceRecord(s, F, "path", frame, source, kind="user"), None, start)  # type: ignore[arg-type]

    @property
    def numbers(self) -> str:
        """The record and its filter."""
        return self.provenance.source

    @property
    def start_unit(self) -> str:
        """The unit in which people say the start: that of the record's axis."""
        return AXIS_UNITS[self.record.axis]

    @property
    def frame(self) -> Frame:
        """Axes of ``components``: a record in the part's axes is turned into the robot's."""
        return "path" if self.record.frame == "path" else "M"

    @property
    def in_time(self) -> bool:
        """Whether the record runs over time."""
        return self.record.axis == "time"

    @property
    def turns_with_part(self) -> bool:
        """Whether the sensor sat on the part."""
        return self.record.frame == "W"

    def placed(self, R_MW: FloatArray) -> Self:
        """With the axes of the part in {M}, which matter to a record in them."""
        return self if np.array_equal(R_MW, self.R_MW) else replace(self, R_MW=frozen(R_MW))

    @property
    def provenance(self) -> Provenance:
        """Measured, from the record's source."""
        filtered = f", low-pass {self.cutoff:g} Hz, zero phase" if self.cutoff is not None else ", unfiltered"
        return Provenance(self.record.kind, self.record.source + filtered)

    @property
    def notes(self) -> tuple[str, ...]:
        """What the reader noticed."""
        return self.record.notes

    def findings(self, conditions: CutConditions) -> tuple[Finding, ...]:
        """What the reader noticed; of a record over time where it is taken to begin, and whether much is left of it."""
        found, record = super().findings(conditions), self.record
        if not conditions.cutting.any():
            return found
        if self._coarse(conditions):
            text = (
                "Force: at this feed the record has too few samples for anything faster than its cut-off, so it is "
                "used as it is, without a filter."
            )
            found += (Finding("info", text, code="record-unfiltered"),)
        unit, along = self.start_unit, conditions.t if self.in_time else conditions.s
        began, last = (format_si(v, unit, 3) for v in (self.start, record.x[-1]))
        if self.in_time:
            text = f"the first cut is taken to begin at {began} of the force record; moves before it are no part of it."
            found += (Finding("info", text, int(conditions.block[np.argmax(conditions.cutting)]), code="record-start"),)
        ends = float(along[conditions.cutting].max()) + self.start
        rest = record.x[-1] - ends
        if rest > LEFT_OVER * (record.x[-1] - record.x[0]) if self.in_time else rest > SLIPPED * ends > 0.0:
            asked = "at this feed, and does it begin with the first cut" if self.in_time else "and is its length in m"
            text = (
                f"Force: the record goes on to {last}, the last cut ends at {format_si(ends, unit, 3)}: is it of this "
                f"program, {asked}?"
            )
            found += (Finding("suspicious", text, code="record-longer"),)
        return found

    def components(self, conditions: CutConditions) -> FloatArray:
        """Force ON the tool (m, 3) N, interpolated at every step; 0 on rapids.

        Raises CuttingError where the path cuts before the record starts or after it ends (by more than a sample).
        """
        record = self.record
        at = (conditions.t if record.axis == "time" else conditions.s) + self.start
        cut = at[conditions.cutting]
        if not cut.size:
            return np.zeros((len(conditions), 3))
        slack = 1.0 / record.rate
        if cut.min() < record.x[0] - slack or cut.max() > record.x[-1] + slack:
            unit = AXIS_UNITS[record.axis]
            low, high, first, last = (
                format_si(float(v), unit, 3) for v in (cut.min(), cut.max(), record.x[0], record.x[-1])
            )
            raise CuttingError(
                f"{record.source}: the path cuts from {low} to {high}, the record holds {first} to {last}; "
                "record the whole cut or set where the path starts in it.",
                where="start",
            )
        if self.cutoff is not None and not self._coarse(conditions):
            record = record.low_pass(self.cutoff / self._speed(conditions))
        F = np.stack([np.interp(at, record.x, column) for column in record.F.T], axis=1)
        if record.frame == "W":
            F = F @ self.R_MW.T
        return np.where(conditions.cutting[:, None], F, 0.0)

    def _coarse(self, conditions: CutConditions) -> bool:
        """Whether a record over path length has too few samples for anything faster than the cut-off: then nothing is
        to be filtered. (Of a record over time that is a slip: seconds in place of milliseconds.)"""
        if self.in_time or self.cutoff is None:
            return False
        return self.record.rate <= 2.0 * self.cutoff / self._speed(conditions) * (1.0 + ROUNDING)

    def _speed(self, conditions: CutConditions) -> float:
        """What turns Hz into the record's own frequency: 1, or the feed for a record over path length."""
        if self.record.axis == "time":
            return 1.0
        feed = float(np.median(conditions.v_f[conditions.cutting]))
        if feed <= 0.0:
            raise CuttingError(f"{self.record.source}: the feed is 0, so a cut-off in Hz has no length; give a feed.")
        return feed
