"""Compiled kernels: what marks one, where its machine code is kept, what is not compiled yet, and who compiles it.

A kernel module is an ordinary module called ``kernels`` or ``*_kernels``, of plain Python:

    @part                                             # compiled into the kernels that call it
    def squared(x: float) -> float: ...

    @kernel                                           # an entry point: compiled for the types of its annotations at
    def norms(p: In2, norm: Out1) -> None: ...        # its first call, or loaded from disk

    @kernel(few=8)                                    # likewise; but up to eight rows of its first argument run as the
    def lengths(p: In2, length: Out1) -> None: ...    # Python they are written in, where no compiler is loaded yet

The first call compiles what the cache on disk does not hold: correct, only slow. A program that talks to people says
so: a command line by ``announce(print)``, a screen by ``missing()`` and ``build()``. ``python -m robomill.compiled``
compiles all. What is damaged in the cache is made anew (``seals``); where nothing can be kept, code lives in memory;
and where there is no compiler (Python in a browser), all runs as the Python it is written in.
"""

from __future__ import annotations

import logging
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from concurrent import futures
from contextlib import suppress
from functools import cache, partial
from importlib import import_module
from importlib.util import find_spec
from itertools import compress
from pathlib import Path
from typing import Annotated, Any, NamedTuple, TypeVar, get_args, get_origin, get_type_hints, overload

import numpy as np

from robomill import seals
from robomill.arrays import BoolArray, FloatArray, IntArray
from robomill.lazy import cached_property
from robomill.seals import COMPLETE

PACKAGE = Path(__file__).parent
PATTERNS = ("*/**/kernels.py", "*/**/*_kernels.py")
RULES = "*/**/*_rules.py"  # plain Python that kernels compile too
IMPORTED = re.compile(r"^from robomill\.([\w.]+) import", re.MULTILINE)
WORDS = "Preparing the kernels, once, up to a minute"
COMPILER = "numba"
FEW = 8  # configurations or poses: some milliseconds of plain Python
PLACE = "ROBOMILL_CACHE"
ROOM = 1 << 16  # bytes that must find room where code is kept
KEPT_FOLDERS = 4  # of older sources: so many stay beside the one in use
# No reciprocals or reassociation: only a * b + c in one rounding.
OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract"}, "no_cfunc_wrapper": True}

F = TypeVar("F", bound=Callable[..., Any])
_parts: list[Callable[..., Any]] = []  # marked, and not yet known to the compiler
_called: set[Callable[..., Any]] = set()
_lessons: list[Callable[[], None]] = []  # for the compiler, before it compiles anything
_lock = threading.RLock()  # around the compiler's configuration
_building = threading.Lock()
_tried = False
_kept = True  # False once machine code could not be kept on disk
_announced: list[Callable[[str], Any]] = []


class Axes(NamedTuple):
    """An array a kernel takes: C-ordered, ``dims`` axes of ``dtype``; read only unless it is there to be written.

    ``dtype`` is the name of a number's type, or a record's.
    """

    dtype: str | np.dtype[Any]
    dims: int
    written: bool = False


In1 = Annotated[FloatArray, Axes("float64", 1)]
In2 = Annotated[FloatArray, Axes("float64", 2)]
In3 = Annotated[FloatArray, Axes("float64", 3)]
InInt1 = Annotated[IntArray, Axes("int64", 1)]
InBool1 = Annotated[BoolArray, Axes("bool_", 1)]
InBool2 = Annotated[BoolArray, Axes("bool_", 2)]
Out1 = Annotated[FloatArray, Axes("float64", 1, written=True)]
Out2 = Annotated[FloatArray, Axes("float64", 2, written=True)]
Out3 = Annotated[FloatArray, Axes("float64", 3, written=True)]
Out4 = Annotated[FloatArray, Axes("float64", 4, written=True)]
OutInt1 = Annotated[IntArray, Axes("int64", 1, written=True)]
OutBool2 = Annotated[BoolArray, Axes("bool_", 2, written=True)]


def part(function: F) -> F:
    """Mark a function that kernels call: compiled into each of them, for the types it is called with."""
    _parts.append(function)
    return function


def called(function: F) -> F:
    """Mark a long part that is called where it is used, not copied there: compiled once for all its callers."""
    _called.add(function)
    return part(function)


def taught(lesson: Callable[[], None]) -> None:
    """Have the compiler taught something that kernels need: called once it is loaded, before it compiles."""
    _lessons.append(lesson)


@overload
def kernel(function: Callable[..., Any]) -> Kernel: ...
@overload
def kernel(*, few: int) -> Callable[[Callable[..., Any]], Kernel]: ...
def kernel(function: Any = None, *, few: int = 0) -> Any:
    """Mark an entry point, which becomes a ``Kernel``."""
    return Kernel(function, few) if function is not None else partial(Kernel, few=few)


class Kernel:
    """An entry point, compiled at its first call for the types of its annotations, or loaded from the cache on disk.

    Annotations: float, complex, int, bool, the aliases of this module (``In2``, ``Out3``, ...), tuples of these, and
    NamedTuples whose fields are annotated so. ``few``: so many rows of the first argument are done before the compiler
    is loaded (half a second), so they run as plain Python unless something else has loaded it.
    """

    def __init__(self, function: Callable[..., Any], few: int = 0) -> None:
        self.plain, self.few = function, few
        self.__name__, self.__doc__ = function.__name__, function.__doc__

    def __call__(self, *arguments: Any) -> Any:
        if self.few and COMPILER not in sys.modules and len(arguments[0]) <= self.few:
            return self.as_written(*arguments)
        return self.code(*arguments)

    def as_written(self, *arguments: Any) -> Any:
        """What the machine code does, done by the Python it is made from."""
        with np.errstate(all="ignore"):  # as compiled code does: NaN in, NaN out
            return self.plain(*arguments)

    @cached_property
    def code(self) -> Any:
        """The machine code: made once, however many threads ask for it at the same moment."""
        with _lock:
            if "code" not in vars(self):  # another thread may have made it while this one waited
                vars(self)["code"] = self._made()
            return vars(self)["code"]

    def _made(self) -> Any:
        """Compiled or loaded. An entry of the cache that is not as it was written is removed and made again."""
        if find_spec(COMPILER) is None:
            return self.as_written
        from numba import config

        if _announced:
            prepare()
        folder = kept_in()
        if folder is None or not _kept:
            return _compile(self.plain, keep=False)
        before = config.CACHE_DIR  # type: ignore[attr-defined]
        config.CACHE_DIR = str(folder)  # type: ignore[attr-defined]
        try:
            return self._kept(folder)
        finally:
            config.CACHE_DIR = before  # type: ignore[attr-defined]

    def _kept(self, folder: Path) -> Any:
        from numba.core.errors import NumbaError

        if not seals.sealed(folder, self.plain) and seals.remove(folder, self.plain):
            _say()
        for last in (False, True):
            try:
                code = _compile(self.plain)
                if not seals.sealed(folder, self.plain):
                    seals.seal(folder, self.plain)
                return code
            except NumbaError:
                raise
            except Exception as exc:  # a full disk, a shut folder, a file in the way; code that another compiler wrote
                seals.remove(folder, self.plain)
                if last or isinstance(exc, OSError):
                    _cannot_keep(f"{folder}: {exc}")
                    break
        return _compile(self.plain, keep=False)


def _compile(function: Callable[..., Any], keep: bool = True) -> Any:
    from numba import njit
    from numba.extending import register_jitable

    options: dict[str, Any] = {**OPTIONS, "_nrt": False}  # no counting of references to arrays
    while _lessons:
        _lessons.pop()()
    while _parts:
        marked = _parts.pop()
        register_jitable(**options, forceinline=marked not in _called)(marked)
    return njit(_signature(function), cache=keep, nogil=True, **OPTIONS)(function)


def _signature(function: Callable[..., Any]) -> Any:
    hints = get_type_hints(function, include_extras=True)
    returned = _numba_type(hints.pop("return"))
    return returned(*map(_numba_type, hints.values()))


def _numba_type(hint: Any) -> Any:
    from numba import from_dtype, types

    plain = {
        float: types.float64,
        complex: types.complex128,
        int: types.int64,
        bool: types.boolean,
        type(None): types.void,
    }
    if hint in plain:
        return plain[hint]
    if get_origin(hint) is Annotated:
        axes = get_args(hint)[1]
        element = getattr(types, axes.dtype) if isinstance(axes.dtype, str) else from_dtype(axes.dtype)
        return types.Array(element, axes.dims, "C", readonly=not axes.written)
    if get_origin(hint) is tuple:
        return types.Tuple([_numba_type(item) for item in get_args(hint)])
    fields = [_numba_type(item) for item in get_type_hints(hint, include_extras=True).values()]
    return types.BaseTuple.from_types(fields, hint)  # fields of one type make another kind of tuple


# ---- where machine code is kept ------------------------------------------------------------------------------------


def modules() -> tuple[str, ...]:
    """The names of all kernel modules."""
    return tuple(".".join(source.relative_to(PACKAGE.parent).with_suffix("").parts) for source in _sources())


def _sources() -> list[Path]:
    return sorted({source for pattern in PATTERNS for source in PACKAGE.glob(pattern)})


@cache
def kept_in() -> Path | None:
    """The folder of the machine code of these sources, this Python, this compiler and this processor.

    Where ROBOMILL_CACHE says, else beside the package where that can be written, else in the user's cache, else in a
    private temporary folder; None where nothing can be written or compiled.
    """
    if find_spec(COMPILER) is None:
        return None
    name = f"kernels-{seals.key(_made_from())}"
    places = [root / name for root in _roots()]
    folder = next((place for place in places if _own(place)), None)
    if folder is None:
        folder = _private(name)
    if folder is None:
        _cannot_keep("no folder can be written")
        return None
    made = next((place for place in places if (place / COMPLETE).is_file()), folder)
    if made != folder:  # by whoever installed the package; the compiler wants to write where it reads
        with suppress(OSError):  # what was not copied is compiled
            shutil.copytree(made, folder, dirs_exist_ok=True)
    _forget_older(folder)
    return folder


def _made_from() -> list[Path]:
    """The kernel modules, rules, and what both import from this package (constants, kinds of tuples, laws)."""
    own = {*_sources(), *PACKAGE.glob(RULES)}
    named = {name for source in own for name in IMPORTED.findall(source.read_text())}
    imported = {PACKAGE.joinpath(*name.split(".")).with_suffix(".py") for name in named}
    return sorted({*own, *(path for path in imported if path.is_file())})


def _roots() -> Iterator[Path]:
    if os.environ.get(PLACE):
        yield Path(os.environ[PLACE])
    yield PACKAGE / "__pycache__"
    yield Path(os.path.expanduser("~")) / ".cache" / "robomill"  # where Path.home() may refuse


def _own(folder: Path) -> bool:
    """Whether the folder stands, made if need be, and can be written: a full disk still makes empty files."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(bytes(ROOM))
    except OSError:
        return False
    return True


def _private(name: str) -> Path | None:
    """A folder of this process and of those that it starts, which inherit its place."""
    try:
        root = tempfile.mkdtemp(prefix="robomill-")
    except OSError:
        return None
    folder = Path(root) / name
    if not _own(folder):
        return None
    os.environ[PLACE] = root
    return folder


def _cannot_keep(why: str) -> None:
    """From now on code lives in memory; said once."""
    global _kept
    if _kept:
        logging.getLogger("robomill").warning("Compiled code cannot be kept (%s): it is compiled at every start.", why)
    _kept = False


def _forget_older(folder: Path) -> None:
    others = [other for other in folder.parent.glob("kernels-*") if other != folder]
    others.sort(key=lambda other: other.stat().st_mtime if other.exists() else 0.0)
    for other in others[:-KEPT_FOLDERS]:
        shutil.rmtree(other, ignore_errors=True)


# ---- what is missing, and making it ----------------------------------------------------------------------------------


def missing() -> tuple[str, ...]:
    """The kernel modules that nobody has compiled for this machine yet, or whose code was found damaged; cheap, without
    the compiler. None of them where nothing can be kept."""
    folder = kept_in()
    if folder is None or not _kept:
        return ()
    _heal(folder)
    done = seals.finished(folder)
    return tuple(name for name in modules() if name not in done)


@cache
def _heal(folder: Path) -> None:
    """Once: what is damaged is removed and counts as missing."""
    lost = seals.heal(folder)
    if lost:
        seals.finish(folder, [name for name in seals.finished(folder) if not name.endswith(lost)])


def build(*names: str) -> None:
    """Compile what is missing, of all or some, in a process of its own (this one stays small); returns when done.

    All are tried once: where no process can be had nothing is lost, kernels are compiled as they are imported."""
    global _tried
    with _building:
        if _tried or not set(names or modules()) & set(missing()):
            return
        _tried = not names
        there = {**os.environ, "PYTHONPATH": os.pathsep.join(path or os.getcwd() for path in sys.path)}
        command = [sys.executable, "-m", "robomill.compiled", *names]
        with suppress(OSError, subprocess.SubprocessError):
            subprocess.run(command, check=False, capture_output=True, timeout=600, env=there)


def compile_all(names: tuple[str, ...] = (), processes: int = 1) -> None:
    """Compile or load every kernel, or those of some modules, by several processes, and note that they are there."""
    folder, names, kept = kept_in(), names or modules(), None
    if min(processes, len(names)) > 1:
        with suppress(OSError, RuntimeError, ImportError), futures.ProcessPoolExecutor(processes) as pool:
            kept = list(pool.map(_compiled, names))
    kept = kept or [_compiled(name) for name in names]  # where no other process is needed, or can be had
    if folder is not None:
        seals.finish(folder, sorted({*seals.finished(folder), *compress(names, kept)}))


def _compiled(name: str) -> bool:
    """Whether all kernels of a module are compiled or loaded, and kept; whoever needs one that is not compiles it."""
    for entry in vars(import_module(name)).values():
        if kept_in() is None or not _kept:
            return False
        if isinstance(entry, Kernel):
            entry.code  # noqa: B018
    return _kept


def announce(say: Callable[[str], Any] | None) -> None:
    """From now on the first kernel that is needed and missing has ``say(WORDS)`` called, then all are built."""
    _announced[:] = [] if say is None else [say]


def prepare() -> None:
    """Build what is missing, aloud, before processes begin that would each compile it."""
    if missing() and not _tried:
        _say()
        build()


def _say() -> None:
    if _announced:
        _announced[-1](WORDS)


if __name__ == "__main__":
    # This file by its own name: what it marks is known there.
    import_module("robomill.compiled").compile_all(tuple(sys.argv[1:]), min(os.cpu_count() or 1, 2))
