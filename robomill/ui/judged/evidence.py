"""The paper's milling test on one chart: what it claims, what it measured, and what comes out of process data here."""

import dataclasses

import streamlit as st

from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.paper import SLOT
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.stations import sideways
from robomill.ui import pieces
from robomill.ui.project import DEFAULT_PRESET, Project, preset_setup
from robomill.ui.work import cached, running
from robomill.units import format_si, from_si
from robomill.viz.evidence import Claim, evidence_figure


@st.cache_resource(show_spinner=False)
def _process_setup() -> SimulationSetup:
    return load_setup(samples_dir() / DEFAULT_PRESET / "setup_process.toml")


def is_papers_path(project: Project) -> bool:
    """Whether the project cuts the paper's slot, by the text of its program: beside another part the chart misleads."""
    source, paper = project.setup.source, preset_setup(DEFAULT_PRESET).source
    if source.kind == "program" and paper.kind == "program":
        return source.text == paper.text
    return source == paper


def claims(project: Project, process: bool = False) -> list[Claim]:
    """Numbers of the paper's slot in m: its own beside those computed here, and the project's where it was edited.

    With ``process`` also the two that come out of process data, with the band of the alloy's rows: these take longer.
    """
    rows = _papers(process)
    setup = project.setup
    known = [preset_setup(DEFAULT_PRESET), *([_process_setup()] if process else [])]
    if setup.digest() not in {each.digest() for each in known} and running.there(setup):
        rows = [*rows, dataclasses.replace(_computed("robomill, your set-up", setup), kind="user")]
    return rows


@cached.shared(lambda process: process, "The paper's test, computed")
def _papers(process: bool) -> list[Claim]:
    """What is the same for everyone."""
    plain, force = preset_setup(DEFAULT_PRESET), format_si(SLOT.force, "N", 0)
    third = plain.robot.with_compliance_set("table_3")
    rows = [
        Claim("paper, predicted from Table 2", "paper", SLOT.from_table_2, note=f"{force} measured force"),
        _computed(f"robomill, {force}, Table 2", plain),
        _computed(f"robomill, {force}, Table 3", plain.replace(robot=third)),
        Claim("paper, predicted from its measured map", "paper", SLOT.from_map, note="raw data not printed"),
        Claim("paper, measured on the part", "measured", SLOT.measured, note="in the paper's words", rough=True),
    ]
    if process:
        rows.append(_computed("robomill, process data, Table 2", _process_setup()))
        rows.append(_computed("robomill, process data, Table 3", _process_setup().replace(robot=third)))
    return rows


def _computed(label: str, setup: SimulationSetup) -> Claim:
    value, low, high = _sideways(setup)
    return Claim(label, "computed", value, low, high, note="middle of the groove")


@cached.shared(cached.by_setup, "The groove at mid-cut")
def _sideways(setup: SimulationSetup) -> tuple[float, float, float]:
    return sideways(cached.result(setup))


def panel(project: Project, dark: bool) -> None:
    """The chart with its caption and its table."""
    unit = project.view.length
    found = pieces.attempt(claims, project, True)
    if found is None:
        return
    lengths = ("value", "low", "high")
    shown = []
    for claim in found:
        value, low, high = (float(from_si(getattr(claim, k), unit)) for k in lengths)
        shown.append(dataclasses.replace(claim, value=value, low=low, high=high))
    pieces.figure(
        evidence_figure(shown, unit, dark=dark),
        "evidence",
        name="paper-evidence",
        table=lambda: {
            "what": [c.label for c in shown],
            "kind": [c.kind for c in shown],
            **{f"{k}_{unit}": [getattr(c, k) for c in shown] for k in lengths},
        },
        caption="Dashed: measured on the part. Process data: the force follows from cutter, feed and material; its bar "
        "is over every published coefficient of 7075. The paper names neither alloy nor helix: 7075-T6 and a "
        "right-hand helix are assumed; no force and no stiffness is tuned to what was measured.",
        alt="The paper's predictions and measurement beside the values computed from process data, with their band.",
    )
