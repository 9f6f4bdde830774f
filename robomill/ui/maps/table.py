"""A figure whose table is made only when it is opened: maps are redrawn at every slider step, their tables are not."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import plotly.graph_objects as go
import streamlit as st

from robomill.ui import parts

Columns = Callable[[], Any]


def figure(
    fig: go.Figure,
    key: str,
    *,
    name: str,
    caption: str,
    alt: str,
    table: Columns,
    on_select: Callable[[], None] | None = None,
) -> Any:
    """As ``ui.figure``, with its table twin behind a button that computes it when pressed."""
    picked = parts.figure(fig, key, name=name, alt=alt, on_select=on_select)
    with st.container(horizontal=True, vertical_alignment="center", horizontal_alignment="distribute", gap="small"):
        parts.note(caption)
        opened = st.popover("Table", icon=":material/table:", type="tertiary", key=f"table-of-{key}", on_change="rerun")
        if opened.open:
            with opened:
                _table(table, name)
    return picked


def _table(table: Columns, name: str) -> None:
    import pandas as pd

    frame = pd.DataFrame(dict(table()))
    shown = frame.head(parts.SHOWN_ROWS)
    st.dataframe(shown, hide_index=True, height=min(36 * (len(shown) + 1), 360), width=640)
    if len(frame) > len(shown):
        parts.note(f"Showing {len(shown)} of {len(frame)} rows; the file has all of them.")
    parts.download("CSV", lambda: frame.to_csv(index=False), f"robomill-{name}.csv", "text/csv", key=f"csv:{name}")
