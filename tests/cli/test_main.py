"""Starting the command line."""

from __future__ import annotations

import sys
from types import ModuleType

import pytest

from robomill import __main__


class Interrupted(ModuleType):
    """A module during whose loading somebody presses Ctrl-C."""

    def __getattr__(self, name: str) -> None:
        raise KeyboardInterrupt


def test_an_interrupt_while_it_loads_has_the_exit_code_of_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "robomill.cli", Interrupted("robomill.cli"))
    assert __main__.main() == 130
