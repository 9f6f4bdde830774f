"""What is not corrected, and why."""

from collections.abc import Callable
from pathlib import Path

import pytest

import robomill as rm
from robomill.errors import CompensationError
from robomill.improve import correction
from robomill.improve.compensation import checked_components
from tests.improve.corrected import SLOT


def far(setup: rm.SimulationSetup) -> rm.SimulationSetup:
    return setup.replace(part_zero_mm=(0, -2600, 2))


def unknown(setup: rm.SimulationSetup) -> rm.SimulationSetup:
    text = setup.source.block_texts()
    return setup.replace(source=rm.GCodeSource("\n".join(text).replace("S12000 M3", "G96 S100 M3"), "path.nc"))


REFUSED: dict[str, tuple[Callable[[rm.SimulationSetup], rm.SimulationSetup], Path, str]] = {
    "not reached": (far, SLOT, "reached"),
    "no speed, so no force is known": (unknown, SLOT / "setup_process.toml", "not judged"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_predicted_is_not_corrected(name: str) -> None:
    change, file, words = REFUSED[name]
    with pytest.raises(CompensationError, match=words):
        rm.compensate(change(rm.load_setup(file)))


def test_an_arm_that_gives_too_much_is_refused_by_name() -> None:
    setup = rm.load_setup(SLOT / "setup_process.toml")
    arm = setup.robot
    with pytest.raises(rm.RobomillError, match=r"^The path is not corrected"):
        rm.compensate(setup.replace(robot=arm.replace(C_theta=60.0 * arm.C_theta)))


def test_what_does_not_settle_is_refused_by_its_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(correction, "MOST", 2)
    with pytest.raises(CompensationError, match=r"does not settle \(line 7\): after 2 runs it still changes by 0\.02"):
        rm.compensate(rm.load_setup(SLOT / "setup_process.toml"))


@pytest.mark.parametrize("given", ["", "sideways", ["normal", "up"], []])
def test_components_are_named(given: str | list[str]) -> None:
    with pytest.raises(CompensationError, match=r"expected some of normal, axial, feed"):
        checked_components(given)


@pytest.mark.parametrize("bound_um", [0.0, -1.0, float("nan"), 5000.0])
def test_a_bound_that_no_program_keeps_is_refused(bound_um: float) -> None:
    with pytest.raises(CompensationError, match="Bound"):
        rm.compensate(rm.load_setup(SLOT), bound_um=bound_um)


def test_a_path_on_which_force_and_deflection_do_not_agree_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """An arm twelve times softer, where nothing is sought beside going round: at some places that does not settle."""
    monkeypatch.setattr("robomill.simulation.coupling.TURNS", 0)
    setup = rm.load_setup(SLOT / "setup_process.toml")
    soft = setup.robot.replace(C_theta=12.0 * setup.robot.C_theta)
    with pytest.raises(CompensationError, match=r"at line \d.* force and deflection do not agree: .* remain"):
        rm.compensate(setup.replace(robot=soft, coupling=True, step_mm=5.0, cell_mm=0.4))


@pytest.mark.parametrize(("bound_um", "kept"), [(0.2, True), (1000.0, True), (0.199, False), (1001.0, False)])
def test_a_program_is_written_to_a_fifth_of_a_micrometre_at_best_and_to_one_millimetre_at_least(
    bound_um: float, kept: bool
) -> None:
    setup = rm.load_setup(SLOT).replace(step=20e-3)
    if kept:
        assert rm.compensate(setup, bound_um=bound_um).bound == pytest.approx(bound_um * 1e-6)
        return
    with pytest.raises(CompensationError, match="Bound"):
        rm.compensate(setup, bound_um=bound_um)
