"""What a corrected program says of itself, and whether a path is the one that it names."""

import pytest

import robomill as rm
from robomill.errors import ToolpathError
from robomill.toolpath.corrected import Mark, key_of, mark_of, marked
from robomill.toolpath.source import meant_by

GIVEN = rm.GCodeSource("%\nO100\nG21 G90\nG1 X10 F600\nM2\n", "part (A).nc")
KEY = key_of(GIVEN.block_texts())


def of(dialect: str, *within: str) -> str:
    return "\n".join(marked(GIVEN.text.split("\n"), Mark(GIVEN.name, KEY, within), dialect))


@pytest.mark.parametrize("dialect", ["fanuc", "sinumerik", "linuxcnc", "grbl"])
def test_what_is_written_reads_back_and_stands_beneath_what_a_control_expects_first(dialect: str) -> None:
    text = of(dialect)
    assert mark_of(text) == Mark("part _A_.nc", KEY)
    assert mark_of(text.replace("\n", "\r\n").upper()) == Mark("PART _A_.NC", KEY)
    some = of(dialect, "normal", "feed")
    assert mark_of(some) == Mark("part _A_.nc", KEY, ("normal", "feed"))
    assert mark_of(some.upper()) == Mark("PART _A_.NC", KEY, ("normal", "feed"))
    assert text.split("\n")[:2] == ["%", "O100"]
    assert [line for line in text.split("\n") if "robomill" not in line] == GIVEN.text.split("\n")


def test_comments_are_those_of_the_dialect() -> None:
    assert of("fanuc").split("\n")[2].startswith("(")
    assert of("sinumerik").split("\n")[2].startswith("; ")


def test_a_program_that_only_speaks_of_it_is_none() -> None:
    assert mark_of("(corrected by hand for path.nc)\nG1 X1") is None
    assert mark_of("G1 X1\n" * 50 + of("fanuc")) is None


def test_the_key_is_that_of_the_lines_whatever_ends_them_and_of_no_others() -> None:
    assert key_of(rm.GCodeSource(GIVEN.text.replace("\n", "\r\n")).block_texts()) == KEY
    assert key_of(rm.GCodeSource(GIVEN.text.replace("X10", "X11")).block_texts()) != KEY


def test_it_is_meant_by_the_path_it_names_alone() -> None:
    corrected, other = rm.GCodeSource(of("fanuc"), "c.nc"), rm.GCodeSource("G1 X2 F60\n", "other.nc")
    found = meant_by(corrected, GIVEN)
    assert isinstance(found, rm.GCodeSource)
    assert found.wanted is GIVEN
    assert meant_by(corrected, found) == found  # the same program once more, beside what it was meant by
    assert meant_by(corrected, other) is corrected
    assert meant_by(other, GIVEN) is other


def test_what_is_wanted_is_a_path() -> None:
    path = rm.Toolpath.from_points(p_mm=[[0, 0, -2], [50, 0, -2]], feed_mm_min=600)
    assert rm.GCodeSource("G1 X1 F60\n", wanted=path).wanted.read() == path
    with pytest.raises(ToolpathError, match=r"wanted: found 'path\.nc'"):
        rm.GCodeSource("G1 X1 F60\n", wanted="path.nc")
