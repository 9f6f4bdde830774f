"""What is known of compliances: it belongs to exactly these."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import robomill as rm
from robomill.compliance.springs.spindle import SpindleSpring
from robomill.identification.knowledge import Knowledge
from robomill.io.samples import samples_dir

ROBOT = rm.load_robot("slavkovic_5r")
FIT = rm.identify(ROBOT, rm.read_load_tests(samples_dir() / "load_tests" / "tilted_bending_tool.csv"), "joints+bending")


def test_it_holds_for_exactly_its_compliances():
    arm, springs = FIT.applied_to(ROBOT), FIT.springs(ROBOT)
    known = Knowledge.of(FIT, ROBOT).held_by(arm, springs)
    assert known.holds_for(arm, springs)
    assert known.holds_for(arm.replace(name="another name"), list(springs))
    assert not Knowledge.of(FIT, ROBOT).holds_for(arm, springs)
    assert not known.holds_for(ROBOT, springs)
    assert not known.holds_for(arm, springs[:1])
    assert not known.holds_for(arm, (*springs, SpindleSpring(1e-9)))
    changed = arm.replace(C_theta=arm.C_theta * np.array([1, 1, 1 + 1e-12, 1, 1]))
    assert not known.holds_for(changed, springs)
    assert known.holds_for(changed.replace(C_theta=arm.C_theta), springs)


def test_what_is_kept_of_an_unseen_joint_goes_with_nothing_else():
    """Its value is the robot's: what the fit's own went along with is of another number."""
    stderr = np.where(np.arange(5) == 3, np.inf, FIT.stderr)
    size = np.sqrt(np.diag(FIT.covariance)[:5]) + 1e-12
    covariance = np.array(FIT.covariance)
    covariance[:5, :5] += 1e4 * np.outer(size, size)  # all the fit's numbers go along with one another
    kept = {name: getattr(FIT, name) for name in ("choice", "parameters", "has_joints", "dof", "band")}
    known = Knowledge.of(SimpleNamespace(**kept, stderr=stderr, covariance=covariance), ROBOT)
    assert known.parameters[3] == ROBOT.C_theta[3]
    assert known.covariance[3, 3] == ROBOT.C_theta[3] ** 2
    draws = np.random.default_rng(0).multivariate_normal(np.zeros(len(size)), known.covariance[:5, :5], 4000)
    assert np.abs(np.corrcoef(draws.T)[3, [0, 1, 2, 4]]).max() < 0.1
    rest = np.flatnonzero(np.arange(len(covariance)) != 3)
    np.testing.assert_array_equal(known.covariance[np.ix_(rest, rest)], covariance[np.ix_(rest, rest)])
    scale = np.sqrt(np.maximum(np.diag(known.covariance), 1e-40))
    assert np.linalg.eigvalsh(known.covariance / np.outer(scale, scale)).min() > -1e-9, "and it is a covariance"


@pytest.mark.parametrize(("force", "length"), [(0.0, 0.0), (3.0, 0.0), (0.0, 1e-3), (3.0, 1e-3)])
def test_it_is_widened_by_what_is_not_known_of_force_and_lengths(force, length):
    known = Knowledge.of(FIT, ROBOT).widened(ROBOT, force, length)
    np.testing.assert_array_equal(known.covariance, FIT.covariance)
    assert (known.F is None, known.lengths is None) == (force == 0, length == 0)
    assert force == 0 or np.array_equal(known.F, 9.0 * np.eye(3))
    assert length == 0 or np.array_equal(known.lengths, np.full(10, 1e-3))
    given = {name: value for name, value in (("force", force), ("length", length)) if value}
    alone = Knowledge.of(FIT, ROBOT).widened(ROBOT, **given)  # what is not stated is certain
    assert (alone.F is None, alone.lengths is None) == (known.F is None, known.lengths is None)


def test_its_arrays_are_read_only():
    with pytest.raises(ValueError, match="read-only"):
        Knowledge.of(FIT, ROBOT).covariance[0, 0] = 1.0


def test_it_says_what_it_is_of_in_a_line():
    assert repr(Knowledge.of(FIT, ROBOT, "from 72 load tests")) == (
        "<Knowledge joints and bending links, 9 parameters: from 72 load tests>"
    )
