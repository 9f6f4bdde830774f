"""Boxes for declared numbers: label, unit, step, digits and hint come from the declaration (``quantities``)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import streamlit as st

from robomill.quantities import Quantity, quantities
from robomill.ui import inputs, session
from robomill.ui.project import read_field, with_field


def box(path: str, **changed: Any) -> None:
    """The box (switch, choice, row of boxes) of the set-up's declared field at ``path``, e.g. ``"cutter.diameter"``."""
    setup = session.project().setup
    owner_path, _, name = path.rpartition(".")
    root = path.partition(".")[0]

    def write(value: Any) -> None:
        session.change(label=path, **{root: getattr(with_field(setup, path, value), root)})

    owner = read_field(setup, owner_path) if owner_path else setup
    draw(quantities(type(owner))[name], path, getattr(owner, name), write, **changed)


def boxes_of(owner: Any, key: str, write: Callable[[str, Any], None], units: Callable[[str], str]) -> None:
    """Every boxed number of ``owner``, numbers in a row; ``write(name, value)`` takes a new one."""
    drawn = [q for q in quantities(type(owner)).values() if q.boxed]
    rowed = [q for q in drawn if q.kind in ("number", "whole")]
    wide = 3 if len(rowed) == 3 else 2
    for start in range(0, len(rowed), wide):
        row = rowed[start : start + wide]
        for column, each in zip(st.columns(len(row)), row, strict=True):
            with column:
                _draw_one(owner, each, key, write, units)
    for each in drawn:
        if each not in rowed:
            _draw_one(owner, each, key, write, units)


def _draw_one(
    owner: Any, declared: Quantity, key: str, write: Callable[[str, Any], None], units: Callable[[str], str]
) -> None:
    name = declared.name
    draw(declared, f"{key}.{name}", getattr(owner, name), lambda v: write(name, v), unit=units(name))


def draw(
    declared: Quantity,
    key: str,
    current: Any,
    write: Callable[[Any], None],
    *,
    unit: str | None = None,
    disabled: bool = False,
) -> None:
    """The widget that the declaration asks for; ``write`` gets the new value in SI."""
    if declared.kind == "switch":
        inputs.switch(declared.label, key, current, write, inputs.Look(hint=declared.hint, disabled=disabled))
    elif declared.kind == "choice":
        inputs.choice(declared.label, key, declared.options, current, write, inputs.Look(hint=declared.hint))
    elif declared.kind == "array":
        for i, (column, axis) in enumerate(zip(st.columns(len(declared.axes)), declared.axes, strict=True)):
            with column:
                _number(declared, f"{key}[{i}]", current[i], _entry_writer(current, i, write), unit, f" {axis}")
    else:
        _number(declared, key, current, write, unit)


def _number(
    declared: Quantity,
    key: str,
    current: float | None,
    write: Callable[[Any], None],
    unit: str | None,
    axis: str = "",
) -> None:
    shown = shown_in(unit or declared.unit)
    inputs.value(
        key,
        inputs.Box(
            declared.label + axis,
            shown,
            step=declared.step_in(shown),
            digits=declared.digits_in(shown),
            hint=declared.hint,
            optional=declared.optional,
        ),
        current,
        write,
    )


def _entry_writer(current: Any, i: int, write: Callable[[Any], None]) -> Callable[[float], None]:
    def put(value: float) -> None:
        changed = np.array(current, dtype=float)
        changed[i] = value
        write(changed)

    return put


def shown_in(unit: str) -> str:
    """Lengths are shown in the unit of the view."""
    return session.project().view.length if unit == "mm" else unit
