"""Programs as people bring them: every encoding to the same text, everything else in a sentence."""

from __future__ import annotations

import pytest

from robomill.errors import ProjectError
from robomill.files import PROGRAM
from robomill.io.programs import program_from_bytes, read_program

TEXT = "(Nut fräsen)\nG1 X1 F100\n"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_every_encoding_gives_the_same_text(encoding, tmp_path):
    (tmp_path / "part.nc").write_bytes(TEXT.encode(encoding))
    source = read_program(tmp_path / "part.nc", "haas")
    assert (source.text, source.name, source.dialect) == (TEXT, "part.nc", "haas")


@pytest.mark.parametrize("mark", [b"\xff\xfe", b"\xfe\xff"])
def test_either_mark_of_utf_16_is_known(mark):
    data = mark + TEXT.encode("utf-16-le" if mark == b"\xff\xfe" else "utf-16-be")
    assert program_from_bytes(data, "part.nc").text == TEXT


def test_a_zero_byte_early_is_a_binary_file_and_late_is_not():
    with pytest.raises(ProjectError, match=r"part\.nc: this is a binary file"):
        program_from_bytes(b"G0" + b" " * 4093 + b"\0", "part.nc")
    assert program_from_bytes(b"G0" + b" " * 4094 + b"\0", "part.nc").text.endswith("\0")
    with pytest.raises(ProjectError, match=r"part\.nc: the file is empty"):
        program_from_bytes(b"\r\n\t ", "part.nc")


@pytest.mark.parametrize(("over", "refused"), [(0, False), (1, True)])
def test_a_program_has_a_largest_size(over, refused, tmp_path):
    file = tmp_path / "long.nc"
    with file.open("wb") as out:
        out.truncate(PROGRAM.most + over)  # zeros: a sparse file, so that nothing is written
    with pytest.raises(ProjectError, match="found more than 200 MB, .* at most 200 MB" if refused else "binary file"):
        read_program(file)


def test_what_is_not_there_and_what_is_no_file(tmp_path):
    with pytest.raises(ProjectError, match=r"lost\.nc: cannot be opened \(No such file"):
        read_program(tmp_path / "lost.nc")
    with pytest.raises(ProjectError, match="cannot be opened"):
        read_program(tmp_path)
