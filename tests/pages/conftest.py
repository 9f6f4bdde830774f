"""The pages without a browser; rendered pictures are left out, they have tests of their own."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
import streamlit as st
from plotly_checks import checked_figure
from streamlit.components.v2 import manifest_scanner
from streamlit.runtime.scriptrunner.script_cache import ScriptCache
from streamlit.testing.v1 import AppTest
from streamlit.testing.v1.element_tree import TextInput

from robomill.toolpath.rewritten import lines_of_path, sketch_of_path
from robomill.toolpath.source import SketchSource
from robomill.ui import rendered
from robomill.ui.entry import inputs
from robomill.ui.project import Project, preset_setup
from robomill.ui.session import KEY, Store
from robomill.ui.work import beside
from robomill.viz.chart import Chart
from robomill.viz.rendered.render_queue import RenderQueue
from robomill.viz.rendered.worker import NO_OPENGL, RenderWorker

ROOT = Path(__file__).resolve().parents[2]
PAGES = ("app", *sorted(file.stem for file in (ROOT / "pages").glob("[0-9]_*.py")))
"""Every page, the start page first."""


class NoPictures(RenderWorker):
    """A machine without OpenGL."""

    def start(self) -> None:
        for _ in range(9):
            self._starts.note(NO_OPENGL)


@pytest.fixture(scope="session", autouse=True)
def _looked_up_once() -> Iterator[None]:
    """An AppTest asks every package for components when it begins and compiles its pages at every run, half of a short
    test's time; neither changes while tests run."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(manifest_scanner, "scan_component_manifests", cache(manifest_scanner.scan_component_manifests))
        of_page = ScriptCache.get_bytecode
        compiled: dict[str, Any] = {}

        def get_bytecode(self: ScriptCache, path: str) -> Any:
            if path not in compiled:
                compiled[path] = of_page(self, path)
            return compiled[path]

        patched.setattr(ScriptCache, "get_bytecode", get_bytecode)
        yield


@pytest.fixture(autouse=True)
def _waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages are looked at with what they make beside themselves."""
    monkeypatch.setattr(beside, "FIRST_S", 60.0)


@pytest.fixture
def app(monkeypatch: pytest.MonkeyPatch) -> AppTest:
    """The start page, run once."""
    monkeypatch.setattr(Chart, "figure", property(checked_figure))
    queue = RenderQueue(NoPictures())
    monkeypatch.setattr(rendered, "queue", lambda: queue)
    return AppTest.from_file(str(ROOT / "app.py"), default_timeout=60).run()


def go(app: AppTest, page: str) -> AppTest:
    """Another page of the same session."""
    return app.switch_page(f"pages/{page}.py" if page != "app" else "app.py").run()


def store(app: AppTest) -> Store:
    """The session's store."""
    kept = app.session_state[KEY]
    assert isinstance(kept, Store)
    return kept


def words(app: AppTest) -> str:
    """Every piece of HTML and text on the page."""
    parts = [element.proto.body for element in app.get("html")] if app.get("html") else []
    for kind in ("markdown", "caption", "error", "info", "warning"):
        parts += [element.value for element in app.get(kind)]
    return "\n".join(parts).replace("\u00a0", " ")  # a number and its unit are held together


def looked(app: AppTest, **view: Any) -> None:
    """As if the browser had settled on a look at the cut (no AppTest can move what is drawn there)."""
    held = store(app)
    held.project = held.project.replace(view=dataclasses.replace(held.project.view, **view))
    app.run()


def errors(app: AppTest) -> list[str]:
    """What the page refuses."""
    return [element.value for element in app.error]


class Grid:
    """In the place of Streamlit's grid, which no AppTest can type into: it shows the tables and types into a cell."""

    def __init__(self) -> None:
        self.shown: dict[str, pd.DataFrame] = {}
        self.columns: dict[str, dict[str, Any]] = {}
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
        self.columns[name] = dict(column_config or {})
        if self.typed is not None and self.typed[0] == name:
            _, row, column, value = self.typed
            self.typed = None
            st.session_state[key] = {"edited_rows": {row: {column: value}}}
            on_change()


@pytest.fixture
def grid(monkeypatch: pytest.MonkeyPatch) -> Grid:
    """What stands in the place of Streamlit's grid."""
    made = Grid()
    monkeypatch.setattr(inputs.st, "data_editor", made)
    return made


WAYS = ("robot", "lines", "shapes", "springs", "tools")


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


class Number:
    """A number box, which is a line of text: the number it shows, and a number typed into it as Python writes it."""

    def __init__(self, line: TextInput) -> None:
        self.line = line

    @property
    def value(self) -> float:
        """What it shows, which is a number as any program reads it."""
        return float(self.line.value or "nan")

    def set_value(self, value: float) -> TextInput:
        """Type a number."""
        return self.line.set_value(str(value))


def number(app: AppTest, key: str) -> Number:
    """The number box with this key."""
    return Number(app.text_input(key=key))


def box(app: AppTest, label: str) -> Number:
    """The number box with this label."""
    return Number(next(b for b in app.text_input if b.label == label))
