"""Work survives what happens to pages and servers: reload, kill -9, two tabs, a page closed in the middle of a run."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from screenshots import idle, until
from server import Server

pytestmark = pytest.mark.browser
NOTICE = ".st-key-autosave-notice"
TABLE_2, TABLE_3 = "text=by +0.230 mm along Y", "text=by +0.264 mm along Y"


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Server]:
    made = Server(tmp_path / "work")
    made.start()
    yield made
    made.stop()


def robot_page(browser: Any, server: Server) -> Any:
    """A new tab on the Robot page that has said which tab it is."""
    page = browser.new_page()
    page.goto(f"{server.url}/Robot")
    page.wait_for_selector("text=moves the tip")
    idle(page)
    page.wait_for_function("sessionStorage.getItem('robomill.tab')")
    page.wait_for_timeout(1500)
    idle(page)
    return page


def choose(page: Any, server: Server, table: str, sign: str) -> None:
    """Put the compliances of one of the paper's tables in force, and wait until the server has them kept: a moment
    later, or as much later as the machine is busy."""
    before = time.time()
    page.get_by_text(table, exact=True).click()
    page.wait_for_selector(sign)
    idle(page)
    until(page, lambda: any(file.stat().st_mtime >= before for file in server.folder.glob("*/*.toml")), wanted=True)


def test_an_edit_is_back_after_a_reload_and_can_be_discarded_and_had_again(browser: Any, server: Server) -> None:
    page = robot_page(browser, server)
    choose(page, server, "Table 3", TABLE_3)
    page.reload()
    page.wait_for_selector(f"{NOTICE} >> text=is back")
    page.wait_for_selector(TABLE_3)
    page.get_by_role("button", name="Discard").click()
    page.wait_for_selector(TABLE_2)
    page.get_by_role("button", name="Undo").click()
    page.wait_for_selector(TABLE_3)


def test_a_deep_link_has_the_work_too(browser: Any, server: Server) -> None:
    choose(robot_page(browser, server), server, "Table 3", TABLE_3)
    page = browser.new_page()
    page.goto(f"{server.url}/Compliance?from=a-link")
    page.wait_for_selector(f"{NOTICE} >> text=is back")
    assert "robomill_key" not in page.url


def test_a_killed_server_comes_back_with_the_work_and_the_page_says_so_by_itself(browser: Any, server: Server) -> None:
    page = robot_page(browser, server)
    choose(page, server, "Table 3", TABLE_3)
    server.kill()
    page.wait_for_timeout(1000)
    server.start()
    page.wait_for_selector(f"{NOTICE} >> text=cut off from its server")
    page.wait_for_selector(TABLE_3)


def test_the_edit_of_the_moment_when_the_server_dies_is_not_lost(browser: Any, server: Server) -> None:
    page = robot_page(browser, server)
    choose(page, server, "Table 3", TABLE_3)
    page.goto(f"{server.url}/Milling")
    box = page.get_by_label("Diameter").first
    box.wait_for()
    idle(page)
    page.wait_for_timeout(2000)
    server.send(signal.SIGSTOP)  # it no longer listens, the edit goes out, then it is gone
    box.fill("10")
    box.press("Enter")
    page.wait_for_timeout(700)
    server.kill()
    server.start()
    page.wait_for_selector(f"{NOTICE} >> text=The change that was on its way is in it")
    idle(page)
    assert float(page.get_by_label("Diameter").first.input_value()) == 10.0
    page.get_by_test_id("stSidebarNavLink").filter(has_text="Robot").click()
    page.wait_for_selector(TABLE_3)


def test_two_tabs_keep_their_own_work_through_reloads_and_a_restart(browser: Any, server: Server) -> None:
    first = robot_page(browser, server)
    choose(first, server, "Table 3", TABLE_3)
    second = robot_page(browser, server)
    second.wait_for_selector(f"{NOTICE} >> text=each goes its own way from here")
    second.wait_for_selector(TABLE_3)
    choose(second, server, "Table 2", TABLE_2)
    for page, sign in ((first, TABLE_3), (second, TABLE_2)):
        page.bring_to_front()
        page.reload()
        page.wait_for_selector(sign)
        idle(page)
        page.wait_for_timeout(1500)
        page.wait_for_selector(sign)
    server.kill()
    server.start()
    for page, sign in ((first, TABLE_3), (second, TABLE_2)):
        page.bring_to_front()
        page.wait_for_selector(f"{NOTICE} >> text=cut off from its server")
        page.wait_for_selector(sign)


def test_a_doubled_tab_takes_a_name_of_its_own_so_that_neither_loses_its_work(browser: Any, server: Server) -> None:
    first = robot_page(browser, server)
    choose(first, server, "Table 3", TABLE_3)
    with browser.expect_page() as opened:  # a window that a page opens begins with a copy of all that the tab holds
        first.evaluate("window.open(location.href)")
    second = opened.value
    second.wait_for_selector(TABLE_3)
    idle(second)
    name = "sessionStorage.getItem('robomill.tab')"
    second.wait_for_function(f"first => {name} !== first", arg=first.evaluate(name))
    second.wait_for_timeout(1500)
    names = [page.evaluate(name) for page in (first, second)]
    assert len(set(names)) == 2
    choose(second, server, "Table 2", TABLE_2)
    for page, sign in ((first, TABLE_3), (second, TABLE_2), (first, TABLE_3)):
        page.reload()
        page.wait_for_selector(sign)
        idle(page)
        page.wait_for_timeout(1500)
        page.wait_for_selector(sign)
    assert [page.evaluate(name) for page in (first, second)] == names


def test_a_page_closed_in_the_middle_of_a_run_loses_nothing(browser: Any, server: Server) -> None:
    page = robot_page(browser, server)
    page.get_by_text("Table 3", exact=True).click()
    page.wait_for_timeout(120)
    page.close()
    page = browser.new_page()
    page.goto(f"{server.url}/Robot")
    page.wait_for_selector(TABLE_3)
    page.wait_for_selector(f"{NOTICE} >> text=is back")
