"""What a reader of a corrected program is told beside its numbers."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import robomill as rm
from robomill.improve.compensation import _findings, _wrong
from robomill.improve.correction import Correction
from robomill.progress import Progress, watched
from tests.improve.corrected import SLOT

RUN = rm.simulate(rm.load_setup(SLOT).replace(step=10e-3))


@pytest.mark.parametrize("some", [[], [3], [2, 5], None])
def test_where_a_correction_is_held_is_told_by_its_lines(some: list[int] | None) -> None:
    """Be it one sample or all of them."""
    held = np.zeros(len(RUN.path), dtype=bool)
    held[slice(None) if some is None else some] = True
    found = Correction(RUN, np.zeros_like(RUN.path.p), RUN, (1e-9,), held)
    told = _findings(found, RUN, SimpleNamespace(unrolled=()), ())  # type: ignore[arg-type]
    words = [each.message for each in told if each.code == "held"]
    assert len(words) == held.any()
    lines = [str(line) for line in sorted(set(RUN.path.block[held].tolist()))]
    assert not lines or any(f"line {lines[0]}{after}" in words[0] for after in (":", ",", " "))
    assert [each.code for each in told if each.code in ("unrolled", "joint-reversals")] == []


@pytest.mark.parametrize("written", [(), ("loops",), ("loops", "canned cycles")])
def test_what_was_written_out_is_told(written: tuple[str, ...]) -> None:
    found = Correction(RUN, np.zeros_like(RUN.path.p), RUN, (1e-9,), np.zeros(len(RUN.path), dtype=bool))
    told = _findings(found, RUN, SimpleNamespace(unrolled=written), ())  # type: ignore[arg-type]
    words = [each.message for each in told if each.code == "unrolled"]
    assert words == ([f"written out: {', '.join(written)}."] if written else [])


def test_its_four_parts_are_told_as_they_begin() -> None:
    told: list[tuple[str, float]] = []
    with watched(Progress(say=lambda each: told.append((each.stage, each.share)))):
        rm.compensate(rm.load_setup(SLOT).replace(step=20e-3))
    stages = ("The program as it is", "Correcting the path", "Writing the program", "What remains")
    assert told == [(stage, part / 4) for part, stage in enumerate(stages)]


@pytest.mark.parametrize("left", [0.05, -0.05, 0.0])
def test_numbers_that_are_a_fifth_wrong_are_wrong_to_the_worse_side(left: float) -> None:
    """Of what the tool is pushed so much is left, or taken back too far: a fifth more, or less, is added to that."""
    push = np.where(RUN.path.cutting[:, None], RUN.delta, 0.0)
    softer, stronger = _wrong(replace(RUN, delta=left * push, ahead=(left - 1.0) * push))
    off = np.abs(RUN.delta_in_cut[RUN.judged, 1]).max()
    assert softer.wall[0] == pytest.approx((0.2 + abs(left)) * off, rel=1e-3)
    assert stronger.wall[0] == softer.wall[0]
