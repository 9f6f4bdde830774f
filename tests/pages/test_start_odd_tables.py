"""Odd words and numbers in every column of every table that is edited: taken, or refused in a sentence; no crash."""

from __future__ import annotations

from itertools import product
from typing import Any

import pandas as pd
import pytest
from conftest import WAYS, Grid, go, put, store
from streamlit.testing.v1 import AppTest

WORDS = (
    "abc",
    "nan",
    "1e308",
    "-1e308",
    "1e-300",
    "inf",
    "",
    None,
    "1,5",
    "-1",
    "0",
    "1,220",
    "5 foo",
    "1/0",
    "9" * 400,
)


def odd_things(column: pd.Series[Any], config: Any) -> tuple[Any, ...]:
    """What a browser lets one type into a column: what it is said to hold, or else what it holds."""
    held = "checkbox" if column.dtype == bool else "number" if pd.api.types.is_numeric_dtype(column) else "text"
    said = config["type_config"] if isinstance(config, dict) else {}
    kind = said.get("type", held)
    assert kind != "number", "a browser's own number cells swallow what they do not understand"
    if kind == "selectbox":
        return tuple(said["options"])
    return {"checkbox": (True, False), "text": WORDS}[kind]


def crashes(app: AppTest, grid: Grid, way: str) -> list[str]:
    """What crashes where the tables are given odd things, each of them in its column."""
    go(app, put(app, way))
    assert not app.exception, [e.message for e in app.exception]
    held, crashed = store(app), list[str]()
    good = held.project
    assert grid.shown
    for name, frame in list(grid.shown.items()):
        things = {column: odd_things(frame[column], grid.columns[name].get(column)) for column in frame}
        rows = sorted({0, len(frame) - 1})
        for column, row in product(things, rows):
            for value in things[column][rows.index(row) :: len(rows)]:
                grid.typed = (name, row, column, value)
                for _ in range(2):  # as it is typed, and as it stands then
                    app.run()
                    crashed += [
                        f"{name}[{row}, {column}] = {str(value)[:20]}: {e.message[:300]}" for e in app.exception
                    ]
                assert grid.typed is None, name
                held.project, held.refused, held.revision = good, {}, held.revision + 1
    return crashed


@pytest.mark.slow
@pytest.mark.parametrize("way", WAYS)
def test_every_odd_thing_in_every_column_is_taken_or_refused(app: AppTest, grid: Grid, way: str) -> None:
    assert not crashes(app, grid, way)
