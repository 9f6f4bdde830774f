"""Program text: files and contents told apart, encodings, line ends, what is no text."""

from __future__ import annotations

import codecs
from pathlib import Path

import pytest

import robomill as rm
from robomill.errors import GCodeError
from robomill.files import FileKind
from robomill.toolpath import text as texts
from robomill.toolpath.text import as_plain_bytes, check_program_name, read_source, split_lines


@pytest.mark.parametrize(
    ("source", "is_file"),
    [
        ("part.nc", True),
        ("part.NGC", True),
        ("a/b.tap", True),
        ("G0 X1", False),
        ("part.nc\nG0", False),
        ("part.nc\rG0", False),
        ("part\0.nc", False),
        ("x" * 4093 + ".nc", False),
        ("y" * 4092 + ".nc", True),
        (" \tG21", False),
    ],
)
def test_a_string_of_one_line_with_the_end_of_a_programs_name_is_a_file(source: str, is_file: bool) -> None:
    if is_file:
        with pytest.raises(GCodeError, match="cannot be opened"):
            read_source(source)
    else:
        assert read_source(source) == (source.replace("\0", "").replace("\r", "\n").encode(), "program")


def test_what_exists_is_a_file_whatever_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "O1234").write_bytes(b"G0\r\nX1\rY2\n")
    monkeypatch.chdir(tmp_path)
    for source in ("O1234", tmp_path / "O1234", str(tmp_path / "O1234")):
        assert read_source(source) == (b"G0\nX1\nY2\n", "O1234")
    assert read_source(bytearray(b"O1234")) == (b"O1234", "program")
    with pytest.raises(GCodeError, match="expected text, bytes or a path, found int"):
        read_source(5)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "name", ["setup.toml", "robot.URDF", "points.csv", "a.dxf", "b.SVG", "report.html", "part.stl"]
)
def test_no_program_is_written_under_the_name_of_another_file(name: str) -> None:
    with pytest.raises(GCodeError, match=rf"{name}: a program is written there; give a name that ends in \.nc\.$"):
        check_program_name(Path("out") / name)
    for own in ("part.nc", "O1234", "part.MPF", f"{name}.nc", "part.h"):
        check_program_name(Path("out") / own)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32"])
def test_a_mark_says_the_encoding(encoding: str) -> None:
    marks = {"utf-16-le": codecs.BOM_UTF16_LE, "utf-16-be": codecs.BOM_UTF16_BE}
    assert as_plain_bytes(marks.get(encoding, b"") + "G0 X1 (5°)\n".encode(encoding)) == "G0 X1 (5°)\n".encode()


@pytest.mark.parametrize("sign", [0, 3, 4, 0x11, 0x12, 0x13, 0x14, 0x7F])
def test_what_a_reader_of_tapes_passes_over_is_passed_over(sign: int) -> None:
    """ISO 840 code tapes and DNC: blank tape before, between and behind, reader on (DC1) and off (DC3), rub-outs."""
    tape = bytes([sign])
    data = tape * 300 + b"%\r\nG0" + tape + b"X1\r\n" + tape + b"M30\r\n%" + tape * 300
    assert as_plain_bytes(data) == b"%\nG0X1\nM30\n%"


def test_what_is_no_text_is_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for data, says in (
        (b" \n\t\r", "found an empty file"),
        (b"G0\nX1\nY\0\x01", "^Line 3: found a NUL byte"),
        (b"\0" * 99 + b"\x11\x7f \n\x03", "found an empty file"),
        (codecs.BOM_UTF16_LE + b"\x00\xd8", "starts like UTF-16 text but is not"),
    ):
        with pytest.raises(GCodeError, match=says):
            as_plain_bytes(data)
    fine = b"\x01" + b"G" * 99  # one sign in a hundred
    assert as_plain_bytes(fine) == fine
    with pytest.raises(GCodeError, match="found a binary file"):
        as_plain_bytes(b"\x01" + b"G" * 98)
    assert as_plain_bytes(b"\t\x0c\x1b\n" * 9) == b"\t\x0c\x1b\n" * 9
    monkeypatch.setattr(texts, "PROGRAM", FileKind("a program", 1))
    most = 1_000_000
    assert as_plain_bytes(b"G" * most) == b"G" * most
    (tmp_path / "long.nc").write_bytes(b"G" * (most + 1))
    for long in (b"G" * (most + 1), tmp_path / "long.nc"):
        with pytest.raises(GCodeError, match="at most 1 MB"):
            read_source(long)
    (tmp_path / "long.nc").write_bytes(b"G" * most)
    assert read_source(tmp_path / "long.nc")[0] == b"G" * most


@pytest.mark.parametrize("text", ["a\nb", "a\r\nb\n", "a\rb\r", "\n\n", "", "a", "a\n\n"])
def test_lines_are_those_of_a_text_that_may_end_one(text: str) -> None:
    assert split_lines(text) == text.splitlines()


@pytest.mark.parametrize("end", [b"\x1a", b"\r\n\x1a", b"\x1a" * 128, b"\x1a\0\0\0", b"\x1a\r\n"])
def test_a_program_from_dos_ends_in_ctrl_z(end: bytes) -> None:
    """CP/M and DOS end a text so, and fill up its last block: it was called a binary file."""
    lines = b"G21 G90\r\nG0 X0 Y0 Z5\r\nG1 X10 F100"
    path = rm.read_gcode(lines + end)
    assert path == rm.read_gcode(lines)
    assert path.p[-1].tolist() == [0.01, 0.0, 0.005]
    with pytest.raises(GCodeError):
        rm.read_gcode(b"G21 G90\nG1 X10 F100\n\x1aG1 X20\n")  # what stands behind it is not left out in silence


@pytest.mark.parametrize("name", ["slavkovic_5r", "part.ncx", "C:\\\\jobs\\\\part.xyz", "", "nope"])
def test_a_word_that_is_no_file_and_no_program_is_told_as_both(name: str) -> None:
    with pytest.raises(GCodeError) as refused:
        rm.read_gcode(name)
    assert ("there is no file" in str(refused.value)) == bool(name)
