"""The verdict of a corrected program: it has one, or says what is not known."""

import json
from pathlib import Path

import pytest

import robomill as rm
from robomill.cli import main

BACK = "G21 G90 G17\nS12000 M3\nG0 X-50 Y0 Z20\nG0 Z2\nG1 Z-2 F300\nG1 X50 F600\nG0 X-50\nG0 Z20\nM30\n"
"""A slot, and back through it as a rapid: corrected, the slot is not where the rapid is told to go."""


@pytest.mark.parametrize("name", ["pocket_arcs", "spiral", "two_tools"])
def test_every_sample_whose_force_is_coupled_is_corrected_and_judged_throughout(name: str) -> None:
    """The text is run by itself: every point of the cut that the arm reaches has a force that agrees with its place."""
    setup = rm.load_setup(name).replace(coupling=True)
    found = rm.compensate(setup)
    run = rm.simulate(setup.replace(source=found.source))
    assert run.coupling is not None
    assert run.coupling.converged
    assert not run.not_judged.any()
    assert run.reached.all()
    assert run.verdict.level in ("ok", "tight")
    assert found.after.max < 0.35 * found.before.max
    assert "not-known" not in {each.code for each in found.findings}


def test_why_a_corrected_program_has_no_verdict_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    setup = rm.load_setup("paper_flute/setup_process").replace(source=rm.GCodeSource(BACK, "back.nc"))
    found = rm.compensate(setup)
    rapid = rm.simulate(setup.replace(source=found.source))
    assert rapid.rapids
    assert found.level == "unjudged"
    (told,) = (each for each in found.findings if each.code == "not-known")
    assert "not known" in told.message
    assert "A rapid runs through material" in told.message
    rm.write_setup(tmp_path / "back.toml", setup)
    asked = ["compensate", str(tmp_path / "back.toml"), "--out", str(tmp_path / "corrected.nc"), "--json"]
    assert main(asked) == 1
    assert "not-known" in {each["code"] for each in json.loads(capsys.readouterr().out)["findings"]}
