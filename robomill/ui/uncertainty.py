"""How sure the compliances in force are, kept beside the project, and the bands that follow from it.

An identification gives compliances with a covariance. ``keep`` stores what it knows under a fingerprint of the
compliances in force (joints and springs beside them), so it holds for as long as exactly these are in force: an
edit, another set or an undo ends it, going back brings it again. Everything else here reads only.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray, as_floats, digest, frozen
from robomill.errors import ProjectError
from robomill.identification.models import Model
from robomill.identification.result import IdentificationResult
from robomill.improve.uncertainty import (
    Sources,
    Uncertain,
    compliance_uncertainty,
    deflection_uncertainty,
    quantile,
    with_band,
)
from robomill.robot.model import Robot
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.units import format_si, from_si
from robomill.viz.bands import add_band

if TYPE_CHECKING:
    import plotly.graph_objects as go

KEY = "robomill:uncertainty"
KEPT = 40
LEVEL = 0.95


@dataclass(frozen=True, eq=False)
class Knowledge:
    """What an identification knows: its model, the parameters in force (p,) SI, how unsure they are, and from where."""

    choice: Model
    parameters: FloatArray
    sources: Sources
    words: str


def knowledge(result: IdentificationResult, robot: Robot, words: str) -> Knowledge:
    """From a fit, for ``result.applied_to(robot)``: a joint that was not seen keeps the robot's own value."""
    parameters = np.array(result.parameters)
    seen = np.isfinite(result.C_theta)
    parameters[: robot.n] = np.where(seen, parameters[: robot.n], robot.C_theta)
    return Knowledge(result.choice, frozen(parameters), Sources.of(result, robot), words)


def widened(given: Knowledge, robot: Robot, force: float = 0.0, length: float = 0.0) -> Knowledge:
    """The same with the force unsure by ``force`` N a component and each D-H length by ``length`` m (std each)."""
    F = np.eye(3) * force**2 if force > 0 else None
    lengths = np.full(2 * robot.rows, length) if length > 0 else None
    return replace(given, sources=replace(given.sources, F=F, lengths=lengths))


def keep(setup: SimulationSetup, known: Knowledge) -> None:
    """Remember ``known`` for as long as the compliances of ``setup`` are in force."""
    kept = _kept()
    kept.pop(fingerprint(setup), None)
    while len(kept) >= KEPT:
        del kept[next(iter(kept))]
    kept[fingerprint(setup)] = known


def known(setup: SimulationSetup) -> Knowledge | None:
    """What is known of the compliances of ``setup``; None where they did not come from an identification."""
    return _kept().get(fingerprint(setup))


def to_table(setup: SimulationSetup) -> dict[str, Any] | None:
    """What is known of the compliances in force, as plain numbers for the project file; None where nothing is."""
    given = known(setup)
    if given is None or given.sources.covariance is None:
        return None
    table: dict[str, Any] = {
        "model": given.choice.name,
        "bending_joints": list(given.choice.bending_joints),
        "parameters": given.parameters.tolist(),
        "covariance": np.asarray(given.sources.covariance).tolist(),
        "words": given.words,
    }
    if given.sources.dof is not None:
        table["dof"] = int(given.sources.dof)
    if given.sources.F is not None:
        table["force_covariance"] = given.sources.F.tolist()
    if given.sources.lengths is not None:
        table["lengths"] = given.sources.lengths.tolist()
    return table


def from_table(setup: SimulationSetup, table: Any) -> None:
    """Keep what a project file knows of the compliances of ``setup``. Raises ProjectError for what cannot be so."""
    where = "project file: [uncertainty]"
    if not isinstance(table, dict):
        raise ProjectError(f"{where} is not a table; remove it or save the project again.")
    try:
        choice = Model(str(table["model"]), tuple(int(j) for j in table.get("bending_joints", (2, 3))))
        p = len(choice.parameters(setup.robot))
        parameters = as_floats(table["parameters"], "parameters", (p,), error=ProjectError)
        covariance = as_floats(table["covariance"], "covariance", (p, p), error=ProjectError)
        F = (
            None
            if "force_covariance" not in table
            else as_floats(table["force_covariance"], "force_covariance", (3, 3))
        )
        rows = 2 * setup.robot.rows
        lengths = None if "lengths" not in table else as_floats(table["lengths"], "lengths", (rows,))
        dof = None if "dof" not in table else int(table["dof"])
    except (KeyError, TypeError, ValueError) as exc:
        raise ProjectError(f"{where} cannot be used ({exc}); remove it or save the project again.") from exc
    sources = Sources(frozen(covariance), F, lengths, dof)
    keep(setup, Knowledge(choice, frozen(parameters), sources, str(table.get("words", "from load tests"))))


def fingerprint(setup: SimulationSetup) -> str:
    """SHA-256 over the compliances in force: joints, blocked axes, springs."""
    robot = setup.robot
    return digest({"C_theta": robot.C_theta_all, "blocked": robot.blocked, "springs": setup.springs})


def deviation_band(result: SimulationResult, given: Knowledge, at: int | None = None) -> Uncertain:
    """The deflection along the path (or at sample ``at``) with its covariance, by linear propagation."""
    chosen = slice(None) if at is None else at
    return deflection_uncertainty(
        result.setup.robot,
        result.theta[chosen],
        result.F[chosen],
        given.sources,
        model=given.choice,
        parameters=given.parameters,
    )


def size_band(result: SimulationResult, band: Uncertain, at: int | None = None) -> FloatArray:
    """Half the 95 % interval (...) m of the deviation's size: of its component along the deviation itself."""
    delta = result.delta if at is None else result.delta[at]
    with np.errstate(invalid="ignore", divide="ignore"):
        along = delta / np.linalg.norm(delta, axis=-1, keepdims=True)
    return quantile(LEVEL, band.dof) * band.along(along)[1]


def worst_half(result: SimulationResult) -> float:
    """Half the 95 % interval of the largest deviation at feed, m; NaN where nothing is known of it."""
    given = known(result.setup)
    if given is None or result.worst < 0:
        return float("nan")
    return float(size_band(result, deviation_band(result, given, result.worst), result.worst))


def compliance_std(setup: SimulationSetup, theta: FloatArray) -> FloatArray | None:
    """(..., 3, 3) m/N: standard deviation of every entry of C at theta (..., n), for maps; None where none is known.

    By the uncertainty of the joints' compliances; that of the springs beside them is not in it.
    """
    given = known(setup)
    if given is None or given.sources.covariance is None:
        return None
    n = setup.robot.n
    return compliance_uncertainty(setup.robot, theta, given.sources.covariance[:n, :n])


def tile_text(result: SimulationResult, unit: str = "mm") -> str:
    """The largest deviation with its 95 % band, "0.26 ± 0.01 mm"; "" where the compliances are taken as certain."""
    half = worst_half(result)
    return band_text(result.max_deviation, half, unit) if np.isfinite(half) else ""


def band_text(value: float, half: float, unit: str) -> str:
    """A value with its half width (m), to the digit that the half width allows."""
    return with_band(value, half, unit, band_digits(half, unit))


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
    return "" if given is None else f"Shaded: 95 % band, {given.words}."


def _kept() -> dict[str, Knowledge]:
    if KEY not in st.session_state:
        st.session_state[KEY] = {}
    return st.session_state[KEY]  # type: ignore[no-any-return]
