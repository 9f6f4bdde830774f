"""Pictures drawn beside whoever asks: in order, each once, and what nobody waits for any more not at all."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import Any

import pytest

from robomill.errors import RenderError
from robomill.progress import checkpoint
from robomill.viz.rendered.render_queue import Order, RenderQueue


class Slate:
    """A worker that notes what it draws, and waits until it may."""

    def __init__(self) -> None:
        self.drawn: list[Any] = []
        self.free = threading.Event()

    def render(self, picture: Any) -> bytes:
        assert self.free.wait(20)
        if picture == "bad":
            raise RenderError("no such thing")
        self.drawn.append(picture)
        return str(picture).encode()


@pytest.fixture
def slate() -> Iterator[Slate]:
    made = Slate()
    yield made
    made.free.set()


@pytest.fixture
def queue(slate: Slate) -> RenderQueue:
    return RenderQueue(slate)  # type: ignore[arg-type]


def ask(queue: RenderQueue, owner: str, what: Any) -> Order:
    return queue.order(owner, what, lambda: what)


def finish(slate: Slate, *orders: Order) -> None:
    slate.free.set()
    for order in orders:
        assert order.done.wait(20)


def test_a_slider_s_older_pictures_are_not_drawn(queue: RenderQueue, slate: Slate) -> None:
    others = [ask(queue, f"other {i}", f"other {i}") for i in range(2)]  # both threads have work
    orders = [ask(queue, "slider", n) for n in range(20)]
    finish(slate, *others, *orders)
    assert [what for what in slate.drawn if isinstance(what, int)] == [19]
    assert orders[19].png == b"19"
    assert all(order.png is None and order.dropped for order in orders[:19])


def test_equal_pictures_are_drawn_once_for_all_that_ask(queue: RenderQueue, slate: Slate) -> None:
    orders = [ask(queue, f"session {i}", "same") for i in range(5)]
    assert len({id(order) for order in orders}) == 1
    ask(queue, "session 0", "another")  # one of them looks elsewhere: the others still wait
    finish(slate, *orders)
    assert slate.drawn.count("same") == 1
    assert orders[0].png == b"same"


def test_a_refusal_reaches_who_asked_and_nobody_else(queue: RenderQueue, slate: Slate) -> None:
    bad, good = ask(queue, "a", "bad"), ask(queue, "b", "good")
    finish(slate, bad, good)
    assert isinstance(bad.error, RenderError)
    assert good.png == b"good"


def test_a_bug_in_the_making_is_kept_for_the_page_and_the_queue_goes_on(queue: RenderQueue, slate: Slate) -> None:
    broken = queue.order("a", "broken", lambda: 1 / 0)  # type: ignore[arg-type, return-value]
    good = ask(queue, "b", "good")
    finish(slate, broken, good)
    assert isinstance(broken.bug, ZeroDivisionError)
    assert good.png == b"good"


def test_the_making_of_a_dropped_picture_stops_at_its_next_checkpoint(queue: RenderQueue, slate: Slate) -> None:
    begun, after = threading.Event(), []

    def make() -> Any:
        begun.set()
        while True:
            checkpoint()
            after.append(1)

    order = queue.order("a", "endless", make)
    assert begun.wait(20)
    queue.drop("a")
    finish(slate, order)
    assert order.png is None
    assert order.error is None
    assert order.bug is None
    assert not slate.drawn


def test_who_leaves_the_queue_is_not_counted_before_others(queue: RenderQueue, slate: Slate) -> None:
    busy = [ask(queue, f"busy {i}", f"busy {i}") for i in range(2)]
    first, second = ask(queue, "a", "a"), ask(queue, "b", "b")
    before = queue.before(second)
    queue.drop("a")
    assert queue.before(second) == before - 1
    finish(slate, *busy, second)
    assert "a" not in slate.drawn
    assert first.done.is_set()
