"""The eight lessons on the screen: a question, a prediction, the reveal, the reason, and a try to break it.

The address says where one is: ``?lesson=3&step=2``, with ``&projector=1`` in large type and without the menu;
``?lesson=exercises`` is the page of exercises.
"""

from __future__ import annotations

import html
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from urllib.parse import urlencode

import numpy as np
import streamlit as st

from robomill.arrays import digest
from robomill.compliance.at_pose import PoseReport
from robomill.extras import needed
from robomill.learn.handout import handout, notes
from robomill.learn.lesson import COUNT, TITLES, Bars, Lesson
from robomill.learn.lessons import lesson
from robomill.learn.marking import check
from robomill.learn.push import AsidePush
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.ui.learn import arrow as arrow_board
from robomill.ui.learn.lesson import ASPECT, BIG, HEIGHT
from robomill.ui.markup import unparted
from robomill.ui.posed.arm import arm
from robomill.ui.posed.point import InHand
from robomill.ui.work import cached
from robomill.units import format_si, format_times
from robomill.viz.arm import ArmScene, displacement_scale

DRAWN_IN = 1  # the lesson whose prediction is an arrow, too
LONG = 60  # characters of a question that stands in smaller type
STEPS = ("Predict", "See", "Why", "Break it")
EXERCISES = "exercises"
SAID = "learn.said"
LOW = 270  # px of the picture above bars
FROM_THE_SIDE, ASKEW = (1.55, -0.29, 0.26), (1.15, -1.05, 0.45)
DOWNLOAD = ":material/download:"
PAPERS = (
    ("Hand-out", handout, "robomill-hand-out.html"),
    ("Teacher's notes, 50 minutes", notes, "robomill-teachers-notes.html"),
)
PROJECTOR = """<style>
html { font-size: 140% !important; }
[data-testid="stSidebar"], [data-testid="stHeader"], [data-testid="stExpandSidebarButton"], footer,
[class*="st-key-bar"] { display: none !important; }
[data-testid="stMainBlockContainer"] { padding-top: 1rem !important; max-width: none !important; }
.rm-bars i { height: 1.5rem !important; }
.js-plotly-plot .js-line, .js-plotly-plot .xgrid, .js-plotly-plot .ygrid { stroke-width: 4px !important; }
</style>"""
LOOKS = """<style>
.rm-ask.rm-long { font-size: 1.75rem; }
.st-key-learn-steps .rm-say { font-size: 1.25rem !important; line-height: 1.35; }
.rm-bars { display: grid; grid-template-columns: minmax(0, max-content) minmax(7rem, 1fr) max-content;
  gap: .45rem .7rem; align-items: center;
  font-size: 1.05rem; font-variant-numeric: tabular-nums; margin: .4rem 0; }
.rm-bars b { font-weight: 650; }
.rm-bars i { display: block; height: 1rem; min-width: 2px; border-radius: 3px; background: #0A84B5; }
.rm-bars i.best { background: #D67500; outline: 2px solid currentColor; outline-offset: 1px; }
.rm-bars div { background: color-mix(in srgb, currentColor 7%, transparent); border-radius: 3px; }
[class*="st-key-learn-said"] label p { font-size: 1.2rem !important; line-height: 1.4; }
.st-key-learn-steps .katex { font-size: 1.15em; }
.st-key-learn-steps .katex-display { overflow-x: auto; overflow-y: hidden; }
@media (max-width: 560px) { .rm-bars { grid-template-columns: 1fr max-content; }
  .rm-bars span:nth-child(3n+1) { grid-column: 1 / -1; white-space: normal; } }
</style>"""


@dataclass(frozen=True)
class Place:
    """Where in the lessons: number (0: the first screen, -1: the exercises), step 1 to 4; whether for a projector."""

    number: int = 0
    step: int = 1
    projector: bool = False


def where() -> Place:
    """What the address says; what it cannot mean is the first screen, or the first step."""
    told = st.query_params
    projector = told.get("projector") == "1"
    if told.get("lesson") == EXERCISES:
        return Place(-1, 1, projector)
    return Place(_whole(told.get("lesson"), COUNT, 0), _whole(told.get("step"), len(STEPS), 1), projector)


def _whole(text: str | None, most: int, otherwise: int) -> int:
    """1 to ``most``, as written in plain digits."""
    known = {str(k): k for k in range(1, most + 1)}
    return known.get(text or "", otherwise)


def go(number: int, step: int = 1, projector: bool | None = None) -> None:
    """Another lesson or step, in the address."""
    large = where().projector if projector is None else projector
    for key in ("lesson", "step", "projector"):
        st.query_params.pop(key, None)
    if number:
        st.query_params["lesson"] = EXERCISES if number < 0 else str(number)
    if number > 0:
        st.query_params["step"] = str(step)
    if large:
        st.query_params["projector"] = "1"


def row(now: Place) -> None:
    """The lessons by number, and the exercises."""
    if now.projector:
        st.html(PROJECTOR)
    names = {0: "Start", **{k: str(k) for k in range(1, COUNT + 1)}, -1: "Exercises"}
    with st.container(key="learn-row"):
        inputs.choice("Lessons", "learn.row", names, now.number, lambda k: go(int(k)))


@cached.shared(lambda number, pose: (number, digest((pose.robot, pose.theta))), "Computing the lesson")
def _lesson(number: int, pose: PoseReport) -> Lesson:
    return lesson(number, pose)


def show(found: InHand, now: Place) -> None:
    """One lesson, as far as the step goes."""
    given = pieces.attempt(_lesson, now.number, found.pose)
    if given is None:
        return
    look = "rm-ask rm-long" if len(given.question) > LONG else "rm-ask"
    st.html(
        f'{BIG}{LOOKS}<p class="rm-kicker">Lesson {now.number} of {COUNT} · {html.escape(given.title)}</p>'
        f'<h1 class="{look}">{unparted(html.escape(given.question))}</h1>'
    )
    with st.container(key="learn-steps"):
        left, right = pieces.split([55, 45], "steps", gap="medium")
        with right:
            if not (now.projector and now.step >= 3):  # the room is for the reason
                _predict(given, found.pose, now.step >= 2)
            if now.step >= 2:
                _see(given, found.pose)
            if now.step >= 3:
                st.html(f'<p class="rm-say">{unparted(pieces.subscripts(given.reason))}</p>')
                st.latex(given.equation)
                pieces.note(f"Eq. {given.paper} with the numbers of now.")
            if now.step >= 4:
                st.html(f'<p class="rm-say"><b>Try to break it.</b> {pieces.subscripts(given.breaking)}</p>')
            _onward(now)
        with left, st.container(border=True):
            _picture(given, found, now)
            if now.step >= 2 and given.bars is not None:
                st.html(_bars(given.bars))


def _predict(given: Lesson, pose: PoseReport, revealed: bool) -> None:
    said = dict(session.kept(SAID, {}))
    key = str(given.number)

    def take(value: object) -> None:
        session.keep(SAID, {**session.kept(SAID, {}), key: value})
        arrow_board.forget()

    if given.number == DRAWN_IN:
        push = AsidePush.of(pose.C)
        pieces.note("Draw where the tip goes: click or drag, or turn the arrow with the arrow keys; or choose below.")
        arrow_board.board(push, given.moved if revealed else None)
        drawn = session.kept(arrow_board.DRAWN)
        if drawn is not None:
            said[key] = list(push.answers).index(arrow_board.answer(push, drawn))
            session.keep(SAID, said)

    with st.container(key=f"learn-said-{given.number}"):
        if given.typed is not None:
            inputs.text(f"Your prediction, {given.typed.asked}", f"learn.typed.{key}", str(said.get(key, "")), take)
            return
        names = {i: choice.text for i, choice in enumerate(given.choices)}
        current = said.get(key)
        look = inputs.Look(stacked=True, hidden=True)
        at = current if current in names else None
        inputs.choice("Your prediction", f"learn.choice.{key}", names, at, take, look)


def _see(given: Lesson, pose: PoseReport) -> None:
    said = session.kept(SAID, {}).get(str(given.number))
    words = f"<b>{unparted(html.escape(given.answer))}</b>"
    judged = ""
    if given.typed is not None and isinstance(said, str) and said.strip():
        judged = check(given.typed, said).sentence
    elif given.typed is None and isinstance(said, int) and said < len(given.choices):
        chosen = given.choices[said]
        told = "" if chosen.told == given.answer else chosen.told
        judged = "You are right." if said == given.right else f"Look again. You said: {chosen.text}. {told}"
        if given.number == DRAWN_IN:
            judged = f"{judged} {arrow_board.words(AsidePush.of(pose.C), given.moved)}".rstrip()
    st.html(f'<p class="rm-say">{words}</p>' + (f'<p class="rm-say">{html.escape(judged)}</p>' if judged else ""))


def _onward(now: Place) -> None:
    with st.container(horizontal=True, gap="small"):
        if now.step > 1:
            inputs.button("Back", "learn.back", "arrow_back", partial(go, now.number, now.step - 1))
        if now.step < len(STEPS):
            words = ("Show what happens", "Why?", "Try to break it")[now.step - 1]
            inputs.button(words, "learn.next", "", partial(go, now.number, now.step + 1), type="primary")
        elif now.number < COUNT:
            title = f"Lesson {now.number + 1}: {TITLES[now.number]}"
            inputs.button(title, "learn.next", "arrow_forward", partial(go, now.number + 1), type="primary")
        else:
            inputs.button("Exercises", "learn.next", "arrow_forward", partial(go, -1), type="primary")


def _picture(given: Lesson, found: InHand, now: Place) -> None:
    revealed, pose = now.step >= 2, found.pose
    fine = given.bars is not None and given.bars.unit == "um"  # what stands beside the picture is counted so
    unit = session.project().view.of("um") if fine else session.project().view.length
    size = float(np.linalg.norm(given.push))
    label = format_si(size, "N", 0)
    scene = ArmScene(
        frames=pose.frames,
        joints=pose.robot.joint_numbers,
        force=given.push,
        force_label=label,
        displacement=given.moved if revealed else None,
        displacement_label=format_si(float(np.linalg.norm(given.moved)), unit),
        unit=session.project().view.of("m"),
        aspect=ASPECT,
        eye=FROM_THE_SIDE if abs(given.push[0]) < 0.5 * size else ASKEW,
    )
    caption = f"A force of {label} on the tip."
    if revealed:
        caption += f" Displacement shown {format_times(displacement_scale(given.moved, pose.frames))}."
    alt = f"The arm with a force of {label} on the tool."
    if revealed:
        alt += f" Its tip moves by {format_si(float(np.linalg.norm(given.moved)), unit)}."
    height = LOW if now.projector or (revealed and given.bars is not None) else HEIGHT
    arm(scene, f"learn-lesson-{given.number}", (caption, alt), height)


def _bars(bars: Bars) -> str:
    """Amounts as bars, the one that is asked for outlined."""
    top = float(np.abs(bars.values).max()) or 1.0
    cells = "".join(
        f"<span>{html.escape(name)}</span><div><i class='{'best' if k == bars.best else ''}' style='width:"
        f"{100.0 * abs(value) / top:.1f}%'></i></div><b>{format_si(value, bars.unit)}</b>"
        for k, (name, value) in enumerate(zip(bars.names, bars.values.tolist()))
    )
    return f'<p class="rm-note">{html.escape(bars.title)}</p><div class="rm-bars">{cells}</div>'


def to_hand_out(found: InHand, where_it_stands: str, now: Place) -> None:
    """What a teacher takes away: the hand-out, the notes, a code of the address, and the projector's view."""
    robot = found.pose.robot
    told = f"{robot.title or robot.name}, which stands {where_it_stands}."

    def made(make: Callable[[list[Lesson], str], str]) -> str:
        return make([_lesson(k, found.pose) for k in range(1, COUNT + 1)], told)

    with st.container(horizontal=True, gap="small", key="learn-teacher"):
        for words, make, name in PAPERS if not now.projector else ():
            st.download_button(
                words, partial(made, make), name, "text/html", f"learn.{name}", icon=DOWNLOAD, on_click="ignore"
            )
        title = "Leave the projector view" if now.projector else "Projector view"
        inputs.button(title, "learn.projector", "present_to_all", partial(go, now.number, now.step, not now.projector))
        with st.popover("QR code", icon=":material/qr_code:"):
            _code(now)


def _code(now: Place) -> None:
    """The address of this lesson as a QR code, drawn here."""
    address = (st.context.url or "").partition("?")[0]
    if not address:
        pieces.note("This page has no address that others can open.")
        return
    told = {"lesson": EXERCISES if now.number < 0 else str(now.number)} if now.number else {}
    whole = f"{address}?{urlencode(told)}" if told else address
    with needed("A QR code"):
        import segno
    drawn = segno.make(whole, error="m").png_data_uri(scale=6, border=4)
    st.html(f'<img alt="QR code of {html.escape(whole)}" src="{drawn}" style="max-width: 100%">')
    pieces.note(whole)
    if any(f"//{own}" in address for own in ("127.0.0.1", "localhost", "[::1]")):
        pieces.note("Only this computer opens that address: serve the app to others with robomill serve.")
