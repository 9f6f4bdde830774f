"""What an identification says on the screen: sentences, tiles and columns. Pure functions, no widgets."""

from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.identification.fit.models import Parameter
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.result import IdentificationResult
from robomill.robot.model import Robot
from robomill.robot.stiffness import is_stiffness, of_joint, shown
from robomill.ui.pieces import Tile
from robomill.units import format_count, format_percent, format_si, format_value, from_si, in_lengths, unit_label
from robomill.viz.identification import Intervals

IDENTIFIED_SET = "identified"
SET_TITLES = {"table_2": "Table 2", "table_3": "Table 3"}


def unit_of(parameter: Parameter, joint_unit: str, length: str) -> str:
    """The unit a parameter is shown in, where lengths are in ``length``: that of joints for them and for bending, um/N
    or what stands in its place for what shifts."""
    of_shift = in_lengths("um/N", length)
    return of_joint(joint_unit, not parameter.turns) if parameter.turns or parameter.joint else of_shift


def interval(low_high: FloatArray, unit: str) -> tuple[float, float]:
    """An interval of a compliance in ``unit``, lower end first."""
    ends = shown(np.asarray(low_high, dtype=np.float64), unit)
    return float(ends.min()), float(ends.max())


def number(value: float, unit: str) -> str:
    """A value already in ``unit`` with that unit's digits, without its name; a dash where there is none."""
    return format_value(value, unit, with_unit=False, missing="–")


def intervals(
    result: IdentificationResult, robot: Robot, joint_unit: str, truth: FloatArray | None = None, length: str = "mm"
) -> list[Intervals]:
    """One drawing for each kind and unit of parameter: the joints, then bending, then what shifts."""
    groups = [(unit_of(p, joint_unit, length), p.joint is not None) for p in result.labels]
    return [
        _drawing(result, robot, unit, [k for k, g in enumerate(groups) if g == (unit, joint)], truth if joint else None)
        for unit, joint in dict.fromkeys(groups)
    ]


def _drawing(
    result: IdentificationResult, robot: Robot, unit: str, rows: list[int], truth: FloatArray | None
) -> Intervals:
    parameters = [result.labels[k] for k in rows]
    lumped = [result.lumped.get(p.label, "") for p in parameters]
    known = np.isfinite(result.parameter_stderr[rows]) & np.array([not other for other in lumped])
    value = np.where(known, shown(result.parameters[rows], unit), np.nan)
    ends = np.array([interval(result.parameter_ci95[k], unit) for k in rows])
    said = tuple(
        f"<b>{number(v, unit)}</b>  ({number(low, unit)} to {number(high, unit)})"
        if seen
        else f"moves as {other} does at these poses: counted there"
        if other
        else "not seen by these tests"
        for v, (low, high), seen, other in zip(value, ends, known, lumped, strict=True)
    )
    joints = [p.joint - 1 for p in parameters if p.joint is not None]
    references = {title: shown(C[joints], unit) for title, C in reference_sets(robot)} if joints else {}
    return Intervals(
        labels=tuple(pretty(p) for p in parameters),
        value=value,
        low=ends[:, 0],
        high=ends[:, 1],
        words=said,
        unit=unit_label(unit),
        references=references,
        truth=None if truth is None else shown(truth, unit),
        logarithmic=not any(p.signed for p in parameters) and bool((value[known] > 0).any()),
    )


def reference_sets(robot: Robot) -> list[tuple[str, FloatArray]]:
    """The robot's own compliance sets (all rows) with their titles, but for those found here."""
    return [
        (SET_TITLES.get(name, name.replace("_", " ").capitalize()), C)
        for name, C in robot.compliance_sets.items()
        if name != IDENTIFIED_SET
    ]


def pretty(parameter: Parameter) -> str:
    """A parameter's name as a figure writes it: "Joint 4", "C" with its index set low."""
    return f"C<sub>{parameter.axis}</sub>" if parameter.kind == "entry" else parameter.label.capitalize()


def parameter_columns(
    result: IdentificationResult, robot: Robot, joint_unit: str, length: str = "mm"
) -> dict[str, Any]:
    """The table of parameters: value, standard error, 95 % interval, share of the displacement, reference sets."""
    units = [unit_of(p, joint_unit, length) for p in result.labels]
    known = np.isfinite(result.parameter_stderr)
    value = np.array([float(shown(v, u)) for v, u in zip(result.parameters, units, strict=True)])
    with np.errstate(invalid="ignore", divide="ignore"):
        error = np.where(
            [is_stiffness(u) for u in units],
            value * result.parameter_stderr / result.parameters,
            [float(from_si(float(e), u)) for e, u in zip(result.parameter_stderr, units, strict=True)],
        )
    ends = [interval(c, u) for c, u in zip(result.parameter_ci95, units, strict=True)]
    columns: dict[str, Any] = {
        "parameter": [p.label for p in result.labels],
        "value": np.where(known, value, np.nan),
        "standard error": np.where(known, error, np.nan),
        "95 % from": np.where(known, [e[0] for e in ends], np.nan),
        "95 % to": np.where(known, [e[1] for e in ends], np.nan),
        "unit": [unit_label(u) for u in units],
        "share of displacement, %": from_si(result.share, "%"),
    }
    if not result.has_joints:
        return columns
    for name, values in reference_sets(robot):
        columns[name] = [
            float(shown(values[p.joint - 1], u)) if p.joint else np.nan
            for p, u in zip(result.labels, units, strict=True)
        ]
    return columns


def residual_columns(result: IdentificationResult, unit: str = "mm") -> dict[str, Any]:
    """One row a test: residual by component (in ``unit``; mrad for single joints), its size, its share, times off."""
    unit = "mrad" if result.single else unit
    flagged = {o.row: o.times for o in result.outliers}
    columns: dict[str, Any] = {"row": result.row}
    for name, values in zip(result.components, result.residual.T, strict=True):
        columns["_".join(filter(None, ("residual", name.replace(" ", ""), unit)))] = from_si(values, unit)
    columns[f"size_{unit}"] = from_si(sizes(result), unit)
    columns["share_of_measured_%"] = from_si(result.residual_share, "%")
    columns["times_the_usual"] = [flagged.get(int(r), np.nan) for r in result.row]
    return columns


def sizes(result: IdentificationResult) -> FloatArray:
    """(m,) size of each test's residual; NaN where nothing was measured."""
    size = np.sqrt(np.nansum(result.residual**2, axis=1))
    return np.where(np.isfinite(result.residual).any(axis=1), size, np.nan)


def summary(tests: LoadTests | JointTests) -> str:
    """What was read: how many tests, at how many poses."""
    m = len(tests)
    if tests.single:
        return f"{m} tests of {len(np.unique(tests.joint))} joints, one at a time."
    poses = int(tests.pose_index().max()) + 1
    numbers = int(np.isfinite(tests.displacement).sum())
    return (
        f"{format_count(m)} tests at {format_count(poses)} poses, {format_count(numbers)} equations ({tests.protocol})."
    )


def weakest(result: IdentificationResult) -> tuple[str, float]:
    """Label of the joint known least, and half its 95 % interval as a share of its value."""
    k = result.weakest
    return result.labels[k].label, float(result.relative_half[k])


def within(half: float) -> str:
    """Half an interval as a share of its value, "± 53 %"."""
    return f"± {format_percent(half)}" if np.isfinite(half) else "not seen"


def title(result: IdentificationResult, made: str = "measured") -> str:
    """The page's one sentence; ``made`` says whether anybody has measured these tests."""
    cv = result.cv_relative_error
    what = "readings" if result.single else "poses"
    these = "These synthetic tests" if made == "synthetic" else "These tests"
    said = (
        f"{these} predict {what} they have not seen to {format_si(cv, '%', 1)}"
        if np.isfinite(cv)
        else f"There are too few {what} to leave any out"
    )
    if not result.has_joints:
        return f"{said}: one matrix for every pose, the naive baseline."
    label, half = weakest(result)
    if not np.isfinite(half):
        return f"{said}; {label} cannot be seen."
    return f"{said}; {label} is the least certain, to {within(half)}."


def tiles(result: IdentificationResult, joint_unit: str, cut: tuple[str, str], length: str = "mm") -> list[Tile]:
    """Cross-validated error, the weakest joint, residual, and what it means for the cut."""
    cv, inside = result.cv_relative_error, result.in_sample
    single = result.single
    rms = format_si(result.residual_rms, "urad" if single else in_lengths("um", length))
    least = Tile("Least certain joint", "none", "this model has no joints")
    if result.has_joints:
        label, half = weakest(result)
        unit = unit_of(result.labels[result.weakest], joint_unit, length)
        low, high = interval(result.parameter_ci95[result.weakest], unit)
        note = f"{number(low, unit)} to {number(high, unit)} {unit_label(unit)}"
        least = Tile(
            f"Least certain: {label}", within(half), note if np.isfinite(half) else "these tests do not see it"
        )
    odd = len(result.outliers)
    fit = f"{odd} outlier{'s' * (odd > 1)}" if odd else "no outlier"
    return [
        Tile(
            f"Prediction error on unseen {'readings' if single else 'poses'}",
            format_si(cv, "%", 1) if np.isfinite(cv) else "not known",
            f"cross-validated; {format_si(inside, '%', 1)} on the data it was fitted to",
            kind="computed",
        ),
        least,
        Tile("Residual (RMS)", rms, f"{format_count(result.equations)} equations, {fit}"),
        Tile("Largest deviation in the cut", *cut),
    ]
