"""Stretches of plain lines and O words, which are read and followed together."""

import sys
from operator import attrgetter
from time import thread_time
from typing import Any

import numpy as np

from robomill.compiled import build
from robomill.toolpath.gcode.flow import Structure
from robomill.toolpath.gcode.lines import Lines
from robomill.toolpath.gcode.program import Rows
from robomill.toolpath.gcode.rules import flow_rules
from robomill.toolpath.gcode.rules.records import STATE

LONG = 20_000
"""Lines to execute that are worth loading the compiled rules for."""
LOADED_LONG = 32
"""Lines to execute that are worth calling them once they are loaded."""
CHUNK = 64
"""Lines that are done together in plain Python."""
COMPILED_CHUNK = 16_384
"""Lines that are done together in compiled code,"""
CHARACTERS = 2_000_000
"""of so many characters at most: some hundredths of a second."""
_KERNELS = "robomill.toolpath.gcode.rules.kernels"
_FIELDS = STATE.names or ()
_state_of = attrgetter(*_FIELDS)


class Stretches:
    """Runs stretches on a machine: in plain Python, or compiled where so many lines are executed that it pays.

    ``preparing`` is the time (s) that the first call of compiled rules took: they may have had to be compiled for it.
    """

    def __init__(self, machine: Any) -> None:
        self._machine = machine
        self._state = np.zeros(1, STATE)
        self._kernels: Any = None
        self.preparing = 0.0

    def run(self, lines: Lines, structure: Structure, at: int, executed: int, most: int) -> tuple[int, int, bool]:
        """Execute lines from index ``at`` on: how many, which comes next, and whether that may be one of a stretch too.

        ``executed`` lines came before; at most ``most`` are executed.
        """
        machine, recorder, began = self._machine, self._machine.recorder, thread_time()
        if self._kernels is None and max(len(lines), executed) >= (LOADED_LONG if _KERNELS in sys.modules else LONG):
            if _KERNELS not in sys.modules:
                build(_KERNELS)
            from robomill.toolpath.gcode.rules import kernels

            self._kernels = kernels
        if self._kernels is None:
            count = min(most, CHUNK)
            written = Rows(machine)
            store, text, flow = machine.store.arrays, lines.plain_text, structure.plain
            done, at = flow_rules.run(machine, store, text, flow, (at, count), written)
            written.keep()
            return done, at, done == count
        rows, machine.moves = recorder.free()
        self._state[0] = _state_of(machine)
        count = min(most, COMPILED_CHUNK, max(CHARACTERS // lines.longest, 1))
        store, flow = machine.store.views(), structure.views
        done, at = self._kernels.run(self._state, store, lines.text, flow, (at, count), rows)
        for name, value in zip(_FIELDS, self._state[0].item()):
            setattr(machine, name, value.tolist() if STATE[name].shape else value)
        recorder.take(machine.moves)
        self.preparing = self.preparing or thread_time() - began
        return done, at, done == count or machine.moves == len(rows)
