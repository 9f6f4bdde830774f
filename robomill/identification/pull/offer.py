"""Whether it pays to fit the load point or the gauge point: asked of every identification that took them as stated."""

from dataclasses import replace

import numpy as np

from robomill.errors import LoadTestError
from robomill.identification.fit.causes import MOST
from robomill.identification.fit.crossvalidation import headline, relative_by_pose
from robomill.identification.fit.folds import folds_of
from robomill.identification.fit.models import Model
from robomill.identification.fit.selection import Candidates
from robomill.identification.fit.suspects import Inquest
from robomill.identification.fit.treatment import Treatment
from robomill.identification.load_test import LoadTests
from robomill.identification.pull.found_points import FoundPoint, Offer, found_points
from robomill.identification.pull.points import FREED
from robomill.robot.model import Robot

PAYS = 0.9  # share of the error on poses left out to which fitting points must bring it
FURTHER = 0.95  # the same for a second point


def offer_of(robot: Robot, tests: LoadTests, choice: Model, treatment: Treatment, inquest: Inquest) -> Offer | None:
    """What fitting points would bring under this model, where they may be what is wrong; None where it does not pay."""
    if not any(each.cause.kind == "points" for each in inquest.likeliest):
        return None
    tests = tests.thinned(MOST)
    fold = folds_of(treatment.leave_out, tests.pose_index(), tests.theta)
    found: dict[str, tuple[float, tuple[FoundPoint, ...]]] = {}
    for name in FREED:
        try:
            how = replace(treatment, fit_points=name, bending=choice.bending_joints, exclude=())
            candidates = Candidates(robot, tests, choice, how, fold)
            _, fitted = candidates.best()
            error = headline(relative_by_pose(fitted.system, candidates.missed().error, fitted.weights))
        except LoadTestError:
            continue
        found[name] = error, found_points(robot, tests, how.freed, fitted.found)
    before = found.pop("none", (np.nan, ()))[0]
    good = {name: each for name, each in found.items() if all(point.is_off for point in each[1])}
    if not good:
        return None
    least = min(error for error, _ in good.values())
    name = min((n for n in good if good[n][0] <= least / FURTHER), key=lambda n: len(FREED[n]))
    after, points = good[name]
    return Offer(name, points, before, after) if after < PAYS * before else None
