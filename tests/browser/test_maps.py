"""The maps in a browser: looking through their planes asks nothing of the server, a click selects a pose, and what is
read off the screen is what the laws say."""

from __future__ import annotations

import re
import statistics
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from screenshots import until

from robomill.io.robot.robots import load_robot

pytestmark = pytest.mark.browser

MAP = "figure.map[data-drawn]"


def open_page(page: Any, name: str) -> None:
    page.wait_for_selector(".rm-tiles", timeout=60_000)
    page.get_by_test_id("stSidebarNavLink").filter(has_text=name).click()
    page.wait_for_selector(f".rm-kicker:has-text('{name} ·')", timeout=60_000)
    page.locator(MAP).first.wait_for(timeout=60_000)
    idle(page)


def idle(page: Any) -> None:
    page.wait_for_timeout(600)
    page.wait_for_selector('[data-testid="stApp"][data-test-script-state="notRunning"]', timeout=60_000)


def slider(page: Any) -> Any:
    return page.get_by_role("slider", name="Z, mm")


def drawn(page: Any, panel: int = 0) -> str:
    return str(page.locator(MAP).nth(panel).get_attribute("data-drawn"))


def cell(page: Any, panel: int, across: float, up: float) -> tuple[float, float]:
    """Where on the page the map ``panel`` has the point (mm) of the paper's box, X in ±600, Y in -1600 to -1000."""
    canvas = page.locator(MAP).nth(panel).locator("canvas")
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    left = 52 if panel % 3 == 0 else 0
    wide = box["width"] - left - 2
    high = wide * 620 / 1220
    return box["x"] + left + (across + 610) / 1220 * wide, box["y"] + (1 - (up + 1610) / 620) * high


def watch(page: Any) -> list[int]:
    """Sizes of what the page sends to the server from now on."""
    sent: list[int] = []
    page.on("websocket", lambda socket: socket.on("framesent", lambda frame: sent.append(len(frame))))
    page.reload()
    return sent


def compliance(theta: np.ndarray[Any, Any], point: tuple[float, float, float]) -> np.ndarray[Any, Any]:
    """C (3, 3) um/N at ``point`` from the robot's table and differences of forward kinematics written out here."""
    robot = load_robot("slavkovic_5r")

    def tip(q: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        T = np.array(robot.T_base)
        full = np.zeros(len(robot.d))
        full[: len(q)] = q
        for k in range(len(robot.d)):
            turn, push = robot.theta_offset[k] + robot.sign[k] * full[k], robot.d[k]
            ct, st, ca, sa = np.cos(turn), np.sin(turn), np.cos(robot.alpha[k]), np.sin(robot.alpha[k])
            R_z = np.array([[ct, -st, 0, 0], [st, ct, 0, 0], [0, 0, 1, push], [0, 0, 0, 1]])
            R_x = np.array([[1, 0, 0, robot.a[k]], [0, ca, -sa, 0], [0, sa, ca, 0], [0, 0, 0, 1]])
            T = T @ (R_z @ R_x if robot.convention == "standard" else R_x @ R_z)
        return np.asarray((T @ robot.T_tool)[:3, 3])

    np.testing.assert_allclose(tip(theta), point, atol=1e-7)
    step = 1e-6
    J = np.stack([(tip(theta + step * e) - tip(theta - step * e)) / (2 * step) for e in np.eye(len(theta))], axis=1)
    return J @ np.diag(robot.C_theta) @ J.T * 1e6


def posture(point: tuple[float, float, float]) -> np.ndarray[Any, Any]:
    import robomill as rm

    found = rm.inverse_kinematics(load_robot("slavkovic_5r"), rm.pose_from_world([*point, 0.0, 0.0]))
    assert found.reached
    return np.asarray(found.theta)


def test_the_plane_follows_the_slider_and_the_server_is_not_asked_until_it_settles(page: Any) -> None:
    page.wait_for_selector(".rm-tiles", timeout=60_000)
    sent = watch(page)
    open_page(page, "Compliance")
    assert drawn(page) == "0"
    assert page.locator(MAP).count() == 9
    slider(page).focus()
    page.wait_for_timeout(500)
    before = len(sent)
    for k in range(12):
        slider(page).press("ArrowLeft")
        assert drawn(page) == drawn(page, 8) == str(-10 * (k + 1))
    assert len(sent) == before, "looking through the planes asks nothing of the server"
    until(page, lambda: len(sent) > before, wanted=True)
    page.wait_for_timeout(1500)
    assert len(sent) <= before + 2, "the plane that was settled on goes to the server once"
    assert drawn(page) == "-120"


def test_the_settled_plane_is_there_again_after_another_page(page: Any) -> None:
    open_page(page, "Workspace")
    for _ in range(5):
        slider(page).press("ArrowLeft")
    assert drawn(page) == "-50"
    page.wait_for_timeout(900)
    idle(page)
    open_page(page, "Compliance")
    assert drawn(page) == "-50"
    assert page.get_by_role("button", name="Undo").first.is_disabled(), "looking is no step to undo"


@pytest.mark.parametrize("point", [(200.0, -1200.0), (-400.0, -1500.0)])
def test_a_value_read_off_a_map_is_what_the_laws_say_there(page: Any, point: tuple[float, float]) -> None:
    open_page(page, "Compliance")
    for _ in range(10):
        slider(page).press("ArrowLeft")
    assert drawn(page) == "-100"
    place = (point[0] * 1e-3, point[1] * 1e-3, -0.1)
    C = compliance(posture(place), place)
    for panel in range(9):
        page.mouse.move(*cell(page, panel, *point))
        tip = page.locator(".maps .tip")
        words = tip.inner_text()
        where = f"X {point[0]:.0f}, Y {point[1]:.0f}, Z -100 mm".replace("-", "−")
        assert where in words
        value = float(re.search(r"([−\d.]+) µm/N", words).group(1).replace("−", "-"))  # type: ignore[union-attr]
        assert value == pytest.approx(C[panel // 3, panel % 3], abs=6e-4)


def test_a_click_on_a_map_selects_its_pose(page: Any) -> None:
    open_page(page, "Compliance")
    report = page.locator("h2", has_text="At the selected point")
    assert "(0, −1300, 0) mm" in report.inner_text()
    page.mouse.click(*cell(page, 4, 400.0, -1100.0))
    page.locator("h2", has_text="At the selected point (400, −1100, 0) mm").wait_for(timeout=30_000)
    assert "at (400, −1100, 0) mm" in " ".join(page.locator(".rm-tile").first.inner_text().split())
    C = compliance(posture((0.4, -1.1, 0.0)), (0.4, -1.1, 0.0))
    assert f"{C[1, 1]:.3f}" in page.locator(".rm-tile").first.inner_text()
    idle(page)
    page.mouse.click(*cell(page, 0, -300.0, -1400.0))
    page.locator("h2", has_text="At the selected point (−300, −1400, 0) mm").wait_for(timeout=30_000)


def test_x_and_y_have_the_same_scale(page: Any) -> None:
    for name in ("Workspace", "Compliance"):
        open_page(page, name)
        box = page.locator(MAP).last.locator("canvas").bounding_box()
        left = 52 if name == "Workspace" else 0
        assert (box["width"] - left - 2) / (box["height"] - 40 - 2) == pytest.approx(1220 / 620, rel=0.02)


def test_table_2_against_table_3_in_two_clicks(page: Any) -> None:
    open_page(page, "Compliance")
    page.get_by_role("radio", name="Compare", exact=True).or_(
        page.get_by_role("button", name="Compare", exact=True)
    ).first.click()
    page.locator(MAP, has_text="Table 3 − Table 2").wait_for(timeout=30_000)
    tile = page.get_by_text("+16 % against Table 2")
    tile.wait_for(timeout=30_000)
    assert tile.is_visible()


def test_keys_walk_over_a_map_and_select(page: Any) -> None:
    open_page(page, "Compliance")
    panel = page.locator(MAP).nth(4)
    assert "over the plane Z = 0 mm: 1.90 … 2.52" in str(panel.get_attribute("aria-label"))
    panel.focus()
    for key in ("ArrowLeft", "ArrowLeft", "ArrowUp"):
        panel.press(key)
    assert "X −20, Y −1280, Z 0 mm" in page.locator(".maps .tip").inner_text()
    panel.press("Enter")
    page.locator("h2", has_text="At the selected point (−20, −1280, 0) mm").wait_for(timeout=30_000)


def times(page: Any, steps: int, moved: Callable[[int], str]) -> list[float]:
    """ms from each key to the frame after another plane was drawn."""
    page.evaluate(WATCH)
    found = []
    for k in range(steps):
        slider(page).press(moved(k))
        page.wait_for_function("window.shown.length > 0", timeout=20_000)
        found.append(float(page.evaluate("window.shown.splice(0)[0]")))
        page.wait_for_timeout(120)
    return found


# From the key's own time to the frame after data-drawn was set, looked for in every shadow root.
WATCH = """() => {
  const find = (root) => root.querySelector('figure.map') ??
    [...root.querySelectorAll('*')].map((e) => e.shadowRoot && find(e.shadowRoot)).find(Boolean);
  const map = find(document);
  window.shown = [];
  let pressed = 0;
  addEventListener('keydown', (event) => { pressed = event.timeStamp; }, true);
  new MutationObserver(() => requestAnimationFrame(() => requestAnimationFrame((now) => {
    window.shown.push(performance.now() - pressed);
  }))).observe(map, { attributes: true, attributeFilter: ['data-drawn'] });
}"""


@pytest.mark.benchmark
def test_a_step_of_the_slider_is_on_the_screen_at_once(page: Any) -> None:
    """Median of 30 below 60 ms, from the key to the frame after the nine maps were drawn, on a quiet machine."""
    open_page(page, "Compliance")
    slider(page).focus()
    found = times(page, 30, lambda k: "ArrowLeft" if k % 10 < 5 else "ArrowRight")
    print(f"a step of the slider: median {statistics.median(found):.0f} ms, longest {max(found):.0f} ms")
    assert statistics.median(found) < 60


def test_no_value_of_a_contour_stands_under_the_selected_point(page: Any) -> None:
    open_page(page, "Compliance")
    drawn_at = """root => root.board.shown.map((made) => ({ words: made.words,
        at: [made.x(root.board.data.point[0]), made.y(root.board.data.point[1])] }))"""
    panels = page.locator(".maps").first.evaluate(drawn_at)
    assert sum(len(each["words"]) for each in panels) > 5
    for each in panels:
        x, y = each["at"]
        assert all(abs(at[0] - x) > 18 or abs(at[1] - y) > 9 for at in (label["at"] for label in each["words"]))
