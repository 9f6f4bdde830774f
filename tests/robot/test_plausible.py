"""Stiffnesses in the wrong thousand: published arms are taken as they are, and refused a thousand times as stiff."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.errors import RobotError
from robomill.robot.plausible import hardly_an_arm, tip_compliance

# Stiffnesses of arms in N m/rad as they are published, with the links of a milling robot of that size (m).
PUBLISHED = {
    "KUKA KR 270": ([350, 1250, -55, 0, 0, 0], [750, 0, 0, 1300, 0, 300], [3.8e6, 6.6e6, 3.9e6, 5.6e5, 6.6e5, 4.7e5]),
    "its tenth": ([350, 1250, -55, 0, 0, 0], [750, 0, 0, 1300, 0, 300], [3.8e5, 6.6e5, 3.9e5, 5.6e4, 6.6e4, 4.7e4]),
    "KUKA KR 500": ([500, 1300, -55, 0, 0, 0], [1045, 0, 0, 1025, 0, 290], [6.5e6, 7.6e6, 3.08e6, 5e5, 6e5, 4e5]),
    "FANUC R-2000iC": (
        [312, 1075, 225, 0, 0, 0],
        [670, 0, 0, 1280, 0, 215],
        [861600, 2856000, 1848000, 279400, 418700, 277700],
    ),
    "a light arm": ([0, 425, 392, 0, 0, 0], [89, 0, 0, 109, 95, 82], [2e4, 2e4, 2e4, 1e4, 1e4, 1e4]),
}
ALPHA = [-90, 0, -90, 90, -90, 0]


def arm(name: str, **stiffness: object) -> rm.Robot:
    a, d, _ = PUBLISHED[name]
    return rm.Robot.from_dh(a_mm=a, d_mm=d, alpha_deg=ALPHA, limits_deg=(-180, 180), **stiffness)


@pytest.mark.parametrize("name", PUBLISHED)
def test_newton_metres_under_a_name_of_kilonewton_metres_are_refused(name: str) -> None:
    """They make an arm a thousand times as stiff: its deviation was a thousandth, and green."""
    k = np.array(PUBLISHED[name][2])
    right = arm(name, k_theta_kNm_per_rad=k / 1000)
    np.testing.assert_allclose(right.C_theta, 1 / k)
    assert hardly_an_arm(right) == ""
    with pytest.raises(RobotError, match="k_theta_kNm_per_rad.* (If N m/rad are meant|in another unit)"):
        arm(name, k_theta_kNm_per_rad=k)
    with pytest.raises(RobotError, match="k_theta_kNm_per_rad.* (If N m/rad are meant|in another unit)"):
        right.replace(k_theta_kNm_per_rad=k)


@pytest.mark.parametrize("name", PUBLISHED)
def test_kilonewton_metres_under_a_name_of_newton_metres_are_refused(name: str) -> None:
    k = np.array(PUBLISHED[name][2])
    with pytest.raises(RobotError, match="k_theta_Nm_per_rad"):
        arm(name, k_theta_Nm_per_rad=k / 1000)


def test_the_sentence_says_both_ways_out() -> None:
    with pytest.raises(RobotError) as caught:
        arm("its tenth", k_theta_kNm_per_rad=PUBLISHED["its tenth"][2])
    assert str(caught.value) == (
        "Robot 'robot': k_theta_kNm_per_rad: no arm's joints are as stiff (its softest has 47\u202f000 kN m/rad): "
        "k_theta_kNm_per_rad is in kN m/rad. If N m/rad are meant, give k_theta_Nm_per_rad; if these stiffnesses are, "
        "give C_theta, one over each."
    )


def test_whoever_means_them_gives_the_compliances() -> None:
    k = np.array(PUBLISHED["KUKA KR 270"][2]) * 100
    np.testing.assert_allclose(arm("KUKA KR 270", C_theta=1 / k).C_theta, 1 / k)


def test_rigid_joints_are_nobodys_slip() -> None:
    """A joint of infinite stiffness says so: what is left may give as little as it likes."""
    stiff = arm("KUKA KR 270", k_theta_kNm_per_rad=[np.inf, np.inf, np.inf, np.inf, np.inf, 470])
    assert (stiff.C_theta[:-1] == 0.0).all()


def test_the_tip_gives_what_the_joints_give_over_all_links() -> None:
    """Two joints, links of 0.5 and 0.4 m: C_1 (0.9)^2 + C_2 (0.4)^2, the stretched arm by hand."""
    two = rm.Robot.from_dh(a_mm=[500, 400], k_theta_kNm_per_rad=[800, 500])
    assert tip_compliance(two) == pytest.approx(0.9**2 / 8e5 + 0.4**2 / 5e5, rel=1e-12)


def test_what_comes_in_without_a_unit_is_doubted_beside_the_result() -> None:
    """A file or plain SI may say what no arm is: it is run, and said."""
    setup = rm.load_setup("paper_flute").replace(step_mm=10, cell_mm=0.5)
    for times, words in ((1e-3, "no arm's joints are as stiff"), (1e3, "no arm that mills is as soft")):
        result = rm.simulate(setup.replace(robot=setup.robot.replace(C_theta=times * setup.robot.C_theta)))
        assert [note for note in result.notes if note.code == "unit-slip" and words in note.message]
    assert not [note for note in rm.simulate(setup).notes if note.code in ("unit-doubt", "unit-slip")]


# Lengths between the joints (m) and torques (N m) of URDF descriptions by others (kroshu/kuka_robot_descriptions), with
# a tool of 150 mm.
TORQUES = {
    "KR 800": ([0.6402, 1.25, 0.7343, 0.346, 0.2488, 0.24], [15000, 17880, 15009, 5754, 5724, 2811]),
    "KR 4": ([0.1915, 0.29, 0.1805, 0.1476, 0.0647, 0.18], [119, 105.9, 54.3, 11.8, 12.3, 6.92]),
    "LBR iisy 11": ([0.1535, 0.5905, 0.1377, 0.4212, 0.0979, 0.244], [405.8, 366.2, 147.2, 65.5, 64.7, 15.7]),
}


@pytest.mark.parametrize("per_torque", [100.0, 300.0, 1100.0])
@pytest.mark.parametrize("name", TORQUES)
def test_arms_from_the_smallest_to_the_largest_are_told_from_a_thousand_times_as_stiff(
    name: str, per_torque: float
) -> None:
    """Gears turn by 1/100 to 1/1100 rad under their torque: such an arm is taken, in another unit it is refused."""
    links, torques = TORQUES[name]
    k = per_torque * np.array(torques)

    def straight(**given: object) -> rm.Robot:
        return rm.Robot.from_dh(a=links, **given)

    right = straight(k_theta_Nm_per_rad=np.maximum(k, 1001.0))
    assert hardly_an_arm(right) == ""
    stretched = np.cumsum(np.array(links)[::-1])[::-1]
    assert tip_compliance(right) == pytest.approx((stretched**2 / np.maximum(k, 1001.0)).sum())
    for wrong in ({"k_theta_kNm_per_rad": k}, {"k_theta_Nm_per_rad": k / 1000}):
        with pytest.raises(RobotError, match="no arm|in another unit"):
            straight(**wrong)


def test_of_fewer_joints_less_is_asked() -> None:
    """Two joints of 3000 and 2000 kN m/rad with links of 0.5 and 0.4 m give 3.5e-7 m/N: stiff, and no slip."""
    two = rm.Robot.from_dh(a_mm=[500, 400], k_theta_kNm_per_rad=[3000, 2000])
    assert tip_compliance(two) == pytest.approx(0.81 / 3e6 + 0.16 / 2e6)
    assert hardly_an_arm(two) == ""


@pytest.mark.parametrize(
    ("length", "k", "said"),
    [
        (3.0, 9.9e6, ""),  # 0.91 um/N: a long arm, and no joint too stiff
        (3.0, 1.01e7, "as stiff"),  # a joint stiffer than any arm's softest, though the tip gives 0.89 um/N
        (0.5, 2.9e6, ""),  # 8.6e-8 m/N of one joint
        (0.5, 3.1e6, "as stiff"),  # 8.1e-8 m/N: less than any arm's tip
        (1.0, 1.01e3, ""),  # 0.99 mm/N
        (1.1, 1.01e3, "as soft"),  # 1.2 mm/N
    ],
)
def test_each_bound_by_itself_of_an_arm_of_one_joint(length: float, k: float, said: str) -> None:
    """The tip gives L^2 / k: at most 1 mm/N, at least 5e-7 / 6 m/N for its joint, which has at most 1e7 N m/rad."""
    one = rm.Robot.from_dh(a=[length], C_theta=[1.0 / k])
    assert tip_compliance(one) == pytest.approx(length**2 / k)
    found = hardly_an_arm(one)
    assert said in found
    assert bool(found) == bool(said)


def test_joints_that_slide_are_no_lever_and_count_for_no_turn() -> None:
    """A slide of 2e-8 m/N before a joint at 0.5 m: 2e-8 + 0.25 / k at the tip, one joint that turns."""
    for k, said in ((3.9e6, ""), (4.1e6, "as stiff")):
        arm = rm.Robot.from_dh(
            a=[0.7, 0.5], prismatic=[True, False], limits=[(0.0, 1.0), (-1.0, 1.0)], C_theta=[2e-8, 1 / k]
        )
        assert tip_compliance(arm) == pytest.approx(2e-8 + 0.25 / k)
        assert said in hardly_an_arm(arm)
        assert bool(hardly_an_arm(arm)) == bool(said)
    rail = rm.Robot.from_dh(a=[0.7], prismatic=[True], limits=[(0.0, 1.0)], C_theta=[1e-10])
    assert hardly_an_arm(rail) == ""
