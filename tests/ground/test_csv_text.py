"""Columns as CSV that NumPy and the standard library read back."""

from __future__ import annotations

import csv
import io

import numpy as np

from robomill.csv_text import csv_text


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


def test_words_with_commas_quotes_and_line_ends_read_back_as_they_were():
    words = ["a, b", 'a 12" bar', "two\nlines", ""]
    columns = {
        "n, of": np.arange(4),
        "word": np.array(words),
        "what": np.array([None, 1.5, np.nan, True], dtype=object),
    }
    head, *rows = csv.reader(io.StringIO(csv_text(columns, unknown="-")))
    assert head == ["n, of", "word", "what"]
    assert rows == [["0", words[0], "-"], ["1", words[1], "1.5"], ["2", words[2], "-"], ["3", words[3], "1"]]


def test_so_many_digits_as_are_asked_for():
    third = {"x": np.array([1.0, 1000.0]) / 3.0}
    assert [csv_text(third, digits).split()[1:] for digits in (3, 5)] == [["0.333", "333"], ["0.33333", "333.33"]]
