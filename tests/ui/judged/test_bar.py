"""The bar says what the tiles say, of the same verdict; nothing that is not judged looks as if it were."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest
import streamlit as st

from robomill.cutting.unjudged import Unjudged
from robomill.provenance import Provenance
from robomill.simulation.judging.verdict_words import MOST
from robomill.simulation.run import simulate
from robomill.simulation.setup import SimulationSetup
from robomill.ui import session
from robomill.ui.judged import bar
from robomill.ui.project import preset_setup
from robomill.ui.session import Store
from robomill.ui.work import cached

WALL = 0.22953  # mm, from Table 2 and 100 N


@pytest.fixture(autouse=True)
def _own_session(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(st, "session_state", {})


@pytest.fixture(scope="module")
def setup() -> SimulationSetup:
    return preset_setup("paper_flute")


def shown(setup: SimulationSetup, unit: str = "mm", why: str = "") -> str:
    return str(bar.words(setup, simulate(setup), unit, why))


def marker(text: str) -> float:
    """Where the marker stands on the gauge, as a share of the tolerance, whose own mark tells the scale."""
    full = re.search(r"--full:([\d.]+)%", text)
    assert full is not None
    found = re.search(r'<b style="left:([\d.]+)%', text)
    assert found is not None
    return float(found[1]) / float(full[1])


def test_it_says_program_deviation_verdict_and_who_says_the_force(setup: SimulationSetup) -> None:
    text = shown(setup)
    for word in (
        "Reference groove (Slavkovic 2013)",
        "path.nc",
        "Within tolerance",
        "+0.230 mm",
        "−0.102 mm",
        "0.251 mm",
        "100 N",
    ):
        assert word in text, word
    assert '<span class="rm-badge rm-measured">measured</span>' in text
    assert 'class="rm-top ok"' in text
    assert marker(text) == pytest.approx(WALL / 0.3, abs=2e-3)
    assert 'aria-label="0.230 mm of 0.30 mm allowed, 77 %"' in text
    assert "0.0090 in" in shown(setup, "in")
    assert "mm" not in re.sub(r"<[^>]*>", "", shown(setup, "in"))


@pytest.mark.parametrize(("tolerance", "tone"), [(0.3, "ok"), (0.26, "tight"), (0.2, "out"), (0.01, "out")])
def test_the_gauge_is_the_verdicts_share_and_ends_beyond_the_tolerance(
    setup: SimulationSetup, tolerance: float, tone: str
) -> None:
    text = shown(setup.replace(tolerance=tolerance * 1e-3))
    assert f'class="rm-top {tone}"' in text
    assert marker(text) == pytest.approx(min(WALL / tolerance, MOST), rel=5e-3)


def test_what_is_not_judged_is_hatched_and_never_green(setup: SimulationSetup) -> None:
    result = simulate(setup)
    lost = result.path.cutting.copy()
    nothing = np.where(lost[:, None], np.nan, 1.0)
    unknown = dataclasses.replace(
        result, F=result.F * nothing, delta=result.delta * nothing, unjudged=(Unjudged("drill", lost, "No thrust."),)
    )
    text = str(bar.words(setup, unknown, "mm"))
    assert 'class="rm-top unjudged"' in text
    assert "Not judged" in text
    assert "<b style" not in text, "no marker on a gauge that measured nothing"


def test_a_program_that_nobody_has_spoken_for_is_hatched(setup: SimulationSetup) -> None:
    carried = {**setup.provenance, "force": dataclasses.replace(setup.provenance["force"], carried_from="another")}
    text = shown(setup.replace(provenance=carried))
    assert 'class="rm-top open"' in text
    assert "Not judged" in text
    assert "if the tool is pushed with 100 N" in text
    assert not {"rm-top ok", "Within tolerance"} & {word for word in ("rm-top ok", "Within tolerance") if word in text}


def test_after_an_edit_it_says_what_was(setup: SimulationSetup) -> None:
    st.session_state[session.KEY] = Store(dataclasses.replace(session.project(), setup=setup))
    cached.result(setup)
    stiffer = setup.robot.replace(C_theta=0.5 * setup.robot.C_theta)
    session.change(robot=stiffer)
    text = shown(session.project().setup)
    assert '<span class="rm-was" title="before the last edit">+0.230 mm</span>' in text
    assert "+0.115 mm" in text


def test_the_run_before_is_greyed_and_said_to_be_it(setup: SimulationSetup) -> None:
    text = shown(setup, why="not computed yet")
    assert "rm-top ok rm-old" in text
    assert "not computed yet; this was before" in text


def test_a_refusal_is_said_in_full_where_it_is_pointed_at(setup: SimulationSetup) -> None:
    text = str(bar.words(setup, None, "mm", 'Line 3, "S": <no speed>.'))
    assert 'title="Line 3, &quot;S&quot;: &lt;no speed&gt;."' in text
    assert "Not computed" in text
    assert "rm-top unjudged" in text


def test_the_force_of_a_material_that_somebody_said_is_computed_not_typed() -> None:
    """After the question what a program cuts was answered the bar said "user": nobody had typed a force."""
    setup = preset_setup("heart")
    said = setup.replace(provenance={**setup.provenance, "force": Provenance("user", "said of the program")})
    assert "rm-badge rm-computed" in shown(said)
    plain = preset_setup("paper_flute")
    typed = plain.replace(provenance={**plain.provenance, "force": Provenance("user", "entered in the app")})
    assert "rm-badge rm-user" in shown(typed)


def test_zero_and_tolerance_do_not_stand_on_each_other(setup: SimulationSetup) -> None:
    scale = r'<div class="rm-scale"><span>(.*?)</span><span style="left:([\d.]+)%">'
    for tolerance, zero in ((0.3e-3, "0"), (0.05e-3, "")):
        found = re.search(scale, shown(setup.replace(tolerance=tolerance)))
        assert found is not None
        assert found[1] == zero, f"the tolerance stands at {found[2]} % of the track"
