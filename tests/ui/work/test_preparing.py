"""The first start: how far it is, counted from what is on disk; how long it takes, told honestly."""

from __future__ import annotations

import threading
from typing import Any

import pytest
from streamlit.testing.v1 import AppTest

from robomill import compiled, seals
from robomill.ui.work import preparing


def test_as_many_parts_are_done_as_kernels_are_sealed(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled, "kept_in", lambda: tmp_path)
    done, count = preparing.so_far()
    assert done == 0
    assert count >= 20
    for k in range(3):
        (tmp_path / f"robomill_{k}").mkdir()
        (tmp_path / f"robomill_{k}" / f"kernels.f{seals.SEAL}").touch()
    assert preparing.so_far() == (3, count)


def test_a_start_that_takes_longer_than_usual_says_so() -> None:
    assert preparing.words(5.0) == "It takes about a minute."
    assert preparing.words(250.0) == "It takes longer than usual (4 min so far) and goes on: the computer is busy."


def test_a_page_waits_with_the_name_of_the_app_and_n_of_m_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    told, go_on = [], threading.Event()
    monkeypatch.setattr(preparing, "_ready", threading.Event())
    monkeypatch.setattr(preparing, "_made", [])
    monkeypatch.setattr(compiled, "missing", lambda: ("robomill.kinematics.kernels",))
    monkeypatch.setattr(compiled, "build", lambda: go_on.wait(20.0))
    monkeypatch.setattr(preparing, "EVERY_S", 0.01)

    def so_far() -> tuple[int, int]:
        told.append(len(told))
        if len(told) == 3:
            go_on.set()
        return 4, 30

    shown: list[Any] = []
    monkeypatch.setattr(preparing, "so_far", so_far)
    monkeypatch.setattr(preparing.st, "rerun", lambda: shown.append("again"))

    def page() -> None:
        from robomill.ui.work import preparing

        preparing.wait()

    app = AppTest.from_function(page).run()
    assert not app.exception
    assert shown == ["again"]
    assert len(told) >= 3
    bodies = " ".join(element.proto.body for element in app.get("html"))
    assert "robomill" in bodies
    assert "Preparing the calculation for this computer" in bodies
    assert app.get("progress")[0].proto.text == "4 of 30 parts"
