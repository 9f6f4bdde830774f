"""Lines of a program as they lie in its bytes."""

from __future__ import annotations

import pytest

from robomill.toolpath.gcode.lines import Lines


@pytest.mark.parametrize("data", [b"", b"\n", b"G0", b"G0\n", b"a\nbb\n\nc\xff\n", b"\n\nlast"])
def test_lines_are_those_of_the_bytes(data: bytes) -> None:
    lines, expected = Lines(data), data.decode("utf-8", "replace").split("\n")
    assert len(lines) == len(expected)
    assert list(lines) == expected
    assert lines[-1] == expected[-1]
    assert lines[1:] == expected[1:]
    assert lines[::-2] == expected[::-2]
    for outside in (len(expected), -len(expected) - 1):
        with pytest.raises(IndexError):
            lines[outside]
    assert list(lines.plain_text.starts) == lines.starts.tolist()
