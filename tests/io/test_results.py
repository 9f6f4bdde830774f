"""A run's results as files."""

from __future__ import annotations

import json

import pytest

from robomill.errors import ProjectError
from robomill.io.results import json_text, write_files


def test_files_are_written_into_a_folder_made_for_them(tmp_path) -> None:
    folder = tmp_path / "a" / "b"
    write_files(folder, {"words.txt": "ü\n", "bytes.bin": b"\x00\xff"})
    assert (folder / "words.txt").read_bytes() == "ü\n".encode()
    assert (folder / "bytes.bin").read_bytes() == b"\x00\xff"
    write_files(folder, {"words.txt": "again"})
    assert (folder / "words.txt").read_text() == "again"


def test_a_folder_that_cannot_be_is_refused(tmp_path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ProjectError, match=r"file/in: cannot write there \(Not a directory\); give another"):
        write_files(tmp_path / "file" / "in", {})


def test_json_is_one_object_that_reads_back_with_its_own_characters() -> None:
    record = {"µ": [1, 0.1, None, True]}
    text = json_text(record)
    assert json.loads(text) == record
    assert "µ" in text
    assert text.startswith('{\n "')
    assert text.endswith("}\n")
    with pytest.raises(ValueError, match="JSON"):
        json_text(float("nan"))
