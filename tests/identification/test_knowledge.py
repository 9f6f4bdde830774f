"""What is known of compliances: it belongs to exactly these, and goes through a project file unchanged."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest
import tomli_w

import robomill as rm
from robomill.arrays import digest
from robomill.compliance.springs.spindle import SpindleSpring
from robomill.errors import ProjectError
from robomill.identification.knowledge import Knowledge
from robomill.io.knowledge import knowledge_from_table, knowledge_to_table
from robomill.io.samples import samples_dir
from robomill.io.tables import Table

ROBOT = rm.load_robot("slavkovic_5r")
FIT = rm.identify(ROBOT, rm.read_load_tests(samples_dir() / "load_tests" / "tilted_bending_tool.csv"), "joints+bending")


def read(table, robot=ROBOT, springs=()):
    return knowledge_from_table(Table(table, "project file, [uncertainty]"), robot, springs)


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


@pytest.mark.parametrize(("force", "length"), [(0.0, 0.0), (3.0, 0.0), (0.0, 1e-3), (3.0, 1e-3)])
def test_it_goes_through_a_file_unchanged(force, length):
    arm, springs = FIT.applied_to(ROBOT), FIT.springs(ROBOT)
    known = Knowledge.of(FIT, ROBOT, "from 72 load tests").widened(ROBOT, force, length).held_by(arm, springs)
    np.testing.assert_array_equal(known.covariance, FIT.covariance)
    assert (known.F is None) == (force == 0)
    assert force == 0 or np.array_equal(known.F, 9.0 * np.eye(3))
    assert length == 0 or np.array_equal(known.lengths, np.full(10, 1e-3))
    again = read(tomllib.loads(tomli_w.dumps(knowledge_to_table(known))), arm, springs)
    assert digest(again) == digest(known)
    assert digest(again) != digest(known.widened(ROBOT, force + 1.0, length))


def test_older_files_may_leave_out_what_has_a_default():
    table = knowledge_to_table(Knowledge.of(FIT, ROBOT))
    del table["words"], table["bending_joints"], table["dof"]
    known = read(table)
    assert known.source == "from load tests"
    assert known.dof is None
    assert known.model.bending_joints == (2, 3)


def test_arrays_are_read_only_and_checked():
    known = Knowledge.of(FIT, ROBOT)
    with pytest.raises(ValueError, match="read-only"):
        known.covariance[0, 0] = 1.0
    table = knowledge_to_table(known.widened(ROBOT, 1.0, 1e-3))
    broken = ("x", {}, {**table, "model": "rubber"}, {**table, "covariance": [[1.0]]}, {**table, "lengths": [1.0, 2.0]})
    for bad in (*broken, {**table, "force_covariance": 3.0}, {**table, "dof": "many"}, {**table, "parameters": [1.0]}):
        with pytest.raises(ProjectError, match=r"\[uncertainty\]"):
            read(bad)
