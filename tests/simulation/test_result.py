"""What a run says of itself, recomputed by loops over its samples and by runs of other set-ups."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import shapely

import robomill as rm
from robomill.compliance.springs.spindle import SpindleSpring
from robomill.cutting.forces.along_path import PathForce
from robomill.cutting.unjudged import Unjudged
from robomill.errors import SurfaceError
from robomill.io.samples import samples_dir
from robomill.report.simulation_record import simulation_record
from robomill.simulation.given import part_frame
from robomill.surface.deviation import deviation
from robomill.toolpath.source import GCodeSource

SETUP = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(cell=4e-4)
PROCESS = rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml").replace(cell=4e-4)
STOCK = SETUP.stock


def program(*lines, **changes):
    return rm.simulate(SETUP.replace(source=GCodeSource("\n".join(["G21 G90 S12000 M3", *lines, "M2", ""])), **changes))


def mm(*values):
    return " ".join(f"{a}{v:.10g}" for a, v in zip("XYZ", values, strict=False))


def test_what_counts_is_at_feed_and_within_the_block():
    """Around corners and sides of the block, a nanometre or a micrometre inside and outside the cutter's reach."""
    R, (x, y, _), (X, Y, top) = 4.0, STOCK.lower * 1e3, STOCK.upper * 1e3
    diagonal = R / np.sqrt(2)
    places = [
        (mx, my, top + dz)
        for d in (-1e-3, 1e-3)
        for mx, my in (
            (X + R + d, 0),
            (x - R - d, 0),
            (0, Y + R + d),
            (0, y - R - d),
            (X + diagonal + d, Y + diagonal + d),
            (x - diagonal - d, y - diagonal - d),
        )
        for dz in (-2.0, -1e-3, 1e-3)
    ]
    lines = [f"G1 {mm(*place)} F1800" for place in places]
    found = program("G0 X0 Y0 Z5", *lines, "G0 Z9", T_MW=part_frame([-0.0, -1.25, 0.0]), step_mm=1000)
    block = shapely.box(*STOCK.lower[:2], *STOCK.upper[:2])
    for i, p in enumerate(found.path.p):
        over = shapely.distance(block, shapely.Point(p[:2])) < 0.004 - 1e-9 and p[2] < STOCK.upper[2] - 1e-9
        assert found.over_stock[i] == over, p
        assert found.judged[i] == (over and found.path.cutting[i] and found.reached[i])
    assert found.judged.sum() > 10
    touching = program(f"G0 {mm(X + R, 0, 5)}", "G1 Z-2 F900", "G1 Y5", "G0 Z9", step_mm=1000)
    assert not touching.judged.any()


@pytest.fixture(scope="module")
def bent():
    """Two cuts under all three forces, with a rapid between, sampled unevenly."""
    force = PathForce(feed=-30.0, feed_normal=100.0, axial=-20.0)
    lines = ("G0 X-40 Y-8 Z-2", "G1 X-10 F1800", "G0 Z9", "G0 X20 Y8", "G0 Z-1", "G1 X50 Y14 F900")
    return program(*lines, force=force, step=7e-3)


def test_size_and_worst_by_loops(bent):
    sizes = [sum(v * v for v in d) ** 0.5 for d in bent.delta]
    judged = [i for i in range(len(sizes)) if bent.judged[i]]
    assert bent.deviation == pytest.approx(sizes)
    assert bent.worst == max(judged, key=lambda i: sizes[i])
    assert bent.max_deviation == sizes[bent.worst]
    length = {i: float(np.linalg.norm(bent.path.p[i] - bent.path.p[i - 1])) for i in judged}
    squares = sum(length[i] * sizes[i] ** 2 for i in judged) / sum(length.values())
    assert bent.rms_deviation == pytest.approx(squares**0.5, rel=1e-12)
    assert bent.worst_block == bent.path.block[bent.worst]
    assert bent.answered.all()


def test_of_a_tool_that_stands_in_the_material_the_mean_is_its_one_deviation():
    """There is no length to weigh by."""
    slot = program("G0 X-20 Y0 Z5", "G0 Z-1", "G1 X20 F1800", "G0 Z9")
    m = len(slot.path)
    still = dataclasses.replace(slot.path, p=np.tile([0.0, 0.0, -1e-3], (m, 1)))
    bent = dataclasses.replace(slot, path=still, delta=np.tile([0.03e-3, -0.04e-3, 0.12e-3], (m, 1)))
    assert bent.rms_deviation == pytest.approx(0.13e-3, rel=1e-12)
    assert bent.max_deviation == pytest.approx(0.13e-3, rel=1e-12)


def test_each_force_component_alone_bends_its_part(bent):
    for c, name in enumerate(("feed", "feed_normal", "axial")):
        alone = rm.simulate(bent.setup.replace(force=PathForce(**{name: getattr(bent.setup.force, name)})))
        np.testing.assert_allclose(bent.delta_component[:, c], alone.delta, atol=1e-12)
    np.testing.assert_allclose(bent.delta_component.sum(axis=1), bent.delta, atol=1e-15)
    at_feed = bent.path.cutting & (bent.path.step_length > 0)
    expected = np.tile([-30.0, 100.0, -20.0], (int(at_feed.sum()), 1))
    np.testing.assert_allclose(bent.force_components[at_feed], expected, atol=1e-9)


def test_the_machined_path_is_the_commanded_one_moved(bent):
    R = bent.setup.T_MW[:3, :3]
    for i in range(len(bent.path)):
        j = i + 1 if not bent.path.cutting[i] and i + 1 < len(bent.path) and bent.path.cutting[i + 1] else i
        np.testing.assert_allclose(bent.p_machined[i], bent.path.p[i] + R.T @ bent.delta[j], atol=1e-15)


def test_stations_and_sections(bent):
    total = sum(np.linalg.norm(np.diff(bent.path.p, axis=0), axis=1)[bent.path.cutting[1:]])
    np.testing.assert_allclose(bent.stations, [0.1 * n * total for n in range(1, 10)])
    assert [section.station for section in bent.sections] == bent.stations.tolist()
    one = bent.groove(float(bent.stations[3]))
    assert (one.width, one.centre_offset) == (bent.sections[3].width, bent.sections[3].centre_offset)
    np.testing.assert_array_equal(one.z_machined, bent.sections[3].z_machined)


@pytest.mark.parametrize(
    ("station", "words"),
    [
        (50, "50 mm is meant, give 0.05"),  # mm as m, within the path
        (5000, r"runs from 0 to \d+\.\d\d mm\.$"),  # nothing that would be on it in mm
        (-0.01, r"runs from 0 to \d+\.\d\d mm\.$"),
    ],
)
def test_a_station_beyond_the_path_says_how_far_it_goes_and_whether_mm_were_meant(bent, station, words: str):
    with pytest.raises(SurfaceError, match=words):
        bent.groove(station)
    with pytest.raises(SurfaceError, match=words):
        bent.grooves([0.01, station])


@pytest.mark.parametrize(("stations", "count"), [([0.01, 0.02], 2), ([0.01], 1), (np.full((2, 3), 0.01), 6)])
def test_several_stations_are_asked_of_grooves_and_one_of_groove(bent, stations, count: int) -> None:
    with pytest.raises(SurfaceError, match=f"expected one station, found {count}; give several to grooves"):
        bent.groove(stations)


def test_what_is_not_reached_is_not_cut():
    found = program("G0 X0 Y0 Z-2", "G1 X50 F1800", "G1 Y-3000", "G1 Y0", step=10e-3)
    for i in range(1, len(found.path)):
        expected = found.path.cutting[i] and found.reached[i] and found.reached[i - 1]
        assert found.removes[i] == expected
    assert not found.removes[0]
    assert found.removes.sum() > 5
    np.testing.assert_array_equal(found.p_machined[~found.reached], found.path.p[~found.reached])


def largest_on_part(result) -> float:
    """Along two straight slots the wall is off by the part of the deviation to the left, the floor by that upwards."""
    size = 0.0
    for i in np.flatnonzero(result.judged):
        size = max(size, abs(result.R_MF[i, :, 1] @ result.delta[i]), abs(result.R_MF[i, :, 2] @ result.delta[i]))
    return size


@pytest.mark.parametrize(
    ("share", "used", "level"),
    [
        (0.5, "50 %", "ok"),
        (0.799, "80 %", "ok"),
        (0.801, "80 %", "tight"),
        (0.999, "99.9 %", "tight"),
        (1.001, "100.1 %", "out"),
    ],
)
def test_the_verdict_follows_the_share_of_the_tolerance(bent, share, used, level):
    judged = rm.simulate(bent.setup.replace(tolerance=largest_on_part(bent) / share)).verdict
    assert (judged.level, judged.red) == (level, level == "out")
    assert judged.share == pytest.approx(share, abs=2e-4)
    assert f" ({used} of it used)" in judged.sentence


def test_what_uses_the_whole_tolerance_is_tight_and_just_four_fifths_too(bent):
    exact = dataclasses.replace(bent, setup=bent.setup.replace(tolerance=abs(bent.verdict.wall.value)))
    assert exact.verdict.level == "tight"
    assert exact.verdict.share == 1.0
    up = bent.R_MF[..., 2] * 0.8e-3
    odd = dataclasses.replace(bent, delta=up)
    assert dataclasses.replace(odd, setup=bent.setup.replace(tolerance=1e-3)).verdict.level == "tight"


def test_three_tolerances_judge_apart(bent):
    wall, floor = (abs(reading.value) for reading in (bent.verdict.wall, bent.verdict.floor))
    for tolerance, level, share in (
        ((2 * wall, 4 * floor, 0.05), "ok", 0.5),
        ({"wall": 4 * wall, "floor": 0.5 * floor}, "out", 2.0),
        ({"wall": 4 * wall, "floor": floor / 0.9, "feed": 0.05}, "tight", 0.9),
    ):
        found = dataclasses.replace(bent, setup=bent.setup.replace(tolerance=tolerance)).verdict
        assert found.level == level
        assert found.share == pytest.approx(share)
    assert found.floor.tolerance == pytest.approx(floor / 0.9)
    assert found.end.tolerance == 0.05


def test_what_has_no_model_is_counted_and_never_green(bent):
    where = bent.path.block == 7
    reason = Unjudged("no-model", where, "The cutter has no model there.")
    lost = np.where(where[:, None], np.nan, bent.delta)
    loose = bent.setup.replace(tolerance=0.05)
    partly = dataclasses.replace(bent, setup=loose, delta=lost, unjudged=(reason,))
    assert partly.verdict.level == "unjudged"
    assert partly.verdict.red
    assert partly.not_judged.sum() == (where & bent.path.cutting).sum() > 0
    assert f"{partly.not_judged.sum()} of {bent.path.cutting.sum()} points of the cut" in partly.verdict.sentence
    assert "line 7" in partly.verdict.sentence
    assert reason.why[:-1] in partly.verdict.sentence
    out = dataclasses.replace(bent, setup=bent.setup.replace(tolerance=1e-6), delta=lost, unjudged=(reason,))
    assert out.verdict.level == "out"
    nothing = dataclasses.replace(partly, delta=np.full_like(bent.delta, np.nan), F=np.full_like(bent.F, np.nan))
    assert nothing.verdict.level == "unjudged"
    assert nothing.worst == -1


def test_a_verdict_names_three_lines_that_are_not_reached():
    far = ["G0 X0 Y0 Z-2", "G1 X50 F1800", *(f"G1 Y-{3000 + n}" for n in range(4))]
    found = program(*far, step=0.5)
    verdict = found.verdict
    missed = [i for i in range(len(found.path)) if not found.reached[i]]
    lines = sorted({int(found.path.block[i]) for i in missed})
    assert len(lines) == 4
    named = ", ".join(map(str, lines[:3]))
    assert verdict.level == "unreached"
    assert verdict.sentence.startswith(f"{len(missed)} of {len(found.path)} points cannot be reached (line {named} and")
    assert verdict.share == pytest.approx(largest_on_part(found) / SETUP.tolerance, abs=2e-3)
    three = program(*far[:-1], step=0.5)
    assert " and more" not in three.verdict.sentence


def test_levels_where_nothing_is_cut():
    assert program("G0 X0 Y90 Z-2", "G1 X50 F1800").verdict.level == "missed"
    assert program("G0 X0 Y90 Z-2", "G1 X50 F1800", "G1 Y9000", step=0.5).verdict.level == "missed"
    nowhere = rm.simulate(SETUP.replace(T_MW=part_frame([9.0, 0, 0])))
    assert nowhere.verdict.level == "unreached"
    assert "No point of the cut can be reached" in nowhere.verdict.sentence
    assert np.isnan(nowhere.verdict.share)
    assert np.isnan(nowhere.rms_deviation)
    assert nowhere.worst_block == 0
    for given in (SETUP, PROCESS):
        record = simulation_record(rm.simulate(given.replace(T_MW=part_frame([0.0, -3.0, 0.002]))))
        assert record["verdict"] == "unreached"
        assert record["reached"]["count"] == 0
        assert record["reached"]["reason"]
        assert record["surface"]["removed_volume_mm3"] == 0.0
    mapped = rm.load_setup(samples_dir() / "paper_flute" / "setup_measured_map.toml")
    outside = rm.simulate(mapped.replace(T_MW=part_frame([0.7, -1.3, 0.002])))
    assert outside.reached.all()
    assert outside.verdict.level == "unreached"
    assert "inside the measured map" in outside.verdict.sentence


def codes(setup):
    return {note.code for note in rm.simulate(setup).notes}


def test_notes_say_what_the_numbers_rest_on():
    mapped = rm.load_setup(samples_dir() / "paper_flute" / "setup_measured_map.toml")
    springs = (SpindleSpring(1e-7),)
    assert "springs-in-map" not in codes(mapped)
    assert "springs-in-map" in codes(mapped.replace(springs=springs))
    assert "springs-in-map" not in codes(SETUP.replace(springs=springs))
    assert "full-slot" not in codes(PROCESS)
    assert "full-slot" in codes(PROCESS.replace(engagement=False))
    assert "full-slot" not in codes(SETUP)


def test_the_error_is_that_of_both_surfaces(bent):
    again = deviation(bent.ideal, bent.machined)
    np.testing.assert_array_equal(bent.error.error, again.error)
    assert bent.error.excess_volume == again.excess_volume > 0


def test_rapids_through_material_are_named_once_in_order():
    cut_through = ("G0 X-40 Y-15 Z-2", "G0 X40", "G0 Y-5", "G0 X-40", "G0 Z5", "G0 X40 Y15")
    found = program("G0 Z9", "G0 X-40 Y0", "G1 Z-2 F300", "G1 X40", "G0 Z9", *cut_through, "G0 Z9")
    # down into the part, across it, aside, back and up again; flying above is not
    (note,) = [note for note in found.surface_notes if note.code == "rapid-in-material"]
    assert note.line == 7
    assert "(also line 8, 9, 10 and more)" in note.message
    more = program("G0 Z9", "G0 X-40 Y0", "G1 Z-2 F300", "G1 X40", *(f"G0 Y{4 * n} Z-2" for n in range(-1, -8, -1)))
    assert found.surface_notes != more.surface_notes
    clear = program("G0 Z9", "G0 X-40 Y0", "G1 Z-2 F300", "G1 X40", "G0 X-40", "G0 Z9", "G0 X90 Y90", "G0 Z-2")
    assert clear.surface_notes == ()  # back through the groove it has cut, and beside the stock


def test_a_feed_tolerance_of_its_own_is_judged():
    """400 N against the feed on a straight groove move no wall: green, unless the feed has a tolerance it exceeds."""
    pushed = SETUP.replace(force=PathForce(feed=-400.0))
    run = rm.simulate(pushed)
    along = np.nanmax(np.abs(run.delta[run.path.cutting] @ SETUP.T_MW[:3, 0]))
    assert along > 0.3e-3
    assert run.verdict.level == "ok"
    assert rm.simulate(pushed.replace(feed_tolerance=1.01 * along)).verdict.level == "tight"
    found = rm.simulate(pushed.replace(feed_tolerance=0.99 * along)).verdict
    assert found.level == "out"
    assert found.share == pytest.approx(1 / 0.99, rel=1e-9)


def test_the_law_of_a_thrust_is_told_where_it_was_used():
    hole = GCodeSource("G21 G90 S12000 M3\nG0 X0 Y0 Z5\nG81 Z-4 R2 F300\nG80\nM2\n")
    drill = dataclasses.replace(PROCESS.cutter, kind="drill", flutes=2, tip_angle=np.radians(118.0))
    mill, lips = (codes(PROCESS.replace(source=hole, cutter=c)) for c in (PROCESS.cutter, drill))
    stated = codes(SETUP.replace(source=hole))
    laws = {"thrust-end-teeth", "thrust-lips"}
    assert [run & laws for run in (mill, lips, stated)] == [{"thrust-end-teeth"}, {"thrust-lips"}, set()]


def test_a_rapid_through_the_part_is_not_judged_and_never_green():
    slot = ("G0 X-60 Y0", "G0 Z-2", "G1 X60 F1800", "G0 Z20")
    calm = program(*slot)
    rash = program(*slot, "G0 X-60 Y14", "G0 Z-1", "G0 X60")
    assert calm.verdict.level in ("ok", "tight")
    assert calm.rapids == ()
    assert (rash.verdict.level, rash.rapids) == ("unjudged", (8,))
    assert rash.verdict.wall == calm.verdict.wall
    assert simulation_record(rash)["not_judged"]["rapids"] == [8]


def test_what_is_out_of_tolerance_counts_walls_by_length_and_height():
    """The paper's slot is cut 96 mm far and 2 mm deep: walls of 2 x 96 x 2 mm, a floor of 96 x 8 mm. Walls are out
    where their tolerance is closer than 0.2295 mm, floors where theirs is closer than 0.1024 mm."""
    setup = SETUP.replace(tolerance=0.2e-3, floor_tolerance=0.15e-3, cell=1e-4)
    found = rm.simulate(setup)
    walls, floors = 2 * 0.002 * 0.096, 0.008 * 0.096
    out, all_of_it = found.area_out
    assert all_of_it == pytest.approx(floors + walls, rel=0.05)
    assert out == pytest.approx(walls, rel=0.05)
    within = rm.simulate(setup.replace(tolerance=0.24e-3, floor_tolerance=0.12e-3))
    assert (within.area_out[0], within.verdict.level) == (0.0, "tight")
    closer = rm.simulate(setup.replace(floor_tolerance=0.05e-3)).area_out[0]
    assert closer == pytest.approx(floors + walls, rel=0.05)


@pytest.mark.parametrize(("x", "lost"), [(-60.0, 0), (-50.1, 0), (-49.0, 2), (0.0, 2)])
def test_a_plunge_beside_the_stock_cuts_air_and_one_into_it_has_no_number(x: float, lost: int) -> None:
    """The stock begins at X -46 and the mill has a radius of 4 mm; its top lies at Z 0, 2 mm over the plunge's end."""
    flute = rm.load_setup("paper_flute")
    text = f"G21 G90\nS12000 M3\nG0 X{x:g} Y0 Z5\nG1 Z-2 F300\nG1 X60 F1800\nG0 Z20\nM2\n"
    found = rm.simulate(flute.replace(source=rm.GCodeSource(text)))
    assert found.not_judged.sum() == lost
    assert found.verdict.wall.value == pytest.approx(0.2295e-3, rel=1e-3)  # the paper's own


@pytest.mark.parametrize("out", ["G0 Z10", "G1 Z10 F100", "G1 Z10 F2000", "G85"])
def test_a_plunge_is_as_deep_however_the_tool_is_drawn_out_of_it(out: str) -> None:
    """Who measures the hole finds the plunge's own error, C F of its last step; after a dwell it is cut to depth."""
    bored = "G85 X0 Y0 Z-5 R1 F100\nG80" if out == "G85" else f"G1 Z-5 F100\n{out}"
    text = f"G21 G90\nS12000 M3\nG0 X0 Y0 Z10\n{bored}\nG0 Z20\nM2\n"
    found = rm.simulate(PROCESS.replace(source=GCodeSource(text)))
    bottom = int(np.flatnonzero(found.path.p[:, 2] == found.path.p[:, 2].min())[0])
    assert found.verdict.floor.value == pytest.approx((found.C[bottom] @ found.F[bottom])[2], rel=1e-6)
    closer = rm.simulate(PROCESS.replace(source=GCodeSource(text), step=1e-4))
    assert closer.verdict.floor.value == pytest.approx(found.verdict.floor.value, rel=1e-6)
    waited = rm.simulate(PROCESS.replace(source=GCodeSource(text.replace("G1 Z10", "G4 P1\nG1 Z10"))))
    assert waited.verdict.floor.value == (0.0 if out.startswith("G1") else found.verdict.floor.value)


def test_a_notebook_names_all_that_a_run_assumes_or_that_it_assumes_nothing() -> None:
    """The largest deviation and its root mean square are those of its samples, in mm."""
    run = rm.simulate(SETUP)
    shown = run._repr_html_()
    sizes = [float(np.linalg.norm(run.delta[i])) for i in range(len(run.path)) if run.judged[i]]
    assert f"{1e3 * max(sizes):.3f} mm" in shown
    assert f"{1e3 * np.sqrt(np.mean(np.square(sizes))):.3f} mm" in shown
    assert len(run.assumed) > 1
    assert all(each.what in shown for each in run.assumed)
    assert "nothing" not in shown
    stated = dataclasses.replace(run)
    vars(stated)["assumed"] = ()
    assert "nothing" in stated._repr_html_()
