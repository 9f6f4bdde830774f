"""Measured groove profiles from CSV."""

import numpy as np
import pytest

from robomill.errors import SurfaceError
from robomill.io.measured.profiles import read_profile


def test_units_order_comments_and_separators(tmp_path):
    text = "# measured on the CMM\nstation_mm;offset_um\n20;230\n10;220\n"
    found = read_profile(text)
    np.testing.assert_allclose(found.station, [0.01, 0.02])
    np.testing.assert_allclose(found.offset, [220e-6, 230e-6])
    path = tmp_path / "measured.csv"
    path.write_text("offset_mm,Station_in\n0.2,1\n0.3,2\n", encoding="utf-8")
    found = read_profile(path)
    assert found.name == "measured.csv"
    np.testing.assert_allclose(found.station, [0.0254, 0.0508])
    assert found.findings == ()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "the file is empty"),
        ("station,offset\n1,2\n2,3\n", "column 'station': the unit is missing; write one of station_mm"),
        ("station_mm,offset_mm\n1,2\n", "found 1 row of numbers; expected at least 2"),
        ("station_mm,offset_mm\n1,2\n2,\n", "Row 3, column offset_mm: the cell is empty, expected a number"),
        ("station_mm,offset_mm\n1,2\n2,wide\n", "Row 3, column offset_mm: found 'wide', expected a number"),
        ("station_mm,offset_mm\n1,2\n2,nan\n", "Row 3, column offset_mm: found 'nan'"),
        ("station_mm,offset_mm\n1,2\n2,1\n1,3\n", "Row 4, column station_mm: the station 1.000 mm is there twice"),
    ],
)
def test_refusals(text, message):
    with pytest.raises(SurfaceError, match=message):
        read_profile(text)


def test_a_wrong_unit_is_suspected():
    assert "check the unit" in read_profile("station_mm,offset_mm\n1,230\n2,231\n").findings[0]


@pytest.mark.parametrize(("largest", "said"), [(20.0, False), (20.1, True), (-20.1, True)])
def test_offsets_larger_than_twenty_millimetres_are_doubted(largest, said):
    found = read_profile(f"s_m,dy_mm\n0.5,{largest}\n0.25,1\n", name="cmm.csv")
    assert found.name == "cmm.csv"
    np.testing.assert_allclose(found.offset, [1e-3, largest * 1e-3])
    assert (found.findings != ()) == said
    if said:
        assert found.findings[0].startswith("cmm.csv: an offset of 20.1 mm is far more")


def test_a_missing_column_is_named():
    with pytest.raises(SurfaceError, match=r"cmm.csv, row 1: no column offset_mm found; .*station_mm,offset_mm"):
        read_profile("station_mm,who\n1,2\n2,3\n", name="cmm.csv")
    with pytest.raises(SurfaceError, match=r"no column station_mm found"):
        read_profile("offset_mm\n1\n2\n")
