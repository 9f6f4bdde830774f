"""From program text to canonical moves: runs the lines, follows O words, and keeps the budgets."""

import re
from time import thread_time

from robomill.errors import GCodeError
from robomill.progress import checkpoint
from robomill.toolpath.gcode import check, codes as modal, tilted
from robomill.toolpath.gcode.corners import AT_END
from robomill.toolpath.gcode.cutters import keep_d
from robomill.toolpath.gcode.dialects import Dialect
from robomill.toolpath.gcode.execute import execute
from robomill.toolpath.gcode.expressions import Reader
from robomill.toolpath.gcode.fanuc.cycles import as_bored, clamps, drill_bolts, repeats
from robomill.toolpath.gcode.fanuc.macro import in_full, with_brackets
from robomill.toolpath.gcode.fanuc.scaling import scale_words
from robomill.toolpath.gcode.klartext.lines import Klartext
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.offsets import place_by_numbers
from robomill.toolpath.gcode.owords import File
from robomill.toolpath.gcode.rules.line_rules import MAX_LINE
from robomill.toolpath.gcode.rules.motion_rules import keep_motion
from robomill.toolpath.gcode.scan import CALLS
from robomill.toolpath.gcode.sinumerik.lines import parted, spaced
from robomill.toolpath.gcode.stretches import Stretches
from robomill.toolpath.gcode.words import Block, apply_settings, normalise, read_words, skip_number

MAX_STEPS = 1_000_000
"""Lines that may be executed beyond the length of the program: loops and subroutines."""

MAX_CODE = 3000
"""Characters of a Sinumerik line that can be read, without its comment."""

LOOPING = 1.3
"""s of computing: longer no loop is followed, once as many lines were executed as the program has."""

_CHECK_EVERY = 256
_SKIP = re.compile(r"(?<=[\d.\]])/[1-9]?(?=[a-z](?![a-z]))")
_LOOK_BEYOND = 20


class Interpreter(Klartext):
    """Runs one program on one machine. ``file`` and ``pc`` are the line that comes next."""

    def __init__(self, machine: Machine, file: File, dialect: Dialect) -> None:
        super().__init__(machine, file, dialect)
        self.steps, self.budget = 0, len(file.lines) + MAX_STEPS
        self.looping_since: float | None = None
        self.percent, self.is_klartext = False, dialect.name == "heidenhain"
        machine.sides = {410: "RL", 420: "RR"} if self.is_klartext else {}
        self.stretches = Stretches(machine)

    def run(self) -> None:
        """Execute until the program ends, plain lines and O words in stretches."""
        self._skip_percent()
        if self.dialect.name == "fanuc":
            self.begin_at_main()
        try:
            while not self.ended:
                if self.machine.is_plain and not self.is_klartext and self._run_stretch():
                    continue
                if self.pc >= len(self.file.lines):
                    self._end_of_file()
                    return
                index = self.pc
                self.pc = index + 1
                self.step(index)
                self.leave_if_due()
        finally:
            self.say_left_over()

    def step(self, index: int) -> None:
        """Execute line ``index`` of the current file."""
        self._count(1, index)
        raw = self.file.lines[index]
        machine = self.machine
        line = machine.line = index + 1
        if len(raw) > MAX_LINE:
            raise GCodeError.at(line, f"{len(raw)} characters long; at most {MAX_LINE} can be read.")
        if self.dialect.name == "sinumerik":
            code, comment = parted(raw)
            if len(code) > MAX_CODE:
                raise GCodeError.at(line, f"{len(code)} characters long; at most {MAX_CODE} can be read.")
            plain = spaced(code.upper())
            left = None if self.sinumerik_flow(plain, line) else self.sinumerik_call(plain, line)
            left = None if left is None else self.sinumerik_line(left, line)
            if left is None:
                return
            raw = raw if left == code.upper() else left + comment
        if self.is_klartext:
            left = self.klartext_line(index)
            if left is None:
                return
            raw = left
        macro = self.dialect.has_macros
        if macro:
            raw = in_full(raw) if machine.is_fanuc else raw
            raw = self.fanuc_angle(with_brackets(self.filled_in(raw, line)), line)
        text = normalise(self.dialect.line(raw, line, machine), line)
        if not text:
            return
        if text[0] == "%":
            self._percent(index, text)
            return
        if macro and "/" in text[1:]:
            text = self._without_skips(text, line)
        reader = Reader(text, line, machine.store, raw)
        if text[0] in "/n":
            skip_number(reader)
        if "/" in text[: reader.at]:
            machine.findings.add("block-delete", "info", line, "block delete (/) is off: these lines are executed")
        if text[reader.at : reader.at + 1] == "o":
            self.o_word(reader, index)
            return
        if macro and (self.macro_call(reader) or self.macro_word(reader, index)):
            return
        block = read_words(reader, machine.diameter_mode)
        self.execute(block)

    def _without_skips(self, text: str, line: int) -> str:
        """The line (no blanks) without a / that stands in its midst, before a word: what follows it may be skipped."""
        parts = _SKIP.split(text)
        if len(parts) > 1 and "(" not in text and ";" not in text:
            self.machine.findings.add(
                "block-delete", "info", line, "block delete (/) is off: what follows it is executed"
            )
            return "".join(parts)
        return text

    def execute(self, block: Block) -> None:
        """Check and execute a block."""
        machine = self.machine
        if machine.stuck or machine.leans or machine.tilted is not None:
            tilted.check(machine, block)
        if block.unknown_m or block.unknown_g or block.m.get(modal.USER) in CALLS:
            if self.fanuc_call(block):
                return
            self.dialect.unknown(machine, block)
        self.dialect.meant_otherwise(machine, block)
        _leave_to_maker(machine, block, self.dialect.name)
        if self.dialect.has_macros:
            as_bored(machine, block)
            clamps(machine, block)
            keep_d(machine, block)
        check.choose_motion(machine, block, self.dialect)
        said = block.motion
        scale_words(machine, block)
        if self.dialect.has_macros:
            repeats(machine, block)
        for letter, use in check.check_words(block):
            self.dialect.unused_word(machine, block, letter, use)
        apply_settings(block, machine.store)
        place_by_numbers(machine, block)
        if block.comment:
            self._comment(block)
        level = machine.store.level
        saved = self.saved.setdefault(level, {})
        ends = execute(machine, block, saved)
        drill_bolts(machine, block)
        if block.motion != said:  # mirrored
            keep_motion(machine, said)
        if machine.corner is not None:
            raise block.refuse(AT_END)
        self.drill_modal(block)
        self.drill_if_due(block)
        self.calls.special[level] = level in self.foreign or bool(saved)
        self.call_modal(block)
        if ends:
            self.ended = True
            self._left_over_lines()

    def _run_stretch(self) -> bool:
        """Execute lines that the rules know; False if the next line is none, or wants the reader's word."""
        if self.pc in self.file.unplain:
            return False
        structure, most = self.file.structure or self.no_words, self.budget + 1 - self.steps
        done, self.pc, more = self.stretches.run(self.file.lines, structure, self.pc, self.steps, most)
        if done == 0 and not more:  # and it is not asked again in every round of a loop
            self.file.unplain.add(self.pc)
        self._count(done, max(self.pc - 1, 0))
        return more

    # --- budgets, ends, comments
    def _count(self, executed: int, index: int) -> None:
        """So many lines more were executed, ``index`` is the last one."""
        before = self.steps
        self.steps += executed
        if self.steps > self.budget:
            raise self._endless(index, f"more than {MAX_STEPS} lines were executed in loops")
        if self.steps // _CHECK_EVERY != before // _CHECK_EVERY:
            self._check_time(index)
            share = min(max(index / max(len(self.main.lines), 1), self.steps / self.budget), 1.0)
            checkpoint(share, "Reading the program")

    def _check_time(self, index: int) -> None:
        if self.steps <= len(self.main.lines):
            return
        now = thread_time() - self.stretches.preparing
        if self.looping_since is None:
            self.looping_since = now
        elif now - self.looping_since > LOOPING:
            raise self._endless(index, f"loops took longer than {LOOPING:g} s after {self.steps} lines")

    def _endless(self, index: int, what: str) -> GCodeError:
        """Nothing is cut short: what is not at its end by then is refused, with its size so far."""
        moves = len(self.machine.recorder)
        text = f"{what} and {moves} moves; the program may not end. If it does, let the CAM system write its moves out."
        return GCodeError.at(index + 1, text)

    def _skip_percent(self) -> None:
        for index, raw in enumerate(self.main.lines):
            text = raw.strip()
            leads = text[:1] == ";" or (text[:1] == "(" and text.find(")") == len(text) - 1)
            if not text or (leads and not self.dialect.strict):  # a post's name, before the % that begins
                continue
            if text.startswith("%") and not (self.is_klartext and self.is_iso):
                self.percent = True
                self.pc = index + 1
                if len(text) > 1:
                    self.machine.findings.add(
                        "program-name", "info", index + 1, "text after % is the name of the program"
                    )
            return

    def _percent(self, index: int, text: str) -> None:
        if len(text) > 1 and text[1] not in "(;":
            raise GCodeError.at(index + 1, "found % and more; a % that ends the program stands alone.")
        if not self.percent:
            self.machine.note("percent", "warning", "% ends the program, but none starts it")
        self.finish(index + 1)
        self.ended = True

    def _left_over_lines(self) -> None:
        """Say where the program goes on behind its end, other than with subprograms."""
        if self.file is not self.main or self.machine.store.level > 0:
            return
        for index in range(self.pc, min(self.pc + _LOOK_BEYOND, len(self.main.lines))):
            text = self.main.lines[index].strip()
            if text and text[0] not in "%(;":
                if self.is_klartext or self.calls_lines or self.o_words(self.main).words or self.names:
                    return
                self.machine.findings.add(
                    "after-end", "warning", index + 1, "the program ended before; this is not read"
                )
                return

    def _end_of_file(self) -> None:
        last = len(self.file.lines)
        if self.machine.store.level > 0:
            raise GCodeError.at(last, f"the file ends inside O{self.called_now()}; close it with endsub or M99.")
        self.machine.findings.add("no-end", "warning", last, "the program ends without M2, M30 or %")
        self.finish(last)

    def _comment(self, block: Block) -> None:
        words = block.comment.lstrip()
        kind = words.split(",", 1)[0].strip().lower() if "," in words else ""
        if kind not in ("msg", "debug", "print", "log", "abort"):
            return
        text = words.split(",", 1)[1]
        if kind != "msg":
            text = self.machine.store.expand(text)
        if kind == "abort":
            raise block.refuse(f"the program gives up: {text.strip()}")
        if len(self.machine.messages) < 1000:
            self.machine.messages.append((block.line, text))


def _leave_to_maker(machine: Machine, block: Block, control: str) -> None:
    """M70 to M73 save and restore modes on LinuxCNC alone; elsewhere they are the machine maker's (a vise, air)."""
    if control != "linuxcnc" and (code := block.m.get(modal.SPINDLE, 0)) in (70, 71, 72, 73):
        del block.m[modal.SPINDLE]
        machine.note("unknown-m", "ignored", f"M{code} is not known and is left out")
