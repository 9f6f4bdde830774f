"""Of which kind an argument has to be, by its annotation: asked once a call has failed, to say what was wrong with it.

A call that was given what it takes and fails all the same is a mistake of robomill's own, which stays as it is raised.
"""

import types
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from inspect import isclass, unwrap
from itertools import islice
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import NO_NUMBERS, Arrays, Numbers, Rows, brief, no_number, with_article
from robomill.errors import ArgumentError, RobomillError

LOOKED_AT = 1000  # entries of a sequence
WORDS = {
    bool: "True or False",
    int: "a whole number",
    float: "a number",
    str: "a text",
    bytes: "bytes",
    types.NoneType: "None",
    np.ndarray: "numbers",
    Arrays: "numbers",
}
# What NumPy takes for an array (text among it), and what stands for numbers of one or two axes.
_NUMBERS, _ROWS, _LINE = (frozenset(get_args(each)) for each in (ArrayLike, Rows, Numbers))


SLIPS = (TypeError, AttributeError, ValueError, LookupError, OverflowError)
"""What Python and NumPy raise of a value of another kind than they can use."""


@contextmanager
def kinds_told(call: Callable[..., Any], who: str, given: Mapping[str, Any]) -> Iterator[None]:
    """What is done with ``given`` meanwhile may fail by its kinds, which ``call`` declares: then it is told."""
    try:
        yield
    except RobomillError:
        raise
    except SLIPS:
        refuse_kinds(call, who, given)
        raise


def refuse_kinds(call: Callable[..., Any], who: str, given: Mapping[str, Any]) -> None:
    """Raises ArgumentError for the first of the arguments ``given`` by name that is of another kind than ``call``
    declares."""
    known = _kinds(call)
    for name, value in given.items():
        if name in known and not _fits(value, known[name]):
            numbers = _alternatives(known[name])[0] in (float, Arrays) and not isinstance(value, str)
            found = no_number(value) if numbers else ""
            raise ArgumentError(
                f"{who}: {name}: expected {_words(known[name])}, found {found or brief(value)}.", where=name
            )


@cache
def _kinds(call: Callable[..., Any]) -> Mapping[str, Any]:
    """What ``call`` declares of its arguments; those that cannot be read here (an optional library's) are left out."""
    found: dict[str, Any] = {}
    known = getattr(unwrap(call), "__globals__", {})
    for name, said in call.__annotations__.items():
        try:
            found |= get_type_hints(types.SimpleNamespace(__annotations__={name: said}), known)
        except (NameError, TypeError, AttributeError):
            continue
    return found


def _alternatives(kind: Any) -> list[Any]:
    """Of a union its members, what NumPy takes for numbers as one of them; else the kind alone."""
    if get_origin(kind) not in (Union, types.UnionType):
        return [kind]
    every = list(get_args(kind))
    for some in (_NUMBERS, _ROWS, _LINE):
        if some <= {*every}:
            every = [Arrays, *(each for each in every if each not in some)]
    return every


def _fits(value: Any, kind: Any) -> bool:
    """Whether a value is of a kind; True of kinds that nobody can tell."""
    return any(_is(value, each) for each in _alternatives(kind))


def _is(value: Any, kind: Any) -> bool:
    origin, inner = get_origin(kind), get_args(kind)
    if origin is Literal:
        return any(type(value) is type(each) and value == each for each in inner)
    if kind in (float, int):
        return _is_number(value, kind is int)
    if kind is Arrays or origin is np.ndarray:
        return not isinstance(value, str | bytes | bytearray | Mapping) and not no_number(value) and _is_even(value)
    if kind is bool:
        return isinstance(value, bool | np.bool_)
    if origin is tuple and inner and inner[-1] is not ...:
        return isinstance(value, tuple | list) and len(value) == len(inner) and all(map(_fits, value, inner))
    cls = origin if isclass(origin) else kind
    cls = Sequence if cls is tuple else cls
    try:
        is_one = isinstance(value, cls)
    except TypeError:
        return True  # a protocol, or a variable
    if cls in (Sequence, Iterable):
        is_one |= isinstance(value, np.ndarray) and value.size > 0
        is_one &= not isinstance(value, str | bytes | Mapping)
    return is_one and _holds(value, cls, inner)


def _holds(value: Any, cls: Any, inner: Sequence[Any]) -> bool:
    """Whether what a container holds is of its kinds."""
    if isclass(cls) and issubclass(cls, Mapping) and len(inner) == 2:
        return all(_fits(key, inner[0]) and _fits(each, inner[1]) for key, each in islice(value.items(), LOOKED_AT))
    if cls in (Sequence, Iterable, list) and inner and isinstance(value, Sequence | np.ndarray):
        return all(_fits(each, inner[0]) for each in islice(value, LOOKED_AT))
    return True


def _is_number(value: Any, whole: bool) -> bool:
    if isinstance(value, bool | str | bytes):
        return False
    try:
        number = float(value)
    except NO_NUMBERS:
        return False
    return not whole or number.is_integer()


def _is_even(value: Any) -> bool:
    """Whether rows are as long as each other all the way down."""
    try:
        np.asarray(value, dtype=np.float64)
    except NO_NUMBERS:
        return False
    return True


def _words(kind: Any) -> str:
    """A kind for people: ``"a Robot"``, ``"a number, or None"``."""
    said = dict.fromkeys(_word(each) for each in _alternatives(kind))
    named = [word for word in said if word != "None"]
    return " or ".join(named) + ", or None" * ("None" in said)


def _word(kind: Any) -> str:
    origin, inner = get_origin(kind), get_args(kind)
    if origin is Literal:
        return " or ".join(repr(each) for each in inner)
    if origin is tuple and inner and inner[-1] is not ...:
        return f"({', '.join(_word(each) for each in inner)})"
    cls = origin if isclass(origin) else kind
    if cls in WORDS:
        return WORDS[cls]
    if cls in (Sequence, list, tuple, Iterable):
        return f"a sequence of {_words(inner[0])}" if inner else "a sequence"
    if isclass(cls) and issubclass(cls, Mapping) and len(inner) == 2:
        return f"a mapping from {_words(inner[0])} to {_words(inner[1])}"
    return with_article(getattr(cls, "__name__", str(cls)))
