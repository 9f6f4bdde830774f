"""The samples: where they lie (beside the package in a checkout, inside it in an installed wheel), and their names."""

import shutil
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import Literal

from robomill.arguments import asked
from robomill.errors import ProjectError, RobomillError
from robomill.files import check_place

SampleKind = Literal["set-up", "robot", "program", "load tests", "material", "drawing", "study", "answers"]
TITLED: tuple[SampleKind, ...] = ("set-up", "robot", "material", "study")  # TOML files, which say what they are called


@dataclass(frozen=True)
class Sample:
    """A file (of answers: a folder) that comes with robomill: ``name`` is what commands take for it."""

    kind: SampleKind
    name: str
    path: Path

    @property
    def title(self) -> str:
        """What it is called in its own words; the name of its file where it has none."""
        if self.kind not in TITLED:
            return self.path.name
        data = tomllib.loads(self.path.read_text(encoding="utf-8"))
        return str(data.get("title") or data.get("name") or self.path.name)


def app_dir() -> Path:
    """Folder that holds app.py, pages/, samples/ and .streamlit/."""
    package = Path(__file__).resolve().parent.parent
    installed = package / "_app"
    return installed if installed.is_dir() else package.parent


def samples_dir() -> Path:
    """Folder of the samples: robots/, materials/ and one folder a case."""
    return app_dir() / "samples"


@cache
def samples() -> tuple[Sample, ...]:
    """The samples that come with robomill, by kind and name.

    Returns
    -------
    tuple of Sample
        Each with ``kind``, ``name`` and ``path``. A case is called as its folder, other set-ups of it ``folder/file``.

    Examples
    --------
    >>> import robomill as rm
    >>> [sample.name for sample in rm.samples() if sample.kind == "program"]
    ['heart', 'paper_flute', 'pocket_arcs', 'spiral', 'two_tools', 'word']
    """
    return tuple(_found(samples_dir()))


def _found(folder: Path) -> Iterator[Sample]:
    for path in sorted(folder.glob("*/setup*.toml")):
        case = path.parent.name
        yield Sample("set-up", case if path.stem == "setup" else f"{case}/{path.stem}", path)
    for path in sorted(folder.glob("*/study*.toml")):
        yield Sample("study", f"{path.parent.name}/{path.stem}", path)
    for path in sorted(folder.glob("*/*.nc")):
        yield Sample("program", path.parent.name, path)
    for path in sorted(folder.glob("drawings/*.dxf")) + sorted(folder.glob("drawings/*.svg")):
        yield Sample("drawing", path.stem if path.suffix == ".dxf" else path.name, path)
    yield Sample("answers", "answers", folder / "answers/class")
    kinds: tuple[tuple[SampleKind, str], ...] = (
        ("robot", "robots/*.toml"),
        ("load tests", "load_tests/*.csv"),
        ("material", "materials/*.toml"),
    )
    for kind, pattern in kinds:
        for path in sorted(folder.glob(pattern)):
            yield Sample(kind, path.stem, path)


def sample_names(kind: SampleKind) -> list[str]:
    """Names of the samples of a kind."""
    return [sample.name for sample in samples() if sample.kind == kind]


def find_sample(kind: SampleKind, name: str | Path) -> Path | None:
    """The file of a sample by its name; None where ``name`` is none, or is a file or folder that stands there."""
    called = str(name)
    found = next((sample.path for sample in samples() if sample.kind == kind and sample.name == called), None)
    return None if found is None or Path(called).exists() else found


def sample_or_file(kind: SampleKind, name: str | Path, error: type[RobomillError]) -> Path:
    """The file of a sample, or the one named. Raises ``error`` for a mere name that is neither, with those known."""
    check_place(name, f"a file, or the name of a {kind} that comes with robomill", error)
    if not str(name).strip():
        raise error(f"The name of the {kind} is empty; give a file, or one of {', '.join(sample_names(kind))}.")
    path = find_sample(kind, name) or Path(name)
    if path.suffix or len(path.parts) != 1 or path.exists():
        return path
    names = sample_names(kind)
    close = get_close_matches(str(name).lower(), names, 1, 0.5)
    other = next((sample for sample in samples() if sample.name == str(name).lower()), None)
    is_one = "" if other is None else "are load tests" if other.kind == "load tests" else f"is a {other.kind}"
    meant = f"; {other.name!r} {is_one}" if other and other.kind != kind else ""
    meant = meant or (f"; did you mean {close[0]!r}?" if close else "")
    refusal = error(
        f"{str(name)!r:.80}: there is no such file here and no {kind} of this name; those that come with robomill are "
        f"{', '.join(names)}{meant}{'' if meant.endswith('?') else '.'}"
    )
    refusal.where = str(name)
    raise refusal


@asked
def copy_samples(folder: str | Path, names: Sequence[str] = ()) -> list[Path]:
    """Copy samples, with what lies beside them, into a folder of one's own.

    Parameters
    ----------
    folder : str or Path
        Where they shall stand, as they lie here; what is there already and is the same stays.
    names : sequence of str
        Which; left out: all.

    Returns
    -------
    list of Path
        The copies.

    Raises
    ------
    ProjectError
        Before anything is copied, for a name that is none, and for a file that is there and is another.

    Examples
    --------
    >>> import tempfile
    >>> import robomill as rm
    >>> sorted(path.name for path in rm.copy_samples(tempfile.mkdtemp(), ["slavkovic_5r", "nine_points"]))
    ['nine_points.csv', 'slavkovic_5r.toml']
    """
    if not str(folder).strip():
        raise ProjectError("The folder to copy to has no name; give one, or . for the folder you are in.")
    here, there = samples_dir(), Path(folder)
    chosen = {path: there / path.relative_to(here) for path in _to_copy(here, names)}
    for path, copy in chosen.items():
        if copy.exists() and not (copy.is_file() and copy.read_bytes() == path.read_bytes()):
            raise ProjectError(f"{copy}: another file stands there already and is not replaced; give another folder.")
    try:
        for path, copy in chosen.items():
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, copy)
    except OSError as exc:
        raise ProjectError(f"{there}: cannot write there ({exc.strerror}); give another folder.") from None
    return list(chosen.values())


def _to_copy(here: Path, names: Sequence[str]) -> list[Path]:
    """Whole folders of cases; of robots, load tests, materials and drawings the file alone."""
    if not names:
        return sorted(path for path in here.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    files: set[Path] = set()
    for name in names:
        found = [sample for sample in samples() if sample.name == name]
        if not found:
            raise ProjectError(f"{name!r:.80}: there is no such sample; 'robomill samples' lists them.")
        for sample in found:
            whole = sample.path if sample.kind == "answers" else sample.path.parent
            files.update(whole.glob("*.*") if sample.kind in ("set-up", "study", "answers") else [sample.path])
    return sorted(files)
