"""What a corrected program is written as, and what is told of one that somebody brings."""

import numpy as np
import pytest

import robomill as rm
from robomill.improve.compensation import Compensation
from tests.improve.corrected import SLOT, beside_slot, silent, tip_of


def test_its_text_simulated_is_told_from_the_path_that_was_meant(process: Compensation, pocket: Compensation) -> None:
    """As a file that somebody brings: nothing but its head says what it was made of. The tip of a run that knows
    nothing of that lies where this one says, on the slot's line."""
    for found in (process, pocket):
        run = rm.simulate(found.setup.replace(source=rm.GCodeSource(found.text, "brought.nc")))
        assert max(abs(run.verdict.wall.value), abs(run.verdict.floor.value)) < 0.01 * found.before.max
        assert run.setup.source.wanted == found.setup.source
        assert any("told from the path of" in note.sentence for note in run.notes)
    run = rm.simulate(process.setup.replace(source=process.source))
    tip, alone = tip_of(process.setup, process.text)
    there = np.asarray(run.path.p + run.delta @ process.setup.T_MW[:3, :3])[run.path.cutting]
    np.testing.assert_allclose(there[8:], tip[alone.path.cutting][-len(there) :][8:], atol=2e-6)
    sizes = np.linalg.norm(run.delta - run.ahead - run.delta_joint.sum(axis=1), axis=1)[run.path.cutting]
    assert sizes.max() < 1e-12


def test_a_softer_arm_leaves_a_fifth_of_a_program_that_is_simulated_too(slot: Compensation) -> None:
    arm = slot.setup.robot
    softer = slot.setup.replace(robot=arm.replace(C_theta=1.2 * arm.C_theta))
    run = rm.simulate(softer.replace(source=rm.GCodeSource(slot.text)))
    assert abs(run.verdict.wall.value) == pytest.approx(0.2 * slot.before.max, rel=0.02)


def test_beside_another_path_it_says_that_it_is_told_from_its_own_lines(slot: Compensation) -> None:
    other = rm.load_setup("heart").replace(source=rm.GCodeSource(slot.text), robot=slot.setup.robot)
    assert other.wanted_path is None
    run = rm.simulate(slot.setup.replace(source=rm.GCodeSource(slot.text.replace("X50", "X49"), "c.nc")))
    assert run.ahead is not None  # the one it names is there: what was changed by hand is told
    alone = rm.simulate(slot.setup.replace(source=other.source))
    assert alone.ahead is not None
    told = [note for note in rm.simulate(other).notes if note.code == "wanted-path"]
    assert [note.level for note in told] == ["warning"]
    assert "open path.nc before it" in told[0].sentence


def test_what_is_corrected_is_not_corrected_again(slot: Compensation) -> None:
    for source in (slot.source, rm.GCodeSource(slot.text)):
        with pytest.raises(rm.RobomillError, match=r"corrected already: ask this of the program .* path\.nc"):
            rm.compensate(slot.setup.replace(source=source))


def test_lines_keep_numbers_comments_feeds_and_words_and_only_places_change(slot: Compensation) -> None:
    before, after = slot.source.name, silent(slot.text).splitlines()
    given = rm.read_program(SLOT / "path.nc").text.splitlines()
    assert before == "path_corrected.nc"
    assert slot.lines_in == slot.lines_out - 2 == len(given)
    changed = [(a, b) for a, b in zip(given, after, strict=True) if a != b]
    assert [a for a, _ in changed] == ["N30 G0 X-50 Y0 Z20", "N40 G0 Z-2"]
    assert [b.split(" ")[:2] for _, b in changed] == [["N30", "G0"], ["N40", "G0"]]


def test_a_finer_bound_takes_more_lines_and_each_keeps_it(process: Compensation) -> None:
    coarse = rm.compensate(process.setup, bound_um=20)
    assert coarse.lines_out <= process.lines_out
    assert process.after.max < 2e-6
    assert coarse.after.max < 20e-6


def test_arcs_stay_arcs_where_their_correction_is_even() -> None:
    """Around a circle about joint 1's axis a push along the tool is the same everywhere."""
    setup = rm.load_setup(SLOT)
    text = "G21 G90 G17\nG0 X-20 Y0 Z5\nG0 Z-2\nG2 X20 Y0 I20 J0 F600\nG0 Z5\nM2\n"
    force = rm.PathForce(axial=-20.0)
    found = rm.compensate(setup.replace(source=rm.GCodeSource(text, "arc.nc"), force=force), "axial", bound_um=20)
    assert sum(line.startswith("G2 ") for line in found.text.splitlines()) == 1
    assert found.lines_out < 12


def test_a_full_circle_becomes_some_arcs_that_lie_where_they_are_meant() -> None:
    """Its axial correction rises and falls by 0.25 mm on the way round, so one arc cannot do; read again, the arcs lie
    on the corrected places."""
    lines = ("G21 G90", "S12000 M3", "G0 X20 Y0 Z10", "G1 Z-2 F600", "G3 X20 Y0 I-20 J0 F1800", "G0 Z10", "M2")
    found = rm.compensate(rm.load_setup("pocket_arcs").replace(source=rm.GCodeSource("\n".join(lines) + "\n", "c.nc")))
    assert found.after.max < 0.01 * found.before.max
    assert found.lines_out < 40
    assert sum("I" in line for line in found.text.splitlines()) > 10
    read = rm.read_gcode(found.text, chord_error=1e-7).p
    meant = (found.wanted.path.p + found.c)[found.wanted.path.cutting]
    way = np.diff(read, axis=0)
    share = np.einsum("mni,ni->mn", meant[:, None] - read[:-1], way) / np.maximum((way**2).sum(axis=1), 1e-30)
    nearest = read[:-1] + np.clip(share, 0.0, 1.0)[..., None] * way
    assert np.linalg.norm(meant[:, None] - nearest, axis=2).min(axis=1).max() < 0.5e-6


def test_an_arc_that_ends_steeply_is_corrected_along_its_curve() -> None:
    """In the plane of the tool, 75 degrees up and down at its ends: its last third was measured against the chord."""
    radius, half, low = 10e-3, 9.659e-3, -4.588e-3
    lines = ("G21 G90", "S12000 M3", "G0 X-60 Y0 Z5", "G0 Z-2", "G1 X-9.659 F1200", "G18 G3 X9.659 Z-2 I9.659 K-2.588")
    text = "\n".join([*lines, "G17 G1 X80", "G0 Z5", "M2", ""])
    setup = rm.load_setup(SLOT).replace(source=rm.GCodeSource(text), force=rm.PathForce(feed=-40, feed_normal=120))
    found = rm.compensate(setup)
    p = found.led.path.p
    on_arc = (np.abs(p[:, 0]) < half - 1e-5) & found.led.path.cutting
    assert np.hypot(p[on_arc, 0], p[on_arc, 2] - low) == pytest.approx(radius, abs=3e-6)
    tip, run = tip_of(setup, found.text)
    curve = run.path.cutting & (np.abs(tip[:, 0]) < half) & (tip[:, 2] > -1.5e-3)
    assert np.abs(np.hypot(tip[curve, 0], tip[curve, 2] - low) - radius).max() < 6e-6
    assert np.abs(tip[curve, 1]).max() < 6e-6
    assert found.after.max < 6e-6


def test_paths_that_are_no_program_are_written_as_one() -> None:
    setup = rm.load_setup(SLOT)
    path = rm.Toolpath.from_points(p_mm=[[-50, 0, -2], [50, 0, -2]], feed_mm_min=1800)
    lines = rm.LinesSource(start_mm=[[-50, 0, -2]], end_mm=[[50, 0, -2]], feed_mm_min=[1800])
    for source in (path, lines):
        found = rm.compensate(setup.replace(source=source))
        assert found.name == "corrected.nc"
        assert beside_slot(found).max() < 0.01 * found.before.max
