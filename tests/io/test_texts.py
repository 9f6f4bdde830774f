"""Text from a path, from itself or from bytes."""

from __future__ import annotations

from dataclasses import replace

import pytest

from robomill.errors import ProjectError
from robomill.files import FileKind
from robomill.io.texts import read_text

WORDS = FileKind("words", 1)
TEXT = "zwei Zeilen\nmit ü\n"


def test_a_text_is_itself_and_may_have_a_name(tmp_path) -> None:
    assert read_text(TEXT, ProjectError, WORDS) == (TEXT, "")
    assert read_text("\ufeff" + TEXT, ProjectError, WORDS, "mine") == (TEXT, "mine")
    assert read_text("a\r", ProjectError, WORDS) == ("a\r", "")
    assert read_text("", ProjectError, WORDS) == ("", "")
    assert read_text("  ", ProjectError, WORDS) == ("  ", "")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_files_and_bytes(tmp_path, encoding: str) -> None:
    file = tmp_path / "words.txt"
    file.write_bytes(TEXT.encode(encoding))
    assert read_text(file, ProjectError, WORDS) == (TEXT, "words.txt")
    assert read_text(str(file), ProjectError, WORDS) == (TEXT, "words.txt")
    assert read_text(file, ProjectError, WORDS, "other") == (TEXT, "other")
    assert read_text(TEXT.encode(encoding), ProjectError, WORDS) == (TEXT, "")
    big = "\ufeff".encode("utf-16-be") + TEXT.encode("utf-16-be")
    assert read_text(big, ProjectError, WORDS) == (TEXT, "")


@pytest.mark.parametrize("raw", [b"\xff\xfe\x00", b"\x89PNG\r\n\x1a\n\0\0", b"a\0b", b"\xe4\x01b", b"caf\x81"])
def test_what_is_no_text(tmp_path, raw: bytes) -> None:
    with pytest.raises(ProjectError, match=r"^This file: this is not a text file; expected words\.$"):
        read_text(raw, ProjectError, WORDS)
    file = tmp_path / "photo.txt"
    file.write_bytes(raw)
    with pytest.raises(ProjectError, match=r"^photo.txt: this is not a text file; expected words\.$"):
        read_text(file, ProjectError, WORDS)


def test_a_table_may_be_in_the_code_page_that_excel_saves_it_in() -> None:
    """Code page 1252: 0xDF is ß, 0xB5 the micro sign, 0x80 the euro."""
    table = replace(WORDS, any_code=True)
    assert read_text(b"# Gr\xf6\xdfe, \xb5m, \x80\n1,2\n", ProjectError, table)[0] == "# Größe, µm, €\n1,2\n"
    assert read_text("# Größe\n".encode(), ProjectError, table)[0] == "# Größe\n"
    with pytest.raises(ProjectError, match=r"^mine.toml: line 2 is not in UTF-8, which words is; save it with that"):
        read_text(b"a = 1\n# Gr\xf6\xdfe\n", ProjectError, WORDS, "mine.toml")


@pytest.mark.parametrize(
    ("given", "why"),
    [("no/such.csv", "No such file or directory"), (".", "Is a directory"), ("a\0b", "null"), ("x" * 5000, "too long")],
)
def test_what_is_no_file(given: str, why: str) -> None:
    with pytest.raises(ProjectError, match=f"cannot be opened .*{why}.*expected words") as caught:
        read_text(given, ProjectError, WORDS)
    assert given[-79:] in str(caught.value)
    assert len(str(caught.value)) < 200


@pytest.mark.parametrize(("name", "said"), [("", "This "), ("mine.csv", "mine.csv")])
def test_what_is_too_much_is_refused_by_its_name(tmp_path, name: str, said: str) -> None:
    fits = "a" * (WORDS.most - 1) + "\n"
    assert read_text(fits, ProjectError, WORDS, name) == (fits, name)
    assert read_text(fits.encode(), ProjectError, WORDS, name) == (fits, name)
    for given, what in ((fits + "b", "text"), ((fits + "b").encode(), "file")):
        with pytest.raises(ProjectError) as refused:
            read_text(given, ProjectError, WORDS, name)
        assert str(refused.value).startswith(said if name else said + what)
