"""What holds at a station of the cut."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.io.materials import sample_materials
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.simulation import stations
from robomill.simulation.origin.spread import AlloySpread, alloy_spread
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import simulate
from robomill.simulation.stations import (
    force_components,
    largest_deviations,
    move_at,
    nearest_judged,
    offset_band,
    place_at,
    sideways,
)
from robomill.surface.sections.metrology import groove_profile
from robomill.toolpath.path import Toolpath
from robomill.toolpath.source import GCodeSource


def test_place_is_on_the_path(result: SimulationResult) -> None:
    for station in (0.0, 0.0333, 0.05, 0.1):
        point, along = place_at(result.path, station)
        np.testing.assert_allclose(point, [-0.05 + station, 0.0, -0.002], atol=1e-9)
        np.testing.assert_allclose(along, [1.0, 0.0, 0.0], atol=1e-12)


def test_places_along_a_path_with_corners_and_a_rapid_are_found_by_walking_it() -> None:
    """Every piece of a zigzag has a direction of its own; a rapid does not count, and the ends hold what is beyond."""
    p = np.array(
        [(0, 0, 1), (0, 0, 0), (3, 4, 0), (3, 9, 0), (20, 9, 5), (20, 9, 0), (14, 1, -1), (14, 1, -1), (15, 3, 1)]
    )
    p, cutting = p * 1e-3, np.array([False, True, True, True, False, False, True, True, True])
    m = len(p)
    zeros = np.zeros(m)
    path = Toolpath(
        p, np.tile([0.0, 0.0, 1.0], (m, 1)), np.full(m, 0.01), cutting, np.arange(m), zeros, np.zeros(m, int)
    )
    passed = 0.0
    for a, b, on in zip(p[:-1], p[1:], cutting[1:], strict=True):
        length = float(np.linalg.norm(b - a))
        if not on or length == 0.0:
            continue
        for share in (0.1, 0.5, 0.9):
            point, along = place_at(path, passed + share * length)
            np.testing.assert_allclose(point, a + share * (b - a), atol=1e-12)
            np.testing.assert_allclose(along, (b - a) / length, atol=1e-12)
        passed += length
    for beyond, end in ((-1.0, p[0]), (passed + 1.0, p[-1])):
        np.testing.assert_allclose(place_at(path, beyond)[0], end, atol=1e-12)


def test_the_nearest_judged_sample(result: SimulationResult) -> None:
    judged = [i for i in range(len(result.path)) if result.judged[i]]
    for station in (0.0, 0.0333, 0.0334, 0.1, 1.0):
        found = nearest_judged(result, station)
        assert found in judged
        assert abs(result.path.s[found] - station) == min(abs(result.path.s[i] - station) for i in judged)


def test_where_nothing_is_judged_there_is_no_sample(result: SimulationResult) -> None:
    far = simulate(dataclasses.replace(result.setup, T_MW=_moved(result, 50.0)))
    assert not far.judged.any()
    assert nearest_judged(far, 0.05) == -1


def _moved(result: SimulationResult, metres: float) -> np.ndarray:
    T = np.array(result.setup.T_MW)
    T[0, 3] += metres
    return T


def test_a_groove_is_straight_while_every_cut_goes_one_way() -> None:
    def path(*points: tuple[float, float]) -> Toolpath:
        m = len(points)
        p = np.array([(x, y, -0.001) for x, y in points])
        k, zeros = np.tile([0.0, 0.0, 1.0], (m, 1)), np.zeros(m, dtype=int)
        return Toolpath(p, k, np.full(m, 0.01), np.arange(m) > 0, np.arange(m), np.zeros(m), zeros)

    assert path((0, 0), (0.01, 0.01), (0.03, 0.03)).goes_one_way
    assert not path((0, 0), (0.01, 0.0), (0.01, 0.01)).goes_one_way
    assert not path((0, 0), (0.01, 0.0), (0.02, 1e-4)).goes_one_way
    assert path((0, 0), (0.01, 0.0), (0.01, 0.0), (0.02, 0.0)).goes_one_way


def test_the_alloys_rows_by_sample_and_row(result: SimulationResult) -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    F = np.random.default_rng(3).normal(size=(3, len(result.path), 3)) * 40.0
    delta = np.random.default_rng(4).normal(size=F.shape) * 1e-4
    spread = AlloySpread(tuple(sample_materials()[:3]), F, delta)
    feed, normal = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])  # the flute runs along X
    R, found = setup.T_MW[:3, :3], force_components(result, spread)
    for r in range(3):
        for i in np.flatnonzero(result.path.cutting)[::17]:
            assert found[r, i, :2] == pytest.approx([F[r, i] @ (R @ feed), F[r, i] @ (R @ normal)])
    largest = largest_deviations(result, spread)
    judged = np.flatnonzero(result.judged)
    assert largest == pytest.approx([max(np.linalg.norm(delta[r, i]) for i in judged) for r in range(3)])
    profile = groove_profile(result.grooves(np.array([0.03, 0.05, 0.08])))
    low, high = offset_band(result, spread, profile)
    for k, station in enumerate(profile.station):
        i = int(np.argmin(np.where(result.path.cutting, np.abs(result.path.s - station), np.inf)))
        every = [profile.centre_offset[k] + (delta[r, i] - result.delta[i]) @ (R @ normal) for r in range(3)]
        assert (low[k], high[k]) == pytest.approx((min(every), max(every)))


def test_sideways_at_mid_cut_over_the_alloys_rows_is_that_of_runs_with_them(result: SimulationResult) -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup_process.toml").replace(cell=4e-4, coupling=False)
    force = setup.force
    assert isinstance(force, MechanisticForce)
    run = simulate(setup)
    offset, low, high = sideways(run)
    assert offset == run.groove(0.5 * float(run.path.s[-1])).centre_offset
    spread = alloy_spread(run)
    assert spread is not None
    others = [
        sideways(simulate(setup.replace(force=dataclasses.replace(force, material=row))))[0]
        for row in spread.materials
        if not row.unknown
    ]
    assert max(others) == pytest.approx(high, abs=5e-6)
    assert low - 5e-6 <= min(others)  # one row leaves the axial force open: it has the axial force of the one in force
    assert high - low > 5e-5
    stated = sideways(result)
    assert stated[0] == result.groove(0.5 * float(result.path.s[-1])).centre_offset
    assert np.isnan(stated[1:]).all()


def test_one_row_of_an_alloy_has_no_range_and_two_have(
    monkeypatch: pytest.MonkeyPatch, result: SimulationResult
) -> None:
    one = AlloySpread(tuple(sample_materials()[:1]), result.F[None], result.delta[None])
    monkeypatch.setattr(stations, "alloy_spread", lambda _: one)
    assert np.isnan(sideways(result)[1:]).all()
    softer = np.stack([result.delta, 1.5 * result.delta])
    two = AlloySpread(tuple(sample_materials()[:2]), np.stack([result.F] * 2), softer)
    monkeypatch.setattr(stations, "alloy_spread", lambda _: two)
    offset, low, high = sideways(result)
    middle = int(np.argmin(np.abs(result.path.s - 0.5 * result.path.s[-1]) + ~result.path.cutting))
    more = 0.5 * float(result.R_MF[middle, :, 1] @ result.delta[middle])
    assert (low, high) == pytest.approx(tuple(sorted((offset, offset + more))), abs=1e-9)


def test_the_move_at_a_station_is_the_one_that_is_being_made_even_where_it_is_not_judged() -> None:
    """5 mm down, 40 along, a rapid, 4 down and 20 back: a force stated along the path says nothing of a plunge."""
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    text = "G21 G90 S9000 M3\nG0 X-40 Y0 Z3\nG1 Z-2 F300\nG1 X0 F900\nG0 Z2\nG1 Z-2 F300\nG1 X-20 F900\nM2\n"
    found = simulate(setup.replace(source=GCodeSource(text), stock=None, cell=1e-3))
    ends = {3: 5e-3, 4: 45e-3, 6: 49e-3, 7: 69e-3}
    for station in np.linspace(1e-4, 69e-3, 137):
        line = min(line for line, end in ends.items() if station <= end + 1e-9)
        here = move_at(found, station)
        assert found.path.block[here] == line
        assert found.judged[here] == (line in (4, 7))
        assert found.path.s[here - 1] - 1e-9 <= station <= found.path.s[here] + 1e-9
    assert found.path.block[nearest_judged(found, 2e-3)] == 4
