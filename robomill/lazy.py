"""Values that are made when they are first asked for, and kept with what they are made of."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, Self, TypeVar, overload

import numpy as np

from robomill.arrays import shut

T = TypeVar("T")


class cached_property(Generic[T]):  # noqa: N801 - the field's name for it
    """``functools.cached_property`` as it is from Python 3.12 on: without a lock.

    Before that one lock serves all objects of a class, and work that waits for its turn under it stops everyone else's
    for ever. Two threads that ask at once both make the value; the one that is kept last stays. An array
    (or a tuple of them) that the public asks for is read-only: what is kept is everybody's.
    """

    def __init__(self, make: Callable[[Any], T]) -> None:
        self._make, self.__doc__ = make, make.__doc__

    def __repr__(self) -> str:
        return "<computed when it is first asked for>"  # as help() shows it

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    @overload
    def __get__(self, one: None, owner: type) -> Self: ...
    @overload
    def __get__(self, one: object, owner: type) -> T: ...
    def __get__(self, one: Any, owner: type) -> Any:
        if one is None:
            return self
        value: Any = self._make(one)
        if not self._name.startswith("_"):
            if type(value) is tuple:  # tuples by name are what kernels take and fill
                value = tuple(shut(each) if isinstance(each, np.ndarray) else each for each in value)
            elif isinstance(value, np.ndarray):
                value = shut(value)
        vars(one)[self._name] = value
        return value
