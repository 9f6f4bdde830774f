"""An arm on a rail: compliances of joints that slide are told in metres a newton, wherever they are."""

import json
from pathlib import Path

import numpy as np
import pytest

import robomill as rm
from robomill.cli import main
from robomill.simulation.origin.origins import robot_sources

RAIL = """
format = "robomill robot"
version = 1
name = "on_a_rail"
[[joint]]
type = "prismatic"
a_mm = 0
alpha_deg = -90
d_mm = 0
theta_offset_deg = 0
limits_mm = [-1000, 1000]
[[joint]]
a_mm = 700
alpha_deg = 0
d_mm = 0
theta_offset_deg = -90
limits_deg = [-170, 170]
[[joint]]
a_mm = 500
alpha_deg = 0
d_mm = 0
theta_offset_deg = 0
limits_deg = [-170, 170]
[base]
rotation = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
[compliance]
"C_theta_1e-7_rad_per_Nm" = [0.8, 8.0, 11.0]
"""
C = np.array([0.8e-7, 8e-7, 11e-7])


def by_hand(s: float, a: float, b: float) -> np.ndarray:
    """(3, 3) Jacobian: the rail along X, two links in the plane of X and Y."""
    far, near = 0.5 * np.array([-np.sin(a + b), np.cos(a + b), 0.0]), 0.7 * np.array([-np.sin(a), np.cos(a), 0.0])
    return np.column_stack([[1.0, 0.0, 0.0], near + far, far])


@pytest.fixture
def files(tmp_path: Path) -> tuple[str, str]:
    rows = ["theta1_mm,theta2_deg,theta3_deg,Fx_N,Fy_N,Fz_N,dx_mm,dy_mm,dz_mm"]
    rng = np.random.default_rng(4)
    for _ in range(12):
        q = rng.uniform(-0.8, 0.8, 3)
        F = np.array([*rng.uniform(-200.0, 200.0, 2), 0.0])
        J = by_hand(*q)
        d = J @ (C * (J.T @ F)) + np.array([*rng.normal(0.0, 1e-9, 2), 0.0])
        rows.append(",".join(f"{v:.12g}" for v in (q[0] * 1e3, *np.degrees(q[1:]), *F, *d * 1e3)))
    (tmp_path / "arm.toml").write_text(RAIL)
    (tmp_path / "tests.csv").write_text("\n".join(rows) + "\n")
    return str(tmp_path / "arm.toml"), str(tmp_path / "tests.csv")


def test_identified_compliances_of_a_rail_have_its_unit(
    files: tuple[str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["identify", *files, "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["C_theta"] == pytest.approx(C, rel=1e-3)
    assert record["C_theta_units"] == ["m/N", "rad/(N m)", "rad/(N m)"]
    main(["identify", *files])
    rows = [line.split() for line in capsys.readouterr().out.splitlines()[2:5]]
    assert float(rows[0][1]) == pytest.approx(80.0, rel=1e-3)
    assert "1e-9 m/N" in " ".join(rows[0])
    assert float(rows[1][1]) == pytest.approx(8.0, rel=1e-3)
    assert "m/N" not in " ".join(rows[1])


def test_what_a_result_rests_on_gives_each_joint_its_unit(files: tuple[str, str]) -> None:
    value = robot_sources(rm.load_robot(files[0]), {})[0].value
    assert "80.00 ×10⁻⁹ m/N, 8.00, 11.00 ×10⁻⁷ rad/(N m)" in value
    assert robot_sources(rm.load_robot("planar_2r"), {})[0].value.count("rad/(N m)") == 1
