"""Which lines are plain and what they say, against Python's own numbers; and the same from compiled code."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from robomill.toolpath.gcode import line_rules
from robomill.toolpath.gcode.motion_rules import LETTERS


def scanned(line: str) -> dict[str, float] | None:
    words = [math.nan] * len(LETTERS)
    data = line.encode()
    plain = line_rules.scan_line(data, 0, len(data), words)
    return {letter.upper(): value for letter, value in zip(LETTERS, words) if not math.isnan(value)} if plain else None


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("", {}),
        (" \t\v\f\r", {}),
        ("X1", {"X": 1.0}),
        ("x-1.5y+.25 Z 1 2 . 5", {"X": -1.5, "Y": 0.25, "Z": 12.5}),
        ("N10 G1 X1.", {"G": 10.0, "X": 1.0}),
        ("n007g03 i-.0j2K3", {"G": 30.0, "I": -0.0, "J": 2.0, "K": 3.0}),
        ("G0", {"G": 0.0}),
        ("G02 X0 R-5", {"G": 20.0, "X": 0.0, "R": -5.0}),
        ("A1B2C3F4S5", {"A": 1.0, "B": 2.0, "C": 3.0, "F": 4.0, "S": 5.0}),
        ("X1 (a comment) Y2 (x) ; Y3, (", {"X": 1.0, "Y": 2.0}),
        ("F0 S0", {"F": 0.0, "S": 0.0}),
        ("X123456789.012345", {"X": 123456789.012345}),
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
        "X[1]",
        "X#1",
        "G4",
        "G1.5",
        "G-1",
        "G1G2",
        "M3",
        "T1",
        "P1",
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
        "X1234567890123456",
        "X\u00e9",
        "X1" + " " * line_rules.MAX_LINE,
    ],
)
def test_lines_that_are_left_to_the_reader(line: str) -> None:
    assert scanned(line) is None


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
    from robomill.toolpath.gcode import kernels

    r = random.Random(5)
    lines = ["".join(r.choice("XYGN(F;) -.0123456789,") for _ in range(r.randint(0, 14))) for _ in range(4000)]
    data = "\n".join(lines).encode()
    starts = np.cumsum([0] + [len(line) + 1 for line in lines])
    tables = []
    for scan, text in ((line_rules.scan, data), (kernels.scan, np.frombuffer(data, np.uint8))):
        words, plain = np.full((len(lines), len(LETTERS)), math.nan), np.zeros(len(lines), bool)
        scan(text, starts, words, plain)
        tables.append((plain, np.where(plain[:, None], words, 0.0)))
    assert 500 < tables[0][0].sum() < 3900
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(*tables))
