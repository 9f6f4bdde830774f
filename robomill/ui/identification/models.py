"""Models side by side on the same tests: which springs the measurements support."""

from typing import Any

import numpy as np
import streamlit as st

from robomill.errors import RobomillError
from robomill.identification.fit.comparison import OVERFIT, Comparison
from robomill.identification.fit.models import MODELS
from robomill.identification.result import IdentificationResult
from robomill.robot.model import Robot
from robomill.robot.stiffness import of_joint, shown as shown_in
from robomill.ui import pieces
from robomill.ui.bench import Bench
from robomill.ui.entry import inputs
from robomill.ui.identification import words
from robomill.ui.identification.bench import comparison_of, decided
from robomill.units import format_si, from_si, unit_label
from robomill.viz.identification import models_figure


def models(bench: Bench, robot: Robot, joint_unit: str, dark: bool) -> None:
    """Every model on the same tests: errors on own data and on unseen poses, parameters, remarks."""
    try:
        compared = pieces.underway(comparison_of, bench, robot)
    except RobomillError as exc:
        pieces.said("info", str(exc), "info")
        return
    if compared is None:
        return
    results, rows = compared.results, compared.rows()
    counts = [row["parameters"] for row in rows]
    names = [f"{r.choice.title} ({n})" for r, n in zip(results, counts, strict=True)]
    best = compared.simplest_good
    pieces.strong(_judgement(compared))
    with st.container(border=True):
        pieces.figure(
            models_figure(
                names,
                np.array([from_si(r.in_sample, "%") for r in results]),
                np.array([from_si(r.cv_relative_error, "%") for r in results]),
                next(k for k, r in enumerate(results) if r is best),
                dark=dark,
            ),
            "ident-models",
            name="models",
            table=lambda: _model_columns(rows),
            caption="In brackets: parameters. From ring to dot: over-fitting. Bold: simplest that predicts as well.",
            alt="Errors of the models on the data they were fitted to and on unseen poses.",
        )
    absorbed = compared.absorbed()
    if absorbed:
        pieces.said("info", absorbed, "lightbulb")
    for name, reason in compared.refused.items():
        pieces.note(f"{MODELS[name].title}: {reason}")
    _side_by_side(results, rows, robot, joint_unit)
    if bench.model != best.model:
        take = (decided("model"), best.model)
        inputs.button(f"Take {best.choice.title.lower()}", "identification.take_best", "thumb_up", *take)


def _judgement(compared: Comparison) -> str:
    best, simple = compared.best, compared.simplest_good
    title = simple.choice.title
    if best is simple:
        return f"{title} predict unseen poses best, to {format_si(best.cv_relative_error, '%', 1)}."
    return (
        f"{title} predict as well as anything richer ({format_si(simple.cv_relative_error, '%', 1)} on unseen poses, "
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
    head = ("", *(f"J{j}" for j in robot.joint_numbers), "")
    units = [of_joint(joint_unit, bool(slides)) for slides in robot.chain.prismatic]
    shown = [
        (
            result.choice.title,
            *(words.number(float(shown_in(c, unit)), unit) for c, unit in zip(result.C_theta, units, strict=True)),
            str(row["remark"]).capitalize(),
        )
        for result, row in zip(results, rows, strict=True)
    ]
    pieces.table(shown, f" {'n' * len(units)} ", head)
    pieces.note(f"Joint values in {unit_label(joint_unit)}; – where a model has none or the tests do not see it.")
