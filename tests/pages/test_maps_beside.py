"""A map that takes long is made beside the page: progress, cancel, a button that begins it again, and then the map."""

from __future__ import annotations

import threading
from typing import Any

import pytest
from conftest import go, store, words
from streamlit.testing.v1 import AppTest

from robomill.progress import checkpoint
from robomill.ui.posed import fields
from robomill.ui.work import beside, cached
from robomill.ui.work.job import Job
from robomill.workspace.region import largest_region


def test_the_largest_box_is_looked_for_beside_the_page(app: AppTest, monkeypatch: pytest.MonkeyPatch) -> None:
    begun, ended, let_go = threading.Event(), threading.Event(), threading.Event()

    def slow(*arguments: Any) -> Any:
        begun.set()
        try:
            while not let_go.wait(0.01):
                checkpoint(0.25, "Boxes")
            return largest_region(*arguments)
        finally:
            ended.set()

    cached.commons.clear()
    monkeypatch.setattr(fields, "largest_region", slow)
    monkeypatch.setattr(beside, "FIRST_S", 0.1)
    for _ in range(20):  # the other maps of the page take what they take
        go(app, "2_Workspace")
        if begun.is_set() and "least |det(J)|" in words(app):
            break
    assert not app.exception
    place = next(key for key, kept in store(app).values.items() if isinstance(kept, Job))
    assert store(app).values[place].progress.stage == "Boxes"
    app.button(key=f"{place}.cancel").click().run()
    assert ended.wait(30)
    assert "not computed yet" in words(app)
    let_go.set()
    monkeypatch.setattr(beside, "FIRST_S", 60.0)
    app.button(key=f"{place}.ask").click().run()
    assert not app.exception
    assert "not computed yet" not in words(app)
    assert "Largest box in reach" in words(app)
    assert not [kept for kept in store(app).values.values() if isinstance(kept, Job)]
