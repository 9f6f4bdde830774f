"""Numbers, parameters, expressions and functions, read from a position in a line.

The grammar is RS274/NGC's: ``[`` ... ``]`` with ``**`` before ``* / MOD`` before ``+ -`` before comparisons before
``AND OR XOR``, all from left to right; functions of a bracket, ``ATAN[y]/[x]``; angles in degrees.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable

from robomill.errors import GCodeError
from robomill.toolpath.gcode.parameters import Parameters

MAX_DEPTH = 60
EQUAL = 1e-4
"""Two numbers are EQ if they differ by less than this."""

_NUMBER = re.compile(r"[+-]*[0-9.]+")
_OPERATOR = re.compile(r"\*\*|[-+/*\]]|and|or|xor|mod|eq|ne|ge|gt|le|lt")
_FUNCTION = re.compile(r"acos|asin|atan|abs|cos|exists|exp|fix|fup|ln|round|sin|sqrt|tan")
_PRECEDENCE = {
    "]": 1,
    "and": 2,
    "or": 2,
    "xor": 2,
    "eq": 3,
    "ne": 3,
    "ge": 3,
    "gt": 3,
    "le": 3,
    "lt": 3,
    "+": 4,
    "-": 4,
    "*": 5,
    "/": 5,
    "mod": 5,
    "**": 6,
}
_TURN = math.pi / 180.0


class Reader:
    """A line in lower case without blanks (outside comments), and how far it has been read.

    Every method raises GCodeError naming the line.
    """

    def __init__(self, text: str, line: int, store: Parameters) -> None:
        self.text = text
        self.line = line
        self.at = 0
        self.store = store
        self.depth = 0

    def refuse(self, message: str) -> GCodeError:
        """The error to raise: ``message`` with the line in front."""
        return GCodeError(f"Line {self.line}: {message}", line=self.line)

    def rest(self, length: int = 20) -> str:
        """What comes next, for messages."""
        return self.text[self.at : self.at + length] or "the end of the line"

    def value(self) -> float:
        """A real value: number, ``[expression]``, ``#parameter`` or function."""
        text, at = self.text, self.at
        number = _NUMBER.match(text, at)
        if number is not None:
            try:
                result = float(number[0])
            except ValueError:
                raise self.refuse(f"{number[0]!r} is not a number; expected digits with one point.") from None
            self.at = number.end()
            if self.at < len(text) and text[self.at] == "," and text[self.at + 1 : self.at + 2].isdigit():
                raise self.refuse(f"{number[0]},{text[self.at + 1]} has a decimal comma; write a point.")
        else:
            result = self._other_value()
        if not math.isfinite(result):
            raise self.refuse("a number is too large or not a number; expected a finite value.")
        return result

    def _other_value(self) -> float:
        first = self.text[self.at : self.at + 1]
        if not first:
            raise self.refuse("the line ends where a number should be; complete or remove the word.")
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise self.refuse(f"brackets, signs or # are nested more than {MAX_DEPTH} deep; simplify the expression.")
        if first == "[":
            result = self.expression()
        elif first == "#":
            result = self.parameter()
        elif first in "+-":
            self.at += 1
            result = self.value() * (-1.0 if first == "-" else 1.0)
        else:
            result = self._function()
        self.depth -= 1
        return result

    def integer(self, what: str) -> int:
        """A value within 0.0001 of an integer."""
        value = self.value()
        nearest = math.floor(value + 0.5)
        if abs(value - nearest) > 1e-4:
            raise self.refuse(f"{what} is {value:g}; expected a whole number.")
        return nearest

    def expression(self) -> float:
        """``[`` value { operator value } ``]`` with precedence, from left to right."""
        self.at += 1
        values, operators = [self.value()], [self._operator()]
        while operators[0] != "]":
            values.append(self.value())
            operators.append(self._operator())
            while len(operators) > 1 and _PRECEDENCE[operators[-1]] <= _PRECEDENCE[operators[-2]]:
                right, following = values.pop(), operators.pop()
                values[-1] = self._binary(values[-1], operators[-1], right)
                operators[-1] = following
        return values[0]

    def _operator(self) -> str:
        found = _OPERATOR.match(self.text, self.at)
        if found is None:
            if self.at >= len(self.text):
                raise self.refuse("an expression is not closed; add ].")
            raise self.refuse(f"found {self.rest()!r} in an expression; expected an operator or ].")
        self.at = found.end()
        return found[0]

    def _binary(self, a: float, operator: str, b: float) -> float:
        simple = _BINARY.get(operator)
        try:
            if simple is not None:
                return simple(a, b)
            if operator == "/":
                return a / b
            if operator == "mod":
                rest = math.fmod(a, b)
                return rest + abs(b) if rest < 0 else rest
            if a < 0 and b != math.floor(b):
                raise self.refuse(f"{a:g}**{b:g}: a negative number can only be raised to a whole power.")
            return a**b
        except ZeroDivisionError:
            raise self.refuse(f"{a:g}{operator}{b:g} divides by zero.") from None
        except (ValueError, OverflowError):
            raise self.refuse(f"{a:g} {operator} {b:g} has no finite value.") from None

    def _function(self) -> float:
        name = _FUNCTION.match(self.text, self.at)
        if name is None:
            raise self.refuse(f"found {self.rest()!r} where a number should be.")
        self.at = name.end()
        if self.text[self.at : self.at + 1] != "[":
            raise self.refuse(f"{name[0].upper()} needs its argument in [ ].")
        if name[0] == "exists":
            return self._exists()
        argument = self.expression()
        if name[0] == "atan":
            if self.text[self.at : self.at + 2] != "/[":
                raise self.refuse("ATAN needs two arguments: ATAN[y]/[x].")
            self.at += 1
            return math.atan2(argument, self.expression()) / _TURN
        try:
            return _FUNCTIONS[name[0]](argument)
        except (ValueError, OverflowError):
            raise self.refuse(f"{name[0].upper()}[{argument:g}] has no value.") from None

    def _exists(self) -> float:
        self.at += 1
        if self.text[self.at : self.at + 1] != "#":
            raise self.refuse("EXISTS needs a parameter: EXISTS[#<name>].")
        self.at += 1
        if self.text[self.at : self.at + 1] == "<":
            found = self.store.get_named(self.name()) is not None
        else:
            found = 1 <= self.integer("The number of a parameter") < len(self.store.numbered)
        if self.text[self.at : self.at + 1] != "]":
            raise self.refuse("EXISTS is not closed; add ].")
        self.at += 1
        return float(found)

    def name(self) -> str:
        """``<name>``, without the brackets."""
        end = self.text.find(">", self.at)
        if end < 0:
            raise self.refuse("a name is not closed; add >.")
        name = self.text[self.at + 1 : end]
        self.at = end + 1
        return name

    def parameter(self) -> float:
        """The value of ``#5``, ``##5``, ``#[...]`` or ``#<name>``."""
        self.at += 1
        if self.text[self.at : self.at + 1] == "<":
            name = self.name()
            value = self.store.get_named(name)
            if value is None:
                raise self.refuse(f"parameter #<{name}> is not defined; set it before it is used.")
            return value
        index = self.integer("The number of a parameter")
        try:
            return self.store.get(index)
        except GCodeError as exc:
            raise self.refuse(str(exc)) from None


def _truth(condition: bool) -> float:
    return 1.0 if condition else 0.0


_BINARY: dict[str, Callable[[float, float], float]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "and": lambda a, b: _truth(a != 0 and b != 0),
    "or": lambda a, b: _truth(a != 0 or b != 0),
    "xor": lambda a, b: _truth((a != 0) != (b != 0)),
    "eq": lambda a, b: _truth(abs(a - b) < EQUAL),
    "ne": lambda a, b: _truth(abs(a - b) >= EQUAL),
    "ge": lambda a, b: _truth(a >= b),
    "le": lambda a, b: _truth(a <= b),
    "gt": lambda a, b: _truth(a > b),
    "lt": lambda a, b: _truth(a < b),
}

_FUNCTIONS: dict[str, Callable[[float], float]] = {
    "abs": abs,
    "acos": lambda v: math.acos(v) / _TURN,
    "asin": lambda v: math.asin(v) / _TURN,
    "cos": lambda v: math.cos(v * _TURN),
    "exp": math.exp,
    "fix": lambda v: float(math.floor(v)),
    "fup": lambda v: float(math.ceil(v)),
    "ln": math.log,
    "round": lambda v: float(math.trunc(v + math.copysign(0.5, v))),
    "sin": lambda v: math.sin(v * _TURN),
    "sqrt": math.sqrt,
    "tan": lambda v: math.tan(v * _TURN),
}
