"""Measured force files: what is read, and one sentence with row and column for what is not."""

import numpy as np
import pytest

from robomill.errors import CuttingError
from robomill.io.measured.forces import GAP, read_forces

ROWS = [f"{0.001 * i:.3f},{-60 + i},{100 + i},{-20}" for i in range(12)]
HEAD = "t_s,F_feed_N,F_feed_normal_N,F_axial_N"


def text(rows=ROWS, head=HEAD):
    return "\n".join([head, *rows]) + "\n"


def test_reads_a_file_its_text_and_its_bytes(tmp_path):
    path = tmp_path / "cut.csv"
    path.write_text(text(), encoding="utf-8")
    for given in (path, str(path), text(), text().encode(), b"\xef\xbb\xbf" + text().encode()):
        record = read_forces(given)
        assert (record.axis, record.frame, record.F.shape, record.notes) == ("time", "path", (12, 3), ())
        np.testing.assert_allclose(record.x, 0.001 * np.arange(12))
        np.testing.assert_allclose(record.F[3], [-57, 103, -20])
    assert read_forces(path).source == "cut.csv"


def test_the_force_on_the_part_is_turned_round():
    np.testing.assert_array_equal(read_forces(text(), on="part").F, -read_forces(text()).F)


def test_path_length_in_mm_and_robot_axes_with_decimal_commas():
    rows = [f"{0.5 * i};{100 + i},5".replace(".", ",") for i in range(6)]
    record = read_forces(text(rows, "s_mm;F_y_N"))
    assert (record.axis, record.frame) == ("path", "M")
    np.testing.assert_allclose(record.x, 0.5e-3 * np.arange(6))
    np.testing.assert_allclose(record.F[2], [0, 102.5, 0])
    assert [note.split(": ")[1] for note in record.notes] == [
        "no x force was recorded; it is taken as 0.",
        "no z force was recorded; it is taken as 0.",
    ]


def test_comments_blank_lines_and_columns_that_are_not_used():
    rows = ["# dynamometer", *[f"{row},ok {i}" for i, row in enumerate(ROWS)], ""]
    record = read_forces(text(rows, HEAD + ",remark"))
    assert record.notes == ("Force file: the column 'remark' is not used.",)
    np.testing.assert_allclose(record.F[0], [-60, 100, -20])


def changed(i, row):
    return text([*ROWS[:i], row, *ROWS[i + 1 :]])


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        (changed(4, "0.004,-56,abc,-20"), "row 6, column F_feed_normal_N: found 'abc', expected a number"),
        (changed(4, "0.004,nan,104,-20"), "row 6, column F_feed_N: found 'nan', expected a finite number"),
        (changed(4, "0.004,1e999,104,-20"), "row 6, column F_feed_N: found '1e999', expected a finite number"),
        (changed(4, "0.004,1e308,104,-20"), "row 6, column F_feed_N: found '1e308', expected no more than 1e+12"),
        (changed(4, "0.004,-56,,-20"), "row 6, column F_feed_normal_N: the cell is empty"),
        (changed(4, "0.004,-56"), "row 6, column F_feed_normal_N: found 2 cells, expected 4"),
        (changed(4, "0.003,-56,104,-20"), "row 6, column t_s: 0.003 repeats the value before it (0.003)"),
        (changed(4, "0.001,-56,104,-20"), "row 6, column t_s: 0.001 is smaller than the value before it (0.003)"),
        (text(ROWS[:6] + [r.replace("0.0", "0.1") for r in ROWS[6:]]), "row 8, column t_s: a gap from 0.005 to 0.106"),
        (text(["0.0,1,2,3"] * 2), "found 2 rows of numbers; expected at least 4"),
        ("\n", "the file is empty; give a header (t_s,F_feed_N"),
        (b"\x89PNG\r\n\x1a\n\0\0", "not a text file"),
        (b"a\0b\n", "not a text file"),
        (
            text(head="time,F_feed_N,F_feed_normal_N,F_axial_N"),
            "row 1, column 'time': the unit is missing; write one of time_s",
        ),
        (text(head="t_s,s_mm,F_feed_normal_N,F_axial_N"), "expected one column of t_s"),
        (text(head="t_s,Fx,Fy,Fz"), "expected columns of either F_feed_N"),
        (text(head="t_s,F_x_N,F_feed_normal_N,F_axial_N"), "expected columns of either F_feed_N"),
        (text(head="t_s,F_feed_N,F_feed_N,F_axial_N"), "row 1: F_feed_N and F_feed_N are the same quantity twice"),
        (
            text([f"{0.001 * i},{110432 + i}" for i in range(9)], "t_s,F_feed_normal_N"),
            "column F_feed_normal_N: the mean size of all rows is 1.104e+05 N, expected 1 to 20000 N; is it in mN?",
        ),
        (text([f"{0.001 * i},{0.11}" for i in range(9)], "t_s,F_feed_normal_N"), "the mean size of all rows is 0.11 N"),
        (text([f"{0.001 * i},0" for i in range(9)], "t_s,F_feed_normal_N"), "the mean size of all rows is 0 N"),
    ],
)
def test_refusals_name_row_and_column(given, sentence):
    with pytest.raises(CuttingError) as refusal:
        read_forces(given, source="cut.csv")
    assert sentence in str(refusal.value)
    assert str(refusal.value).startswith("cut.csv")
    assert "\n" not in str(refusal.value)


def test_sizes_can_be_vouched_for():
    rows = [f"{0.001 * i},0.11" for i in range(9)]
    assert read_forces(text(rows, "t_s,F_feed_normal_N"), trust_units=True).F[0, 1] == 0.11


def test_missing_file(tmp_path):
    with pytest.raises(
        CuttingError, match=r"none.csv: cannot be opened \(No such file or directory\); expected a CSV table"
    ):
        read_forces(tmp_path / "none.csv")


@pytest.mark.parametrize(("unit", "one"), [("N", 1.0), ("kN", 1e3)])
def test_either_unit_of_force_and_of_the_axis(unit, one):
    rows = [f"{i},{2 + i}" for i in range(5)]
    record = read_forces(text(rows, f"time_min,F_axial_{unit}"))
    np.testing.assert_allclose(record.x, 60.0 * np.arange(5))
    np.testing.assert_allclose(record.F, np.outer(2 + np.arange(5), [0, 0, one]))


def test_each_column_goes_to_its_axis():
    for frame, names in (("path", ("feed", "feed_normal", "axial")), ("M", ("x", "y", "z"))):
        for i, name in enumerate(names):
            record = read_forces(text([f"{k},{5 + k}" for k in range(4)], f"s_m,F_{name}_N"))
            assert (record.frame, record.axis) == (frame, "path")
            np.testing.assert_array_equal(record.F, np.outer(5 + np.arange(4), np.eye(3)[i]))
            absent = [other.replace("_", "-") for other in names if other != name]
            assert [note.split(": ")[1] for note in record.notes] == [
                f"no {word} force was recorded; it is taken as 0." for word in absent
            ]


@pytest.mark.parametrize(("last", "fine"), [(8.0, True), (8.1, False)])
def test_a_step_over_five_times_the_usual_one_is_a_gap(last, fine):
    given = text([f"{t},100" for t in (0, 1, 2, 3, last)], "t_s,F_x_N")
    if fine:
        assert len(read_forces(given).x) == 5
    else:
        with pytest.raises(CuttingError, match="Row 6, column t_s: a gap from 3 to 8.1 where rows are usually 1"):
            read_forces(given)


@pytest.mark.parametrize(("size", "unit"), [(0.99, "kN"), (1.0, ""), (20_000.0, ""), (20_001.0, "mN")])
def test_mean_sizes_that_milling_has(size, unit):
    given = text([f"{t},{(-1) ** t * size},0.01" for t in range(6)], "t_s,F_x_N,F_y_N")
    if not unit:
        assert read_forces(given).F[0, 0] == size
    else:
        with pytest.raises(CuttingError, match=f"column F_x_N: the mean size .*is it in {unit}"):
            read_forces(given)


@pytest.mark.parametrize("names", [HEAD, "t_s,F_x_N,F_y_N,F_z_N"])
@pytest.mark.parametrize("turns_with", ["robot", "part"])
def test_axes_are_the_robots_unless_the_sensor_sits_on_the_part(names, turns_with):
    """Along the feed a force turns with the path, whoever carries the sensor."""
    record = read_forces(text(head=names), turns_with=turns_with)
    fixed = "W" if turns_with == "part" else "M"
    assert record.frame == ("path" if names == HEAD else fixed)
    np.testing.assert_allclose(record.F[3], [-57, 103, -20])


@pytest.mark.parametrize(("size", "kept"), [(0.99, False), (1.0, True), (20_000.0, True), (20_001.0, False)])
def test_mean_sizes_that_milling_has_are_kept(size, kept):
    given = text([f"{0.001 * i:.3f},{size if i % 2 else -size}" for i in range(6)], "t_s,F_axial_N")
    if kept:
        assert np.abs(read_forces(given).F).max() == size
    else:
        with pytest.raises(CuttingError, match="mean size of all rows"):
            read_forces(given)
    assert np.abs(read_forces(given, trust_units=True).F).max() == size


def test_a_gap_is_one_that_is_longer_than_rows_usually_are_apart():
    """Rows a millisecond apart; a hole counts from a number of steps on that the module states."""
    for steps, whole in ((GAP - 0.01, True), (GAP + 0.01, False)):
        times = [0.0, 0.001, 0.002, 0.003, 0.003 + 0.001 * steps, 0.004 + 0.001 * steps]
        given = text([f"{t:.6f},100" for t in times], "t_s,F_axial_N")
        if whole:
            assert len(read_forces(given).x) == 6
        else:
            with pytest.raises(CuttingError, match="a gap") as refused:
                read_forces(given)
            assert refused.value.where == "row 6, column t_s"
