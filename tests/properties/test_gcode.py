"""Properties of G-code reading: plain stretches read as arrays, modes that persist, numbers in every spelling."""

from __future__ import annotations

import dataclasses
from contextlib import ExitStack
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from robomill.errors import GCodeError
from robomill.io.gcode_out import toolpath_to_gcode
from robomill.toolpath.gcode import interpret, read_gcode

coordinate = st.decimals(-500, 500, places=4).map(lambda d: f"{d:f}")
spelling = st.sampled_from(["{}", "+{}", " {}", "{} "])


@st.composite
def plain_line(draw: st.DrawFn) -> str:
    words = [draw(st.sampled_from(["", "", "G0", "G1", "g01", "N7 G1", "G2", "G3", "N12"]))]
    for letter in draw(st.permutations("XYZ")):
        if draw(st.booleans()):
            value = draw(coordinate)
            words.append(letter + (draw(spelling).format(value) if not value.startswith("-") else value))
    if draw(st.integers(0, 3)) == 0:
        words += [f"I{draw(coordinate)}", f"J{draw(coordinate)}"] if draw(st.booleans()) else ["R400"]
    if draw(st.integers(0, 5)) == 0:
        words.append(f"F{draw(st.integers(0, 900))}")
    return draw(st.sampled_from([" ", ""])).join(words) + draw(st.sampled_from(["", "", "", "(c)", ";x", "\r"]))


special = st.sampled_from(
    [
        "G90",
        "G91",
        "G20",
        "G21",
        "G17",
        "G18",
        "M3 S100",
        "M5",
        "#1=2",
        "G0 X#1",
        "G92 X1",
        "G55",
        "G81 Z-1 R1",
        "G80",
        "(MSG, hi)",
        "/X1",
        "G1 X1 X2",
        "A5",
        "G64",
        "G41.1 D2",
        "G40",
        "G90.1",
        "G91.1",
        "",
        "T1 M6",
        "%",
    ]
)
program = st.lists(st.one_of(plain_line(), plain_line(), plain_line(), special), min_size=1, max_size=30)


STRETCHES = "robomill.toolpath.gcode.stretches."
READERS = {
    "reader": {"Stretches.run": lambda stretches, lines, structure, at, executed, most: (0, at, False)},
    "plain": {"LONG": 10**9, "LOADED_LONG": 10**9, "CHUNK": 5},
    "compiled": {"LONG": 0, "LOADED_LONG": 0},
}


def outcome(text: str, how: str) -> list:
    with ExitStack() as stack:
        for name, value in READERS[how].items():
            stack.enter_context(patch(STRETCHES + name, value))
        try:
            result = interpret(text.encode())
        except GCodeError as exc:
            return [str(exc)]
    return [getattr(result, f.name) for f in dataclasses.fields(result)]


@settings(max_examples=150, deadline=None)
@given(program)
def test_plain_stretches_are_what_line_by_line_makes_of_them(lines: list[str]) -> None:
    text = "G21 F100\n" + "\n".join(lines) + "\n"
    for _ in range(len(lines)):  # leave out the lines that are refused, to get far
        try:
            interpret(text.encode())
            break
        except GCodeError as exc:
            kept = text.split("\n")
            if not 0 < exc.line <= len(kept):
                break
            del kept[exc.line - 1]
            text = "\n".join(kept)
    one_by_one = outcome(text, "reader")
    for how, tolerance in (("plain", 0.0), ("compiled", 1e-14)):
        for a, b in zip(outcome(text, how), one_by_one, strict=True):
            assert np.allclose(a, b, rtol=tolerance, atol=tolerance) if isinstance(a, np.ndarray) else a == b


def test_a_bad_line_far_down_is_refused_on_its_line() -> None:
    text = "G21 F100\n" + "G1 X1\nX2 Y3\n" * 5000 + "G2 X5 Y5 I1\n" + "X1\n" * 5000
    with pytest.raises(GCodeError) as caught:
        interpret(text)
    assert caught.value.line == 10002


@settings(max_examples=60, deadline=None)
@given(st.decimals(-9999, 9999, places=5), st.sampled_from(["x", "X ", " X  ", "x\t"]), st.booleans())
def test_spelling_does_not_matter(value: object, letter: str, in_brackets: bool) -> None:
    text = f"{value:f}"
    shown = f"[{text}]" if in_brackets else text
    assert interpret(f"G21 g0 {letter}{shown}\n").end[0, 0] == float(text) * 1e-3


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(coordinate, coordinate), min_size=1, max_size=12))
def test_incremental_is_absolute_with_sums(points: list[tuple[str, str]]) -> None:
    absolute, incremental, x, y = ["G90"], ["G91"], 0.0, 0.0
    for a, b in points:
        x, y = x + float(a), y + float(b)
        absolute.append(f"G0 X{x:.9f} Y{y:.9f}")
        incremental.append(f"G0 X{a} Y{b}")
    ends = [interpret("\n".join(["G21", *lines])).end for lines in (absolute, incremental)]
    assert np.abs(ends[0] - ends[1]).max() < 1e-11


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.sampled_from(["G90", "G91", "G20", "G21", "G17", "G18", "G94", "F60", "S9", "M3", "M8"]), max_size=8)
)
def test_kept_modes_come_back(changes: list[str]) -> None:
    head = "G21 G90 G17 F120 S50\n"
    with_changes = head + "M70\n" + "\n".join(changes) + "\nM72\nG0 X1\nG0 X2\nG1 X3\nG2 X5 I1\n"
    without = head + "G0 X1\nG0 X2\nG1 X3\nG2 X5 I1\n"
    a, b = interpret(with_changes), interpret(without)
    assert np.allclose(a.end, b.end, atol=1e-12)
    assert np.allclose(a.v_f, b.v_f)


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(coordinate, coordinate, coordinate, st.booleans()), min_size=1, max_size=20))
def test_writing_and_reading_is_the_identity(points: list[tuple[str, str, str, bool]]) -> None:
    lines = [f"G{int(cut)} X{x} Y{y} Z{z}" for x, y, z, cut in points]
    path = read_gcode("G21 F250\n" + "\n".join(lines))
    again = read_gcode(toolpath_to_gcode(path))
    assert np.array_equal(again.cutting, path.cutting)
    assert np.abs(again.p - path.p).max() < 1e-12
