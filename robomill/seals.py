"""Whether the machine code that was kept of a kernel is what was written: beside its files stands a digest of each.

A file cut short or changed is code that would end the process, or compute something else, without a word; so what does
not fit its seal is removed, and compiled anew.
"""

import hashlib
import os
import platform
import shutil
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any

SEAL, COMPLETE = ".seal", "complete"


def key(sources: Sequence[Path]) -> str:
    """A digest of all ``sources`` of kernels, the compiler and the processor: the compiler by itself looks only at a
    function's own file, and would keep running old code of the functions it calls."""
    state = hashlib.sha256(f"{sys.implementation.cache_tag} {version('numba')} {_processor()}".encode())
    for source in sources:
        state.update(source.name.encode() + source.read_bytes())
    return state.hexdigest()[:16]


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(errors="replace").splitlines()
    except OSError:
        return f"{platform.machine()} {platform.processor()}"
    return " ".join(sorted({line for line in lines if line.startswith(("model name", "flags", "Features"))}))


def seal(folder: Path, function: Callable[..., Any]) -> None:
    """Note what the files of ``function`` in the cache ``folder`` hold. Raises OSError where that cannot be written."""
    place, base = _place(folder, function), _base(function)
    files, note = _files(place, base), place / f"{base}.{os.getpid()}.new"
    if files:
        note.write_text("".join(f"{_digest(file)} {file.name}\n" for file in files))
        note.replace(place / f"{base}{SEAL}")


def sealed(folder: Path, function: Callable[..., Any]) -> bool:
    """Whether files of ``function`` are there, and as they were sealed."""
    return _holds(_place(folder, function), _base(function))


def remove(folder: Path, function: Callable[..., Any]) -> bool:
    """Take away the files of ``function`` and their seal, as far as that can be done; whether there were any."""
    return _remove(_place(folder, function), _base(function))


def heal(folder: Path) -> tuple[str, ...]:
    """Take away everything in ``folder`` that does not fit its seal; the names of the kernel modules it was of."""
    found = set()
    for note in sorted(folder.glob(f"*/*{SEAL}")):
        base = note.name.removesuffix(SEAL)
        if not _holds(note.parent, base):
            _remove(note.parent, base)
            found.add(f".{note.parent.name.rsplit('_', 1)[0]}.{base.split('.')[0]}")
    return tuple(sorted(found))


def finished(folder: Path) -> list[str]:
    """The kernel modules of which all code is in ``folder``."""
    try:
        return (folder / COMPLETE).read_text(errors="replace").split()
    except OSError:
        return []


def finish(folder: Path, names: Sequence[str]) -> None:
    """All code of these kernel modules is in ``folder``."""
    with suppress(OSError):
        note = folder / f"{COMPLETE}.{os.getpid()}"
        note.write_text("\n".join(names) + "\n")
        note.replace(folder / COMPLETE)


def _base(function: Callable[..., Any]) -> str:
    """How the compiler's names of its files begin: module and function."""
    return f"{Path(function.__code__.co_filename).stem}.{function.__qualname__}"


def _place(folder: Path, function: Callable[..., Any]) -> Path:
    """The compiler's folder for the package ``function`` is in: its name, and a digest of where it lies."""
    package = os.path.dirname(os.path.abspath(function.__code__.co_filename))
    return folder / f"{os.path.basename(package)}_{hashlib.sha1(package.encode()).hexdigest()}"


def _files(place: Path, base: str) -> list[Path]:
    return sorted(place.glob(f"{base}-*.nb[ic]"))


def _holds(place: Path, base: str) -> bool:
    try:
        said = [line.split(" ", 1) for line in (place / f"{base}{SEAL}").read_text(errors="replace").splitlines()]
        return bool(said) and said == [[_digest(file), file.name] for file in _files(place, base)]
    except OSError:
        return False


def _remove(place: Path, base: str) -> bool:
    there = [file for file in (*_files(place, base), place / f"{base}{SEAL}") if os.path.lexists(file)]
    for file in there:
        with suppress(OSError):
            shutil.rmtree(file) if file.is_dir() else file.unlink()
    return bool(there)


def _digest(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()
