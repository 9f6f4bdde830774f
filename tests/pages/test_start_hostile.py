"""A project full of words that look like markup, and one that crashes: visitors see words, and no paths."""

from __future__ import annotations

import html
import re

import pytest
from conftest import PAGES, errors, go, store, words
from streamlit import config
from streamlit.testing.v1 import AppTest

from robomill.cutting.tool_table import TableTool, ToolTable
from robomill.provenance import Provenance
from robomill.ui.project import Project, project_to_toml
from robomill.ui.shell import _open

HOSTILE = (
    "<style>*{display:none}</style><img src='http://foreign.example/x.png'>![x](http://foreign.example/y.png)"
    "[a](javascript:b) $\\LaTeX$ :red[c] `d` | **e**"
)
OURS = re.compile(
    r"</?(?:style|h1|h2|i|b|p|div|span|small|sub|sup|table|tr|td|th|br|details|summary|svg|g|path|circle|text)\b[^<>]*>"
)


def hostile(project: Project) -> Project:
    """Every word of a project that a file may hold."""
    setup = project.setup
    blocks = {key: Provenance("user", HOSTILE) for key in (*setup.provenance, "force", "path", "cutter")}
    robot = setup.robot.replace(
        title=HOSTILE, provenance={key: Provenance("user", HOSTILE) for key in setup.robot.provenance}
    )
    source = setup.source
    assert source.kind == "program"
    return project.replace(
        setup=setup.replace(
            name=HOSTILE,
            description=HOSTILE,
            robot=robot,
            provenance=blocks,
            tools=ToolTable((TableTool(1, setup.cutter, name=HOSTILE),)),
            source=type(source)(source.text, HOSTILE, source.dialect),
        )
    )


@pytest.mark.parametrize("page", PAGES)
def test_words_of_a_file_are_words_on_every_page(app: AppTest, page: str) -> None:
    held = store(app)
    held.project = hostile(held.project)
    shown = go(app, page)
    assert not shown.exception
    parts = [element.proto.body for element in shown.get("html")]
    for part in parts:
        rest = OURS.sub("", part.split("</style>", 1)[-1] if part.startswith("<style>\n") else part)
        assert "<" not in rest, rest[:300]
    for kind in ("markdown", "caption", "error", "info", "warning"):
        for element in shown.get(kind):
            assert "![x](" not in element.value
            assert "[a](" not in element.value
            assert not re.search(r"(?<!\\):red\[", element.value)
            assert not getattr(element.proto, "allow_html", False) or "foreign" not in element.value
    for element in shown.main:
        for words_of in ("label", "help", "placeholder"):
            said = str(getattr(getattr(element, "proto", None), words_of, ""))
            assert "![x](" not in said, (element.type, words_of)
            assert "[a](" not in said, (element.type, words_of)
    assert page == "4_Identification" or "foreign.example" in html.unescape(words(shown)), (
        "the words themselves are there"
    )


def test_a_refused_file_is_quoted_as_words(app: AppTest) -> None:
    text = project_to_toml(store(app).project).replace("tolerance_mm = 0.3", f"tolerance_mm = {HOSTILE!r}")
    held = store(app)
    with pytest.raises(Exception, match="was not opened") as refused:
        _open(text.encode(), f"{HOSTILE}.toml")
    held.refused["project.file"] = (None, str(refused.value))
    said = errors(app.run())
    assert said
    for sentence in said:
        assert not re.search(r"(?<!\\)[<\[`$]", sentence)


def test_a_crash_tells_visitors_nothing_of_the_server(monkeypatch: pytest.MonkeyPatch) -> None:
    assert config.get_option("client.showErrorDetails") == "none"

    def page() -> None:
        open("/secret/place")  # noqa: SIM115

    shown = AppTest.from_function(page).run().exception
    assert shown
    assert not any(re.search(r"/|secret|\.py|line \d", str(element.proto)) for element in shown)
