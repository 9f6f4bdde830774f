"""What the options say: numbers, joint coordinates, the points of an axis; refused by their name."""

import argparse
import math
from collections.abc import Sequence
from difflib import get_close_matches
from typing import Any

from robomill.errors import RobomillError


class Parser(argparse.ArgumentParser):
    """A parser that says what was meant by a word that is not one of its choices."""

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is None or value in action.choices:
            return
        words = [str(each) for each in action.choices]
        close = get_close_matches(str(value).lower(), words, 1, 0.5)
        meant = f"did you mean {close[0]!r}?" if close else f"expected one of {', '.join(words)}"
        raise argparse.ArgumentError(action, f"there is no {value!r:.40}; {meant}")


def numbers(text: str, option: str, count: int | None, what: str) -> list[float]:
    values = floats(text.split(","))
    if len(values) != (count or max(len(values), 1)):
        raise RobomillError(
            f"{option}: expected {count or 'one or more'} numbers separated by commas ({what}), found {text!r:.80}."
        )
    return values


def floats(words: Sequence[str]) -> list[float]:
    """The numbers that words say; none where one of them says none."""
    from robomill.typed_numbers import plain_number

    try:
        values = [plain_number(word) for word in words]
    except ValueError:
        return []
    return values if all(map(math.isfinite, values)) else []


def wholes(text: str, option: str) -> tuple[int, ...]:
    return tuple(int(v) for v in numbers(text, option, None, "whole numbers"))


def number(text: str) -> float:
    """A number, as argparse takes it; raises its refusal."""
    from robomill.typed_numbers import plain_number

    try:
        return plain_number(text)
    except ValueError:
        point = f"; write {text.replace(',', '.')}" if floats([text.replace(",", ".")]) else ""
        raise argparse.ArgumentTypeError(f"expected a number, found {text!r:.40}{point}") from None


def whole(most: int, text: str) -> int:
    """A whole number from 1 on, as argparse takes it; raises its refusal."""
    if not (text.isascii() and text.isdecimal() and len(text) < 9 and 0 < int(text) <= most):
        raise argparse.ArgumentTypeError(f"expected a whole number from 1 to {most}, found {text!r:.40}")
    return int(text)


def theta(robot: Any, text: str) -> Any:
    import numpy as np

    from robomill.units import to_si

    what = f"the {robot.n} joint coordinates of {robot.name}"
    values = np.array(numbers(text, "--theta-deg", robot.n, what))
    return np.array([to_si(value, unit) for value, unit in zip(values, robot.joint_units, strict=True)])


def axis(text: str, option: str) -> Any:
    """Points of one axis from "low:high:step" or one number, in mm."""
    from robomill.workspace.grid import axis_points

    values = floats(text.split(":"))
    if len(values) not in (1, 3):
        raise RobomillError(f"{option}: expected low:high:step or one number, in mm, found {text!r:.80}.")
    low, *rest = values
    return axis_points(low, rest[0], rest[1], option) if rest else low


def span(text: str | None, option: str) -> tuple[float, float] | None:
    """Least and largest from "low:high", or one number for both; None where nothing is said."""
    if text is None:
        return None
    values = floats(text.split(":"))
    if len(values) not in (1, 2):
        raise RobomillError(f"{option}: expected low:high or one number, found {text!r:.80}.")
    return values[0], values[-1]


def box(text: str, option: str) -> tuple[list[float], list[float]]:
    """Lower and upper corner from "x,y,z:x,y,z"."""
    corners = [floats(corner.split(",")) for corner in text.split(":")]
    if list(map(len, corners)) != [3, 3]:
        raise RobomillError(f"{option}: expected X,Y,Z:X,Y,Z (lower and upper corner, mm), found {text!r:.80}.")
    return corners[0], corners[1]
