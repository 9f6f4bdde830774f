"""Derivatives of the deviation by compliances and lengths, against differences of runs in full and a closed form."""

import numpy as np
import pytest

import robomill as rm
from robomill.errors import SetupError


def numeric(setup: rm.SimulationSetup, key: str, step: float) -> np.ndarray:
    """By a number of the arm, (m, 3) along feed, feed-normal and axis."""
    robot, (name, _, number) = setup.robot, key.rpartition("_")
    found = []
    for sign in (1.0, -1.0):
        values = np.array(getattr(robot, name))
        values[int(number) - 1] += sign * step
        found.append(rm.simulate(setup.replace(robot=robot.replace(**{name: values}))).delta_in_cut)
    return (found[0] - found[1]) / (2.0 * step)


@pytest.mark.parametrize("name", ["paper_flute", "heart", "two_tools"])
def test_every_compliance_and_length_as_differences_of_simulate_have_it(name: str) -> None:
    setup = rm.load_setup(name).replace(step=10e-3, cell=4e-4)
    found = rm.sensitivity(setup)
    size = np.abs(found.run.delta_in_cut).max()
    for each, delta in zip(found.inputs, found.delta, strict=True):
        step = 1e-3 * each.value if each.group == "compliance" else 1e-4
        expected = numeric(setup, each.key, step)
        scale = max(np.abs(expected).max(), size)  # of a length: the deviation per metre
        np.testing.assert_allclose(delta, expected, atol=2e-5 * scale, err_msg=each.key)


def test_an_arm_with_two_links_has_it_in_closed_form() -> None:
    """The elbow of a planar arm gives C2 F h^2 towards the base, h its height over the line from there to the tip."""
    robot = rm.load_robot("planar_2r")
    reach = 0.7
    l1, l2 = robot.a[:2]
    setup = rm.SimulationSetup(
        robot=robot.replace(C_theta=[0.0, 1e-6]),
        source=rm.Toolpath.from_points(p_mm=[[0, -1, 0], [0, 0, 0]], feed_mm_min=600),
        part_zero=(reach, 0.0, 0.0),
        cutter=rm.Cutter("flat", diameter_mm=8, flutes=3),
        force=rm.ConstantForce((100.0, 0.0, 0.0)),
    )
    found = rm.sensitivity(setup)
    run = found.run
    x = (l1**2 - l2**2 + reach**2) / (2 * reach)
    h2 = l1**2 - x**2
    assert run.delta[-1, 0] == pytest.approx(1e-6 * 100.0 * h2, rel=1e-9)
    R, values = run.R_MF[-1], dict(zip((e.key for e in found.inputs), found.delta[:, -1], strict=True))
    by_l1 = 1e-4 * (2 * l1 - 2 * x * l1 / reach)
    by_l2 = 1e-4 * (2 * x * l2 / reach)
    assert (R @ values["a_1"])[0] == pytest.approx(by_l1, rel=1e-6)
    assert (R @ values["a_2"])[0] == pytest.approx(by_l2, rel=1e-6)
    assert (R @ values["C_theta_2"])[0] == pytest.approx(100.0 * h2, rel=1e-9)


def test_a_table_with_one_row_a_number() -> None:
    pytest.importorskip("pandas")
    setup = rm.load_setup("paper_flute").replace(step=20e-3)
    found = rm.sensitivity(setup)
    frame = found.to_dataframe().set_index("input")
    softer = setup.robot.C_theta * [1, 1, 1.01, 1, 1]
    then = rm.simulate(setup.replace(robot=setup.robot.replace(C_theta=softer))).max_deviation
    change = (then - found.run.max_deviation) * 1e3
    assert frame.loc["C_theta_3", "max_deviation_changes_mm"] == pytest.approx(change, rel=0.01)


def test_a_measured_map_is_refused() -> None:
    with pytest.raises(SetupError, match="measured map, in which no joint is known"):
        rm.sensitivity(rm.load_setup("paper_flute/setup_measured_map"))
