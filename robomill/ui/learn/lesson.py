"""The lesson: push along an axis, where does the tip go? One question, one picture, then the reason.

The push is along the axis that leads this robot aside most: along Y for the paper's.
"""

from __future__ import annotations

import dataclasses
import html
from dataclasses import dataclass
from functools import partial
from typing import Any, cast

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.compliance.at_pose import PoseReport
from robomill.compliance.deflection import displacement
from robomill.learn.push import FORCE, AsidePush
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.ui.posed import fields, push
from robomill.ui.posed.arm import arm
from robomill.ui.posed.point import InHand, default_point, in_hand, place
from robomill.ui.project import Project
from robomill.ui.serving.menu import go_on, head_for
from robomill.ui.work import running
from robomill.units import format_number, format_si, format_times, from_si, unit_label
from robomill.viz.arm import ArmScene, displacement_scale

KEPT = "learn.lesson"
PUSH = format_si(FORCE, "N", 0)
ALIGHT = 5e-9  # m/N: what is less reads 0.00 um/N
HEIGHT, ASPECT = 380, 1.4  # of the picture
SIDE = {
    "eye": {"x": 1.55, "y": -0.42, "z": 0.22},
    "center": {"x": 0, "y": -0.13, "z": -0.04},
    "projection": {"type": "orthographic"},
}

# Big type, readable from the back row.
BIG = """<style>
/* Question and picture stand side by side from 900 px on, where the pages' columns stand under each other. */
@media (min-width: 900px) and (max-width: 1080px) {
  :is(.st-key-split-ask, .st-key-split-edge, .st-key-split-steps)
    [data-testid="stHorizontalBlock"]:has(> [data-testid="stColumn"]) {
    flex-wrap: nowrap !important; gap: 1.2rem; }
  :is(.st-key-split-ask, .st-key-split-edge, .st-key-split-steps)
    [data-testid="stHorizontalBlock"] > [data-testid="stColumn"] {
    flex: 1 1 0 !important; min-width: 0 !important; width: auto !important; }
  .st-key-split-ask [data-testid="stHorizontalBlock"] > [data-testid="stColumn"] { flex-grow: 55 !important; }
  .st-key-split-ask [data-testid="stHorizontalBlock"] > [data-testid="stColumn"]:last-child {
    flex-grow: 45 !important; }
}
@media (max-width: 1100px) {
  [class*="st-key-learn-answers"] label p { font-size: 20px !important; }
  .rm-ask { font-size: 2rem !important; }
  .rm-say { font-size: 1.35rem !important; }
  .rm-c { border-spacing: 3px !important; width: 100%; }
  .rm-c td { font-size: 1.15rem !important; min-width: 0 !important; padding: .4rem .3rem !important; }
  .rm-c th { font-size: .85rem !important; padding: .1rem .2rem !important; }
}
/* A button that takes the answer back is no button that is off. */
.st-key-learn-reveal button[kind="secondary"] { border: 2px solid #0A84B5; font-weight: 600; }
.rm-ask { font-size: 2.5rem; line-height: 1.15; font-weight: 650; letter-spacing: -.02em; margin: .2rem 0 .4rem 0;
  text-wrap: balance; }
[class*="st-key-learn-answers"] label p { font-size: 1.5rem !important; line-height: 1.5; }
.rm-say { font-size: 1.65rem; line-height: 1.3; font-weight: 500; margin: .3rem 0; }
.rm-say b { font-weight: 700; }
.rm-c { border-collapse: separate; border-spacing: 6px; margin: .2rem 0 .4rem -6px;
  font-variant-numeric: tabular-nums; }
.rm-c td { font-size: 1.75rem; min-width: 6.4rem; text-align: right; padding: .5rem .8rem; border-radius: 8px;
  border: 0;  background: color-mix(in srgb, currentColor 4%, transparent); }
.rm-c th { font-size: 1.05rem; font-weight: 500; opacity: .75; border: 0; padding: .1rem .5rem; text-align: right; }
.rm-c td.on { background: color-mix(in srgb, #0A84B5 22%, transparent); font-weight: 650; }
.rm-c td.off { background: color-mix(in srgb, #D67500 32%, transparent); font-weight: 650;
  outline: 2px solid #D67500; }
.rm-det { font-size: 3.1rem; font-weight: 650; letter-spacing: -.02em; line-height: 1.1;
  font-variant-numeric: tabular-nums; }
.rm-det small { font-size: 1.2rem; font-weight: 500; opacity: .75; }
</style>"""


@dataclass(frozen=True)
class Lesson:
    """How far this session is in the lesson."""

    answer: str | None = None
    revealed: bool = False
    out: float | None = None


def progress() -> Lesson:
    """How far this session is."""
    return cast(Lesson, session.kept(KEPT, Lesson()))


def go(**steps: Any) -> None:
    """Another step in the lesson."""
    session.keep(KEPT, dataclasses.replace(progress(), **steps))


def stand(project: Project) -> tuple[InHand, str]:
    """Where the lesson stands, tool vertical, and that in words: at the point that a person chose on the maps, else at
    the project's cut, else in the middle of the region."""
    robot, unit = project.setup.robot, project.view.length
    view = dataclasses.replace(session.maps(), A=0.0, B=0.0)
    if view.point is not None:
        x, y, z = view.point.tolist()
        found = in_hand(robot, (x, y, z), 0.0, 0.0)
        if found.pose.reached:
            return found, f"at the selected point {place(found.point, unit)}"
    view = dataclasses.replace(view, point=None)
    cut = push.decided(running.quiet(project.setup))
    if cut is not None and cut.upright:
        found = cut.in_hand()
        return found, f"at line {cut.line} of the cut, {place(found.point, unit)}"
    centre = fields.cut_in_reach(robot, view)
    if centre is not None:
        return in_hand(robot, centre, 0.0, 0.0), f"in the middle of the cut, {place(centre, unit)}"
    box = fields.region(robot, view)
    known = fields.overview(robot, view, box)
    found = in_hand(robot, default_point(view, box, known), 0.0, 0.0)
    return found, f"at {place(found.point, unit)}"


@st.fragment
def question(found: InHand) -> None:
    """The question, its four answers, the picture, and after the reveal where the tip went and why."""
    go_on("Learn")
    push = AsidePush.of(found.pose.C)
    st.html(BIG + f'<h1 class="rm-ask">Push the tool along {push.name}. Where does the tip go?</h1>')
    now = progress()
    left, right = pieces.split([55, 45], "ask", gap="medium")
    with right:
        with st.container(key="learn-answers"):
            look = inputs.Look(stacked=True, hidden=True)
            answer = now.answer if now.answer in push.answers else None
            inputs.choice("Your answer", "learn.answer", push.answers, answer, lambda a: go(answer=a), look)
        words, tone = ("Hide it again", "secondary") if now.revealed else ("Show where it goes", "primary")
        turn = partial(go, revealed=not now.revealed)
        inputs.button(words, "learn.reveal", "visibility", turn, width="stretch", type=tone)
        _answer(found.pose.C, push, now)
        if now.revealed:
            label = "Measure it in the virtual laboratory"
            inputs.button(label, "learn.laboratory", "science", _measure, type="tertiary")
    with left, st.container(border=True):
        _push(found.pose, push, now.revealed)


def _measure() -> None:
    session.keep("identification.section", "laboratory")
    head_for("Identification")


def _answer(C: FloatArray, push: AsidePush, now: Lesson) -> None:
    if not now.revealed:
        st.html('<p class="rm-say">Ask the class first. Then show.</p>')
        return
    delta = displacement(C, push.force)
    unit = session.project().view.length
    st.html(f'<p class="rm-say">{PUSH} along {push.name} moves the tip {push.told(delta, unit, "<b>{}</b>")}.</p>')
    if now.answer in push.answers:
        judged = "Right." if now.answer == push.went(delta) else "Look again."
        st.html(
            f'<p class="rm-say">You said: {html.escape(push.said(now.answer))}. <b>{judged}</b> The {push.column} '
            f"column of C says where a push along {push.name} leads.</p>"
        )
    st.html(compliance_table(C, push.along, unit_of_C()))
    pieces.note(
        f"C in {unit_label(unit_of_C())}. Blue: along the push. Orange, outlined: the off-diagonal terms, where "
        f"the push leads aside."
    )


def unit_of_C() -> str:
    """The unit in which C is shown."""
    return session.project().view.of("um/N")


def compliance_table(C: FloatArray, along: int, unit: str = "um/N") -> str:
    """C in ``unit`` as a large table with the column of the push along that axis lit, HTML."""
    rows = ""
    for i, name in enumerate("XYZ"):
        cells = ""
        for j in range(3):
            value = float(from_si(float(C[i, j]), unit))
            lit = "" if j != along else "on" if i == along else "off" if abs(C[i, j]) > ALIGHT else ""
            cells += f'<td class="{lit}">{format_number(value, 3)}</td>'
        rows += f"<tr><th>tip {name}</th>{cells}</tr>"
    return f'<table class="rm-c"><tr><th></th><th>push X</th><th>push Y</th><th>push Z</th></tr>{rows}</table>'


def _push(pose: PoseReport, push: AsidePush, revealed: bool) -> None:
    delta = pose.delta(push.force)
    unit = session.project().view.length
    scene = ArmScene(
        frames=pose.frames,
        joints=pose.robot.joint_numbers,
        force=push.force,
        force_label=PUSH,
        displacement=delta if revealed else None,
        displacement_label=format_si(float(np.linalg.norm(delta)), unit),
        unit=session.project().view.of("m"),
        aspect=ASPECT,
        eye=(1.55, -0.29, 0.26),
    )
    drawn = format_times(displacement_scale(delta, pose.frames))
    caption = (
        f"Seen from the side. Displacement shown {drawn}."
        if revealed
        else f"Seen from the side: {PUSH} along {push.name}."
    )
    alt = f"The arm seen from the side with a force of {PUSH} along {push.name} on the tool."
    if revealed:
        alt += f" Its tip moves by {format_si(float(np.linalg.norm(delta)), unit)}."
    arm(scene, "learn-push", (caption, alt), HEIGHT)
