"""Inches chosen: no metric length is left in any sentence, tile, axis, colour bar or hover of any page."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import pytest
from conftest import PAGES, go
from streamlit.testing.v1 import AppTest

METRIC = re.compile(r"(?<![\w_])(?:[µμ]m|mm|cm|m)(?:[²³]|/N|/min|/s|/tooth)?(?![\w'’_=])|(?<=\d)mm\b|/mm")
SOURCES = re.compile(r'<span class="rm-badge.*?(?:</td>|</p>)', re.DOTALL)  # who says a number, in that one's own words
KEPT = re.compile(  # torque, what a program is written in, units to choose from, and the program's own text
    r"N m\b|kN m\b|mm \(G21\)|^mm$|mm inch|\"lines\": \[.*?\]|\"codes\": \[.*?\]|in mm, true to size"
    # a file of load tests; the paper's table and the mathematics beside it, which say that they are in its units
    r"|# provenance: synthetic.*|<th class=\"w\">Of the paper.*?</table>|the paper&#x27;s units.*?</p>",
    re.DOTALL | re.MULTILINE,
)


def said(app: AppTest) -> Iterator[tuple[str, str]]:
    """Kind and text of every element."""

    def walk(node: Any) -> Iterator[tuple[str, str]]:
        children = getattr(node, "children", {})
        for child in children.values():
            yield from walk(child)
        proto = getattr(node, "proto", None)
        if proto is not None and not children:
            yield str(node.type), words(proto)

    yield from walk(app._tree)


def words(proto: Any) -> str:
    """What an element says, as people read it."""
    if hasattr(proto, "spec"):
        spec = re.sub(r'"bdata":"[^"]*"', "", str(proto.spec))
        return spec.encode().decode("unicode_escape").encode("latin1", "ignore").decode("utf8", "ignore")
    lines = []

    def of(message: Any) -> None:
        for field, value in message.ListFields():
            values = value if hasattr(value, "append") or hasattr(value, "add") else [value]
            for one in values:
                if hasattr(one, "ListFields"):
                    of(one)
                elif isinstance(one, str) and field.name not in (
                    "id",
                    "key",
                    "js",
                    "css",
                    "js_content",
                    "css_content",
                    "form_id",
                    "element_id",
                ):
                    lines.append(one)

    of(proto)
    return re.sub(r'"blob": ?"[^"]*"|data:image/\w+;base64,\S*', "", "\n".join(lines))


def metric(app: AppTest) -> list[tuple[str, str]]:
    """Every metric length that is read somewhere, with what stands around it."""
    found = []
    for kind, text in said(app):
        text = KEPT.sub("", SOURCES.sub("", text.replace("\u00a0", " ")))  # a unit is held together
        found += [(kind, text[max(0, at.start() - 60) : at.end() + 20]) for at in METRIC.finditer(text)]
    return list(dict.fromkeys(found))


@pytest.mark.parametrize("page", PAGES)
def test_no_metric_length_is_left_where_inches_are_chosen(app: AppTest, page: str) -> None:
    app.button_group(key="view.units").set_value("in").run()
    shown = go(app, page)
    left = metric(shown)
    assert not left, "\n".join(f"{kind}: {text}" for kind, text in left)
