"""Of an arm that may turn about its tool each place is screened at the spin that it would be milled with."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import robomill as rm
from robomill.improve.screening import Screen, Screened, Standing
from robomill.kinematics.choice import spins

SIX, FIVE = rm.load_robot("fanuc_r2000ic"), rm.load_robot("slavkovic_5r")
K = 9


def looking(spin: object, robot: rm.Robot, every: dict[float, Screened]) -> SimpleNamespace:
    asked: list[object] = []

    def with_(T_MW: np.ndarray, angle: object) -> Screened:
        asked.append(angle)
        return every[angle] if isinstance(angle, float) and every else angle  # type: ignore[return-value]

    return SimpleNamespace(setup=SimpleNamespace(spin=spin, robot=robot), _with=with_, asked=asked)


@pytest.mark.parametrize("seed", range(4))
def test_of_the_spins_that_reach_all_of_the_path_the_one_that_deviates_least_is_taken_at_each_place(seed: int) -> None:
    """By a loop; where none reaches it all, whatever is told is told of one spin; and what has no number is 0."""
    rng, every = np.random.default_rng(seed), {}
    for angle in spins().tolist():
        missed = np.where(rng.random(K) < (0.7, 0.99)[seed % 2], rng.integers(1, 5, K), 0)
        errors = {name: rng.uniform(0.1, 1.0, K) for name in ("wall", "tip")}
        every[angle] = Screened(Standing(missed, rng.random(K), rng.random(K)), errors)
    found = Screen._best_spin(looking("least_deviation", SIX, every), np.zeros((K, 4, 4)))  # type: ignore[arg-type]
    for k in range(K):
        there = [each for each in every.values() if each.standing.missed[k] == 0]
        best = min(there, key=lambda each: each.errors["tip"][k]) if there else every[float(spins()[0])]
        assert [part[k] for part in found.standing] == [part[k] for part in best.standing]
        assert {name: error[k] for name, error in found.errors.items()} == {n: e[k] for n, e in best.errors.items()}


@pytest.mark.parametrize(
    ("spin", "robot", "asked"),
    [(0.3, SIX, 0.3), ("least_motion", SIX, "least_motion"), ("least_deviation", FIVE, "least_motion")],
)
def test_one_spin_is_asked_where_it_is_told_or_nothing_is_to_be_chosen(
    spin: object, robot: rm.Robot, asked: object
) -> None:
    own = looking(spin, robot, {})
    Screen._best_spin(own, np.zeros((K, 4, 4)))  # type: ignore[arg-type]
    assert own.asked == [asked]
