"""Looking at the cut asks nobody: the picture follows the scrubber, plays and turns in the browser alone."""

from __future__ import annotations

import statistics
import time
from typing import Any

import pytest
from screenshots import page_paths, until

pytestmark = pytest.mark.browser

SETTLED_MS = 250

SCRUB = """async (root) => {
  const bar = root.querySelector('.station'), took = [];
  for (let n = 0; n < 20; n++) {
    const before = root.dataset.drawn, start = performance.now();
    bar.value = 300 + 5 * n;
    bar.dispatchEvent(new Event('input', { bubbles: true }));
    while (root.dataset.drawn === before) await new Promise(requestAnimationFrame);
    took.push(performance.now() - start);
  }
  return took;
}"""
PLAY = """(root) => new Promise((done) => {
  const seen = [], watch = new MutationObserver(() => seen.push([performance.now(), root.dataset.drawn]));
  watch.observe(root, { attributes: true, attributeFilter: ['data-drawn'] });
  root.querySelector('.play').click();
  setTimeout(() => { root.querySelector('.play').click(); watch.disconnect(); done(seen); }, 3000);
})"""
SHIFT = """() => { window.moved = 0; new PerformanceObserver((list) => {
  for (const entry of list.getEntries()) if (!entry.hadRecentInput) window.moved += entry.value;
}).observe({ type: 'layout-shift', buffered: true }); }"""


def idle(page: Any) -> None:
    page.wait_for_timeout(300)
    page.wait_for_selector('[data-testid="stApp"][data-test-script-state="notRunning"]', timeout=60_000)


def told(page: Any, sent: list[int]) -> bool:
    """Whether the server is told something within ten seconds."""
    for _ in range(100):
        if sent:
            return True
        page.wait_for_timeout(100)
    return False


def drawn(page: Any) -> dict[str, str]:
    """What the element says is drawn."""
    words = (page.locator(".live").get_attribute("data-drawn") or "").split()
    return {"station": words[0].partition("=")[2], "times": words[1], "camera": words[2], "view": words[3]}


@pytest.fixture
def sent(page: Any) -> list[int]:
    """Lengths of what the page sends to the server over its socket."""
    lengths: list[int] = []
    page.on("websocket", lambda socket: socket.on("framesent", lambda data: lengths.append(len(data))))
    return lengths


@pytest.fixture
def look(page: Any, url: str, sent: list[int]) -> Any:
    """The milling page with its cut drawn."""
    page.goto(f"{url}/Milling")
    page.wait_for_selector(".live[data-drawn]", timeout=60_000)
    idle(page)
    page.wait_for_timeout(500)
    sent.clear()
    return page


def test_a_step_of_the_scrubber_is_drawn_without_a_word_to_the_server(look: Any, sent: list[int]) -> None:
    took = look.locator(".live").evaluate(SCRUB)
    assert sent == [] or max(took) > SETTLED_MS, "a machine that pauses so long lets the scrubber settle"
    assert drawn(look)["station"] == "0.395"
    print(f"a step of the scrubber: median {statistics.median(took):.0f} ms (60 is the aim), most {max(took):.0f} ms")
    assert told(look, sent)
    idle(look)
    look.wait_for_function(
        "() => document.body.innerText.includes('(−10.50') || document.body.innerText.includes('(−11.00')"
        " || document.body.innerText.includes('(−10.00')",
        timeout=20_000,
    )


def test_it_plays_in_the_browser(look: Any, sent: list[int]) -> None:
    look.get_by_role("slider", name="Position along the cut").fill("0")
    assert told(look, sent)
    idle(look)
    look.wait_for_timeout(500)
    sent.clear()
    seen = look.locator(".live").evaluate(PLAY)
    assert sent == [], "nothing is told until it has stopped"
    stations = [float(words.split()[0].partition("=")[2]) for _, words in seen]
    assert stations == sorted(stations)
    assert 0.0 <= stations[0] < stations[-1] < 1.0, "three of the nine seconds that the whole cut takes"
    assert "so-far" in seen[0][1]
    print(f"played: {len(set(stations)) / 3.0:.1f} pictures a second; 20 is the aim on a quiet machine")
    assert told(look, sent)
    assert look.get_by_role("button", name="Play").count() == 1


def test_keys_exaggeration_camera_and_view_are_drawn_at_once_and_kept(look: Any, url: str) -> None:
    slider = look.get_by_role("slider", name="Position along the cut")
    slider.focus()
    look.keyboard.press("ArrowRight")
    look.wait_for_function("() => true")
    look.get_by_label("Exaggeration").select_option("50")
    look.get_by_label("Camera").select_option("top")
    look.get_by_role("radio", name="Arm").click()
    until(look, lambda: drawn(look), {"station": "0.505", "times": "x50", "camera": "top", "view": "arm"})
    assert "line 7" in (slider.get_attribute("aria-valuetext") or "")
    look.wait_for_timeout(600)
    idle(look)
    look.get_by_role("link", name="Robot").first.click()
    idle(look)
    look.get_by_role("link", name="Milling").first.click()
    look.wait_for_selector(".live[data-drawn]", timeout=60_000)
    until(look, lambda: drawn(look), {"station": "0.505", "times": "x50", "camera": "top", "view": "arm"})


def test_the_picture_is_turned_with_the_mouse(look: Any, sent: list[int]) -> None:
    box = look.locator(".live .picture").bounding_box()
    look.mouse.move(box["x"] + 200, box["y"] + 150)
    look.mouse.down()
    look.mouse.move(box["x"] + 260, box["y"] + 170, steps=4)
    look.mouse.up()
    until(look, lambda: drawn(look)["camera"], "turned")
    assert sent == []


def test_the_picture_is_on_the_first_screen_and_nothing_jumps(page: Any, url: str) -> None:
    page.add_init_script(f"({SHIFT})()")
    for width, height in ((1440, 900), (1024, 768)):
        page.set_viewport_size({"width": width, "height": height})
        start = time.perf_counter()
        page.goto(f"{url}/Milling")
        page.wait_for_selector(".live[data-drawn]", timeout=60_000)
        idle(page)
        page.wait_for_timeout(1500)
        stage = page.locator(".live .stage").bounding_box()
        moved, taken = page.evaluate("() => window.moved"), time.perf_counter() - start
        print(f"{width}: picture at {stage['y']:.0f} px, shift {moved:.3f}, {taken:.1f} s")
        assert stage["y"] < 44 + 200 if width == 1440 else stage["y"] + 200 < height
        assert stage["width"] > 600


def test_no_page_jumps_as_it_comes(page: Any, url: str) -> None:
    page.add_init_script(f"({SHIFT})()")
    moved: dict[str, float] = {}
    for name, path in page_paths().items():
        for _ in range(2):  # a page that jumps does so again; one that came late on a busy machine does not
            page.goto(url + path)
            idle(page)
            page.wait_for_timeout(1500)
            moved[name] = min(round(page.evaluate("() => window.moved"), 3), moved.get(name, 1.0))
            if moved[name] < 0.2:
                break
    print(f"shift: {moved}")
    assert max(moved.values()) < 0.2, "0.1 is the aim on a quiet machine"


BEFORE_ITS_PICTURE = """(split) => {
    document.querySelector('[data-testid="stApp"]').dataset.testScriptState = 'running';
    const [first, last] = document.querySelector(`.${split} [data-testid="stColumn"]`).parentElement.children;
    last.replaceChildren();
    return first.getBoundingClientRect().top - last.getBoundingClientRect().top;
}"""


@pytest.mark.parametrize("name", ["Robot", "Workspace", "Compliance", "Milling"])
def test_what_is_drawn_last_and_stands_first_has_its_room_before_it_comes(page: Any, url: str, name: str) -> None:
    """In a narrow window: what is typed stood in its place until then, and was pushed out of sight."""
    page.set_viewport_size({"width": 1024, "height": 768})
    page.goto(f"{url}/{name}")
    split = "st-key-split-milling" if name == "Milling" else "st-key-split-page"
    page.locator(f".{split}").wait_for()
    idle(page)
    assert page.evaluate(BEFORE_ITS_PICTURE, split) > 400


def test_without_webgl_a_sentence_and_the_rendered_picture_stand_there(page: Any, url: str) -> None:
    page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null;")
    page.goto(f"{url}/Milling")
    page.wait_for_selector(".live[data-drawn='none']", timeout=60_000)
    assert "draws no 3-D pictures" in page.locator(".live .instead").inner_text()
    rendered = page.locator("[class*='st-key-rendered-milling-picture'] img")
    rendered.or_(page.get_by_text("No picture can be drawn")).first.wait_for(timeout=60_000)
