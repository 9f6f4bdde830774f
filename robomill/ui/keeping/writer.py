"""Writes projects to the shelf beside the page: in one thread, the newest of each tab, large ones seldom."""

import atexit
import logging
import secrets
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass
from weakref import WeakKeyDictionary

from robomill.errors import ProjectError
from robomill.ui.keeping.shelf import Head, OvertakenError, Shelf, StoreError
from robomill.ui.project import Project, project_to_toml

EARLIER, EARLIER_BYTES = 20, 200_000  # states before the last one that are kept with it
REST = 10.0  # a tab's next writing waits this many times as long as its last one took,
LONGEST_REST_S = 10.0  # but not longer


@dataclass(eq=False)
class Line:
    """Where the work of one tab is kept: the browser's key, its place there and what was last seen of it.

    ``place`` is "" until the tab has said which one it is; ``trouble`` why the last writing was refused;
    ``overtaken`` what another tab wrote over this one's work, which then goes on at a place of its own, ``moved``;
    ``opened`` what a session began with, and ``shown`` its project.
    """

    key: str = ""
    place: str = ""
    stamp: str = ""
    saved: float = 0.0
    trouble: str = ""
    overtaken: Head | None = None
    moved: tuple[str, str] | None = None
    opened: Head | None = None
    shown: Project | None = None
    rests_until: float = 0.0


@dataclass(frozen=True, eq=False)
class Work:
    """A project with the states before it: those of this session, and before these those kept of an earlier one.

    ``of`` is when it was done (s), 0 for now.
    """

    project: Project
    past: Sequence[Project] = ()
    older: Sequence[str] = ()
    of: float = 0.0


class Writer:
    """Takes work in no time and writes it soon."""

    def __init__(self, shelf: Shelf) -> None:
        self.shelf = shelf
        self.trouble = ""  # why nothing could be kept when it was last tried, whoever's it was
        self._waiting: dict[Line, Work] = {}
        self._busy: Line | None = None
        self._changed = threading.Condition()
        self._texts: WeakKeyDictionary[Project, str] = WeakKeyDictionary()
        try:
            shelf.check()
        except StoreError as exc:
            self._refused(exc)
        threading.Thread(target=self._run, daemon=True, name="robomill-writer").start()
        atexit.register(self.flush, 3.0)

    def hand(self, line: Line, work: Work) -> None:
        """Have ``work`` written at ``line``, in place of what waits there."""
        if line.key and line.place:
            with self._changed:
                self._waiting[line] = work
                self._changed.notify_all()

    def settle(self, line: Line, timeout_s: float) -> None:
        """Wait until the work of ``line`` is written, unless it rests."""
        with self._changed:
            self._changed.wait_for(
                lambda: self._busy is not line and (line not in self._waiting or line.rests_until > time.monotonic()),
                timeout_s,
            )

    def flush(self, timeout_s: float) -> bool:
        """Write all that waits, at once; False where that takes longer."""
        with self._changed:
            for line in self._waiting:
                line.rests_until = 0.0
            self._changed.notify_all()
            return self._changed.wait_for(lambda: not self._waiting and self._busy is None, timeout_s)

    def _run(self) -> None:
        while True:
            with self._changed:
                self._busy = None
                self._changed.notify_all()
                line = self._next()
                work, self._busy = self._waiting.pop(line), line
            began = time.monotonic()
            try:
                self._write(line, work)
            except Exception:  # a bug: the owner's log has it, and the next work is kept all the same
                logging.getLogger(__name__).exception("Work could not be kept")
                line.trouble = "Your work could not be kept on the server."
            took = time.monotonic() - began
            line.rests_until = time.monotonic() + min(REST * took, LONGEST_REST_S)

    def _next(self) -> Line:
        """The line that may be written, once there is one."""
        while True:
            first = min(self._waiting, key=lambda line: line.rests_until, default=None)
            rest = None if first is None else first.rests_until - time.monotonic()
            if first is not None and rest is not None and rest <= 0.0:
                return first
            self._changed.wait(rest)

    def _write(self, line: Line, work: Work) -> None:
        texts = self._told(work)
        try:
            head = self.shelf.put(line.key, line.place, (work.project.setup.name, work.of), texts, over=line.stamp)
        except OvertakenError as exc:
            old, line.place, line.overtaken = line.place, f"tab-{secrets.token_hex(8)}", exc.head
            line.moved, line.stamp = (old, line.place), ""
            self._write(line, work)
            return
        except ProjectError as exc:
            line.trouble = str(exc)
            if isinstance(exc, StoreError):
                self._refused(exc)
            return
        line.stamp, line.saved, line.trouble, self.trouble = head.stamp, head.time, "", ""

    def _refused(self, exc: StoreError) -> None:
        """Said to the owner once; to those whose work it is as long as it lasts."""
        if self.trouble != str(exc):
            logging.getLogger(__name__).warning("Work is not kept in %s: %s", self.shelf.settings.folder, exc)
        self.trouble = str(exc)

    def _told(self, work: Work) -> list[str]:
        """The project as Save writes it, then the last small states before it, the newest first."""
        text = self._texts[work.project] = project_to_toml(work.project)
        earlier: list[str] = []
        for known in (*map(self._text, reversed(work.past)), *reversed(work.older)):
            if not known or len(earlier) == EARLIER or sum(map(len, earlier)) + len(known) > EARLIER_BYTES:
                break
            earlier.append(known)
        if len(text) > EARLIER_BYTES:
            self._texts[work.project] = ""
        return [text, *earlier]

    def _text(self, project: Project) -> str:
        """A project's file, written once; "" of a large one, which is no state to go back to."""
        if project not in self._texts:
            text = project_to_toml(project)
            self._texts[project] = text if len(text) <= EARLIER_BYTES else ""
        return self._texts[project]
