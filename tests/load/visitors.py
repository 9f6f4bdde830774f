"""Thirty people at once: real websocket clients that visit the pages and type new numbers.

Usage: ``python tests/load/visitors.py [--sessions 10 20 30] [--seconds 60] [--think 2] [--url URL] [--alone]``.

Every client speaks the browser's own protocol: it opens a page, thinks, types a number that nobody has typed before
into one of the page's boxes, and waits until the page has run; now and then it goes to another page. While it thinks it
looks again wherever the page asks for that, as a browser does: work beside a page is waited for in this way. Printed
are the seconds from an edit to the end of its run, for each page and for all of them, then the seconds until the page
stands with nothing left under way (inf where the next edit came before that), and the server's memory before and
after. Without a URL the app is started for the time it takes. ``--alone`` measures each page with one client first.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import random
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from streamlit.proto.BackMsg_pb2 import BackMsg
from streamlit.proto.ForwardMsg_pb2 import ForwardMsg
from streamlit.proto.WidgetStates_pb2 import WidgetState
from websockets.asyncio.client import connect

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "browser"))
from screenshots import served

LONGEST = 120.0  # s that a run may take before the client gives up
EDITS_A_PAGE = 4
WHOLE = "whole "  # the page stands, with nothing left under way
LOOKED = "(looks)"  # that a page asks for while work of it is under way


@dataclass
class Box:
    """A number box (a line of text) or a slider as the browser got it: its widget, and the fragment it runs in."""

    id: str
    kind: str
    value: float
    low: float
    high: float
    step: float
    whole: bool
    fragment: str

    def typed(self, rng: random.Random) -> WidgetState:
        """A value near the one that is shown, which no one has typed before."""
        near = self.value * rng.uniform(0.9, 1.1) + self.step * rng.uniform(-1.0, 1.0)
        self.value = min(max(near, self.low), self.high)
        if self.whole:
            self.value = float(round(self.value))
        state = WidgetState(id=self.id)
        if self.kind == "slider":
            state.double_array_value.data.append(self.value)
        else:
            state.string_value = f"{self.value:.10g}"
        return state


@dataclass
class Visitor:
    """One browser: the page it is on, the boxes there, what it has typed."""

    socket: Any
    rng: random.Random
    pages: dict[str, str] = field(default_factory=dict)
    page: str = ""
    boxes: dict[str, Box] = field(default_factory=dict)
    typed: dict[str, WidgetState] = field(default_factory=dict)
    broken: list[str] = field(default_factory=list)
    looks: dict[str, float] = field(default_factory=dict)
    looked: list[float] = field(default_factory=list)

    async def run(self, fragment: str = "", look: bool = False) -> float:
        """Ask for a run and wait for its end; the seconds it took. A ``look`` is one that the page has asked for."""
        message = BackMsg()
        message.rerun_script.page_script_hash = self.page
        message.rerun_script.fragment_id = fragment
        message.rerun_script.is_auto_rerun = look
        message.rerun_script.widget_states.widgets.extend(self.typed.values())
        message.rerun_script.context_info.timezone = "UTC"
        began = time.perf_counter()
        await self.socket.send(message.SerializeToString())
        await asyncio.wait_for(self._listen(), LONGEST)
        return time.perf_counter() - began

    async def visit(self, name: str) -> float:
        """Go to a page."""
        self.page, self.boxes, self.typed = self.pages.get(name, ""), {}, {}
        return await self.run()

    async def edit(self) -> float:
        """Type a new number into one of the page's boxes; NaN where the page has none."""
        if not self.boxes:
            return float("nan")
        box = self.rng.choice(list(self.boxes.values()))
        self.typed[box.id] = box.typed(self.rng)
        return await self.run(box.fragment)

    async def think(self, seconds: float) -> float:
        """Think, and look again where the page asks for it; seconds until nothing more is under way."""
        began, stood = time.perf_counter(), 0.0
        while self.looks and time.perf_counter() < began + seconds:
            fragment, every = next(iter(self.looks.items()))
            await asyncio.sleep(every)
            self.looked.append(await self.run(fragment, look=True))
            stood = time.perf_counter() - began
        left = began + seconds - time.perf_counter()
        await asyncio.sleep(max(left, 0.0))
        return float("inf") if self.looks else stood

    async def _listen(self) -> None:
        while True:
            message = ForwardMsg()
            message.ParseFromString(await self.socket.recv())
            kind = message.WhichOneof("type")
            if kind == "new_session":
                self.pages = {page.url_pathname: page.page_script_hash for page in message.new_session.app_pages}
                if not message.metadata.run.fragment_ids:
                    self.looks = {}
            elif kind == "auto_rerun":
                self.looks[message.auto_rerun.fragment_id] = message.auto_rerun.interval
            elif kind == "stop_auto_rerun":
                for gone in message.stop_auto_rerun.fragment_ids:
                    self.looks.pop(gone, None)
            elif kind == "delta" and message.delta.HasField("new_element"):
                self._see(message.delta)
            elif kind == "script_finished" and message.script_finished != ForwardMsg.FINISHED_EARLY_FOR_RERUN:
                return

    def _see(self, delta: Any) -> None:
        element = delta.new_element
        kind = element.WhichOneof("type")
        if kind == "exception":
            self.broken.append(f"{element.exception.type}: {element.exception.message}")
        line = element.text_input
        if kind == "text_input" and line.autocomplete == "off" and not line.disabled:
            shown = line.value if line.set_value else line.default
            if shown:  # a number that is left out stays so
                whole = shown.lstrip("-").isdigit()
                step = 1.0 if whole else 10.0 ** -len(shown.partition(".")[2])
                self._keep(Box(line.id, "number", float(shown), -1e9, 1e9, step, whole, delta.fragment_id))
        box = element.slider
        if kind == "slider" and box.type == box.SLIDER and not box.disabled and len(box.default) == 1:
            value = box.value[0] if box.set_value else box.default[0]
            self._keep(Box(box.id, "slider", value, box.min, box.max, box.step, False, delta.fragment_id))

    def _keep(self, box: Box) -> None:
        known = self.boxes.setdefault(box.id, box)
        known.fragment = box.fragment


async def person(url: str, number: int, until: float, think: float, times: dict[str, list[float]]) -> list[str]:
    """One person's visit, ``think`` seconds between two actions on average; what broke."""
    rng = random.Random(number)
    address = url.replace("http", "ws", 1) + "/_stcore/stream"
    async with connect(address, subprotocols=["streamlit"], max_size=None) as socket:
        visitor = Visitor(socket, rng)
        times["first"].append(await visitor.visit(""))
        await visitor.think(rng.uniform(0.5, 1.5) * think)
        while time.perf_counter() < until:
            name = rng.choice(sorted(visitor.pages))
            times[f"open {name or 'start'}"].append(await visitor.visit(name))
            await visitor.think(rng.uniform(0.5, 1.5) * think)
            for _ in range(EDITS_A_PAGE):
                answered = await visitor.edit()
                times[name or "start"].append(answered)
                stood = await visitor.think(rng.uniform(0.5, 1.5) * think)
                times[f"{WHOLE}{name or 'start'}"].append(answered + stood)
                if time.perf_counter() > until:
                    break
        times[LOOKED] += visitor.looked
        return visitor.broken


async def crowd(url: str, sessions: int, seconds: float, think: float) -> tuple[dict[str, list[float]], list[str]]:
    """``sessions`` people for ``seconds``: seconds of every run by page, and what broke."""
    times: dict[str, list[float]] = defaultdict(list)
    until = time.perf_counter() + seconds
    visits = [person(url, 1000 * sessions + k, until, think, times) for k in range(sessions)]
    broken = await asyncio.gather(*visits, return_exceptions=True)
    words = [str(b) for b in broken if isinstance(b, BaseException)]
    return times, words + [word for b in broken if isinstance(b, list) for word in b]


def table(title: str, times: dict[str, list[float]]) -> None:
    """Print the median, 95 % and longest run of each page and of all edits."""
    others = ("open ", "first", WHOLE, LOOKED)
    edits = [t for name, found in times.items() if not name.startswith(others) for t in found]
    whole = [t for name, found in times.items() if name.startswith(WHOLE) for t in found]
    print(f"\n{title}\n{'page':24s} {'runs':>5s} {'median':>8s} {'95 %':>8s} {'longest':>8s}   s")
    for name, found in [*sorted(times.items()), ("ALL EDITS", edits), ("ALL WHOLE", whole)]:
        _row(name, found)


def _row(name: str, found: Iterable[float]) -> None:
    known = np.array([t for t in found if t == t])
    if known.size:
        median, high = np.quantile(known, (0.5, 0.95), method="higher")
        print(f"{name:24s} {known.size:5d} {median:8.2f} {high:8.2f} {known.max():8.2f}")


def memory() -> float:
    """MB held by the processes of the app."""
    found = subprocess.run(["ps", "-eo", "rss,args"], capture_output=True, text=True, check=True).stdout
    return sum(int(line.split()[0]) for line in found.splitlines() if "streamlit run" in line) / 1024


def main() -> None:
    """Read the words of the command line and print the tables."""
    words = argparse.ArgumentParser(description="Visit the app with many people at once.")
    words.add_argument("--sessions", type=int, nargs="+", default=[10, 20, 30])
    words.add_argument("--seconds", type=float, default=60.0)
    words.add_argument("--think", type=float, default=2.0)
    words.add_argument("--url", default="")
    words.add_argument("--alone", action="store_true")
    given = words.parse_args()
    with contextlib.ExitStack() as stack:
        url = given.url or stack.enter_context(served())
        if given.alone:
            times, broken = asyncio.run(crowd(url, 1, given.seconds, 0.2))
            table("one person", times)
        for sessions in given.sessions:
            held = memory()
            times, broken = asyncio.run(crowd(url, sessions, given.seconds, given.think))
            table(f"{sessions} people, memory {held:.0f} -> {memory():.0f} MB, {len(broken)} broken", times)
            print(*sorted(set(broken))[:10], sep="\n")


if __name__ == "__main__":
    main()
