"""The most of everything that a program may ask for is read, and one more is refused."""

from __future__ import annotations

import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import interpret

CYCLE = "CYCL DEF 200 Q200=2 Q201=-5 Q206=150 Q202=10 Q210=0 Q203=0 Q204=50 Q211=0"
HEADS = {
    "linuxcnc": "G21 G90 F100\nG0 X0 Y0 Z0\n{}\nM2\n",
    "sinumerik": "G71 G90 G17 F100\nG0 X0 Y0 Z0\n{}\nM30\n",
    "heidenhain": "BEGIN PGM A MM\nTOOL CALL 1 Z S900 F300\nL X+0 Y+0 Z+9 R0 FMAX M3\n{}\nEND PGM A MM\n",
}
LIMITS = [
    ("linuxcnc", 10_000, lambda n: f"G17 G2 X0 Y0 I5 J0 P{n}"),
    ("linuxcnc", 50, lambda n: " ".join(f"#{k + 1}={k}" for k in range(n))),
    ("sinumerik", 999, lambda n: f"R{n}=5\nX=R{n}"),
    ("sinumerik", 999, lambda n: f"R[{n}]=5\nX=R[{n}]"),
    ("sinumerik", 999, lambda n: f"R10=5 R999=5\nR1={n}\nX=R[R1]"),
    ("sinumerik", 999, lambda n: f"G2 X0 Y0 I5 J0 TURN={n}"),
    ("sinumerik", 3000, lambda n: f"X=1{' ' * (n - 6)}Y=2"),
    ("heidenhain", 1999, lambda n: f"Q{n} = 5\nL X+Q{n}"),
    ("heidenhain", 499, lambda n: f"QL{n} = 5\nL X+QL{n}"),
    ("heidenhain", 499, lambda n: f"QR{n} = 5\nL X+QR{n}"),
    ("heidenhain", 10_000, lambda n: f"{CYCLE}\nPATTERN DEF ROW1 (X+1 Y+1 D+1 NUM{n})"),
]


@pytest.mark.parametrize(("dialect", "most", "body"), LIMITS)
def test_so_much_is_read_and_no_more(dialect, most, body):
    interpret(HEADS[dialect].format(body(min(most, 10))), dialect=dialect)
    interpret(HEADS[dialect].format(body(most)), dialect=dialect)
    with pytest.raises(GCodeError, match=r"^Line \d: .*(does not exist|at most|expected|more than)"):
        interpret(HEADS[dialect].format(body(most + 1)), dialect=dialect)


@pytest.mark.parametrize(
    ("line", "most", "more", "says"),
    [
        ("G0 A{}", 100_000 * 360, 90, "an axis turns more than 100 000 times"),
        ("G0 B-{}", 100_000 * 360, 90, "an axis turns more than 100 000 times"),
        ("G2 I{}", 1e12, 500, "the centre of an arc lies more than 1 000 000 km from part zero"),
        ("G3 J-{}", 1e12, 500, "the centre of an arc lies more than 1 000 000 km from part zero"),
        ("G1 X1 F{}", 60_000_000, 60, "a feed is above 60 000 000 mm/min"),
        ("G1 X1 M3 S{}", 6_000_000, 60, "a spindle turns faster than 6 000 000 1/min"),
        ("G82 Z-1 R1 P{}", 1e8, 1, "a dwell takes more than three years"),
    ],
)
def test_numbers_that_no_machine_has_are_refused_at_their_line(line: str, most: float, more: float, says: str) -> None:
    """As much is read, but for what units may round off."""
    text = f"G21 G90 G17 F100\nG0 X0 Y0 Z0\n{line}\nG0 X0\nM2\n"
    assert len(interpret(text.format(f"{most * (1.0 - 1e-9):.6f}"))) > 1
    with pytest.raises(GCodeError, match=f"^Line 3: {says}; mend the number"):
        interpret(text.format(f"{most + more:.6f}"))


@pytest.mark.parametrize(("cycle", "fits"), [("220 Q241={}", 6), ("221 Q242={} Q243=2", 3), ("221 Q242=2 Q243={}", 3)])
def test_so_many_holes_are_repeated_and_no_more(monkeypatch: pytest.MonkeyPatch, cycle: str, fits: int) -> None:
    monkeypatch.setattr("robomill.toolpath.gcode.klartext.patterns.MOST_HOLES", 6)
    where = "Q216=0 Q217=0 Q244=60 Q245=0 Q246=360 Q247=0 Q225=0 Q226=0 Q237=9 Q238=7 Q224=0 Q203=0 Q301=1"
    for count, refused in ((1, False), (fits, False), (fits + 1, True), (0, True)):
        text = HEADS["heidenhain"].format(f"{CYCLE}\nCYCL DEF {cycle.format(count)} {where}")
        if refused:
            with pytest.raises(GCodeError, match="Line 5: CYCL DEF 22. has "):
                interpret(text)
        else:
            drilled = interpret(text).end[:, 2] < -4e-3
            assert drilled.sum() == count * (6 // fits)


@pytest.mark.parametrize("word", ["X{}", "Y-{}", "Z{}"])
def test_places_reach_ten_kilometres_from_part_zero(word: str) -> None:
    text = f"G21 G90\nG0 X1\nG0 {word}\nG0 X2\nM2\n"
    assert len(interpret(text.format(1e7))) > 1
    with pytest.raises(GCodeError, match="^Line 3: a point lies 10.010 m from part zero, expected at most 10.000 m"):
        interpret(text.format(1.001e7))
