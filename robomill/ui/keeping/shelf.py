"""Where projects live on beyond the page: a folder of files, bounded in bytes, number and age. It knows no screen.

Each browser has a folder named by the hash of its key, so that neither a listing nor a log gives the key away. An entry
is one file: a line that says what it is, then the project as Save writes it and, behind form feeds (which TOML cannot
hold), earlier states of it. Files are written beside and renamed; a sum tells one that is damaged.
"""

import contextlib
import hashlib
import json
import os
import re
import secrets
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from robomill.errors import ProjectError
from robomill.ui.keeping.settings import Settings
from robomill.units import format_bytes

FIRST = "# robomill work "
SEPARATOR = "\n\f"
HEAD_BYTES = 2000
SWEEP_S = 3600.0
KEY, PLACE = re.compile(r"[0-9a-f]{64}"), re.compile(r"(tab|name|side)-[0-9a-f]{16}")


@dataclass(frozen=True)
class Head:
    """What an entry is: where it stands among those of its browser, its name, when it was written (s, of the clock).

    ``order`` rises with every entry of a browser, whatever the clock does; ``stamp`` is new at every writing.
    """

    place: str
    name: str
    time: float
    order: float
    stamp: str
    sum: str


class OvertakenError(ProjectError):
    """Somebody else has written the entry meanwhile; ``head`` is theirs."""

    def __init__(self, head: Head) -> None:
        super().__init__("This work went on in another tab.")
        self.head = head


class StoreError(ProjectError):
    """The store itself cannot be read or written, whoever's work it is."""


class Shelf:
    """The entries of all browsers. Every method raises ProjectError with one sentence where it cannot do its work."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self._lock = threading.RLock()
        self._bytes: float | None = None
        self._swept = float("-inf")
        self._began = time.time() - time.monotonic()

    def put(
        self, key: str, place: str, about: tuple[str, float], texts: Sequence[str], over: str | None = None
    ) -> Head:
        """Write an entry, in place of the one stamped ``over`` ("": none); None: whatever stands there.

        ``about`` is its name and when it was done (s, 0 for now). Raises OvertakenError where another one stands there.
        """
        body = SEPARATOR.join(texts).encode()
        most = min(self.settings.entry_MB, self.settings.all_MB)
        if len(body) > most * 1e6:
            raise ProjectError(f"This project has {format_bytes(len(body))}; at most {most:g} MB are kept.")
        with self._lock, _said("kept"):
            there = {head.place: head for head in self.heads(key)}
            old = there.get(place)
            if old is not None and over is not None and old.stamp != over:
                raise OvertakenError(old)
            self._make_room(key, place, there)
            order = max([time.time(), *(head.order + 1e-3 for head in there.values())])
            name, when = about
            stamp, found = secrets.token_hex(8), hashlib.sha256(body).hexdigest()
            head = Head(place, name[:80], when or time.time(), order, stamp, found)
            file = self._file(key, place)
            before = file.stat().st_size if file.exists() else 0
            data = f"{FIRST}{json.dumps(asdict(head))}\n".encode() + body
            self._write(file, data)
            self._bytes = self._total() + len(data) - before
            if self._bytes > self.settings.all_MB * 1e6 or self._now() - self._swept > SWEEP_S:
                self.sweep(file)
        return head

    def check(self) -> None:
        """Whether anything can be kept here at all. Raises StoreError where not."""
        with _said("kept"):
            check = self.settings.folder / "check"
            self._write(check, b"check" * 1000)
            check.unlink()
        with contextlib.suppress(OSError):
            self.settings.folder.rmdir()  # refused unless it is empty

    def get(self, key: str, place: str) -> tuple[Head, list[str]]:
        """An entry with its texts: the project, then its earlier states. A damaged one is set aside."""
        file = self._file(key, place)
        with _said("read"):
            with file.open("rb") as opened:
                line, body = opened.readline(HEAD_BYTES), opened.read(int(self.settings.entry_MB * 2e6))
            head = _head(line, place)
            if head is not None and head.sum == hashlib.sha256(body).hexdigest():
                return head, body.decode().split(SEPARATOR)
        self.set_aside(key, place)
        raise ProjectError("What was kept of your work is damaged and cannot be opened.")

    def set_aside(self, key: str, place: str) -> None:
        """Out of the way, so that nothing is written over it: for whoever runs the server, until it is too old."""
        file = self._file(key, place)
        with contextlib.suppress(OSError):
            file.replace(file.with_suffix(".aside"))

    def has(self, key: str, place: str) -> bool:
        """Whether an entry stands there, whole or not."""
        return bool(PLACE.fullmatch(place)) and self._file(key, place).exists()

    def heads(self, key: str, kind: str = "") -> list[Head]:
        """The entries of a browser, the last written first; ``kind`` "tab", "name" or "side" picks some of them."""
        found = []
        with contextlib.suppress(OSError):
            for file in self._folder(key).glob(f"{kind}*.toml"):
                with contextlib.suppress(OSError), file.open("rb") as opened:
                    found.append(_head(opened.readline(HEAD_BYTES), file.stem))
        return sorted((head for head in found if head), key=lambda head: -head.order)

    def drop(self, key: str, place: str) -> None:
        """Forget an entry; none is there is as well."""
        with self._lock, _said("deleted"):
            self._file(key, place).unlink(missing_ok=True)
            self._bytes = None

    def _now(self) -> float:
        """The time (s) by a clock that nobody sets while the server runs: set to another year, and back, the clock
        of the machine makes nothing old."""
        return self._began + time.monotonic()

    def sweep(self, written_now: Path | None = None) -> None:
        """Drop what is too old, then the oldest until the rest is within bounds; what was ``written_now`` stays,
        whatever the clock says of it."""
        with self._lock:
            self._swept = now = self._now()
            files = sorted(self._files(), key=lambda each: (each[0] == written_now, each[1]))
            total = sum(size for _, _, size in files)
            for file, written, size in files:
                if now - written > self.settings.days * 86400 or total > self.settings.all_MB * 1e6:
                    with contextlib.suppress(OSError):
                        file.unlink()
                        total -= size
                        file.parent.rmdir()  # refused unless it is empty
            self._bytes = float(total)

    def _make_room(self, key: str, place: str, there: Mapping[str, Head]) -> None:
        kind = place.partition("-")[0]
        others = [head for head in there.values() if head.place.startswith(kind) and head.place != place]
        if kind == "name" and len(others) >= self.settings.names:
            raise ProjectError(f"{len(others)} projects are kept, and more are not; delete one first.")
        for head in others[max(int(self.settings.tabs) - 1, 0) :] if kind != "name" else ():
            self._file(key, head.place).unlink(missing_ok=True)

    def _write(self, file: Path, data: bytes) -> None:
        self.settings.folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        file.parent.mkdir(exist_ok=True, mode=0o700)
        beside = file.with_suffix(f".{secrets.token_hex(4)}.part")
        try:
            with os.fdopen(os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as opened:
                opened.write(data)
            beside.replace(file)
        except OSError:
            beside.unlink(missing_ok=True)
            raise

    def _total(self) -> float:
        if self._bytes is None:
            self._bytes = float(sum(size for _, _, size in self._files()))
        return self._bytes

    def _files(self) -> list[tuple[Path, float, int]]:
        """Every file with the time when it was written and its bytes."""
        found = []
        for file in self.settings.folder.glob("*/*"):
            with contextlib.suppress(OSError):
                said = file.stat()
                found.append((file, said.st_mtime, said.st_size))
        return found

    def _folder(self, key: str) -> Path:
        if not KEY.fullmatch(key):
            raise ProjectError("The browser's key is not one that robomill made; delete its cookie robomill_key.")
        return self.settings.folder / hashlib.sha256(bytes.fromhex(key)).hexdigest()

    def _file(self, key: str, place: str) -> Path:
        if not PLACE.fullmatch(place):
            raise ProjectError(f"There is no work kept at {place!r:.40}.")
        return self._folder(key) / f"{place}.toml"


def place_of(name: str) -> str:
    """Where the project kept under ``name`` stands."""
    return f"name-{hashlib.sha256(name.encode()).hexdigest()[:16]}"


def side_of(fingerprint: str) -> str:
    """Where a project stands that another one is held against."""
    return f"side-{hashlib.sha256(fingerprint.encode()).hexdigest()[:16]}"


def _head(line: bytes, place: str) -> Head | None:
    """What the first line of an entry says; None where it is none, or of a robomill that says other things."""
    try:
        said = json.loads(line.decode().removeprefix(FIRST))
        head = Head(**{**said, "place": place})
        numbers = [float(head.time), float(head.order)]
        return head if all(n == n and abs(n) < 1e11 for n in numbers) and isinstance(head.name, str) else None
    except (ValueError, TypeError, AttributeError):
        return None


@contextlib.contextmanager
def _said(done: str) -> Iterator[None]:
    """A refusal of the file system as one sentence, without its path."""
    try:
        yield
    except (OSError, UnicodeError) as exc:
        if isinstance(exc, FileNotFoundError) and done != "kept":
            raise ProjectError("There is nothing kept there any more.") from None
        reason = exc.strerror if isinstance(exc, OSError) and exc.strerror else "it cannot be read"
        raise StoreError(f"Your work could not be {done} on the server: {reason.lower()}.") from None
