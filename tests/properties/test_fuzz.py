"""Mutated programs: nothing but GCodeError, no hang, bounded memory. The long run is marked slow."""

from __future__ import annotations

import contextlib
import random
import time
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.apt import read_apt
from robomill.toolpath.gcode import Tool, interpret
from robomill.toolpath.gcode.chords import to_toolpath
from robomill.toolpath.gcode.support import SUPPORT
from robomill.toolpath.text import is_apt

DATA = Path(__file__).resolve().parents[1] / "toolpath" / "gcode" / "data"
TOOLS = {n: Tool(n, 3e-3, (0.0, 0.0, 1e-3)) for n in range(1, 20)}
ALPHABET = "GXYZABCIJKRFSPQLDHMTNO#<>[]()%;/=+-.,*^@$ 0123456789\n\t\r\0subifwhilecallendrepeat\u00e9\u2028"
NASTY = [
    "#1=1e9",
    "L1000000000",
    "O9 while [1]",
    "O9 endwhile",
    "O1 call",
    "X1e308",
    "X" + "9" * 320,
    "[" * 200,
    "G10 L2 P1 R45",
    "O9 repeat [999999999]",
    "O9 endrepeat",
    "G83 Z-1e9 R1 Q0.0000001",
    "G2 I1 P99999999",
    "#[#[#1]]=[1/0]",
    "%",
    "M2",
    "G41.1 D5",
    "G40",
    "G91",
    "G20",
    "(",
    ")",
    "\ufeff",
    "G76 P1 Z-5 I-1 J0.0000001 K1",
    "G5.2 X1 Y1 P1",
    "M98 P1 L999999",
]


def seeds() -> list[str]:
    files = [*(DATA / "programs").glob("*.ngc"), *(DATA / "refused").glob("*.ngc")]
    return [f.read_text() for f in sorted(files)] + [row.example + "\n" for row in SUPPORT]


def mutate(text: str, r: random.Random) -> str:
    for _ in range(r.randint(1, 6)):
        at = r.randrange(len(text) + 1)
        kind = r.random()
        if kind < 0.3:
            text = text[:at] + r.choice(ALPHABET) + text[at:]
        elif kind < 0.5:
            text = text[:at] + text[at + r.randint(1, 12) :]
        elif kind < 0.7:
            text = text[:at] + "\n" + r.choice(NASTY) + "\n" + text[at:]
        elif kind < 0.85:
            other = r.randrange(len(text) + 1)
            text = text[:at] + text[other : other + r.randint(1, 60)] + text[at:]
        else:
            text = text.replace(r.choice("0123456789XYZG"), r.choice(ALPHABET), r.randint(1, 3))
    return text[:20_000]


def run(count: int, seed: int) -> tuple[int, float]:
    r = random.Random(seed)
    programs, accepted, slowest = seeds(), 0, 0.0
    for _ in range(count):
        text = mutate(r.choice(programs), r)
        began = time.process_time()
        try:
            data = text.encode("utf-8", "surrogatepass")
            if r.random() < 0.05:
                data = text.encode("utf-16", "surrogatepass")
            program = interpret(data, dialect=r.choice(["auto", "auto", "fanuc", "sinumerik", "grbl"]), tools=TOOLS)
            accepted += 1
            if len(program) and r.random() < 0.3:
                to_toolpath(program, 1e-3)
        except GCodeError:
            pass
        slowest = max(slowest, time.process_time() - began)
    return accepted, slowest


@pytest.fixture
def small_budgets(monkeypatch: pytest.MonkeyPatch) -> None:
    base = "robomill.toolpath."
    import_module(base + "gcode.rules.kernels")
    interpret("G0 X1\n" * 400)  # compiled before a clock runs
    for name, value in (
        ("gcode.interpreter.MAX_STEPS", 3000),
        ("gcode.program.MAX_MOVES", 20_000),
        ("gcode.program.FLUSH", 512),
        ("arcs.MAX_POINTS", 200_000),
        ("gcode.rules.cycle_rules.MAX_PECKS", 500),
        ("gcode.threads.MAX_PASSES", 300),
    ):
        monkeypatch.setattr(base + name, value)


@pytest.mark.usefixtures("small_budgets")
def test_mutated_programs_are_read_or_refused() -> None:
    accepted, slowest = run(1200, seed=1)
    assert accepted > 20
    assert slowest < 5.0


@pytest.mark.slow
@pytest.mark.usefixtures("small_budgets")
def test_a_hundred_thousand_mutated_programs() -> None:
    began = time.process_time()
    accepted, slowest = run(100_000, seed=2)
    print(f"{accepted} of 100000 accepted, slowest {slowest:.2f} s, {time.process_time() - began:.0f} s in all")
    assert slowest < 10.0


@pytest.mark.parametrize(
    "text",
    [
        "G21 F9\nG81 Z-1 R1 L99999\n" * 100,
        "G21 F9\nO1 repeat [1000000000]\nG91 G1 X1\nO1 endrepeat\n",
        "O1 sub\nO2 call\nO1 endsub\nO2 sub\nO1 call\nO2 endsub\nO1 call\n",
        "G21\nG0 X" + "9" * 309 + "\n",
        "G21\nM98 P1 L99999999\nM2\nO1\nG4 P1\nM99\n",
        "G21\n" + "#1=[#1+1]" * 2000 + "\n",
        "G0 X[[[[[[" * 3000,
        "O1 while [1]\n" * 3000,
        "\n" * 300_000 + "G0 X1\n",
        " " * 90_000 + "\n" + "G0 X1 (" * 3000,
        "O1 " * 30_000,
        "IF [" * 50_000,
        "(" * 90_000,
        "X=" * 40_000,
        "G71 " * 20_000,
        "\t \n" * 90_000 + "o",
        "%" * 90_000,
        "G21\nG0 X1" + " " * 99_000 + "Y1\nM99\n",
    ],
)
@pytest.mark.usefixtures("small_budgets")
def test_bombs_are_refused_or_read_in_time(text: str) -> None:
    began = time.process_time()
    with contextlib.suppress(GCodeError):
        interpret(text)
    assert time.process_time() - began < 5.0


def test_telling_apt_files_takes_no_time() -> None:
    began = time.process_time()
    assert not is_apt(b"\n" * 300_000 + b" " * 300_000)
    assert time.process_time() - began < 2.0


def test_mutated_apt_files() -> None:
    r = random.Random(3)
    base = (
        "PARTNO/X\nUNITS/MM\nFROM/0,0,5,0,0,1\nFEDRAT/60,MMPM\nSPINDL/900,CLW\nGOTO/1,2,3,0,0.1,1\nRAPID\nGOTO/4,5,6\n"
    )
    read = 0
    for _ in range(400):
        with contextlib.suppress(GCodeError):
            path = read_apt(mutate(base, r).encode("utf-8", "surrogatepass"))
            assert np.isfinite(path.p).all()
            np.testing.assert_allclose(np.linalg.norm(path.k, axis=1), 1.0, atol=1e-12)
            read += 1
    assert 10 < read < 390, "both happen: read, and refused"
