"""What a long work says of itself while it runs: the shares as they are told, before anything holds them in bounds."""

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from robomill.progress import Progress, watched


@dataclass(eq=False)
class _Listener(Progress):
    heard: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))

    def reach(self, share: float | None = None, stage: str = "", beside: str = "") -> None:
        if share is not None:
            self.heard[stage].append(share)
        super().reach(share, stage, beside)


def told(work: Callable[[], object]) -> dict[str, list[float]]:
    """The shares of each stage, which lie from 0 to 1 and rise, unless the stage begins again."""
    listener = _Listener()
    with watched(listener):
        work()
    for stage, shares in listener.heard.items():
        assert min(shares) >= 0.0, stage
        assert max(shares) <= 1.0, stage
        assert ((np.diff(shares) >= 0.0) | (np.array(shares[1:]) == 0.0)).all(), stage
    return listener.heard
