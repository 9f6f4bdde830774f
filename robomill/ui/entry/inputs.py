"""Inputs: one number box, one choice, one switch, one slider, one button, one upload; the table is in ``grid``.

Each is seeded from what is in force and hands what was typed to the project. Input that is refused stays where it was
typed with the sentence beneath it; the project keeps the last good value. Keys read "page.thing".

What is shown is each input's own default, too: in the browser an input comes up with its default and gets its value in
a second step, and a word that goes to the server between the two (a tick of progress, another click) carries the
default as if a person had chosen it.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import streamlit as st

from robomill.errors import ProjectError
from robomill.ui import session
from robomill.ui.entry.box import NumberBox, declared
from robomill.ui.entry.typed import accept, heard, news, note, refuse, seed, sentence, submit
from robomill.ui.markup import as_markdown
from robomill.ui.project import read_field, with_field


@dataclass(frozen=True)
class Look:
    """How an input is shown: as a list or stacked instead of a row, without its label, with a hint, or greyed.

    A list of which ``most`` can be chosen says ``placeholder`` while none is.
    """

    listed: bool = False
    stacked: bool = False
    hidden: bool = False
    hint: str | None = None
    disabled: bool = False
    most: int | None = None
    placeholder: str | None = None

    @property
    def label_visibility(self) -> Literal["visible", "collapsed"]:
        """As Streamlit says it."""
        return "collapsed" if self.hidden else "visible"


PLAIN, LISTED, HIDDEN = Look(), Look(listed=True), Look(hidden=True)


@dataclass(frozen=True)
class Span:
    """From where to where a slider goes and in which steps, in display units; ``form`` is how it says its value."""

    low: float
    high: float
    step: float
    form: str | None = None


def number(path: str, **shown: Any) -> None:
    """The number box of the set-up's field at ``path``, shown otherwise than declared, or not declared at all.

    ``shown`` are fields of ``NumberBox``; a field that is not declared needs a ``label``.
    """
    setup = session.project().setup
    box = declared(setup, path, **shown)
    value(path, box, read_field(setup, path), into_setup(path, _key(path, box)))


def into_setup(path: str, label: str) -> Callable[[Any], None]:
    """Writes the field at ``path``; quick changes with one ``label`` are one step back."""
    name = path.partition(".")[0].partition("[")[0]

    def write(new: Any) -> None:
        changed = with_field(session.project().setup, path, new)
        session.change(label=label, **{name: getattr(changed, name)})

    return write


def value(name: str, box: NumberBox, current: float | None, write: Callable[[Any], None]) -> None:
    """A number box for any value in SI; ``write`` gets what was typed, in SI.

    A line of text: a browser's own number box swallows a decimal comma, and one with a default cannot be emptied.
    """
    key, written = _key(name, box), box.written(current)
    shown = seed(key, written)

    def take() -> None:
        text = st.session_state[key]
        if text.strip() == written:
            accept(key)  # what is shown may be rounded: the value stays as it is
        elif not text.strip() and not box.optional:
            refuse(key, written, f"{box.label}: the box was emptied; it stays {box.named(current)}.")
        else:
            _read(key, text, box, current, write)

    st.text_input(
        box.title,
        shown,
        key=key,
        on_change=news(key, take),
        help=box.hint,
        disabled=box.disabled,
        placeholder=box.placeholder if box.optional else None,
        label_visibility="collapsed" if box.hidden else "visible",
        autocomplete="off",
    )
    heard(key, shown, take)
    note(key, shown)


def _read(key: str, text: str, box: NumberBox, current: float | None, write: Callable[[Any], None]) -> None:
    """What was typed into a number box into ``write``; a refusal that is not the project's own says what stays."""
    session.store().read_as.pop(key, None)
    try:
        new = box.read(text)
    except ProjectError as exc:
        refuse(key, text, f"{exc} It stays {box.named(current)}.")
        return
    submit(key, text, lambda: write(new))
    if key not in session.store().refused:
        session.store().read_as[key] = box.written(new), box.understood(text)


def _key(name: str, box: NumberBox) -> str:
    return name if box.unit == "1" else f"{name}:{box.unit}"


def choice(
    label: str,
    key: str,
    options: Mapping[Any, str],
    current: Any,
    write: Callable[[Any], None],
    look: Look = PLAIN,
) -> None:
    """A choice between a few options in a row or stacked, or many in a list; ``write`` gets the chosen key.

    Stacked, none is chosen where ``current`` is None.
    """
    shown = seed(key, current)
    at = list(options).index(shown) if shown in options else None

    def take() -> None:
        picked = st.session_state[key]
        if picked in options:  # a browser says an option whose name has changed by the name that it had
            submit(key, picked, lambda: write(picked))

    common: dict[str, Any] = {
        "key": key,
        "format_func": lambda k: options[k] if look.listed else as_markdown(options[k]),
        "on_change": news(key, take),
        "help": look.hint,
        "disabled": look.disabled,
        "label_visibility": look.label_visibility,
    }
    if look.listed:
        st.selectbox(label, list(options), index=at, **common)
    elif look.stacked:
        st.radio(label, list(options), index=at, **common)
    else:
        st.segmented_control(
            label, list(options), default=None if at is None else shown, required=True, width="stretch", **common
        )
    heard(key, shown, take)


def pick(label: str, key: str, options: Mapping[Any, str], otherwise: Any = None, look: Look = PLAIN) -> Any:
    """A choice kept in the session under ``key``: returns what is chosen, at first ``otherwise`` or the first option.

    What is kept but no option now is shown as the first choice and comes back when it is one again.
    """
    first = next(iter(options)) if otherwise is None else otherwise
    current = session.kept(key, first)
    choice(label, key, options, current if current in options else first, lambda v: session.keep(key, v), look)
    current = session.kept(key, first)
    return current if current in options else first


def several(
    label: str,
    key: str,
    options: Mapping[Any, str],
    current: Sequence[Any],
    write: Callable[[list[Any]], None],
    look: Look = LISTED,
) -> None:
    """A choice of any number of options, as a list or in a row; ``write`` gets the list of those chosen."""
    shown = seed(key, list(current))

    def take() -> None:
        submit(key, st.session_state[key], lambda: write(list(st.session_state[key])))

    common: dict[str, Any] = {
        "key": key,
        "format_func": lambda k: options[k] if look.listed else as_markdown(options[k]),
        "on_change": news(key, take),
        "label_visibility": look.label_visibility,
        "default": [each for each in shown if each in options],
    }
    if look.listed:
        st.multiselect(label, list(options), max_selections=look.most, placeholder=look.placeholder, **common)
    else:
        st.pills(label, list(options), selection_mode="multi", **common)
    heard(key, shown, take)


def switch(label: str, key: str, current: bool, write: Callable[[bool], None], look: Look = PLAIN) -> None:
    """An on/off switch; ``write`` gets the new state."""
    shown = seed(key, bool(current))

    def take() -> None:
        submit(key, st.session_state[key], lambda: write(bool(st.session_state[key])))

    st.toggle(label, shown, key=key, help=look.hint, disabled=look.disabled, on_change=news(key, take))
    heard(key, shown, take)


def slider(
    label: str, key: str, span: Span, current: float, write: Callable[[float], None], look: Look = PLAIN
) -> None:
    """A slider over a number of the view or the set-up, in display units."""
    low, high = float(span.low), float(span.high)
    shown = seed(key, float(min(max(current, low), high)))

    def take() -> None:
        submit(key, st.session_state[key], lambda: write(float(st.session_state[key])))

    st.slider(
        label,
        low,
        high,
        shown,
        key=key,
        step=float(span.step),
        format=span.form,
        help=look.hint,
        disabled=look.disabled,
        label_visibility=look.label_visibility,
        on_change=news(key, take),
    )
    heard(key, shown, take)


def stops(label: str, key: str, options: Mapping[Any, str], current: Any, write: Callable[[Any], None]) -> None:
    """A slider over options that stand in an order but not at equal steps; ``write`` gets the chosen key."""
    shown = seed(key, current)

    def take() -> None:
        submit(key, st.session_state[key], lambda: write(st.session_state[key]))

    st.select_slider(label, list(options), shown, key=key, format_func=lambda k: options[k], on_change=news(key, take))
    heard(key, shown, take)


def text(label: str, key: str, current: str, write: Callable[[str], None], *, lines: int = 1, **shown: Any) -> None:
    """A line of text, or several; ``write`` gets what was typed, ``shown`` goes to Streamlit."""
    begun = seed(key, current)

    def take() -> None:
        submit(key, st.session_state[key], lambda: write(st.session_state[key]))

    if lines == 1:
        st.text_input(label, begun, key=key, on_change=news(key, take), **shown)
    else:
        st.text_area(label, begun, key=key, on_change=news(key, take), **shown)
    heard(key, begun, take)


def button(label: str, key: str, icon: str, do: Callable[..., Any], *args: Any, **more: Any) -> None:
    """A button for ``do(*args)``; a refusal is said beneath. ``icon`` names a symbol, ``more`` goes to Streamlit."""
    act = partial(submit, key, None, partial(do, *args))
    st.button(label, key=key, icon=f":material/{icon}:" if icon else None, on_click=act, **more)
    sentence(key)


def upload(
    label: str,
    key: str,
    take: Callable[[bytes, str], None],
    *,
    most_MB: int,
    look: Look = PLAIN,
    fresh: Any = 0,
) -> None:
    """A file to be read: ``take`` gets its bytes and its name, and may refuse them. A new ``fresh`` empties the box.

    Any name is let in and judged by ``take``, so that an odd ending gets a sentence and not a grey refusal.
    """
    box = f"{key}:{fresh}"

    def taken() -> None:
        file: Any = st.session_state.get(box)
        if file is None:
            accept(key)
        else:
            submit(key, None, lambda: take(file.getvalue(), file.name))

    most = min(most_MB, int(st.get_option("server.maxUploadSize")))
    st.file_uploader(label, key=box, max_upload_size=most, on_change=taken, help=look.hint)
    sentence(key)


def reread(key: str, take: Callable[[bytes, str], None], option: str, chosen: Any) -> None:
    """Keep how files are to be read, and read the one that is kept under ``key`` again."""
    session.keep(option, chosen)
    if given := session.kept(key):
        submit(key, None, lambda: take(*given))
