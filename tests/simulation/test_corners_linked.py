"""Where one cut ends at a corner and the next begins: of all pairs of ends the one that costs least, by loops."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.simulation.corners import LINKED, ON_THE_SPOT, UPRIGHT, Ways, _link

K = np.array([0.0, np.sin(0.2), np.cos(0.2)])
U, V = np.array([1.0, 0.0, 0.0]), np.cross(K, [1.0, 0.0, 0.0])


def bent(turn: float, corner: float) -> Ways:
    """Across a leaning tool: four steps of 1 mm that each turn by as much, a corner, and four steps more."""
    angle = np.cumsum([0.0, turn, turn, turn, corner, turn, turn, turn])
    steps = 1e-3 * (np.cos(angle)[:, None] * U + np.sin(angle)[:, None] * V)
    p = np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])
    return Ways.of(p, np.tile(K, (9, 1)))


def aside(step: np.ndarray, way: np.ndarray) -> float:
    """What a step of a cut costs."""
    up = float(step @ K)
    across = step - up * K
    size, along = float(np.linalg.norm(across)), float(across @ way)
    cost = np.sqrt(max(size**2 - along**2, 0.0)) if along > 0.0 else size
    return float(cost) + (UPRIGHT * abs(up) if size < 0.1 * abs(up) else 0.0)


def cheapest(q: np.ndarray, ends: list[int], s: np.ndarray, cut: Ways) -> tuple[int, int]:
    """Every pair: the cut that ends, as far as the first, the link, and what begins at the second."""
    of = [next((j for j in range(8) if cut.s[j] >= each - 1e-6), 7) for each in s]
    costs: dict[tuple[int, int], float] = {}
    for one, other in [(n, n) for n in range(len(ends))] + [(n, n + 1) for n in range(len(ends) - 1)]:
        a, b = ends[one], ends[other]
        cost = sum(aside(q[i] - q[i - 1], cut.way[min(of[i], 3)]) for i in range(1, a + 1))
        cost += sum(aside(q[i] - q[i - 1], cut.way[max(of[i], 4)]) for i in range(b + 1, len(q)))
        for n in range(len(ends) - 1):
            line = q[ends[n + 1]] - q[ends[n]]
            length = float(np.linalg.norm(line - (line @ K) * K))
            if n == one and other > one:
                rise = sum(abs(float((q[i] - q[i - 1]) @ K)) for i in range(a + 1, b + 1))
                cost += LINKED * length + 0.5 * UPRIGHT * rise
                continue
            begin, end = (float((q[ends[at]] - cut.p[3]) @ cut.way[3 if n < one else 4]) for at in (n, n + 1))
            gone = min(end, 0.0) - min(begin, 0.0) if n < one else max(end, 0.0) - max(begin, 0.0)
            cost += ON_THE_SPOT * max(0.5 * length - gone, 0.0)
        costs[a, b] = cost
    return min(costs, key=lambda each: costs[each])


@pytest.mark.parametrize("seed", range(25))
def test_a_corner_is_where_ends_and_link_cost_least(seed: int) -> None:
    """Samples that come along the one cut, wander about the corner and leave along the other, some right at the ends of
    its steps, with links that rise."""
    for draw in range(8):
        _compare(np.random.default_rng([seed, draw]))


def _compare(rng: np.random.Generator) -> None:
    cut = bent(*rng.choice([0.0, 0.08, -0.05], 1), rng.choice([1.5, -0.9, 2.6]))
    assert cut.corners.tolist() == [3]
    s = np.sort(np.where(rng.random(12) < 0.4, rng.integers(1, 9, 12) * 1e-3, rng.uniform(0.2e-3, 7.8e-3, 12)))
    along = np.append(0.0, cut.s)
    p = np.vstack([np.zeros(3), cut.p])
    q = np.column_stack([np.interp(s, along, p[:, i]) for i in range(3)])
    near = np.abs(s - 4e-3) < 2e-3
    wander = rng.normal(size=(12, 2)) * rng.choice([0.05e-3, 0.4e-3]) @ (U, V)
    q += np.where(near[:, None], wander, 0.0) + np.outer(np.where(near, rng.choice([0.0, 4e-3], 12), 0.0), K)
    ends = sorted({*rng.permutation(12)[: rng.integers(1, 9)].tolist()})
    found = _link(q, np.tile(K, (12, 1)), np.array(ends), s, (cut, 3))
    assert found == cheapest(q, ends, s, cut)
