"""The mathematics behind a page's numbers, opened beside its tiles: law, numbers of now, and both to be copied."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import streamlit as st

from robomill.learn.worked import Worked
from robomill.ui import pieces
from robomill.ui.entry import inputs

OPEN = "worked.open"


def mathematics(make: Callable[[], Sequence[Worked]], name: str) -> None:
    """What stands on a page worked out, one at a time; made once it is opened."""
    popover = st.popover(
        "Show the mathematics", icon=":material/function:", type="tertiary", key=f"worked-{name}", on_change="rerun"
    )
    if not popover.open:
        return
    with popover:
        found = {each.name: each for each in make()}
        if not found:
            pieces.note("Nothing here has an equation of its own: no point is reached, or none is judged.")
            return
        picked = inputs.pick("What is worked out", f"worked.{name}", {key: key for key in found}, None, inputs.LISTED)
        each = found[picked]
        st.latex(each.law)
        with st.container(key=f"worked-numbers-{name}"):
            st.latex(each.numbers)
        pieces.note(f"In the paper: {each.paper}. {each.units}")
        pieces.note("As LaTeX; the symbol at the right copies it.")
        st.code(each.tex, language=None, wrap_lines=True)
