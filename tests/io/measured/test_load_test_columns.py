"""Columns of load tests are written as the templates and refusals show them, and read back as what they hold."""

import pytest

from robomill.io.columns import read_columns
from robomill.io.measured.load_test_columns import LAYOUT, written

AS_WRITTEN = {
    "fx": "Fx_N",
    "f0y": "F0y_N",
    "fpz": "FPz_mm",
    "mpx": "MPx_mm",
    "my": "My_Nm",
    "dx": "dx_mm",
    "d0z": "d0z_mm",
    "x": "X_mm",
    "b": "B_deg",
    "c": "C_deg",
    "w": "W_deg",
    "theta3": "theta3_deg",
    "pulley_y": "pulley_y_mm",
    "cable_z": "cable_z",
    "load": "load_N",
}


@pytest.mark.parametrize("name", AS_WRITTEN)
def test_a_name_is_written_as_people_write_it(name: str) -> None:
    assert written(name) == AS_WRITTEN[name]


@pytest.mark.parametrize("name", sorted(LAYOUT.units))
def test_whatever_is_written_is_read(name: str) -> None:
    columns, _ = read_columns(f"{written(name)};who\n1;2\n3;4\n", LAYOUT, "mine.csv")
    assert [*columns.values] == [name]
    assert columns.known[name].unit == LAYOUT.units[name][0]
