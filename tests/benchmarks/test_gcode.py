"""Lines of G-code per second, with peers in the same run. Run with ``-m benchmark -s``.

Peers do less or more: gcodeparser splits words and knows no modes; LinuxCNC's ``rs274`` (C++) interprets and prints.
"""

from __future__ import annotations

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


def test_rs274(program: Path, tmp_path: Path) -> None:
    rs274 = shutil.which("rs274")
    if rs274 is None:
        pytest.skip("rs274 is not installed (Debian: linuxcnc-uspace)")
    (tmp_path / "v.var").touch()
    (tmp_path / "t.tbl").write_text("T1 P1 D3 Z0\n")
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    options = ["-t", str(tmp_path / "t.tbl"), "-v", str(tmp_path / "v.var"), "-g"]
    subprocess.run(
        [rs274, *options, str(program), str(tmp_path / "out")], check=False, capture_output=True, timeout=120
    )
    theirs = LINES / (resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before)
    ours = lines_per_second(program, LINES)
    print(f"\nrobomill {ours:,.0f} lines/s, LinuxCNC rs274 {theirs:,.0f} lines/s: {ours / theirs:.1f} times")
    assert ours > 1.5 * theirs


def test_lines_that_are_reckoned() -> None:
    """Expressions and parameters on every line: the reader of words, one line after the other."""
    text = "G21 G90 F100\n#1=2 #2=0.5\n" + "G1 X[#1*3.5] Y[#2+1]\nG1 X0 Y#1\n" * 10_000 + "M2\n"
    began = time.process_time()
    program = interpret(text)
    rate = 20_000 / (time.process_time() - began)
    print(f"\nrobomill, expressions on every line: {rate:,.0f} lines/s")
    np.testing.assert_allclose(program.end[:, :2], np.tile([[7e-3, 1.5e-3], [0.0, 2e-3]], (10_000, 1)), atol=1e-15)
    assert rate > 5_000  # 10 000 on a machine with seven others at work
