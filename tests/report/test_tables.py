"""Columns as CSV that numpy reads back."""

from __future__ import annotations

import io

import numpy as np

from robomill.report.tables import csv_text


def test_csv_reads_back_with_empty_cells_for_what_is_not_known():
    columns = {"a": np.array([1.0, np.nan, 1 / 3]), "b": np.array([-2.5e-7, 4.0, 1e9])}
    text = csv_text(columns)
    assert text.splitlines()[0] == "a,b"
    assert text.splitlines()[2] == ",4"
    assert text.endswith("\n")
    again = np.genfromtxt(io.StringIO(text), delimiter=",", skip_header=1)
    np.testing.assert_allclose(again, np.column_stack(list(columns.values())), rtol=1e-8)


def test_a_flag_is_0_or_1_and_a_count_has_all_its_digits():
    columns = {"flag": np.array([True, False]), "line": np.array([1234567890123, 2]), "kind": np.array(["a", "b"])}
    assert csv_text(columns).splitlines()[1:] == ["1,1234567890123,a", "0,2,b"]
