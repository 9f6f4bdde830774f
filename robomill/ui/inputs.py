"""Inputs bound to fields of the project: seeded from it, writing a replaced project back, in the units of the screen.

A value that is refused stays in its box with the sentence beneath it; the project keeps the last good value.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import streamlit as st

from robomill.errors import RobomillError
from robomill.ui import fields, state
from robomill.units import UNITS, from_si, to_si, unit_label


def number(
    label: str,
    path: str,
    unit: str = "1",
    *,
    step: float | None = None,
    digits: int | None = None,
    hint: str | None = None,
    disabled: bool = False,
) -> None:
    """A number box for the set-up's field at ``path`` (see ``fields``), shown in ``unit``."""
    key = f"in:{path}:{unit}"
    shown = _rounded(from_si(float(fields.read(state.project().setup, path)), unit))

    def take() -> None:
        typed = st.session_state[key]
        attempt(key, typed, lambda: _put(path, to_si(float(typed), unit), key))

    seed(key, shown)
    decimals = UNITS[unit].digits if digits is None else digits
    name = f"{label}, {unit_label(unit)}" if unit_label(unit) else label
    st.number_input(name, key=key, step=step, format=f"%.{decimals}f", on_change=take, help=hint, disabled=disabled)
    sentence(key)


def whole(label: str, path: str, *, hint: str | None = None) -> None:
    """A box for a whole number of the set-up."""
    key = f"in:{path}"
    seed(key, int(fields.read(state.project().setup, path)))
    st.number_input(
        label,
        key=key,
        step=1,
        help=hint,
        on_change=lambda: attempt(key, st.session_state[key], lambda: _put(path, int(st.session_state[key]), key)),
    )
    sentence(key)


def choice(
    label: str,
    key: str,
    options: Mapping[Any, str],
    current: Any,
    write: Callable[[Any], None],
    *,
    horizontal: bool = True,
    hint: str | None = None,
    label_visibility: Any = "visible",
) -> None:
    """A choice between a few (``horizontal``) or many options; ``write`` gets the chosen key."""
    seed(key, current)

    def take() -> None:
        picked = st.session_state[key]
        if picked is not None:
            attempt(key, picked, lambda: write(picked))

    if horizontal:
        st.segmented_control(
            label,
            list(options),
            key=key,
            format_func=lambda k: options[k],
            on_change=take,
            help=hint,
            label_visibility=label_visibility,
            required=True,
            width="stretch",
        )
    else:
        st.selectbox(
            label,
            list(options),
            key=key,
            format_func=lambda k: options[k],
            on_change=take,
            help=hint,
            label_visibility=label_visibility,
        )
    sentence(key)


def slider(
    label: str,
    key: str,
    low: float,
    high: float,
    current: float,
    write: Callable[[float], None],
    *,
    step: float,
    form: str | None = None,
    hint: str | None = None,
    label_visibility: Any = "visible",
) -> None:
    """A slider over a number of the view or the set-up, in display units."""
    seed(key, float(min(max(current, low), high)))
    st.slider(
        label,
        float(low),
        float(high),
        key=key,
        step=step,
        format=form,
        help=hint,
        label_visibility=label_visibility,
        on_change=lambda: attempt(key, st.session_state[key], lambda: write(float(st.session_state[key]))),
    )
    sentence(key)


def seed(key: str, value: Any) -> None:
    """Show ``value`` in the widget ``key``, unless something refused is waiting there to be mended."""
    kept = state.store()
    waiting = kept.refused.get(key)
    known = key in st.session_state and key in kept.seeded
    if waiting is not None and known:
        return
    shown = waiting[0] if waiting is not None else value
    # Written only where it differs: a slider that is being dragged would jump otherwise.
    if not known or st.session_state[key] != shown:
        st.session_state[key] = shown
        kept.seeded.add(key)


def sentence(key: str) -> None:
    """The reason why the input at ``key`` was refused, if it was."""
    waiting = state.store().refused.get(key)
    if waiting is not None:
        st.error(waiting[1], icon=":material/error:")


def refuse(key: str, typed: Any, reason: str) -> None:
    """Keep refused input and its reason, to be shown under the widget ``key``."""
    state.store().refused[key] = (typed, reason)


def accept(key: str) -> None:
    """Forget an earlier refusal at ``key``."""
    state.store().refused.pop(key, None)


def _put(path: str, value: Any, label: str) -> None:
    name, _, _ = path.partition(".")
    name = name.partition("[")[0]
    changed = fields.write(state.project().setup, path, value)
    state.change(label=label, **{name: getattr(changed, name)})


def attempt(key: str, typed: Any, action: Callable[[], None]) -> None:
    """Do ``action``; a refusal keeps ``typed`` and its sentence at ``key``, success forgets an earlier one."""
    try:
        action()
    except RobomillError as exc:
        refuse(key, typed, str(exc))
    except TypeError:
        refuse(key, typed, "The box is empty: type a number.")
    else:
        accept(key)


def _rounded(value: float) -> float:
    """Without the last bits that a unit conversion leaves behind."""
    return float(f"{value:.12g}")
