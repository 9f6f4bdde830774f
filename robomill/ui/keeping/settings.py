"""What is kept of people's work on the server, where and how much: every bound once, each to be set from outside."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from robomill.errors import ProjectError

PREFIX = "ROBOMILL_AUTOSAVE"  # of the environment variables that set what follows
METRICS = "ROBOMILL_METRICS"  # on: the server's owner wants Streamlit's figures of it


@dataclass(frozen=True)
class Settings:
    """Whether work is kept, where, and how much: ``ROBOMILL_AUTOSAVE=off`` or, say, ``ROBOMILL_AUTOSAVE_DAYS=7``.

    entry_MB, all_MB   of one entry and of all; the oldest go first
    days               after which an entry that was not touched goes
    tabs, names        entries of one browser: of its tabs (and as many that these are held against), and under a name
    """

    on: bool = True
    folder: Path = Path()
    entry_MB: float = 25.0
    all_MB: float = 1000.0
    days: float = 30.0
    tabs: int = 8
    names: int = 20

    @classmethod
    def of(cls, environment: Mapping[str, str]) -> Settings:
        """As the environment says. Raises ProjectError where it says what cannot be."""
        word = environment.get(PREFIX, "on").lower()
        if word not in ("on", "off"):
            raise ProjectError(f"{PREFIX} is {word!r:.40}; expected on or off.")
        given: dict[str, float] = {}
        for name in ("entry_MB", "all_MB", "days", "tabs", "names"):
            said = environment.get(f"{PREFIX}_{name.upper()}")
            if said is not None:
                if not re.fullmatch(r"\d{1,9}(\.\d{1,9})?", said) or not float(said):
                    raise ProjectError(f"{PREFIX}_{name.upper()} is {said!r:.40}; expected a number above 0.")
                given[name] = float(said)
        folder = Path(environment.get(f"{PREFIX}_FOLDER") or _state(environment) / "robomill" / "work")
        return cls(on=word == "on", folder=folder.expanduser(), **given)  # type: ignore[arg-type]


def _state(environment: Mapping[str, str]) -> Path:
    """Where programs of this system keep what outlives them."""
    if os.name == "nt":
        return Path(environment.get("LOCALAPPDATA") or "~/AppData/Local")
    if sys.platform == "darwin":
        return Path("~/Library/Application Support")
    return Path(environment.get("XDG_STATE_HOME") or "~/.local/state")
