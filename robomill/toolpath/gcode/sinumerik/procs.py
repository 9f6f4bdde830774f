"""Subprograms of Sinumerik programs with values, variables and modes of their own: PROC NAME(REAL A, INT B=2) SAVE.

A value that a call leaves out is the one that PROC says, else 0; a VAR parameter is the caller's own variable. SAVE
gives the caller its modes and its frame back. (840D sl, Programming Manual, Job Planning: subprogram technique.)
"""

import re
from dataclasses import dataclass, field
from typing import Any

from robomill.errors import GCodeError
from robomill.lazy import cached_property
from robomill.toolpath.gcode.execute import restore_modes
from robomill.toolpath.gcode.frames import frame_of, see_frame, turn_back
from robomill.toolpath.gcode.machine import Scale
from robomill.toolpath.gcode.sinumerik.flow import SinumerikFlow
from robomill.toolpath.gcode.sinumerik.words import parts
from robomill.toolpath.gcode.words import Block

_HEAD = re.compile(rb"^[ \t]*(?:N\d+[ \t]*)?PROC[ \t]+(\w+)([^\n;]*)", re.MULTILINE | re.IGNORECASE)
_PARAMETER = re.compile(r"(VAR[ \t]+)?(REAL|INT|BOOL)[ \t]+([A-Z_]{1,2}\w+)[ \t]*(?:=[ \t]*(.+))?")
_START = re.compile(r"^[ \t/]*(?:N\d+[ \t]*)?")
_CALL = re.compile(
    r"(?:CALL[ \t]+)?(L\d{1,7}|[A-Z_]{2}\w*)[ \t]*(?:\((.*)\))?(?:[ \t]+P[ \t]*=?[ \t]*(\d{1,4}))?[ \t]*"
)
_MODAL = re.compile(r"MCALL[ \t]+(\w+)[ \t]*\((.*)\)[ \t]*")
_KEPT = ("unit_code", "system", "plane", "absolute", "arc_absolute", "feed_mode", "motion", "straight")
"""Modes that SAVE gives back."""


@dataclass(frozen=True)
class Parameter:
    """What PROC says of a value: its kind and name, what it is where a call leaves it out; ``shared``: by VAR."""

    kind: str
    name: str
    usual: str
    shared: bool


@dataclass(frozen=True)
class Proc:
    """The head of a subprogram; ``problem`` is what of it is not read."""

    parameters: tuple[Parameter, ...]
    saves: bool
    problem: str


@dataclass
class Scope:
    """What a caller has of its own until it comes back; ``given`` is what its subprogram begins with, by place."""

    variables: dict[str, int]
    own: set[str]
    used: int
    given: dict[int, float] = field(default_factory=dict)
    modes: dict[str, Any] = field(default_factory=dict)
    frame: tuple[list[float], float] = ([], 0.0)
    scale: Scale | None = None


class SinumerikProcs(SinumerikFlow):
    """Calls subprograms with values; ``SinumerikFlow`` follows what they do."""

    modal_given: list[float | int]

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.scopes: dict[int, Scope] = {}

    @cached_property
    def procs(self) -> dict[str, Proc]:
        """Heads of subprograms, by name."""
        found = _HEAD.finditer(self.main.lines.data)
        return {each[1].decode().upper(): _proc(each[2].decode("utf-8", "replace").upper()) for each in found}

    def sinumerik_flow(self, code: str, line: int) -> bool:
        """Follow ``code`` (capitals, no comment) if it branches, loops or defines; False for other lines."""
        if _START.sub("", code, count=1).startswith("EXTERN "):  # says what another file's PROC says
            return True
        return super().sinumerik_flow(code, line)

    def sinumerik_call(self, code: str, line: int) -> str | None:
        """Follow a call, or the end of a subprogram; what else the line says, None where it is done."""
        found = _CALL.fullmatch(_START.sub("", code, count=1).strip())
        if found is None or found[1] not in self.procs:
            return super().sinumerik_call(code, line)
        self.call_proc(Block(line), found[1], self.given_of(found[1], found[2] or "", line), int(found[3] or 1))
        return None

    def given_of(self, name: str, text: str, line: int) -> list[float | int]:
        """What a call gives, in order: values, and for VAR the places (whole numbers) of its variables."""
        proc = self.procs[name]
        texts = [each.strip() for each in parts(text)] if text.strip() else []
        if proc.problem:
            raise GCodeError.at(line, f"PROC {name} has {proc.problem}, which is not read; expected REAL, INT or BOOL.")
        if len(texts) > len(proc.parameters):
            raise GCodeError.at(line, f"{name} is called with {len(texts)} values; PROC takes {len(proc.parameters)}.")
        texts += [""] * (len(proc.parameters) - len(texts))
        out: list[float | int] = []
        for each, said in zip(proc.parameters, texts):
            if each.shared and not said:
                raise GCodeError.at(line, f"{name} is called without {each.name}, a variable of the caller's (VAR).")
            out.append(self.slot(said, line) if each.shared else self.value(said or each.usual, line))
        return out

    def call_proc(self, block: Block, name: str, given: list[float | int], repeats: int = 1) -> None:
        """Call a subprogram by its PROC."""
        level = self.machine.store.level
        self._enter(block, name, self.names[name], repeats)
        if self.machine.store.level == level:
            return
        scope, proc = self.scopes[level + 1], self.procs[name]
        for each, value in zip(proc.parameters, given):
            if each.shared:
                self.variables[each.name] = int(value)
                self.own.add(each.name)
            else:
                at = self.define(each.kind, each.name, block.line)
                self.keep(at, float(value))
                scope.given[at] = float(value)
        if proc.saves:
            scope.modes = {mode: getattr(self.machine, mode) for mode in _KEPT}
            scope.frame, scope.scale = frame_of(self.machine), self.machine.scale

    def _modal_call(self, plain: str, line: int) -> bool:
        found = _MODAL.fullmatch(plain)
        name, said = ("", "") if found is None or found[1] not in self.procs else found.groups()
        self.modal_given = self.given_of(name, said, line) if name else []
        return super()._modal_call(f"MCALL {name}" if name else plain, line)

    def enter_modal(self, block: Block, name: str, start: int) -> None:
        """Call the subprogram that MCALL holds, with the values that it was given."""
        if name in self.procs:
            self.call_proc(block, name, self.modal_given)
        else:
            super().enter_modal(block, name, start)

    def _enter(self, block: Block, label: str, *given: Any) -> None:
        level = self.machine.store.level
        super()._enter(block, label, *given)
        if self.machine.store.level > level:
            self.scopes[level + 1] = Scope(dict(self.variables), self.own, self.used)
            self.own = set()

    def _repeat_or_leave(self) -> None:
        scope = self.scopes.get(self.machine.store.level)
        super()._repeat_or_leave()
        if scope is not None and self.scopes.get(self.machine.store.level) is scope:  # once more
            for at, value in scope.given.items():
                self.keep(at, value)

    def _go_back(self, level: int, where: int) -> None:
        super()._go_back(level, where)
        scope = self.scopes.pop(level, None)
        if scope is None:
            return
        self.variables, self.own, self.used = scope.variables, scope.own, scope.used
        if scope.modes:
            self._take_up(scope)

    def _take_up(self, scope: Scope) -> None:
        """Modes and frame are what they were at the call (SAVE)."""
        machine, block = self.machine, Block(self.machine.line)
        machine.need_compensation_off(block, "The end of a subprogram with SAVE")
        turn_back(machine)
        restore_modes(machine, block, {**scope.modes, "automatic": True})
        if any(scope.frame[0]) or scope.frame[1]:
            see_frame(machine, *scope.frame)
        if machine.scale is not scope.scale:
            machine.set_scale(scope.scale)


def _proc(text: str) -> Proc:
    """The head of a subprogram behind its name (capitals)."""
    found = re.fullmatch(r"[ \t]*(?:\((.*)\))?([^()]*)", text)
    if found is None:
        return Proc((), False, "brackets that do not match")
    parameters: list[Parameter] = []
    for each in parts(found[1]) if (found[1] or "").strip() else []:
        said = _PARAMETER.fullmatch(each.strip())
        if said is None:
            return Proc((), False, f"{each.strip()[:30]!r}")
        parameters.append(Parameter(said[2], said[3], (said[4] or "0").strip(), bool(said[1])))
    return Proc(tuple(parameters), bool(re.search(r"\bSAVE\b", found[2])), "")
