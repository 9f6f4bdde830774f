"""Improve: what would fix the project's cut, and what each remedy leaves and takes."""

from functools import partial

import streamlit as st

from robomill import ui
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.ui.improve import opened, remedies, stiffen, studied, sure

project = ui.begin("Improve")
setup, unit = project.setup, project.view.length
title = f"Improve · {setup.name}"

result = ui.attempt(ui.result, setup)
if result is None or result.worst < 0 or result.setup.digest() != setup.digest():
    if result is None or result.setup.digest() != setup.digest():
        ui.headline(title, "There is no cut to improve yet.")
        ui.note("The cut has no result: mend what is named above, or bring the path within reach on the Toolpath page.")
    else:
        unjudged = result.verdict.level == "unjudged"
        ui.headline(title, remedies.NOTHING_JUDGED if unjudged else "There is no cut to improve yet.")
        ui.note(ui.verdict_sentence(result, unit))
        ui.open_question(result)
    st.stop()
by, now = remedies.judged_by(result, unit)
found, waits = remedies.known(result, unit, by)
ui.headline(
    title, remedies.sentence(found, result, now, unit), f"{stiffen.meanwhile(result)} {stiffen.changed(result)}".strip()
)
with st.container(border=True):
    remedies.table(found, now)
    remedies.once(result)
    ui.open_question(result)
    asked, beside = pieces.split((1, 1), "judged")
    with asked:
        inputs.choice("Judged by", remedies.BY, remedies.JUDGED, by, partial(session.keep, remedies.BY))
    if waits is not None:
        with beside:
            waits.show()
there = {each.remedy.code: each.remedy.title for each in found if each.shown is not None}
if there:
    chosen = inputs.pick("Remedy", "improve.remedy", there)
    opened.opened(next(each for each in found if each.remedy.code == chosen), result, unit)
if waits is None:
    with st.container(border=True):
        sure.panel(result, remedies.as_it_is(result, unit).error, unit)
    with st.container(border=True):
        studied.panel(setup, unit)
