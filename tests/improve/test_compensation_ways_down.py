"""Corrected holes, ramps and plunges, and the ways out of them, by ordinary runs of their texts."""

import numpy as np
import pytest

import robomill as rm
from robomill.improve.compensation import Compensation
from tests.improve.corrected import DRILL, SLOT, own, tip_of


@pytest.mark.parametrize("way", ["G0 Z10", "G1 Z10", "G1 Z10 F2000", "G4 P1\nG1 Z10", "G85"])
def test_a_hole_is_corrected_however_the_tool_is_drawn_out_of_it(way: str) -> None:
    """Pushed as it comes down, the tip ends on the hole's bottom. Drawn out at feed it goes back there first, while
    only the floor can push it, and then up on the hole's axis."""
    bored = "G85 X3 Y2 Z-5 R1 F100\nG80" if way == "G85" else f"G1 Z-5 F100\n{way}"
    text = f"G21 G90\nS12000 M3\nG0 X3 Y2 Z10\n{bored}\nG0 Z20\nM2\n"
    setup = rm.load_setup(SLOT / "setup_process.toml").replace(source=rm.GCodeSource(text))
    found = rm.compensate(setup)
    before = rm.simulate(setup).verdict
    assert found.before.max == pytest.approx(max(abs(before.wall.value), abs(before.floor.value)), rel=0.01)
    assert found.after.max < 0.01 * found.before.max
    tip, run = tip_of(setup, found.text)
    end = int(np.flatnonzero(run.conditions.plunges & run.conditions.engaged)[-1])
    bottom = -5e-3 + (float(run.C[end, 2] @ run.F[end]) if "G4" in way else 0.0)  # waiting, it cuts to depth
    np.testing.assert_allclose(tip[end], [3e-3, 2e-3, bottom], atol=3e-6)
    if way != "G0 Z10":
        after = run.path.p[end + 1 :][run.path.cutting[end + 1 :]]
        at = int(np.argmax(np.linalg.norm(after - [3e-3, 2e-3, -5e-3], axis=1) < 1e-6))
        np.testing.assert_allclose(after[at], [3e-3, 2e-3, -5e-3], atol=1e-6)
        np.testing.assert_allclose(after[at:, :2], np.broadcast_to([3e-3, 2e-3], after[at:, :2].shape), atol=1e-6)
        assert np.linalg.norm(after[:at] - tip[end], axis=1).max(initial=0.0) < 1.01 * run.deviation[end]
    if "G4" in way:
        lines = found.text.splitlines()
        assert {"X3", "Y2"} <= set(lines[lines.index("G4 P1") - 1].split())


def test_a_slot_left_at_feed_goes_back_to_its_end_and_then_straight_up() -> None:
    text = "G21 G90\nS12000 M3\nG0 X-40 Y0 Z10\nG0 Z-2\nG1 X8 F1000\nG1 Z10\nG0 Z20\nM2\n"
    found = rm.compensate(rm.load_setup(SLOT).replace(source=rm.GCodeSource(text)))
    tip, run = tip_of(found.setup, found.text)
    assert found.after.max < 0.01 * found.before.max
    up = run.path.cutting & (np.diff(run.path.p[:, 2], prepend=0.0) > 0.02e-3) & (run.path.p[:, 0] > 0.0)
    np.testing.assert_allclose(run.path.p[up, :2], np.broadcast_to([8e-3, 0.0], (up.sum(), 2)), atol=1e-6)


def test_a_ramp_into_a_level_cut_is_cut_to_its_depth_up_to_its_end() -> None:
    """Its end teeth push the tool up by 0.7 mm to the last; only then does the level cut let it down."""
    text = "G21 G90\nS12000 M3\nG0 X-20 Y0 Z1\nG1 X0 Z-3 F600\nX20\nG0 Z20\nM2\n"
    found = rm.compensate(rm.load_setup(SLOT / "setup_process.toml").replace(source=rm.GCodeSource(text)))
    assert found.after.max < 0.01 * found.before.max
    tip, run = tip_of(found.setup.replace(coupling=True), found.text)  # it meets the part where it is pushed to
    x, y, z = tip[run.path.cutting & run.conditions.engaged].T
    on_ramp, on_level = (x > -9e-3) & (x < -0.5e-3), x > 1e-3
    assert np.abs(z[on_ramp] - (1e-3 - 0.2 * (x[on_ramp] + 20e-3))).max() < 0.02 * found.before.max
    assert np.abs(z[on_level] + 3e-3).max() < 0.02 * found.before.max
    assert np.abs(y[on_ramp | on_level]).max() < 0.02 * found.before.max


@pytest.mark.parametrize(("begin", "short"), [(-20.0, 0.1), (-20.0, 0.02), (-12.0, 0.02), (-5.0, 0.05)])
def test_a_ramp_is_corrected_where_the_level_cut_begins_with_a_short_step(begin: float, short: float) -> None:
    """Shorter than the tool is pushed along it, as on a circle at the end of a helix: correcting that there, too, sent
    the tool back, and on its next step down by as much as the ramp pushes it up: 1.06 mm too deep, and refused.
    Steep ramps ask for it by what is across them alone, which leads along the cut that goes on."""
    text = f"G21 G90\nS12000 M3\nG0 X{begin} Y0 Z1\nG1 X0 Z-3 F600\nX{short}\nX20\nG0 Z20\nM2\n"
    found = rm.compensate(rm.load_setup(SLOT / "setup_process.toml").replace(source=rm.GCodeSource(text)))
    assert found.after.max < 0.012 * found.before.max
    level = found.led.path.cutting & (found.led.path.p[:, 0] > 0.0)
    tip, run = tip_of(found.setup, found.text)
    assert np.abs(found.led.delta[level][:, 2]).max() < 10e-6
    assert tip[run.path.cutting & (run.path.p[:, 0] > 0.5e-3), 2] == pytest.approx(-3e-3, abs=10e-6)


def test_a_plunge_is_led_straight_down_beside_its_hole() -> None:
    """As it first touches the force is there at once: what undoes it is there before, in the air; and along a way that
    leans by a thousandth the tool would cut with its side."""
    found = rm.compensate(own(DRILL))
    tip, run = tip_of(found.setup, found.text)
    cut = run.path.cutting & run.conditions.engaged
    holes = np.array([[0.010, 0.010], [-0.010, 0.005]])
    off = np.linalg.norm(tip[cut, None, :2] - holes, axis=2).min(axis=1)
    assert off.max() < 5e-6 < 0.3e-3 < found.before.wall[0]
    moves = np.diff(run.path.p[:, :2], axis=0)[run.path.cutting[1:]]
    assert np.abs(moves).max() < 1e-9


def test_a_retract_goes_straight_up_from_where_the_cut_ended(slot: Compensation) -> None:
    path = slot.source.read()
    up = np.flatnonzero(~path.cutting)[-1]
    np.testing.assert_allclose(path.p[up, :2], path.p[up - 1, :2], atol=1e-9)


def test_a_plunge_into_what_is_open_already_meets_nothing_where_the_deflected_tool_has_left_the_floor() -> None:
    """In the word a stroke begins where an earlier one has been cut. A coupled run, which cuts where the tool really
    stands and is solved step by step, found a gouge of 0.170 mm beside that place when the plunge was corrected as if
    it cut; the worst that it finds now is elsewhere, and half of that."""
    setup = rm.load_setup("word")
    found = rm.compensate(setup)
    run = rm.simulate(setup.replace(coupling=True, source=found.source))
    crossing = np.linalg.norm(run.path.p[run.gauge.walls.sample][:, :2] - [0.032, 0.008], axis=1) < 1e-3
    assert crossing.any()
    assert np.abs(run.gauge.walls.error[crossing]).max() < 0.02e-3
    assert np.abs(run.gauge.walls.error).max() < 0.1e-3


@pytest.mark.parametrize(
    "way",
    [
        "G0 Z0.2\nG1 Z-3 F200",
        "G1 Z0.2 F3000\nG1 Z-3 F200",
        "G81 Z-3 R0.2 F200\nG80",
        "G83 Z-3 R0.2 Q1 F200\nG80",
        "G0 Z0.2\nG1 X20 Z-3 F200\nX30",
    ],
)
def test_no_rapid_is_led_into_the_part_by_what_only_pushes_in_there(way: str) -> None:
    """The thrust of the end teeth pushes the tool up by 0.8 mm, so it is sent deeper by that: but not before it is in
    the part, with a rapid from 0.2 mm above to 0.6 mm within."""
    text = f"G21 G90\nS12000 M3\nG0 X3 Y2 Z10\n{way}\nG0 Z20\nM2\n"
    setup = rm.load_setup(SLOT / "setup_process.toml").replace(source=rm.GCodeSource(text))
    found = rm.compensate(setup)
    assert found.before.max > 0.3e-3
    fast = [
        np.round(each.p[~each.cutting | (each.v_f > 0.01), 2], 9)
        for each in (rm.read_gcode(t) for t in (text, found.text))
    ]
    for z in fast[1]:
        assert np.min(np.abs(fast[0] - z)) < 1e-6 or z > fast[0].min() - 1e-6
    assert fast[1].min() >= fast[0].min() - 1e-6
    assert found.after.max < 0.012 * found.before.max
    if "X20" not in way:  # of a ramp a test of its own says more
        tip, run = tip_of(setup, found.text)
        assert tip[run.path.cutting & run.conditions.engaged, 2].min() == pytest.approx(-3e-3, abs=10e-6)


def test_a_rapid_over_a_ramp_stops_where_it_was_told_to_and_a_link_leads_down_from_there() -> None:
    """The force is stated, and so is there from the first step on: 0.64 mm up."""
    text = "G21 G90\nS12000 M3\nG0 X-20 Y0 Z10\nG0 Z0.2\nG1 X20 Z-2 F600\nX30\nG0 Z20\nM2\n"
    force = rm.PathForce(feed_normal=80.0, axial=300.0)
    found = rm.compensate(rm.load_setup(SLOT).replace(source=rm.GCodeSource(text), force=force))
    path = rm.read_gcode(found.text)
    assert path.p[1:][~path.cutting[1:], 2].min() == pytest.approx(0.2e-3, abs=1e-9)
    assert found.after.max < 0.01 * found.before.max
    tip, run = tip_of(found.setup, found.text)
    x, _, z = tip[run.path.cutting & run.conditions.engaged].T
    on_ramp = (x > -15e-3) & (x < 19e-3)
    assert np.abs(z[on_ramp] - (0.2e-3 - 0.055 * (x[on_ramp] + 20e-3))).max() < 0.02 * found.before.max


def test_a_rapid_onto_a_finished_floor_stops_there_and_one_beside_the_stock_is_led() -> None:
    """150 N up lift the tool by 0.36 mm as it cuts: it goes down by that at feed, not at rapid into the floor."""
    text = "G21 G90\nS12000 M3\nG0 X-60 Y0 Z5\nG0 Z-2\nG1 X60 F1200\nG0 Z5\nG0 X0\nG0 Z-2\nG1 Y10 F600\nG0 Z10\nM30\n"
    force = rm.PathForce(feed_normal=60.0, axial=150.0)
    stock = rm.Stock(lower_mm=[-50, -60, -20], upper_mm=[50, 60, 0])
    found = rm.compensate(rm.load_setup(SLOT).replace(source=rm.GCodeSource(text), force=force, stock=stock))
    path = rm.read_gcode(found.text)
    low = [p[2] for p, cutting in zip(path.p, path.cutting, strict=True) if not cutting and p[2] < -1e-3]
    assert low[0] == pytest.approx(-2.3026e-3, abs=2e-6)  # beside the stock
    assert low[1] == pytest.approx(-2e-3, abs=1e-9)
    tip, run = tip_of(found.setup, found.text)
    y, z = tip[run.path.cutting & (np.abs(run.path.p[:, 0]) < 1e-3)].T[1:]
    assert np.abs(z[(y > 4.5e-3) & (y < 9.5e-3)] + 2e-3).max() < 0.01 * found.before.max
