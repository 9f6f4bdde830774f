"""The drawing process: pictures come back, deaths are survived and told truly, and a machine without GL says so."""

from __future__ import annotations

import io
import os
import select
import signal
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from robomill import extras
from robomill.errors import MissingExtraError, RenderError
from robomill.viz.rendered import worker as worker_module
from robomill.viz.rendered.picture import SurfacePicture
from robomill.viz.rendered.worker import RenderWorker

ECHO = """
import os, pickle, sys, time
out = os.fdopen(os.dup(1), "wb"); os.dup2(2, 1)
def say(answer): pickle.dump(answer, out); out.flush()
BEFORE_LOADING
say(("loaded", None))
BEFORE_READY
say(("ready", None))
while True:
    wish = pickle.load(sys.stdin.buffer)
    if wish == "die": os.abort()
    if wish == "killed": os.kill(os.getpid(), 9)
    if wish == "memory": os._exit(12)
    if wish == "code": print("the last words", file=sys.stderr, flush=True); os._exit(3)
    if wish == "hang": time.sleep(60)
    if wish.startswith("once "):
        if not os.path.exists(wish[5:]): open(wish[5:], "w").close(); os.kill(os.getpid(), 9)
    if wish.startswith("tenth "):
        with open(wish[6:], "a") as file: file.write("x")
        if os.path.getsize(wish[6:]) <= 10: os.kill(os.getpid(), 9)
    say(("error", "no such thing") if wish == "refuse" else ("png", ("got " + wish).encode()))
"""


def fake(timeout_s: float = 20.0, loading: str = "", ready: str = "") -> RenderWorker:
    """A drawing process of few words, that runs these lines before it says that it has loaded, or is ready."""
    text = ECHO.replace("BEFORE_LOADING", loading).replace("BEFORE_READY", ready)
    return RenderWorker(timeout_s, (sys.executable, "-c", text))


def short_pauses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(worker_module, "LONGEST_PAUSE_S", 0.01)


def kill(worker: RenderWorker) -> None:
    """As the system does, or somebody by hand."""
    process = worker._process
    assert process is not None
    os.kill(process.pid, signal.SIGKILL)
    process.wait()


def test_messages_of_any_size_come_back() -> None:
    worker = fake()
    for wish in ("a", "b" * 3_000_000, "c"):
        assert worker.render(wish) == ("got " + wish).encode()
    worker.close()


def test_a_drawing_error_is_a_sentence_and_the_process_lives_on() -> None:
    worker = fake()
    with pytest.raises(RenderError, match="no such thing"):
        worker.render("refuse")
    assert worker.render("again") == b"got again"
    worker.close()


def test_a_process_killed_ten_times_between_pictures_is_started_again() -> None:
    worker = fake()
    for n in range(10):
        assert worker.render(f"{n}") == f"got {n}".encode()
        kill(worker)
    assert not worker.down
    assert worker.render("after") == b"got after"
    worker.close()


def test_a_process_killed_in_mid_picture_is_started_again_for_it(tmp_path: Path) -> None:
    worker = fake()
    wish = f"once {tmp_path / 'mark'}"
    assert worker.render(wish) == b"got " + wish.encode()
    worker.close()


@pytest.mark.parametrize(
    ("wish", "said"),
    [
        ("killed", "was killed (signal 9)"),
        ("die", "crashed (signal 6, SIGABRT)"),
        ("memory", "ran out of memory"),
        ("code", "ended with code 3: the last words"),
    ],
)
def test_the_reason_of_a_death_is_the_true_one_and_others_are_served(wish: str, said: str) -> None:
    worker = fake()
    with pytest.raises(RenderError) as caught:
        worker.render(wish)
    assert said in str(caught.value)
    assert "OpenGL" not in str(caught.value)
    assert caught.value.again_s is not None
    assert not worker.down
    assert worker.refusal is None
    assert worker.render("another's") == b"got another's"
    with pytest.raises(RenderError, match="tried again in"):  # not drawn again before its pause is over
        worker.render(wish)
    worker.close()


def test_ten_deaths_of_one_picture_and_it_is_drawn_after_all(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    short_pauses(monkeypatch)
    worker, count = fake(), tmp_path / "count"
    wish = f"tenth {count}"
    for _ in range(9):
        with pytest.raises(RenderError, match="signal 9"):
            worker.render(wish)
        assert worker.render("another's") == b"got another's"
        time.sleep(0.02)
    assert worker.render(wish) == b"got " + wish.encode()
    assert len(count.read_text()) >= 10
    worker.close()


def test_pauses_grow_and_end(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [1000.0]
    monkeypatch.setattr(worker_module.time, "monotonic", lambda: now[0])
    failures = worker_module.Failures()
    pauses = []
    for _ in range(12):
        failures.note("It was killed.")
        pauses.append(failures.left_s)
        now[0] += failures.left_s
        assert failures.left_s == 0.0
    for _ in range(2000):  # the machine's library is missing for a day
        failures.note("It was killed.")
    assert failures.left_s == 60.0
    assert pauses == [0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 60.0, 60.0, 60.0, 60.0, 60.0]


def test_a_machine_without_opengl_names_the_command_that_mends_it() -> None:
    worker = fake(ready="os.kill(os.getpid(), 11)")
    with pytest.raises(RenderError, match="apt-get install -y libegl1 libgl1-mesa-dri"):
        worker.render("any")
    assert worker.down
    assert worker.refusal is not None
    with pytest.raises(RenderError, match="apt-get"):
        worker.render("other")
    worker.close()


@pytest.mark.parametrize(
    ("loading", "said"),
    [
        ("os.kill(os.getpid(), 9)", "killed (signal 9)"),
        ("raise ModuleNotFoundError('no vtk here')", "ended with code 1: ModuleNotFoundError: no vtk here"),
        ("time.sleep(60)", "longer than 1.5 s"),
    ],
)
def test_what_does_not_start_is_told_truly(loading: str, said: str) -> None:
    worker = fake(1.5, loading=loading)
    with pytest.raises(RenderError) as caught:
        worker.render("any")
    assert said in str(caught.value)
    assert "OpenGL" not in str(caught.value)
    worker.close()


def test_a_process_killed_while_it_starts_is_started_again(tmp_path: Path) -> None:
    mark = tmp_path / "mark"
    once = f"p = {str(mark)!r}\nif not os.path.exists(p): open(p, 'w').close(); os.kill(os.getpid(), 9)"
    worker = fake(loading=once)
    worker.start()
    assert worker.render("any") == b"got any"
    worker.close()


def test_what_could_not_start_starts_once_it_can(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    short_pauses(monkeypatch)
    mark = tmp_path / "library"
    worker = fake(ready=f"if not os.path.exists({str(mark)!r}): os.kill(os.getpid(), 11)")
    with pytest.raises(RenderError, match="OpenGL"):
        worker.render("any")
    mark.touch()
    time.sleep(0.02)
    assert worker.render("any") == b"got any"
    assert not worker.down
    worker.close()


def test_a_death_while_two_wait_serves_both(tmp_path: Path) -> None:
    worker = fake()
    answers: list[bytes] = []
    wishes = [f"once {tmp_path / name}" for name in "ab"]
    threads = [threading.Thread(target=lambda w=w: answers.append(worker.render(w))) for w in wishes]  # type: ignore[misc]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30)
    assert sorted(answers) == sorted(b"got " + wish.encode() for wish in wishes)
    worker.close()


def test_a_hang_is_ended_and_the_next_picture_comes() -> None:
    worker = fake(timeout_s=1.5)
    with pytest.raises(RenderError, match="longer than 1.5 s"):
        worker.render("hang")
    assert worker.render("next") == b"got next"
    worker.close()


def test_a_process_that_takes_no_picture_is_ended_in_time() -> None:
    """More than a pipe holds, so that the writing waits, not the reading."""
    worker = fake(timeout_s=1.5, ready="say(('ready', None)); time.sleep(60)")
    began = time.monotonic()
    with pytest.raises(RenderError, match="longer than 1.5 s"):
        worker.render("x" * 5_000_000)
    assert time.monotonic() - began < 6.0
    worker.close()


def test_it_needs_nothing_that_windows_lacks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(os, "set_blocking")
    monkeypatch.delattr(os, "nice")
    there = SimpleNamespace(SIGSEGV=signal.SIGSEGV, SIGABRT=signal.SIGABRT, Signals=signal.Signals)
    monkeypatch.setattr(worker_module, "signal", there)  # no SIGKILL
    monkeypatch.setattr(select, "select", lambda *_: pytest.fail("a pipe cannot be waited for there"))
    worker = fake(timeout_s=1.5)
    assert worker.render("a") == b"got a"
    with pytest.raises(RenderError, match="longer than 1.5 s"):
        worker.render("hang")
    with pytest.raises(RenderError, match="signal 9"):
        worker.render("killed")
    assert worker.render("b") == b"got b"
    worker.close()


@pytest.mark.parametrize(
    ("stage", "said"), [("loaded", "Rendered pictures need an OpenGL library"), ("ready", "crashed (code 0xc0000005)")]
)
def test_a_fault_on_windows_is_told_by_when_it_came(stage: str, said: str) -> None:
    """Where Windows ends a process for a fault, its exit code is a number of 32 bits from 0xC0000000 on."""

    class Ended:
        def wait(self, timeout: float) -> int:
            return 0xC0000005

    worker = fake()
    worker._process, worker._stage = Ended(), stage  # type: ignore[assignment]
    assert said in worker._why_ended()


def test_without_the_extra_it_is_named_and_nothing_is_started(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extras, "find_spec", lambda name: None if name == "pyvista" else object())
    worker = fake()
    with pytest.raises(MissingExtraError, match=r'needs pyvista, .* pip install "robomill\[render\]"'):
        worker.render("a")
    assert isinstance(worker.refusal, MissingExtraError)
    worker.start()
    assert worker._process is None


def test_without_a_graphics_driver_the_real_process_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent")
    monkeypatch.setenv("LD_PRELOAD", "")
    worker = RenderWorker()
    try:
        worker.render(groove(False, "iso"))
    except RenderError as exc:
        assert "apt-get install" in str(exc)  # noqa: PT017 - a machine with OSMesa draws nevertheless
    worker.close()


def groove(dark: bool, camera: str) -> SurfacePicture:
    x, y = np.linspace(-30, 30, 121), np.linspace(-10, 10, 81)
    X, Y = np.meshgrid(x, y, indexing="ij")
    ideal = np.where((np.abs(Y) < 4) & (np.abs(X) < 20), -2.0, 0.0)
    z = np.where((np.abs(Y - 1) < 4) & (np.abs(X) < 20), -2.1, 0.0)
    error = np.where((z < 0) | (ideal < 0), 1e3 * (z - ideal), np.nan)
    return SurfacePicture(
        x=x,
        y=y,
        z=z,
        ideal=ideal,
        error=error,
        limit=300.0,
        bottom=-8.0,
        camera=camera,
        dark=dark,  # type: ignore[arg-type]
        size=(480, 320),
        station=(0.0, 0.0, -2.0),
        captions=("Displacement shown x 10",),
    )


@pytest.fixture(scope="module")
def worker() -> RenderWorker:
    made = RenderWorker()
    try:
        made.render(groove(False, "iso"))
    except RenderError as exc:
        if made.down:
            pytest.skip(str(exc))
        raise
    return made


@pytest.mark.parametrize(("dark", "camera"), [(False, "iso"), (True, "along"), (False, "top"), (True, "front")])
def test_the_surface_is_drawn_in_its_colours(worker: RenderWorker, dark: bool, camera: str) -> None:
    from PIL import Image

    image = np.asarray(Image.open(io.BytesIO(worker.render(groove(dark, camera)))).convert("RGB")).astype(int)
    assert image.shape == (320, 480, 3)
    corner = image[2, 2]
    assert (corner < 60).all() if dark else (corner > 240).all()
    part = image[:, : int(0.8 * 480)]
    red, blue = part[..., 0], part[..., 2]
    if camera != "front":  # the front hides the groove
        assert ((red - blue) > 80).sum() > 100, "material left is orange"
        assert ((blue - red) > 60).sum() > 100, "cut too deep is blue"
    assert (np.abs(part - corner).max(axis=-1) > 25).mean() > 0.1, "the block fills the picture"
