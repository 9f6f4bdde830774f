"""Checks of a fit in words: which joint cannot be seen and why, which rows do not belong, what hit a bound."""

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.identification.fit.confidence import half_width
from robomill.identification.fit.least_squares import Fit, robust_fit, triangle
from robomill.identification.fit.models import Parameter
from robomill.identification.fit.system import System
from robomill.identification.result import Outlier, UnseenJoint
from robomill.provenance import Finding
from robomill.units import format_number, format_percent, format_si
from robomill.wording import listed

ALIKE = 0.7  # correlation from which two parameters are said to be confused
CONDITION_WARNING = 100.0
MANY = 0.1  # share of the rows from which outliers speak against the model rather than the readings
COLLINEAR = 1e-10  # 1 - |cosine| below which two columns are one


def correlation(covariance: FloatArray) -> FloatArray:
    """(p, p) correlations; NaN where a variance is not known or zero."""
    with np.errstate(invalid="ignore", divide="ignore"):
        size = np.sqrt(np.diag(covariance))
        return covariance / np.outer(size, size)


def shares(system: System, x: FloatArray) -> FloatArray:
    """(p,) size of what each parameter predicts, as a share of what was measured (rms over the displacements)."""
    size = float(np.sqrt(np.mean(system.b[system.linear] ** 2)))
    predicted = np.sqrt(np.mean((system.A[system.linear] * x) ** 2, axis=0))
    return predicted / size if size > 0 else np.zeros_like(predicted)


def twins(system: System) -> dict[int, int]:
    """Extra springs whose column is that of an earlier parameter: {column: earlier column}."""
    found: dict[int, int] = {}
    A = triangle(system.A, system.b)[:, :-1]  # same lengths and angles between columns, a handful of rows
    norms = np.linalg.norm(A, axis=0)
    for k, parameter in enumerate(system.parameters):
        if parameter.kind in ("joint", "entry") or norms[k] == 0:
            continue
        for j in range(k):
            if norms[j] == 0:
                continue
            gap = A[:, k] / norms[k] - A[:, j] / norms[j]
            if 0.5 * float(gap @ gap) < COLLINEAR:
                found[k] = j
                break
    return found


def scatter(system: System) -> tuple[FloatArray, FloatArray, float]:
    """By a robust fit: residuals (e,) measured minus predicted, the standard deviation (e,) of each, and how many of
    these normal noise puts between any number and its prediction once in a hundred data sets; infinite where unknown.
    """
    from scipy.special import stdtrit

    e = len(system.b)
    dof = e - system.A.shape[1]
    robust = robust_fit(system.A / system.noise[:, None], system.b / system.noise)
    limit = float(stdtrit(dof, 1.0 - 0.01 / (2.0 * e))) if dof >= 3 and robust.scale > 0.0 else np.inf
    return robust.residual * system.noise, robust.scale * system.noise, limit


def outliers(system: System, row: IntArray) -> tuple[Outlier, ...]:
    """Tests further from the robust fit than normal noise puts any number once in a hundred data sets."""
    residual, spread, limit = scatter(system)
    if not np.isfinite(limit):
        return ()
    miss = np.abs(residual) / spread
    found: dict[int, Outlier] = {}
    for k in np.flatnonzero(miss > limit):
        number = int(row[system.test[k]])
        best = found.get(number)
        if best is None or miss[k] > best.times:
            found[number] = Outlier(number, float(miss[k]), float(residual[k]))
    return tuple(sorted(found.values(), key=lambda outlier: -outlier.times))


def unseen_joints(fit: Fit, parameters: tuple[Parameter, ...], share: FloatArray) -> tuple[UnseenJoint, ...]:
    """Joints whose interval reaches down to zero, or that have none: in words, with what they are confused."""
    signed = np.array([p.signed for p in parameters])
    low = fit.interval(signed)[:, 0]
    return tuple(
        UnseenJoint(p.joint, confused_with(fit, parameters, k), sentence(fit, parameters, share, k))
        for k, p in enumerate(parameters)
        if p.joint is not None and (not fit.seen[k] or low[k] <= 0.0)
    )


def confused_with(fit: Fit, parameters: tuple[Parameter, ...], k: int) -> tuple[str, ...]:
    """Labels of the parameters whose effect looks like that of parameter ``k`` at these poses."""
    if not fit.seen[k]:
        together = np.abs(fit.null.T @ fit.null)[k]  # the projector: it does not depend on the basis
        chosen = together > 1e-3 * float(together.max())
    else:
        chosen = np.abs(np.nan_to_num(correlation(fit.covariance)[k])) >= ALIKE
    return tuple(p.label for j, p in enumerate(parameters) if chosen[j] and j != k)


def sentence(fit: Fit, parameters: tuple[Parameter, ...], share: FloatArray, k: int) -> str:
    """Why parameter ``k`` is known as well as it is, and what would help."""
    name = parameters[k].label.capitalize()
    others = confused_with(fit, parameters, k)
    cure = "measure where it has a longer lever on the tool, for example with the tool tilted"
    if not fit.seen[k]:
        if not others:
            return f"{name} cannot be seen: no test makes it yield; {cure}."
        return (
            f"{name} cannot be seen: at these poses its effect is exactly made up of {listed(others)}, "
            "so only their sum is known; measure at poses where they move the tool differently."
        )
    table = np.nan_to_num(correlation(fit.covariance)[k])
    table[k] = 0.0
    j = int(np.argmax(np.abs(table)))
    alike, other = abs(table[j]), parameters[j].label
    said = f"(correlation {format_number(table[j], 2, sign=True)})"
    part = format_si(share[k], "%", 1 if share[k] < 0.1 else 0)
    half = half_share(fit, k)
    if half >= 1.0 and alike >= ALIKE:
        return (
            f"{name} cannot be told from {other}: at these poses both move the tool alike {said}, "
            "so only a mix of the two is known; measure where they move it differently."
        )
    known = f"is known to ± {format_percent(half)}" if half < 1.0 else "cannot be told from a rigid one"
    text = f"{name} {known}: it makes {part} of the measured displacement"
    if alike >= 0.3:
        text += f", and here it moves the tool much as {other} does {said}"
        cure = f"measure where {parameters[k].label} and {other} move the tool differently"
    return f"{text}; to know it better, {cure}."


def half_share(fit: Fit, k: int) -> float:
    """Half the 95 % interval of parameter ``k`` as a share of its estimate."""
    if fit.dof <= 0 or not fit.x[k] > 0:
        return float("inf")
    return float(half_width(fit.stderr[k], fit.dof) / fit.x[k])


def fit_findings(system: System, fit: Fit, active: tuple[str, ...], lumped: dict[str, str]) -> list[Finding]:
    """What the fit itself has to say: bounds, springs that are one, condition, noise against what was stated."""
    found = []
    joints = {parameter.label for parameter in system.parameters if parameter.kind == "joint"}
    for label in active:
        text = f"{label.capitalize()} is held at zero: the tests ask for a negative compliance, which no spring has."
        found.append(Finding("warning" if label in joints else "info", text, code="held-at-zero"))
    for label, other in lumped.items():
        text = f"{label.capitalize()} turns about the same line as {other} at these poses: one spring, counted there."
        found.append(Finding("info", text, code="lumped"))
    if len(fit.null):
        labels = tuple(p.label for k, p in enumerate(system.parameters) if not fit.seen[k])
        what = f"tell {listed(labels)} apart" if len(labels) > 1 else f"make {labels[0]} yield, so it stays unknown"
        text = f"These poses do not {what}; predictions near the measured poses still hold."
        found.append(Finding("warning", text, code="not-seen"))
    elif fit.condition[1] > CONDITION_WARNING:
        text = (
            f"Condition number {fit.condition[1]:.0f} after scaling: small errors of measurement are much magnified; "
            "add poses that differ more."
        )
        found.append(Finding("warning", text, code="condition"))
    if fit.dof == 0 and not system.stated:
        text = "As many unknowns as measured numbers: nothing is left to judge the noise by, so there are no intervals."
        found.append(Finding("warning", text, code="no-residuals"))
    if system.stated and fit.dof > 0 and fit.sigma > 2.0:
        text = (
            f"The residuals are {fit.sigma:.1f} times the stated noise: the model does not explain all that was "
            "measured; compare it with bending or a tool spring."
        )
        found.append(Finding("warning", text, code="above-stated-noise"))
    return found
