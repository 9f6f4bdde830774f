"""Turns: no more at once than there are places, in the order in which they came, and long work lets others pass."""

import threading
import time

import pytest

from robomill.lazy import cached_property
from robomill.progress import Cancelled
from robomill.ui.work.turns import AT_ONCE_S, Turn, Turns


def begun(turns: Turns, work, unwanted=bool) -> threading.Thread:
    """A thread that does ``work(turn)`` when it is its turn."""

    def run() -> None:
        try:
            with Turn(unwanted, turns) as turn:
                work(turn)
        except Cancelled:
            pass

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    return thread


def until(there) -> None:
    end = time.monotonic() + 10.0
    while not there():
        assert time.monotonic() < end
        time.sleep(0.002)


@pytest.mark.parametrize("places", [1, 2])
def test_no_more_at_once_than_places_in_the_order_in_which_they_came(places):
    turns, go, lock = Turns(places), threading.Event(), threading.Lock()
    order, at_once, most = [], [], []

    def work(number):
        def do(_turn):
            with lock:
                order.append(number)
                at_once.append(number)
                most.append(len(at_once))
            go.wait(10.0)
            with lock:
                at_once.remove(number)

        return do

    threads = []
    for number in range(6):
        threads.append(begun(turns, work(number)))
        until(lambda number=number: number < len(order) + len(turns._waiting))
    assert order == list(range(places))
    go.set()
    for thread in threads:
        thread.join(10.0)
    assert sorted(order) == list(range(6))
    assert max(most) == places
    if places == 1:
        assert order == list(range(6))


def test_what_is_no_longer_wanted_is_never_begun_and_holds_up_nobody():
    turns, go, gone, done = Turns(1), threading.Event(), threading.Event(), []
    first = begun(turns, lambda _: go.wait(10.0))
    until(lambda: not turns._free)
    given_up = begun(turns, lambda _: done.append("given up"), gone.is_set)
    until(lambda: turns.waited_for)
    last = begun(turns, lambda _: done.append("last"))
    gone.set()
    given_up.join(10.0)
    assert not done
    go.set()
    first.join(10.0)
    last.join(10.0)
    assert done == ["last"]


def test_long_work_lets_a_short_piece_pass():
    turns, said = Turns(1), []

    def long(turn):
        end = time.monotonic() + 3 * AT_ONCE_S
        while time.monotonic() < end:
            time.sleep(0.005)
            turn.let_pass()
        said.append("long")

    one = begun(turns, long)
    until(lambda: not turns._free)
    other = begun(turns, lambda _: said.append("short"))
    for thread in (one, other):
        thread.join(10.0)
    assert said == ["short", "long"]
    assert turns._free == 1


def test_work_that_is_given_up_while_it_lets_others_pass_gives_its_place_up_once():
    turns, gone = Turns(1), threading.Event()

    def long(turn):
        time.sleep(1.2 * AT_ONCE_S)
        gone.set()
        turn.let_pass()

    one = begun(turns, long, gone.is_set)
    until(lambda: not turns._free)
    other = begun(turns, lambda _: time.sleep(0.2))
    for thread in (one, other):
        thread.join(10.0)
    assert turns._free == 1


def test_work_that_lets_others_pass_in_the_midst_of_a_property_holds_up_nobody_who_needs_it_too():
    class Result:
        def __init__(self, make) -> None:
            self._make = make

        @cached_property
        def surface(self) -> str:
            return self._make()

    turns, made = Turns(1), []

    def long(turn: Turn) -> str:
        until(lambda: turns.waited_for)
        time.sleep(1.2 * AT_ONCE_S)
        turn.let_pass()
        return "long"

    first = begun(turns, lambda turn: made.append(Result(lambda: long(turn)).surface))
    second = begun(turns, lambda _: made.append(Result(lambda: "short").surface))
    first.join(10.0)
    second.join(10.0)
    assert made == ["short", "long"]
