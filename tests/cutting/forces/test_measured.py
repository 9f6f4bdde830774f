"""Measured force: the filter keeps the mean and the place, takes the tooth passing out, and lies on the path."""

import numpy as np
import pytest

import robomill as rm
from robomill.cutting.conditions import CutConditions
from robomill.cutting.force import feed_frame, force_on_tool
from robomill.cutting.forces.measured import ForceRecord, MeasuredForce
from robomill.errors import CuttingError
from robomill.quantities import quantities

T = np.arange(0.0, 4.0, 1e-3)


def record(feed_normal, x=T, **changes):
    F = np.zeros((len(x), 3))
    F[:, 1] = feed_normal
    return ForceRecord(x, F, **changes)


def test_filter_keeps_the_mean_and_takes_out_the_tooth_passing():
    tooth = 100.0 + 60.0 * np.sin(2 * np.pi * 300.0 * T)
    smooth = record(tooth).low_pass(50.0)
    np.testing.assert_allclose(smooth.F[200:-200, 1], 100.0, atol=0.2)


@pytest.mark.parametrize("frequency", [5.0, 20.0, 50.0, 120.0])
def test_gain_is_that_of_the_butterworth_run_twice_and_nothing_is_shifted(frequency):
    wave = np.cos(2 * np.pi * frequency * T)
    smooth = record(wave).low_pass(50.0)
    middle = slice(500, -500)
    # Bilinear transform: frequencies as tan(pi f / rate).
    warped = np.tan(np.pi * frequency / 1000) / np.tan(np.pi * 50 / 1000)
    gain = 1.0 / (1.0 + warped**4)  # |H|^2 of a second-order Butterworth
    np.testing.assert_allclose(smooth.F[middle, 1], gain * wave[middle], atol=1e-6)


def by_recurrence(b, a, wave):
    """A second-order filter step by step, begun at rest in the first value."""
    out = np.empty_like(wave)
    x1 = x2 = y1 = y2 = wave[0]
    for i, x in enumerate(wave):
        y = b[0] * x + b[1] * x1 + b[2] * x2 - a[1] * y1 - a[2] * y2
        x2, x1, y2, y1, out[i] = x1, x, y1, y, y
    return out


@pytest.mark.parametrize(("cutoff", "mirrored"), [(50.0, 20), (170.0, 6), (400.0, 6), (20.0, 40), (2.0, 40)])
def test_the_filter_is_a_recurrence_run_both_ways_over_ends_mirrored_for_a_period(cutoff, mirrored):
    """Mirrored over a period of the cut-off: at least three times the order, at most the record."""
    x = T[300:341]
    wave = np.random.default_rng(0).normal(size=len(x)) + 50 * (x - x[0])
    # Butterworth by the bilinear transform of 1 / (s^2 + sqrt(2) s + 1).
    c = 1.0 / np.tan(np.pi * cutoff / 1000)
    whole = 1 + np.sqrt(2) * c + c * c
    b, a = np.array([1, 2, 1]) / whole, np.array([whole, 2 - 2 * c * c, 1 - np.sqrt(2) * c + c * c]) / whole
    before, after = 2 * wave[0] - wave[mirrored:0:-1], 2 * wave[-1] - wave[-2 : -2 - mirrored : -1]
    there = by_recurrence(b, a, np.concatenate([before, wave, after]))
    back = by_recurrence(b, a, there[::-1])[::-1]
    smooth = record(wave, x).low_pass(cutoff)
    np.testing.assert_allclose(smooth.x, x, atol=1e-12)
    np.testing.assert_allclose(smooth.F[:, 1], back[mirrored:-mirrored], atol=1e-9)


def test_a_step_keeps_its_place():
    step = np.where(T >= 2.0, 100.0, 0.0)
    smooth = record(step).low_pass(50.0).F[:, 1]
    assert T[np.argmin(np.abs(smooth - 50.0))] == pytest.approx(2.0, abs=1.1e-3)


def test_uneven_sampling_is_evened_out():
    rng = np.random.default_rng(3)
    x = np.sort(T + rng.uniform(-2e-4, 2e-4, len(T)))
    wave = 100 + 30 * np.sin(2 * np.pi * 2 * x)
    smooth = record(wave, x).low_pass(50.0)
    np.testing.assert_allclose(smooth.F[300:-300, 1], 100 + 30 * np.sin(2 * np.pi * 2 * smooth.x[300:-300]), atol=0.05)


def test_laid_on_the_path_by_time_and_by_length():
    m = 21
    t = np.linspace(0, 2, m)
    conditions = CutConditions.steady(0.03, 200.0, 2e-3, cutting=np.arange(m) > 0, t=t, s=0.03 * t)
    ramp = MeasuredForce(record(50.0 * T), start=0.5)
    np.testing.assert_allclose(ramp.components(conditions)[1:, 1], 50 * (t[1:] + 0.5), rtol=2e-3)
    np.testing.assert_array_equal(ramp.components(conditions)[0], 0.0)
    by_length = MeasuredForce(record(50.0 * T, 0.03 * T, axis="path"), start=0.015)
    np.testing.assert_allclose(by_length.components(conditions), ramp.components(conditions), rtol=1e-9, atol=1e-9)
    raw = MeasuredForce(record(50.0 * T), cutoff=None)
    np.testing.assert_allclose(raw.components(conditions)[1:, 1], 50 * t[1:], rtol=1e-12)
    assert raw.provenance.source.endswith("unfiltered")
    assert "50 Hz, zero phase" in ramp.provenance.source


def test_in_the_robot_frame_or_along_the_path():
    frames = feed_frame([[0, 0, 0], [0, 1.0, 0]], [[0, 0, 1.0]] * 2)
    conditions = CutConditions.steady(0.03, 200.0, 2e-3, cutting=[False, True], t=[0.0, 1.0])
    for frame, expected in (("M", [0, 100, 0]), ("path", [-100, 0, 0])):
        F = force_on_tool(MeasuredForce(record(100.0, frame=frame)), conditions, frames)
        np.testing.assert_allclose(F, [[0, 0, 0], expected], atol=1e-6)


def test_short_records_filter_too():
    assert record([1.0, 2.0, 1.0, 2.0], [0, 1e-3, 2e-3, 3e-3]).low_pass(50.0).F.shape == (4, 3)


@pytest.mark.parametrize(("spacing", "filtered"), [(0.5e-3, False), (0.1e-3, True)])
def test_a_record_too_coarse_for_the_cut_off_is_used_as_it_is(spacing: float, filtered: bool) -> None:
    """50 Hz at 15 mm/s are 3333 per metre: samples each half millimetre hold nothing faster than 1000 per metre."""
    s = np.arange(0.0, 0.06, spacing)
    F = np.column_stack([-1e3 * s, 2e3 * s, np.zeros_like(s)]) + 5.0 * np.cos(np.pi * s / spacing)[:, None]
    conditions = CutConditions.steady(0.015, 200.0, 2e-3, s=[0.0, 0.02, 0.04], t=[0.0, 1.0, 2.0])
    force = MeasuredForce(ForceRecord(s, F, "path", "path", "a test"), 50.0)
    found = force.components(conditions)
    straight = np.column_stack([np.interp(conditions.s, s, column) for column in F.T])
    assert np.allclose(found, straight) != filtered
    assert ("record-unfiltered" in [each.code for each in force.findings(conditions)]) != filtered


def test_refusals():
    conditions = CutConditions.steady(0.03, 200.0, 2e-3, cutting=[False, True, True], t=[0.0, 1.0, 5.0])
    with pytest.raises(CuttingError, match=r"cuts from 1.000 s to 5.000 s, the record holds 0.000 s to 3.999 s"):
        MeasuredForce(record(100.0)).components(conditions)
    with pytest.raises(CuttingError, match=r"1 samples per second are too few to filter at 50 per second"):
        MeasuredForce(record(100.0, 1e3 * T)).components(conditions)
    with pytest.raises(CuttingError, match="must be greater than 0"):
        record(100.0).low_pass(0.0)
    with pytest.raises(CuttingError, match="found 2 samples"):
        ForceRecord([0.0, 1.0], np.zeros((2, 3)))
    with pytest.raises(CuttingError, match="does not increase at sample 2"):
        ForceRecord([0.0, 1.0, 1.0, 2.0], np.zeros((4, 3)))
    with pytest.raises(CuttingError, match="finite numbers"):
        ForceRecord([0.0, 1.0, 2.0, 3.0], np.full((4, 3), np.nan))
    still = CutConditions.steady(0.0, 200.0, 2e-3, s=[0.0, 0.01])
    with pytest.raises(CuttingError, match="the feed is 0"):
        MeasuredForce(record(100.0, 0.03 * T, axis="path")).components(still)
    with pytest.raises(CuttingError, match="axis is 'angle'; expected 'time' or 'path'"):
        record(100.0, axis="angle")
    with pytest.raises(CuttingError, match="frame is 'W2'; expected 'path' or 'M' or 'W'"):
        record(100.0, frame="W2")
    with pytest.raises(CuttingError, match="Low-pass cut-off: found −5 Hz; expected more than 0 Hz, or left out"):
        MeasuredForce(record(100.0), cutoff=-5.0)
    with pytest.raises(CuttingError, match="Path starts at: found nan"):
        MeasuredForce(record(100.0), start=float("nan"))


def test_a_record_in_the_axes_of_the_part_turns_with_it():
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # x of the part is y of the robot
    conditions = CutConditions.steady(0.03, 200.0, 2e-3, cutting=[False, True], t=[0.0, 1.0])
    for frame, expected in (("W", [-100, 0, 0]), ("M", [0, 100, 0]), ("path", [0, 100, 0])):
        force = MeasuredForce(record(100.0, frame=frame)).placed(turn)
        assert force.turns_with_part == (frame == "W")
        np.testing.assert_allclose(force.components(conditions)[1], expected, atol=1e-9)
        assert force.placed(turn) is force
    assert MeasuredForce(record(100.0)).in_time
    assert not MeasuredForce(record(100.0, axis="path")).in_time


def test_a_rate_of_twice_the_cut_off_is_too_few_and_rounded_instants_do_not_help():
    for rate, enough in ((100.0, False), (100.00005, False), (100.001, True)):
        x = np.arange(40) / rate
        if enough:
            assert len(record(np.ones(40), x).low_pass(50.0).x) == 40
        else:
            with pytest.raises(CuttingError, match="it takes more than 100"):
                record(np.ones(40), x).low_pass(50.0)


@pytest.mark.parametrize(("last", "longer"), [(2.0, False), (2.5, False), (2.502, True), (10.0, True)])
def test_a_record_that_goes_on_by_a_fifth_of_its_time_is_suspected(last, longer):
    """The cut ends 2 s after its begin, which is at 0.5 s of a record that begins at 0.5 s."""
    x = np.linspace(0.5, 0.5 + last, 5)
    t = np.array([7.0, 0.0, 1.0, 2.0, 9.0])
    conditions = CutConditions.steady(
        0.03, 200.0, 2e-3, cutting=[False, True, True, True, False], t=t, block=[3, 4, 5, 6, 7]
    )
    force = MeasuredForce(record(np.ones(5), x), start=0.5)
    found = force.findings(conditions)
    begin = found[0]
    assert (begin.code, begin.line, "begin at 0.500 s" in begin.message) == ("record-start", 4, True)
    assert [(each.code, each.line) for each in found[1:]] == [("record-longer", 0)] * longer
    if longer:
        assert f"goes on to {x[-1]:.3f} s, the last cut ends at 2.500 s" in found[1].message


def test_only_a_record_over_time_laid_on_a_cut_has_a_begin():
    air = CutConditions.steady(0.03, 200.0, 2e-3, cutting=[False, False])
    cut = CutConditions.steady(0.03, 200.0, 2e-3, cutting=[False, True])
    noted = record(1.0, notes=("read with care",))
    assert [(each.code, each.line) for each in MeasuredForce(noted).findings(air)] == [("force-note", 0)]
    assert [each.code for each in MeasuredForce(noted).findings(cut)][:2] == ["force-note", "record-start"]
    by_length = record(1.0, axis="path", notes=("read with care",))
    assert [each.code for each in MeasuredForce(by_length, None).findings(cut)] == ["force-note"]
    np.testing.assert_array_equal(MeasuredForce(noted).components(air), np.zeros((2, 3)))


@pytest.mark.parametrize(
    ("first", "last", "held"), [(-1.0, 99.0, True), (0.0, 100.0, True), (-1.5, 99.0, False), (0.0, 100.5, False)]
)
def test_a_cut_may_leave_the_record_by_a_sample(first, last, held):
    """In samples, of which the record holds a hundred."""
    conditions = CutConditions.steady(0.03, 200.0, 2e-3, t=np.array([first, last]) / 1024)
    force = MeasuredForce(record(100.0, np.arange(100) / 1024), cutoff=None)
    if held:
        np.testing.assert_allclose(force.components(conditions)[:, 1], 100.0)
    else:
        with pytest.raises(CuttingError, match="record the whole cut"):
            force.components(conditions)


def test_a_record_over_length_is_filtered_at_the_median_feed_of_the_cut():
    wave = np.cos(2 * np.pi * 40.0 * T)
    by_length = record(wave, 0.03 * T, axis="path")
    v_f = np.array([9.0, 0.03, 0.03, 0.03, 0.05, 0.01])
    conditions = CutConditions.steady(v_f, 200.0, 2e-3, cutting=v_f != 9.0, s=0.03 * np.linspace(1.0, 3.0, 6))
    expected = MeasuredForce(record(wave)).record.low_pass(50.0)
    found = MeasuredForce(by_length).components(conditions)[1:, 1]
    np.testing.assert_allclose(found, np.interp(np.linspace(1.0, 3.0, 6)[1:], expected.x, expected.F[:, 1]), atol=1e-6)


def test_no_filter_is_written_as_a_cut_off_of_nothing():
    assert quantities(MeasuredForce)["cutoff"].written_none == 0.0
    assert MeasuredForce(record(1.0)).cutoff == 50.0
    assert MeasuredForce(record(1.0)).start == 0.0


def test_a_record_over_length_that_was_given_in_mm_is_doubted() -> None:
    """100 mm of cut, and a record over 100 of what stands for m."""
    setup = rm.load_setup("paper_flute")
    s, F = np.linspace(0.0, 200.0, 50), np.tile([0.0, 100.0, 0.0], (50, 1))
    for times, doubted in ((1.0, True), (1e-3, False)):
        run = rm.simulate(setup.replace(force=rm.MeasuredForce.along_path(s * times, F)))
        assert ("record-longer" in {note.code for note in run.notes}) == doubted
