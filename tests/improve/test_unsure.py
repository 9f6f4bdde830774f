"""What of a cut is not known exactly: draws of it, against the moments that they were drawn for."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import robomill as rm
from robomill.identification.fit.models import Model
from robomill.identification.knowledge import Knowledge
from robomill.improve.unsure import unsure_of

EXACT = dict.fromkeys(("lengths", "part", "part_turn", "tool_length"), 0.0)


def test_what_is_too_small_to_have_a_square_is_known_exactly() -> None:
    setup = rm.load_setup("paper_flute").replace(force=rm.PathForce(feed_normal=100.0, axial=1e-200))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        unsure = unsure_of(setup, rm.Spread(compliance=0.0, force=0.1, **EXACT), None)
        change, _ = unsure.drawn(10, seed=1)
        alone = unsure.alone(0)
    assert [each.key for each in unsure.inputs] == ["feed_normal"]
    assert np.isfinite(change).all()
    assert alone == [10.0]


def test_draws_have_the_spread_that_was_stated() -> None:
    unsure = unsure_of(rm.load_setup("paper_flute"), rm.Spread(compliance=0.05, force=0.02, **EXACT), None)
    count = 4000
    change, again = unsure.drawn(count, seed=3)
    assert again == 0, "20 and 50 standard deviations from zero"
    np.testing.assert_allclose(change.std(axis=0), unsure.std, rtol=5.0 / np.sqrt(2 * count))
    np.testing.assert_allclose(change.mean(axis=0) / unsure.std, 0.0, atol=5.0 / np.sqrt(count))
    share = {"compliance": 0.05, "force": 0.02}
    for each in unsure.inputs:
        np.testing.assert_allclose(each.std, share[each.group] * abs(each.value), rtol=1e-12)


@pytest.mark.parametrize(("source", "said"), [("nine points", "nine points"), ("", "identified")])
def test_what_is_known_of_compliances_says_from_where(source: str, said: str) -> None:
    """Each with the standard deviation of its own: the root of the diagonal."""
    setup = rm.load_setup("paper_flute")
    C = setup.robot.C_theta
    known = Knowledge(Model(), C, np.diag((np.arange(1, 6) * 0.01 * C) ** 2), source=source)
    inputs = unsure_of(setup, rm.Spread(force=0.0, **EXACT), known).inputs
    assert [each.key for each in inputs] == [f"C_theta_{n}" for n in range(1, 6)]
    np.testing.assert_allclose([each.std for each in inputs], np.arange(1, 6) * 0.01 * C)
    assert {(each.provenance.kind, each.provenance.source) for each in inputs} == {("measured", said)}
