"""Every output that the documents print is what the code prints, and every number between them is one of these."""

from __future__ import annotations

import re

import pytest

from tests.docs.documents import ROOT  # first: it finds the documents' own modules

import printed  # isort: skip

RUN = [page for page in printed.PAGES if re.search(r"^```(python|console)", page.read_text(encoding="utf-8"), re.M)]
# A page's own sentences: without blocks, tables, links, code, mathematics and comments.
NOT_PROSE = (
    r"^```.*?^```[ ]*$",
    r"^\|.*$",
    r"\]\([^)]*\)",
    r"`[^`]*`",
    r"\$\$.*?\$\$",
    r"\$[^$\n]+\$",
    r"<!--.*?-->",
    r"Python \d\.\d+",
)


def named(page):
    return page.relative_to(ROOT).as_posix()


@pytest.mark.parametrize("page", RUN, ids=named)
def test_a_page_shows_what_its_code_prints(page):
    for each in printed.in_empty_folder(page):
        assert each.agrees, (
            f"{named(page)}, line {each.line}, shows\n{each.shown}\nand this is printed:\n{each.printed}\n"
            "'python docs/printed.py --write' fills it in."
        )


@pytest.mark.parametrize("page", RUN, ids=named)
def test_a_decimal_number_in_a_sentence_stands_in_the_page_s_code_or_output_too(page):
    text = page.read_text(encoding="utf-8")
    computed = "\n".join(block.text for block in printed.blocks(text)).replace("−", "-")
    prose = text
    for pattern in NOT_PROSE:
        prose = re.sub(pattern, "", prose, flags=re.MULTILINE | re.DOTALL)
    for number in re.findall(r"(?<![\w.])\d+\.\d+(?![\w.]*\.\d)", prose):
        assert number in computed, f"{named(page)}: {number} stands in a sentence and in no block"


def test_an_output_that_differs_is_found_and_filled_in(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("```python\nprint(1 + 1)\n```\n\n```text\n3\n```\n\n```python\nprint('b')\n```\n", encoding="utf-8")
    found = printed.in_empty_folder(page)
    assert [each.agrees for each in found] == [False, False]
    page.write_text(printed.refreshed(page.read_text(encoding="utf-8"), found), encoding="utf-8")
    again = printed.in_empty_folder(page)
    assert [each.agrees for each in again] == [True, True]
    assert page.read_text(encoding="utf-8").count("```text") == 2


def test_a_verb_s_output_is_compared_and_dots_stand_for_anything(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(
        "```console\n$ robomill --version\nrobomill ...\n$ robomill --version\nsomething\n```\n", encoding="utf-8"
    )
    assert [each.agrees for each in printed.in_empty_folder(page)] == [True, False]
