"""Lines of G-code per second, with peers in the same run. Run with ``-m benchmark -s``.

Peers do less or more: gcodeparser splits words and knows no modes; LinuxCNC's ``rs274`` (C++) interprets and prints.
"""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from robomill.toolpath.gcode import interpret

pytestmark = pytest.mark.benchmark
LINES = 1_000_000


def milling_program(lines: int, seed: int = 1) -> str:
    """Finishing passes as a CAM system writes them: short G1, arcs, some N and F words, few rapids and comments."""
    r = np.random.default_rng(seed)
    kind, step = r.random(lines), np.round(r.normal(0, 2, (lines, 2)), 3)
    out = ["%", "G21 G90 G17 G94", "T1 M6", "S12000 M3", "G0 X0 Y0 Z5", "G1 Z-1 F600"]
    x = y = 0.0
    for i in range(lines - len(out) - 3):
        x, y = round(0.99 * x + step[i, 0], 3), round(0.99 * y + step[i, 1], 3)
        if kind[i] < 0.3:
            out.append(f"N{i} G1 X{x} Y{y} Z{-1 - kind[i]:.4f}")
        elif kind[i] < 0.8:
            out.append(f"G1 X{x} Y{y}")
        elif kind[i] < 0.9:
            radius = round(1 + kind[i], 3)
            out.append(f"G1 X{x} Y{y}" if i % 2 else f"G{2 if kind[i] < 0.85 else 3} I{radius} J0")
        elif kind[i] < 0.98:
            out.append(f"G1 X{x} Y{y} F{int(300 + kind[i] * 100)}")
        else:
            out.append("G0 Z5" if i % 5 else f"(section {i})")
    return "\n".join([*out, "M5", "M30", "%"]) + "\n"


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("bench") / "million.nc"
    file.write_text(milling_program(LINES))
    return file


SCRIPT = """
import resource, sys, time
from pathlib import Path
began = time.process_time()
from robomill.toolpath.gcode import interpret
program = interpret(Path(sys.argv[1]))
first = time.process_time() - began
memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
began = time.process_time()
interpret(Path(sys.argv[1]))
print(first, time.process_time() - began, memory, len(program))
"""


def test_a_million_lines(program: Path) -> None:
    """CPU seconds in a process of its own, imports and loading of compiled rules included."""
    runs = [
        subprocess.run([sys.executable, "-c", SCRIPT, str(program)], capture_output=True, text=True, check=True).stdout
        for _ in range(3)
    ]
    first, again, memory, moves = min(tuple(map(float, run.split())) for run in runs)
    print(f"\nrobomill: a million lines in {first:.2f} s, again in {again:.2f} s ({LINES / again:,.0f} lines/s)")
    print(f"{memory:.0f} MiB, {moves:.0f} moves")
    assert first < 2.5
    assert memory < 400


def lines_per_second(program: Path, lines: int) -> float:
    """Of the first ``lines`` lines, in this process, the rules loaded."""
    text = "\n".join(program.read_text().splitlines()[:lines]) + "\nM2\n"
    interpret(text)
    began = time.process_time()
    interpret(text)
    return lines / (time.process_time() - began)


def test_gcodeparser_only_splits_words_and_is_slower(program: Path) -> None:
    gcodeparser = pytest.importorskip("gcodeparser")
    text = "\n".join(program.read_text().splitlines()[:200_000])
    began = time.process_time()
    gcodeparser.GcodeParser(text).lines  # noqa: B018
    theirs = 200_000 / (time.process_time() - began)
    ours = lines_per_second(program, 200_000)
    print(f"\nrobomill {ours:,.0f} lines/s, gcodeparser (words only) {theirs:,.0f} lines/s: {ours / theirs:.1f} times")
    assert ours > 5 * theirs


def found_rs274() -> str:
    """LinuxCNC's interpreter: where ROBOMILL_RS274 says, or on the path."""
    found = os.environ.get("ROBOMILL_RS274") or shutil.which("rs274")
    if found is None:
        pytest.skip("rs274 is not installed (Debian: linuxcnc-uspace); ROBOMILL_RS274 says where it is")
    return found


def mixes() -> dict[str, list[str]]:
    """Programs of 20 000 lines as posts write them, and as people do who program by hand."""
    r = np.random.default_rng(3)
    points = np.round(np.cumsum(r.normal(0, 1, (20_000, 2)), axis=0), 3).tolist()
    moves = [f"G1 X{x} Y{y} Z-{i % 9}.5" for i, (x, y) in enumerate(points)]
    cam = ["G90", "M8", "F500", "S9000 M3", "G17", "G0 Z5", "(pass 3, depth 2)", "M9", "G94 F300", "G91", "G90"]
    change = ["G0 Z50", "M9", "M5", "T2 M6", "S8000 M3", "G43 H2 Z50", "M8"]
    return {
        "moves": moves,
        "N numbers and feeds": [f"N{i} {move} F{500 + i % 7}" for i, move in enumerate(moves)],
        "arcs": [f"G{2 + i % 2} I{1 + i % 5} J0" if i % 3 else move for i, move in enumerate(moves)],
        "words of a post on every third line": [cam[i // 3 % 11] if i % 3 == 0 else m for i, m in enumerate(moves)],
        "a tool change every 500 lines": [
            line for i, move in enumerate(moves) for line in ([*change, move] if i % 500 == 0 else [move])
        ],
        "expressions": [f"G1 X[#1*{x}+2] Y[SIN[{y}]*20]" for x, y in points],
        "names": ["#<scale>=2", "G1 X0", *(f"Y[#<scale>*{x}]Z[#<scale>*-{abs(y)}]" for x, y in points)],
        "holes": [f"X{x} Y{y}" if i % 50 else f"G81 X{x} Y{y} Z-5 R2" for i, (x, y) in enumerate(points)],
        "loop": ["O1 while [#1 LT 5000]", "G1 X[#1*0.1] Y[SIN[#1]]", "#1=[#1+1]", "O1 endwhile"],
        "subroutine": ["O2 sub", "G1 X#1", "Y#2", "O2 endsub", "O1 repeat [5000]", "O2 call [1] [2]", "O1 endrepeat"],
    }


NOT_MET = {"loop", "subroutine"}
"""O words are executed line by line."""


def test_rs274(tmp_path: Path) -> None:
    """CPU seconds from the file to the moves, the start of either program left out."""
    command = [found_rs274(), "-t", str(tmp_path / "t.tbl"), "-v", str(tmp_path / "v.var"), "-g"]
    (tmp_path / "t.tbl").write_text("T1 P1 D3 Z0\nT2 P2 D3 Z1\n")

    def theirs(file: Path) -> float:
        runs = []
        for _ in range(3):
            (tmp_path / "v.var").write_text("")
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run([*command, str(file), str(tmp_path / "out")], check=False, capture_output=True, timeout=120)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            runs.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
        return min(runs)

    def ours(file: Path) -> float:
        runs = []
        for _ in range(3):
            began = time.process_time()
            interpret(file)
            runs.append(time.process_time() - began)
        return min(runs)

    files = {name: tmp_path / f"{name}.ngc" for name in mixes()}
    for name, lines in mixes().items():
        files[name].write_text("\n".join(["G21 G90 F600 S9000 M3", *lines, "M2"]) + "\n")
    folder = os.environ.get("ROBOMILL_GCODE_ORACLE")
    files |= {
        f.name: f for f in sorted(Path(folder or tmp_path).rglob("*.ngc")) if folder and f.stat().st_size > 20_000
    }
    (tmp_path / "start.ngc").write_text("G0 X1\nM2\n")
    start, slow = theirs(tmp_path / "start.ngc"), []
    print(f"\nrs274 starts in {start * 1e3:.0f} ms")
    for name, file in files.items():
        us, them = ours(file), theirs(file) - start
        print(f"{name:36s} robomill {us * 1e3:7.1f} ms, rs274 {them * 1e3:7.1f} ms: {them / us:.2f} times")
        slow += [name] if name in mixes() and name not in NOT_MET and them < 1.5 * us else []
    assert not slow


def test_lines_that_are_reckoned() -> None:
    """Expressions and parameters on every line: the reader of words, one line after the other."""
    text = "G21 G90 F100\n#1=2 #2=0.5\n" + "G1 X[#1*3.5] Y[#2+1]\nG1 X0 Y#1\n" * 10_000 + "M2\n"
    began = time.process_time()
    program = interpret(text)
    rate = 20_000 / (time.process_time() - began)
    print(f"\nrobomill, expressions on every line: {rate:,.0f} lines/s")
    np.testing.assert_allclose(program.end[:, :2], np.tile([[7e-3, 1.5e-3], [0.0, 2e-3]], (10_000, 1)), atol=1e-15)
    assert rate > 5_000  # 10 000 on a machine with seven others at work
