"""The lesson: push along Y, where does the tip go? One question, one picture, then the reason."""

import dataclasses
from dataclasses import dataclass
from functools import partial
from typing import Any, cast

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.compliance.at_pose import PoseReport
from robomill.compliance.deflection import displacement
from robomill.robot.model import Robot
from robomill.ui import fields, inputs, pieces, session
from robomill.ui.arm import arm
from robomill.ui.point import FORCE, InHand, default_point, in_hand
from robomill.units import format_number, format_si, format_times, from_si, unit_label
from robomill.viz.arm import ArmScene, displacement_scale

KEPT = "learn.lesson"
PUSH = format_si(FORCE, "N", 0)
ANSWERS = {"y": "Along Y, nowhere else", "up": "Along Y and up", "down": "Along Y and down", "x": "Along Y and along X"}
SIDE = {
    "eye": {"x": 1.55, "y": -0.42, "z": 0.22},
    "center": {"x": 0, "y": -0.13, "z": -0.04},
    "projection": {"type": "orthographic"},
}

# Big type, readable from the back row.
BIG = """<style>
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


def stand(robot: Robot) -> InHand:
    """Where the lesson stands: the point in hand of the maps, tool vertical."""
    view = dataclasses.replace(session.maps(), A=0.0, B=0.0, point=None)
    box = fields.region(robot, view)
    known = fields.overview(robot, view, box)
    return in_hand(robot, default_point(view, box, known), 0.0, 0.0)


@st.fragment
def question(found: InHand) -> None:
    """The question, its four answers, the picture, and after the reveal where the tip went and why."""
    st.html(BIG + '<p class="rm-ask">Push the tool along Y. Where does the tip go?</p>')
    now = progress()
    left, right = pieces.split([1.35, 1], "ask", gap="large")
    with right:
        with st.container(key="learn-answers"):
            look = inputs.Look(stacked=True, hidden=True)
            inputs.choice("Your answer", "learn.answer", ANSWERS, now.answer, lambda a: go(answer=a), look)
        words, tone = ("Hide it again", "secondary") if now.revealed else ("Show where it goes", "primary")
        turn = partial(go, revealed=not now.revealed)
        inputs.button(words, "learn.reveal", "visibility", turn, width="stretch", type=tone)
        _answer(found.pose.C, now)
    with left, st.container(border=True):
        _push(found.pose, now.revealed)


def _answer(C: FloatArray, now: Lesson) -> None:
    if not now.revealed:
        st.html('<p class="rm-say">Ask the class first. Then show.</p>')
        return
    delta = displacement(C, [0.0, FORCE, 0.0])
    truth = went(delta)
    unit = session.project().view.length
    st.html(f'<p class="rm-say">{PUSH} along Y move the tip {_moves(delta, unit)}.</p>')
    if now.answer is not None:
        judged = "Right." if now.answer == truth else "Look again:"
        said = (
            f"You said: {ANSWERS[now.answer].lower()}. {judged} the second column of C says where a push along Y leads."
        )
        pieces.note(said)
    st.html(compliance_table(C))
    pieces.note(
        f"C in {unit_label('um/N')}. Blue: along the push. Orange, outlined: the off-diagonal terms, where the "
        f"push leads aside."
    )


def went(delta: FloatArray) -> str:
    """Which of the answers is right for a displacement (3,) under a push along Y."""
    aside = np.abs(delta[[0, 2]])
    if aside.max() < 0.02 * np.linalg.norm(delta):
        return "y"
    if aside[0] > aside[1]:
        return "x"
    return "down" if delta[2] < 0 else "up"


def _moves(delta: FloatArray, unit: str) -> str:
    words = ("along X", "along Y", "down" if delta[2] < 0 else "up")
    told = [
        f"<b>{format_si(abs(float(delta[i])), unit)}</b> {words[i]}"
        for i in (1, 0, 2)
        if abs(delta[i]) > 0.02 * np.linalg.norm(delta)
    ]
    return " and ".join(told) if told else "nowhere"


def compliance_table(C: FloatArray) -> str:
    """C in um/N as a large table with the column of the push lit, HTML."""
    rows = ""
    for i, name in enumerate("XYZ"):
        cells = ""
        for j in range(3):
            value = float(from_si(float(C[i, j]), "um/N"))
            lit = "" if j != 1 else "on" if i == 1 else "off" if abs(value) > 5e-3 else ""
            cells += f'<td class="{lit}">{format_number(value, 3)}</td>'
        rows += f"<tr><th>tip {name}</th>{cells}</tr>"
    return f'<table class="rm-c"><tr><th></th><th>push X</th><th>push Y</th><th>push Z</th></tr>{rows}</table>'


def _push(pose: PoseReport, revealed: bool) -> None:
    delta = pose.delta([0.0, FORCE, 0.0])
    unit = session.project().view.length
    scene = ArmScene(
        frames=pose.frames,
        joints=pose.robot.joint_numbers,
        force=np.array([0.0, FORCE, 0.0]),
        force_label=PUSH,
        displacement=delta if revealed else None,
        displacement_label=format_si(float(np.linalg.norm(delta)), unit),
    )
    drawn = format_times(displacement_scale(delta, pose.frames))
    caption = f"Seen from the side. Displacement shown {drawn}." if revealed else f"Seen from the side: {PUSH} along Y."
    alt = f"The arm seen from the side with a force of {PUSH} along Y on the tool."
    arm(scene, "learn-push", (caption, alt), 520, 0.95, (None, lambda fig, _: fig.lay_out(scene={"camera": SIDE})))
