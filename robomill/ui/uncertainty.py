"""How sure the compliances in force are, kept beside the project, and the bands that follow from it.

An identification gives compliances with a covariance. ``keep`` stores what it knows under a fingerprint of the
compliances in force (joints and springs beside them), so it holds for as long as exactly these are in force: an
edit, another set or an undo ends it, going back brings it again. Everything else here reads only.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import streamlit as st

from robomill.identification.knowledge import Knowledge, compliance_digest
from robomill.simulation.band import LEVEL, deviation_band, size_band, worst_half
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.units import format_many, format_si, from_si
from robomill.viz.along import add_band

if TYPE_CHECKING:
    import plotly.graph_objects as go

KEY = "robomill:uncertainty"
KEPT = 40


def keep(setup: SimulationSetup, known: Knowledge) -> None:
    """Remember ``known`` for as long as the compliances of ``setup`` are in force."""
    kept, held = _kept(), known.held_by(setup.robot, setup.springs)
    kept.pop(held.compliances, None)
    while len(kept) >= KEPT:
        del kept[next(iter(kept))]
    kept[held.compliances] = held


def known(setup: SimulationSetup) -> Knowledge | None:
    """What is known of the compliances of ``setup``; None where they did not come from an identification."""
    return _kept().get(compliance_digest(setup.robot, setup.springs))


def to_table(setup: SimulationSetup) -> dict[str, Any] | None:
    """What is known of the compliances in force, as plain numbers for the project file; None where nothing is."""
    given = known(setup)
    return None if given is None else given.to_table()


def from_table(setup: SimulationSetup, table: Any) -> None:
    """Keep what a project file knows of the compliances of ``setup``. Raises ProjectError for what cannot be so."""
    keep(setup, Knowledge.from_table(table, setup.robot, setup.springs, "project file: [uncertainty]"))


def tile_text(result: SimulationResult, unit: str = "mm") -> str:
    """The largest deviation with its 95 % band, "0.26 ± 0.01 mm"; "" where the compliances are taken as certain."""
    half = worst_half(result, known(result.setup))
    return band_text(result.max_deviation, half, unit) if np.isfinite(half) else ""


def band_text(value: float, half: float, unit: str) -> str:
    """A value with its half width (m), to the digit that the half width allows."""
    return format_many((value, half), unit, band_digits(half, unit), " ± ")


def band_digits(half: float, unit: str) -> int:
    """Decimals that show a half width (m) to at least one digit: 2 to 4, more only in inches."""
    size = float(from_si(half, unit))
    needed = int(np.ceil(-np.log10(size) - 0.3)) if size > 0 else 4
    return min(max(needed, 2), 4 if unit == "mm" else 5)


def banded(fig: go.Figure, result: SimulationResult, unit: str, *, dark: bool) -> bool:
    """Add the 95 % band of the deviation's size and components to the path plot; False where there is none to add."""
    given = known(result.setup)
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
    parts = (("compliances", band.by_compliance), ("force", band.by_force), ("lengths", band.by_lengths))
    shown = [f"{format_si(float(np.linalg.norm(v)), 'um', 1)} from the {name}" for name, v in parts if np.any(v > 0)]
    made = f" One standard deviation: {', '.join(shown)}." if shown else ""
    value = band_text(result.max_deviation, half, unit)
    return f"At line {result.worst_block} the tip is {value} off its path, with 95 % probability.{made}"


def band_caption(setup: SimulationSetup) -> str:
    """What the shading of the path plot is, for its caption; "" where there is none."""
    given = known(setup)
    return "" if given is None else f"Shaded: 95 % band, {given.source}."


def _kept() -> dict[str, Knowledge]:
    if KEY not in st.session_state:
        st.session_state[KEY] = {}
    return st.session_state[KEY]  # type: ignore[no-any-return]
