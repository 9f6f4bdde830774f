"""Records of a force laid on a path: by a clock that runs through rapids, with their signs and in their own axes."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.cutting.forces.measured import ForceRecord, MeasuredForce
from robomill.errors import SetupError
from robomill.io.measured.forces import read_forces
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup, setup_from_toml, setup_to_toml
from robomill.simulation.given import part_frame
from robomill.toolpath.source import GCodeSource

SETUP = load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(cell=5e-4, step=1e-3)
# Two cuts of 40 mm at 20 mm/s with 20 + 40 + 12 + 20 mm of rapids and a dwell of 0.5 s between them.
TWO = GCodeSource(
    "G21 G90 S12000 M3\nG0 X-20 Y-6 Z5\nG0 Z-2\nG1 X20 F1200\nG0 Z18\nG0 X-20\nG0 Y6\nG0 Z-2\nG4 P0.5\nG1 X20\nM2\n"
)
RAPID = 0.2  # m/s
BETWEEN = (20e-3 + 40e-3 + 12e-3 + 20e-3) / RAPID + 0.5


def recorded(turn=1.0, **changes):
    """100 N to the left on the first cut, rising from 200 to 240 N on the second, nothing between."""
    t = np.arange(0.0, 2.0 + BETWEEN + 2.0, 0.01)
    F = np.zeros((len(t), 3))
    F[t <= 2.0, 1] = 100.0
    second = t - (2.0 + BETWEEN)
    F[second >= 0, 1] = 200.0 + 20.0 * second[second >= 0]
    F[:, 0] = -0.3 * np.abs(F[:, 1])
    return MeasuredForce(ForceRecord(t, turn * F, **changes), cutoff=None)


def test_the_second_cut_has_its_own_part_of_the_record():
    run = rm.simulate(SETUP.replace(source=TWO, force=recorded(), rapid_rate=RAPID))
    first, second = (run.path.cutting & (run.path.p[:, 1] * y > 0) for y in (-1.0, 1.0))
    x = run.path.p[:, 0]
    inside = x > -19e-3
    np.testing.assert_allclose(run.force_components[first, 1], 100.0, atol=1e-6)
    truth = 200.0 + 20.0 * (x + 20e-3) / 20e-3
    np.testing.assert_allclose(run.force_components[second & inside, 1], truth[second & inside], atol=0.2)


def test_without_the_rapid_rate_it_is_asked_for():
    with pytest.raises(SetupError, match=r"before line 10 a rapid.*rapid_rate_mm_min"):
        rm.simulate(SETUP.replace(source=TWO, force=recorded()))
    one = GCodeSource("G21 G90 S12000 M3\nG0 X-20 Y-6 Z5\nG0 Z-2\nG1 X20 F1200\nG0 Z18\nM2\n")
    assert rm.simulate(SETUP.replace(source=one, force=recorded())).verdict.level == "ok"


def test_a_rapid_rate_comes_back_from_its_file():
    again = setup_from_toml(setup_to_toml(SETUP.replace(rapid_rate=RAPID)))
    assert again.rapid_rate == pytest.approx(RAPID)


@pytest.mark.parametrize(("turn", "suspected"), [(1.0, False), (-1.0, True)])
def test_turned_signs_are_suspected_aloud(turn, suspected):
    run = rm.simulate(SETUP.replace(source=TWO, force=recorded(turn), rapid_rate=RAPID))
    assert ("force-pulls" in {note.code for note in run.notes}) == suspected


@pytest.mark.parametrize(("air", "metal", "suspected"), [(80.0, -30.0, False), (-80.0, 30.0, True)])
def test_what_a_sensor_reads_in_the_air_is_no_cut(air, metal, suspected):
    """A long way to the block, then as much within it as is cut: only there does a pull along the feed count."""
    start, low = -160e-3, float(SETUP.stock_block.lower[0])
    t = np.arange(0.0, 14.0, 0.01)
    inside = start + 20e-3 * t > low - 5e-3  # the rim of the cutter comes before its axis
    F = np.column_stack([np.where(inside, metal, air), np.full(len(t), 100.0), 0.0 * t])
    one = GCodeSource(f"G21 G90 S12000 M3\nG0 X{1e3 * start} Y0 Z5\nG0 Z-2\nG1 X{1e3 * low + 30} F1200\nG0 Z18\nM2\n")
    force = MeasuredForce(ForceRecord(t, F), cutoff=None)
    run = rm.simulate(SETUP.replace(source=one, force=force, engagement=True))
    engaged = run.conditions.engaged & run.judged
    assert 0 < engaged.sum() < 0.4 * run.path.cutting.sum()
    assert ("force-pulls" in {note.code for note in run.notes}) == suspected


@pytest.mark.parametrize(("air", "metal", "suspected"), [(80.0, -30.0, False), (-80.0, 30.0, True)])
def test_what_a_sensor_reads_on_the_way_back_through_the_groove_is_no_cut(air, metal, suspected):
    """Into the block for two seconds, and back over the floor just cut: the way back meets nothing."""
    low = 1e3 * float(SETUP.stock_block.lower[0])
    t = np.arange(0.0, 4.5, 0.01)
    F = np.column_stack([np.where(t < 2.0, metal, air), np.full(len(t), 100.0), 0.0 * t])
    there = GCodeSource(
        f"G21 G90 S12000 M3\nG0 X{low - 5} Y0 Z5\nG0 Z-2\nG1 X{low + 35} F1200\nX{low - 5}\nG0 Z18\nM2\n"
    )
    force = MeasuredForce(ForceRecord(t, F), cutoff=None)
    run = rm.simulate(SETUP.replace(source=there, force=force, engagement=True))
    assert (run.judged & ~run.conditions.engaged).sum() >= 0.4 * run.judged.sum() > 0
    assert ("force-pulls" in {note.code for note in run.notes}) == suspected


@pytest.mark.parametrize("turns_with", ["robot", "part"])
def test_columns_in_x_y_z_turn_with_the_sensor(turns_with):
    rows = "\n".join(f"{0.1 * n:.1f},-30,100,0" for n in range(80))
    record = read_forces(f"t_s,F_x_N,F_y_N,F_z_N\n{rows}\n", turns_with=turns_with)
    one = GCodeSource("G21 G90 S12000 M3\nG0 X-10 Y0 Z5\nG0 Z-2\nG1 X10 F1200\nG0 Z18\nM2\n")
    turned = part_frame(SETUP.T_MW[:3, 3], np.radians(90.0))
    run = rm.simulate(SETUP.replace(source=one, force=MeasuredForce(record, cutoff=None), T_MW=turned))
    i = int(np.flatnonzero(run.judged)[5])
    # The part's x is the robot's y; a sensor on the part feels -30 N along it, one on the base along its own x.
    expected = {"part": [-100.0, -30.0, 0.0], "robot": [-30.0, 100.0, 0.0]}[turns_with]
    assert run.F[i] == pytest.approx(expected, abs=1e-9)
    assert ("force-axes" in {note.code for note in run.notes}) == (turns_with == "robot")
    again = setup_from_toml(setup_to_toml(run.setup))
    assert again.digest() == run.setup.digest()


@pytest.mark.parametrize(("length", "longer"), [(1.1, False), (3.0, True)])
def test_where_a_record_over_time_begins_is_said_and_whether_much_of_it_is_left(length, longer):
    t = np.linspace(0.0, length, 200)  # one cut of 20 mm at 20 mm/s takes 1 s
    record = ForceRecord(t, np.tile([-10.0, 50.0, 0.0], (200, 1)))
    one = GCodeSource("G21 G90 S12000 M3\nG0 X-10 Y0 Z5\nG0 Z-2\nG1 X10 F1200\nG0 Z18\nM2\n")
    notes = {
        note.code: note
        for note in rm.simulate(SETUP.replace(source=one, force=MeasuredForce(record, cutoff=None))).notes
    }
    assert (notes["record-start"].line, "record-longer" in notes) == (4, longer)
