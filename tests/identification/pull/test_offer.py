"""Which points are offered to be fitted: the rule as it is said, errors on poses left out laid down by hand."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import robomill as rm
from robomill.errors import LoadTestError
from robomill.identification.fit.models import Model
from robomill.identification.fit.suspects import Cause, Inquest, Suspect
from robomill.identification.fit.treatment import Treatment
from robomill.identification.load_test import LoadTests
from robomill.identification.pull import offer
from robomill.identification.pull.points import FREED

ROBOT = rm.load_robot("slavkovic_5r")
TESTS = LoadTests(np.ones((6, 3)), np.ones((6, 3)), theta=np.arange(30.0).reshape(6, 5) * 0.01, row=np.arange(6) + 5)
POINTS = Inquest(1.0, (Suspect(Cause("points", points="force"), 3, 1e-9, 0.5),))


def offered(monkeypatch, errors, near=(), inquest=POINTS, refused=(), **treatment):
    """The offer where fits have ``errors`` on poses left out, and the points ``near`` are not off."""
    asked = []

    def candidates(robot, tests, choice, how, fold):
        asked.append((how, fold))
        if how.fit_points in refused:
            raise LoadTestError("Too few.")
        fitted = SimpleNamespace(system=how.fit_points, weights=None, found=None)
        return SimpleNamespace(best=lambda: (choice, fitted), missed=lambda: SimpleNamespace(error=None))

    monkeypatch.setattr(offer, "Candidates", candidates)
    monkeypatch.setattr(offer, "relative_by_pose", lambda system, error, weights: errors[system])
    monkeypatch.setattr(offer, "headline", lambda error: error)
    monkeypatch.setattr(
        offer,
        "found_points",
        lambda robot, tests, freed, found: tuple(
            SimpleNamespace(is_off=point not in near, name=point) for point in freed
        ),
    )
    found = offer.offer_of(ROBOT, TESTS, Model("joints+bending", (3,)), Treatment(**treatment), inquest)
    return found, asked


@pytest.mark.parametrize(
    ("force", "gauge", "both", "name"),
    [
        (0.80, 0.50, 0.49, "gauge"),  # a second point must bring the error to 0.95 of it
        (0.50, 0.80, 0.49, "force"),
        (0.50, 0.80, 0.47, "both"),
        (0.91, 0.95, 0.90, None),  # nothing pays: nine tenths of the error at least are left
        (0.89, 0.95, 0.90, "force"),
        (1.20, 1.10, 1.05, None),
    ],
)
def test_the_fewest_points_are_offered_that_bring_nearly_as_much(monkeypatch, force, gauge, both, name):
    errors = {"none": 1.0, "force": force, "gauge": gauge, "both": both}
    found, _ = offered(monkeypatch, errors)
    assert (found and found.fit_points) == name
    if found:
        assert (found.before, found.after) == (1.0, errors[name])
        assert [point.name for point in found.points] == list(FREED[name])


def test_points_that_are_not_off_are_not_offered(monkeypatch):
    errors = {"none": 1.0, "force": 0.3, "gauge": 0.5, "both": 0.2}
    assert offered(monkeypatch, errors, near=("force",))[0].fit_points == "gauge"
    assert offered(monkeypatch, errors, near=("gauge",))[0].fit_points == "force"
    assert offered(monkeypatch, errors, near=("force", "gauge"))[0] is None
    assert offered(monkeypatch, errors, refused=("both", "force"))[0].fit_points == "gauge"
    assert offered(monkeypatch, errors, refused=("none",))[0] is None


def test_fits_are_asked_as_they_were_made_where_points_may_be_wrong(monkeypatch):
    """The same bending, folds and weights, no rows left out once more; nothing where no point is likely."""
    errors = dict.fromkeys(FREED, 1.0)
    _, asked = offered(monkeypatch, errors, weights="size", leave_out="neighbours", bending="auto", exclude=(1, 2))
    assert [how.fit_points for how, _ in asked] == list(FREED)
    for how, fold in asked:
        assert (how.bending, how.exclude, how.weights, how.leave_out) == ((3,), (), "size", "neighbours")
        assert sorted(fold) == list(range(6))
    tool = Inquest(1.0, (Suspect(Cause("tool"), 2, 1e-9, 0.5),))
    assert offered(monkeypatch, errors, inquest=tool) == (None, [])
