"""Work that lives on beyond the page, told on the start page: sessions of one browser, one after the other."""

from __future__ import annotations

import errno
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
from conftest import ROOT, NoPictures, store, words
from streamlit.testing.v1 import AppTest

from robomill.ui import rendered
from robomill.ui.keeping import autosave
from robomill.ui.keeping.settings import Settings
from robomill.ui.keeping.shelf import Shelf, place_of
from robomill.ui.keeping.writer import Writer
from robomill.viz.rendered.render_queue import RenderQueue

KEY, TAB, OTHER = "a1" * 32, "0" * 16, "1" * 16
Visit = Callable[..., AppTest]


@pytest.fixture
def writer(tmp_path: Path) -> Writer:
    return Writer(Shelf(Settings(folder=tmp_path / "work")))


@pytest.fixture
def visit(monkeypatch: pytest.MonkeyPatch, writer: Writer) -> Visit:
    """A new session of a browser that holds ``KEY``: a page that was loaded, and a moment later says its tab.

    ``cut_off``: a page that was open before its session, and says its tab at once.
    """
    queue = RenderQueue(NoPictures())
    monkeypatch.setattr(rendered, "queue", lambda: queue)
    monkeypatch.setattr(autosave, "writer", lambda: writer)
    said: dict[str, str | None] = {}
    monkeypatch.setattr(autosave, "_page", lambda **_: SimpleNamespace(**said))
    monkeypatch.setattr(autosave, "_cookie", lambda name: {"robomill_key": KEY}.get(name, ""))

    def load(tab: str = TAB, *, cut_off: bool = False) -> AppTest:
        assert writer.flush(20.0)
        said["tab"] = tab if cut_off else None
        app = AppTest.from_file(str(ROOT / "app.py"), default_timeout=60).run()
        said["tab"] = tab
        app.run()
        assert not app.exception
        return app

    return load


def inches(app: AppTest) -> None:
    app.button_group(key="view.units").set_value("in").run()


def other_preset(app: AppTest) -> None:
    app.selectbox(key="project.preset").set_value("pocket_arcs").run()


def rename(app: AppTest, writer: Writer, name: str) -> None:
    """An edit of the set-up that no preset has."""
    held = store(app)
    held.past = [*held.past, held.project]
    held.put(held.project.replace(setup=held.project.setup.replace(name=name, tolerance=1e-4)))
    assert writer.flush(20.0)


def test_an_edit_is_back_after_a_reload_and_undo_leads_behind_it(visit: Visit, writer: Writer) -> None:
    first = visit()
    assert "is back" not in words(first)
    before = store(first).project.digest()
    rename(first, writer, "mine")
    again = visit()
    assert "is back" in words(again)
    assert store(again).project.digest() == store(first).project.digest()
    again.button(key="undo").click().run()
    assert store(again).project.digest() == before
    assert "is back" not in words(again)


def test_an_untouched_preset_is_no_work_but_how_it_was_looked_at_stays(visit: Visit) -> None:
    app = visit()
    other_preset(app)
    inches(app)
    again = visit()
    assert store(again).project.preset == "pocket_arcs"
    assert store(again).project.view.units == "in"
    assert "is back" not in words(again)


def test_who_only_looks_around_leaves_nothing_on_the_server(visit: Visit, writer: Writer) -> None:
    visit()
    assert writer.flush(5.0)
    assert not writer.shelf.settings.folder.exists()


def test_what_came_back_can_be_discarded_and_had_again(visit: Visit, writer: Writer) -> None:
    rename(visit(), writer, "mine")
    app = visit()
    app.button(key="autosave.delete").click().run()
    assert store(app).project.setup.name != "mine"
    assert "is back" not in words(app)
    app.button(key="undo").click().run()
    assert store(app).project.setup.name == "mine"


def test_words_are_put_away_and_stay_away(visit: Visit, writer: Writer) -> None:
    rename(visit(), writer, "mine")
    app = visit()
    app.button(key="autosave.check").click().run()
    assert "is back" not in words(app.run())
    assert store(app).project.setup.name == "mine"


def test_a_new_tab_begins_with_the_last_work_and_each_keeps_its_own(visit: Visit, writer: Writer) -> None:
    first = visit()
    rename(first, writer, "of the first tab")
    second = visit(OTHER)
    assert "each goes its own way" in words(second)
    rename(second, writer, "of the second tab")
    rename(first, writer, "again of the first tab")
    assert store(visit(OTHER)).project.setup.name == "of the second tab"
    assert store(visit(TAB)).project.setup.name == "again of the first tab"


def test_a_doubled_tab_is_told_and_can_take_either(visit: Visit, writer: Writer) -> None:
    first, second = visit(), visit()
    rename(first, writer, "first")
    rename(second, writer, "second")
    second.run()
    assert "Another tab went on with this work" in words(second)
    assert store(second).project.setup.name == "second"
    second.button(key="autosave.swap_horiz").click().run()
    assert store(second).project.setup.name == "first"
    second.button(key="undo").click().run()
    assert store(second).project.setup.name == "second"


def test_a_page_whose_server_was_restarted_says_so_and_has_its_own_work(visit: Visit, writer: Writer) -> None:
    rename(visit(), writer, "mine")
    rename(visit(OTHER), writer, "of another tab")
    app = visit(cut_off=True)
    assert "was cut off from its server" in words(app)
    assert store(app).project.setup.name == "mine"


def test_a_page_that_was_cut_off_and_of_which_nothing_is_kept_does_not_take_another_tabs_work(
    visit: Visit, writer: Writer
) -> None:
    rename(visit(), writer, "mine")
    app = visit(OTHER, cut_off=True)
    assert "Nothing was kept of it" in words(app)
    assert store(app).project.setup.name != "mine"


def test_a_damaged_entry_is_one_quiet_sentence_and_work_goes_on(visit: Visit, writer: Writer) -> None:
    rename(visit(), writer, "mine")
    (file,) = writer.shelf.settings.folder.rglob("*.toml")
    file.write_bytes(file.read_bytes()[:-20])
    app = visit()
    assert "could not be opened" in words(app)
    assert "is damaged" in words(app)
    rename(app, writer, "new")
    assert store(visit()).project.setup.name == "new"


def test_what_this_robomill_does_not_read_is_said_handed_over_and_not_written_over(
    visit: Visit, writer: Writer
) -> None:
    writer.shelf.put(KEY, f"tab-{TAB}", ("old", 0.0), ['format = "of another time"\n'])
    app = visit()
    assert "Your work could not be opened" in words(app)
    assert app.get("download_button")
    rename(app, writer, "new")
    (aside,) = writer.shelf.settings.folder.rglob("*.aside")
    assert "of another time" in aside.read_text()
    assert store(visit()).project.setup.name == "new"


def test_a_server_that_cannot_write_says_so_where_one_saves(visit: Visit, writer: Writer, tmp_path: Path) -> None:
    (tmp_path / "work").write_text("a file where the folder should be")
    app = visit()
    rename(app, writer, "mine")
    assert "could not be kept on the server" in words(app.run())
    assert store(app).project.setup.name == "mine"


def test_a_page_says_by_itself_that_its_edit_is_not_kept_and_so_does_one_that_comes_after(
    visit: Visit, writer: Writer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(autosave, "SETTLED_S", 20.0)
    app = visit()
    other_preset(app)
    assert "could not be kept" not in words(app)
    assert writer.flush(20.0)

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(writer.shelf, "_write", full)
    store(app).values["autosave.line"].rests_until = 0.0
    inches(app)
    assert "could not be kept on the server: no space left on device. Save takes it away" in words(app)
    assert "could not be kept on the server" in words(visit(OTHER))


def test_a_browser_without_cookies_is_told_where_one_saves(visit: Visit, writer: Writer) -> None:
    app = visit("")
    assert "takes no cookies" in words(app.run())
    rename(app, writer, "mine")
    assert not writer.shelf.settings.folder.exists()


def test_a_server_that_keeps_nothing_says_so_where_one_saves(visit: Visit, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(autosave, "writer", lambda: None)
    app = visit()
    assert "keeps no work beyond the page" in words(app)
    assert "was cut off" in words(visit(cut_off=True))


def test_a_strange_key_is_replaced(visit: Visit, writer: Writer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(autosave, "_cookie", lambda name: "../../etc/passwd")
    rename(visit(), writer, "mine")
    (file,) = writer.shelf.settings.folder.rglob("*.toml")
    assert file.parent.parent == writer.shelf.settings.folder


def dialog(app: AppTest) -> AppTest:
    """The list of kept projects, opened."""
    return app.button(key="snapshots").click().run()


def kept_as(app: AppTest, name: str) -> None:
    dialog(app).text_input(key="snapshots.name").set_value(name).run()
    dialog(app).button(key="snapshots.keep").click().run()
    assert not app.exception


def test_a_project_is_kept_under_a_name_opened_again_and_deleted(visit: Visit, writer: Writer) -> None:
    app = visit()
    rename(app, writer, "mine")
    kept_as(app, "first try")
    rename(app, writer, "other")
    again = dialog(visit())
    assert "first try" in "\n".join(each.value for each in again.text)
    (opens,) = [each for each in again.button if each.key.startswith("snapshots.open.name")]
    opens.click().run()
    assert store(again).project.setup.name == "mine"
    again.button(key="undo").click().run()
    assert store(again).project.setup.name == "other"
    dialog(again)
    (deletes,) = [each for each in again.button if each.key.startswith("snapshots.delete")]
    deletes.click().run()
    assert "first try" not in "\n".join(each.value for each in dialog(again).text)
    again.button(key="snapshots.back").click().run()
    assert "first try" in "\n".join(each.value for each in dialog(again).text)


def test_a_kept_project_is_put_beside_the_one_in_force(visit: Visit, writer: Writer) -> None:
    app = visit()
    kept_as(app, "<b>as it came</b>")
    rename(app, writer, "mine")
    dialog(app)
    choice = app.button_group(key="snapshots.chosen")
    choice.set_value([place_of("<b>as it came</b>")]).run()
    assert not app.exception
    text = words(dialog(app))
    for word in ("In force", "&lt;b&gt;as it came", "Wall error", "Floor error", "Tolerance", "0.3 mm", "0.1 mm"):
        assert word in text
    assert "<b>as it came" not in text


def test_a_name_is_needed_and_no_more_are_kept_than_fit(visit: Visit, writer: Writer) -> None:
    app = visit()
    dialog(app).button(key="snapshots.keep").click().run()
    assert [e for e in dialog(app).error if "name" in e.value]


def test_work_of_another_tab_can_be_opened_here(visit: Visit, writer: Writer) -> None:
    rename(visit(), writer, "of the first tab")
    second = visit(OTHER)
    rename(second, writer, "of the second tab")
    dialog(second)
    (opens,) = [each for each in second.button if each.key == f"snapshots.open.tab-{TAB}"]
    opens.click().run()
    assert store(second).project.setup.name == "of the first tab"
