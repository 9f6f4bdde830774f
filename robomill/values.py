"""What every public value has: one line that says it, a table in a notebook, equality by what it holds, read-only
arrays, copies and pickles that are as good as the first."""

from __future__ import annotations

import html
from collections.abc import Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from robomill.arrays import digest, sealed, shut
from robomill.frames import Columns, data_frame
from robomill.lazy import cached_property
from robomill.quantities import described
from robomill.units import format_count, format_significant
from robomill.wording import spelled

if TYPE_CHECKING:
    from robomill.frames import DataFrame

MOST_ROWS = 10  # of a table in a notebook


# Attributes of values that completion does not offer: what other parts of the product go by.
MACHINERY = {"carried", "carried_from", "door", "first", "hint", "kinds", "rank", "seals_itself", "unstated"}


class ReadOnly:
    """A frozen dataclass whose arrays nobody writes to."""

    seals_itself: ClassVar[bool] = True

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__()} - MACHINERY)

    def __post_init__(self) -> None:
        for each in fields(self):  # type: ignore[arg-type]
            _keep(self, each.name, getattr(self, each.name))


def _keep(one: Any, name: str, value: Any) -> None:
    """What a field holds, read-only from now on."""
    kept = shut(value) if isinstance(value, np.ndarray) else sealed(value)
    object.__setattr__(one, name, kept)


class Value(ReadOnly):
    """A frozen dataclass (``eq=False, repr=False``) that is equal to whatever holds the same.

    A class says what it is in ``_said``, and what a notebook tells of it in ``_facts``; ``carried`` are attributes
    beside the fields that a copy has, too.
    """

    carried: ClassVar[tuple[str, ...]] = ()

    def digest(self) -> str:
        """SHA-256 over every number that tells this value from another: the same on every machine."""
        return self._digest

    @cached_property
    def _digest(self) -> str:
        return digest(self)

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return self is other or self._digest == other._digest  # type: ignore[attr-defined,no-any-return]

    def __hash__(self) -> int:
        return hash(self._digest)

    def __getstate__(self) -> dict[str, Any]:
        names = (*(each.name for each in fields(self)), *self.carried)  # type: ignore[arg-type]
        return {name: getattr(self, name) for name in names}

    def __setstate__(self, state: dict[str, Any]) -> None:
        for name, value in state.items():
            _keep(self, name, value)

    def _said(self) -> str:
        """What one wants to know of it at first sight."""
        raise NotImplementedError

    def _facts(self) -> Sequence[tuple[str, str]]:
        """What a notebook's table tells: names and words."""
        return ()

    def __repr__(self) -> str:
        return short(self)

    def _repr_html_(self) -> str:
        return captioned(self, "".join(_row("th", [name], "td", [words]) for name, words in self._facts()))


class Said:
    """A small value (``repr=False``) that says in one line what it is; one that holds arrays is a ``Value``, too."""

    def _said(self) -> str:
        """What one wants to know of it at first sight."""
        return described(self)

    def __repr__(self) -> str:
        return short(self)


class Table:
    """What is a table, too."""

    def columns(self) -> Columns:
        """The table as arrays in the units that the columns' names end in."""
        raise NotImplementedError

    def _about(self) -> dict[str, str]:
        """What of the table no column says."""
        return {}

    def _rows(self) -> Any:
        """The numbers of the rows; None: from 0."""
        return None

    def to_dataframe(self) -> DataFrame:
        """The table as a pandas DataFrame.

        Returns
        -------
        pandas.DataFrame
            The columns of ``columns()``, each with its unit at the end of its name; its own copy, free to change.

        Raises
        ------
        MissingExtraError
            Where pandas is not installed: ``pip install "robomill[data]"`` brings it.
        """
        return data_frame(self.columns(), self._about(), self._rows())


class Tabled(Table, Value):
    """A value that is a table, too; a notebook shows its first rows where it has no facts."""

    def _repr_html_(self) -> str:
        return super()._repr_html_() if self._facts() else captioned(self, head_of(self.columns()))


def short(value: Any) -> str:
    """One line for a console, ASCII where the value's own names are."""
    said = value._said()
    return f"<{type(value).__name__} {spelled(said, 0, len(said), str)[0]}>"


def captioned(value: Any, rows: str) -> str:
    """A table of HTML rows with what the value says of itself above them."""
    said = html.escape(f"{type(value).__name__} {value._said()}")
    return f"<table><caption>{said}</caption>{rows}</table>"


def head_of(columns: Columns) -> str:
    """The first rows of a table as HTML."""
    count = max(map(len, columns.values()), default=0)
    some = {name: values[:MOST_ROWS].tolist() for name, values in columns.items()}
    rows = [_row("th", list(some))]
    rows += [_row("td", [_cell(value) for value in row]) for row in zip(*some.values(), strict=True)]
    if count > MOST_ROWS:
        rows.append(f'<tr><td colspan="{len(columns)}">… {format_count(count - MOST_ROWS)} more</td></tr>')
    return "".join(rows)


def _row(tag: str, cells: Sequence[str], then: str = "td", more: Sequence[str] = ()) -> str:
    made = [f"<{kind}>{html.escape(text)}</{kind}>" for kind, some in ((tag, cells), (then, more)) for text in some]
    return f"<tr>{''.join(made)}</tr>"


def _cell(value: Any) -> str:
    if isinstance(value, float):
        return "" if np.isnan(value) else format_significant(value, 5)
    return str(value)
