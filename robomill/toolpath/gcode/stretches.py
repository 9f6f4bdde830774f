"""The lines of a program, and stretches of plain ones among them that are read and moved along together."""

import sys
from collections.abc import Sequence
from operator import attrgetter
from typing import Any

import numpy as np

from robomill.arrays import IntArray
from robomill.lazy import cached_property
from robomill.toolpath.gcode import mode_rules
from robomill.toolpath.gcode.program import Rows
from robomill.toolpath.gcode.records import STATE, Text

LONG = 20_000
"""Lines to execute that are worth loading the compiled rules for."""
LOADED_LONG = 300
"""Lines to execute that are worth calling them once they are loaded."""
CHUNK = 64
"""Lines that are done together in plain Python."""
_KERNELS = "robomill.toolpath.gcode.kernels"
_FIELDS = STATE.names or ()
_state_of = attrgetter(*_FIELDS)


class Lines(Sequence[str]):
    """The lines of a program (bytes with "\\n" between them); each is made a string when it is asked for."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        codes = np.frombuffer(data, np.uint8)
        self.starts: IntArray = np.concatenate([[0], np.flatnonzero(codes == 10) + 1, [len(data) + 1]])
        self.starts.flags.writeable = False
        self.text = Text(codes, self.starts)

    def __len__(self) -> int:
        return len(self.starts) - 1

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        index = range(len(self))[index]
        return self.data[int(self.starts[index]) : int(self.starts[index + 1]) - 1].decode("utf-8", "replace")

    @cached_property
    def plain_text(self) -> Text:
        """``text`` in plain Python."""
        starts: Any = self.starts.tolist()
        return Text(self.data, starts)


class Stretches:
    """Runs plain lines on a machine: in plain Python, or compiled where so many are executed that it pays."""

    def __init__(self, machine: Any) -> None:
        self._machine = machine
        self._state = np.zeros(1, STATE)
        self._kernels: Any = None

    def run(self, lines: Lines, first: int, executed: int) -> tuple[int, bool]:
        """Execute plain lines from index ``first`` on: how many, and whether the next one may be plain too.

        ``executed`` lines came before.
        """
        machine, recorder = self._machine, self._machine.recorder
        if self._kernels is None and max(len(lines), executed) >= (LOADED_LONG if _KERNELS in sys.modules else LONG):
            from robomill.toolpath.gcode import kernels

            self._kernels = kernels
        if self._kernels is None:
            count = min(len(lines) - first, CHUNK)
            written = Rows(machine)
            done = mode_rules.run(machine, machine.store.arrays, lines.plain_text, first, count, written)
            written.keep()
            return done, done == count
        rows, machine.moves = recorder.free()
        self._state[0] = _state_of(machine)
        count = len(lines) - first
        done = self._kernels.run(self._state, machine.store.views(), lines.text, first, count, rows)
        for name, value in zip(_FIELDS, self._state[0].item()):
            setattr(machine, name, value.tolist() if STATE[name].shape else value)
        recorder.take(machine.moves)
        return done, done == count or machine.moves == len(rows)
