"""Odd words and numbers in every cell of every table that is edited: taken or refused in a sentence, never a crash."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import Any

import pandas as pd
import pytest
import streamlit as st
from conftest import go, store
from streamlit.testing.v1 import AppTest

from robomill.toolpath.source import SketchSource
from robomill.ui import inputs
from robomill.ui.project import Project, preset_setup
from robomill.ui.toolpath.sources import lines_of_path, sketch_of_path

WORDS = ("abc", "nan", "1e308", "-1e308", "1e-300", "inf", "", "1,5", "9" * 400)
NUMBERS = (1e308, -1e308, 1e-300, 0.0, -1.0, None)


class Grid:
    """In the place of Streamlit's grid, which no AppTest can type into: it shows the tables and types into a cell."""

    def __init__(self) -> None:
        self.shown: dict[str, pd.DataFrame] = {}
        self.odd: dict[str, dict[str, tuple[Any, ...]]] = {}
        self.typed: tuple[str, int, str, Any] | None = None

    def __call__(
        self,
        frame: pd.DataFrame,
        *,
        key: str,
        on_change: Callable[[], None],
        disabled: Any,
        column_config: Any,
        **_: Any,
    ) -> None:
        name = key.rpartition(":")[0]
        self.shown[name] = frame.drop(columns=[c for c in disabled if c in frame])
        self.odd[name] = {c: odd_things(frame[c], (column_config or {}).get(c)) for c in self.shown[name]}
        if self.typed is not None and self.typed[0] == name:
            _, row, column, value = self.typed
            self.typed = None
            st.session_state[key] = {"edited_rows": {row: {column: value}}}
            on_change()


def odd_things(column: pd.Series[Any], config: Any) -> tuple[Any, ...]:
    """What a browser lets one type into a column: what it is said to hold, or else what it holds."""
    held = "checkbox" if column.dtype == bool else "number" if pd.api.types.is_numeric_dtype(column) else "text"
    said = config["type_config"] if isinstance(config, dict) else {}
    kind = said.get("type", held)
    if kind == "selectbox":
        return tuple(said["options"])
    return {"checkbox": (True, False), "number": NUMBERS, "text": WORDS}[kind]


@pytest.fixture
def grid(monkeypatch: pytest.MonkeyPatch) -> Grid:
    """What stands in the place of Streamlit's grid."""
    made = Grid()
    monkeypatch.setattr(inputs.st, "data_editor", made)
    return made


def put(app: AppTest, way: str) -> str:
    """Open a set-up with the tables of one kind; the page that shows them."""
    held = store(app)
    setup = preset_setup("two_tools" if way == "tools" else "paper_flute")
    if way == "lines":
        setup = setup.replace(source=lines_of_path(setup.toolpath))
        held.values["toolpath.way"] = "points"
    if way == "shapes":
        drawn = sketch_of_path(setup.toolpath)
        assert drawn is not None
        setup = setup.replace(source=SketchSource(drawn))
    if way == "springs":
        held.values |= {f"springs.{kind}": True for kind in ("joint_bending", "weight")}
    held.project = Project(setup)
    held.revision += 1
    return {"robot": "1_Robot", "lines": "5_Toolpath", "shapes": "5_Toolpath"}.get(way, "6_Milling")


def crashes(app: AppTest, grid: Grid, way: str, each: bool) -> list[str]:
    """What crashes where the tables are given odd things: ``each`` of them in each cell, or one after the other."""
    go(app, put(app, way))
    assert not app.exception, [e.message for e in app.exception]
    held, crashed, turn = store(app), [], 0
    good = held.project
    assert grid.shown
    for name, frame in list(grid.shown.items()):
        for row, column in product(sorted({0, len(frame) - 1}), grid.odd[name]):
            odd, turn = grid.odd[name][column], turn + 1
            for value in odd if each else (odd[turn % len(odd)],):
                grid.typed = (name, row, column, value)
                for _ in range(2):  # as it is typed, and as it stands then
                    app.run()
                    crashed += [
                        f"{name}[{row}, {column}] = {str(value)[:20]}: {e.message[:300]}" for e in app.exception
                    ]
                assert grid.typed is None, name
                held.project, held.refused, held.revision = good, {}, held.revision + 1
    return crashed


WAYS = ("robot", "lines", "shapes", "springs", "tools")


@pytest.mark.parametrize("way", WAYS)
def test_an_odd_thing_in_each_cell_is_taken_or_refused(app: AppTest, grid: Grid, way: str) -> None:
    assert not crashes(app, grid, way, each=False)


@pytest.mark.slow
@pytest.mark.parametrize("way", WAYS)
def test_every_odd_thing_in_every_cell_is_taken_or_refused(app: AppTest, grid: Grid, way: str) -> None:
    assert not crashes(app, grid, way, each=True)
