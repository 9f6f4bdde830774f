"""Numbered and named parameters, with the ones the machine itself provides."""

from __future__ import annotations

from collections.abc import Callable

from robomill.errors import GCodeError

COUNT = 5602
"""Numbered parameters run from 1 to COUNT - 1."""

ARGUMENTS = 30
"""#1 to #30 are the arguments of a subroutine; a call saves and restores them."""

MAX_NAMED = 10_000
READ_ONLY = frozenset(range(5400, 5414)) | frozenset(range(5420, 5429))


class Parameters:
    """The store. ``provided`` answers for read-only values (``#5420``, ``#<_x>``) that follow the machine."""

    def __init__(self, provided: Callable[[str | int], float | None]) -> None:
        self.numbered = [0.0] * COUNT
        for system in range(9):
            self.numbered[5210 + 20 * (system + 1)] = 0.0
        self.numbered[5220] = 1.0
        self.shared: dict[str, float] = {}
        self.frames: list[dict[str, float]] = [{}]
        self._provided = provided

    def get(self, index: int) -> float:
        """Value of ``#index``. Raises GCodeError (without a line) if there is no such parameter."""
        if not 1 <= index < COUNT:
            raise GCodeError(f"#{index} does not exist; parameters run from 1 to {COUNT - 1}.")
        if index in READ_ONLY:
            value = self._provided(index)
            return 0.0 if value is None else value
        return self.numbered[index]

    def get_named(self, name: str) -> float | None:
        """Value of ``#<name>``, None if it is not defined. Names with ``_`` in front are shared by all frames."""
        if not name.startswith("_"):
            return self.frames[-1].get(name)
        value = self.shared.get(name)
        return self._provided(name) if value is None else value

    def set(self, key: int | str, value: float) -> None:
        """Set ``#key`` or ``#<key>``. Raises GCodeError (without a line) if it cannot be set."""
        if isinstance(key, str):
            scope = self.shared if key.startswith("_") else self.frames[-1]
            if key.startswith("_") and key not in scope and self._provided(key) is not None:
                raise GCodeError(f"#<{key}> is provided by the machine and cannot be set.")
            if len(scope) >= MAX_NAMED and key not in scope:
                raise GCodeError(f"more than {MAX_NAMED} named parameters; use fewer.")
            scope[key] = value
        elif key in READ_ONLY:
            raise GCodeError(f"#{key} is provided by the machine and cannot be set.")
        elif not 1 <= key < COUNT:
            raise GCodeError(f"#{key} does not exist; parameters run from 1 to {COUNT - 1}.")
        else:
            self.numbered[key] = value

    def expand(self, comment: str) -> str:
        """``comment`` with each ``#1`` or ``#<name>`` replaced by its value, as messages show it."""
        out, at = [], 0
        while at < len(comment):
            if comment[at] != "#":
                out.append(comment[at])
                at += 1
                continue
            at += 1
            value: float | None = None
            end = at
            if comment[at : at + 1] == "<" and ">" in comment[at:]:
                end = comment.index(">", at) + 1
                value = self.get_named("".join(comment[at + 1 : end - 1].split()).lower())
            else:
                while end < len(comment) and comment[end].isdigit():
                    end += 1
                if end > at and int(comment[at:end][:9]) < COUNT and int(comment[at:end][:9]) > 0:
                    value = self.get(int(comment[at:end]))
            if end == at:
                out.append("#")
                continue
            out.append("######" if value is None else f"{0.0 if abs(value) < 1e-6 else value:f}")
            at = end
        return "".join(out)
