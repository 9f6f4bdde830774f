"""Whether it pays to fit the load point or the gauge point: asked of every identification that took them as stated."""

from dataclasses import replace

import numpy as np

from robomill.errors import LoadTestError
from robomill.identification.fit.crossvalidation import headline, relative_by_pose
from robomill.identification.fit.folds import folds_of
from robomill.identification.fit.least_squares import triangle
from robomill.identification.fit.models import Model
from robomill.identification.fit.selection import Candidates
from robomill.identification.fit.system import build_system
from robomill.identification.fit.treatment import Treatment
from robomill.identification.load_test import LoadTests
from robomill.identification.pull.found_points import FoundPoint, Offer, found_points
from robomill.identification.pull.points import FREED, slopes
from robomill.robot.model import Robot

MOST = 600  # tests that are looked at; more are thinned evenly
CHANCE = 1e-4  # with which noise alone would ask for other points
PAYS = 0.9  # share of the error on poses left out to which fitting points must bring it
FURTHER = 0.95  # the same for a second point


def offer_of(robot: Robot, tests: LoadTests, choice: Model, treatment: Treatment) -> Offer | None:
    """What fitting points would bring under this model; None where it does not pay or cannot be judged."""
    if treatment.freed or not choice.has("joint"):
        return None
    tests = tests.thinned(MOST)
    if not _asked_for(robot, tests, choice):
        return None
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


def _asked_for(robot: Robot, tests: LoadTests, choice: Model) -> bool:
    """Whether the readings ask for other points: an F-test of the six shifts, linear about the stated points."""
    from scipy.special import fdtrc

    try:
        system = build_system(robot, tests, choice, FREED["both"])
    except LoadTestError:
        return False
    x = system.fit().x
    p, s = len(x), 6
    G = slopes(system.every_term, x, np.zeros(s), system.freed)
    scale = np.where(np.linalg.norm(G, axis=0) > 0, np.linalg.norm(G, axis=0), 1.0)
    long = np.where(np.linalg.norm(system.A, axis=0) > 0, np.linalg.norm(system.A, axis=0), 1.0)
    wide = np.concatenate([system.A / long, G / scale], axis=1) / system.noise[:, None]
    R = triangle(wide, system.b / system.noise)
    left = [np.linalg.lstsq(R[:, :k], R[:, -1], rcond=1e-9)[0] for k in (p, p + s)]
    squares = [float(np.sum((R[:, : len(z)] @ z - R[:, -1]) ** 2)) for z in left]
    dof = len(system.b) - p - s
    if dof <= 0 or squares[0] <= 1e-20 * float(np.sum(R[:, -1] ** 2)):
        return False
    ratio = (squares[0] - squares[1]) / s / max(squares[1] / dof, 1e-300)
    return bool(fdtrc(s, dof, ratio) < CHANCE)
