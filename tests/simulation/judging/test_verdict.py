"""The verdict from readings of plain shares of the tolerance: the largest that decides, and what is not known."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest

import robomill as rm
from robomill.identification.measured_field import MeasuredField
from robomill.simulation.judging.gauge import Gauge, Readings
from robomill.simulation.judging.verdict import decided, judge
from robomill.simulation.result import SimulationResult

TOLERANCES = (0.3e-3, 0.1e-3, 0.5e-3)  # wall, floor, feed


def readings(*errors: float) -> Readings:
    """Readings one after the other along the path, of one length each."""
    m = len(errors)
    row, rows = np.ones(m), np.zeros((m, 3))
    return Readings(np.arange(m) + 20, np.array(errors), row, row, np.zeros(m), rows, rows, rows, row)


def gauge(wall: float | None, floor: float | None, end: float | None) -> Gauge:
    """What is measured, as a share of its own tolerance; None: nothing."""
    return Gauge(
        *(
            readings() if share is None else readings(0.2 * share * allowed, -share * allowed, 0.5 * share * allowed)
            for share, allowed in zip((wall, floor, end), TOLERANCES, strict=True)
        )
    )


def toleranced(result: SimulationResult, *, feed: bool) -> SimulationResult:
    wall, floor, along = TOLERANCES
    setup = result.setup.replace(tolerance=wall, floor_tolerance=floor, feed_tolerance=along if feed else None)
    return dataclasses.replace(result, setup=setup)


SHARES = (None, 0.5, 0.9, 1.2)


@pytest.mark.parametrize("feed", [False, True])
@pytest.mark.parametrize(("wall", "floor", "end"), list(itertools.product(SHARES, repeat=3)))
def test_the_largest_share_that_decides(result: SimulationResult, feed: bool, wall, floor, end) -> None:
    """Out is what exceeds its own tolerance, wall, floor or, with a tolerance of its own, what lies along the feed; and
    the share used is by how much all tolerances can shrink, or must grow, before just that begins."""
    run = toleranced(result, feed=feed)
    measured, found = gauge(wall, floor, end), judge(run, gauge(wall, floor, end))
    counted = [(measured.walls.error, TOLERANCES[0]), (measured.floors.error, TOLERANCES[1])]
    if feed:
        on_its_way = np.einsum("mi,mi->m", run.delta, run.R_MF[:, :, 0])[run.judged]
        counted += [(measured.ends.error, TOLERANCES[2]), (on_its_way, TOLERANCES[2])]
    if not any(len(errors) for errors, _ in counted):
        counted = [(np.linalg.norm(run.delta, axis=1)[run.judged], TOLERANCES[0])]

    def exceeds(times: float) -> bool:
        return any(abs(error) > times * bound for errors, bound in counted for error in errors)

    assert found.level == ("out" if exceeds(1.0) else "tight" if exceeds(0.8) else "ok")
    rests = decided(run, found)
    allowed = {0: TOLERANCES[2], 1: TOLERANCES[0], 2: TOLERANCES[1], None: TOLERANCES[0]}[rests.kind.axis]
    assert rests.size == pytest.approx(found.share * allowed)
    assert rests.sample in ((run.worst,) if found.deciding is None else range(len(run.path)))
    assert found.red == exceeds(1.0)
    assert exceeds(found.share * (1.0 - 1e-9))
    assert not exceeds(found.share * (1.0 + 1e-9))
    bounds = (*TOLERANCES[:2], TOLERANCES[2 if feed else 0])  # the wall's is the one for all that have none
    for reading, given, bound in zip(
        (found.wall, found.floor, found.end), (measured.walls, measured.floors, measured.ends), bounds, strict=True
    ):
        if len(given.error):
            assert (reading.worst, reading.value, reading.tolerance) == (21, given.error[1], bound)
            assert reading.share_out == pytest.approx(np.mean(np.abs(given.error) > bound))
        else:
            assert reading.worst == -1
            assert np.isnan(reading.value)


@pytest.mark.parametrize(("edge", "level"), [(0.799, "ok"), (0.801, "tight"), (0.999, "tight"), (1.001, "out")])
def test_where_the_levels_begin(result: SimulationResult, edge: float, level: str) -> None:
    assert judge(toleranced(result, feed=False), gauge(0.1, edge, None)).level == level


@pytest.mark.parametrize("feed", [False, True])
@pytest.mark.parametrize("least", [0.0, 0.3e-3, 0.6e-3, 2e-3])
def test_how_much_of_the_path_is_out_along_the_feed(result: SimulationResult, feed: bool, least: float) -> None:
    """Sample by sample, ahead of its place or behind it, by the way that each one ends; pushed aside is not out."""
    rng = np.random.default_rng(7)
    m = len(result.path)
    ahead = rng.choice([-1.0, 1.0], m) * rng.uniform(least, 1e-3 + least, m)
    pushed = np.column_stack([ahead, np.full(m, 5e-3), np.zeros(m)])
    bent = dataclasses.replace(result, delta=np.einsum("mij,mj->mi", result.R_MF, pushed))
    run = toleranced(bent, feed=feed)
    bound, p = TOLERANCES[2 if feed else 0], run.path.p
    ways = {i: float(np.linalg.norm(p[i] - p[i - 1])) if i else 0.0 for i in range(m) if run.judged[i]}
    out = sum(way for i, way in ways.items() if abs(ahead[i]) > bound)
    found = judge(run, gauge(None, None, None)).feed.share_out
    assert found == pytest.approx(out / sum(ways.values()))
    assert (found == 1.0) == (least >= bound)


@pytest.mark.parametrize(
    ("share", "unjudged"), [(0.5, "unjudged"), (0.9, "unjudged"), (1.2, "out"), (None, "unjudged")]
)
def test_what_is_not_known_is_never_green(result: SimulationResult, share, unjudged: str) -> None:
    """Points out of reach come first; points without a force leave red red and make everything else unjudged."""
    run = toleranced(result, feed=False)
    cut = int(np.flatnonzero(run.path.cutting)[3])
    reached, F, delta = run.reached.copy(), run.F.copy(), run.delta.copy()
    F[cut] = delta[cut] = np.nan
    found = judge(dataclasses.replace(run, F=F, delta=delta), gauge(share, None, None))
    assert found.level == unjudged
    assert ("of it used" in found.sentence) == (share is not None), "a figure stands only where one was measured"
    reached[cut] = False
    gone = dataclasses.replace(run, F=F, delta=delta, ik=dataclasses.replace(run.ik, reached=reached))
    found = judge(gone, gauge(share, None, None))
    assert (found.level, found.red) == ("unreached", True)
    assert f"1 of {len(run.path)} points" in found.sentence
    off = dataclasses.replace(run, delta=delta)  # a force, and no compliance: outside of what was measured
    assert judge(off, gauge(share, None, None)).level == "unreached"


def test_where_nothing_is_judged_nothing_is_read(result: SimulationResult) -> None:
    cuts = result.path.cutting[:, None]
    silent = dataclasses.replace(result, F=np.where(cuts, np.nan, result.F), delta=np.where(cuts, np.nan, result.delta))
    found = judge(toleranced(silent, feed=True), gauge(None, None, None))
    assert found.level == "unjudged"
    for reading in (found.wall, found.floor, found.feed, found.end):
        assert reading.worst == -1
        assert np.isnan(reading.value)
    assert np.isnan(found.share)


@pytest.mark.parametrize(
    ("wall", "floor", "feed", "level"),
    [
        (0.1, 0.05, 0.01, "tight"),
        (0.1 - 1e-7, 0.05, 0.01, "out"),
        (0.1, 0.05 - 1e-7, 0.01, "out"),
        (0.1, 0.05, 0.01 - 1e-7, "out"),
        (0.125 + 1e-6, 0.0625 + 1e-6, 0.0125 + 1e-6, "ok"),
    ],
)
def test_what_is_exactly_on_its_limit_is_within_it(wall: float, floor: float, feed: float, level: str) -> None:
    """1 um/N across and 2 um/N along the tool, 10 N along the feed, 100 N across it and 25 N into the part: the wall is
    0.1 mm off, the floor 0.05 mm too deep and the tip 0.01 mm ahead, whatever the last bits of a subtraction say."""
    p = [[x, -1.3, z] for x in (-0.1, 0.1) for z in (-0.1, 0.1)]
    setup = rm.SimulationSetup(
        robot=rm.load_robot("slavkovic_5r"),
        source=rm.Toolpath.from_points(p_mm=[[-30, 0, 5], [-30, 0, -2], [30, 0, -2]], feed_mm_min=[0, 0, 1800]),
        part_zero_mm=(0, -1300, 0),
        cutter=rm.Cutter("flat", diameter_mm=8, flutes=3),
        force=rm.PathForce(10.0, 100.0, -25.0),
        measured_map=MeasuredField(p, np.tile(np.diag([1e-6, 1e-6, 2e-6]), (4, 1, 1))),
        stock=rm.Stock(lower_mm=[-20, -20, -10], upper_mm=[40, 20, 0]),
        tolerance_mm=(wall, floor, feed),
        step_mm=5,
    )
    run = rm.simulate(setup)
    assert run.verdict.level == level
    assert (run.area_out[0] > 0.0) == (wall < 0.1 or floor < 0.05)
