"""What a caliper or a CMM would say of a groove: profiles along it, best fit, comparison with a measurement."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, as_floats, frozen
from robomill.errors import SurfaceError
from robomill.surface.sections.groove import GrooveSection
from robomill.units import format_si


@dataclass(frozen=True, eq=False)
class GrooveProfile:
    """Sections along a groove as arrays (q,): station m, centre_offset m, floor_error m, width m, depth m.

    NaN where a section could not be measured; ``missing`` counts them.
    """

    station: FloatArray
    centre_offset: FloatArray
    floor_error: FloatArray
    width: FloatArray
    depth: FloatArray

    @property
    def missing(self) -> int:
        """Sections without a centre offset."""
        return int(np.isnan(self.centre_offset).sum())


def groove_profile(sections: Sequence[GrooveSection]) -> GrooveProfile:
    """The sections' numbers as arrays, in the order of their stations."""
    ordered = sorted(sections, key=lambda section: section.station)
    names = ("station", "centre_offset", "floor_error", "width", "depth")
    return GrooveProfile(*(frozen([getattr(section, name) for section in ordered]) for name in names))


@dataclass(frozen=True, eq=False)
class LineFit:
    """Best straight line through a profile: what is a shift, what is a turn, and what is left as form.

    offset    m    at the middle of the measured stations: what re-zeroing the part removes
    rotation  rad  what turning the part removes
    residual  (q,) m, NaN where not measured
    form_error m   range of the residual (straightness)
    rms        m   of the residual
    """

    offset: float
    rotation: float
    residual: FloatArray
    form_error: float
    rms: float


@dataclass(frozen=True, eq=False)
class GrooveFit:
    """The groove's best fit: sideways (its middle line) and in depth (its floor)."""

    side: LineFit
    floor: LineFit


def fit_line(station: ArrayLike, value: ArrayLike) -> LineFit:
    """Least-squares line through value (q,) m over station (q,) m; NaN are left out. Needs three points."""
    s, v = as_floats(station, "stations", (None,)), as_floats(value, "profile", (None,), finite=False)
    known = np.isfinite(v)
    if known.sum() < 3 or np.ptp(s[known]) <= 0:
        raise SurfaceError(
            f"Best fit of the groove: found {int(known.sum())} measured sections; it needs three at different stations."
        )
    middle = float(s[known].mean())
    rotation, offset = np.polyfit(s[known] - middle, v[known], 1)
    residual = v - (offset + rotation * (s - middle))
    left = residual[known]
    return LineFit(
        float(offset),
        float(np.arctan(rotation)),
        frozen(residual),
        float(np.ptp(left)),
        float(np.sqrt(np.mean(left**2))),
    )


def fit_groove(profile: GrooveProfile) -> GrooveFit:
    """Separate the groove's constant shift and turn from its form error. For one straight groove."""
    return GrooveFit(fit_line(profile.station, profile.centre_offset), fit_line(profile.station, profile.floor_error))


@dataclass(frozen=True, eq=False)
class ProfileComparison:
    """A measured profile over the predicted one, at the measured stations inside the predicted range.

    station, measured, predicted, difference (q,) m, difference = predicted - measured; mean, rms and largest
    difference (m); ``explained`` is the share of the measured mean that the prediction gives (1: all of it).
    """

    station: FloatArray
    measured: FloatArray
    predicted: FloatArray
    difference: FloatArray
    mean: float
    rms: float
    largest: float
    explained: float
    outside: int


def compare_profile(profile: GrooveProfile, station: ArrayLike, measured: ArrayLike) -> ProfileComparison:
    """Prediction's error against a measured centre offset (q,) m at stations (q,) m (linear between sections).

    Measured stations outside the predicted ones are counted, not guessed. Raises SurfaceError if none is inside.
    """
    s = as_floats(station, "measured stations", (None,), error=SurfaceError)
    v = as_floats(measured, "measured profile", (len(s),), error=SurfaceError)
    known = np.isfinite(profile.centre_offset)
    if not known.any():
        raise SurfaceError("Comparison: no section of the predicted groove could be measured.")
    low, high = profile.station[known][[0, -1]]
    inside = (s >= low - 1e-9) & (s <= high + 1e-9)
    if not inside.any():
        raise SurfaceError(
            f"Comparison: the measured stations run from {format_si(s.min(), 'mm')} to {format_si(s.max(), 'mm')},"
            f" the predicted groove from {format_si(low, 'mm')} to {format_si(high, 'mm')}; they must overlap."
        )
    s, v = s[inside], v[inside]
    predicted = np.interp(s, profile.station[known], profile.centre_offset[known])
    difference = predicted - v
    mean = float(v.mean())
    return ProfileComparison(
        frozen(s),
        frozen(v),
        frozen(predicted),
        frozen(difference),
        float(difference.mean()),
        float(np.sqrt(np.mean(difference**2))),
        float(difference[np.argmax(np.abs(difference))]),
        float(predicted.mean() / mean) if mean != 0.0 else float("nan"),
        int((~inside).sum()),
    )
