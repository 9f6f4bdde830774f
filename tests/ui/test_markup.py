"""Words from files: shown as they are, whatever they look like."""

from __future__ import annotations

import ast
import html
import re
from pathlib import Path

import pytest

from robomill.report.tags import Html
from robomill.ui.markup import as_html, as_markdown, unparted

ROOT = Path(__file__).resolve().parents[2]
LIVE = [
    "<style>body{display:none}</style>",
    "<img src=x onerror=alert(1)>",
    "![x](http://foreign.example/x.png)",
    "[a](javascript:alert(1))",
    "[a][b]",
    "[^1]",
    r"$\LaTeX$",
    "$$x$$",
    ":red[warm]",
    ":material/home:",
    ":smile:",
    "`code`",
    "```x",
    "~~gone~~",
    "**bold** and __bold__ and _slanted_ and *slanted*",
    "# Title",
    "> quoted",
    "- item",
    "1. item",
    "2) item",
    "+ item",
    "a | b",
    "&lt;b&gt; &#60;",
    "http://foreign.example/x www.foreign.example me@foreign.example",
    "line\n\n    code after an empty line",
    "=== ---",
]


def shown(markdown: str) -> str:
    """What CommonMark makes of backslashes before punctuation, without the joiner that no one sees."""
    return re.sub(r"\\([!-/:-@\[-`{-~])", r"\1", markdown).replace("\u2060", "")


@pytest.mark.parametrize("text", LIVE)
def test_words_are_shown_to_the_letter_and_nothing_in_them_is_live(text: str) -> None:
    made = as_markdown(text)
    assert shown(made) == " ".join(text.split())
    for live in (
        r"(?<!\\)[`*\[<~$]",
        r"(?<!\\):[A-Za-z]",
        r"^[#>+\-=]",
        r"^\d+[.)] ",
        r"://",
        r"\bwww\.",
        r"(?<!\u2060)@|@(?!\u2060)",
        "\n",
    ):
        assert not re.search(live, made), live
    assert not re.search(r"(?<!\w)(?<!\\)_\w", made)
    assert not re.search(r"(?<!\\)&#?\w+;", made)


@pytest.mark.parametrize(
    "text",
    [
        "setup.toml, tolerance_mm: found 0 mm; expected more than 0 mm.",
        "Line 12, 'G2 X10': an arc needs I/J or R.",
        "1.5 mm is too much (at most 1 mm); 3 − 2 = 1, C_yy, δ_x, 40 %.",
    ],
)
def test_plain_sentences_stay_as_they_are(text: str) -> None:
    assert as_markdown(text) == text


@pytest.mark.parametrize("text", LIVE)
def test_html_shows_words_too(text: str) -> None:
    made = as_html(text)
    assert "<" not in made
    assert html.unescape(made) == text


def test_html_stays_html_and_all_else_is_words() -> None:
    bold = Html("<b>a</b>")
    assert as_html("x < y", bold) == "x &lt; y <b>a</b>"
    assert as_html(f"{bold} <i>") == "&lt;b&gt;a&lt;/b&gt; &lt;i&gt;", "an f-string is words: nothing slips through it"


MARKED = ("error", "warning", "info", "success", "markdown", "caption", "write", "toast", "exception")
BOUNDARY = "pieces.py"  # as_markdown is called there
# What is ours whatever a file says: a number, a heading of constants.
OURS = re.compile(r"(as_markdown|format_\w+|unit_label|len)\(|count$|by_joints\.worst_block$|.*DIFFERENCES")


def test_sentences_with_words_in_them_go_through_the_one_door() -> None:
    """A call of Streamlit that reads Markdown gets a text of ours, or one that was escaped."""
    loose = []
    for path in sorted([*(ROOT / "robomill" / "ui").rglob("*.py"), *(ROOT / "pages").glob("*.py"), ROOT / "app.py"]):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.args):
                continue
            if ast.unparse(node.func) in {f"st.{mark}" for mark in MARKED} and path.name != BOUNDARY:
                words = [value for value in _words_in(node.args[0]) if not OURS.match(value)]
                loose += [f"{path.relative_to(ROOT)}:{node.lineno}: {value}" for value in words]
    assert loose == []


def _words_in(node: ast.expr) -> list[str]:
    """The expressions that a text is made of."""
    if isinstance(node, ast.Constant):
        return []
    if isinstance(node, ast.JoinedStr):
        return [ast.unparse(part.value) for part in node.values if isinstance(part, ast.FormattedValue)]
    if isinstance(node, ast.BinOp):
        return _words_in(node.left) + _words_in(node.right)
    return [ast.unparse(node)]


def test_a_number_and_its_unit_stand_on_one_line() -> None:
    assert (
        unparted("77 % of 0.30 mm, × 1800, line 7 of 9") == "77\u00a0% of 0.30\u00a0mm, ×\u00a01800, line\u00a07 of 9"
    )
    assert unparted("3 sides, 5 m long, 2 in a row, 4 inputs") == "3 sides, 5\u00a0m long, 2\u00a0in a row, 4 inputs"
    assert unparted("± 53 rad/(N m) of joint 4") == "±\u00a053 rad/(N\u00a0m) of joint\u00a04"
    assert unparted("(0.00, −0.68, 0.73) mm in {M}") == "(0.00,\u00a0−0.68,\u00a00.73)\u00a0mm in {M}"
    assert unparted("X 0.000 · Y +0.230, Z −0.102") == "X\u00a00.000 · Y\u00a0+0.230, Z\u00a0−0.102"
    assert unparted("lines (1, 2, 3, 4, 5), X and Y") == "lines (1, 2, 3, 4, 5), X and Y"
    assert isinstance(unparted(Html("5 mm")), Html)
    assert not isinstance(unparted("5 mm"), Html)
