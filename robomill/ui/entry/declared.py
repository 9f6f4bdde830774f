"""Declared fields on the page: number boxes, switches and choices as ``quantities`` says them, of any owner."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, TypeVar

import numpy as np
import streamlit as st

from robomill.quantities import Quantity, quantities
from robomill.ui import session
from robomill.ui.entry import inputs
from robomill.ui.entry.box import box_of, declaration, entry
from robomill.ui.entry.inputs import PLAIN, Look
from robomill.ui.entry.typed import said_below
from robomill.ui.project import read_field

Item = TypeVar("Item")


def field(path: str, write: Callable[[Any], None] | None = None, look: Look = PLAIN) -> None:
    """The declared field of the set-up at ``path`` ("cutter.diameter"): what ``draw`` makes of its declaration.

    ``write`` gets what was typed in place of the set-up, where more than the field is to change.
    """
    setup = session.project().setup
    said = declaration(setup, path)
    if said is None:
        raise KeyError(f"not a declared field: {path!r}")
    draw(said, path, read_field(setup, path), write or inputs.into_setup(path, path), look)


def seen(path: str, look: Look = PLAIN, options: Mapping[Any, str] | None = None, label: str = "", **more: Any) -> Any:
    """The field of what is looked at, "view.camera" or "maps.A", as declared: draws it and returns what is in force.

    Where ``options`` are given it is a choice between these; what is none of them (on another arm) is shown as the
    first one. A field that is not declared needs its ``label``, too. ``more`` are fields that change with it.
    """
    owner, _, name = path.partition(".")
    held, write = (session.project().view, session.look) if owner == "view" else (session.maps(), session.see)
    said = quantities(type(held)).get(name, Quantity(label))
    if options is not None:
        said = replace(said, kind="choice", options=options)
    current = getattr(held, name)
    if said.kind == "choice" and current not in said.options:
        current = next(iter(said.options))
    draw(said, path, current, lambda new: write(**{name: new, **more}), look)
    return current


def fields(owner: Any, key: str, write: Callable[[str, Any], None]) -> None:
    """Every field of ``owner`` that is declared with a box, numbers in a row; ``write`` gets its name and new value."""
    drawn = [said for said in quantities(type(owner)).values() if said.boxed]
    numbers = [said for said in drawn if said.kind in ("number", "whole")]
    wide = 3 if len(numbers) == 3 else 2
    rows = [numbers[start : start + wide] for start in range(0, len(numbers), wide)]
    for row in [*rows, *([said] for said in drawn if said not in numbers)]:
        in_row(row, lambda said: draw(said, f"{key}.{said.name}", getattr(owner, said.name), partial(write, said.name)))


def draw(said: Quantity, key: str, current: Any, write: Callable[[Any], None], look: Look = PLAIN) -> None:
    """The input that a declaration asks for: a number box (one an entry of an array), a switch or a choice.

    Lengths are typed in the unit of the view; ``write`` gets SI.
    """
    look = replace(look, hint=look.hint or said.hint)
    if said.kind == "switch":
        inputs.switch(said.label, key, current, write, look)
    elif said.kind == "choice":
        inputs.choice(said.label, key, said.options, current, write, look)
    elif said.kind == "array":
        in_row(
            range(len(said.axes)),
            lambda i: draw(entry(said, i), f"{key}[{i}]", current[i], partial(_write_entry, current, i, write), look),
        )
    else:
        shown = {"unit": in_view(said.unit), "hint": look.hint, "disabled": look.disabled, "hidden": look.hidden}
        empty = {} if look.placeholder is None else {"placeholder": look.placeholder}
        inputs.value(key, box_of(said, **shown, **empty), current, write)


def _write_entry(array: Any, i: int, write: Callable[[Any], None], new: float) -> None:
    changed = np.array(array, dtype=float)
    changed[i] = new
    write(changed)


def in_view(unit: str) -> str:
    """Numbers that hold a length are typed in the units of the view."""
    return session.project().view.of(unit)


def in_row(items: Sequence[Item], show: Callable[[Item], None]) -> None:
    """Show the items side by side."""
    with said_below():
        for column, item in zip(st.columns(len(items)), items, strict=True):
            with column:
                show(item)
