"""The toolpath page of a set-up whose path is given point by point: shown, run, and made what can be edited."""

from __future__ import annotations

import dataclasses

from conftest import errors, go, store, words
from streamlit.testing.v1 import AppTest

from robomill.toolpath.path import Toolpath


def test_points_are_shown_run_and_made_a_table_of_lines(app: AppTest) -> None:
    path = Toolpath.from_points(p_mm=[[-50, 0, 5], [-50, 0, -2], [50, 0, -2]], feed_mm_min=[0, 600, 1800])
    held = store(app)
    held.project = dataclasses.replace(held.project, setup=held.project.setup.replace(source=path))
    go(app, "5_Toolpath")
    assert not app.exception
    assert not errors(app)
    assert "3 points from a file" in words(app)
    assert "2 moves, 100.0 × 7.0 mm along X and Z" in words(app)
    app.button_group(key="toolpath.kind").set_value("lines").run()
    assert not app.exception
    source = store(app).project.setup.source
    assert source.kind == "lines"
    assert source.read().p[-1].tolist() == path.p[-1].tolist()
