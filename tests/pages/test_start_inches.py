"""Inches chosen: no metric length is left in any sentence, tile, axis, colour bar or hover of any page."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from conftest import PAGES, go, store
from numpy.typing import NDArray
from streamlit.testing.v1 import AppTest

from robomill.toolpath.part_zero import frame_from_points, points_of_frame
from robomill.ui.toolpath.part_zero import TOUCHED

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


def maps(app: AppTest) -> list[NDArray[np.float64]]:
    """The numbers of the maps that are drawn, one after the other."""
    drawn = [json.loads(chart.proto.spec) for chart in app.get("plotly_chart")]
    of = [trace["z"] for figure in drawn for trace in figure["data"] if trace["type"] == "heatmap"]
    return [np.frombuffer(base64.b64decode(z["bdata"]), z["dtype"]) for z in of]


def test_the_measured_map_and_the_laboratory_are_in_inches_too(app: AppTest) -> None:
    """The same maps in µin/N, and readings in inches."""
    go(app, "4_Identification")
    app.button_group(key="identification.section").set_value("map").run()
    in_um = maps(app)
    app.button_group(key="view.units").set_value("in").run()
    assert not metric(app)
    assert len(in_um) == len(maps(app)) == 3
    for uin, um in zip(maps(app), in_um, strict=True):
        np.testing.assert_allclose(uin * 25.4e-3, um, rtol=1e-5)
    app.button_group(key="identification.section").set_value("laboratory").run()
    app.button(key="identification.lab.three").click().run()
    assert not app.exception
    (readings,) = [frame.value for frame in app.dataframe if "dx, in" in frame.value]
    assert len(readings) == 3
    assert not [name for name in readings if "mm" in name]
    assert not metric(app)


def test_touched_points_are_said_to_be_off_in_inches(app: AppTest) -> None:
    app.button_group(key="view.units").set_value("in").run()
    held = store(app)
    touched = frame_from_points(*points_of_frame(held.project.setup.T_MW))
    held.project = held.project.replace(setup=held.project.setup.replace(T_MW=touched.T_MW))
    held.values[TOUCHED] = touched
    go(app, "5_Toolpath").button_group(key="toolpath.way").set_value("points").run()
    assert "if each point is off by 0.004 in" in "\n".join(text for _, text in said(app)).replace("\u00a0", " ")
