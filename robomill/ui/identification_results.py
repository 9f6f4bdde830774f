"""What the load tests say: compliances with their intervals, residuals by test, models side by side."""

from __future__ import annotations

import html
from typing import Any

import numpy as np
import streamlit as st

from robomill.errors import RobomillError
from robomill.identification.comparison import OVERFIT, in_sample
from robomill.identification.result import IdentificationResult
from robomill.robot.model import Robot
from robomill.ui import identification_words as words
from robomill.ui import inputs, parts
from robomill.ui.load_bench import Bench, comparison_of
from robomill.ui.tables import PRISMATIC_UNITS
from robomill.units import format_si, from_si, unit_label
from robomill.viz.identification import (
    correlation_figure,
    intervals_figure,
    models_figure,
    residuals_figure,
)

RESIDUAL_UNITS = {"mm": "in mm", "%": "in % of the test"}


def compliances(result: IdentificationResult, robot: Robot, joint_unit: str, dark: bool) -> None:
    """Intervals beside the paper's tables, the joint these poses hardly see, correlations, condition."""
    with st.container(border=True):
        for k, drawn in enumerate(words.intervals(result, robot, joint_unit)):
            first = k == 0
            parts.figure(
                intervals_figure(drawn, dark=dark), f"ident-intervals-{k}", name="compliances",
                table=(lambda: words.parameter_columns(result, robot, joint_unit)) if first else None,
                caption=_scale(drawn.logarithmic) if first else "",
                alt="Fitted compliances with 95 % intervals beside the reference values.",
            )  # fmt: skip
    unseen(result)
    few = len(result.labels) <= 8
    left, right = parts.split([1, 1.3], "fit") if few else (st.container(), st.container())
    with left, st.container(border=True, height="stretch"):
        st.markdown("**Which are confused with which**")
        if np.isfinite(result.correlation).any():
            names = [words.pretty(p.label).replace("Joint ", "J").replace("joint ", "J") for p in result.labels]
            parts.figure(
                correlation_figure(names, result.correlation, dark=dark), "ident-correlation",
                table=lambda: {"": names, **{n: result.correlation[:, i] for i, n in enumerate(names)}},
                caption="±1: only their sum or difference is known.", alt="Correlations of the fitted compliances.",
            )  # fmt: skip
        else:
            parts.note("Without residuals to judge the noise by, there are no correlations.")
    with right, st.container(border=True, height="stretch"):
        st.markdown("**The numbers**")
        _table(result, robot, joint_unit)
        before, after = result.condition
        parts.note(
            f"Condition number {before:.0f} as measured, {after:.1f} after scaling the columns. One reading is good to "
            f"{_noise(result)} by the residuals; {result.dof:,} equations to spare."
        )


def _scale(logarithmic: bool) -> str:
    bars = "Bars: 95 % intervals."
    return f"{bars} Logarithmic: equal lengths are equal percentages." if logarithmic else bars


def unseen(result: IdentificationResult) -> None:
    """The joint that cannot be seen, or is known least, and why."""
    if result.unseen_joints:
        for joint in result.unseen_joints:
            st.warning(joint.sentence, icon=":material/visibility_off:")
    elif result.model != "constant" and not words.is_single(result):
        st.info(result.explain(result.weakest_joint), icon=":material/lightbulb:")


def _noise(result: IdentificationResult) -> str:
    if not np.isfinite(result.noise):
        return "an unknown spread"
    return format_si(result.noise, "urad" if result.residual.shape[1] == 1 else "um", 1)


def _table(result: IdentificationResult, robot: Robot, joint_unit: str) -> None:
    columns = words.parameter_columns(result, robot, joint_unit)
    references = [c for c in columns if c not in FIXED]
    head = ["", "value", "std. error", "95 % interval", *references]
    common = words.unit_of(result.labels[0], joint_unit)
    body = []
    for k, parameter in enumerate(result.labels):
        unit = words.unit_of(parameter, joint_unit)
        value, error, low, high = (columns[c][k] for c in FIXED[1:5])
        cells = ["not seen", "–", "–"] if not np.isfinite(value) else [
            f"<b>{words.number(value, unit)}</b>", words.number(error, unit),
            f"{words.number(low, unit)} to {words.number(high, unit)}",
        ]  # fmt: skip
        if parameter.label in result.lumped:
            cells = [f"counted with {result.lumped[parameter.label]}", "", ""]
        cells += [words.number(columns[c][k], unit) for c in references]
        own = "" if unit == common else f" <small>{html.escape(unit_label(unit))}</small>"
        row = "".join(f'<td class="n">{c}</td>' for c in cells)
        body.append(f'<tr><td style="white-space:nowrap">{parts.subscripts(parameter.label)}{own}</td>{row}</tr>')
    top = "".join(f'<th class="{"n" if i else ""}">{html.escape(h)}</th>' for i, h in enumerate(head))
    st.html(f'<div style="overflow-x:auto"><table class="rm-facts"><tr>{top}</tr>{"".join(body)}</table></div>')
    sources = [(title, robot.provenance.get(f"compliance.{name}")) for name, title in words.SET_TITLES.items()]
    said = [f"{parts.badge(source.kind)} {title}" for title, source in sources if source and title in references]
    parts.note(f"In {unit_label(common)}. {' '.join(said)}")


FIXED = ("parameter", "value", "standard error", "95 % from", "95 % to", "unit", "share of displacement, %")


def residuals(kept: Bench, result: IdentificationResult, dark: bool) -> None:
    """Residual of each test, what does not fit, and the click that leaves it out."""
    single = words.is_single(result)
    with st.container(border=True):
        picked = _residual_unit(single)
        if picked == "%":
            with np.errstate(invalid="ignore", divide="ignore"):
                size = words.sizes(result)[:, None]
                drawn = result.residual * (from_si(result.residual_share, "%")[:, None] / size)
        else:
            drawn = from_si(result.residual, picked)
        odd = np.isin(result.row, [o.row for o in result.outliers])
        note = f"Drawn: at most 3,000 of {len(result.row):,} tests. " if len(result.row) > 3000 else ""
        parts.figure(
            residuals_figure(result.row, drawn, odd, picked, dark=dark), f"ident-residuals-{picked}", name="residuals",
            table=lambda: words.residual_columns(result),
            caption=note + "One symbol a component. Ringed: further off than chance allows once in 100 data sets.",
            alt="Measured minus predicted displacement of each test.",
        )  # fmt: skip
    _outliers(kept, result)


def _residual_unit(single: bool) -> str:
    options = {"mrad": "in mrad", "%": RESIDUAL_UNITS["%"]} if single else RESIDUAL_UNITS
    current = st.session_state.get("identification:residual", "")
    current = current if current in options else next(iter(options))

    def take(unit: str) -> None:
        st.session_state["identification:residual"] = unit

    inputs.choice("Residuals", "ident:residual", options, current, take, label_visibility="collapsed")
    return str(st.session_state.get("identification:residual", current)) if current in options else current


def _outliers(kept: Bench, result: IdentificationResult) -> None:
    rows = [o.row for o in result.outliers]
    if not rows and not kept.excluded:
        st.info("Every test fits the others; nothing is left out.", icon=":material/check_circle:")
        return
    if rows:
        unit = "urad" if result.residual.shape[1] == 1 else "um"
        named = "; ".join(
            f"row {o.row}: {format_si(abs(o.residual), unit, 0)}, {o.times:.0f} times the usual"
            for o in result.outliers[:6]
        )
        more = f"; and {len(rows) - 6} more" if len(rows) > 6 else ""
        st.warning(f"{len(rows)} tests do not fit the others ({named}{more}). They are used until you leave them out.",
                   icon=":material/flag:")  # fmt: skip
        if len(rows) > 0.1 * len(result.row):
            parts.note("So many at once speak against the model rather than against the readings: compare the models.")
    key = "ident:excluded"
    inputs.seed(key, list(kept.excluded))
    st.multiselect(
        "Rows left out", sorted({*rows, *kept.excluded}), key=key,
        on_change=lambda: setattr(kept, "excluded", tuple(sorted(st.session_state[key]))),
    )  # fmt: skip
    left, right = st.columns(2)
    left.button(
        f"Leave out {'this row' if len(rows) == 1 else f'these {len(rows)} rows'} and refit", key="ident:drop",
        disabled=not rows, width="stretch", icon=":material/filter_alt:",
        on_click=lambda: setattr(kept, "excluded", tuple(sorted({*rows, *kept.excluded}))),
    )  # fmt: skip
    right.button(
        "Use every row again", key="ident:restore", disabled=not kept.excluded, width="stretch", icon=":material/undo:",
        on_click=lambda: setattr(kept, "excluded", ()),
    )  # fmt: skip


def models(kept: Bench, robot: Robot, joint_unit: str, dark: bool) -> None:
    """Every model on the same tests: errors on own data and on poses left out, parameters, remarks."""
    try:
        with st.spinner("Fitting every model …"):
            compared = comparison_of(kept, robot)
    except RobomillError as exc:
        st.info(str(exc), icon=":material/info:")
        return
    results, rows = compared.results, compared.rows()
    counts = [row["parameters"] for row in rows]
    names = [f"{words.MODEL_TITLES[r.model]} ({n})" for r, n in zip(results, counts, strict=True)]
    best = compared.simplest_good
    st.markdown(f"**{_judgement(compared)}**")
    with st.container(border=True):
        parts.figure(
            models_figure(
                names, np.array([from_si(in_sample(r), "%") for r in results]),
                np.array([from_si(r.cv_relative_error, "%") for r in results]),
                next(k for k, r in enumerate(results) if r is best), dark=dark,
            ), "ident-models", name="models", table=lambda: _model_columns(rows),
            caption="In brackets: parameters. From ring to dot: over-fitting. Bold: simplest that predicts as well.",
            alt="Errors of the models on their own data and on poses left out.",
        )  # fmt: skip
    absorbed = compared.absorbed()
    if absorbed:
        st.info(absorbed, icon=":material/lightbulb:")
    for name, reason in compared.refused.items():
        parts.note(f"{words.MODEL_TITLES[name]}: {html.escape(reason)}")
    _side_by_side(results, rows, robot, joint_unit)
    if kept.model != best.model:
        st.button(
            f"Take {words.MODEL_TITLES[best.model].lower()}", key="ident:best", icon=":material/thumb_up:",
            on_click=lambda: setattr(kept, "model", best.model),
        )  # fmt: skip


def _judgement(compared: Any) -> str:
    best, simple = compared.best, compared.simplest_good
    title = words.MODEL_TITLES[simple.model]
    if best is simple:
        return f"{title} predict poses left out best, to {format_si(best.cv_relative_error, '%', 1)}."
    return (
        f"{title} predict as well as anything richer ({format_si(simple.cv_relative_error, '%', 1)} on poses left out, "
        f"the best model {format_si(best.cv_relative_error, '%', 1)})."
    )


def _model_columns(rows: list[dict[str, Any]]) -> dict[str, Any]:
    return {
        "model": [r["model"] for r in rows],
        "parameters": [r["parameters"] for r in rows],
        "own_data_%": [float(from_si(r["in_sample"], "%")) for r in rows],
        "poses_left_out_%": [float(from_si(r["cross_validated"], "%")) for r in rows],
        "residual_rms_um": [float(from_si(r["residual_rms"], "um")) for r in rows],
        "over_fits": [r["cross_validated"] > OVERFIT * r["in_sample"] for r in rows],
        "remark": [r["remark"] for r in rows],
    }


def _side_by_side(
    results: tuple[IdentificationResult, ...], rows: list[dict[str, Any]], robot: Robot, joint_unit: str
) -> None:
    """Joint values of every model in columns, with the remarks beneath."""
    head = "".join(f'<th class="n">J{j}</th>' for j in robot.joint_numbers)
    units = [PRISMATIC_UNITS[joint_unit] if slides else joint_unit for slides in robot.chain.prismatic]
    body = ""
    for result, row in zip(results, rows, strict=True):
        cells = "".join(
            f'<td class="n">{words.number(float(words.shown(c, unit)), unit)}</td>'
            for c, unit in zip(result.C_theta, units, strict=True)
        )
        remark = html.escape(str(row["remark"]).capitalize())
        body += f"<tr><td>{words.MODEL_TITLES[result.model]}</td>{cells}<td>{remark}</td></tr>"
    st.html(
        f'<div style="overflow-x:auto"><table class="rm-facts"><tr><th></th>{head}<th></th></tr>{body}</table></div>'
    )
    parts.note(f"Joint values in {unit_label(joint_unit)}; – where a model has none or the tests do not see it.")
