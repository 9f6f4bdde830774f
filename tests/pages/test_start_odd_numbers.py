"""Odd numbers in every box of every page, and in every key of how a project is looked at: a sentence, never a crash."""

from __future__ import annotations

import pytest
from conftest import PAGES, go, store
from streamlit.testing.v1 import AppTest

from robomill.errors import ProjectError
from robomill.ui.project import MapView, View, project_from_toml, project_to_toml

ODD = ("nan", "1e308", "1e-300", "-1.0", "0.0", "-1e308", "inf", "", "9" * 400, "1,220", "1/0", "5 foo", "words")


def each_box(app: AppTest, page: str) -> list[str]:
    """What crashes where a line of the page is given an odd number."""
    held, crashed = store(app), []
    good = held.project
    go(app, page)
    assert not app.get("number_input"), "a browser's own number box swallows what it does not understand"
    keys = [box.key for box in app.text_input if not box.disabled]
    for key in keys:
        for value in ODD:
            if key not in {box.key for box in app.text_input}:
                continue  # the page shows other boxes now
            app.text_input(key=key).set_value(value).run()
            crashed += [f"{page}, {key} = {value!r}: {e.message[:200]}" for e in app.exception]
        held.project, held.refused = good, {}
        app.run()
    assert keys or page in ("app", "7_Improve", "8_Learn", "2_Workspace", "4_Identification")
    return crashed


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES)
def test_every_odd_number_in_every_box_is_taken_or_refused(app: AppTest, page: str) -> None:
    assert not each_box(app, page)


LOOKS = {"view": View, "maps": MapView}
WRITTEN = (
    "nan",
    "inf",
    "-inf",
    "1e308",
    "1e-300",
    "-1.0",
    "0.0",
    '""',
    '"x"',
    "true",
    "[]",
    "[nan]",
    "[1e308]",
    "9" * 300,
)
LISTS = (
    "[nan, nan, nan, nan, nan]",
    "[1e5, 1e5, 1e5, 1e5, 1e5]",
    "[1e-300, 0, 0]",
    "[-1, -1, -1]",
    "[1e5, 1e5]",
    '["a"]',
)
LOOKED = [(table, name) for table, kind in LOOKS.items() for name in kind.__dataclass_fields__]


def opened(app: AppTest, table: str, name: str, value: str) -> bool:
    """Whether a project whose look says so is opened."""
    project = store(app).project
    text = project_to_toml(project.replace(maps=project.maps.of(project.setup.robot)))
    head, _, rest = text.partition(f"[{table}]\n")
    block, bar, tail = rest.partition("\n\n")
    block = "\n".join(line for line in block.splitlines() if not line.startswith(f"{name} ="))
    try:
        new = project_from_toml(f"{head}[{table}]\n{name} = {value}\n{block}{bar}{tail}")
    except ProjectError:
        return False
    store(app).project = new
    return True


@pytest.mark.parametrize(("table", "name"), LOOKED, ids=lambda word: word)
def test_odd_looks_of_a_project_are_taken_or_refused(app: AppTest, table: str, name: str) -> None:
    good = store(app).project
    page = "1_Robot" if table == "view" else "2_Workspace" if name in ("pair", "level", "quantity") else "3_Compliance"
    go(app, page)
    for value in WRITTEN + LISTS:
        if opened(app, table, name, value):
            assert not app.run().exception, f"[{table}] {name} = {value}"
        store(app).project = good


@pytest.mark.parametrize("value", ["[nan, nan, nan, nan, nan]", "nan", "[1e308, 0, 0, 0, 0]", "9" * 300])
def test_a_configuration_that_is_none_is_refused(app: AppTest, value: str) -> None:
    assert not opened(app, "view", "theta", value)
