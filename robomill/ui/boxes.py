"""Inputs that are not one number of the set-up: switches, numbers that may be left out, numbers written by a function.

They follow the rule of ``inputs``: seeded from the project, refused input stays with its sentence beneath it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import streamlit as st

from robomill.ui import inputs
from robomill.units import UNITS, from_si, to_si, unit_label


def switch(
    label: str,
    key: str,
    current: bool,
    write: Callable[[bool], None],
    *,
    hint: str | None = None,
    disabled: bool = False,
) -> None:
    """An on/off switch; ``write`` gets the new state."""
    inputs.seed(key, bool(current))
    st.toggle(
        label,
        key=key,
        help=hint,
        disabled=disabled,
        on_change=lambda: inputs.attempt(key, st.session_state[key], lambda: write(bool(st.session_state[key]))),
    )
    inputs.sentence(key)


def number_box(
    label: str,
    key: str,
    value: float | None,
    unit: str,
    write: Callable[[float | None], None],
    *,
    optional: bool = False,
    step: float | None = None,
    digits: int | None = None,
    hint: str | None = None,
    placeholder: str = "not given",
) -> None:
    """A number in ``unit`` (SI inside) whose new value goes to ``write``; empty means None where ``optional``."""
    shown = None if value is None else float(f"{from_si(float(value), unit):.12g}")

    def take() -> None:
        typed = st.session_state[key]

        def put() -> None:
            if typed is None and not optional:
                raise TypeError
            write(None if typed is None else to_si(float(typed), unit))

        inputs.attempt(key, typed, put)

    inputs.seed(key, shown)
    decimals = UNITS[unit].digits if digits is None else digits
    name = f"{label}, {unit_label(unit)}" if unit_label(unit) else label
    # Without a default an emptied box stays empty; with one it would fall back to it.
    default: Any = {"value": None} if optional else {}
    st.number_input(
        name,
        key=key,
        step=step,
        format=f"%.{decimals}f",
        on_change=take,
        help=hint,
        placeholder=placeholder,
        **default,
    )
    inputs.sentence(key)
