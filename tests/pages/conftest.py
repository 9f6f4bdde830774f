"""The pages without a browser; rendered pictures are left out, they have tests of their own."""

from __future__ import annotations

from pathlib import Path

import pytest
from plotly_checks import checked_figure
from streamlit.testing.v1 import AppTest
from streamlit.testing.v1.element_tree import NumberInput

from robomill.ui import beside, rendered
from robomill.ui.session import KEY, Store
from robomill.viz.chart import Chart
from robomill.viz.render_queue import RenderQueue
from robomill.viz.worker import NO_OPENGL, RenderWorker

ROOT = Path(__file__).resolve().parents[2]


class NoPictures(RenderWorker):
    """A machine without OpenGL."""

    def start(self) -> None:
        for _ in range(9):
            self._starts.note(NO_OPENGL)


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
    return "\n".join(parts)


def errors(app: AppTest) -> list[str]:
    """What the page refuses."""
    return [element.value for element in app.error]


def box(app: AppTest, label: str) -> NumberInput:
    """The number box with this label."""
    return next(b for b in app.number_input if b.label == label)
