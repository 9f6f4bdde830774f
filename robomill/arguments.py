"""Arguments as people give them: a name that is not known, one too many and one that is missing are told."""

import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from difflib import get_close_matches
from functools import wraps
from typing import Any, ParamSpec, TypeVar

from robomill.errors import ArgumentError, RobomillError
from robomill.kinds import SLIPS, refuse_kinds

P = ParamSpec("P")
R = TypeVar("R")
C = TypeVar("C", bound=type)
# What people call what goes by another name here.
SAME = {
    "teeth": "flutes",
    "n_flutes": "flutes",
    "length": "stick_out_mm",
    "tool": "cutter",
    "program": "source",
    "path": "source",
    "toolpath": "source",
    "points": "p_mm",
    "feed": "feed_mm_min",
    "feedrate": "feed_mm_min",
    "rpm": "spindle_1_min",
    "stiffness": "k_theta_kNm_per_rad",
    "k_theta": "k_theta_kNm_per_rad",
    "compliance": "C_theta",
    "zero": "part_zero_mm",
    "tcp": "T_tool",
}


def asked(call: Callable[P, R]) -> Callable[P, R]:
    """A public function that tells by ``ArgumentError`` how it was called wrongly: by a name that it does not take,
    without one that it needs, with a value of another kind than it declares. What it raises itself stays."""
    signature, who = inspect.signature(call), call.__qualname__.removesuffix(".__init__")
    return _telling(call, lambda args, given: refuse_kinds(call, who, named(signature, who, args, given, whole=True)))


def asking(cls: C) -> C:
    """A public dataclass that tells in the same way how it was made wrongly."""
    cls.__init__ = asked(cls.__init__)  # type: ignore[misc]
    return cls


def made_by(call: str) -> Callable[[C], C]:
    """A public dataclass that people get from ``call`` and hardly make themselves: so they are told who tried."""

    def of(cls: C) -> C:
        init: Callable[..., None] = cls.__init__  # type: ignore[misc]
        signature = inspect.signature(init)

        def refuse(args: Sequence[Any], given: Mapping[str, Any]) -> None:
            try:
                found = signature.bind(*args, **given).arguments
            except TypeError:
                raise ArgumentError(f"{cls.__name__}: {call} makes it; it is not made by hand.") from None
            refuse_kinds(init, cls.__name__, found)

        cls.__init__ = _telling(init, refuse)  # type: ignore[misc]
        return cls

    return of


def _telling(call: Callable[P, R], refuse: Callable[[Sequence[Any], Mapping[str, Any]], None]) -> Callable[P, R]:
    """``call``; where it slips over what it was given, ``refuse`` may say in a sentence why."""

    @wraps(call)
    def told(*args: P.args, **given: P.kwargs) -> R:
        try:
            return call(*args, **given)
        except RobomillError:
            raise
        except SLIPS:
            refuse(args, given)
            raise

    return told


def named(
    signature: inspect.Signature, who: str, args: Sequence[Any], given: Mapping[str, Any], whole: bool = False
) -> dict[str, Any]:
    """``given`` with the ``args`` by their names, but ``self``. Raises ArgumentError where the signature does not take
    them, or lacks one of a ``whole`` call."""
    every = signature.parameters.values()
    order = [each.name for each in every if each.kind in (each.POSITIONAL_ONLY, each.POSITIONAL_OR_KEYWORD)]
    if not any(each.kind is each.VAR_KEYWORD for each in every):
        refuse_unknown(given, signature.parameters, who)
    hidden = order[:1] in (["self"], ["cls"])
    if len(args) > len(order) and not any(each.kind is each.VAR_POSITIONAL for each in every):
        found, known = len(args) - hidden, order[hidden:]
        most = f"at most {len(known)} ({', '.join(known)}); give the others" if known else "none; give everything"
        raise ArgumentError(f"{who}: found {found} value{'s' * (found != 1)} without a name, expected {most} by name.")
    first = dict(zip(order, args))
    twice = [name for name in first if name in given]
    if twice:
        raise ArgumentError(f"{who}: got multiple values for {twice[0]}; give it once.", where=twice[0])
    lacking = [each.name for each in every if each.default is each.empty and each.name not in {*first, *given}]
    lacking = [name for name in lacking if signature.parameters[name].kind.name[:3] != "VAR"]
    if whole and lacking:
        are = "are" if len(lacking) > 1 else "is"
        raise ArgumentError(f"{who}: {' and '.join(lacking)} {are} missing.", where=lacking[0])
    return {name: value for name, value in (first | dict(given)).items() if name not in order[:hidden]}


def refuse_unknown(given: Iterable[str], known: Iterable[str], who: str) -> None:
    """Raises ArgumentError for the first name of ``given`` that is not ``known``, with what may have been meant."""
    names = [name for name in known if name not in ("self", "cls")]
    for name in given:
        if name not in names:
            raise ArgumentError(f"{who}: there is no {name!r}{_meant(name, names)}", where=name)


def _meant(name: str, names: Sequence[str]) -> str:
    """The end of a refusal: what is like ``name``, or all names there are."""
    small = {each.lower(): each for each in reversed(names)}
    like = [SAME[name]] if SAME.get(name) in names else get_close_matches(name.lower(), small, 1, 0.7)
    if like:
        return f"; did you mean {small.get(like[0], like[0])}?"
    return f"; it takes {', '.join(names)}." if names else "; it takes none by name."
