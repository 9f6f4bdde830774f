"""Text for consoles whose code page does not hold every character."""

from __future__ import annotations

import ast
import io
from pathlib import Path

import pytest

from robomill.console import harmless, one_line, put, shows_all, speak_plainly
from robomill.errors import RobomillError

PACKAGE = Path(__file__).resolve().parents[2] / "robomill"
PAGES = ("ascii", "cp437", "cp850", "cp1252", "latin-1", "utf-8")


def written(text: str, page: str) -> str:
    """What a stream of a code page holds after ``text``."""
    data = io.BytesIO()
    stream = io.TextIOWrapper(data, encoding=page)
    speak_plainly(stream)
    stream.write(text)
    stream.flush()
    return data.getvalue().decode(page)


@pytest.mark.parametrize(
    ("text", "spelled"),
    [
        ("2.3 µm/N", "2.3 um/N"),
        ("90° and 12 °/s", "90 deg and 12 deg/s"),
        ("7.14 ×10⁻⁷ rad/(N m)", "7.14 x10^-7 rad/(N m)"),
        ("1.5 m³, 2 mm², min⁻¹", "1.5 m^3, 2 mm^2, min^-1"),
        ("C_θ, θ₀, Jᵀ", "C_theta, theta_0, J^T"),
        ("−0.1 ± 0.2, ∞", "-0.1 +- 0.2, inf"),
        ("…/part.nc → out", ".../part.nc -> out"),
        ("Fräse\udcff.nc", "Fr\\xe4se\\udcff.nc"),
        ("铣削 😀", "\\u94e3\\u524a \\U0001f600"),
    ],
)
def test_what_a_code_page_lacks_is_spelled(text: str, spelled: str) -> None:
    assert written(text, "ascii") == spelled


def test_what_a_code_page_holds_stays() -> None:
    assert written("90° 2 µm ± 1 mm², ∞", "cp437") == "90° 2 µm ± 1 mm², ∞"
    assert written("90° 2 µm ± 1 mm³ θ ∞", "cp1252") == "90° 2 µm ± 1 mm³ theta inf"
    assert written("θ → 10⁻⁷", "utf-8") == "θ → 10⁻⁷"


def test_a_raised_number_is_spelled_to_its_end() -> None:
    """¹ is in cp1252, ⁻ and ⁷ are not."""
    assert written("min⁻¹ 10⁻¹⁷", "cp1252") == "min^-1 10^-17"


@pytest.mark.parametrize("page", PAGES)
def test_no_character_ends_a_program(page: str) -> None:
    every = "".join(map(chr, [*range(32, 0x3000), *range(0xD800, 0xE000), 0x1F600]))
    assert written(every, page)


def test_what_the_product_itself_says_is_spelled_and_not_escaped() -> None:
    """Every symbol in a text of the product that is not of the screen's, but for those it reads as people type them."""
    found = set()
    for path in PACKAGE.rglob("*.py"):
        room = path.relative_to(PACKAGE).parts[0]
        if room in ("ui", "viz", "console.py", "typed_numbers.py", "unit_words.py"):
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                found |= {c for c in node.value if ord(c) > 127}
    readers = set("ÄÖÜ\ufeff\ud800\udfff•’⅛")  # of letters that programs spell, of marks at a file's beginning
    lost = {c for c in found - readers if "\\" in written(c, "ascii")}
    assert not lost


def test_a_handler_that_somebody_chose_stays() -> None:
    stream = io.TextIOWrapper(io.BytesIO(), encoding="ascii", errors="replace")
    speak_plainly(stream, None, io.StringIO())
    assert stream.errors == "replace"


def test_a_sentence_is_one_line_and_steers_no_terminal() -> None:
    assert one_line("a\nb\x1b[31m\x9b") == "a\\nb\\x1b[31m\\x9b"
    assert harmless("a\tb\n\x07") == "a\tb\n\\x07"


def test_which_streams_show_everything() -> None:
    assert shows_all(io.TextIOWrapper(io.BytesIO(), encoding="utf-8"))
    assert not shows_all(io.TextIOWrapper(io.BytesIO(), encoding="cp437"))
    assert not shows_all(io.StringIO())


def test_a_full_disk_is_said() -> None:
    with open("/dev/full", "w") as stream, pytest.raises(RobomillError, match="standard output: cannot be written"):
        put("text", stream)


def test_no_stream_shows_nothing() -> None:
    """As under pythonw, and where standard output is closed."""
    assert not shows_all(None)


def test_names_that_the_system_gave_as_bytes_are_shown_in_letters() -> None:
    assert harmless("größe".encode().decode("ascii", "surrogateescape")) == "größe"
    assert harmless(b"\xff.nc".decode("utf-8", "surrogateescape")) == "\\xff.nc"
    assert harmless("\ud800") == "\ud800"
