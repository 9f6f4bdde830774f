"""O words and subroutines as the interpreter follows them: where ``flow_rules`` hands a line back, and files."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from robomill.errors import GCodeError
from robomill.files import FileKind, read_file
from robomill.toolpath.gcode.dialects import Dialect
from robomill.toolpath.gcode.execute import restore_modes
from robomill.toolpath.gcode.expressions import Reader
from robomill.toolpath.gcode.flow import Calls, OWord, Structure, scan
from robomill.toolpath.gcode.lines import Lines
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.parameters import ARGUMENTS, LEVELS
from robomill.toolpath.gcode.rules import flow_rules as rules, value_rules
from robomill.toolpath.gcode.rules.records import Flow
from robomill.toolpath.gcode.words import Block

SUBROUTINE = FileKind("a subroutine beside the program", 10)

SENTENCES = {
    rules.NO_CONDITION: "{name} needs [ and a condition.",
    rules.MORE_BEHIND: "found {rest!r} after {name}; remove it.",
    rules.NO_END: "O{label} {opening} has no end; close it with {closing}.",
    rules.OUTSIDE: "{name} is outside of a subroutine.",
    rules.TOO_MANY_ARGUMENTS: f"O{{label}} is called with {{count:.0f}} arguments; at most {ARGUMENTS} are passed.",
    rules.TOO_MANY_LEVELS: f"subroutines call one another more than {LEVELS - 1} levels deep.",
}
"""What is said for a problem of ``flow_rules``."""


@dataclass
class File:
    """Lines of a program or subroutine file, its O words once one has been met, and the lines that no stretch takes."""

    name: str
    lines: Lines
    folder: Path | None = None
    structure: Structure | None = None
    unplain: set[int] = field(default_factory=set)


@dataclass
class Call:
    """A call that the rules cannot leave: it goes back into another file, or behind a line that has no O word.

    ``start`` is the line (index) at which each of its ``repeats`` begins. ``values`` are the variables that it begins
    with, by number (None: those of its caller), and ``kept`` those of its caller.
    """

    label: str
    file: File
    pc: int
    repeats: int = 1
    start: int = 0
    values: dict[int, float] | None = None
    kept: list[float] = field(default_factory=list)


class OWords:
    """Follows O words. ``file`` and ``pc`` are the line that comes next.

    ``foreign`` are the open calls that the rules cannot leave, by level; ``saved`` is what M70 and M73 have kept there.
    """

    def __init__(self, machine: Machine, file: File, dialect: Dialect) -> None:
        self.machine = machine
        self.main = self.file = file
        self.dialect = dialect
        self.pc = 0
        self.calls = Calls()
        self.no_words = Structure(self.calls)
        self.foreign: dict[int, Call] = {}
        self.saved: dict[int, dict[str, Any]] = {}
        self.ended = False
        self.others: dict[str, File] = {}

    def finish(self, line: int) -> None:
        """Record what cutter compensation holds back, as the program ends."""
        if self.machine.compensation is not None:
            self.machine.compensation.finish(self.machine, Block(line))

    def o_words(self, file: File) -> Structure:
        """The structure of a file, found when it is first needed."""
        if file.structure is None:
            file.structure = scan(file.lines, self.calls)
        return file.structure

    def o_word(self, reader: Reader, index: int) -> None:
        """Follow the O word of a line."""
        structure = self.o_words(self.file)
        place = structure.places.get(index)
        if place is None:
            word = self._computed_call(reader)
            codes: Any = value_rules.codes(word.argument)
            self._follow(word, structure.plain._replace(words=[word], arguments=codes), 0)
            return
        word = structure.words[place]
        if word.problem:
            raise reader.refuse(word.problem)
        self._follow(word, structure.plain, place)

    def _follow(self, word: OWord, known: Flow, place: int) -> None:
        machine, store = self.machine, self.machine.store
        argument, level = Reader(word.argument, word.line + 1, store), store.level
        while True:
            problem, behind, where = argument.told(lambda: rules.step(machine, store.arrays, known, place), word.begin)
            if problem != rules.SPECIAL:
                break
            self.calls.special[level] = 0
        if problem == rules.ELSEWHERE:
            self._call(word, argument)
        elif problem:
            argument.at = where - word.begin
            raise self._refused(problem, argument, word)
        elif store.level < level:
            self._go_back(level, where)
        else:
            self.pc = known.words[where].line + behind

    def _refused(self, problem: int, argument: Reader, word: OWord) -> GCodeError:
        opening = rules.KEYWORDS[self.o_words(self.file).words[word.start].keyword] if problem == rules.NO_END else ""
        return argument.refuse(
            SENTENCES[problem].format(
                name=word.name,
                label=word.label,
                rest=argument.rest(),
                opening=opening,
                closing="while" if opening == "do" else f"end{opening}",
                count=self.machine.store.arrays.figures[0],
            )
        )

    def say_left_over(self) -> None:
        """LinuxCNC keeps one flag each for break and continue; the reference's quirk is followed, counted and said."""
        for file in (self.main, *self.others.values()):
            structure = file.structure or self.no_words
            for word, count in zip(structure.words, structure.plain.left_over):
                cause = "break in an earlier while" if word.keyword == rules.WHILE else "continue in an earlier do"
                if count:
                    message = f"O{word.label} does not loop as written: LinuxCNC still remembers a {cause} loop"
                    self.machine.findings.add("loop-flags", "warning", word.line + 1, message, int(count))

    # --- subroutines
    def _computed_call(self, reader: Reader) -> OWord:
        reader.at += 1
        label = str(reader.integer("The number of a subroutine"))
        if not reader.text.startswith("call", reader.at):
            raise reader.refuse("an O word with a computed number can only be a call.")
        argument = reader.text[reader.at + 4 :]
        most = rules.MOST[rules.CALL]
        return OWord(reader.line - 1, rules.CALL, label, argument, 0, len(argument), most=most)

    def _call(self, word: OWord, argument: Reader) -> None:
        """Call a subroutine of any file, with the arguments that the rules have read."""
        arrays = self.machine.store.arrays
        file, sub = self._find_sub(word.label, argument)
        structure = self.o_words(file)
        problem = rules.enter(arrays, structure.plain, sub, -1, int(arrays.figures[0]))
        if problem:
            raise self._refused(problem, argument, word)
        self._go_to(Call(word.label, self.file, self.pc), file, structure.words[sub].line + 1)

    def _go_to(self, call: Call, file: File, pc: int) -> None:
        level = self.machine.store.level
        self.foreign[level], self.calls.special[level] = call, 1
        self.file, self.pc = file, pc

    def _go_back(self, level: int, where: int) -> None:
        """Go on behind a call that has been left: where ``foreign`` knows, or behind the O word ``where``."""
        call, saved = self.foreign.pop(level, None), self.saved.pop(level, {})
        self.calls.special[level] = 0
        if call is None:
            self.pc = self.o_words(self.file).words[where].line + 1
        else:
            self.file, self.pc = call.file, call.pc
        if saved.get("automatic"):
            restore_modes(self.machine, Block(self.machine.line), saved)

    def called_now(self) -> str:
        """The label of the subroutine that is being executed."""
        level = self.machine.store.level
        call = self.foreign.get(level)
        return call.label if call is not None else self.o_words(self.file).words[self.calls.subs[level]].label

    def _find_sub(self, label: str, reader: Reader) -> tuple[File, int]:
        for file in (self.file, self.main):
            place = self.o_words(file).subs.get(label)
            if place is not None:
                return file, place
        other = self.others.get(label) or self._open_sub(label, reader)
        place = self.o_words(other).subs.get(label)
        if place is None:
            raise reader.refuse(f"O{label} is called, but {other.name} does not define it.")
        return other, place

    def _open_sub(self, label: str, reader: Reader) -> File:
        folder = self.main.folder
        plain = label.replace("_", "").replace("-", "").isalnum()
        path = folder / f"{label}.ngc" if folder is not None and plain else None
        if path is None or not path.is_file():
            raise reader.refuse(f"O{label} is called, but there is no O{label} sub; define it in the program.")
        try:
            lines = Lines(read_file(path, SUBROUTINE, GCodeError, regular=True))
        except GCodeError as exc:
            raise reader.refuse(f"O{label} is called, but {exc}") from None
        self.machine.note("sub-file", "info", f"O{label} is read from {path.name} beside the program")
        self.others[label] = File(path.name, lines, folder)
        return self.others[label]
