"""The strip of carved samples: a small picture of each as it would be milled, its predicted error; a click opens it."""

import base64
import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import streamlit as st

from robomill.report.tags import Html
from robomill.simulation.judging.verdict_words import Level
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.ui.judged.verdict import WORDS
from robomill.ui.markup import unparted
from robomill.ui.project import preset_setup
from robomill.units import format_beside, format_limit, format_times, to_si

HERE = Path(__file__).parent


@dataclass(frozen=True)
class Carved:
    """A sample: the reading that decides its verdict and its tolerance, m; what it is judged."""

    sample: str
    value: float
    tolerance: float
    level: Level

    def picture(self, dark: bool) -> Path:
        """The part with its displacement enlarged, for a light or a dark page."""
        return HERE / "carved" / f"{self.sample}{'-dark' * dark}.webp"

    def address(self, dark: bool) -> str:
        """The picture itself: that of a file would be decoded and encoded anew whenever the page runs."""
        return _address(self.picture(dark))


@cache
def _address(picture: Path) -> str:
    return f"data:image/webp;base64,{base64.b64encode(picture.read_bytes()).decode()}"


@cache
def carved() -> tuple[float, tuple[Carved, ...]]:
    """How many times the displacement is drawn in the pictures, and the samples."""
    said = tomllib.loads((HERE / "carved.toml").read_text(encoding="utf-8"))
    rows = []
    for row in said["carved"]:
        value, tolerance = (float(to_si(row[f"{each}_mm"], "mm")) for each in ("value", "tolerance"))
        rows.append(Carved(row["sample"], value, tolerance, row["level"]))
    return float(said["times"]), tuple(rows)


def strip(unit: str, dark: bool) -> None:
    """The six beside each other; a click opens the sample."""
    times, rows = carved()
    with st.container(key="carved"):
        for row in rows:
            title = preset_setup(row.sample).name
            off = f"{format_beside(row.value, row.tolerance, unit, 2)} of {format_limit(row.tolerance, unit)}"
            with st.container(key=f"carved-{row.sample}"):
                alt = f"{title}: {off} allowed, {WORDS[row.level].lower()}; displacement shown {format_times(times)}."
                st.image(row.address(dark), alt=alt, width="stretch")
                inputs.button(title, f"start.open.{row.sample}", "", session.open_preset, row.sample, type="tertiary")
                out = Html(' <span class="rm-card-out">out of tolerance</span>') if row.level == "out" else ""
                pieces.note(unparted(off), out)
    pieces.note(
        "Six examples, each with its own robot; under each its largest surface error, of the tolerance allowed. "
        f"{_shown(times)}"
    )


def _shown(times: float) -> str:
    return f"Displacement shown {format_times(times)}; a click opens one."
