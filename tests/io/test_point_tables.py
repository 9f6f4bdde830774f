"""Points from CSV and Parquet: units, axes, feeds, and what is refused where."""

from __future__ import annotations

import io

import numpy as np
import pytest

import robomill as rm
from robomill.errors import ToolpathError, UnitAskedError
from robomill.io.point_tables import points_from_bytes

PLAIN = "X_mm,Y_mm,Z_mm,feed_mm_min\n0,0,1,0\n0,0,-2,300\n50,0,-2,1800\n"


def test_points_in_mm_with_their_feeds() -> None:
    path = rm.read_points(PLAIN)
    np.testing.assert_allclose(path.p, [[0, 0, 1e-3], [0, 0, -2e-3], [0.05, 0, -2e-3]])
    np.testing.assert_allclose(path.v_f, [0, 5e-3, 30e-3])
    assert path.cutting.tolist() == [False, True, True]
    np.testing.assert_array_equal(path.k, [[0, 0, 1]] * 3)


def test_inches_semicolons_and_decimal_commas() -> None:
    path = rm.read_points("x [in];y [in];z [in];feed [in/min]\n0;0;0;0\n1,5;0;0;60\n")
    np.testing.assert_allclose(path.p[1], [0.0381, 0, 0])
    assert path.v_f[1] == pytest.approx(0.0254)


def test_a_tool_axis_spindle_and_tool_number() -> None:
    text = "X_mm,Y_mm,Z_mm,i,j,k,feed_mm_min,spindle_1_min,tool\n0,0,0,0,0,1,0,6000,3\n9,0,0,0,1,1,600,6000,3\n"
    path = rm.read_points(text)
    np.testing.assert_allclose(path.k[1], [0, np.sqrt(0.5), np.sqrt(0.5)])
    assert path.n_s[1] == pytest.approx(100.0)
    assert path.tool.tolist() == [3, 3]


def test_one_feed_for_all_where_the_table_has_none() -> None:
    path = rm.read_points("X_mm,Y_mm,Z_mm\n0,0,-1\n10,0,-1\n", feed_mm_min=600)
    assert path.v_f.tolist() == [0.0, pytest.approx(0.01)]


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_what_a_path_writes_as_a_table_is_read_back(kind, tmp_path) -> None:
    path = rm.read_gcode("G21 G90 G1 X0 Y0 Z-2 F600 A10\nG1 X50 Y20\nG0 Z5\n")
    frame = path.to_dataframe()
    file = tmp_path / f"path.{kind}"
    frame.to_csv(file, index=False) if kind == "csv" else frame.to_parquet(file)
    again = rm.read_points(file)
    np.testing.assert_allclose(again.p, path.p, atol=1e-15)
    np.testing.assert_allclose(again.k, path.k, atol=1e-15)
    np.testing.assert_allclose(again.v_f, path.v_f, atol=1e-15)
    assert again.cutting.tolist() == path.cutting.tolist()


def test_headers_without_a_unit_are_asked_for_one() -> None:
    text = "X,Y,Z,F\n0,0,0,0\n1,0,0,5\n"
    with pytest.raises(UnitAskedError, match="X, Y, Z, F name no unit; the path would be 1.0 × 0.0 × 0.0 mm in mm"):
        rm.read_points(text)
    path = rm.read_points(text, unit="in")
    assert path.p[1, 0] == pytest.approx(0.0254)
    assert path.v_f[1] == pytest.approx(5 * 0.0254 / 60)
    with pytest.raises(UnitAskedError, match="F names no unit"):
        rm.read_points("X_mm,Y_mm,Z_mm,F\n0,0,0,0\n1,0,0,5\n")


def test_columns_that_are_not_known_are_named() -> None:
    path = rm.read_points(
        PLAIN.replace("feed_mm_min", "feed_mm_min,force_N")
        .replace("\n0,0,1,0", "\n0,0,1,0,1")
        .replace("300", "300,1")
        .replace("1800", "1800,1")
    )
    assert path.findings[0].sentence == "force_N: not a column of points, left out"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("X_mm,Y_mm,feed_mm_min\n0,0,0\n1,0,5\n", "there is no column of z"),
        ("X_mm,Y_mm,Z_mm\n0,0,0\n1,0,0\n", "there is no column of feeds"),
        (
            "X_mm,Y_mm,Z_mm,i,j,feed_mm_min\n0,0,0,0,1,0\n1,0,0,0,1,5\n",
            "a tool axis needs i, j and k, and k is missing",
        ),
        ("X_mm,Y_mm,Z_mm,i,j,k,feed_mm_min\n0,0,0,0,0,1,0\n1,0,0,0,0,0,5\n", "Row 3, column i: the tool axis has no"),
        ("X_mm,Y_mm,Z_mm,feed_mm_min\n0,0,0,0\n1,0,0,-5\n", "Row 3, column feed_mm_min: found a feed below 0"),
        ("X_mm,Y_mm,Z_mm,feed_mm_min\n0,0,0,0\n1,0,zero,5\n", "Row 3, column Z_mm"),
        ("X_mm,Y_mm,Z_mm,feed_mm_min\n0,0,0,0\n1,0,0,0\n", "no move has a feed, so nothing is cut"),
        ("X_mm,Y_mm,Z_mm,feed_mm_min\n0,0,0,0\n1e9,0,0,5\n", "a point lies 1e"),
        ("X_mm,Y_mm,Z_mm,feed_mm_min,tool\n0,0,0,0,1\n1,0,0,5,1.5\n", "expected the whole number of a tool"),
        ("X_furlong,Y_mm,Z_mm,feed_mm_min\n0,0,0,0\n1,0,0,5\n", "furlong"),
        ("X_mm,Y_mm,Z_mm,feed_mm_min\n0,0,0,0\n", "expected at least 2"),
    ],
)
def test_refusals_name_row_and_column(text, said) -> None:
    with pytest.raises(ToolpathError) as refused:
        rm.read_points(text)
    assert said in str(refused.value)


def test_the_refusal_of_a_cell_names_its_file_once() -> None:
    with pytest.raises(ToolpathError, match=r"^p.csv, row 3, column feed_mm_min: found a feed below 0"):
        points_from_bytes(b"X_mm,Y_mm,Z_mm,feed_mm_min\n0,0,0,0\n1,0,0,-5\n", "p.csv")


def test_a_packed_parquet_file_that_inflates_is_refused_before_it_is_read() -> None:
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    zeros = pyarrow.array(np.zeros(1_000_000))
    packed = io.BytesIO()
    parquet.write_table(pyarrow.table(dict.fromkeys(("x_mm", "y_mm", "z_mm", *"abcdefghijklmnopqr"), zeros)), packed)
    with pytest.raises(ToolpathError, match="21 columns of 1.000.000 numbers"):
        points_from_bytes(packed.getvalue(), "a.parquet")


def test_a_parquet_file_that_is_none_is_refused() -> None:
    with pytest.raises(ToolpathError, match="this is no Parquet file"):
        points_from_bytes(b"PAR1 and nothing else", "a.parquet")


@pytest.mark.parametrize("feed", [-5.0, 0.0, float("inf"), float("nan")])
def test_a_feed_of_all_moves_that_is_none_is_refused(feed: float) -> None:
    with pytest.raises(ToolpathError, match=r"p\.csv: the feed of all moves is .* expected more than 0"):
        points_from_bytes(b"X_mm,Y_mm,Z_mm\n0,0,0\n10,0,0\n", "p.csv", "", feed)
