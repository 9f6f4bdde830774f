"""What the tiles and the sentence say of a run, against numbers worked out here."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from robomill.cutting.unjudged import Unjudged
from robomill.report.ranges import Range
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import simulate
from robomill.simulation.setup import SimulationSetup
from robomill.ui.judged import verdict as panel
from robomill.ui.project import preset_setup

WALL, FLOOR = 0.22953, -0.1024  # mm, from Table 2 and 100 N: 0.2295 to four digits


@pytest.fixture(scope="module")
def setup() -> SimulationSetup:
    return preset_setup("paper_flute")


def tiles(result: SimulationResult, unit: str = "mm") -> dict[str, panel.Tile]:
    return {tile.label: tile for tile in panel.verdict_tiles(result, unit)}


def unjudged(setup: SimulationSetup, share: float) -> SimulationResult:
    """The run with its first steps as if no model held there."""
    result = simulate(setup)
    cutting = np.flatnonzero(result.path.cutting)
    lost = np.zeros(len(result.path), dtype=bool)
    lost[cutting[: round(share * len(cutting))]] = True
    nothing = np.where(lost[:, None], np.nan, 1.0)
    return dataclasses.replace(
        result, F=result.F * nothing, delta=result.delta * nothing, unjudged=(Unjudged("drill", lost, "No thrust."),)
    )


def test_wall_and_floor_are_judged_apart(setup: SimulationSetup) -> None:
    shown = tiles(simulate(setup))
    assert shown["Wall error"].value == f"+{WALL:.3f} mm"
    assert shown["Floor error"].value == f"−{-FLOOR:.3f} mm"
    assert f"{100 * WALL / 0.3:.0f} % of 0.30 mm" in shown["Wall error"].note
    assert f"{100 * -FLOOR / 0.3:.0f} % of 0.30 mm" in shown["Floor error"].note
    assert shown["Tip off its path"].value == f"{np.hypot(WALL, FLOOR):.3f} mm"
    assert shown["Verdict"].tone == "ok"
    assert tiles(simulate(setup), "in")["Wall error"].value == f"+{WALL / 25.4:.4f} in"


def test_a_tolerance_of_its_own_for_floors_reddens_the_same_cut(setup: SimulationSetup) -> None:
    shown = tiles(simulate(setup.replace(floor_tolerance=0.05e-3)))
    assert shown["Verdict"].tone == "out"
    assert f"{100 * -FLOOR / 0.05:.0f} % of 0.05 mm" in shown["Floor error"].note
    assert f"{100 * WALL / 0.3:.0f} % of 0.30 mm" in shown["Wall error"].note


@pytest.mark.parametrize("share", [0.3, 1.0])
def test_what_is_not_judged_is_counted_and_never_green(setup: SimulationSetup, share: float) -> None:
    result = unjudged(setup, share)
    total = int(result.path.cutting.sum())
    count = round(share * total)
    shown = tiles(result)
    assert shown["Verdict"].tone == "unjudged"
    assert f"{count} of {total} points" in shown["Verdict"].note
    sentence = panel.verdict_sentence(result)
    assert f"{count} of {total} points" in sentence
    if share == 1.0:
        empty = [shown[name] for name in ("Wall error", "Floor error", "Tip off its path")]
        assert {(tile.value, tile.note) for tile in empty} == {("–", "not judged")}


def test_inputs_in_the_other_direction_lead_to_the_other_wall(setup: SimulationSetup) -> None:
    force = dataclasses.replace(setup.force, feed_normal=-setup.force.feed_normal)  # type: ignore[type-var, attr-defined]
    tile = tiles(simulate(setup.replace(force=force)))["Wall error"]
    assert tile.value == f"−{WALL:.3f} mm"
    assert "to the right" in tile.note


@pytest.mark.parametrize(("high", "may"), [(0.99, False), (1.09, True)])
def test_a_green_cut_whose_ends_lie_beyond_the_tolerance_says_so(
    setup: SimulationSetup, high: float, may: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    none = (float("nan"), float("nan"))
    found = (Range("assumed lengths", "assumed", none, none, none, (0.7, high)),)
    monkeypatch.setattr(panel, "ranges_of", lambda result: found)
    result = simulate(setup)
    said = tiles(result)["Verdict"].ranges
    assert ("so it could be out of tolerance" in said) is may
    assert "so it could be out of tolerance" not in tiles(simulate(setup.replace(tolerance=1e-4)))["Verdict"].ranges


def test_one_range_leads_and_the_others_stand_by_the_verdict(
    setup: SimulationSetup, monkeypatch: pytest.MonkeyPatch
) -> None:
    none = (float("nan"), float("nan"))
    little = Range("as teeth come by", "computed", (2.2e-4, 2.4e-4), none, (2.4e-4, 2.6e-4), (0.73, 0.80))
    much = Range("assumed lengths", "assumed", (2.1e-4, 3.2e-4), none, (2.3e-4, 3.3e-4), (0.70, 1.07))
    monkeypatch.setattr(panel, "ranges_of", lambda result: (little, much))
    monkeypatch.setattr(panel, "_ranges", lambda result, known: (little, much))
    shown = tiles(simulate(setup))
    assert shown["Wall error"].ranges == ["+0.210 to +0.320: assumed lengths"]
    assert shown["Floor error"].ranges == []
    assert shown["Verdict"].ranges == [
        "70 % to 107 %: assumed lengths",
        "so it could be out of tolerance",
        "73 % to 80 %: as teeth come by",
    ]
    assert panel.headline(simulate(setup)).endswith(
        "(77 % of it used). It could be out (up to 107 %: assumed lengths)."
    )
    monkeypatch.setattr(panel, "_ranges", lambda result, known: (little,))
    assert panel.headline(simulate(setup)) == panel.verdict_sentence(simulate(setup))


def test_what_a_later_pass_cleans_up_is_said_and_what_is_nothing_is_left_out(setup: SimulationSetup) -> None:
    assert tiles(simulate(setup))["Tip off its path"].note == "Y +0.230, Z −0.102 · most at line 7"
    assert tiles(simulate(preset_setup("pocket_arcs")))["Tip off its path"].note.endswith(
        "most at line 6: a later pass cleans that place up"
    )
