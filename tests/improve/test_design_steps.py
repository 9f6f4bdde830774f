"""Between a design that does not hold and the stiffest joints: halved to where the tolerance is kept."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import robomill as rm
from robomill.improve import design as module
from robomill.improve.design import _Search, linear
from robomill.improve.judged import judged
from robomill.improve.least_cost import Errors

X, LOW = np.array([1.0, 0.8, 1.0]), np.array([0.25, 0.2, 1.0])


@pytest.mark.parametrize("threshold", [0.01, 0.3, 0.5, 0.77, 0.99])
def test_the_first_design_on_the_way_that_keeps_the_tolerance_is_found_to_a_sixty_fourth(
    monkeypatch: pytest.MonkeyPatch, threshold: float
) -> None:
    """By equal factors from x to the stiffest: parts of the way by their logarithms."""

    def part(x: np.ndarray) -> float:
        return float(np.log(x[0] / X[0]) / np.log(LOW[0] / X[0]))

    monkeypatch.setattr(module, "judged", lambda x, measure: SimpleNamespace(share=2.0 - (part(x) > threshold)))
    own = SimpleNamespace(low=LOW, at=lambda x: x, measure="verdict")
    x, run, residual = _Search.on_the_way(own, X, X, 0.5)  # type: ignore[arg-type]
    assert threshold < part(x) <= threshold + 1.0 / 64.0 + 1e-9
    np.testing.assert_allclose(run, x, rtol=1e-12)
    np.testing.assert_allclose(np.log(x / X)[:2] / np.log(LOW / X)[:2], part(x))
    assert np.isnan(residual)


@pytest.mark.parametrize(("stiffest", "taken"), [(1.5, True), (1.9, True), (2.0, False), (2.5, False)])
def test_where_not_even_the_stiffest_keep_it_the_better_of_the_two_is_taken(
    monkeypatch: pytest.MonkeyPatch, stiffest: float, taken: bool
) -> None:
    shares = {"first": 2.0, "stiffest": stiffest}
    monkeypatch.setattr(module, "judged", lambda run, measure: SimpleNamespace(share=shares[run]))
    own = SimpleNamespace(low=LOW, at=lambda x: "stiffest", measure="verdict")
    x, run, residual = _Search.on_the_way(own, X, "first", 0.5)  # type: ignore[arg-type]
    assert (run, residual) == ("stiffest" if taken else "first", 0.5)
    np.testing.assert_array_equal(x, LOW if taken else X)


@pytest.mark.parametrize("sag", [False, True])
def test_errors_of_other_joints_are_those_of_a_run_with_them(sag: bool) -> None:
    """A straight slot, whose force and contact stay: walls and floors are linear in the compliances, with what the
    links' weight does where that is added."""
    setup = rm.load_setup("paper_flute").replace(step=20e-3, cell=5e-4)
    if sag:
        setup = setup.replace(links=rm.LinkMasses(mass=np.full(5, 4.0), centre=np.zeros((5, 3))), add_sag=True)
    before, x = rm.simulate(setup), np.array([0.5, 0.9, 1.3, 0.7, 1.1])
    after = rm.simulate(setup.replace(robot=setup.robot.replace(C_theta=x * setup.robot.C_theta)))
    told, found = linear(before, judged(before), np.ones(5)), judged(after)
    np.testing.assert_allclose(told.at(np.ones(5)), judged(before).error, atol=1e-12)
    np.testing.assert_allclose(told.at(x), found.error, atol=3e-6)
    again = linear(after, found, x)
    np.testing.assert_allclose(again.at(np.ones(5)), judged(before).error, atol=3e-6)
    assert np.abs(found.error - judged(before).error).max() > 20e-6


def test_a_table_of_a_design_has_a_row_a_joint() -> None:
    found = rm.design(rm.load_setup("paper_flute").replace(step=20e-3), tolerance_mm=0.2, weight=[1, 2, 3, 1, 1])
    table = found.columns()
    assert table["joint"].tolist() == [1, 2, 3, 4, 5]
    ratio = found.before.setup.robot.C_theta / found.setup.robot.C_theta
    np.testing.assert_allclose(table["stiffness_ratio"], ratio)
    np.testing.assert_allclose(table["cost"], np.array([1, 2, 3, 1, 1]) * np.log(ratio) / np.log(2.0), atol=1e-12)
    np.testing.assert_allclose(table["C_theta_before"] / table["C_theta_after"], ratio)
    assert found.cost == pytest.approx(table["cost"].sum())


@pytest.mark.parametrize("beyond", [1.0, 1.06, 1.3])
def test_where_what_is_left_is_not_linear_it_is_aimed_lower_until_the_tolerance_is_kept(
    monkeypatch: pytest.MonkeyPatch, beyond: float
) -> None:
    """Runs use so many times what the solver was told of them."""
    low, size = 0.5, 2.0
    monkeypatch.setattr(module, "judged", lambda x, measure: SimpleNamespace(share=float(size * x[0]) * beyond))
    errors = Errors(np.zeros((1, 1)), np.full((1, 1, 1), size), np.ones(1))
    monkeypatch.setattr(module, "linear", lambda result, now, x, goes: errors)
    own = SimpleNamespace(
        low=np.array([low / 2.6]), high=np.ones(1), weight=np.ones(1), measure="verdict", at=lambda x: x
    )
    x, run, _, rounds = _Search.settled(own, np.ones(1), np.ones(1))  # type: ignore[arg-type]
    np.testing.assert_array_equal(x, run)
    assert 0.99 < size * x[0] * beyond <= 1.0
    assert (rounds <= 2) == (beyond == 1.0)


def test_what_no_deviation_explains_goes_with_the_joints_in_the_first_half_of_the_rounds_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where it never stays: it is run as often as it may be, and what was found last is told."""
    told: list[bool] = []

    def changing(result: object, now: object, x: np.ndarray, goes: bool) -> Errors:
        told.append(goes)
        return Errors(np.zeros((1, 1)), np.full((1, 1, 1), 2.0 + len(told) % 2), np.ones(1))

    monkeypatch.setattr(module, "judged", lambda x, measure: SimpleNamespace(share=1.0))
    monkeypatch.setattr(module, "linear", changing)
    own = SimpleNamespace(low=np.array([0.1]), high=np.ones(1), weight=np.ones(1), measure="verdict", at=lambda x: x)
    x, run, _, rounds = _Search.settled(own, np.ones(1), np.ones(1))  # type: ignore[arg-type]
    assert told == [True] * (rounds // 2) + [False] * (rounds // 2)
    np.testing.assert_allclose([x[0], run[0]], 0.5, rtol=2e-4)
