"""The lines of a program, for those who ask for one and for the rules."""

import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from robomill.arrays import IntArray
from robomill.lazy import cached_property
from robomill.toolpath.gcode.rules.records import Text

_PERCENT = re.compile(rb"^[ \t]*%(?!_N_)", re.MULTILINE)


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

    def index_at(self, place: int) -> int:
        """The index of the line that holds a place among the bytes."""
        return int(np.searchsorted(self.starts, place, "right")) - 1

    @cached_property
    def closing(self) -> int | None:
        """The index of the line whose % ends the program; None where there is none.

        A % on the first line that holds anything begins it. Headers of an archive (``%_N_NAME_SPF``) end nothing.
        """
        places = (found.start() for found in _PERCENT.finditer(self.data))
        return next((self.index_at(place) for place in places if self.data[:place].strip()), None)

    @cached_property
    def longest(self) -> int:
        """Bytes of the longest line."""
        return int(np.diff(self.starts).max())

    @cached_property
    def plain_text(self) -> Text:
        """``text`` in plain Python."""
        starts: Any = self.starts.tolist()
        return Text(self.data, starts)
