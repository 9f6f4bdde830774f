"""A move beside the contour that waits for the next one, and how sharp outside corners may be."""

import math
from dataclasses import dataclass

SHARPEST = math.radians(100.0) + 1e-9
"""rad: G451 goes around sharper outside corners by an arc all the same (Sinumerik, MD20210 CUTCOM_CORNER_LIMIT)."""
BESIDE_ARC = "an outside corner beside an arc under G451 is not read; write G450, which goes around it by an arc."


@dataclass
class HeldMove:
    """A move that waits for its successor. ``turn`` is 0 for straight moves."""

    line: int
    rapid: bool
    end: tuple[float, float, float]
    rotary: tuple[float, float, float]
    v_f: float
    direction: tuple[float, float] = (0.0, 0.0)
    centre: tuple[float, float] = (0.0, 0.0)
    turn: int = 0
    sweep: float = 0.0
