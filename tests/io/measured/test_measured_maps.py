"""Measured maps in a set-up: numbers written by hand become SI by hand, and come back to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.errors import ProjectError
from robomill.identification.measured_field import MeasuredField
from robomill.io.beside import Beside
from robomill.io.measured.measured_maps import map_from_table, map_to_table
from robomill.io.samples import samples_dir
from robomill.io.tables import Table
from robomill.provenance import Provenance

ROBOT = rm.load_robot("slavkovic_5r")
P_MM = [[0.0, -1300.0, 10.0], [100.0, -1300.0, 10.0], [0.0, -1200.5, 10.0]]
C_M_N = [[float(10 * i + j) * 1e-7 for j in range(9)] for i in range(3)]
TILT_DEG = [[0.0, 0.0], [30.0, -45.0], [0.0, 90.0]]


def read(folder=None, **data):
    return map_from_table(Table(data, "setup.toml, [measured_map]"), ROBOT, Beside(folder))


def rows(points=3, matrices=3, tilts=3):
    return {"p_mm": P_MM[:points], "C_m_N": C_M_N[:matrices], "tilt_deg": TILT_DEG[:tilts], "reach_m": 0.25}


def test_rows_are_points_matrices_and_tilts():
    field = read(**rows(), provenance={"kind": "synthetic", "source": "gauge"})
    np.testing.assert_allclose(field.p, np.array(P_MM) / 1000, rtol=1e-15)
    for row, C in zip(C_M_N, field.C, strict=True):
        np.testing.assert_array_equal(C, [row[0:3], row[3:6], row[6:9]])
    np.testing.assert_allclose(field.AB, np.array(TILT_DEG) * np.pi / 180, rtol=1e-15)
    assert (field.reach, field.provenance) == (0.25, Provenance("synthetic", "gauge"))
    older = read(**rows(), source="gauge", synthetic=True)
    assert older.provenance == field.provenance


@pytest.mark.parametrize("counts", [(2, 3, 3), (3, 2, 3), (3, 3, 2), (3, 2, 2), (2, 2, 3), (1, 2, 3)])
def test_every_point_has_one_matrix_and_one_tilt(counts):
    with pytest.raises(ProjectError, match=f"expected {counts[0]} rows of"):
        read(**rows(*counts))


def test_a_map_comes_back_to_the_last_bit():
    rng = np.random.default_rng(0)
    field = MeasuredField(rng.normal(size=(7, 3)), rng.normal(size=(7, 3, 3)) * 1e-6, rng.normal(size=(7, 2)), 1 / 3)
    again = read(**map_to_table(field))
    for name in ("p", "C", "AB", "stderr"):
        np.testing.assert_array_equal(getattr(again, name), getattr(field, name))
    assert (again.reach, again.provenance) == (field.reach, field.provenance)


def test_a_file_of_measurements_is_looked_for_beside_the_set_up():
    folder = samples_dir() / "load_tests"
    field = read(folder, file="nine_points_compliances.csv")
    assert len(field.p) == 9
    with pytest.raises(rm.errors.RobomillError, match=r"nine_points_compliances\.csv"):
        read(folder.parent, file="nine_points_compliances.csv")
    with pytest.raises(ProjectError, match="p_mm: this key is not known here"):
        read(folder, file="nine_points_compliances.csv", p_mm=P_MM)
