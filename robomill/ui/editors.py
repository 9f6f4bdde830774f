"""Table editors bound to the project: what is typed is kept, what is refused is explained beneath the table."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pandas as pd
import streamlit as st

from robomill.ui import inputs, state
from robomill.ui.tables import edited


def table_editor(
    name: str,
    base: Callable[[], pd.DataFrame],
    write: Callable[[pd.DataFrame], None],
    *,
    columns: dict[str, Any] | None = None,
    locked: tuple[str, ...] = (),
    dynamic: bool = False,
    height: Any = "auto",
) -> None:
    """A table whose edits go to ``write`` (which changes the project, ``from_editor=True``, or raises its refusal).

    The table starts from ``base()`` and keeps what was typed until the project changes from outside (undo, preset,
    another input) or the page is left. ``locked`` columns cannot be edited; ``dynamic`` lets rows be added.
    """
    kept = state.store()
    key = f"table:{name}:{kept.revision}"
    waiting = kept.refused.get(f"table:{name}")
    if key not in st.session_state or key not in kept.frames:
        for old in [k for k in kept.frames if k.startswith(f"table:{name}:")]:
            del kept.frames[old]
        # A refused table comes back as it was typed when its page is entered again.
        kept.frames[key] = waiting[0] if waiting is not None and waiting[0] is not None else base()
    start = kept.frames[key]

    def take() -> None:
        frame = edited(start, st.session_state[key])
        inputs.attempt(f"table:{name}", frame, lambda: write(frame))

    st.data_editor(
        start,
        key=key,
        column_config=columns,
        disabled=list(locked),
        hide_index=True,
        on_change=take,
        num_rows="dynamic" if dynamic else "fixed",
        height=height,
        width="stretch",
    )
    inputs.sentence(f"table:{name}")
