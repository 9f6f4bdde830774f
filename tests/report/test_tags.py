"""HTML made of tags: only what is HTML already stays HTML."""

from __future__ import annotations

import html.parser

import pytest

from robomill.report.tags import Html, escaped, joined, tag


class Read(html.parser.HTMLParser):
    """What a browser's reader finds: tags, and words."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.words = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.words += "".join(f"[{key}={value}]" for key, value in attrs)

    def handle_data(self, data: str) -> None:
        self.words += data


def test_what_is_added_to_html_is_words() -> None:
    bold = Html("<b>a</b>")
    assert bold + "<i>" == "<b>a</b>&lt;i&gt;"
    assert "<i>" + bold == "&lt;i&gt;<b>a</b>"
    assert isinstance("<i>" + bold, Html)
    assert joined((bold, "<i>", bold)) == "<b>a</b>&lt;i&gt;<b>a</b>"


@pytest.mark.parametrize("words", ["<img src=x>", "a & b &lt;", "\"quoted\" 'twice'", "</td><td>"])
def test_a_reader_finds_the_words_and_no_other_tag(words: str) -> None:
    read = Read(tag("td", words, title=words))
    assert read.tags == ["td"]
    assert read.words == f"[title={words}]{words}"


@pytest.mark.parametrize("mark", ["\x1b[31m", "\u202e", "\x00", "\ud800"])
def test_what_steers_a_terminal_or_turns_words_round_is_marked(mark: str) -> None:
    assert escaped(f"a{mark[0]}b") == "a\ufffdb"


def test_an_attribute_without_a_value_is_left_out() -> None:
    assert tag("line", class_=None, stroke_width=2) == '<line stroke-width="2"/>'
