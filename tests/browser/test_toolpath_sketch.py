"""Sketching with the mouse: a slot on the pad is in the table, is simulated, and has its deviation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from screenshots import until

from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.simulation.run import simulate
from robomill.toolpath.gcode import read_gcode
from robomill.toolpath.sketch import Element, Sketch
from robomill.toolpath.source import SketchSource

pytestmark = pytest.mark.browser

PAD = '[data-testid="sketch-pad"]'
BAD = "G21 G90\nG0 X0 Y0 Z1\nG1 Z-1 F100\nG2 X10 Y0 I3 J0\nM2\n"
GOOD = "G21 G90\nG0 X-20 Y-10 Z1\nM8\nG1 Z-2 F300\nX20 F1200\nG3 X20 Y10 J10\nG1 X-20\nM9\nG0 Z5\nM2\n"


def idle(page: Any) -> None:
    page.wait_for_timeout(250)
    page.wait_for_selector('[data-testid="stApp"][data-test-script-state="notRunning"]', timeout=60_000)


@pytest.fixture
def toolpath(page: Any) -> Any:
    """The toolpath page."""
    page.get_by_test_id("stSidebarNavLink").filter(has_text="Toolpath").click()
    page.wait_for_selector(".rm-kicker:has-text('Toolpath')")
    idle(page)
    return page


@pytest.fixture
def board(toolpath: Any) -> Any:
    """The pad, emptied."""
    toolpath.get_by_role("radio", name="Sketch").or_(
        toolpath.get_by_role("button", name="Sketch", exact=True)
    ).first.click()
    svg = toolpath.locator(f"{PAD} .board > svg")
    svg.wait_for()
    idle(toolpath)
    svg.locator(".hit").first.click(button="right", position={"x": 60, "y": 1}, force=True)
    toolpath.get_by_text("There is no path yet.").wait_for(timeout=20_000)
    idle(toolpath)
    return svg


def place(board: Any, x: float, y: float) -> tuple[float, float]:
    """Where the point (x, y) of the board is on the screen: two labels of each axis tell."""
    pixels = board.evaluate(
        """(svg) => {
          const ticks = [...svg.querySelectorAll('text.tick')].map((t) => ({
            at: t.getAttribute('text-anchor') === 'middle' ? 'x' : 'y', value: Number(t.textContent.replace('−', '-')),
            u: Number(t.getAttribute('x')), v: Number(t.getAttribute('y')) - 4,
          })).filter((t) => !Number.isNaN(t.value));
          const along = (name, key) => { const some = ticks.filter((t) => t.at === name);
            const [a, b] = [some[0], some[some.length - 1]];
            return [a.value, a[key], (b[key] - a[key]) / (b.value - a.value)]; };
          const box = svg.getBoundingClientRect();
          return { x: along('x', 'u'), y: along('y', 'v'), left: box.left, top: box.top };
        }"""
    )
    u, v = (p[1] + (w - p[0]) * p[2] for p, w in ((pixels["x"], x), (pixels["y"], y)))
    return pixels["left"] + u, pixels["top"] + v


def drag(page: Any, board: Any, start: tuple[float, float], end: tuple[float, float]) -> None:
    page.mouse.move(*place(board, *start))
    page.mouse.down()
    page.mouse.move(*place(board, *end), steps=6)
    page.mouse.up()
    idle(page)


def points(page: Any) -> list[str]:
    """The column of points in the table beside the pad."""
    cells = page.get_by_test_id("stDataFrame").first.locator("canvas [role=gridcell][aria-colindex='3']")
    return [text for text in cells.all_text_contents() if text]


def see(page: Any, expected: list[str]) -> None:
    """Wait until the table shows these points; it draws a moment after the project has changed."""
    until(page, lambda: points(page), expected)


def test_a_slot_is_sketched_seen_in_the_table_and_simulated(toolpath: Any, board: Any) -> None:
    page = toolpath
    page.locator(f"{PAD} [data-name=line]").click()
    drag(page, board, (-40, 10), (40, 10))
    page.wait_for_selector(".rm-lead:has-text('1 shape, 80.0 ')", timeout=20_000)
    see(page, ["-40, 10; 40, 10"])
    tile = page.locator(".rm-tile", has_text="Wall error").locator(".rm-value")
    slot = Sketch((Element("line", np.array([[-0.04, 0.01], [0.04, 0.01]]), 2e-3, 30e-3),))
    setup = load_setup(samples_dir() / "paper_flute").replace(source=SketchSource(slot), stock=None)
    expected = f"{simulate(setup).verdict.wall.value * 1e3:+.3f}"
    shown = tile.inner_text().replace("\n", " ").split("mm")[0].strip()
    assert shown == expected, page.locator(".rm-title, .rm-lead, .rm-tile").all_inner_texts()

    page.get_by_test_id("stSidebarNavLink").filter(has_text="Milling").click()
    # A force stated along the path says nothing of the plunge at the start of the slot.
    page.wait_for_selector(".rm-lead:has-text('are not judged')", timeout=30_000)
    page.get_by_test_id("stSidebarNavLink").filter(has_text="Toolpath").click()
    page.wait_for_selector(f"{PAD} .line", state="attached", timeout=30_000)
    idle(page)
    see(page, ["-40, 10; 40, 10"])

    with page.expect_download() as download:
        page.get_by_role("button", name="G-code of this sketch").click()
    path = read_gcode(Path(download.value.path()).read_text())
    cut = path.p[path.cutting & (path.v_f > 0.02)]
    np.testing.assert_allclose(cut[-1], [0.04, 0.01, -0.002], atol=1e-9)


def test_draw_move_delete_and_undo(toolpath: Any, board: Any) -> None:
    page = toolpath
    page.locator(f"{PAD} [data-name=rectangle]").click()
    page.mouse.click(*place(board, -30, -20))
    page.mouse.click(*place(board, 10, 10))
    idle(page)
    see(page, ["-30, -20; 10, 10"])

    page.locator(f"{PAD} [data-name=polyline]").click()
    for q in ((20, -20), (40, -20), (40, 20), (20, -20)):
        page.mouse.click(*place(board, *q))
    see(page, ["-30, -20; 10, 10", "20, -20; 40, -20; 40, 20"])
    assert board.locator(".line").count() == 2

    page.locator(f"{PAD} [data-name=select]").click()
    drag(page, board, (10, 10), (5, 20))
    see(page, ["-30, -20; 5, 20", "20, -20; 40, -20; 40, 20"])
    page.keyboard.press("Control+z")
    see(page, ["-30, -20; 10, 10", "20, -20; 40, -20; 40, 20"])
    page.keyboard.press("Control+y")
    see(page, ["-30, -20; 5, 20", "20, -20; 40, -20; 40, 20"])

    page.mouse.click(*place(board, -10, -20), button="right")
    see(page, ["20, -20; 40, -20; 40, 20"])


def test_quick_clicks_are_all_kept_and_keys_draw_too(toolpath: Any, board: Any) -> None:
    """Twelve clicks in about a second: twelve points, while Python simulates beside."""
    page = toolpath
    page.locator(f"{PAD} [data-name=polyline]").click()
    corners = [(5 * i - 30, 10 * (i % 2)) for i in range(12)]
    where = [place(board, *q) for q in corners]
    for q in where:
        page.mouse.click(*q)
        page.wait_for_timeout(60)
    page.keyboard.press("Enter")
    see(page, ["; ".join(f"{x}, {y}" for x, y in corners)])

    # And without a mouse: letters choose tools, arrows move the cursor, Enter sets a point.
    for _ in range(14):
        page.keyboard.press("Control+z")
        page.wait_for_timeout(350)
    see(page, ["-50, 0; 50, 0"])
    assert board.is_visible(), "the board's own undo stays with the sketch"
    board.focus()
    for key in ("l", "ArrowLeft", "ArrowLeft", "Enter", *(["ArrowRight"] * 6), "ArrowUp", "Enter"):
        page.keyboard.press(key)
    see(page, ["-50, 0; 50, 0", "15, 10; 45, 15"])
    page.keyboard.press("v")
    for key in ("Enter", "ArrowUp", "Enter"):
        page.keyboard.press(key)
    see(page, ["-50, 0; 50, 0", "15, 10; 45, 20"])
    assert "Sketch pad with 2 shapes" in str(board.get_attribute("aria-label"))


def test_a_finding_leads_to_its_line(toolpath: Any, tmp_path: Path) -> None:
    """A dropped program: its findings stand beside the code, a click on a line marks its place."""
    page = toolpath
    file = tmp_path / "PART.NC"
    file.write_text(GOOD)
    page.locator('input[type="file"]').first.set_input_files(file)
    page.wait_for_selector(".rm-kicker:has-text('PART.NC')", timeout=20_000)
    idle(page)
    row = page.locator('.row[data-line="6"]')
    row.click()
    page.get_by_text("Line 6: G3 X20 Y10 J10").wait_for(timeout=20_000)
    assert "on" in str(row.get_attribute("class")).split()
    page.keyboard.press("ArrowUp")
    page.get_by_text("Line 5: X20 F1200").wait_for(timeout=20_000)

    bad = tmp_path / "bad.nc"
    bad.write_text(BAD)
    page.locator('input[type="file"]').first.set_input_files(bad)
    page.get_by_text("bad.nc was not taken. Line 4").wait_for(timeout=20_000)
    assert page.locator('.row.on[data-line="4"]').count() == 1
    assert page.locator(".rm-kicker:has-text('PART.NC')").count() == 1, "the program before stays in force"
