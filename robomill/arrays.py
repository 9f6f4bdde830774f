"""Arrays at the door: shape and finiteness checks, read-only copies, canonical digests."""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomill.errors import RobomillError

T = TypeVar("T")
FloatArray = NDArray[np.float64]


class Arrays(Protocol):
    """What NumPy makes an array of: its own, a column of pandas, a variable of xarray."""

    def __array__(self) -> NDArray[Any]: ...


# As people write them: of [[0, 0, -2], [1.5, 0, -2]] a type checker sees numbers only where it is told to.
Numbers = Arrays | Sequence[float]
Rows = Arrays | Sequence[Arrays | Sequence[float]]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]
NO_NUMBERS = (TypeError, ValueError, OverflowError)
"""What NumPy and Python raise of what is no number, or larger than any."""
UNREAL = "cmM"  # kinds of arrays that NumPy would make numbers of: complex ones, and times
PLAIN = (str, int, float, bytes)  # nobody writes into these
DIGITS = 13  # of a number that tell it from another
SMALLEST = 1e-290  # below it, no power of ten brings thirteen digits before the point
TYPED = 100_000  # cells: larger arrays are no lists that people type, and are told apart to the last bit
FARTHEST = 1e4  # m from the base of a robot or the zero of a part


def of_kind(value: Any, kinds: type | tuple[type, ...], name: str, give: str, error: type[RobomillError]) -> None:
    """Refuse a ``value`` of another kind, with what to ``give`` instead: what is called later would only crash."""
    if not isinstance(value, kinds):
        first = kinds[0] if isinstance(kinds, tuple) else kinds
        what = "a text" if first is str else with_article(first.__name__)
        rest = "." if give == what else f"; give {give}."
        raise error(f"{name}: expected {what}, found {brief(value)}{rest}")


def as_floats(
    value: ArrayLike,
    name: str,
    shape: tuple[int | None, ...],
    *,
    error: type[RobomillError] = RobomillError,
    finite: bool = True,
    one: bool = False,
) -> FloatArray:
    """``value`` as float64 whose *trailing* axes match ``shape`` (None: any length).

    Leading axes are free, but of ``one`` thing, which has none. Raises ``error`` with what was found and expected.
    """
    try:
        found = np.asarray(value)
        if value is None or found.dtype.kind in UNREAL or np.ma.is_masked(value):
            raise TypeError
        array = found.astype(np.float64, copy=False)
    except NO_NUMBERS as exc:
        raise error(f"{name}: expected numbers, found {no_number(value) or brief(value)}.") from exc
    fits = array.ndim == len(shape) or (array.ndim > len(shape) and not one)
    trailing = array.shape[array.ndim - len(shape) :] if fits else None
    if trailing is None or any(w is not None and w != h for w, h in zip(shape, trailing, strict=True)):
        want = ", ".join("any" if s is None else str(s) for s in shape)
        turned = array.ndim == len(shape) == 2 and shape[0] is None and array.shape[0] == shape[1]
        ask = ": is it transposed?" if turned else "."
        raise error(f"{name}: expected shape ({'' if one else '..., '}{want}), found {array.shape}{ask}")
    if finite and not np.isfinite(array).all():
        raise error(f"{name}: expected finite numbers, found NaN or infinity.")
    return array


def next_true(which: BoolArray, otherwise: int) -> IntArray:
    """(m,) where, from each place of ``which`` (m,) on, the first True stands; ``otherwise`` where none does."""
    first = np.where(which, np.arange(len(which)), otherwise)[::-1]
    return np.asarray(np.minimum.accumulate(first)[::-1])


def stretches(which: BoolArray) -> IntArray:
    """(r, 2): where each run of True in ``which`` (m,) begins, and the place past its end."""
    return np.flatnonzero(np.diff(which, prepend=False, append=False)).reshape(-1, 2)


def is_unreal(value: Any) -> bool:
    """Whether NumPy would take for numbers what is none: True and False alone or in lists, complex, masked, dates."""
    if isinstance(value, np.ndarray):
        return value.dtype.kind in UNREAL or bool(np.ma.is_masked(value))
    if isinstance(value, list | tuple):
        return any(map(is_unreal, value))
    return isinstance(value, bool | np.bool_ | complex | np.complexfloating)


def no_number(value: Any) -> str:
    """What in ``value`` is no number: the first such thing, or rows that differ in length; "" where all are numbers."""
    if np.ma.is_masked(value):
        return "a masked entry, which is no number"
    if isinstance(value, Sequence | np.ndarray) and not isinstance(value, str | bytes):
        lengths = {len(row) for row in value if isinstance(row, Sequence | np.ndarray) and not isinstance(row, str)}
        uneven = f"rows of {' and '.join(map(str, sorted(lengths)))}" if len(lengths) > 1 else ""
        return next((found for each in value if (found := no_number(each))), uneven)
    if is_unreal(value):
        return brief(value)
    try:
        float(value)
    except NO_NUMBERS:
        return brief(value)
    return ""


def brief(value: Any, most: int = 60) -> str:
    """What was found, on one line and no longer than that; by its kind, what would only show an address or a table."""
    kind = type(value)
    if isinstance(value, Iterator):
        return f"{with_article(kind.__name__)}, which is read once only: give a list or an array"
    if kind.__repr__ is object.__repr__ or kind.__module__.partition(".")[0] in ("pandas", "xarray"):
        return with_article(kind.__name__)
    try:
        return " ".join(f"{value!r:.{4 * most}}".split())[:most]
    except ValueError:  # Python writes no whole number of more than 4300 digits
        return "a whole number of thousands of digits"


def with_article(name: str) -> str:
    """A noun with its article: ``a list``, ``an Arc``."""
    return f"{'an' if name[:1] in 'AEIOUaeiou' else 'a'} {name}"


def check_place(p: ArrayLike, name: str, error: type[RobomillError]) -> None:
    """Refuse a place (..., 3) m that is farther off than a machine can be, where rounding would eat all else."""
    farthest = float(np.abs(p).max())
    if not farthest <= FARTHEST:
        raise error(f"{name}: it lies {farthest:.3g} m off; expected {FARTHEST:g} m at most.")


def frozen(array: ArrayLike, dtype: Any = np.float64) -> NDArray[Any]:
    """A read-only, C-contiguous copy, for fields of frozen dataclasses (an array that is one already stays)."""
    if isinstance(array, np.ndarray) and array.dtype == np.dtype(dtype) and _is_frozen(array):
        return array
    copy = np.array(array, dtype=dtype, order="C")
    return shut(copy)


def shut(array: NDArray[Any]) -> NDArray[Any]:
    """The same numbers in an array that nobody can make writable again: NumPy asks whoever owns the memory."""
    array.flags.writeable = False
    return array.view() if array.base is None else array


def made_array(default: Any = None) -> Any:
    """The default of a field that holds an array, of which ``__post_init__`` makes one."""
    return default


def sealed(value: T) -> T:
    """The same value, read-only from now on: an array, or every array that a dataclass or a sequence holds.

    Dataclasses that see to it themselves say so by ``seals_itself``.
    """
    if value is None or isinstance(value, PLAIN) or getattr(value, "seals_itself", False):
        pass
    elif isinstance(value, np.ndarray):
        value.flags.writeable = False
    elif is_dataclass(value) and not isinstance(value, type):
        for field in fields(value):
            sealed(getattr(value, field.name))
    elif isinstance(value, Mapping):
        sealed(tuple(value.values()))
    elif isinstance(value, tuple | list):
        for item in value:
            sealed(item)
    return value


def _is_frozen(array: NDArray[Any]) -> bool:
    base = array.base
    whole = isinstance(base, np.ndarray) and base.base is None and base.size == array.size
    owned = base is None or (whole and not base.flags.writeable)
    return owned and bool(array.flags.c_contiguous) and not array.flags.writeable


def digest(value: Any) -> str:
    """SHA-256 over canonical bytes of dataclasses, mappings, sequences, arrays and scalars.

    Equal values give equal digests on every machine. Every cell of an array counts, and thirteen digits of a number:
    0.7 m, 700 mm and 700 * 1e-3 are one length, though their last bits differ.
    """
    state = hashlib.sha256()
    _feed(state, value)
    return state.hexdigest()


def _told(numbers: FloatArray) -> FloatArray:
    """Numbers as a digest tells them: thirteen digits and a power of ten each, in two rows; what has none, as it is."""
    plain = np.isfinite(numbers) & (np.abs(numbers) > SMALLEST)
    some = np.where(plain, numbers, 1.0)
    power = np.floor(np.log10(np.abs(some)))
    digits = np.rint(some * 10.0 ** (DIGITS - 1 - power))
    carried = np.abs(digits) == 10.0**DIGITS  # 9.99... rounded up
    told = np.where(plain, np.where(carried, digits / 10.0, digits), numbers + 0.0)
    return np.stack([told, np.where(plain, power + carried, 0.0)])


def _feed(state: Any, value: Any) -> None:
    if isinstance(value, np.ndarray):
        array = np.ascontiguousarray(value)
        little = array.astype(array.dtype.newbyteorder("<"), copy=False)
        state.update(f"a{little.dtype.str}{little.shape}".encode())
        typed = little.dtype.str == "<f8" and little.size <= TYPED
        state.update((_told(little) if typed else little).tobytes())
    elif is_dataclass(value) and not isinstance(value, type):
        state.update(f"d{type(value).__name__}(".encode())
        for field in fields(value):
            if field.compare:
                state.update(field.name.encode() + b"=")
                _feed(state, getattr(value, field.name))
        state.update(b")")
    elif isinstance(value, Mapping):
        state.update(b"m(")
        for key in sorted(value, key=repr):
            _feed(state, key)
            _feed(state, value[key])
        state.update(b")")
    elif isinstance(value, Sequence) and not isinstance(value, str | bytes):
        state.update(f"s{len(value)}(".encode())
        for item in value:
            _feed(state, item)
        state.update(b")")
    elif isinstance(value, frozenset):
        _feed(state, sorted(value, key=repr))
    elif isinstance(value, bool | np.bool_):
        state.update(b"b1" if value else b"b0")
    elif isinstance(value, int | np.integer):
        state.update(f"i{int(value)}".encode())
    elif isinstance(value, float | np.floating):
        state.update(f"f{float(value) + 0.0:.{DIGITS - 1}e}".encode())
    elif isinstance(value, str):
        state.update(f"t{len(value)}:{value}".encode())
    elif isinstance(value, bytes):
        state.update(f"y{len(value)}:".encode() + value)
    elif value is None:
        state.update(b"n")
    else:
        raise TypeError(f"digest: no canonical bytes for {type(value).__name__}")
