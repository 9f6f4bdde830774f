"""What the compliances found mean for the project's cut: the deviation along its path with a band."""

from contextlib import suppress
from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.errors import RobomillError
from robomill.identification.fit.confidence import LEVEL
from robomill.identification.knowledge import Knowledge
from robomill.identification.result import IdentificationResult
from robomill.robot.model import Robot
from robomill.simulation.band import deviation_band, size_band, worst_half
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.ui import pieces, session
from robomill.ui.bench import Bench
from robomill.ui.entry import inputs
from robomill.ui.identification.bench import field
from robomill.ui.identification.inputs import adopted, knowledge
from robomill.ui.judged import uncertainty
from robomill.ui.work import running
from robomill.ui.work.job import Underway
from robomill.units import format_si, from_si
from robomill.viz.deviation import band_figure


def cut_of(robot: Robot) -> SimulationResult:
    """The project's cut by ``robot``. Raises the refusal of the simulation, and Underway."""
    return running.computed(_setup_of(robot), "identification.cut")


def _setup_of(robot: Robot) -> SimulationSetup:
    setup = session.project().setup
    return setup if setup.robot == robot else setup.replace(robot=robot)


def cut_tile(bench: Bench, robot: Robot, result: IdentificationResult, unit: str) -> tuple[str, str]:
    """Value and note of the tile on the cut: its worst deviation by the compliances found, with its band."""
    if not result.has_joints:
        return "no joints", "choose a model with joint springs"
    setup = session.project().setup
    made = None
    with suppress(RobomillError, Underway):
        if pieces.underway(running.path_of, setup) is not None and _there(bench, robot, result):
            made = predicted(bench, robot, result), cut_of(robot).max_deviation
    if made is None:
        return "not computed", "see In the cut"
    (found, known), now = made
    if found.worst < 0:
        return "out of reach", "no point of the cut is reached"
    half = worst_half(found, known)
    if not np.isfinite(half):
        return "not known", "no residuals to judge the noise by"
    digits = uncertainty.band_digits(half)
    text = uncertainty.band_text(found.max_deviation, half, unit)
    if known.held_by(found.setup.robot, found.setup.springs).holds_for(setup.robot, setup.springs):
        return text, "95 % band; in use in the project"
    return text, f"by these compliances; the project has {format_si(now, unit, digits)}"


def _there(bench: Bench, robot: Robot, result: IdentificationResult) -> bool:
    """Whether both runs are kept, or short: longer ones are begun where they can be cancelled."""
    found = adopted(session.project().setup, robot, result, bench.name)
    return running.there(found) and running.there(_setup_of(robot))


def predicted(bench: Bench, robot: Robot, result: IdentificationResult) -> tuple[SimulationResult, Knowledge]:
    """The project's cut with the compliances found, and how unsure they, force and lengths are."""
    setup = adopted(session.project().setup, robot, result, bench.name)
    found = running.computed(setup, "identification.found")
    return found, knowledge(bench, robot, result)


def in_the_cut(bench: Bench, robot: Robot, result: IdentificationResult, unit: str, dark: bool) -> None:
    """The deviation along the project's path with its band, and what the band is made of."""
    if not result.has_joints:
        pieces.note("One constant matrix has no joint compliances; choose a model with joint springs.")
        return
    first, band, second, third = pieces.split([1.5, 1.5, 1, 1], "cut", gap="small")
    with first:
        axis = inputs.pick("Deviation", "identification.component", {"": "Size", "x": "X", "y": "Y", "z": "Z"})
    with band:
        field(bench, "band", inputs.LISTED)
    with second:
        field(bench, "force_unsure")
    with third:
        field(bench, "length_unsure")
    made, now = pieces.attempt(predicted, bench, robot, result), pieces.attempt(cut_of, robot)
    if made is None or now is None:
        return
    found, known = made
    pieces.strong(uncertainty.sentence(found, known, unit))
    with st.container(border=True):
        pieces.figure(
            band_figure(_curves(found, now, known, axis, unit), axis, unit, dark=dark),
            "ident-band",
            name="deviation-band",
            table=lambda: band_columns(found, known),
            caption=f"Shaded: 95 % band, {known.source}. Dashed: the compliances of the project now.",
            alt="Deviation along the path with its 95 % band.",
        )
    pieces.note("Force: each component, link lengths: each a and d; one standard deviation, zero is taken as exact.")


def _curves(
    found: SimulationResult, now: SimulationResult, known: Knowledge, axis: str, unit: str
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Length cut, value, half width and the project's value now (m,), all in ``unit``, where the tool cuts."""
    band = deviation_band(found, known)
    cutting = found.judged
    if axis:
        i = "xyz".index(axis)
        value, half, before = found.delta[:, i], band.half_width(LEVEL)[:, i], now.delta[:, i]
    else:
        value, half, before = found.deviation, size_band(found, band), now.deviation
    blank = np.where(cutting, 1.0, np.nan)
    s, value, half, before = (from_si(v, unit) for v in (found.path.s, value * blank, half * blank, before * blank))
    return s, value, half, before


def band_columns(found: SimulationResult, known: Knowledge) -> dict[str, Any]:
    """Along the path: station, deviation and the standard deviation by source, mm."""
    band = deviation_band(found, known)
    columns: dict[str, Any] = {"line": found.path.block, "station_mm": from_si(found.path.s, "mm")}
    for i, axis in enumerate("xyz"):
        columns[f"delta_{axis}_mm"] = from_si(found.delta[:, i], "mm")
        columns[f"half95_{axis}_mm"] = from_si(band.half_width(LEVEL)[:, i], "mm")
    for name in ("compliance", "model", "force", "lengths"):
        spread = np.linalg.norm(getattr(band, f"by_{name}"), axis=1)
        columns[f"std_by_{name}_mm"] = from_si(spread, "mm")
    return columns
