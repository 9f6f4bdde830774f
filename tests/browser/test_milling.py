"""The milling page in a browser: one scrubber moves everything, a click lands on its place, files come back."""

from __future__ import annotations

import io
import struct
import time
from pathlib import Path
from typing import Any

import pytest
from screenshots import boxes, until

pytestmark = pytest.mark.browser


def idle(page: Any) -> None:
    page.wait_for_timeout(200)
    page.wait_for_selector('[data-testid="stApp"][data-test-script-state="notRunning"]', timeout=60_000)


@pytest.fixture
def milling(page: Any, url: str) -> Any:
    """The milling page, drawn."""
    page.goto(f"{url}/Milling")
    page.wait_for_selector(".rm-tiles", timeout=60_000)
    idle(page)
    return page


def ask(page: Any, question: str) -> None:
    page.get_by_role("radio", name=question).or_(page.get_by_role("button", name=question)).first.click()
    idle(page)


def choose(page: Any, label: str, option: str) -> None:
    box = page.locator('[data-testid="stSelectbox"]').filter(has_text=label)
    box.locator('[role="combobox"], input').first.click()
    page.locator('[role="option"]').filter(has_text=option).first.click()
    idle(page)


def place(page: Any) -> str:
    """The line of text that says where the scrubber is."""
    return str(page.locator(".rm-lead b").first.locator("xpath=..").inner_text())


def test_the_sentence_leads_to_its_line_and_the_curve_can_be_clicked(milling: Any) -> None:
    page = milling
    choose(page, "Model", "mechanistic")
    page.get_by_text("Where does the tip go?").first.click()
    page.get_by_role("button", name="Go to worst").first.click()
    page.wait_for_selector("text=Program")
    page.wait_for_function(
        "() => [...document.querySelectorAll('.rm-lead')].some(e => e.innerText.includes('(50.00, 0.00, −2.00)'))",
        timeout=20_000,
    )
    idle(page)
    assert "Line 7" in place(page)
    assert "(50.00, 0.00, −2.00)" in place(page)
    figure = page.locator(".js-plotly-plot").first
    figure.locator(".nsewdrag").first.wait_for()
    figure.scroll_into_view_if_needed()
    page.wait_for_timeout(1200)
    plot = figure.locator(".nsewdrag").first.bounding_box()
    # Half way along, on the curve of the size: the axis runs from below zero to above the tolerance.
    dots = figure.locator(".scatterlayer .trace path.point")
    points = [dots.nth(k).bounding_box() for k in range(0, dots.count(), 10)]
    middle = plot["x"] + 0.5 * plot["width"]
    near = min((b for b in points if b), key=lambda b: abs(b["x"] + b["width"] / 2 - middle))
    page.mouse.click(near["x"] + near["width"] / 2, near["y"] + near["height"] / 2)
    idle(page)
    until(page, lambda: "(50.00" in place(page), wanted=False)


def test_the_scrubber_moves_code_section_and_point_without_the_whole_page(milling: Any) -> None:
    page = milling
    ask(page, "Where does the tip go?")
    slider = page.get_by_role("slider", name="Position along the cut").first
    slider.focus()
    before = place(page)
    times = []
    for _ in range(5):
        start = time.perf_counter()
        told = place(page)
        for _ in range(4):  # a step of the slider is finer than the samples of the path
            page.keyboard.press("ArrowRight")
        page.wait_for_function(
            "told => ![...document.querySelectorAll('.rm-lead')].some(e => e.innerText === told)",
            arg=told,
            timeout=20_000,
        )
        times.append(time.perf_counter() - start)
        idle(page)
    assert place(page) != before
    print(f"scrubber to new place: {min(times):.2f} s (best of {len(times)})")


def test_a_length_that_is_not_known_can_be_left_out_again(milling: Any) -> None:
    page = milling
    box = page.get_by_role("textbox", name="Stick-out, mm").first
    box.fill("32")
    box.press("Enter")
    idle(page)
    assert box.input_value() == "32.0"
    box.fill("")
    box.press("Enter")
    idle(page)
    assert box.input_value() == ""
    assert page.locator("[data-testid='stAlert']").count() == 0


def test_the_surface_comes_as_ply_and_a_film_as_gif(milling: Any, tmp_path: Path) -> None:
    from PIL import Image

    page = milling
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Surface PLY").click()
    waiting.value.save_as(tmp_path / "surface.ply")
    assert (tmp_path / "surface.ply").read_bytes().startswith(b"ply")
    page.get_by_role("button", name="Picture PNG").click()  # drawn when it is asked for
    with page.expect_download(timeout=60_000) as waiting:
        page.get_by_role("button", name="Save part.png").click(timeout=60_000)
    waiting.value.save_as(tmp_path / "groove.png")
    data = (tmp_path / "groove.png").read_bytes()
    if not data:
        pytest.skip("no OpenGL library here")
    assert struct.unpack(">II", data[16:24]) == (1360, 720)
    page.locator('[data-testid="stExpander"] summary').filter(has_text="Film of the cut").click()
    idle(page)
    page.get_by_role("slider", name="Pictures").focus()
    page.keyboard.press("Home")
    idle(page)
    page.get_by_role("button", name="Make the film").click()
    with page.expect_download(timeout=90_000) as waiting:
        page.get_by_role("button", name="Film GIF").click(timeout=80_000)
    waiting.value.save_as(tmp_path / "cut.gif")
    film = Image.open(io.BytesIO((tmp_path / "cut.gif").read_bytes()))
    assert film.n_frames >= 12
    assert film.size == (960, 544)


@pytest.mark.parametrize("width", [390, 800, 1024])
def test_in_a_narrow_window_inputs_stand_between_the_picture_and_the_questions(milling: Any, width: int) -> None:
    """They were below six charts, a film and downloads: at 390 px five screens down."""
    milling.set_viewport_size({"width": width, "height": 900})
    milling.wait_for_selector("text=Section at the position")
    milling.wait_for_timeout(500)

    keys = (".st-key-milling-look", "[data-testid='stMain'] .rm-tiles", ".st-key-milling-open-force")
    selectors = (*keys, ".st-key-milling-open-accuracy", ".st-key-milling-more")
    picture, tiles, force, accuracy, question = (box["y"] for box in boxes(*map(milling.locator, selectors)))
    assert picture < tiles < force <= accuracy < question


def test_each_group_of_inputs_says_its_value_beside_its_title(milling: Any) -> None:
    def said(name: str) -> str:
        script = f"getComputedStyle(document.querySelector('.st-key-milling-open-{name} summary'), '::after').content"
        return str(milling.evaluate(script)).strip('"')

    assert said("force") == "100 N"
    assert said("cutter") == "8 mm, 3 flutes"
    assert said("accuracy") == "0.30 mm"


def test_what_does_not_hang_on_the_inputs_stands_below_them_in_the_whole_width(milling: Any) -> None:
    """The column of inputs was empty below them for three screens; it stays in sight beside what answers them."""
    milling.set_viewport_size({"width": 1440, "height": 900})
    inputs = milling.locator("[data-testid=stColumn]:has(.st-key-milling-open-force) > [data-testid=stVerticalBlock]")
    wide, more = milling.locator(".st-key-milling-wide"), milling.locator(".st-key-milling-more")
    wide.get_by_text("Over the whole surface").wait_for()
    wide.get_by_text("Over the whole surface").scroll_into_view_if_needed()
    milling.wait_for_timeout(500)
    left, below, beside = boxes(inputs, wide, more)
    assert abs(below["x"] - left["x"]) < 2
    assert below["width"] > left["width"] + beside["width"]
    assert beside["x"] > left["x"] + left["width"]
    assert left["y"] + left["height"] <= below["y"] + 1, "nothing lies over another"
    more.get_by_text("Section at the position").scroll_into_view_if_needed()
    milling.wait_for_timeout(300)
    assert 0 < inputs.bounding_box()["y"] < 100, "the inputs stay beside what answers them"
