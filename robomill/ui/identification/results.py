"""What the load tests say: compliances with their intervals, residuals by test."""

import html

import numpy as np
import streamlit as st

from robomill.identification.result import IdentificationResult
from robomill.identification.slips import outlier_findings
from robomill.report.tags import Html
from robomill.robot.model import Robot
from robomill.ui import pieces, session
from robomill.ui.bench import Bench
from robomill.ui.entry import inputs
from robomill.ui.identification import words
from robomill.ui.identification.bench import decide, decided
from robomill.ui.markup import as_html
from robomill.units import format_count, format_number, format_si, from_si, unit_label
from robomill.viz.identification import (
    MAX_TESTS,
    correlation_figure,
    intervals_figure,
    residuals_figure,
)

# Columns of the table of parameters beside those of the reference sets.
FIXED = ("parameter", "value", "standard error", "95 % from", "95 % to", "unit", "share of displacement, %")


def compliances(result: IdentificationResult, robot: Robot, joint_unit: str, dark: bool) -> None:
    """Intervals beside the paper's tables, the joint these poses hardly see, correlations, condition."""
    length = session.project().view.length
    with st.container(border=True):
        for k, drawn in enumerate(words.intervals(result, robot, joint_unit, length=length)):
            first = k == 0
            pieces.figure(
                intervals_figure(drawn, dark=dark),
                f"ident-intervals-{k}",
                name="compliances",
                table=(lambda: words.parameter_columns(result, robot, joint_unit, length)) if first else None,
                caption=_scale(drawn.logarithmic) if first else "",
                alt="Fitted compliances with 95 % intervals beside the reference values.",
            )
    unseen(result)
    few = len(result.labels) <= 8
    left, right = pieces.split([1, 1.3], "fit") if few else (st.container(), st.container())
    with left, st.container(border=True, height="stretch"):
        st.markdown("**Joints the tests cannot tell apart**")
        if np.isfinite(result.correlation).any():
            names = [words.pretty(p).replace("Joint ", "J").replace("joint ", "J") for p in result.labels]
            pieces.figure(
                correlation_figure(names, result.correlation, dark=dark),
                "ident-correlation",
                table=lambda: {"": names, **{n: result.correlation[:, i] for i, n in enumerate(names)}},
                caption="Correlation of two joints: at ±1 only their sum or difference is known.",
                alt="Correlations of the fitted compliances.",
            )
        else:
            pieces.note("Without residuals to judge the noise by, there are no correlations.")
    with right, st.container(border=True, height="stretch"):
        st.markdown("**Compliances found**")
        _table(result, robot, joint_unit)
        before, after = result.condition
        pieces.note(
            f"One reading is good to {_noise(result)} by the residuals; {format_count(result.dof)} equations to spare."
        )
        with st.expander("Details of the fit"):
            pieces.note(
                f"Condition number {format_number(before, 0)} as measured, {format_number(after, 1)} after scaling "
                "the columns."
            )


def _scale(logarithmic: bool) -> str:
    bars = "Bars: 95 % intervals."
    return f"{bars} Logarithmic: equal lengths are equal percentages." if logarithmic else bars


def unseen(result: IdentificationResult) -> None:
    """The joint that cannot be seen, or is known least, and why."""
    if result.unseen_joints:
        for joint in result.unseen_joints:
            pieces.said("warning", joint.sentence, "visibility_off")
    elif result.has_joints and not result.single:
        pieces.said("info", result.explain(result.weakest_joint), "lightbulb")


def _noise(result: IdentificationResult) -> str:
    if not np.isfinite(result.noise):
        return "an unknown spread"
    return format_si(result.noise, "urad" if result.single else session.project().view.of("um"))


def _table(result: IdentificationResult, robot: Robot, joint_unit: str) -> None:
    length = session.project().view.length
    columns = words.parameter_columns(result, robot, joint_unit, length)
    references = [c for c in columns if c not in FIXED]
    head = ["", "value", "std. error", "95 % interval", *references]
    common = words.unit_of(result.labels[0], joint_unit, length)
    body = []
    for k, parameter in enumerate(result.labels):
        unit = words.unit_of(parameter, joint_unit, length)
        value, error, low, high = (columns[c][k] for c in FIXED[1:5])
        cells = (
            ["not seen", "–", "–"]
            if not np.isfinite(value)
            else [
                Html(f"<b>{words.number(value, unit)}</b>"),
                words.number(error, unit),
                f"{words.number(low, unit)} to {words.number(high, unit)}",
            ]
        )
        if parameter.label in result.lumped:
            cells = [f"counted with {result.lumped[parameter.label]}", "", ""]
        cells += [words.number(columns[c][k], unit) for c in references]
        own = "" if unit == common else Html(f" <small>{html.escape(unit_label(unit))}</small>")
        body.append((pieces.subscripts(parameter.label) + own, *cells))
    pieces.table(body, "s" + "n" * (len(head) - 1), head)
    sources = [(title, robot.provenance.get(f"compliance.{name}")) for name, title in words.SET_TITLES.items()]
    said = [as_html(pieces.badge(source.kind), title) for title, source in sources if source and title in references]
    pieces.note(f"In {unit_label(common)}.", *said)


def residuals(bench: Bench, result: IdentificationResult, dark: bool) -> None:
    """Residual of each test, what does not fit, and the click that leaves it out."""
    length = "mrad" if result.single else session.project().view.of("um")
    options = {length: f"in {unit_label(length)}", "%": "in % of the test"}
    with st.container(border=True):
        picked = inputs.pick("Residuals", f"identification.residual.{length}", options, look=inputs.HIDDEN)
        if picked == "%":
            with np.errstate(invalid="ignore", divide="ignore"):
                size = words.sizes(result)[:, None]
                drawn = result.residual * (from_si(result.residual_share, "%")[:, None] / size)
        else:
            drawn = from_si(result.residual, picked)
        odd = np.isin(result.row, [o.row for o in result.outliers])
        note = (
            f"Drawn: at most {MAX_TESTS} of {format_count(len(result.row))} tests. "
            if len(result.row) > MAX_TESTS
            else ""
        )
        pieces.figure(
            residuals_figure(result.row, drawn, odd, unit_label(picked), result.components, dark=dark),
            f"ident-residuals-{picked}",
            name="residuals",
            table=lambda: words.residual_columns(result, length),
            caption=note + "One symbol a component. Ringed: further off than chance allows once in 100 data sets.",
            alt="Measured minus predicted displacement of each test.",
        )
    _outliers(bench, result)


def _outliers(bench: Bench, result: IdentificationResult) -> None:
    rows = [o.row for o in result.outliers]
    if not rows and not bench.excluded:
        st.info("Every test fits the others; nothing is left out.", icon=":material/check_circle:")
        return
    for finding in outlier_findings(result.outliers, len(result.row)):
        pieces.said("warning", finding.message, "flag")
    flagged = tuple(sorted({*rows, *bench.excluded}))
    inputs.several(
        "Rows left out",
        "identification.excluded",
        {row: str(row) for row in flagged},
        bench.excluded,
        lambda chosen: decide(excluded=tuple(sorted(chosen))),
    )
    every = ("identification.use_all", "undo", decided("excluded"), ())
    inputs.button("Use every row again", *every, disabled=not bench.excluded)


def leave_out(bench: Bench, result: IdentificationResult) -> None:
    """The button that leaves out the rows that do not fit (they are named among the findings)."""
    rows = [o.row for o in result.outliers]
    if not rows:
        return
    flagged = tuple(sorted({*rows, *bench.excluded}))
    these = "this row" if len(rows) == 1 else f"these {len(rows)} rows"
    out = ("identification.leave_these_out", "filter_alt", decided("excluded"), flagged)
    inputs.button(f"Leave out {these} and refit", *out, width="stretch")
