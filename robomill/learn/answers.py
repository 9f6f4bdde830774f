"""A student's answers as a file: plain TOML, as the Learn page exports it and as it can be typed by hand.

format = "robomill answers"
version = 1
student = "1234567"
name = "Ada Lovelace"
robot = "slavkovic_5r"

[answers]
tip = "0,123 mm"
share = 42.5
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robomill.arguments import asked
from robomill.errors import LearnError
from robomill.files import FileKind, name_of, read_file
from robomill.io.tables import Table, parse_toml, toml_value
from robomill.io.texts import read_text
from robomill.learn.draws import student_number
from robomill.learn.personal import BY_ID, ROBOT

FORMAT, VERSION = "robomill answers", 1
ANSWERS = FileKind("answers (.toml)", 1, any_code=True)
LONGEST_NAME = 100


@dataclass(frozen=True)
class Answers:
    """Whose answers, for which robot; ``given`` by exercise, as they were typed; ``strange`` names are none."""

    student: str
    name: str
    robot: str
    given: Mapping[str, Any]
    strange: tuple[str, ...] = ()


@asked
def answers_text(student: str | int, given: Mapping[str, str], name: str = "", robot: str = ROBOT) -> str:
    """The file of a student's answers, as the Learn page exports it and ``grade`` marks it.

    Parameters
    ----------
    student : str or int
        The student number.
    given : mapping
        Answers by the ids of their exercises, as they were typed; what is blank is left out.
    name : str
        The student's name.
    robot : str
        The name of the robot that the exercises were made for.

    Returns
    -------
    str
        TOML.

    Raises
    ------
    LearnError
        For what is no student number, and an answer to no exercise.

    Examples
    --------
    >>> from robomill import learn
    >>> print(learn.answers_text(1234567, {"torque": "96,5 N m"}, "Ada"))
    format = "robomill answers"
    version = 1
    student = "1234567"
    name = "Ada"
    robot = "slavkovic_5r"
    <BLANKLINE>
    [answers]
    torque = "96,5 N m"
    <BLANKLINE>
    """
    unknown = [key for key in given if key not in BY_ID]
    if unknown:
        raise LearnError(f"Answers: there is no exercise {unknown[0]!r:.40}; they are {', '.join(BY_ID)}.")
    head = {"format": FORMAT, "version": VERSION, "student": student_number(student), "name": name, "robot": robot}
    lines = [f"{key} = {toml_value(value)}" for key, value in head.items()]
    told = [f"{key} = {toml_value(given[key])}" for key in BY_ID if given.get(key, "").strip()]
    return "\n".join([*lines, "", "[answers]", *told, ""])


def plain_name(path: Path) -> str:
    """The file's name on one line, whatever bytes it is made of."""
    return "".join(c if c.isprintable() else "\ufffd" for c in name_of(path))


def read_answers(path: Path) -> Answers:
    """The answers of a file. Raises LearnError where it is none, or does not say whose they are."""
    where = plain_name(path)
    text, _ = read_text(read_file(path, ANSWERS, LearnError, regular=True, said=where), LearnError, ANSWERS, where)
    table = Table(parse_toml(text, where, LearnError), where, LearnError)
    found = table.data.get("format")
    if found != FORMAT:
        raise LearnError(f"{where}: this is no file of answers: format is {found!r:.40}, expected {FORMAT!r}.")
    if table.whole("version", VERSION) != VERSION:
        raise LearnError(f"{where}: this file is of a newer robomill; expected version {VERSION}.")
    number = table.data.get("student", "")
    if isinstance(number, bool) or not isinstance(number, str | int):
        raise LearnError(f"{where}, student: expected a student number, found {number!r:.40}.")
    given = table.table("answers", {}).data
    strange = tuple(f"{name:.40}" for name in given if name not in BY_ID)
    known = {name: value for name, value in given.items() if name in BY_ID}
    called = "".join(c for c in table.text("name", "") if c.isprintable())[:LONGEST_NAME]
    return Answers(student_number(number), called, table.text("robot", ROBOT), known, strange)
