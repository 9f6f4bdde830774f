"""Which draws are run in full, too: those that decide, and where these are off some of every size."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from robomill.improve.uncertainty import CHECKED, DECIDING, DOUBTED, PROBES, _Work

N = 400


@pytest.mark.parametrize("measure", ["verdict", "floor"])
@pytest.mark.parametrize(
    ("off", "more", "said"),
    [
        ((0.5 * DOUBTED, DOUBTED), (9.0, 9.0), (0.5 * DOUBTED, DOUBTED)),
        ((2.0 * DOUBTED, 0.0), (DOUBTED, 3.0), (2.0 * DOUBTED, 3.0)),
        ((0.0, 2.0 * DOUBTED), (5.0 * DOUBTED, 0.0), (5.0 * DOUBTED, 2.0 * DOUBTED)),
    ],
)
def test_the_largest_and_the_nearest_to_the_limit_are_run_and_more_of_all_sizes_where_these_are_off(
    measure: str, off: tuple[float, float], more: tuple[float, float], said: tuple[float, float]
) -> None:
    """Each draw is its own number here, of which some have no share; by sorting."""
    rng, asked = np.random.default_rng(6), []
    share = rng.permutation(np.linspace(0.2, 1.9, N))
    share[rng.permutation(N)[:9]] = np.nan
    errors = {name: rng.uniform(0.0, 1.0, N) for name in ("wall", "floor", "tip")}

    def differs(change: np.ndarray, names: tuple[str, ...]) -> tuple[float, float]:
        asked.append(change[:, 0].astype(int).tolist())
        assert names == (("wall", "floor", "tip") if measure == "verdict" else (measure,))
        return more if len(asked) == 2 else off

    own = SimpleNamespace(expansion=object(), measure=measure, _off=differs)
    found = _Work.checked(own, np.arange(N)[:, None], errors, share)  # type: ignore[arg-type]
    size = np.nan_to_num(share)
    largest = [int(errors[name].argmax()) for name in (errors if measure == "verdict" else (measure,))]
    near = sorted(range(N), key=lambda i: abs(size[i] - 1.0))[:DECIDING]
    worst = sorted(range(N), key=lambda i: -size[i])
    first = {*largest, *near}
    assert asked[0][: len(largest)] == largest
    assert first <= {*asked[0]}
    assert len(asked[0]) == len({*asked[0]}) == CHECKED
    assert {*asked[0]} - first <= {*worst[: CHECKED - len(first) + len({*worst[:CHECKED]} & first)]}
    assert len(asked) == 1 + (max(off) > DOUBTED)
    if len(asked) == 2:
        rank = {i: n for n, i in enumerate(worst[::-1])}
        ranks = [rank[i] for i in asked[1]]
        assert not {*asked[0]} & {*asked[1]}
        assert PROBES - CHECKED <= len(ranks) <= PROBES + 1
        assert ranks[0] < 2 * N / PROBES
        ranks = [each for each in ranks if each >= 9]  # what has no share is as small as the other
        assert ranks == sorted(ranks)
        assert max(np.diff(ranks)) <= 2 * (N // PROBES)
        assert min(np.diff(ranks)) >= N // PROBES
    assert found == (sum(map(len, asked)), *said)


def test_where_every_draw_is_a_run_nothing_is_left_to_check() -> None:
    own = SimpleNamespace(expansion=None)
    assert _Work.checked(own, np.zeros((3, 1)), {}, np.ones(3)) == (0, 0.0, 0.0)  # type: ignore[arg-type]
