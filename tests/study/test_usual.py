"""The numbers of a set-up that a page offers: each is what it is said to be, and a study takes it."""

import numpy as np
import pytest

import robomill as rm
from robomill.errors import StudyError
from robomill.study.addressed import changed, tables_of
from robomill.study.usual import usual_parameters


@pytest.mark.parametrize("sample", ["paper_flute", "heart", "two_tools"])
def test_each_usual_number_put_back_leaves_the_set_up_as_it_was_and_another_value_changes_it(sample: str) -> None:
    setup = rm.load_setup(sample)
    offered = usual_parameters(setup)
    assert len({each.key for each in offered}) == len(offered) >= 8
    before = rm.simulate(setup).max_deviation
    for each in offered:
        data = tables_of(setup, [each.key])
        now = changed(data, {each.key: each.in_key(each.now)})
        assert np.isclose(rm.simulate(now).max_deviation, before, rtol=1e-9), each.key
        assert changed(data, {each.key: each.in_key(each.high)}).digest() != now.digest(), each.key


def test_numbers_are_called_what_people_call_them() -> None:
    setup = rm.load_setup("paper_flute")
    assert [each.label for each in usual_parameters(setup)][:2] == ["Force, feed-normal", "Force, feed"]
    fixed = setup.replace(force=rm.ConstantForce((0.0, 100.0, 0.0)))
    assert [each.label for each in usual_parameters(fixed)][:3] == ["Force Y", "Force X", "Force Z"]


def test_an_arm_read_from_its_stiffnesses_offers_no_compliance_that_its_file_does_not_have() -> None:
    setup = rm.load_setup("paper_flute")
    odd = setup.replace(robot=setup.robot.replace(C_theta=setup.robot.C_theta * np.pi))
    for each in usual_parameters(odd):
        changed(tables_of(odd, [each.key]), {each.key: each.in_key(each.now)})


def test_a_feed_of_so_many_per_cent_is_every_feed_so_much_faster() -> None:
    setup = rm.load_setup("heart")
    made = changed(tables_of(setup, ["path.feed_percent"]), {"path.feed_percent": 50.0})
    at = setup.toolpath.cutting
    np.testing.assert_allclose(made.toolpath.v_f[at], 0.5 * setup.toolpath.v_f[at])
    np.testing.assert_array_equal(made.toolpath.p, setup.toolpath.p)
    with pytest.raises(StudyError, match=r"path.feed_percent: found -1; expected a number above 0"):
        changed(tables_of(setup, []), {"path.feed_percent": -1})
