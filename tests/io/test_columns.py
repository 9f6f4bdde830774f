"""Columns of CSV files: however a table is written it reads as the same numbers; what is wrong has row and column."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import robomill.io.columns as columns_module
from robomill.errors import LoadTestError, SurfaceError
from robomill.io.columns import LONGEST_NAME, MOST_COLUMNS, Layout, append_rows, read_cells, read_columns, spelled

UNITS = {
    "fx": ("N", "kN"),
    "f_feed": ("N",),
    "f_feed_normal": ("N", "kN"),
    "m": ("N m",),
    "c": ("um/N",),
    "joint": ("1",),
}
LAYOUT = Layout("Table", SurfaceError, UNITS, "Fx_N,m_Nm", fewest=2, aliases={"force": "fx"})
ONE = {"N": 1.0, "kN": 1e3, "N m": 1.0, "um/N": 1e-6, "1": 1.0}  # one unit in SI, written independently of the product
NAMES = {"fx": ("Fx", "fx", "FORCE"), "f_feed": ("F_feed",), "f_feed_normal": ("F_feed_normal",), "m": ("m", "M")}
NAMES |= {"c": ("C",), "joint": ("joint",)}
SUFFIXES = {"N": ("_N", " [N]", "(N)"), "kN": ("_kN", " [kN]"), "N m": ("_Nm", " [N m]", " (Nm)", "_[Nm]")}
SUFFIXES |= {"um/N": ("_um_N", " [um/N]", " [µm/N]", "_µm_N", " (μm/N)"), "1": ("",)}


@dataclass(frozen=True)
class Written:
    """A table, and every way it may be written."""

    header: list[tuple[str, str, str]]  # quantity, unit, name as written
    values: np.ndarray
    mark: str
    comma: bool
    quoted: bool
    end: str
    before: list[str]
    extra: bool

    def rows(self) -> list[list[str]]:
        cells = [[repr(float(v)) for v in row] for row in self.values]
        if self.comma:
            cells = [[cell.replace(".", ",") for cell in row] for row in cells]
        head = [name for _, _, name in self.header]
        if self.extra:
            head, cells = ["who", *head], [["Ana", *row] for row in cells]
        return [head, *cells]

    def text(self, rows: list[list[str]] | None = None) -> str:
        put = (lambda cell: f'"{cell}"') if self.quoted else (lambda cell: cell)
        lines = [self.mark.join(put(cell) for cell in row) for row in rows or self.rows()]
        return self.end.join([*self.before, *lines, ""])


@st.composite
def tables(draw) -> Written:
    header = []
    for quantity in draw(st.lists(st.sampled_from(sorted(UNITS)), min_size=1, unique=True)):
        unit = draw(st.sampled_from(UNITS[quantity]))
        header.append((quantity, unit, draw(st.sampled_from(NAMES[quantity])) + draw(st.sampled_from(SUFFIXES[unit]))))
    count = draw(st.integers(2, 4))
    number = st.floats(-1e9, 1e9) | st.integers(-99, 99).map(float)
    values = np.array([[draw(number) for _ in header] for _ in range(count)])
    mark = draw(st.sampled_from(",;\t"))
    return Written(
        header,
        values,
        mark,
        comma=mark != "," and len(header) > 1 and draw(st.booleans()),  # one column alone shows no separator
        quoted=draw(st.booleans()),
        end=draw(st.sampled_from(["\n", "\r\n", "\r"])),
        before=draw(st.lists(st.sampled_from(["# made by hand", "", "  ", ",,;", "\t# more"]), max_size=3)),
        extra=draw(st.booleans()),
    )


@settings(max_examples=150, deadline=None)
@given(table=tables(), encoding=st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "text", "text with mark"]))
def test_however_it_is_written_it_reads_the_same(table: Written, encoding: str) -> None:
    text = table.text()
    given = {"text": text, "text with mark": "\ufeff" + text}.get(encoding) or text.encode(encoding)
    columns, name = read_columns(given, LAYOUT, "mine.csv")
    assert name == "mine.csv"
    assert set(columns.values) == {quantity for quantity, _, _ in table.header}
    for i, (quantity, unit, written) in enumerate(table.header):
        assert quantity in columns
        assert columns.written(quantity) == written
        assert columns.known[quantity].unit == unit
        np.testing.assert_array_equal(columns.values[quantity], table.values[:, i] * ONE[unit])
    first = len(table.before) + 1
    assert columns.place.head == first
    assert columns.row.tolist() == [first + 1 + k for k in range(len(table.values))]
    assert columns.passed_over == (("who",) if table.extra else ())
    assert columns.remarks.splitlines() == [line.strip().lstrip("# ") for line in table.before if "#" in line]


@settings(max_examples=150, deadline=None)
@given(
    table=tables(),
    at=st.integers(0, 10**6),
    junk=st.sampled_from(["", " ", "half", "nan", "inf", "-inf", "1e999", "1_0", "1.2.3", "--1", "0x1G"]),
)
def test_a_bad_cell_is_named_by_file_row_and_column(table: Written, at: int, junk: str) -> None:
    rows = table.rows()
    k, i = at % len(table.values), at // 7 % len(table.header)
    rows[k + 1][i + table.extra] = junk
    others = len(rows[0]) > 1  # a row of one empty cell is an empty line
    if not junk.strip() and not others:
        return
    with pytest.raises(SurfaceError) as caught:
        read_columns(table.text(rows), LAYOUT, "mine.csv")
    place = f"row {len(table.before) + 2 + k}, column {table.header[i][2]}"
    assert str(caught.value).startswith(f"mine.csv, {place}: ")
    assert caught.value.where == place
    found = "the cell is empty, expected a number" if not junk.strip() else f"found {junk!r}, expected a "
    assert found in str(caught.value)
    assert ("finite" in str(caught.value)) == (junk in ("nan", "inf", "-inf", "1e999"))


@settings(max_examples=300, deadline=None)
@given(st.text(max_size=60) | st.binary(max_size=60) | st.text('Fx_N,m;\t"#\n1.5[]() ', max_size=80))
def test_anything_else_is_read_or_refused_in_one_sentence(given: str | bytes) -> None:
    if isinstance(given, str):
        given += "\n"
    try:
        columns, _ = read_columns(given, LAYOUT)
    except SurfaceError as refusal:
        said = str(refusal)
    else:
        said = ""
        assert all(np.isfinite(values).all() and len(values) >= 2 for values in columns.values.values())
    assert said == "" or said.endswith(".")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "Table: the file is empty; give a header (Fx_N,m_Nm) and the numbers below it."),
        ("# only a remark\n,,\n", "Table: the file is empty; give a header (Fx_N,m_Nm) and the numbers below it."),
        ("Fx_N\n", "Table: found only a header (row 1) and nothing below it; expected at least 2."),
        ("\nFx_N\n1\n", "Table: found 1 row of numbers; expected at least 2."),
        ("\n1,2\n3,4\n5,6", "Row 2: found numbers, expected a header that names columns and units (Fx_N,m_Nm)."),
        ("1,5;2\n3;4\n5;6", "Row 1: found numbers, expected a header that names columns and units (Fx_N,m_Nm)."),
        ("what,ever\n1,2\n3,4", "Row 1: no column is known among what, ever; expected a header such as Fx_N,m_Nm."),
        ("Fx\n1\n2", "Row 1, column 'Fx': the unit is missing; write one of Fx_N, Fx_kN."),
        ("\n\nFx\n1\n2", "Row 3, column 'Fx': the unit is missing; write one of Fx_N, Fx_kN."),
        ("Fx_lb\n1\n2", "Row 1, column 'Fx_lb': unit 'lb' is not known; write one of Fx_N, Fx_kN."),
        ("Fx [lb]\n1\n2", "Row 1, column 'Fx [lb]': unit 'lb' is not known; write one of Fx_N, Fx_kN."),
        ("joint_N\n1\n2", "Row 1, column 'joint_N': unit 'N' is not known; write one of joint."),
        ("Fx_N,force_kN\n1,2\n1,2", "Row 1: Fx_N and force_kN are the same quantity twice; keep one."),
        ("Fx_N;m_Nm\n1,5;2\n1.061,579;3", "Row 3, column Fx_N: found '1.061,579', expected a number;"),
        ("Fx_N;m_Nm\n1,5;2\n3;1e999,0", "Row 3, column m_Nm: found '1e999,0', expected a number;"),
        ("Fx_N,m_Nm\n1,2\n3", "Row 3, column m_Nm: found 1 cells, expected 2 as in the header."),
        ("Fx_N;m_Nm\n1;2\n3;4;5", "Row 3: found 3 cells, expected 2 as in the header."),
        (
            "Fx_N,m_Nm\n1,2\n3,5,4,5",
            "Row 3: found 4 cells, expected 2 as in the header; with decimal commas, separate the columns by semico",
        ),
        ('Fx_N,m_Nm\n1,2\n"3",4,"5"', "Row 3: found 3 cells, expected 2 as in the header; with decimal commas, "),
    ],
)
def test_refusals(text: str, sentence: str) -> None:
    with pytest.raises(SurfaceError) as caught:
        read_columns(text + "\n", LAYOUT)
    assert str(caught.value).startswith(sentence)


@pytest.mark.parametrize("mark", [";", "\t"])
def test_a_comma_that_may_part_thousands_is_asked_where_no_other_says_what_it_is(mark: str) -> None:
    asked = f"Fx_N{mark}m_Nm\n1{mark}-1,220\n3{mark}4\n"
    with pytest.raises(SurfaceError, match="row 2, column m_Nm: found '-1,220', which is -1.220 to some and -1220 to"):
        read_columns(asked, LAYOUT, "mine.csv")
    for clear in ("0,220", "1,22", "1234,500"):
        columns, _ = read_columns(asked.replace("4", clear), LAYOUT, "mine.csv")
        assert columns.values["m"].tolist() == [-1.22, float(clear.replace(",", "."))]


def test_a_table_of_words_and_numbers_asks_the_same() -> None:
    table = "who;Fx_N\nAna, the first;1,220\nBo;3\n"
    with pytest.raises(SurfaceError, match="row 2, column Fx_N: found '1,220'"):
        read_cells(table, LAYOUT, "mine.csv")
    rows = read_cells(table.replace(";3", ";3,5"), LAYOUT, "mine.csv")
    assert [cells["Fx_N"] for _, cells in rows] == ["1.220", "3.5"]
    assert rows[0][1]["who"] == "Ana, the first"


def test_the_refusal_is_of_the_layouts_kind_and_names_the_place_as_data() -> None:
    layout = Layout("Table", LoadTestError, UNITS, "Fx_N")
    columns, name = read_columns("#\nFx_N,f_feed_N\n1,2\n", layout)
    assert name == ""
    refusal = columns.refuse(0, "f_feed", "too small.")
    assert type(refusal) is LoadTestError
    assert str(refusal) == "Row 3, column f_feed_N: too small."
    assert refusal.where == "row 3, column f_feed_N"
    assert columns.place.refuse("no.").where == "row 2"
    assert "m" not in columns


def test_a_second_spelling_with_an_odd_unit_is_passed_over_aloud() -> None:
    columns, _ = read_columns("Fx_N,force_of_habit\n1,2\n3,4\n", LAYOUT)
    assert columns.passed_over == ("force_of_habit",)
    np.testing.assert_array_equal(columns.values["fx"], [1, 3])
    with pytest.raises(SurfaceError, match="unit 'of_habit' is not known"):
        read_columns("m_Nm,force_of_habit\n1,2\n3,4\n", LAYOUT)


def test_empty_cells_behind_the_last_column_do_not_count() -> None:
    columns, _ = read_columns("Fx_N,m_Nm,\n1,2\n3,4,,\n".replace("1,2", "1,2,"), LAYOUT)
    np.testing.assert_array_equal(columns.values["m"], [2, 4])
    assert columns.passed_over == ()
    columns, _ = read_columns('Fx_N,m_Nm\n1,2,,\n"3","4",""\n', LAYOUT)
    np.testing.assert_array_equal(columns.values["m"], [2, 4])


def test_a_quoted_cell_may_hold_the_separator() -> None:
    columns, _ = read_columns('who,Fx_N\n"Ana, and Bo",1\n"Cy",2\n', LAYOUT)
    np.testing.assert_array_equal(columns.values["fx"], [1, 2])


def test_units_are_found_in_either_case_but_kept_apart() -> None:
    columns, _ = read_columns("FX_n,M_NM,F_FEED_NORMAL_KN\n1,2,3\n1,2,3\n", LAYOUT)
    assert [columns.values[q][0] for q in ("fx", "m", "f_feed_normal")] == [1, 2, 3000]


def test_a_sound_table_is_read_by_the_quick_reader_alone(monkeypatch) -> None:
    monkeypatch.setattr(columns_module, "_cell", lambda *_: pytest.fail("each cell was looked at"))
    for text in ("Fx_N,m_Nm\n1,2\n3,4\n", "Fx_N;m_Nm\n1,5;2\n3;4\n", '"Fx_N","who","m_Nm"\n"1","a, b",2\n"3",,4\n'):
        columns, _ = read_columns(text, LAYOUT)
        np.testing.assert_array_equal(columns.values["m"], [2, 4])


def test_units_as_they_end_a_name() -> None:
    assert [spelled(u) for u in ("N m", "um/N", "mm", "1")] == ["Nm", "um_N", "mm", ""]


def test_a_missing_file_names_itself(tmp_path) -> None:
    with pytest.raises(SurfaceError, match=r"none.csv: cannot be opened \(No such file or directory\); expected a CSV"):
        read_columns(tmp_path / "none.csv", LAYOUT)
    deep = tmp_path / ("a" * 60) / ("b" * 60)
    with pytest.raises(SurfaceError, match=r"^….*b/none.csv: cannot be opened"):
        read_columns(deep / "none.csv", LAYOUT)
    file = tmp_path / "there.csv"
    file.write_text("Fx_N\n1\n2\n", encoding="utf-16")
    columns, name = read_columns(str(file), LAYOUT)
    assert name == "there.csv"
    assert math.isclose(columns.values["fx"].sum(), 3)


SHEETS = {
    "itself": "Fx_N,m_Nm\n5.5,-6\n7,8.25\n",
    "semicolons and decimal commas": "Fx_N;m_Nm\r\n5,5;-6\r\n7;8,25\r\n",
    "tabs, remarks, other order": "# filled in on Monday\nm [N m]\tnote\tforce_N\n-6\ta\t5,5\n\n8,25\tb\t7\n",
    "quoted": '"Fx_N","m_Nm"\n"5.5","-6"\n"7","8.25"\n',
}


@pytest.mark.parametrize("more", SHEETS.values(), ids=SHEETS)
@pytest.mark.parametrize("head", ["Fx_N,m_Nm\n1,2\n3,4", "# old\nm_Nm;by;Fx_N\n2;me;1\n4,0;me;3,0\n\n"])
def test_a_sheet_joins_a_table_that_is_written_another_way(head: str, more: str) -> None:
    joined = append_rows(head, more, LAYOUT, "sheet.csv")
    assert joined.startswith(head.rstrip("\n"))
    table, _ = read_columns(joined, LAYOUT)
    assert table.values["fx"].tolist() == [1.0, 3.0, 5.5, 7.0]
    assert table.values["m"].tolist() == [2.0, 4.0, -6.0, 8.25]


@pytest.mark.parametrize("more", ["Fx_N\n1\n2\n", "Fx_kN,m_Nm\n1,2\n3,4\n"])
def test_a_sheet_of_other_columns_or_units_joins_nothing(more: str) -> None:
    with pytest.raises(SurfaceError, match=r"^sheet.csv, row 1: found the columns .* expected Fx_N, m_Nm"):
        append_rows("Fx_N,m_Nm\n1,2\n3,4\n", more, LAYOUT, "sheet.csv")


def test_a_number_among_names_is_a_column_that_is_passed_over():
    name, unit = next((quantity, unit) for quantity, units in UNITS.items() for unit in units if unit in SUFFIXES)
    column = NAMES[name][0] + SUFFIXES[unit][0]
    columns, _ = read_columns(f"7;{column};-1,5\n1;2;3\n4;5;6\n", LAYOUT, "mine.csv")
    np.testing.assert_array_equal(columns.values[name], np.array([2.0, 5.0]) * ONE[unit])
    assert columns.passed_over == ("7", "-1,5")
    for header in ("7;8;9", "7,5;-8;1e3"):
        with pytest.raises(SurfaceError, match="found numbers, expected a header"):
            read_columns(f"{header}\n1;2;3\n4;5;6\n", LAYOUT, "mine.csv")


@pytest.mark.parametrize("count", [MOST_COLUMNS, MOST_COLUMNS + 1])
def test_as_many_columns_as_are_said(count: int) -> None:
    name, unit = next((quantity, unit) for quantity, units in UNITS.items() for unit in units if unit in SUFFIXES)
    names = [NAMES[name][0] + SUFFIXES[unit][0], *(f"c{k}" for k in range(count - 1))]
    given = "\n".join([";".join(names), *(";".join(["1"] * count) for _ in range(3))]) + "\n"
    if count <= MOST_COLUMNS:
        assert len(read_columns(given, LAYOUT, "mine.csv")[0].passed_over) == count - 1
    else:
        with pytest.raises(SurfaceError, match=f"found {count} columns, expected {MOST_COLUMNS} at most"):
            read_columns(given, LAYOUT, "mine.csv")


@pytest.mark.parametrize("length", [LONGEST_NAME, LONGEST_NAME + 1])
def test_a_name_longer_than_any_is_none(length: int) -> None:
    name, unit = next((quantity, unit) for quantity, units in UNITS.items() for unit in units if unit in SUFFIXES)
    plain = NAMES[name][0] + SUFFIXES[unit][0]
    blank = " " * (length - len(NAMES[name][0]) - len(unit) - 2)
    written = f"{NAMES[name][0]}{blank}({unit})"
    assert len(written) == length
    given = f"{written};who\n1;2\n3;4\n5;6\n"
    if length <= LONGEST_NAME:
        expected = read_columns(given.replace(written, plain), LAYOUT, "mine.csv")[0].values[name]
        np.testing.assert_array_equal(read_columns(given, LAYOUT, "mine.csv")[0].values[name], expected)
    else:
        with pytest.raises(SurfaceError, match="no column is known"):
            read_columns(given, LAYOUT, "mine.csv")


@pytest.mark.parametrize("first", ["sep=;", "SEP=;", '"sep=;"'])
def test_excels_first_line_names_the_separator_and_no_column(first: str) -> None:
    layout = Layout("a table", SurfaceError, {"x": ("mm",), "z": ("mm",)}, "x_mm, z_mm")
    found, _ = read_columns(f"{first}\nx_mm;z_mm\n1,5;2,25\n3;4\n", layout)
    np.testing.assert_allclose([found.values["x"], found.values["z"]], [[1.5e-3, 3e-3], [2.25e-3, 4e-3]])
    assert found.row.tolist() == [3, 4]
