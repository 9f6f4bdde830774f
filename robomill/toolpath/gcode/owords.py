"""O words and subroutines: where the program goes on."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from robomill.errors import GCodeError
from robomill.files import FileKind, read_file
from robomill.toolpath.gcode import flow
from robomill.toolpath.gcode.dialects import Dialect
from robomill.toolpath.gcode.execute import restore_modes
from robomill.toolpath.gcode.expressions import Reader
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.parameters import ARGUMENTS, LEVELS
from robomill.toolpath.gcode.stretches import Lines
from robomill.toolpath.gcode.words import Block

SUBROUTINE = FileKind("a subroutine beside the program", 10)


@dataclass
class File:
    """Lines of a program or subroutine file, and its O words."""

    name: str
    lines: Lines
    folder: Path | None = None
    structure: flow.Structure | None = None

    def has_o_word(self, index: int) -> bool:
        """True if a line is known to be one of the structure."""
        return self.structure is not None and index in self.structure.lines

    def o_words(self) -> flow.Structure:
        """The structure, found when it is first needed."""
        if self.structure is None:
            self.structure = flow.scan(self.lines)
        return self.structure


@dataclass
class Call:
    """A subroutine being executed: where it returns to, and what it put aside."""

    sub: flow.Node | None
    label: str
    back_to: int
    back_file: File
    arguments: list[float] | None = None
    counters: dict[int, int] = field(default_factory=dict)
    saved: dict[str, Any] = field(default_factory=dict)
    repeats: int = 1


class OWords:
    """Follows O words and M98/M99. ``file`` and ``pc`` are the line that comes next, ``calls`` the open calls."""

    def __init__(self, machine: Machine, file: File, dialect: Dialect) -> None:
        self.machine = machine
        self.main = self.file = file
        self.dialect = dialect
        self.pc = 0
        self.calls = [Call(None, "", -1, file)]
        self.ended = False
        self.others: dict[str, File] = {}
        self.broke = self.continued = False

    def finish(self, line: int) -> None:
        """Record what cutter compensation holds back, as the program ends."""
        if self.machine.compensation is not None:
            self.machine.compensation.finish(self.machine, Block(line))

    def o_word(self, reader: Reader, index: int) -> None:
        entry = self.file.o_words().lines.get(index)
        if entry is None:
            self._computed_call(reader)
            return
        if entry.problem:
            raise reader.refuse(entry.problem)
        argument = Reader(entry.argument, reader.line, self.machine.store)
        getattr(self, f"_do_{entry.keyword or 'bare'}")(entry, argument, index)

    def _computed_call(self, reader: Reader) -> None:
        reader.at += 1
        label = str(reader.integer("The number of a subroutine"))
        if not reader.text.startswith("call", reader.at):
            raise reader.refuse("an O word with a computed number can only be a call.")
        argument = Reader(reader.text[reader.at + 4 :], reader.line, self.machine.store)
        self._call(label, argument, reader.line - 1)

    def _condition(self, entry: flow.OLine, argument: Reader) -> float:
        if argument.text[:1] != "[":
            raise argument.refuse(f"O{entry.label} {entry.keyword} needs [ and a condition.")
        value = argument.value()
        self._nothing_after(entry, argument)
        return value

    @staticmethod
    def _nothing_after(entry: flow.OLine, argument: Reader) -> None:
        if argument.rest() != "the end of the line" and argument.text[argument.at] not in "(;":
            raise argument.refuse(f"found {argument.rest()!r} after O{entry.label} {entry.keyword}; remove it.")

    def _end_of(self, entry: flow.OLine, argument: Reader) -> int:
        node = entry.node
        if node is None or node.end < 0:
            raise argument.refuse(f"O{entry.label} {entry.keyword} has no end; close it with end{entry.keyword}.")
        return node.end

    def _do_bare(self, entry: flow.OLine, argument: Reader, index: int) -> None:
        if entry.argument and entry.argument[0] not in "(;":
            raise argument.refuse(f"found {argument.rest()!r} after O{entry.label}; expected sub, call, if and so on.")

    def _do_sub(self, entry: flow.OLine, argument: Reader, index: int) -> None:
        if self.calls[-1].sub is not entry.node:
            self._nothing_after(entry, argument)
            self.pc = self._end_of(entry, argument) + 1

    def _do_call(self, entry: flow.OLine, argument: Reader, index: int) -> None:
        self._call(entry.label, argument, index)

    def _do_endsub(self, entry: flow.OLine, argument: Reader, index: int) -> None:
        self._do_return(entry, argument, index)

    def _do_return(self, entry: flow.OLine, argument: Reader, index: int) -> None:
        machine = self.machine
        if len(self.calls) == 1:
            raise argument.refuse(f"O{entry.label} {entry.keyword} is outside of a subroutine.")
        value = argument.value() if argument.text[:1] == "[" else None
        self._nothing_after(entry, argument)
        machine.return_value, machine.value_returned = value or 0.0, float(value is not None)
        self._leave()

    def _do_if(self, entry: flow.OLine, argument: Reader, index: int) -> None:
        if self._condition(entry, argument) == 0.0:
            self._branch(entry, index, argument)

    def _branch(self, entry: flow.OLine, index: int, argument: Reader) -> None:
        """Go to the branch whose condition holds, or behind the endif."""
        node = entry.node
        assert node is not None
        end = self._end_of(flow.OLine("if", entry.label, "", node), argument)
        at = node.next_branch(index)
        while at != end:
            branch = self.file.o_words().lines[at]
            reader = Reader(branch.argument, at + 1, self.machine.store)
            if branch.keyword == "else" or self._condition(branch, reader) != 0.0:
                break
            at = node.next_branch(at)
        self.pc = at + 1

    def _do_else(self, entry: flow.OLine, argument: Reader, index: int) -> None:
        assert entry.node is not None
        self.pc = self._end_of(flow.OLine("if", entry.label, "", entry.node), argument) + 1

    def _do_elseif(self, entry: flow.OLine, argument: Reader, index: int) -> None:
        self._do_else(entry, argument, index)

    def _do_endif(self, entry: flow.OLine, argument: Reader, index: int) -> None:
        self._nothing_after(entry, argument)

    def _do_while(self, entry: flow.OLine, argument: Reader, index: int) -> None:
        holds = self._condition(entry, argument) != 0.0
        assert entry.node is not None
        if entry.node.kind == "do":
            if holds and not self.broke:
                self.pc = entry.node.start + 1
                return
            if holds:
                self._left_over(entry, "break in an earlier while")
            self.broke = False
        elif not holds:
            self.pc = self._end_of(entry, argument) + 1
            self.continued = False
            self.broke |= entry.node.has_break

    def _do_endwhile(self, entry: flow.OLine, argument: Reader, index: int) -> None:
        assert entry.node is not None
        self.pc = entry.node.start

    def _do_do(self, entry: flow.OLine, argument: Reader, index: int) -> None:
        self._nothing_after(entry, argument)

    def _do_repeat(self, entry: flow.OLine, argument: Reader, index: int) -> None:
        counters = self.calls[-1].counters
        if index not in counters:
            counters[index] = round(min(self._condition(entry, argument), 2.0**31))
        if counters[index] <= 0:
            del counters[index]
            self.pc = self._end_of(entry, argument) + 1
            if self.continued:
                self._left_over(entry, "continue in an earlier do")
                self.pc, self.continued = index, False
        else:
            counters[index] -= 1

    def _do_endrepeat(self, entry: flow.OLine, argument: Reader, index: int) -> None:
        assert entry.node is not None
        self.pc = entry.node.start

    def _do_break(self, entry: flow.OLine, argument: Reader, index: int) -> None:
        assert entry.node is not None
        end = self._end_of(flow.OLine(entry.node.kind, entry.label, "", entry.node), argument)
        self.calls[-1].counters.pop(entry.node.start, None)
        self.pc = end + 1
        if entry.node.kind == "while":
            self.broke = True
            if self.continued:
                self._left_over(entry, "continue in an earlier do")
                self.pc, self.continued = entry.node.start, False

    def _do_continue(self, entry: flow.OLine, argument: Reader, index: int) -> None:
        assert entry.node is not None
        self.pc = self._end_of(flow.OLine(entry.node.kind, entry.label, "", entry.node), argument)
        self.continued = entry.node.kind == "do"

    def _left_over(self, entry: flow.OLine, cause: str) -> None:
        """LinuxCNC keeps one flag each for break and continue; the reference's quirk is followed and said."""
        message = f"O{entry.label} does not loop as written: LinuxCNC still remembers a {cause} loop"
        self.machine.note("loop-flags", "warning", message)

    # --- subroutines
    def _call(self, label: str, argument: Reader, index: int) -> None:
        values = []
        while argument.text[argument.at : argument.at + 1] in ("[", "("):
            if argument.text[argument.at] == "(":
                argument.at = argument.text.index(")", argument.at) + 1
            else:
                values.append(argument.value())
        self._nothing_after(flow.OLine("call", label, ""), argument)
        if len(values) > ARGUMENTS:
            raise argument.refuse(f"O{label} is called with {len(values)} arguments; at most {ARGUMENTS} are passed.")
        file, node = self._find_sub(label, argument)
        store = self.machine.store
        call = Call(node, label, self.pc, self.file, store.values(1, ARGUMENTS))
        self._enter(call, argument)
        store.put(1, values + [0.0] * (ARGUMENTS - len(values)))
        store.set("n_args", float(len(values)))
        self.file, self.pc = file, node.start + 1

    def _enter(self, call: Call, reader: Reader) -> None:
        if len(self.calls) >= LEVELS:
            raise reader.refuse(f"subroutines call one another more than {LEVELS - 1} levels deep.")
        self.calls.append(call)
        self.machine.store.enter()

    def _leave(self) -> None:
        call = self.calls.pop()
        store = self.machine.store
        store.leave()
        if call.arguments is not None:
            store.put(1, call.arguments)
        self.file, self.pc = call.back_file, call.back_to
        if call.saved.get("automatic"):
            restore_modes(self.machine, Block(self.machine.line), call.saved)

    def _find_sub(self, label: str, reader: Reader) -> tuple[File, flow.Node]:
        for file in (self.file, self.main):
            node = file.o_words().subs.get(label)
            if node is not None:
                return file, node
        other = self.others.get(label) or self._open_sub(label, reader)
        node = other.o_words().subs.get(label)
        if node is None:
            raise reader.refuse(f"O{label} is called, but {other.name} does not define it.")
        return other, node

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

    def fanuc_call(self, block: Block) -> bool:
        """M98 calls the program O..., M99 returns from it (in the main program: ends it)."""
        code = next((c for c in block.unknown_m if c in (98, 99)), None)
        if code is None:
            return False
        reader = Reader("", block.line, self.machine.store)
        if code == 99:
            if len(self.calls) == 1:
                self.machine.note("m99-ends", "info", "M99 in the main program is taken as its end")
                self.finish(block.line)
                self.ended = True
            else:
                self._repeat_or_leave()
            return True
        if "p" not in block.words:
            raise block.refuse("M98 needs P, the number of the program to call.")
        number, repeats = self.dialect.subprogram(block)
        target = self.main.o_words().bare.get(str(number))
        if target is None:
            raise block.refuse(f"M98 calls O{number}, but there is no O{number} in the program.")
        if repeats > 0:
            self._enter(Call(None, str(number), self.pc, self.file, None, repeats=repeats), reader)
            self.file, self.pc = self.main, target + 1
        return True

    def _repeat_or_leave(self) -> None:
        call = self.calls[-1]
        call.repeats -= 1
        if call.repeats > 0:
            self.pc = self.main.o_words().bare[call.label] + 1
        else:
            self._leave()
