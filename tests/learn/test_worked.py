"""What is worked out on a tile: the printed numbers, read back and put into the printed law, give the printed result.

Nothing of the module's own law is used: the TeX is read as a reader would, and computed with NumPy.
"""

from __future__ import annotations

import re

import numpy as np
import pytest

import robomill as rm
from robomill.compliance.at_pose import PoseReport
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.learn.worked import Worked, at_the_pose, of_the_run
from robomill.simulation.result import SimulationResult

NUMBER = r"-?\d+(?:\.\d+)?"
ARMS = ("slavkovic_5r", "kuka_kr500", "fanuc_r2000ic")


def matrices(tex: str) -> list[np.ndarray]:
    """Every matrix of the TeX."""
    found = re.findall(r"\\begin\{bmatrix\}(.*?)\\end\{bmatrix\}", tex, re.DOTALL)
    return [np.array([[float(cell) for cell in row.split("&")] for row in each.split(r"\\")]) for each in found]


def result_of(tex: str) -> str:
    """What stands after the last equals sign."""
    return re.findall(rf"= (?:\{{\}} & )?({NUMBER})", tex)[-1]


def decimals(text: str) -> int:
    return len(text.partition(".")[2])


def reads(value: float, text: str) -> bool:
    """Whether a value rounds to what is printed."""
    return abs(value - float(text)) <= 0.5 * 10.0 ** -decimals(text) * (1 + 1e-9)


def by_name(found: list[Worked]) -> dict[str, Worked]:
    return {each.name: each for each in found}


def posed(name: str, k: int) -> PoseReport:
    """An arm somewhere within its limits, always the same places."""
    robot = rm.load_robot(name)
    low, high = robot.limits.T
    return rm.at_pose(robot, np.random.default_rng(k).uniform(0.8 * low, 0.8 * high))


@pytest.mark.parametrize("name", ARMS)
@pytest.mark.parametrize("k", range(4))
def test_what_is_printed_at_a_pose_multiplies_out(name: str, k: int) -> None:
    pose = posed(name, k)
    F = np.random.default_rng(100 + k).uniform(-300.0, 300.0, 3)
    found = by_name(at_the_pose(pose, F, pose.delta(F)))
    for c in ("xx", "yy", "zz", "xy", "xz", "yz"):
        tex = found[f"C_{c}"].numbers
        terms = re.findall(rf"({NUMBER})\\cdot \(({NUMBER})\)(?:\^2|\(({NUMBER})\)) &&", tex)
        total = sum(float(C) * float(a) * float(b or a) for C, a, b in terms)
        assert reads(total, result_of(tex))
        assert reads(pose.component(c) * 1e6, result_of(tex))
    J, C = matrices(found["C, all of it"].numbers)
    C_theta = np.array([float(v) for v in re.findall(NUMBER, re.search(r"diag\}\((.*?)\)", tex_of(found)).group(1))])
    np.testing.assert_allclose(np.round((J * C_theta) @ J.T, 3), C, atol=1.1e-3)
    np.testing.assert_allclose(C, pose.C * 1e6, atol=5.1e-4)
    u, C, again = matrices(found["Largest compliance"].numbers)
    np.testing.assert_array_equal(u, again)
    assert reads(float((u.T @ C @ u).item()), result_of(found["Largest compliance"].numbers))
    (J,) = matrices(found["det(J)"].numbers)
    assert reads(float(np.linalg.det(J)), result_of(found["det(J)"].numbers))
    assert reads(pose.det_J, result_of(found["det(J)"].numbers))
    C, F_said, moved = matrices(found["Displacement of the tip"].numbers)
    np.testing.assert_allclose(C @ F_said, moved, atol=0.0501)
    np.testing.assert_allclose(moved[:, 0], pose.delta(F) * 1e6, atol=0.0501)
    size = found["Tip off its path"].numbers
    parts = [float(v) for v in re.findall(rf"\(({NUMBER})\)\^2", size)]
    assert reads(float(np.linalg.norm(parts)), result_of(size))
    assert reads(float(np.linalg.norm(pose.delta(F))) * 1e6, result_of(size))


def tex_of(found: dict[str, Worked]) -> str:
    return found["C, all of it"].numbers


def test_the_shares_of_the_joints_are_what_they_give_along_the_displacement() -> None:
    pose = posed("slavkovic_5r", 1)
    F = np.array([0.0, 100.0, 0.0])
    parts = np.array([C @ F for C in pose.C_joint])
    whole = parts.sum(axis=0)
    found = [each for each in at_the_pose(pose, F, pose.delta(F)) if each.name.startswith("Share of joint")]
    assert len(found) == 3
    for each in found:
        k = pose.robot.joint_numbers.index(int(each.name.split()[-1]))
        above, below = re.search(r"\\frac\{(.*)\}\{(.*)\} =", each.numbers).groups()
        top = sum(float(a) * float(b) for a, b in re.findall(rf"\(({NUMBER})\)\(({NUMBER})\)", above))
        bottom = sum(float(a) ** 2 for a in re.findall(rf"\(({NUMBER})\)\^2", below))
        assert reads(100.0 * top / bottom, result_of(each.numbers))
        assert reads(100.0 * float(parts[k] @ whole) / float(whole @ whole), result_of(each.numbers))


def test_what_springs_give_beside_the_joints_is_not_printed_as_the_joints_product() -> None:
    """At a pose whose tip moves by more than its joints give, the product C F would not be the number shown."""
    pose = posed("slavkovic_5r", 1)
    F = np.array([0.0, 100.0, 0.0])
    names = {each.name for each in at_the_pose(pose, F, 1.2 * pose.delta(F))}
    assert "Displacement of the tip" not in names
    assert "C_yy" in names


def test_nothing_is_worked_out_where_the_arm_does_not_get() -> None:
    robot = rm.load_robot("slavkovic_5r")
    assert at_the_pose(rm.at_pose(robot, np.full(5, np.nan)), np.ones(3), np.ones(3)) == []


@pytest.fixture(scope="module")
def run() -> SimulationResult:
    """The paper's slot."""
    return rm.simulate(rm.load_setup("paper_flute"))


def test_the_readings_of_a_run_multiply_out_to_what_its_verdict_says(run: SimulationResult) -> None:
    found = by_name(of_the_run(run, run.decided.sample))
    for name, reading in (("Wall error", run.verdict.wall), ("Floor error", run.verdict.floor)):
        tex = found[name].numbers
        total = sum(float(a) * float(b) for a, b in re.findall(rf"\(({NUMBER})\)\(({NUMBER})\)", tex))
        assert reads(total, result_of(tex))
        assert reads(reading.value * 1e6, result_of(tex))
    share = found["Share of the tolerance"].numbers
    value, allowed = re.search(rf"\\frac\{{({NUMBER})\}}\{{({NUMBER})\}}", share).groups()
    assert reads(100.0 * float(value) / float(allowed), result_of(share))
    assert reads(100.0 * run.verdict.share, result_of(share))
    C, F, moved = matrices(found["Displacement of the tip"].numbers)
    np.testing.assert_allclose(C @ F, moved, atol=0.0501)
    np.testing.assert_allclose(moved[:, 0], run.delta[run.decided.sample] * 1e6, atol=0.0501)


def test_the_force_of_a_straight_edge_is_its_closed_form() -> None:
    """A flat mill without a helix in a full slot: F_n = N a (Ktc c / 4 + Kte / pi), by hand."""
    setup = load_setup(samples_dir() / "paper_flute" / "setup_process.toml")
    result = rm.simulate(setup)
    i = result.decided.sample
    (force,) = [each for each in of_the_run(result, i) if each.name == "Force across the feed"]
    row = setup.force.row
    c, a = 0.05e-3, float(result.conditions.a_p[i])
    by_hand = 3 * a * (row.Ktc * c / 4 + row.Kte / np.pi)
    assert reads(by_hand, result_of(force.numbers))
    numbers = [float(v) for v in re.findall(NUMBER, force.numbers)]
    N, a, c, _, Ktc, *_ = numbers
    assert (N, Ktc) == (3.0, row.Ktc * 1e-6)
    assert (a, c) == (2.0, 0.05)
