"""Pictures that are drawn beside whoever asked: one after the other, what is wanted no more left out."""

import threading
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field

from robomill.errors import RobomillError
from robomill.progress import Cancelled, Progress, watched
from robomill.viz.rendered.picture import SurfacePicture
from robomill.viz.rendered.worker import RenderWorker

PREPARING = 2  # threads: one prepares a picture while another's is drawn


@dataclass(eq=False)
class Order:
    """A picture that was asked for: ``png`` once it is drawn, or ``error``, or ``bug``; neither where it was dropped.

    ``owners`` are the places that wait for it; an order that nobody waits for any more is not drawn.
    """

    key: Hashable
    make: Callable[[], SurfacePicture]
    owners: set[str]
    png: bytes | None = None
    error: RobomillError | None = None
    bug: Exception | None = None
    done: threading.Event = field(default_factory=threading.Event)

    @property
    def dropped(self) -> bool:
        """Whether nobody waits for it."""
        return not self.owners


class RenderQueue:
    """Orders for a worker, drawn in the order they came. An owner (a place on one person's page) waits for one picture
    at a time: its newest order takes the place of its earlier ones. Equal keys are drawn once, for all that ask."""

    def __init__(self, worker: RenderWorker) -> None:
        self.worker = worker
        self._changed = threading.Condition()
        self._waiting: list[Order] = []
        self._in_hand: list[Order] = []
        self._threads: list[threading.Thread] = []

    def order(self, owner: str, key: Hashable, make: Callable[[], SurfacePicture]) -> Order:
        """Ask for the picture of ``make``, which is called in a thread of the queue."""
        with self._changed:
            self._leave(owner, key)
            for order in (*self._in_hand, *self._waiting):
                if order.key == key:
                    order.owners.add(owner)
                    return order
            made = Order(key, make, {owner})
            self._waiting.append(made)
            self._changed.notify()
            while len(self._threads) < PREPARING:
                self._threads.append(threading.Thread(target=self._serve, daemon=True, name="pictures"))
                self._threads[-1].start()
            return made

    def drop(self, owner: str) -> None:
        """``owner`` waits for nothing any more."""
        with self._changed:
            self._leave(owner)

    def before(self, order: Order) -> int:
        """How many pictures are drawn before this one."""
        with self._changed:
            return len(self._in_hand) + self._waiting.index(order) if order in self._waiting else 0

    def _leave(self, owner: str, but: Hashable = None) -> None:
        for order in (*self._in_hand, *self._waiting):
            if order.key != but or but is None:
                order.owners.discard(owner)
        for order in [order for order in self._waiting if order.dropped]:
            self._waiting.remove(order)
            order.done.set()

    def _serve(self) -> None:
        while True:
            with self._changed:
                while not self._waiting:
                    self._changed.wait()
                order = self._waiting.pop(0)
                self._in_hand.append(order)
            try:
                with watched(Progress(stop=lambda order=order: order.dropped)):  # type: ignore[misc]
                    picture = order.make()
                if not order.dropped:
                    order.png = self.worker.render(picture)
            except Cancelled:
                pass
            except RobomillError as exc:
                order.error = exc
            except Exception as exc:  # shown by the page that asked: a thread has nobody to raise to
                order.bug = exc
            finally:
                with self._changed:
                    self._in_hand.remove(order)
                order.done.set()
