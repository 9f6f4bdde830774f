"""Which of several causes is the likeliest, by the rule as it is said: chosen by hand."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

import robomill as rm
from robomill.identification.fit.doubts import bending_offer, model_findings
from robomill.identification.fit.suspects import Cause, Inquest, Suspect
from robomill.identification.fit.treatment import Treatment

ROBOT = rm.load_robot("kuka_kr270")
LINK, ZERO, TOOL = Cause("bending", 2), Cause("zero", 3), Cause("tool")
FORCE, GAUGE, BOTH = (Cause("points", points=name) for name in ("force", "gauge", "both"))


def asked(*found):
    """An inquest from (cause, numbers, error on poses left out)."""
    suspects = [Suspect(cause, numbers, 1e-9, error, 0.01, 0.001) for cause, numbers, error in found]
    return Inquest(0.4, tuple(sorted(suspects, key=lambda each: each.error)))


@pytest.mark.parametrize(
    ("found", "likeliest"),
    [
        ([], []),
        ([(LINK, 2, 0.1)], [LINK]),
        ([(LINK, 2, 0.1), (ZERO, 1, 0.106)], [LINK]),  # more than a twentieth worse: told apart
        ([(LINK, 2, 0.1), (ZERO, 1, 0.105)], [ZERO, LINK]),  # alike: the simpler one first
        ([(LINK, 2, 0.1), (TOOL, 2, 0.101)], [LINK, TOOL]),
        ([(LINK, 2, 0.1), (TOOL, 2, 0.102), (ZERO, 1, 0.103), (FORCE, 3, 0.104)], [ZERO, LINK, TOOL, FORCE]),
        ([(BOTH, 6, 0.1), (FORCE, 3, 0.101), (GAUGE, 3, 0.102)], [FORCE]),  # points are one cause, the simplest of them
        ([(BOTH, 6, 0.1), (FORCE, 3, 0.101), (LINK, 2, 0.102)], [LINK, FORCE, BOTH]),
    ],
)
def test_the_simplest_of_those_that_explain_best_and_what_cannot_be_told_from_it(found, likeliest):
    assert [each.cause for each in asked(*found).likeliest] == likeliest


def test_causes_that_cannot_be_told_apart_are_named_three_at_most():
    found = [(LINK, 2, 0.1), (TOOL, 2, 0.102), (ZERO, 1, 0.103), (FORCE, 3, 0.104), (Cause("drift"), 6, 0.1045)]
    for count, words in (
        (1, "explains poses left out best, missed by 10.0 % then instead of 40.0 %. "),
        (2, "; these tests cannot tell it from a spring of the tool. "),
        (3, "; these tests cannot tell it from a link that bends at joint 2 or a spring of the tool. "),
        (4, "; these tests cannot tell it from a link that bends at joint 2, a spring of the tool or 1 more. "),
        (5, "; these tests cannot tell it from a link that bends at joint 2, a spring of the tool or 2 more. "),
    ):
        (said,) = (each for each in model_findings(ROBOT, asked(*found[:count])) if each.code == "model-misses")
        assert words in said.message


@pytest.mark.parametrize(("lack", "growth", "told"), [(0.9e-3, 0.5, True), (1.1e-3, 0.5, False), (0.5, 0.9e-3, True)])
def test_what_chance_makes_once_in_a_thousand_is_said(lack, growth, told):
    found = model_findings(ROBOT, Inquest(0.1, (), lack, growth))
    assert [each.code for each in found] == ["model-misses"] * told
    assert all(("at one pose" in each.message) == (lack < growth) for each in found)


def test_a_zero_that_explains_best_is_said_first_and_points_that_explain_less_well_after_it():
    alone = model_findings(ROBOT, asked((ZERO, 1, 0.1)))
    assert [each.code for each in alone] == ["joint-zero", "model-misses"]
    assert "Joint 3 seems to stand +0.6° (± 0.1, 95 %) from its stated angles" in alone[0].message
    assert alone[0].message.endswith("anything else is fitted.")
    beside = model_findings(ROBOT, asked((ZERO, 1, 0.1), (FORCE, 3, 0.2)))
    assert beside[0].message.endswith("; another load point explains the readings less well.")
    alike = model_findings(ROBOT, asked((ZERO, 1, 0.1), (LINK, 2, 0.101)))
    assert "Joint 3 may stand" in alike[0].message


@pytest.mark.parametrize(
    ("bending", "found"),
    [
        ("auto", [(LINK, 2, 0.1)]),  # the tests have been asked
        ((2,), [(ZERO, 1, 0.1)]),  # nothing bends
        ((2,), [(TOOL, 1, 0.1), (LINK, 2, 0.101)]),  # the tool explains as well, by less
        ((2,), []),
    ],
)
def test_bending_is_offered_where_it_may_be_what_is_missing_and_was_not_asked(bending, found):
    """Where it is not, nothing is even fitted: candidates that hold no tests would say so."""
    candidates = SimpleNamespace(treatment=Treatment(bending=bending))
    assert bending_offer(candidates, "joints", asked(*found), 0.4) is None
