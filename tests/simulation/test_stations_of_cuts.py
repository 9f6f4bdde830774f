"""What holds at a station, against plane geometry on paths that one can draw."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import robomill as rm
from robomill.io.samples import samples_dir
from robomill.simulation import stations
from robomill.simulation.given import part_frame
from robomill.simulation.origin.spread import alloy_spread
from robomill.toolpath.source import GCodeSource, LinesSource

SETUP = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml")
PROCESS = rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml")


def run(*lines, setup=SETUP, **changes):
    """A run of straight cuts, each from where the one before ended (mm in the part's frame)."""
    points = np.array(lines, dtype=float) * 1e-3
    source = LinesSource(points[:-1], points[1:], [0.03] * (len(points) - 1), 100.0)
    return rm.simulate(setup.replace(source=source, **changes))


@pytest.fixture(scope="module")
def corner():
    return run((-30, 0, -2), (0, 0, -2), (0, 15, -2), step=4e-3)


def test_samples_nearest_to_a_station(corner):
    """The samples at feed stand 30 / 8 mm and 15 / 4 mm apart: the nearest is found by rounding."""
    for station in (0.0, 0.0011, 0.0299, 0.031, 0.0449, 0.09):
        i = stations.nearest_feed(corner, station)
        assert corner.path.cutting[i]
        assert abs(corner.path.s[i] - min(station, 0.045)) <= 0.5 * 0.00375 + 1e-12
        assert stations.nearest_judged(corner, station) == i


def test_judged_samples_are_only_those_in_the_stock():
    text = "G21 G90 S9000 M3\nG0 X0 Y90 Z-2\nG1 X50 F1800\nG0 Z9\nG0 X-40 Y0\nG0 Z-2\nG1 X0\nM2\n"
    found = rm.simulate(SETUP.replace(source=GCodeSource(text)))
    i, j = stations.nearest_feed(found, 0.02), stations.nearest_judged(found, 0.02)
    assert (int(found.path.block[i]), int(found.path.block[j])) == (3, 7)
    assert stations.nearest_judged(rm.simulate(SETUP.replace(T_MW=part_frame([9.0, 0, 0]))), 0.02) == -1


def test_places_on_a_path(corner):
    for station, point, way in (
        (0.0, (-0.03, 0, -0.002), (1, 0, 0)),
        (0.0101, (-0.0199, 0, -0.002), (1, 0, 0)),
        (0.03, (0, 0, -0.002), (1, 0, 0)),
        (0.0302, (0, 0.0002, -0.002), (0, 1, 0)),
        (-1.0, (-0.03, 0, -0.002), (1, 0, 0)),
        (9.0, (0, 0.015, -0.002), (0, 1, 0)),
    ):
        found, direction = stations.place_at(corner.path, station)
        np.testing.assert_allclose(found, point, atol=1e-12)
        np.testing.assert_allclose(direction, way, atol=1e-12)


def test_one_way_and_one_groove(corner):
    slot, back = run((-30, 0, -2), (20, 0, -2)), run((-30, 3, -2), (20, 3, -2), (-10, 3, -2))
    ramp = run((-30, 0, -1), (0, 0, -1), (20, 0, -2))
    beside = rm.simulate(
        SETUP.replace(source=GCodeSource("G21 G90 S9000 M3\nG0 X-30 Y0 Z-2\nG1 X0 F900\nG0 Y9\nG1 X-30\nM2\n"))
    )
    skew = run((-30, 0, -2), (0, 0.002, -2), (20, 0, -2))  # 2 um beside the line
    there_and_back = run((-30, 0, -2), (20, 0, -2), (-30, 0, -2))
    holes = rm.simulate(SETUP.replace(source=GCodeSource("G21 G90 S9000 M3 F90\nG81 X-30 Y0 Z-2 R2\nX0\nX30\nM2\n")))
    assert [r.path.goes_one_way for r in (slot, back, ramp, beside, corner, skew)] == [True] * 2 + [
        False,
        True,
        False,
        False,
    ]
    grooves = [r.path.on_one_line for r in (slot, back, ramp, beside, corner, skew, there_and_back, holes)]
    assert grooves == [True, True, True, False, False, False, True, False]


def test_joint_shares_are_what_each_joint_moves_along_the_deviation(corner):
    i = corner.worst
    alone, along = [], []
    for n in range(5):
        C_theta = np.where(np.arange(5) == n, SETUP.robot.C_theta, 0.0)
        other = rm.simulate(corner.setup.replace(robot=SETUP.robot.replace(C_theta=C_theta)))
        alone.append(other.delta[i] @ corner.delta[i] / (corner.delta[i] @ corner.delta[i]))
        along.append(other.delta_in_cut[i] / corner.delta_in_cut[i])
    np.testing.assert_allclose(stations.joint_shares(corner, i), alone, atol=1e-12)
    assert sum(alone) == pytest.approx(1.0)
    for axis, shares in enumerate(np.transpose(along)):
        np.testing.assert_allclose(stations.joint_shares(corner, i, axis), shares, atol=1e-9)
        assert not np.allclose(shares, alone, atol=1e-3)
    stiff = rm.simulate(SETUP.replace(robot=SETUP.robot.replace(C_theta=np.zeros(5))))
    np.testing.assert_array_equal(stations.joint_shares(stiff, stiff.worst), 0.0)


def test_rows_of_the_alloy_are_runs_of_their_own():
    """Force and groove of each row: the simulation run again with the row's material; in the range alone, what another
    row does not give is as in the row in force."""
    result = rm.simulate(PROCESS)
    spread = alloy_spread(result)
    forces, middle = stations.force_components(result, spread), 0.5 * float(result.path.s[-1])
    i = stations.nearest_feed(result, middle)
    offset = result.groove(middle).centre_offset
    offsets = stations.offset_by_row(result, spread, [middle, middle], [offset, 0.0])
    materials = (PROCESS.force.material, *PROCESS.force.alternatives)
    assert forces.shape[0] == len(materials) > 1
    for row, material in enumerate(materials):
        filled = material.replace(**{name: getattr(PROCESS.force.material, name) for name in material.missing})
        force = dataclasses.replace(PROCESS.force, material=filled, alternatives=())
        other = rm.simulate(PROCESS.replace(force=force))
        np.testing.assert_allclose(forces[row], other.force_components, atol=1e-9)
        np.testing.assert_allclose(spread.delta[row], other.delta, atol=1e-15)
        np.testing.assert_allclose(spread.deviation[row], np.sqrt((other.delta**2).sum(axis=1)), atol=1e-15)
        aside = float((other.delta[i] - result.delta[i]) @ result.R_MF[i, :, 1])
        assert offsets[row] == pytest.approx([offset + aside, aside], abs=1e-12)
        if row == 1:
            assert offsets[row, 0] == pytest.approx(other.groove(middle).centre_offset, abs=5e-6)


def test_only_forces_from_a_material_have_rows_and_a_peak():
    from robomill.simulation.origin.spread import peak_force

    stated, computed = rm.simulate(SETUP), rm.simulate(PROCESS)
    assert alloy_spread(stated) is None
    assert peak_force(stated) is None
    peak, i = peak_force(computed), computed.worst
    mean = computed.force_components[i]
    assert np.hypot(*peak.at_peak[i][:2]) >= np.hypot(*mean[:2])
    spread = alloy_spread(computed)
    assert spread.materials[0].name == PROCESS.force.material.name
    assert (spread.F[:, ~computed.conditions.cutting] == 0.0).all()


def test_no_row_of_the_alloy_knows_a_force_that_has_no_model():
    """From M4 on a right-hand cutter turns against its teeth: each row's own run knows no force there, nor its row."""
    turned = "G21 G90 S12000 M3\nG0 X-50 Y0 Z-2\nG1 X0 F1800\nM4\nG1 X50\nM2\n"
    result = rm.simulate(PROCESS.replace(source=GCodeSource(turned)))
    spread, against = alloy_spread(result), result.path.block == 5
    assert np.isnan(spread.F[:, against & result.conditions.engaged]).all()
    for row, material in enumerate(spread.materials):
        filled = material.replace(**{name: getattr(PROCESS.force.material, name) for name in material.missing})
        other = rm.simulate(
            result.setup.replace(force=dataclasses.replace(PROCESS.force, material=filled, alternatives=()))
        )
        np.testing.assert_allclose(spread.F[row], other.F, atol=1e-9)
        np.testing.assert_allclose(spread.delta[row], other.delta, atol=1e-15)
