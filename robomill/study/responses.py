"""What a study asks of every run, by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from robomill.simulation.result import SimulationResult
from robomill.units import from_si


@dataclass(frozen=True)
class Response:
    """A number (or a word) of a run; ``title`` says which."""

    title: str
    of: Callable[[SimulationResult], float | str]


def _mm(value: float) -> float:
    return float(from_si(float(value), "mm"))


def _at_worst(result: SimulationResult, values: np.ndarray) -> float:
    return float(values[result.worst]) if result.worst >= 0 else float("nan")


RESPONSES: dict[str, Response] = {
    "max_deviation_mm": Response("Largest deviation of the tip at feed, mm", lambda run: _mm(run.max_deviation)),
    "rms_deviation_mm": Response("Root mean square of it over the length cut, mm", lambda run: _mm(run.rms_deviation)),
    "wall_mm": Response("Largest error of walls, mm, left of the feed +", lambda run: _mm(run.verdict.wall.value)),
    "floor_mm": Response("Largest error of floors, mm, up +", lambda run: _mm(run.verdict.floor.value)),
    "feed_mm": Response("Largest deviation along the feed, mm", lambda run: _mm(run.verdict.feed.value)),
    "end_mm": Response("Largest error where cuts end in the material, mm", lambda run: _mm(run.verdict.end.value)),
    "share": Response("Share of the tolerance that is used, 1 is all of it", lambda run: float(run.verdict.share)),
    "verdict": Response("ok, tight, out, unreached, unjudged or missed", lambda run: run.verdict.level),
    "force_N": Response("Size of the force at the worst place, N", lambda run: _at_worst(run, run.force_size)),
    "reached": Response("Share of the samples that are reached", lambda run: float(run.reached.mean())),
}
USUAL = ("max_deviation_mm", "wall_mm", "floor_mm", "share", "verdict")
WORDS = ("verdict",)  # those that are no numbers
