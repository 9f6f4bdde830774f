"""How hard it pushes: force along the path with its peak and its band, engagement, the alloy's rows, the coupling."""

import numpy as np

from robomill.arrays import FloatArray
from robomill.cutting.force import COMPONENTS, ForceSpread
from robomill.simulation.coupling import COUPLING
from robomill.simulation.edges import NO_WALL
from robomill.simulation.origin.spread import AlloySpread
from robomill.simulation.result import SimulationResult
from robomill.simulation.stations import force_components, largest_deviations
from robomill.surface.stock_unit import OUTSIDE
from robomill.ui import pieces, session
from robomill.units import format_many, format_si, from_si
from robomill.viz.engagement import engagement_figure, force_figure

OF_CUTTER = (
    "stock-unit",
    "stock-size",
    OUTSIDE,
    "wide-cutter",
    NO_WALL,
    "beyond-flutes",
)  # codes of findings that stand beside cutter and stock


def force_plot(
    result: SimulationResult,
    i: int,
    spread: AlloySpread | None,
    peak: ForceSpread | None,
    dark: bool,
) -> None:
    """Size of the mean force along the cut with its band; its components come with a click in the key."""
    unit = session.project().view.length
    words = "Mean force on the tool. A click in the key shows its components: feed-normal is to the left of the feed, "
    words += "axial positive out of the part."
    pieces.figure(
        force_figure(result, spread, peak, unit, dark=dark, i=i),
        "force",
        name="force",
        table=lambda: force_columns(result, peak),
        caption=words,
        alt=_in_words(result),
    )


def _in_words(result: SimulationResult) -> str:
    size = result.force_size[result.judged]
    if not len(size):
        return "Mean force on the tool along the path: nothing is judged."
    ends = format_many((float(size.min()), float(size.max())), "N", 0, " to ")
    return f"Mean force on the tool along the path: {ends}."


def force_columns(result: SimulationResult, peak: ForceSpread | None) -> dict[str, FloatArray]:
    """The force along the path as columns."""
    c = result.conditions
    columns: dict[str, FloatArray] = {
        "line": result.path.block.astype(float),
        "station_mm": from_si(result.path.s, "mm"),
        "depth_mm": from_si(c.a_p, "mm"),
        "phi_st_deg": from_si(c.phi_st, "deg"),
        "phi_ex_deg": from_si(c.phi_ex, "deg"),
    }
    for k, name in enumerate(COMPONENTS):
        columns[f"F_{name}_N"] = result.force_components[:, k]
        if peak is not None:
            columns[f"low_{name}_N"], columns[f"high_{name}_N"] = peak.low[:, k], peak.high[:, k]
    return columns


def facts(result: SimulationResult, i: int, peak: ForceSpread | None) -> None:
    """Mean and peak at the station, side by side, so that nobody takes one for the other."""
    if i < 0:
        return
    mean = result.force_components[i]
    rows = [("Mean force", format_si(float(result.force_size[i]), "N"), _three(mean) + ", what deflects here")]
    if peak is not None:
        worst = peak.at_peak[i]
        rows.append(
            (
                "Peak of a turn",
                format_si(float(np.linalg.norm(worst)), "N"),
                _three(worst) + ", what shakes: teeth alike, no run-out",
            )
        )
    c = result.conditions
    if bool(c.engaged[i]) and bool(c.n_s[i] > 0):
        rows.append(
            (
                "Chip",
                format_si(c.chip(i, result.tooling.at(i).flutes), "mm/tooth", 3),
                f"{format_si(float(c.n_s[i]), '1/min')}, {format_si(float(c.v_f[i]), 'mm/min')}",
            )
        )
    pieces.facts(rows)


def _three(force: FloatArray) -> str:
    named = zip(COMPONENTS.values(), force, strict=True)
    return ", ".join(f"{name} {format_si(float(v), 'N', sign=True)}" for name, v in named)


def engagement_plot(result: SimulationResult, i: int, dark: bool) -> None:
    """Arc and depth along the path."""
    source = "found from the stock as it stands" if result.setup.engagement else "a full slot, as assumed"
    pieces.figure(
        engagement_figure(result, session.project().view.length, dark=dark, i=i),
        "milling.engagement",
        name="engagement",
        table=lambda: force_columns(result, None),
        caption=f"Arc of engagement and depth, {source}.",
        alt="Arc of engagement and axial depth along the path.",
    )


def alloy_table(result: SimulationResult, i: int, spread: AlloySpread | None) -> None:
    """Every coefficient row of the alloy: its force at the station and the deviation it leads to."""
    if spread is None or i < 0:
        pieces.note("A band comes with a force from the material: the other rows of the same alloy.")
        return
    unit = session.project().view.length
    F, largest = force_components(result, spread)[:, i], largest_deviations(result, spread)
    rows = []
    for row, (material, known) in enumerate(zip(spread.materials, spread.axial, strict=True)):
        feed, normal, axial = (format_si(v, "N", 0, sign=True, with_unit=False) for v in F[row])
        off = format_si(float(largest[row]), unit)
        mark = pieces.badge(material.provenance.kind) + (" in force" if row == 0 else "")
        rows.append((material.title, feed, normal, axial if known else "not given", off, mark))
    head = ("Published coefficients", *(f"{name}, N" for name in COMPONENTS.values()), "tip off, max", "")
    pieces.table(rows, " nnnn ", head, strong=0)
    if not all(spread.axial):
        pieces.note("A row that gives no axial force has no part in its range: there it counts as the row in force.")


def coupling_facts(result: SimulationResult) -> None:
    """What the iteration of force and deflection did."""
    coupling = result.coupling
    if coupling is None:
        return
    if not coupling.converged:
        return  # said beside its switch
    small = session.project().view.of("um")
    rate = f"a step, {coupling.iterations} at most"
    pieces.facts(
        [
            ("Coupling", f"{coupling.mean_iterations:.1f} evaluations", rate),
            ("Against one pass", format_si(coupling.difference, small), "largest difference of any component"),
        ]
    )


def worth_knowing(result: SimulationResult) -> None:
    """Notes on force, stock and cutter."""
    for finding in result.notes:
        if finding.code not in (COUPLING, *OF_CUTTER):  # these stand among the facts and beside the cutter
            pieces.note(f"• {finding.sentence}")
