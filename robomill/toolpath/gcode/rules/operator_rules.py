"""The rules of operators and functions, and why a value can be refused; ``motion_rules`` says what rules are.

Problems are codes, 0 for none; ``expressions.SENTENCES`` says what each means, with the numbers that are left in
``s.figures``.
"""

# mypy: disable-error-code="no-untyped-def, no-untyped-call"

import math

from robomill.units import to_si

EQUAL = 1e-4
"""Two numbers are EQ if they differ by less than this; a number that differs from a whole one by less is whole."""

DEGREE = to_si(1.0, "deg")
_MOST = 1e15
_MOST_LOG = 709.7
"""exp of more than this is no finite number."""

(
    NOT_A_NUMBER,
    DECIMAL_COMMA,
    TOO_LARGE,
    NOTHING,
    TOO_DEEP,
    NOT_CLOSED,
    NO_OPERATOR,
    NO_FUNCTION,
    NO_ARGUMENT,
    ONE_ARGUMENT,
    EXISTS_OF_WHAT,
    EXISTS_NOT_CLOSED,
    BY_ZERO,
    NO_VALUE,
    NO_FUNCTION_VALUE,
    NAME_NOT_CLOSED,
    NOT_DEFINED,
    NOT_WHOLE,
    NO_PARAMETER,
    ASK_NUMBER,
    ASK_NAME,
) = range(1, 22)
"""Why there is no value; the last two: the machine has to be asked for it."""

OPERATORS = ("]", "and", "or", "xor", "eq", "ne", "ge", "le", "gt", "lt", "+", "-", "*", "/", "mod", "**")
CLOSE, AND, OR, XOR, EQ, NE, GE, LE, GT, LT, PLUS, MINUS, TIMES, OVER, MOD, POWER = range(len(OPERATORS))
BINDS = (1, 2, 2, 2, 3, 3, 3, 3, 3, 3, 4, 4, 5, 5, 5, 6)
FUNCTIONS = ("abs", "acos", "asin", "atan", "cos", "exists", "exp", "fix", "fup", "ln", "round", "sin", "sqrt", "tan")
ABS, ACOS, ASIN, ATAN, COS, EXISTS, EXP, FIX, FUP, LN, ROUND, SIN, SQRT, TAN = range(len(FUNCTIONS))


def whole(value: float) -> float:
    """The whole number next to ``value``; NaN if none is near."""
    if not abs(value) < _MOST:
        return value
    near = float(math.floor(value + 0.5))
    return near if abs(value - near) <= EQUAL else math.nan


def combined(s, operator: int, a: float, b: float):
    """(problem, value) of ``a`` operator ``b``."""
    s.figures[0], s.figures[1], s.figures[2] = a, b, operator
    if operator == PLUS:
        return 0, a + b
    if operator == MINUS:
        return 0, a - b
    if operator == TIMES:
        return 0, a * b
    if operator == OVER:
        return (BY_ZERO, 0.0) if b == 0.0 else (0, a / b)
    if operator == POWER:
        return _power(a, b)
    if operator == MOD:  # LinuxCNC's is never negative, other controls' has the sign of what is divided
        rest = (abs(a) if s.towards_zero else a) % abs(b) if b != 0.0 else math.nan
        rest = -rest if s.towards_zero and a < 0.0 else rest
        return (0 if math.isfinite(rest) else NO_VALUE), rest
    if s.by_bits and operator in (AND, OR, XOR):
        return _by_bits(operator, whole(a), whole(b))
    return 0, 1.0 if _holds(operator, a, b) else 0.0


def _by_bits(operator: int, a: float, b: float):
    if not (abs(a) < _MOST and abs(b) < _MOST):  # or no whole number
        return NO_VALUE, 0.0
    first, second = int(a), int(b)
    if operator == AND:
        return 0, float(first & second)
    return 0, float(first | second) if operator == OR else float(first ^ second)


def _power(a: float, b: float):
    if a < 0.0 and b % 1.0 != 0.0:
        return NO_VALUE, 0.0
    if a == 0.0:
        return (BY_ZERO if b < 0.0 else 0), 1.0 if b == 0.0 else 0.0
    return (NO_VALUE, 0.0) if b * math.log(abs(a)) > _MOST_LOG else (0, a**b)


def _holds(operator: int, a: float, b: float) -> bool:
    if operator == AND:
        return a != 0.0 and b != 0.0
    if operator == OR:
        return a != 0.0 or b != 0.0
    if operator == XOR:
        return (a != 0.0) != (b != 0.0)
    if operator == EQ:
        return abs(a - b) < EQUAL
    if operator == NE:
        return abs(a - b) >= EQUAL
    if operator == GE:
        return a >= b
    if operator == LE:
        return a <= b
    if operator == GT:
        return a > b
    return operator == LT and a < b


def applied(s, function: int, x: float):
    """(problem, value) of a function of one argument."""
    s.figures[0], s.figures[1], s.figures[2] = x, function, -1.0
    if function == EXISTS:
        near = whole(x)
        return (NOT_WHOLE if math.isnan(near) else 0), 1.0 if 1.0 <= near < len(s.numbered) else 0.0
    value = _function(function, x)
    if s.towards_zero and x < 0.0 and function in (FIX, FUP):  # the whole number nearer to 0, or farther from it
        value = -_function(function, -x)
    return (0 if math.isfinite(value) else NO_FUNCTION_VALUE), value


def _function(function: int, x: float) -> float:
    if function == ABS:
        return abs(x)
    if function in (ACOS, ASIN):
        if abs(x) > 1.0:
            return math.nan
        return (math.acos(x) if function == ACOS else math.asin(x)) / DEGREE
    if function == COS:
        return math.cos(x * DEGREE)
    if function == SIN:
        return math.sin(x * DEGREE)
    if function == TAN:
        return math.tan(x * DEGREE)
    if function == EXP:
        return math.exp(x) if x < _MOST_LOG else math.inf
    if function == LN:
        return math.log(x) if x > 0.0 else math.nan
    if function == SQRT:
        return math.sqrt(x) if x >= 0.0 else math.nan
    if abs(x) >= _MOST:  # is whole
        return x
    if function == FIX:
        return float(math.floor(x))
    if function == FUP:
        return float(math.ceil(x))
    return float(math.trunc(x + math.copysign(0.5, x))) if function == ROUND else math.nan
