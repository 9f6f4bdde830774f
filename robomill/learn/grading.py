"""The files of a class, marked: a row a file, with the marks and the reason of each exercise."""

from __future__ import annotations

import csv
import io
import os
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from robomill.arguments import asked
from robomill.errors import LearnError, RobomillError
from robomill.files import check_place, shown_place
from robomill.io.robot.robots import robot_names
from robomill.learn.answers import Answers, plain_name, read_answers
from robomill.learn.exercise import Exercise
from robomill.learn.marking import MOST, Judgement, check
from robomill.learn.personal import TASKS, exercises
from robomill.progress import checkpoint
from robomill.units import format_count

MOST_FILES = 5000
COPIED = 2  # wrong answers that are right for one other number: so many are no chance
JUNK = {"thumbs.db", "desktop.ini", "__macosx"}
MARKED = ("wrong", "slip", "sign", "unit")  # kinds of answers that may be another student's


@dataclass(frozen=True)
class Row:
    """What one file is worth: ``judged`` by exercise, empty where it cannot be marked, which ``remarks`` then say."""

    file: str
    answers: Answers | None = None
    judged: Mapping[str, Judgement] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()

    @property
    def total(self) -> float | None:
        """The sum of the marks; None where the file cannot be marked."""
        return sum(each.marks for each in self.judged.values()) if self.judged else None


@dataclass(frozen=True)
class Marks:
    """The marks of a class, rows by student number; what cannot be marked comes last.

    Examples
    --------
    >>> from robomill import learn
    >>> from robomill.io.samples import samples_dir
    >>> marks = learn.grade(samples_dir() / "answers/class")
    >>> [(row.file, row.total) for row in marks.rows][:1]
    [('answers-1234567.toml', 20.0)]
    """

    rows: tuple[Row, ...]

    @property
    def unmarked(self) -> int:
        """Files that cannot be marked."""
        return sum(row.total is None for row in self.rows)

    def csv(self) -> str:
        """A table a spreadsheet opens: a row a file, of each exercise its marks and why."""
        out = io.StringIO()
        heads = [name for task in TASKS for name in (task.id, f"{task.id}_why")]
        table = csv.writer(out, lineterminator="\r\n")
        table.writerow(["student", "name", "file", "robot", "total", "of", *heads, "remarks"])
        for row in self.rows:
            whose = row.answers or Answers("", "", "", {})
            judged = [row.judged.get(task.id) for task in TASKS]
            told = [
                cell for each in judged for cell in (("", "") if each is None else (_short(each.marks), each.sentence))
            ]
            total = "" if row.total is None else _short(row.total)
            first = [whose.student, whose.name, row.file, whose.robot, total, _short(MOST * len(TASKS))]
            table.writerow([_harmless(cell) for cell in (*first, *told, " ".join(row.remarks))])
        return "\ufeff" + out.getvalue()  # without the mark, Excel takes umlauts for another code page


def _short(value: float) -> str:
    return f"{value:g}"


def _harmless(cell: str) -> str:
    """A cell that no spreadsheet takes for a formula."""
    return f"'{cell}" if cell[:1] in ("=", "+", "-", "@", "\t", "\r") else cell


@asked
def grade(folder: str | Path, robot: str | None = None, but: str | Path | None = None) -> Marks:
    """Mark every file of answers in a folder and below.

    Parameters
    ----------
    folder : str or Path
        Where the files are, as the Learn page exports them.
    robot : str, optional
        The robot that the class was given; answers for another are not marked.
    but : str or Path, optional
        A file that is none of theirs, such as an older table of marks.

    Returns
    -------
    Marks
        A row a file. One that cannot be read has its row and its reason; the others are marked all the same.

    Raises
    ------
    LearnError
        Where there is no such folder, or nothing in it.

    Examples
    --------
    >>> from robomill import learn
    >>> from robomill.io.samples import samples_dir
    >>> learn.grade(samples_dir() / "answers/class").unmarked
    0
    """
    check_place(folder, "a folder of answers", LearnError)
    if not str(folder).strip():
        raise LearnError("The name of the folder of answers is empty; give one, or . for the folder you are in.")
    if robot is not None and robot not in robot_names():
        raise LearnError(f"Robot {robot!r:.40} is not known here; known are {', '.join(robot_names())}.")
    files = [each for each in _files(Path(folder)) if but is None or each[0].resolve() != Path(but).resolve()]
    rows = []
    for k, (path, called) in enumerate(files):
        checkpoint(k / len(files), "Files marked")
        rows.append(_row(path, called, robot))
    rows = _compared(rows)
    return Marks(tuple(sorted(rows, key=lambda row: (row.total is None, _order(row), row.file))))


def _order(row: Row) -> tuple[int, str]:
    number = row.answers.student if row.answers else ""
    return (int(number), "") if number.isdecimal() else (10**40, number)


def _files(folder: Path) -> Iterator[tuple[Path, str]]:
    """Every file in the folder and below, with what it is called there. Raises LearnError."""
    place = shown_place(folder)
    if not folder.is_dir():
        found = "this is a file" if folder.exists() else "there is no such folder"
        raise LearnError(f"{place}: {found}; expected a folder with files of answers (.toml).", where=str(folder))
    files: list[Path] = []
    try:
        for here, folders, names in os.walk(folder, onerror=_refuse):
            folders[:] = sorted(name for name in folders if not _junk(name))
            files += [Path(here, name) for name in names if not _junk(name)]
            if len(files) > MOST_FILES:
                raise LearnError(
                    f"{place}: found more than {format_count(MOST_FILES, 'file')}; expected those of one class."
                )
    except OSError as exc:
        raise LearnError(f"{place}: cannot be opened ({exc.strerror}); expected a folder of answers.") from None
    if not any(path.suffix.lower() == ".toml" for path in files):
        raise LearnError(f"{place}: there is no file of answers (.toml) in it or below.", where=str(folder))
    for path in sorted(files):
        parts = [plain_name(Path(part)) for part in path.relative_to(folder).parts]
        yield path, "/".join(parts)


def _refuse(exc: OSError) -> None:
    raise exc


def _junk(name: str) -> bool:
    return name.startswith(".") or name.lower() in JUNK


def _row(path: Path, called: str, robot: str | None) -> Row:
    if path.suffix.lower() != ".toml":
        return Row(called, remarks=("Not marked: this is no file of answers, whose name ends in .toml.",))
    answers = None
    try:
        answers = read_answers(path)
        if answers.robot not in robot_names():
            raise LearnError(f"robot {answers.robot!r:.40} is not known; known are {', '.join(robot_names())}.")
        if robot is not None and answers.robot != robot:
            raise LearnError(f"these are answers for {answers.robot}, and the class was given {robot}.")
        given = exercises(answers.student, answers.robot)
    except RobomillError as refusal:
        return Row(called, answers, remarks=(f"Not marked: {refusal}",))
    judged = {each.id: _judged(each, answers.given.get(each.id)) for each in given}
    return Row(called, answers, judged, tuple(_remarks(path, answers)))


def _judged(exercise: Exercise, given: object) -> Judgement:
    if isinstance(given, bool) or not isinstance(given, str | int | float | None):
        return Judgement("unread", f"This is no number: found {given!r:.40}, expected one in {exercise.asked}.")
    return check(exercise, given)


def _remarks(path: Path, answers: Answers) -> Iterator[str]:
    if answers.strange:
        yield f"No exercise is called {', '.join(answers.strange[:3])}."
    if not answers.given:
        yield "There is no answer in it."
    _, _, number = Path(plain_name(path)).stem.partition("answers-")
    if number and number.lower().lstrip("0") != answers.student:
        yield f"The file is called after {number:.40}, and the number in it is {answers.student}."


def _compared(rows: list[Row]) -> list[Row]:
    """The rows with what is told of two of them: one number twice, and the answers of another student's exercises."""
    counts = Counter(row.answers.student for row in rows if row.answers and row.judged)
    keys = {(row.answers.student, row.answers.robot) for row in rows if row.answers and row.judged}
    every = {key: {each.id: each for each in exercises(*key)} for key in keys}
    out = []
    for k, row in enumerate(rows):
        checkpoint(k / len(rows), "Rows compared")
        if row.answers is None or not row.judged:
            out.append(row)
            continue
        more = []
        if counts[row.answers.student] > 1:
            same = [other.file for other in rows if other.answers and other.answers.student == row.answers.student]
            beside = ", ".join(name for name in same if name != row.file)
            more.append(f"The same student number stands in {beside:.200}.")
        more += [
            f"{format_count(count, 'wrong answer')} of it {'is' if count == 1 else 'are'} right for student {student}."
            for student, count in _of_others(row, every)
        ]
        out.append(replace(row, remarks=(*row.remarks, *more)))
    return out


def _of_others(row: Row, every: Mapping[tuple[str, str], Mapping[str, Exercise]]) -> Iterator[tuple[str, int]]:
    """Other students whose answers stand in this file, and how many."""
    assert row.answers is not None
    wrong = {name: each.value for name, each in row.judged.items() if each.kind in MARKED}
    if len(wrong) < COPIED:
        return
    for (student, robot), given in sorted(every.items()):
        if student == row.answers.student or robot != row.answers.robot:
            continue
        count = sum(given[name].tolerance > 0.0 and given[name].holds(value) for name, value in wrong.items())
        if count >= COPIED:
            yield student, count
