"""What is noticed while a program is read: kept once per kind, with the first line and a count."""

from __future__ import annotations

from robomill.provenance import Finding, Level

_ORDER = {"error": 0, "warning": 1, "suspicious": 2, "ignored": 3, "info": 4}


class Findings:
    """Collects findings; equal level and message are one finding with a count and its first line."""

    def __init__(self) -> None:
        self._found: dict[tuple[Level, str], tuple[int, int]] = {}

    def add(self, level: Level, line: int, message: str, count: int = 1) -> None:
        """Note ``message`` for ``line`` (0: the whole file)."""
        first, before = self._found.get((level, message), (line, 0))
        self._found[level, message] = (min(first, line), before + count)

    def has(self, level: Level) -> bool:
        """True if something of this level was noted."""
        return any(key[0] == level for key in self._found)

    def freeze(self) -> tuple[Finding, ...]:
        """All findings, the grave ones first, then by line."""
        found = [Finding(level, line, message, n) for (level, message), (line, n) in self._found.items()]
        return tuple(sorted(found, key=lambda f: (_ORDER[f.level], f.line, f.message)))
