"""A part of ``fuzz_readers``: damaged files of every kind are read or refused, soon."""

from __future__ import annotations

from pathlib import Path

import fuzz_readers
import pytest

from robomill.compiled import compile_all

pytestmark = pytest.mark.usefixtures("compiled_before")
NAMES = sorted(fuzz_readers.readers(Path()))


@pytest.fixture(scope="module")
def compiled_before() -> None:
    """Kernels are compiled before a clock runs."""
    compile_all()


@pytest.mark.parametrize("name", NAMES)
def test_damaged_files_are_read_or_refused(name: str, tmp_path: Path) -> None:
    reader = fuzz_readers.readers(tmp_path)[name]
    reader.read([whole for whole in reader.seeds if b"<!DOCTYPE" not in whole][-1])  # what is damaged is a good file
    found = fuzz_readers.run(reader, 120, seed=1)
    assert not found.escaped
    assert found.read < 120
    assert found.slowest < 2.0
