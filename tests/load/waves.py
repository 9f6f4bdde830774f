"""Does a server keep what its visitors leave behind? Sessions come and go in waves, and its memory is read after each.

Usage: ``python tests/load/waves.py [--waves 6] [--sessions 50] [--edits 4] [--think 0.2] [--stay 0]``.

Each visitor of a wave opens pages, types numbers that nobody has typed before, and goes. ``--stay`` waits so many
seconds after a wave before it is read (Streamlit keeps a closed session for two minutes, in case its browser comes
back). Printed for each wave: resident and proportional memory (MB) of the server as it stands, and after a full
collection with what the allocator holds given back; then how many sessions, projects, set-ups and results live, and
how many of them were only waiting to be collected.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections import defaultdict
from pathlib import Path

from visitors import Visitor
from websockets.asyncio.client import connect

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "browser"))
from server import Server

AT_ONCE = 5
PROBE = Path(__file__).with_name("probe")


async def visit(url: str, number: int, edits: int, think: float) -> tuple[int, list[str]]:
    """One visitor's runs, and what broke."""
    rng = random.Random(number)
    address = url.replace("http", "ws", 1) + "/_stcore/stream"
    runs = 0
    async with connect(address, subprotocols=["streamlit"], max_size=None) as socket:
        visitor = Visitor(socket, rng)
        await visitor.visit("")
        await visitor.visit("")  # only the second run of a session names the pages
        for name in rng.sample(sorted(visitor.pages), min(3, len(visitor.pages))):
            await visitor.visit(name)
            for _ in range(edits):
                await visitor.edit()
                await visitor.think(think)
                runs += 1
        return runs + 4, visitor.broken


async def wave(url: str, first: int, sessions: int, edits: int, think: float) -> tuple[int, list[str]]:
    """``sessions`` visitors, some at once."""
    places = asyncio.Semaphore(AT_ONCE)

    async def come(number: int) -> tuple[int, list[str]]:
        async with places:
            return await visit(url, number, edits, think)

    came = await asyncio.gather(*(come(first + k) for k in range(sessions)))
    return sum(runs for runs, _ in came), [word for _, broken in came for word in broken]


def server_process(parent: int) -> int:
    """The process that serves: Streamlit's, where it was started by ours."""
    listed = subprocess.run(["ps", "-eo", "pid,ppid,args"], capture_output=True, text=True, check=True).stdout
    rows = [line.split(None, 2) for line in listed.splitlines()[1:]]
    return next((int(pid) for pid, above, said in rows if int(above) == parent and "streamlit run" in said), parent)


def memory(process: int) -> tuple[float, float]:
    """Resident and proportional memory, MB."""
    found: dict[str, float] = defaultdict(float)
    for line in Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()[1:]:
        name, said = line.split(None, 1)
        found[name] += float(said.split()[0]) / 1024
    return found["Rss:"], found["Pss:"]


def counted(process: int, url: str, told: Path) -> dict[str, list[int]]:
    """What the server holds, before and after a full collection.

    A server that nobody visits sleeps in its event loop, where Python does not see the signal: it is woken by requests.
    """
    told.unlink(missing_ok=True)
    os.kill(process, signal.SIGUSR1)
    for _ in range(600):
        with contextlib.suppress(OSError):
            urllib.request.urlopen(f"{url}/_stcore/health", timeout=1).close()
        if told.exists():
            return dict(json.loads(told.read_text()))
        time.sleep(0.1)
    raise TimeoutError("the server does not say what it holds")


def main() -> None:
    """Read the words of the command line and print the table."""
    words = argparse.ArgumentParser(description="Memory of a server whose visitors come and go.")
    words.add_argument("--waves", type=int, default=6)
    words.add_argument("--sessions", type=int, default=50)
    words.add_argument("--edits", type=int, default=4)
    words.add_argument("--think", type=float, default=0.2)
    words.add_argument("--stay", type=float, default=0.0)
    given = words.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        told = Path(folder) / "counts.json"
        os.environ |= {"ROBOMILL_COUNTS": str(told), "PYTHONPATH": str(PROBE)}
        server = Server(Path(folder) / "kept")  # a shelf that is empty again is taken away
        server.start()
        try:
            assert server.process is not None
            process = server_process(server.process.pid)
            print(f"{'wave':>4s} {'runs':>6s} {'rss':>6s} {'pss':>6s} {'then':>6s}   held (of which garbage)")
            runs = 0
            for number in range(given.waves):
                more, broken = asyncio.run(wave(server.url, 1000 * number, given.sessions, given.edits, given.think))
                runs += more
                time.sleep(given.stay)
                rss, pss = memory(process)
                held = counted(process, server.url, told)
                said = " ".join(f"{name} {after} ({before - after})" for name, (before, after) in held.items())
                print(f"{number + 1:4d} {runs:6d} {rss:6.0f} {pss:6.0f} {memory(process)[0]:6.0f}   {said}", flush=True)
                print(*sorted(set(broken))[:5], sep="\n", end="")
        finally:
            server.stop()


if __name__ == "__main__":
    main()
