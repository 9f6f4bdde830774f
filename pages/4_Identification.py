"""Identification: load tests in, joint compliances out, with how sure; the measured map; a laboratory to learn in."""

from typing import Any

import streamlit as st

from robomill import ui
from robomill.errors import RobomillError
from robomill.ui import pieces
from robomill.ui.bench import Bench
from robomill.ui.identification import cut, inputs, laboratory, measured_map, models, plan, points, results, words
from robomill.ui.identification.bench import fit_of, robot_of, tests_of


def load_tests(kept: Bench, view: ui.View, dark: bool, top: Any) -> None:
    """The sentence at the ``top``; measurements and model on the left, what they say on the right."""
    robot = robot_of(kept)
    tests = result = refusal = None
    try:
        tests = pieces.underway(tests_of, kept, robot)
        result = None if tests is None else pieces.underway(fit_of, kept, robot)
    except RobomillError as exc:
        refusal = exc
    made = "measured" if tests is None else tests.provenance.kind
    kicker = f"Identification · {kept.title}" + " · synthetic example" * (made == "synthetic")
    with top:
        ui.headline(
            kicker, words.title(result, made) if result else "Nothing can be identified from these load tests yet."
        )
    if result is not None:
        ui.tiles(words.tiles(result, view.joint_unit, cut.cut_tile(kept, robot, result, view.length), view.length))
    left, right = ui.split([1, 2.3], "identified")
    with left:
        inputs.source(kept, robot)
        inputs.said(tests, refusal, inputs.findings(tests, result, robot))
        inputs.robot_choice(kept)
        inputs.model_choice(kept, robot)
        if result is not None:
            points.offer(kept, result)
            points.bending(result)
            results.leave_out(kept, result)
            inputs.use(kept, robot, result)
    with right:
        if result is None and refusal is not None:
            st.info("Mend what is named beside; your rows are kept as they are.", icon=":material/arrow_back:")
        if result is None:
            return
        with_points = points.says_something(kept, robot, result)
        view_name = inputs.choose("view", {k: v for k, v in inputs.VIEWS.items() if with_points or k != "points"})
        if view_name == "compliances":
            results.compliances(result, robot, view.joint_unit, dark)
        elif view_name == "residuals":
            results.residuals(kept, result, dark)
        elif view_name == "points":
            points.points(kept, robot, result, view.length, dark)
        elif view_name == "models":
            models.models(kept, robot, view.joint_unit, dark)
        elif view_name == "next":
            plan.measure_next(kept, robot, result, view.length, dark)
        else:
            cut.in_the_cut(kept, robot, result, view.length, dark)


project = ui.begin("Identification")
top = st.container()
section = inputs.choose("section", inputs.SECTIONS)
show = {"tests": load_tests, "map": measured_map.page, "laboratory": laboratory.page}[section]
show(project.bench, project.view, ui.dark(), top)
