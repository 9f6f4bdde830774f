"""What an edited table sends, against the table one sees: cells are read one by one, what nobody touched is kept."""

from __future__ import annotations

from typing import Any

import pandas as pd
import pytest

from robomill.ui.entry.box import NumberBox
from robomill.ui.entry.grid import Edited, Sheet, empty

NUMBERS = {"a": NumberBox("a", "mm"), "teeth": NumberBox("teeth", whole=True, optional=True)}
THIRD = 1e-3 / 3  # shown with six digits


def sheet(**more: Any) -> Sheet:
    return Sheet(NUMBERS, where=lambda row: f"Joint {row + 1}", **more)


def begun(sheet: Sheet) -> Edited:
    frame = pd.DataFrame({"name": ["x", "y", "z"], "a": [1e-3, THIRD, 3e-3], "teeth": [2, None, 4]})
    return Edited.start(frame, sheet)


def edited(**rows: dict[str, Any]) -> dict[str, Any]:
    return {"edited_rows": {name.removeprefix("row"): cells for name, cells in rows.items()}}


def test_numbers_are_shown_as_text_and_what_is_missing_as_nothing() -> None:
    start = begun(sheet())
    assert start.shown["a"].tolist() == ["1", "0.333333", "3"]
    assert start.shown["teeth"].tolist() == ["2", "", "4"]


def test_what_nobody_touched_keeps_its_value_to_the_last_bit() -> None:
    found = begun(sheet()).after(edited(row0={"a": "1,5"}, row1={"name": "other"}), sheet()).now
    assert found["a"].tolist() == [1.5e-3, THIRD, 3e-3]
    assert found["name"].tolist() == ["x", "other", "z"]
    again = begun(sheet()).after(edited(row1={"a": "0.333333"}), sheet())
    assert again.now["a"][1] == THIRD
    assert (again.refused, again.understood) == ([], [])


def test_a_cell_that_cannot_be_read_keeps_the_number_it_had_and_is_named() -> None:
    first = begun(sheet()).after(edited(row0={"a": "7"}), sheet())
    second = first.after(edited(row0={"a": "1,220"}, row2={"a": "9"}), sheet())
    assert second.now["a"].tolist() == [pytest.approx(7e-3), THIRD, pytest.approx(9e-3)]
    (sentence,) = second.refused
    assert sentence.startswith("Joint 1, a: found '1,220', which is 1.220 to some and 1220 to others")
    assert sentence.endswith("It stays 7 mm.")


@pytest.mark.parametrize("text", ["", None, "  "])
def test_an_emptied_cell_keeps_its_number_unless_it_may_be_left_out(text: str | None) -> None:
    found = begun(sheet()).after(edited(row0={"a": text, "teeth": text}), sheet())
    assert found.now["a"][0] == 1e-3
    assert empty(found.now["teeth"][0])
    assert list(found.refused) == ["Joint 1, a: the cell was emptied; it stays 1 mm."]


def test_how_a_cell_was_understood_is_said_once() -> None:
    first = begun(sheet()).after(edited(row0={"a": "1,5"}), sheet())
    assert list(first.understood) == ["Joint 1, a: 1,5 is 1.5 mm."]
    assert not first.converted
    second = first.after(edited(row0={"a": "1,5"}, row1={"a": "1/16 in"}), sheet())
    assert list(second.understood) == ["Joint 2, a: 1/16 in is 1.5875 mm."]
    assert second.converted
    assert second.now["a"].tolist() == [1.5e-3, pytest.approx(1.5875e-3), 3e-3]


def test_a_cell_that_is_put_back_by_hand_is_what_it_was() -> None:
    first = begun(sheet()).after(edited(row1={"a": "5"}), sheet())
    assert first.after({"edited_rows": {}}, sheet()).now["a"][1] == THIRD


def test_rows_are_added_and_deleted() -> None:
    free = sheet(dynamic=True)
    changes = {
        "edited_rows": {0: {"a": "9"}, "2": {"teeth": "8"}},
        "deleted_rows": [1],
        "added_rows": [{"a": "7,5"}, {"name": "new", "a": "abc"}],
    }
    found = begun(free).after(changes, free)
    assert found.now["a"].tolist() == [pytest.approx(9e-3), 3e-3, pytest.approx(7.5e-3), None]
    assert found.now["teeth"].tolist()[:2] == [2, 8]
    assert list(found.understood) == ["Joint 3, a: 7,5 is 7.5 mm."]
    assert [sentence.partition(",")[0] for sentence in found.refused] == ["Joint 4"]
    assert found.refused[0].endswith("It stays empty.")


def test_a_row_whose_numbers_were_all_emptied_is_gone_where_rows_may_go() -> None:
    changes = edited(row0={"a": None, "teeth": None})
    assert begun(sheet(dynamic=True)).after(changes, sheet(dynamic=True)).now["a"][0] is None
    assert begun(sheet()).after(changes, sheet()).now["a"][0] == 1e-3


@pytest.mark.parametrize("typed", ["1e308", "", "2"])
def test_a_whole_number_may_be_emptied_or_be_larger_than_any(typed: str) -> None:
    found = begun(sheet()).after(edited(row0={"teeth": typed}), sheet()).now["teeth"]
    assert found[0] == (int(float(typed)) if typed else None)
    assert found[2] == 4


def test_a_column_may_have_a_box_a_row() -> None:
    mixed = Sheet({"a": [NumberBox("a", unit) for unit in ("mm", "deg", "in")]})  # of other units, so not alike
    start = begun(mixed)
    assert start.shown["a"].tolist() == ["1", "0.0190986", "0.11811"]
    assert start.after(edited(row2={"a": "1"}), mixed).now["a"][2] == pytest.approx(25.4e-3)


def test_the_numbers_of_a_column_have_equally_many_decimals_and_what_is_shown_is_what_is_held() -> None:
    """12.3 stood beside 7.14. One with more digits than its unit shows has them all, and takes no others along."""
    sheet = Sheet({name: NumberBox(name, "mm", optional=True) for name in "abc"})
    lengths = {"a": [7.14, 12.3, 0.0], "b": [1220.5, 1.5875, 300.0], "c": [1220.0, None, -300.0]}
    frame = pd.DataFrame({name: pd.Series(column, dtype=object) for name, column in lengths.items()}) * 1e-3
    start = Edited.start(frame, sheet)
    assert start.shown["a"].tolist() == ["7.14", "12.30", "0"]
    assert start.shown["b"].tolist() == ["1220.5", "1.5875", "300"]
    assert start.shown["c"].tolist() == ["1220", "", "-300"]
    assert start.after(edited(row1={"a": "12.30"}), sheet).now["a"].tolist() == start.began["a"].tolist()
    rows = {"a": pd.Series([7.14e-3, 12.3e-3], dtype=object)}
    shown = {
        units: Edited.start(pd.DataFrame(rows), Sheet({"a": [NumberBox("a", unit) for unit in units]})).shown["a"]
        for units in (("mm", "mm"), ("mm", "in"))
    }
    assert shown["mm", "mm"].tolist() == ["7.14", "12.30"]
    assert shown["mm", "in"].tolist() == ["7.14", "0.484252"]
