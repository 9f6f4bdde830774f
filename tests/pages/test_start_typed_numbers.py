"""Numbers as people type them, in every box and every cell of every table: read right, asked, or refused and said."""

from __future__ import annotations

import math

import pandas as pd
import pytest
from conftest import WAYS, Grid, errors, go, put, store
from streamlit.testing.v1 import AppTest
from test_start_odd_numbers import PAGES

from robomill.ui.entry.box import NumberBox
from robomill.ui.entry.grid import Sheet
from robomill.ui.entry.tools import TABLE

REFUSED = {
    "1,220": "1.220 to some and 1220 to others",
    "abc": "found 'abc', expected",
    "5 foo": "'foo' is no such unit",
}


def with_comma(shown: str) -> tuple[str, float]:
    """A number near the one that is shown, with a decimal comma, and what it is."""
    near = f"{(float(shown) * 1.03 if float(shown) else 0.4) + 0.01234:.5f}"
    return near.replace(".", ","), float(near)


def numbers(shown: pd.DataFrame) -> pd.DataFrame:
    """A table as it is read: a number's decimals follow those of its column and are no part of it."""

    def read(cell: object) -> object:
        try:
            return float(str(cell))
        except ValueError:
            return cell

    return shown.map(read)


# Other points say the same frame, what weighs nothing has no centre, and a cutter has only what its shape has.
SETTLED = {
    *(("toolpath.points:mm", c) for c in "XYZ"),
    *(("springs.weight.table", f"{c} mm") for c in "xyz"),
    *((TABLE, head) for head in ("Corner radius, mm", "Full tip angle, °", "Tip diameter, mm")),
}


def number_boxes(app: AppTest) -> list[str]:
    """Keys of the number boxes of a page: the lines for which a browser proposes nothing."""
    return [box.key for box in app.text_input if box.proto.autocomplete == "off" and not box.disabled]


@pytest.mark.parametrize("page", PAGES)
def test_each_number_box_asks_or_refuses_and_keeps_what_it_had(app: AppTest, page: str) -> None:
    go(app, page)
    held = store(app)
    for key in number_boxes(app):
        good, shown = held.project, app.text_input(key=key).value
        for text, words in REFUSED.items():
            app.text_input(key=key).set_value(text).run()
            assert [words in error and " stays " in error for error in errors(app)] == [True], (key, errors(app))
            assert app.text_input(key=key).value == text
            assert held.project == good
        app.text_input(key=key).set_value("").run()
        assert held.project.setup.digest() == good.setup.digest() or not shown or not errors(app), key
        if errors(app):
            assert "was emptied; it stays" in errors(app)[0]
            assert app.text_input(key=key).value == shown
        held.project, held.refused = good, {}
        app.run()


@pytest.mark.parametrize("page", PAGES)
def test_each_number_box_reads_a_decimal_comma_and_shows_what_it_read(app: AppTest, page: str) -> None:
    go(app, page)
    held = store(app)
    for key in number_boxes(app):
        good, shown = held.project, app.text_input(key=key).value or "1"
        text, value = with_comma(shown)
        app.text_input(key=key).set_value(text).run()
        assert not app.exception, key
        if errors(app):  # out of its bounds, or no whole number: said with the number that was meant
            assert any(word in errors(app)[0] for word in ("expected", "cell", "beyond", "more than", "is not")), (
                errors(app)
            )
            assert app.text_input(key=key).value == text
        else:
            assert float(app.text_input(key=key).value) == pytest.approx(value, rel=1e-9), key
        held.project, held.refused = good, {}
        app.run()


def type_into(app: AppTest, grid: Grid, cell: tuple[str, int, str], text: str | None) -> None:
    """Type into a cell of a table, and look at the page once more."""
    grid.typed = (*cell, text)
    app.run()
    assert grid.typed is None, cell
    grid.shown.clear()
    app.run()
    assert not app.exception, (cell, text, [e.message for e in app.exception])


def number_cells(grid: Grid, sheets: dict[str, Sheet]) -> list[tuple[str, int, str, NumberBox]]:
    """The first and last cell of every column of numbers, with its box."""
    return [
        (name, row, column, sheets[name].box(column, row))
        for name, frame in grid.shown.items()
        for row in sorted({0, len(frame) - 1})
        for column in sheets[name].numbers
    ]


@pytest.fixture
def sheets(monkeypatch: pytest.MonkeyPatch) -> dict[str, Sheet]:
    """The sheets of the tables that are shown, by their names."""
    import robomill.ui.entry.grid as module

    seen: dict[str, Sheet] = {}
    real = module.table

    def noted(name, base, write, sheet):
        seen[name] = sheet
        real(name, base, write, sheet)

    monkeypatch.setattr(module, "table", noted)
    return seen


@pytest.mark.parametrize("way", WAYS)
def test_each_cell_asks_or_refuses_and_shows_its_old_number(
    app: AppTest, grid: Grid, sheets: dict[str, Sheet], way: str
) -> None:
    go(app, put(app, way))
    held = store(app)
    cells = number_cells(grid, sheets)
    assert cells
    for name, row, column, box in cells:
        good, shown = held.project.setup.digest(), grid.shown[name].loc[row, column]
        for text, words in {**REFUSED, "": "was emptied", None: "was emptied"}.items():
            if not text and (box.optional or not shown):
                continue
            type_into(app, grid, (name, row, column), text)
            (error,) = errors(app)
            assert words in error, (name, row, column, error)
            assert error.startswith(sheets[name].where(row))
            assert f", {box.label}: " in error
            assert grid.shown[name].loc[row, column] == shown
            assert held.project.setup.digest() == good
        held.refused = {}


@pytest.mark.parametrize("way", WAYS)
def test_each_cell_reads_a_decimal_comma_and_keeps_every_other_number(
    app: AppTest, grid: Grid, sheets: dict[str, Sheet], way: str
) -> None:
    go(app, put(app, way))
    held = store(app)
    for name, row, column, _box in number_cells(grid, sheets):
        good, others = held.project, grid.shown[name].drop(index=row)
        text, value = with_comma(grid.shown[name].loc[row, column] or "1")
        type_into(app, grid, (name, row, column), text)
        if not errors(app):
            if name not in grid.shown:  # a material that was edited is another one
                name = f"{name}_edited"
            else:
                assert any(text in words.value for words in app.caption), (name, column)
            held.revision += 1
            app.run()
            if (name, column) not in SETTLED:
                assert float(grid.shown[name].loc[row, column]) == pytest.approx(value, rel=1e-9), (name, column)
                assert numbers(grid.shown[name].drop(index=row)).equals(numbers(others)), (name, row, column)
        held.project, held.refused, held.revision = good, {}, held.revision + 1
        app.run()


ROW_1 = [("1220,5", 1220.5), ("0,3", 0.3), ("1e-6", 1e-6), ("-1300,5", -1300.5), ("48 in", 1219.2), ("1 220,5", 1220.5)]


@pytest.mark.parametrize(("text", "value"), ROW_1)
def test_lengths_of_the_d_h_table(app: AppTest, grid: Grid, text: str, value: float) -> None:
    go(app, "1_Robot")
    before = store(app).project.setup.robot
    type_into(app, grid, ("geometry", 1, "a, mm"), text)
    after = store(app).project.setup.robot
    assert after.a[1] == pytest.approx(value * 1e-3, rel=1e-12)
    assert (after.alpha == before.alpha).all()
    assert (after.d == before.d).all()
    assert after.a[0] == before.a[0]


def test_a_unit_in_a_cell_is_converted_and_the_cell_shows_the_number_in_its_own(app: AppTest, grid: Grid) -> None:
    go(app, "1_Robot")
    type_into(app, grid, ("geometry", 1, "a, mm"), "1/16 in")
    assert grid.shown["geometry"].loc[1, "a, mm"] == "1.5875"
    assert any("Joint 2, a: 1/16 in is 1.5875 mm" in words.value for words in app.caption)
    type_into(app, grid, ("limits", 0, "lower"), "-1,5 rad")
    assert store(app).project.setup.robot.limits_all[0, 0] == pytest.approx(-1.5)
    assert grid.shown["limits"].loc[0, "lower"] == f"{math.degrees(-1.5):.6g}"
    type_into(app, grid, ("compliance", 0, "compliance"), "7,5e-7")
    assert store(app).project.setup.robot.C_theta[0] == pytest.approx(7.5e-7)
    assert float(grid.shown["compliance"].loc[0, "compliance"]) == 7.5


def test_a_number_that_is_shown_rounded_is_not_written_back_rounded(app: AppTest, grid: Grid) -> None:
    held = store(app)
    robot = held.project.setup.robot
    exact = robot.a + 1e-3 / 7
    held.project = held.project.replace(setup=held.project.setup.replace(robot=robot.replace(a=exact)))
    go(app, "1_Robot")
    type_into(app, grid, ("geometry", 0, "d, mm"), "12,5")
    assert (held.project.setup.robot.a == exact).all()
    type_into(app, grid, ("geometry", 0, "a, mm"), grid.shown["geometry"].loc[0, "a, mm"])
    assert (held.project.setup.robot.a == exact).all()


def test_a_unit_in_a_box_is_converted_and_said_beneath_it(app: AppTest) -> None:
    go(app, "5_Toolpath")
    app.text_input(key="toolpath.zero[1]:mm").set_value("-51,5 in").run()
    assert store(app).project.setup.T_MW[1, 3] == pytest.approx(-1.3081)
    assert app.text_input(key="toolpath.zero[1]:mm").value == "-1308.10"
    assert any("51,5 in is -1308.1 mm" in words.value for words in app.caption)
    app.text_input(key="toolpath.zero[1]:mm").set_value("-1300,5").run()
    assert store(app).project.setup.T_MW[1, 3] == pytest.approx(-1.3005)
    assert app.text_input(key="toolpath.zero[1]:mm").value == "-1300.50"
    assert not any("51,5 in" in words.value for words in app.caption)


def test_a_box_that_shows_less_than_it_holds_keeps_it_when_it_is_typed_again(app: AppTest) -> None:
    held = store(app)
    held.project = held.project.replace(setup=held.project.setup.replace(tolerance=1e-3 / 7))
    go(app, "6_Milling")
    box = app.text_input(key="tolerance:mm")
    assert box.value == "0.143"
    box.set_value(" 0.143").run()
    assert held.project.setup.tolerance == 1e-3 / 7


@pytest.mark.parametrize(
    ("page", "key"),
    [("5_Toolpath", "toolpath.zero[1]:mm"), ("1_Robot", "pose.box.1:deg"), ("5_Toolpath", "toolpath.go-to")],
)
def test_a_refusal_stands_beneath_the_row_of_a_narrow_box(app: AppTest, page: str, key: str) -> None:
    go(app, page)
    app.text_input(key=key).set_value("1,220").run()
    assert len(errors(app)) == 1
    narrow = [column for column in app.columns if any(box.key == key for box in column.text_input)]
    thin = [column for column in narrow if len(column.text_input) == 1]
    assert not any(len(column.error) for column in thin)
    assert thin or key == "toolpath.go-to"
