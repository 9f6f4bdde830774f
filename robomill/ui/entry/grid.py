"""The table that is edited. Its numbers are lines of text, read cell by cell as in every box; its frames are in SI.

A browser's own number cells swallow decimal commas and exponents without a word. What nobody has touched keeps its
value to the last bit, however it is shown. A cell that cannot be read gets its old number back, and the sentence
beneath quotes what was typed.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import pandas as pd
import streamlit as st

from robomill.errors import ProjectError
from robomill.ui import session
from robomill.ui.entry.box import NumberBox
from robomill.ui.entry.typed import accept, note, refuse, sentence, submit

MOST_SAID = 3


def empty(cell: Any) -> bool:
    """Whether a cell of an edited table holds nothing."""
    return cell is None or cell is pd.NA or cell == "" or (isinstance(cell, float) and cell != cell)


@dataclass(frozen=True)
class Sheet:
    """How a table is edited: its columns of ``numbers``, each with one box or one a row, and Streamlit's own others.

    ``heads`` are other headings than the columns' names, ``width`` is that of the columns of numbers in pixels, and
    ``where`` names a row, counted from 0, in a refusal. Columns may be ``locked``, rows be added. A table in which one
    cell says what another one does is ``linked``: it starts afresh after every edit.
    """

    numbers: Mapping[str, NumberBox | Sequence[NumberBox]] = field(default_factory=dict)
    columns: Mapping[str, Any] = field(default_factory=dict)
    heads: Mapping[str, str] = field(default_factory=dict)
    width: int | Mapping[str, int] | None = None
    where: Callable[[int], str] = lambda row: f"Row {row + 1}"
    locked: tuple[str, ...] = ()
    linked: bool = False
    dynamic: bool = False
    height: int | Literal["auto"] = "auto"

    def box(self, column: str, row: int) -> NumberBox:
        """The box of a cell."""
        boxes = self.numbers[column]
        return boxes if isinstance(boxes, NumberBox) else boxes[row]

    def plain(self, frame: pd.DataFrame) -> pd.DataFrame:
        """``frame`` with None where a number is missing."""
        return self._each(frame, lambda column, row, cell: None if empty(cell) else cell)

    def shown(self, frame: pd.DataFrame) -> pd.DataFrame:
        """A plain ``frame`` with its numbers as lines of text; those of a column of one quantity have equally many
        decimals, where none has more than its unit."""
        texts = self._each(frame, lambda column, row, cell: self.box(column, row).written(cell, cell=True))
        alike = [name for name, boxes in self.numbers.items() if isinstance(boxes, NumberBox) or _of_one_unit(boxes)]
        most = {name: max(map(_decimals, texts[name]), default=0) for name in alike}

        def level(column: str, row: int, cell: Any) -> str:
            box = self.box(column, row)
            exact = not cell or box.whole  # a zero stays a plain one
            if exact or column not in most or most[column] > box.decimals:
                return str(texts.loc[row, column])
            return box.written(cell, True, most[column])

        return self._each(frame, level)

    def configured(self) -> dict[str, Any]:
        """The columns as Streamlit is told of them."""
        wide = self.width if isinstance(self.width, Mapping) else dict.fromkeys(self.numbers, self.width)
        numbers = {
            name: st.column_config.TextColumn(self.heads.get(name, name), width=wide.get(name), alignment="right")
            for name in self.numbers
        }
        return numbers | dict(self.columns)

    def _each(self, frame: pd.DataFrame, make: Callable[[str, int, Any], Any]) -> pd.DataFrame:
        made = {name: [make(name, row, cell) for row, cell in enumerate(frame[name])] for name in self.numbers}
        return frame.assign(**{name: pd.Series(cells, frame.index, dtype=object) for name, cells in made.items()})


@dataclass(frozen=True)
class Edited:
    """A table being edited: as it ``began``, how that was ``shown``, and as it is ``now`` with what was ``typed``.

    ``refused`` and ``understood`` are sentences on the cells typed last; ``converted``: one is not the number typed.
    """

    began: pd.DataFrame
    shown: pd.DataFrame
    now: pd.DataFrame
    typed: Mapping[tuple[int, str], str] = field(default_factory=dict)
    refused: Sequence[str] = ()
    understood: Sequence[str] = ()
    converted: bool = False

    @classmethod
    def start(cls, frame: pd.DataFrame, sheet: Sheet) -> "Edited":
        """A table in which nothing was typed yet."""
        plain = sheet.plain(frame.reset_index(drop=True))
        return cls(plain, sheet.shown(plain), plain)

    def after(self, changes: Mapping[str, Any], sheet: Sheet) -> "Edited":
        """The table with what ``st.data_editor`` says was changed by now: edited, added and deleted rows."""
        reading = _Reading(self, sheet, self.began.copy())
        deleted = [int(row) for row in changes.get("deleted_rows", [])]
        edited = {int(row): cells for row, cells in changes.get("edited_rows", {}).items()}
        added = {len(self.began) + i: cells for i, cells in enumerate(changes.get("added_rows", []))}
        for row in added:
            reading.frame.loc[row] = None
        standing = [row for row in reading.frame.index if row not in deleted]
        for row, cells in {**edited, **added}.items():
            reading.row(row, cells, sheet.where(standing.index(row)) if row in standing else "")
        return replace(
            self,
            now=reading.frame.drop(index=deleted),
            typed=reading.typed,
            refused=reading.refused,
            understood=reading.understood,
            converted=reading.converted,
        )

    def known(self, row: int, name: str) -> Any:
        """What a cell holds by now; None where that is nothing."""
        cell = self.now.loc[row, name] if row in self.now.index else None
        return None if empty(cell) else cell

    def text(self, row: int, name: str) -> str:
        """What was shown for a cell at first."""
        return str(self.shown.loc[row, name]) if row in self.shown.index else ""


@dataclass
class _Reading:
    """The changes of a table as they are read."""

    was: Edited
    sheet: Sheet
    frame: pd.DataFrame
    typed: dict[tuple[int, str], str] = field(default_factory=dict)
    refused: list[str] = field(default_factory=list)
    understood: list[str] = field(default_factory=list)
    converted: bool = False

    def row(self, row: int, cells: Mapping[str, Any], where: str) -> None:
        """The changed cells of a row. One whose numbers were all emptied, where rows may go, holds nothing."""
        numbers = self.sheet.numbers
        gone = self.sheet.dynamic and all(empty(cells.get(name, self.was.text(row, name))) for name in numbers)
        for name, cell in cells.items():
            if name in numbers:
                text = "" if empty(cell) else str(cell)
                self.typed[row, name] = text
                cell = None if gone else self.number(row, name, text, where)
            self.frame.loc[row, name] = cell

    def number(self, row: int, name: str, text: str, where: str) -> Any:
        """The number of a cell; the one that it had where what was typed is refused."""
        box, known = self.sheet.box(name, row), self.was.known(row, name)
        if text == self.was.typed.get((row, name)):
            return known
        if text == self.was.text(row, name):
            return None if empty(text) else self.was.began.loc[row, name]
        if empty(text.strip()) and known is not None and not box.optional:
            self.refused.append(f"{where}, {box.label}: the cell was emptied; it stays {box.named(known, cell=True)}.")
            return known
        try:
            new = None if empty(text.strip()) else box.read(text)
        except ProjectError as exc:
            self.refused.append(f"{where}, {exc} It stays {box.named(known, cell=True)}.")
            return known
        if words := box.understood(text, cell=True):
            self.understood.append(f"{where}, {box.label}: {words}.")
            self.converted |= bool(box.understood(text))
        return new


def table(name: str, base: Callable[[], pd.DataFrame], write: Callable[[pd.DataFrame], None], sheet: Sheet) -> None:
    """A table whose edits go to ``write`` (which changes the project, ``from_editor=True``, or raises its refusal).

    The table starts from ``base()`` and keeps what was typed until the project changes from outside (undo, preset,
    another input) or the page is left. It starts afresh, too, where a cell has to show another number than was typed.
    """
    held = session.store()
    key = f"{name}:{held.revision}.{session.kept(_turn(name), 0)}"
    waiting = held.refused.get(name)
    if key not in st.session_state or key not in held.frames:
        for old in [k for k in held.frames if k.startswith(f"{name}:")]:
            del held.frames[old]
        # A refused table comes back as it was typed when its page is entered again.
        held.frames[key] = Edited.start(waiting[0] if waiting and waiting[0] is not None else base(), sheet)
    st.data_editor(
        held.frames[key].shown,
        key=key,
        column_config=sheet.configured(),
        disabled=list(sheet.locked),
        hide_index=True,
        on_change=lambda: _take(name, key, write, sheet),
        num_rows="dynamic" if sheet.dynamic else "fixed",
        height=sheet.height,
        width="stretch",
    )
    sentence(name)
    note(name, name)


def _take(name: str, key: str, write: Callable[[pd.DataFrame], None], sheet: Sheet) -> None:
    """What was typed last into ``write``; cells that were refused are said, whatever became of the others."""
    held = session.store()
    was: Edited = held.frames[key]
    now = held.frames[key] = was.after(st.session_state[key], sheet)
    pending = held.refused.get(name, (None, ""))[0] is not None
    if pending or not now.now.equals(was.now):
        submit(name, now.now, lambda: write(now.now))
    else:
        accept(name)
    if now.refused:
        frame, words = held.refused.get(name, (None, ""))
        refuse(name, frame, " ".join([_few(now.refused), words]).strip())
    held.read_as[name] = name, _few(now.understood)
    if now.refused or now.converted or sheet.linked:
        session.keep(_turn(name), session.kept(_turn(name), 0) + 1)


def _of_one_unit(boxes: Sequence[NumberBox]) -> bool:
    """Whether the rows of a column are of one quantity, as those of joints that all turn."""
    return len({(box.unit, box.decimals) for box in boxes}) == 1


def _decimals(text: str) -> int:
    """How many a number has as it is written."""
    return len(text.partition(".")[2])


def _few(sentences: Sequence[str]) -> str:
    more = len(sentences) - MOST_SAID
    return " ".join(sentences[:MOST_SAID]) + (f" And {more} more." if more > 0 else "")


def _turn(name: str) -> str:
    return f"{name}.turn"
