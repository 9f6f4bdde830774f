"""The exercises on the screen: a student's own numbers, hints one by one, a sentence on each answer, and a file."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import streamlit as st

from robomill.errors import LearnError
from robomill.io.robot.robots import robot_names
from robomill.learn.answers import answers_text
from robomill.learn.draws import student_number
from robomill.learn.exercise import Exercise
from robomill.learn.marking import check
from robomill.learn.personal import ROBOT, exercises
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.ui.markup import as_markdown

WHO, GIVEN, HINTS = "learn.student", "learn.answers", "learn.hints"


def show(robot: str) -> None:
    """The exercises of the student number that is typed, for the project's robot where it is one that comes along."""
    st.html('<h1 class="rm-ask">Exercises with your own numbers</h1>')
    name = robot if robot in robot_names() else ROBOT
    who: Mapping[str, str] = session.kept(WHO, {})
    left, right = pieces.split([1, 1], "who")
    with left:
        inputs.text("Student number", "learn.number", who.get("number", ""), partial(_keep, WHO, "number"))
    with right:
        inputs.text("Name", "learn.name", who.get("name", ""), partial(_keep, WHO, "name"), max_chars=100)
    number = who.get("number", "").strip()
    if not number:
        pieces.note("Every student number has its own numbers, the same on every computer. Type yours to begin.")
        return
    try:
        number = student_number(number)
        given = exercises(number, name)
    except LearnError as refusal:
        pieces.error(refusal)
        return
    kept = _prefix(number, name)
    answers: Mapping[str, str] = session.kept(GIVEN, {})
    pieces.note(f"For {name}. Decimal comma or point, with or without the unit. What you type is kept until you leave.")
    for k, each in enumerate(given, start=1):
        with st.container(border=True, key=f"learn-exercise-{each.id}"):
            _one(k, each, kept, answers.get(kept + each.id, ""))
    own = {each.id: answers.get(kept + each.id, "") for each in given}
    done = sum(bool(text.strip()) for text in own.values())
    text = answers_text(number, own, who.get("name", ""), name)
    words = f"Save my answers ({done} of {len(given)})"
    pieces.download(words, text, f"answers-{number}.toml", "learn.save", type="primary")
    pieces.note("Hand this file in; it holds your number, your name and what you typed, and nothing else.")


def _prefix(number: str, robot: str) -> str:
    return f"{robot}/{number}/"


def _keep(name: str, key: str, value: str) -> None:
    session.keep(name, {**session.kept(name, {}), key: value})


def _one(k: int, given: Exercise, kept: str, answer: str) -> None:
    st.subheader(f"{k}. {given.title}")
    st.markdown(as_markdown(given.text))
    if given.data:
        pieces.table_twin(lambda: given.data, f"robomill-{given.id}", f"learn.data.{given.id}")
    inputs.text(
        f"Your answer, {given.asked}", f"learn.answer.{given.id}:{kept}", answer, partial(_keep, GIVEN, kept + given.id)
    )
    found = check(given, answer)
    if found.kind != "missing":
        if found.right:
            st.success(as_markdown(found.sentence), icon=":material/check_circle:")
        else:
            pieces.said("warning", found.sentence)
    shown = session.kept(HINTS, {}).get(kept + given.id, 0)
    for hint in given.hints[:shown]:
        pieces.note(f"Hint: {hint}")
    if shown == len(given.hints):
        st.latex(given.equation)
        pieces.note(f"Eq. {given.number}.")
    else:
        words = "A hint" if shown == 0 else "Another hint"
        more = partial(_keep, HINTS, kept + given.id, shown + 1)
        inputs.button(words, f"learn.hint.{given.id}:{kept}", "lightbulb", more, type="tertiary")
