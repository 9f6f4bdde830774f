"""Columns of a run: its arrays in display units, one name a column."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.io.samples import samples_dir


@pytest.fixture(scope="module")
def result():
    return rm.simulate(rm.load_setup(samples_dir() / "paper_flute" / "setup.toml"))


def test_columns_are_the_arrays_in_millimetres(result):
    columns = result.columns()
    p = result.path.p @ result.setup.T_MW[:3, :3].T + result.setup.T_MW[:3, 3]
    for i, axis in enumerate("xyz"):
        np.testing.assert_allclose(columns[f"{axis.upper()}_M_mm"], p[:, i] * 1e3)
        np.testing.assert_allclose(columns[f"delta_{axis}_mm"], result.delta[:, i] * 1e3)
        np.testing.assert_allclose(columns[f"F_{axis}_N"], result.F[:, i])
        shares = sum(columns[f"joint{j}_{axis}_mm"] for j in range(1, 6))
        np.testing.assert_allclose(shares, columns[f"delta_{axis}_mm"], atol=1e-12)
        np.testing.assert_allclose(columns[f"joint3_{axis}_mm"], result.delta_joint[:, 2, i] * 1e3)
    size = np.sqrt(sum(columns[f"delta_{axis}_mm"] ** 2 for axis in "xyz"))
    np.testing.assert_allclose(columns["deviation_mm"], size)
    np.testing.assert_allclose(columns["station_mm"], result.path.s * 1e3)
    np.testing.assert_array_equal(columns["line"], result.path.block)
    np.testing.assert_array_equal(columns["cutting"], result.path.cutting)
    np.testing.assert_array_equal(columns["reached"], result.reached)


def test_sections_are_in_millimetres(result):
    columns = result.sections.columns()
    assert list(columns)[:6] == ["station_mm", "kind", "width_mm", "depth_mm", "centre_offset_mm", "floor_error_mm"]
    assert columns["kind"].tolist() == ["groove"] * len(result.sections)
    np.testing.assert_allclose(columns["wall_left_angle_deg"], 90.0)
    assert np.isnan(columns["slope_deg"]).all()
    np.testing.assert_allclose(columns["depth_mm"], [1e3 * s.depth for s in result.sections])
    np.testing.assert_allclose(columns["centre_offset_mm"], [1e3 * s.centre_offset for s in result.sections])


def test_springs_and_what_a_program_is_sent_aside_have_columns_of_their_own():
    """Of a corrected program whose spindle gives way: its shares with the joints' add up to what it is pushed."""
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(step=10e-3)
    setup = setup.replace(springs=(rm.SpindleSpring(lateral_um_N=0.5),))
    made = rm.compensate(setup).led
    columns, name = made.columns(), setup.springs[0].name.replace(" ", "_")
    for i, axis in enumerate("xyz"):
        np.testing.assert_allclose(columns[f"{name}_{axis}_mm"], made.delta_spring[:, 0, i] * 1e3)
        np.testing.assert_allclose(columns[f"ahead_{axis}_mm"], made.ahead[:, i] * 1e3)
        pushed = sum(columns[f"joint{j}_{axis}_mm"] for j in range(1, 6)) + columns[f"{name}_{axis}_mm"]
        np.testing.assert_allclose(columns[f"delta_{axis}_mm"], pushed + columns[f"ahead_{axis}_mm"], atol=1e-9)
    cut = made.path.cutting
    np.testing.assert_allclose(made.delta_spring[cut, 0, :2], 0.5e-6 * made.F[cut, :2], atol=1e-12)
