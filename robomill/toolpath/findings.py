"""What is noticed while a program is read: kept once per kind, with the first line and a count."""

from robomill.provenance import Finding, Level

NO_UNITS = "no-units"
"""The code of what is found where a program does not say its unit,"""
UNITS_OF_FEED = "units-of-feed"
"""or says no more than that of its feeds."""


class Findings:
    """Collects findings; equal level and message are one finding with a count and its first line."""

    def __init__(self) -> None:
        self._found: dict[tuple[str, Level, str], tuple[int, int]] = {}

    def add(self, code: str, level: Level, line: int, message: str, count: int = 1) -> None:
        """Note ``message``, which is of the kind ``code``, for ``line`` (0: the whole file), ``count`` times."""
        first, before = self._found.get((code, level, message), (line, 0))
        self._found[code, level, message] = (min(first, line), before + count)

    def freeze(self) -> tuple[Finding, ...]:
        """All findings, the grave ones first, then by line."""
        found = [
            Finding(level, message, line, count=n, code=code)
            for (code, level, message), (line, n) in self._found.items()
        ]
        return tuple(sorted(found, key=lambda f: f.order))
