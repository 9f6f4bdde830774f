"""How sure the compliances in force are, in words and pictures: the bands that follow from an identification."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from robomill.identification.fit.confidence import LEVEL
from robomill.identification.knowledge import Knowledge
from robomill.identification.propagation import SOURCES
from robomill.simulation.band import deviation_band, size_band, worst_half
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.ui import session
from robomill.units import format_many, format_si, from_si, in_lengths
from robomill.viz.along import add_band

if TYPE_CHECKING:
    from robomill.viz.chart import Chart


def tile_text(result: SimulationResult, unit: str = "mm") -> str:
    """The largest deviation with its 95 % band, "0.26 ± 0.01 mm"; "" where the compliances are taken as certain."""
    half = worst_half(result, session.known(result.setup))
    return band_text(result.max_deviation, half, unit) if np.isfinite(half) else ""


def band_text(value: float, half: float, unit: str) -> str:
    """A value with its half width (m), to the digit that the half width allows."""
    return format_many((value, half), unit, band_digits(half), " ± ")


def band_digits(half: float) -> int:
    """Decimals of a millimetre that show a half width (m) to at least one digit, 2 to 4."""
    size = float(from_si(half, "mm"))
    needed = int(np.ceil(-np.log10(size) - 0.3)) if size > 0 else 4
    return min(max(needed, 2), 4)


def banded(fig: Chart, result: SimulationResult, unit: str, *, dark: bool) -> bool:
    """Add the 95 % band of the deviation's size and components to the path plot; False where there is none to add."""
    given = session.known(result.setup)
    if given is None:
        return False
    band = deviation_band(result, given)
    s = from_si(result.path.s, unit)
    cutting = np.where(result.judged, 1.0, np.nan)  # rapids push nothing: a band of zero width would say otherwise
    half = from_si(size_band(result, band) * cutting, unit)
    add_band(fig, s, from_si(result.deviation, unit), half, "", dark=dark)
    halves = from_si(band.half_width(LEVEL) * cutting[:, None], unit)
    for i, axis in enumerate("xyz"):
        add_band(fig, s, from_si(result.delta[:, i], unit), halves[:, i], axis, dark=dark)
    return True


def sentence(result: SimulationResult, given: Knowledge, unit: str) -> str:
    """The worst deviation with its band and what the band is made of."""
    i = result.worst
    if i < 0:
        return "No point of the cut is reached, so there is nothing to be sure of."
    band = deviation_band(result, given, i)
    half = float(size_band(result, band, i))
    if not np.isfinite(half):
        return "The band is not known: the tests leave no residuals to judge the noise by."
    along = result.delta[i] / np.linalg.norm(result.delta[i])
    parts = {source: float(band.by_along(source, along)) for source in SOURCES}
    shown = [
        f"{format_si(part, in_lengths('um', unit), 1)} from the {source}"
        for source, part in parts.items()
        if part > 0.0
    ]
    made = f" One standard deviation: {', '.join(shown)}." if shown else ""
    value = band_text(result.max_deviation, half, unit)
    return f"At line {result.worst_block} the tip is {value} off its path, with 95 % probability.{made}"


def band_caption(setup: SimulationSetup) -> str:
    """What the shading of the path plot is, for its caption; "" where there is none."""
    given = session.known(setup)
    return "" if given is None else f"Shaded: 95 % band, {given.source}."
