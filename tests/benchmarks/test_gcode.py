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


def test_a_million_lines(program: Path) -> None:
    code = (
        "import sys,time,resource\nfrom pathlib import Path\nt=time.perf_counter(),time.process_time()\n"
        "from robomill.toolpath.gcode import interpret\np=interpret(Path(sys.argv[1]))\n"
        "memory=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss/1024\n"
        "print(time.process_time()-t[1], time.perf_counter()-t[0], memory, len(p))"
    )
    command = [sys.executable, "-c", code, str(program)]
    runs = [subprocess.run(command, capture_output=True, text=True, check=True).stdout for _ in range(3)]
    seconds, wall, memory, moves = min(tuple(map(float, run.split())) for run in runs)
    print(
        f"\nrobomill: {LINES / seconds:,.0f} lines per second of CPU ({seconds:.2f} s with imports; {wall:.2f} s by the"
    )
    print(f"clock), {memory:.0f} MiB, {moves:.0f} moves")
    assert seconds < 8.0
    assert memory < 1024


def test_line_by_line(program: Path) -> None:
    text = "\n".join(program.read_text().splitlines()[:50_000]) + "\nM2\n"
    began = time.process_time()
    interpret(text, fast=False)
    print(f"\nrobomill, line by line: {50_000 / (time.process_time() - began):,.0f} lines/s")


def test_peer_gcodeparser(program: Path) -> None:
    gcodeparser = pytest.importorskip("gcodeparser")
    text = "\n".join(program.read_text().splitlines()[:200_000])
    began = time.process_time()
    gcodeparser.GcodeParser(text).lines  # noqa: B018
    print(f"\ngcodeparser (words only): {200_000 / (time.process_time() - began):,.0f} lines/s")


def test_peer_rs274(program: Path, tmp_path: Path) -> None:
    rs274 = shutil.which("rs274")
    if rs274 is None:
        pytest.skip("rs274 is not installed (Debian: linuxcnc-uspace)")
    (tmp_path / "v.var").touch()
    (tmp_path / "t.tbl").write_text("T1 P1 D3 Z0\n")
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    command = [
        rs274,
        "-t",
        str(tmp_path / "t.tbl"),
        "-v",
        str(tmp_path / "v.var"),
        "-g",
        str(program),
        str(tmp_path / "out"),
    ]
    subprocess.run(command, check=False, capture_output=True, timeout=120)
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    print(f"\nLinuxCNC rs274: {LINES / seconds:,.0f} lines/s (user time {seconds:.2f} s)")
