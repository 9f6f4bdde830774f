"""What is known of compliances goes through a project file unchanged."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest
import tomli_w

import robomill as rm
from robomill.arrays import digest
from robomill.errors import ProjectError
from robomill.identification.knowledge import Knowledge
from robomill.io.samples import samples_dir
from robomill.io.setups.knowledge import knowledge_from_table, knowledge_to_table
from robomill.io.tables import Table

ROBOT = rm.load_robot("slavkovic_5r")
FIT = rm.identify(ROBOT, rm.read_load_tests(samples_dir() / "load_tests" / "tilted_bending_tool.csv"), "joints+bending")


def read(table, robot=ROBOT, springs=()):
    return knowledge_from_table(Table(table, "project file, [uncertainty]"), robot, springs)


@pytest.mark.parametrize(("force", "length"), [(0.0, 0.0), (3.0, 0.0), (0.0, 1e-3), (3.0, 1e-3)])
def test_it_goes_through_a_file_unchanged(force, length):
    arm, springs = FIT.applied_to(ROBOT), FIT.springs(ROBOT)
    known = Knowledge.of(FIT, ROBOT, "from 72 load tests").widened(ROBOT, force, length).held_by(arm, springs)
    again = read(tomllib.loads(tomli_w.dumps(knowledge_to_table(known))), arm, springs)
    assert digest(again) == digest(known)
    for name in ("parameters", "covariance", "F", "lengths"):
        np.testing.assert_array_equal(getattr(again, name), getattr(known, name))
    assert (again.model, again.dof, again.error, again.source) == (known.model, known.dof, known.error, known.source)
    assert digest(again) != digest(known.widened(ROBOT, force + 1.0, length))


def test_older_files_may_leave_out_what_has_a_default():
    table = knowledge_to_table(Knowledge.of(FIT, ROBOT))
    del table["words"], table["bending_joints"], table["dof"]
    known = read(table)
    assert known.source == "from load tests"
    assert known.dof is None
    assert known.model.bending_joints == (2, 3)


def test_what_is_of_the_wrong_shape_is_refused():
    known = Knowledge.of(FIT, ROBOT)
    table = knowledge_to_table(known.widened(ROBOT, 1.0, 1e-3))
    broken = ("x", {}, {**table, "model": "rubber"}, {**table, "covariance": [[1.0]]}, {**table, "lengths": [1.0, 2.0]})
    for bad in (*broken, {**table, "force_covariance": 3.0}, {**table, "dof": "many"}, {**table, "parameters": [1.0]}):
        with pytest.raises(ProjectError, match=r"\[uncertainty\]"):
            read(bad)


@pytest.mark.parametrize(
    ("key", "wrong"),
    [
        ("dof", 0),
        ("covariance", -np.eye(9) * 1e-16),
        ("covariance", np.triu(np.full((9, 9), 1e-16))),
        ("covariance", np.eye(9) * 1e300),
        ("covariance", np.full((9, 9), 1e-16) * (2.0 * np.eye(9) - 1.0)),  # each pair opposed: there is no such thing
        ("force_covariance", np.diag([1.0, -1.0, 1.0])),
        ("model_error", [-0.1, 0.0, 0.0]),
        ("model_error", [1e200, 0.0, 0.0]),
        ("lengths", [-1e-3] * 10),
    ],
)
def test_numbers_that_say_nothing_of_how_sure_one_is_are_refused(key: str, wrong):
    table = knowledge_to_table(Knowledge.of(FIT, ROBOT)) | {key: np.asarray(wrong).tolist()}
    with pytest.raises(ProjectError, match=rf"\[uncertainty\], {key}: "):
        read(table)
