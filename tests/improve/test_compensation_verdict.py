"""The verdict of a corrected program: it has one, or says what is not known."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
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


def test_a_coupled_ramp_is_corrected_from_its_first_step_on() -> None:
    """A rapid sends the tool so deep that it stands on the part with all of its thrust, as the ramp's end needs it."""
    body = "G0 X-12 Y0 Z5\nG0 Z0\nG1 X4 Z-1.4 F1800\nG1 X10\n"
    source = rm.GCodeSource(f"G21 G90\nS12000 M3\n{body}G0 Z20\nM2\n", "ramp.nc")
    setup = rm.load_setup("paper_flute/setup_process").replace(source=source, coupling=True)
    found = rm.compensate(setup)
    assert found.before.max > 0.7e-3
    assert found.after.max < 0.02 * found.before.max


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


SLOT = rm.load_setup("paper_flute").replace(
    source=rm.GCodeSource("G21 G90 G17\nG0 X-15 Y0 Z5\nG0 Z-2\nG1 X125 F800\nG0 Z20\nM30\n", "slot.nc"),
    stock=rm.Stock(lower_mm=[-80, -70, -20], upper_mm=[180, 70, 0]),
    force=rm.PathForce(feed=-40.0, feed_normal=120.0, axial=-30.0),
    tolerance_mm={"wall": 0.3, "floor": 0.3, "feed": 0.03},
)


def told(run: rm.SimulationResult) -> list[str]:
    return [note.code for note in run.notes]


@pytest.mark.parametrize("pull", [-40.0, 40.0])
def test_a_slot_corrected_along_its_feed_is_not_read_as_off_along_it(pull: float) -> None:
    """Its tip ends at 125 mm, as a run that knows nothing of the correction has it. The same line led elsewhere is off
    by as much as that, whatever it says of itself."""
    setup = SLOT.replace(force=rm.PathForce(feed=pull, feed_normal=120.0, axial=-30.0))
    found = rm.compensate(setup, components=("normal", "axial", "feed"))
    assert "normal axial feed)" in found.text
    free = rm.simulate(setup.replace(source=rm.GCodeSource(found.text, "as_written.nc")))
    tip = free.path.p + free.delta @ SLOT.T_MW[:3, :3]
    assert tip[free.path.cutting][[0, -1], 0] == pytest.approx([-15e-3, 125e-3], abs=2e-6)
    assert found.level == "ok"
    assert abs(found.led.verdict.feed.value) < 1e-6
    assert found.led.max_deviation < 2e-6
    assert "untold-feed" in told(found.led)
    assert "untold-feed" in {each.code for each in found.findings}
    for text in (found.text, found.text.replace(" in normal axial feed", "")):
        assert rm.simulate(setup.replace(source=replace(found.source, text=text))).verdict.level == "ok"
    ends = [line for line in found.text.splitlines() if line.startswith("G1 X12")]
    word = ends[0].split()[1]
    for more in (0.1, -0.1):
        wrong = found.text.replace(word, f"X{float(word[1:]) + more:.4f}")
        run = rm.simulate(setup.replace(source=replace(found.source, text=wrong)))
        assert run.verdict.level == "out"
        assert run.verdict.feed.value == pytest.approx(more * 1e-3, abs=2e-6)


def test_a_slot_corrected_across_its_feed_alone_is_read_along_it_at_every_sample() -> None:
    """Along the feed it is off by what the run of the program as it is, is."""
    found = rm.compensate(SLOT)
    before = rm.simulate(SLOT)
    assert found.led.verdict.feed.value == pytest.approx(before.verdict.feed.value, abs=1e-6)
    np.testing.assert_array_equal(found.led.judged_along, found.led.judged)
    assert "untold-feed" not in told(found.led)
    assert "untold-feed" not in {each.code for each in found.findings}
    assert found.level == "out"
