"""How much of a cut must be judged before a number stands for it: nothing of a cut of unknown force, part of others."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.cli import main
from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.cutting.tool import Cutter
from robomill.cutting.unjudged import Unjudged
from robomill.io.materials import load_material
from robomill.io.setups.projects import setup_to_toml
from robomill.report.plain import simulation_lines
from robomill.report.simulation_record import simulation_record
from tests.simulation.judging.pushed_runs import SETUP, pushed, run

BLIND = load_material("al6061_t6_carbide_ref160")  # gives no axial coefficients
MILL = Cutter("flat", 8e-3, flutes=3)
SLOT = ("G0 X-30 Y0 Z5", "G0 Z-2", "G1 X30 F1800")
ROUND = (
    "G0 X-20 Y-10 Z5",
    "G1 Z-2 F300",
    *("G1 X20 F1200", "G1 Y10", "G1 X-20", "G1 Y-10"),
    *("G1 X20", "G1 Y10", "G1 X-20", "G1 Y-10"),  # once more, through air
)


@pytest.fixture(scope="module")
def blind() -> rm.SimulationResult:
    """A frame that is milled twice round, with a material whose axial force nobody knows."""
    return run(*ROUND, cutter=MILL, force=MechanisticForce(MILL, BLIND), engagement=True)


def lost(result: rm.SimulationResult, share: float) -> rm.SimulationResult:
    """The run with no number on the first ``share`` of what it cuts."""
    cuts = np.flatnonzero(result.path.cutting & result.conditions.engaged)
    where = np.zeros(len(result.path), dtype=bool)
    where[cuts[: round(share * len(cuts))]] = True
    unknown = np.where(where[:, None], np.nan, 1.0)
    return replace(
        result,
        F=result.F * unknown,
        delta=result.delta * unknown,
        unjudged=(Unjudged("drill", where, "no thrust."),),
    )


def test_a_second_time_round_pushes_nothing_and_is_no_reading(blind: rm.SimulationResult) -> None:
    """Half the length has a force of 0 N, since nothing is left for it to cut: what the first round left is unknown."""
    again = blind.path.cutting & ~blind.not_judged
    assert blind.path.step_length[again].sum() > 0.4 * blind.path.s[-1]
    assert not blind.force_size[again].any()
    verdict = blind.verdict
    assert (verdict.level, verdict.decides, blind.worst) == ("unjudged", False, -1)
    assert verdict.sentence.startswith(f"Cannot be judged: the axial force of {BLIND.title} is not known; ")
    assert "take another material" in verdict.sentence
    assert "0.00" not in verdict.sentence
    assert "olerance" not in verdict.sentence.replace("tolerances", "")
    assert rm.simulate(blind.setup.replace(force=replace(blind.setup.force, axial_share=0.2))).verdict.decides


def test_records_and_lines_of_it_have_no_number_either(blind: rm.SimulationResult) -> None:
    record = simulation_record(blind)
    for name in ("wall", "floor", "feed", "end"):
        assert record[name]["line"] is None
        assert not np.isfinite(record[name]["value_mm"])
    told = "\n".join(simulation_lines(record))
    assert "within" not in told
    assert "wall      not judged" in told
    assert "in a file: Kac, Kae, axial_share" in told


def test_the_command_line_says_so(blind: rm.SimulationResult, tmp_path, capsys) -> None:
    (tmp_path / "setup.toml").write_text(setup_to_toml(blind.setup))
    assert main(["simulate", str(tmp_path / "setup.toml"), "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert found["verdict"] == "unjudged"
    assert found["verdict_sentence"].startswith("Cannot be judged: the axial force of ")
    assert found["wall"]["value_mm"] is None
    assert found["share"] is None


@pytest.mark.parametrize("share", [0.2, 0.45, 0.55, 0.85, 0.95])
@pytest.mark.parametrize("off", [0.1e-3, 0.5e-3])
def test_within_tolerance_is_said_of_most_of_a_cut_and_out_of_it_of_any_part(share: float, off: float) -> None:
    """A slot of which a share has no number, of 0.3 mm allowed: the rest is off by 0.1 or by 0.5 mm."""
    half = lost(pushed(run(*SLOT), left=off), share)
    verdict, sentence = half.verdict, half.verdict.sentence
    assert verdict.red
    if share > 0.9:
        assert sentence.startswith("Cannot be judged: no thrust. ")
        assert "mm" not in sentence
        return
    assert f"{off * 1e3:.2f} mm off in Y" in sentence
    assert ("out of tolerance" in sentence) == (off > 0.3e-3)
    assert ("within tolerance" in sentence) == (off < 0.3e-3 and share < 0.5)
    assert ("where it is judged" in sentence) == (off < 0.3e-3)


def test_a_cut_that_is_all_judged_counts_its_passes_through_air() -> None:
    """Nothing is unknown then: what the first pass left is there to be read beside the second."""
    twice = run(*SLOT, "G1 X-30", cutter=MILL, engagement=True, force=SETUP.force)
    assert not twice.not_judged.any()
    assert (twice.judged & (twice.path.block == 5)).any()


def test_of_a_way_at_feed_that_meets_nothing_none_is_judged_where_its_force_is_unknown() -> None:
    air = run("G0 X-30 Y0 Z8", "G1 X30 F1800")
    unknown = replace(air, F=np.where(air.path.cutting[:, None], np.nan, air.F))
    assert unknown.not_judged.any()
    assert not unknown.judged.any()
    assert not unknown.mostly_judged
    assert air.mostly_judged


def test_what_cuts_is_at_feed_and_has_an_answer_at_both_of_its_ends() -> None:
    """Step by step, a slot there and back between rapids, with no number on a third of it."""
    made = lost(run(*SLOT, "G0 Z5", "G0 X-35", "G0 Z-2", "G1 X-30 Y3"), 0.3)
    has = made.reached & np.isfinite(made.delta).all(axis=1)
    cuts = [bool(made.path.cutting[i] and has[i] and has[i - 1]) for i in range(1, len(has))]
    assert made.removes.tolist() == [False, *cuts]
    assert 0 < sum(cuts) < made.path.cutting.sum() < len(cuts)
