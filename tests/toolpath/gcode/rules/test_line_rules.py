"""Which lines are plain and what they say, against Python's own numbers; and the same from compiled code."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from robomill.toolpath.gcode import codes
from robomill.toolpath.gcode.codes import G_GROUP, LETTERS, M_GROUP, WIDTH
from robomill.toolpath.gcode.flow import Calls, Structure
from robomill.toolpath.gcode.lines import Lines
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.program import Move
from robomill.toolpath.gcode.rules import flow_rules, kernels, line_rules
from robomill.toolpath.gcode.rules.records import MOVE, STATE

NAMES = [*LETTERS.upper(), *(f"G{n}" for n in range(M_GROUP - G_GROUP)), *(f"M{n}" for n in range(WIDTH - M_GROUP))]
"""Of the columns: letters, then codes by modal group."""


def scanned(line: str) -> dict[str, float] | None:
    store, data = Machine(None).store, line.encode()
    if line_rules.read_line(store.arrays, data, 0, len(data)) != 0:
        return None
    return {name: value for name, value in zip(NAMES, store.arrays.words, strict=True) if not math.isnan(value)}


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("", {}),
        (" \t\v\f\r", {}),
        ("X1", {"X": 1.0}),
        ("x-1.5y+.25 Z 1 2 . 5", {"X": -1.5, "Y": 0.25, "Z": 12.5}),
        ("N10 G1 X1.", {"G1": 10.0, "X": 1.0}),
        ("n007g03 i-.0j2K3", {"G1": 30.0, "I": -0.0, "J": 2.0, "K": 3.0}),
        ("G0", {"G1": 0.0}),
        ("G02 X0 R-5", {"G1": 20.0, "X": 0.0, "R": -5.0}),
        ("A1B2C3F4S5", {"A": 1.0, "B": 2.0, "C": 3.0, "F": 4.0, "S": 5.0}),
        ("X1 (a comment) Y2 (x) ; Y3, (", {"X": 1.0, "Y": 2.0}),
        ("F0 S0", {"F": 0.0, "S": 0.0}),
        ("X123456789.012345", {"X": 123456789.012345}),
        ("X1234567890.1234567", {"X": 1234567890.1234567}),
        ("G90 G1 G17 M8 M3", {"G3": 900.0, "G1": 10.0, "G2": 170.0, "M8": 8.0, "M7": 3.0}),
        *((f"M{code} X1", {f"M{codes.STOP}": float(code), "X": 1.0}) for code in (0, 1, 60)),
        ("M9 M49 M5", {f"M{codes.COOLANT}": 9.0, f"M{codes.OVERRIDE}": 49.0, f"M{codes.SPINDLE}": 5.0}),
        ("X[1 + 2 * 3] Y-#1 Z SIN [30]", {"X": 7.0, "Y": -0.0, "Z": math.sin(math.radians(30.0))}),
        ("(pass 3, depth 2) X1", {"X": 1.0}),
    ],
)
def test_plain_lines(line: str, words: dict[str, float]) -> None:
    assert scanned(line) == words


@pytest.mark.parametrize(
    "line",
    [
        "X",
        "X-",
        "X.",
        "X1X2",
        "X1.2.3",
        "X1-2",
        "X--1",
        "X.-1",
        "X1,5",
        "X1e3",
        "G4",
        "G1.5",
        "G-1",
        "G1G2",
        "T1",
        "M6",
        "G43",
        "G80 G0",
        "X[1",
        "X[1/0]",
        "X#5420",
        "X#<a>",
        "#<a>=1",
        "#5420=1",
        "#1=2 X1",
        "G4 P1",
        "L1.5",
        "L-1",
        "F-1",
        "S-1",
        "F-1 ; x",
        "G5 ; x",
        "N-1",
        "N",
        "NX1",
        "X1 N1",
        "N1 N2",
        "(a) N1 X1",
        "(MSG, hi)",
        "(open",
        "X1 )",
        "(a (b) c)",
        "/X1",
        "%",
        "O1",
        "X\u00e9",
        "X1" + " " * line_rules.MAX_LINE,
        *(
            "(;)" + left
            for left in ("#", "#1", "#1 X", "#1=", "#1=X", "#<a", "#<a>=1", "#5420=1", "#0=1", "#<_x>", "(b", "N")
        ),
    ],
)
def test_lines_that_are_left_to_the_reader(line: str) -> None:
    store, data = Machine(None).store, line.encode()
    assert line_rules.read_line(store.arrays, data, 0, len(data)) == line_rules.NOT_PLAIN


@pytest.mark.parametrize("level", [0, 2])
def test_a_line_sets_names_and_numbers_with_values_from_before_it(level: int) -> None:
    """Names of a subroutine, names for all, and numbers, against a dictionary; new names are left to the reader."""
    store = Machine(None).store
    for name in ("first", "a"):
        store.set(name, -1.0)  # the caller's
    for _ in range(level):
        flow_rules.enter_names(store.arrays)
    known = {"first": 3.0, "_all": 4.0, "a": 5.0}
    for name, value in known.items():
        store.set(name, value)
    data = b"#<a>=[#<a>+#<_all>] # < _ALL > = #<first>  #7=#<a> #<first>=-2 (and so on) #8=[1+1]"
    assert line_rules.read_line(store.arrays, data, 0, len(data)) == 5
    assert {name: store.get_named(name) for name in known} == known  # reading changes nothing
    line_rules.apply_settings(store.arrays, 5)
    assert {name: store.get_named(name) for name in known} == {"first": -2.0, "_all": 3.0, "a": 9.0}
    assert store.values(6, 4) == [0.0, 5.0, 2.0, 0.0]
    new = b"#<newer>=1"
    assert line_rules.read_line(store.arrays, new, 0, len(new)) == line_rules.NOT_PLAIN


def test_numbers_are_pythons_own() -> None:
    r = random.Random(4)
    for _ in range(3000):
        digits = "".join(r.choice("0123456789") for _ in range(r.randint(1, 15)))
        at = r.randint(0, len(digits))
        text = (
            r.choice(["", "+", "-"]) + digits[:at] + r.choice([".", ""] if at == len(digits) else ["."]) + digits[at:]
        )
        assert scanned("Y" + text) == {"Y": float(text)}, text


def test_compiled_code_reads_the_same() -> None:
    r = random.Random(5)
    words = ["X1", "y-2.5", "G1", "g 0", "Z[1+2*3]", "#1=3", "#2=[#1/3]", "(a)", "(a, b)", "N5", "M8", "F100", "S 1 0"]
    words += [
        "X[SIN[30]**2]",
        "A#2",
        "B[#1 GT 2]",
        "C-[2 MOD 3]",
        "X[",
        "I1",
        "G91",
        "M3",
        ";",
        ".",
        "-",
        "]",
        "#3",
        " ",
    ]
    written = ["".join(r.choices(words, k=r.randint(0, 4))) for _ in range(6000)]
    lines, plain, compiled = Lines("\n".join(written).encode()), Machine(None), Machine(None)
    none = Structure(Calls())
    state, rows, table, read = np.zeros(1, STATE), [Move()], np.zeros(1, MOVE), 0
    state[0] = tuple(getattr(compiled, name) for name in STATE.names)
    for i in range(len(lines)):
        plain.moves = state["moves"][0] = 0
        done = flow_rules.run(plain, plain.store.arrays, lines.plain_text, none.plain, (i, 1), rows)
        assert kernels.run(state, compiled.store.views(), lines.text, none.views, (i, 1), table) == done, written[i]
        if done[0]:
            assert plain.store.values(1, 30) == compiled.store.values(1, 30), written[i]
            np.testing.assert_allclose(compiled.store.arrays.words, plain.store.arrays.words, rtol=1e-15)
        read += done[0]
    assert 1000 < read < 5000
