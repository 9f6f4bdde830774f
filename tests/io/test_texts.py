"""Text from a path, from itself or from bytes."""

from __future__ import annotations

import pytest

from robomill.errors import ProjectError
from robomill.io.texts import read_text

TEXT = "zwei Zeilen\nmit ü\n"


def test_a_text_is_itself_and_may_have_a_name(tmp_path) -> None:
    assert read_text(TEXT, ProjectError, "words") == (TEXT, "")
    assert read_text("\ufeff" + TEXT, ProjectError, "words", "mine") == (TEXT, "mine")
    assert read_text("a\r", ProjectError, "words") == ("a\r", "")
    assert read_text("", ProjectError, "words") == ("", "")
    assert read_text("  ", ProjectError, "words") == ("  ", "")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_files_and_bytes(tmp_path, encoding: str) -> None:
    file = tmp_path / "words.txt"
    file.write_bytes(TEXT.encode(encoding))
    assert read_text(file, ProjectError, "words") == (TEXT, "words.txt")
    assert read_text(str(file), ProjectError, "words") == (TEXT, "words.txt")
    assert read_text(file, ProjectError, "words", "other") == (TEXT, "other")
    assert read_text(TEXT.encode(encoding), ProjectError, "words") == (TEXT, "")
    big = "\ufeff".encode("utf-16-be") + TEXT.encode("utf-16-be")
    assert read_text(big, ProjectError, "words") == (TEXT, "")


@pytest.mark.parametrize("raw", [b"\xff\xfe\x00", b"\x89PNG\r\n\x1a\n\0\0", b"a\0b", "naïve".encode("latin-1")])
def test_what_is_no_text(tmp_path, raw: bytes) -> None:
    with pytest.raises(ProjectError, match=r"^This file: this is not a text file; expected words\.$"):
        read_text(raw, ProjectError, "words")
    file = tmp_path / "photo.txt"
    file.write_bytes(raw)
    with pytest.raises(ProjectError, match=r"^photo.txt: this is not a text file; expected words\.$"):
        read_text(file, ProjectError, "words")


@pytest.mark.parametrize(
    ("given", "why"),
    [("no/such.csv", "No such file or directory"), (".", "Is a directory"), ("a\0b", "null"), ("x" * 5000, "too long")],
)
def test_what_is_no_file(given: str, why: str) -> None:
    with pytest.raises(ProjectError, match=f"cannot be opened .*{why}.*expected words") as caught:
        read_text(given, ProjectError, "words")
    assert given[-79:] in str(caught.value)
    assert len(str(caught.value)) < 200
