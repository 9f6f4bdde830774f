"""Tool tables from every file they come in, to the same tools; what a file does not say is marked."""

from __future__ import annotations

from pathlib import Path

import pytest
import tomli_w

from robomill.cutting.tool import Cutter
from robomill.cutting.tool_table import TableTool, ToolTable
from robomill.errors import CuttingError
from robomill.io.beside import Beside
from robomill.io.setups.tool_tables import read_tool_table, tools_from_table, tools_to_tables
from robomill.io.tables import Table, parse_toml

TBL = "; my machine\nT1 P1 D+6.0 Z+20.5 ;six\n;\nt4 p2 Z-1.5 D.5 Q2\nT99999 P3 X0 Y0 A0 B0 C0 U0 V0 W0 I+95 J+85 Z7\n"
TOML = '[[tools]]\nnumber = 1\nkind = "ball"\ndiameter_mm = 6\nflutes = 3\nhelix_angle_deg = 40\nlength_mm = 20.5\n'
CSV = "tool,kind,diameter_mm,flutes,helix_angle_deg,length_mm\n1,ball,6,3,40,20.5\n"


def test_a_tbl_says_lengths_and_diameters_and_the_rest_is_marked() -> None:
    table = read_tool_table(TBL)
    assert list(table) == [1, 4, 99999]
    assert table[1].offset == pytest.approx((0.0, 0.0, 20.5e-3))
    assert table[1].diameter == pytest.approx(6e-3)
    assert (table[1].name, table[4].orientation, table[4].length) == ("six", 2, pytest.approx(-1.5e-3))
    assert table[1].assumed == ("kind", "flutes", "helix_angle")
    assert table[99999].cutter is None
    assert table[99999].diameter == 0.0


def test_the_same_tool_from_a_csv_and_from_toml() -> None:
    expected = TableTool(1, Cutter("ball", 6e-3, flutes=3, helix_angle=0.6981317007977318), 20.5e-3)
    assert read_tool_table(TOML).tools == (expected,)
    assert read_tool_table(CSV).tools == (expected,)
    decimal_commas = "Tool;Kind;Diameter (mm);Flutes;Helix angle [deg];Length_mm\n1;Ball;6,0;3;40;20,5\n"
    assert read_tool_table(decimal_commas).tools == (expected,)


def test_inches() -> None:
    table = read_tool_table("T1 D0.25 Z2.5\n", unit="in")
    assert (table[1].diameter, table[1].length) == (pytest.approx(6.35e-3), pytest.approx(63.5e-3))
    again = read_tool_table("tool,diameter_in,length_in\n1,0.25,2.5\n")
    assert (again[1].diameter, again[1].length) == (pytest.approx(6.35e-3), pytest.approx(63.5e-3))
    assert [f.code for f in read_tool_table("T1 D0.25 Z2.5\n").findings] == ["tool-units"]
    assert not table.findings


def test_the_usual_headings_without_a_unit() -> None:
    """Diameter and length count in the unit of the table, and that is said."""
    for text in ("T,D,L\n1,6,50\n", "Tool;Diameter;Length\n1;6,0;50\n", "No\tDia\tLen\n1\t6\t50\n"):
        table = read_tool_table(text)
        assert (table[1].diameter, table[1].length) == (pytest.approx(6e-3), pytest.approx(50e-3))
        assert [f.code for f in table.findings] == ["column-unit"]
    assert "D is diameter, L is length, in mm" in read_tool_table("T,D,L\n1,6,50\n").findings[0].message
    assert read_tool_table("T,D,L\n1,0.25,2.5\n", unit="in")[1].diameter == pytest.approx(6.35e-3)
    assert read_tool_table("T,diameter_mm,D\n1,8,6\n")[1].diameter == pytest.approx(8e-3)
    with pytest.raises(CuttingError, match="diameter_mm: expected a number"):
        read_tool_table("T,diameter_mm\n1,six\n")


def test_a_diameter_of_0_is_said_and_none_is_not() -> None:
    sizes = read_tool_table("T1 D0 Z5\nT2 Z5\nT3 D-4\nT4 D4\n")
    assert [sizes[k].sized for k in (1, 2, 3, 4)] == [True, False, True, True]
    assert [sizes[k].diameter for k in (1, 2, 3, 4)] == pytest.approx([0.0, 0.0, -4e-3, 4e-3])


def test_columns_that_are_not_known_are_said() -> None:
    table = read_tool_table("tool,diameter_mm,vendor\n1,6,ACME\n2,,ACME\n")
    assert [(f.code, "vendor" in f.message) for f in table.findings] == [("column-left-out", True)]
    assert table[2].cutter is None


def test_a_set_up_keeps_every_tool(tmp_path: Path) -> None:
    table = ToolTable((*read_tool_table(TBL).tools, TableTool(7, Cutter("bull", 8e-3, 1e-3), 0.06, name="finish")))
    text = tomli_w.dumps({"tools": tools_to_tables(table)})
    top = Table(parse_toml(text, "set-up"), "set-up")
    assert tools_from_table(top) == table
    top.finish()
    (tmp_path / "mine.tbl").write_text("T1 D0.25\n")
    named = Table({"tools": "mine.tbl", "tools_unit": "in"}, "set-up")
    assert tools_from_table(named, Beside(tmp_path))[1].diameter == pytest.approx(6.35e-3)
    assert not tools_from_table(Table({}, "set-up"))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("\n", "no tools"),
        ("X1 Y2\n", "line 1: found no T"),
        ("T1 D3\nT2 D3,5\n", "line 2: found 'T2 D3,5'"),
        ("T1 D3\nT2 D3 K7\n", "line 2: found K, which no tool has"),
        ("T1 D3\nT1 D4\n", "tool 1 is there twice"),
        ("T1.5 D3\n", "line 1, number: expected a whole number"),
        ("T1 D3 Q12\n", "Orientation"),
        ("tool,diameter_mm\n1,a\n", "row 2, diameter_mm: expected a number"),
        ("tool,diameter_mm\n1,1_0\n", "row 2, diameter_mm: expected a number"),
        ("tool,diameter_mm\n1,1,2\n", "ow 2: found 3 cells"),
        ("tool,diameter_mm,length_mm\n1,1,2\n1,1,2\n", "twice"),
        ("tool,diameter_mm,flutes\n1,-1,2\n", "Diameter: found -1 mm"),
        ("[[tools]]\nnumber = 1\ndiamter_mm = 3\n", "diamter_mm: this key is not known"),
        ("[[tools]]\nnumber = 1\nkind = 'ball'\n", "diameter_mm: missing"),
        ("[[tools]]\nnumber = 1\nkind = 'chamfer'\ndiameter_mm = 6\n", "tools 1, tip_angle_deg: A chamfer mill needs"),
        ("[[tools]]\nnumber = 1\nassumed = ['colour']\n", "a cutter has no 'colour'"),
    ],
)
def test_refusals(text: str, says: str) -> None:
    with pytest.raises(CuttingError) as caught:
        read_tool_table(text)
    assert says in str(caught.value).replace("\u2212", "-")


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(CuttingError, match="cannot be opened"):
        read_tool_table(tmp_path / "none.tbl")
    with pytest.raises(CuttingError, match="unit is 'cm'"):
        read_tool_table("T1\n", unit="cm")


@pytest.mark.parametrize("column", ["tool", "diameter_mm", "flutes"])
@pytest.mark.parametrize("digits", [25, 400, 5000])
def test_a_number_of_very_many_digits_is_refused(column: str, digits: int) -> None:
    cells = {"tool": "1", "diameter_mm": "6", "flutes": "2"} | {column: "9" * digits}
    with pytest.raises(CuttingError):
        read_tool_table(",".join(cells) + "\n" + ",".join(cells.values()) + "\n")
