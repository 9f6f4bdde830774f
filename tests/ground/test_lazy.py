"""Values made at their first use: once each, told apart by object, and without a lock that all objects share."""

import threading
from dataclasses import dataclass
from pathlib import Path

from robomill.lazy import cached_property

SOURCES = Path(__file__).parents[2] / "robomill"


@dataclass(frozen=True)
class Square:
    side: float

    @cached_property
    def area(self) -> list[float]:
        """Its area."""
        return [self.side * self.side]


def test_a_value_is_made_once_for_each_object_and_documented():
    three, four = Square(3.0), Square(4.0)
    assert (three.area, four.area) == ([9.0], [16.0])
    assert three.area is three.area
    assert Square.area.__doc__ == "Its area."
    assert Square(3.0) == three, "what was made is no field"


def test_two_objects_make_theirs_at_the_same_time():
    """Each waits for the other in the midst of making its own."""
    meeting = threading.Barrier(2, timeout=10.0)

    class Waits:
        @cached_property
        def value(self) -> int:
            return meeting.wait()

    made: list[int] = []
    threads = [threading.Thread(target=lambda: made.append(Waits().value), daemon=True) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(20.0)
    assert sorted(made) == [0, 1]


def test_no_property_of_the_package_shares_a_lock():
    found = [str(path) for path in SOURCES.rglob("*.py") if "functools import cached_property" in path.read_text()]
    assert found == []
