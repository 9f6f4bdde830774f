"""Values of a line that is read word by word: the rules of ``value_rules``, and their refusals in words."""

import math
import re
from collections.abc import Callable

from robomill.errors import GCodeError
from robomill.toolpath.gcode.foreign import said_of
from robomill.toolpath.gcode.parameters import COUNT, Parameters
from robomill.toolpath.gcode.rules import operator_rules as rules, value_rules
from robomill.toolpath.gcode.rules.value_rules import MAX_DEPTH

SENTENCES = {
    rules.NOT_A_NUMBER: "{number!r} is not a number; expected digits with one point.",
    rules.DECIMAL_COMMA: "{number},{comma} has a decimal comma; write a point.",
    rules.TOO_LARGE: "a number is too large or not a number; expected a finite value.",
    rules.NOTHING: "the line ends where a number should be; complete or remove the word.",
    rules.TOO_DEEP: f"brackets, signs or # are nested more than {MAX_DEPTH} deep; simplify the expression.",
    rules.NOT_CLOSED: "an expression is not closed; add ].",
    rules.NO_OPERATOR: "found {rest!r} in an expression; expected an operator or ].",
    rules.NO_FUNCTION: "found {rest!r} where a number should be; expected digits, [ ], a # or a function.",
    rules.NO_ARGUMENT: "{function} needs its argument in [ ].",
    rules.ONE_ARGUMENT: "ATAN needs two arguments: ATAN[y]/[x].",
    rules.EXISTS_OF_WHAT: "EXISTS needs a parameter: EXISTS[#<name>].",
    rules.EXISTS_NOT_CLOSED: "EXISTS is not closed; add ].",
    rules.BY_ZERO: "{a:g}{operator}{b:g} divides by zero.",
    rules.NO_VALUE: "{a:g} {operator} {b:g} has no finite value.",
    rules.NO_FUNCTION_VALUE: "{function}[{a:g}] has no value.",
    rules.NAME_NOT_CLOSED: "a name is not closed; add >.",
    rules.NOT_DEFINED: "parameter #{name} is not defined; set it before it is used.",
    rules.NOT_WHOLE: "The number of a parameter is {a:g}; expected a whole number.",
    rules.NO_PARAMETER: (
        f"#{{a:.0f}} does not exist; parameters run from 1 to {COUNT - 1}, and those of a control beyond, such as tool "
        "offsets, are not known here: write the value."
    ),
}
"""What is said for a problem of ``operator_rules``."""

_NUMBER = re.compile(r"([+-]*[0-9.]+),?(\d?)")
_NAME = re.compile(r"<[^>]*>?")


class Reader:
    """A line in lower case without blanks (outside comments), and how far it has been read.

    Every method raises GCodeError naming the line.
    """

    def __init__(self, text: str, line: int, store: Parameters, raw: str = "") -> None:
        self.text, self.raw = text, raw or text
        self.line = line
        self.at = 0
        self.store = store
        self.codes = value_rules.codes(text)

    def refuse(self, message: str) -> GCodeError:
        """The error to raise: ``message`` with the line in front."""
        return GCodeError.at(self.line, message)

    def rest(self, length: int = 20) -> str:
        """What comes next, for messages."""
        return self.text[self.at : self.at + length] or "the end of the line"

    def value(self) -> float:
        """A real value: number, ``[expression]``, ``#parameter`` or function."""
        codes = self.codes
        _, value, self.at = self.told(lambda: value_rules.value(self.store.arrays, codes, self.at, len(codes)))
        return float(value)

    def told(self, read: Callable[[], tuple[int, float, int]], first: int = 0) -> tuple[int, float, int]:
        """(problem, ..., where) that ``read`` answers once the machine has said the values it is asked for.

        ``first`` is where this line begins in what it reads. Raises GCodeError for a value that is refused.
        """
        store, asked = self.store, False
        while True:
            problem, answer, at = read()
            if problem not in (rules.ASK_NUMBER, rules.ASK_NAME):
                break
            asked = True
            try:
                store.ask(None if problem == rules.ASK_NUMBER else self._name_at(at - first))
            except GCodeError as exc:
                raise self.refuse(str(exc)) from None
        if asked:
            store.forget()
        if problem in SENTENCES:
            raise self._refused(problem, at - first)
        return problem, answer, at

    def integer(self, what: str) -> int:
        """A value within 0.0001 of an integer."""
        value = self.value()
        nearest = rules.whole(value)
        if math.isnan(nearest):
            raise self.refuse(f"{what} is {value:g}; expected a whole number.")
        return int(nearest)

    def name(self) -> str:
        """``<name>``, without the brackets."""
        end = value_rules.name_end(self.codes, self.at, len(self.codes))
        if end < 0:
            raise self._refused(rules.NAME_NOT_CLOSED, self.at)
        name = self.text[self.at + 1 : end]
        self.at = end + 1
        return name

    def _name_at(self, at: int) -> str:
        found = _NAME.match(self.text, at)
        return found[0][1:-1] if found is not None else ""

    def _refused(self, problem: int, at: int) -> GCodeError:
        foreign = said_of(self.raw, self.text, at) if problem == rules.NO_FUNCTION else ""
        if foreign:
            return self.refuse(foreign)
        a, b, operator = self.store.arrays.figures
        number = _NUMBER.match(self.text, at) or ("", "", "")
        return self.refuse(
            SENTENCES[problem].format(
                a=a,
                b=b,
                operator=rules.OPERATORS[int(operator)],
                function=rules.FUNCTIONS[int(b)].upper() if operator < 0.0 else "",
                number=number[1],
                comma=number[2],
                name=f"<{self._name_at(at)}>",
                rest=self.text[at : at + 20],
            )
        )
