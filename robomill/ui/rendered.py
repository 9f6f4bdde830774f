"""A rendered picture on a page. The page does not wait for it: it is drawn beside it, and put in its place when it is
there; until then the place shows the picture before it, greyed."""

import uuid
from collections.abc import Callable, Sequence
from typing import Any

import streamlit as st

from robomill.errors import RenderError, RobomillError
from robomill.progress import checkpoint
from robomill.ui import pieces, session
from robomill.ui.work.cached import commons
from robomill.viz.rendered.picture import SurfacePicture
from robomill.viz.rendered.render_queue import Order, RenderQueue
from robomill.viz.rendered.worker import RenderWorker

SOON_MS, EACH_MS, LATEST_MS = 120, 250, 2000  # until the page looks again: at least, for each picture before, at most
AGAIN_LEAST_S = 1.0
LOOK_S = 0.1
# One look after `ms`, then no more unless the place asks for another.
WAKE = """
export default function (component) {
  const { data, setTriggerValue } = component;
  const timer = setTimeout(() => setTriggerValue('due', data.count), data.ms);
  return () => clearTimeout(timer);
}
"""
_wake = st.components.v2.component("robomill_wake", html="<i></i>", css="i { display: none }", js=WAKE)


@st.cache_resource(show_spinner=False)
def queue() -> RenderQueue:
    """The pictures that wait to be drawn on this server, and who draws them."""
    return RenderQueue(RenderWorker())


def picture(
    place: str,
    key: Sequence[object],
    make: Callable[[], SurfacePicture],
    alt: str,
    otherwise: Callable[[], Any],
) -> None:
    """The picture of ``make`` at ``place``; ``key`` is all that it depends on (digests and view). ``make`` is called in
    another thread, so it knows no page. ``otherwise`` shows something else where nothing can be drawn."""
    _picture(place, tuple(key), make, alt, otherwise)


@st.fragment
def _picture(
    place: str,
    key: tuple[object, ...],
    make: Callable[[], SurfacePicture],
    alt: str,
    otherwise: Callable[[], Any],
) -> None:
    png = commons.find(("png", *key))
    if png is None:
        order = _ordered(place, key, make)
        if isinstance(order, RobomillError):
            _refused(place, order, otherwise)
            return
        png = order.png
        if png is None:
            _waiting(place, order, alt)
            return
        commons.put(("png", *key), png)
    queue().drop(_owner(place))
    session.hold(f"{place}.png", png)
    session.drop(f"{place}.order")
    with st.container(key=f"rendered-{place}"):
        st.image(png, width="stretch", alt=alt)


def there(key: Sequence[object]) -> bool:
    """Whether a picture is drawn already."""
    return commons.find(("png", *key)) is not None


def now(place: str, key: Sequence[object], make: Callable[[], SurfacePicture]) -> bytes:
    """PNG bytes of a picture, waited for. Raises RenderError with the reason why it cannot be drawn."""
    png: bytes | None = commons.find(("png", *key))
    return png if png is not None else wait(queue().order(f"{place}.{uuid.uuid4()}", tuple(key), make))


def wait(order: Order) -> bytes:
    """PNG bytes of an order once it is drawn. Raises RenderError, and Cancelled where the caller's work is given up."""
    while not order.done.wait(LOOK_S):
        checkpoint()
    return _result(order) or b""


def _owner(place: str) -> str:
    """Who waits: the place on this person's page."""
    mine = session.kept("rendered.owner")
    if mine is None:
        mine = str(uuid.uuid4())
        session.keep("rendered.owner", mine)
    return f"{mine}.{place}"


def _ordered(place: str, key: tuple[object, ...], make: Callable[[], SurfacePicture]) -> Order | RobomillError:
    """The order of a picture, placed if it is not yet; or why it is refused."""
    kept: Order | None = session.kept(f"{place}.order")
    if kept is None or kept.key != key or (kept.done.is_set() and kept.dropped and kept.png is None):
        refusal = queue().worker.refusal
        if refusal is not None:
            queue().drop(_owner(place))
            return refusal
        kept = queue().order(_owner(place), key, make)
        session.hold(f"{place}.order", kept)
    if kept.done.is_set():
        try:
            _result(kept)
        except RobomillError as exc:
            session.drop(f"{place}.order")
            return exc
    return kept


def _result(order: Order) -> bytes | None:
    """What an order has come to. Raises its refusal, or its bug."""
    if order.bug is not None:
        raise order.bug
    if order.error is not None:
        raise order.error
    return order.png


def _waiting(place: str, order: Order, alt: str) -> None:
    before: bytes | None = session.kept(f"{place}.png")
    with st.container(key=f"rendered-{place}-waiting"):
        if before is not None:
            st.image(before, width="stretch", alt=f"{alt} The one before, while a new one is drawn.")
        else:
            st.html('<div class="rm-drawing">Drawing …</div>')
    _look_again(place, min(SOON_MS + EACH_MS * queue().before(order), LATEST_MS))


def _refused(place: str, exc: RobomillError, otherwise: Callable[[], Any]) -> None:
    otherwise()
    pieces.note(str(exc))
    again = exc.again_s if isinstance(exc, RenderError) else None
    if again is not None:
        _look_again(place, round(1000 * max(again, AGAIN_LEAST_S)))


def _look_again(place: str, ms: int) -> None:
    count = int(session.kept(f"{place}.looks", 0)) + 1
    session.keep(f"{place}.looks", count)
    _wake(key=f"{place}.wake", data={"ms": ms, "count": count}, on_due_change=lambda: None, height=1)
