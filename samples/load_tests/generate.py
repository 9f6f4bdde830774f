"""Makes the load tests of this folder. They are synthetic: the paper prints no raw measurements.

Run from the project's folder: ``python samples/load_tests/generate.py``. The same seeds give the same files.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import robomill as rm
from robomill.identification.load_test import LoadTests
from robomill.identification.fit.models import Model
from robomill.identification.plan import box_candidates
from robomill.identification.synthesis import three_directions
from robomill.io.measured.load_test_sheets import load_tests_to_csv
from robomill.kinematics.forward import tool_pose
from robomill.kinematics.transforms import world_from_pose
from robomill.units import from_si, to_si

HERE = Path(__file__).parent
sys.path.append(str(HERE.parents[1] / "tests" / "identification"))
from synthetic import simulated_tests, true_parameters  # noqa: E402 - tests of any model are made where they are needed

LOAD = 250.0  # N, the paper's dead weight
NOISE = 4e-6  # m
STIFF_TOOL = {"tool across": 5e-9, "tool along": 1e-9}  # m/N: a short tool with a sphere for its tip
SOFT_TOOL = {"tool across": 4e-8, "tool along": 1e-8, "bending x at joint 2": 6e-7, "bending x at joint 3": 8e-7}
SIDES = [f"{shoulder}, {elbow}" for shoulder in ("front", "back") for elbow in ("elbow up", "elbow down")]
PULLEYS = ((3.4, -2.2, 1.6), (2.6, 2.4, 3.2))  # m in {M}
LOAD_POINT, GAUGE_POINT = np.array([60.0, 100.0, 420.0]), np.array([-50.0, 120.0, 380.0])  # mm in the flange
OFF_LOAD, OFF_GAUGE = np.array([90.0, -110.0, 49.0]), np.array([-40.0, 50.0, 48.0])  # mm: 150 and 80 away from them
BENDS = {"bending x after joint 2": 5e-7, "bending y after joint 2": 2.5e-7}
WORDS = """Synthetic load tests of the robot slavkovic_5r: no measurement of a real robot is in this file.
Truth: joint compliances of the paper's Table 3, 9.03 11.17 14.74 27.65 97.58 x 1e-7 rad/(N m)."""

CABLE_WORDS = """provenance: synthetic
frame: flange
angles: kuka
Synthetic cable tests of the robot kuka_kr270: no measurement of a real robot is in this file.
Truth: the preset's published stiffnesses, 3.8 6.6 3.9 0.56 0.66 0.47 MN m/rad; besides them {bends} rad/(N m).
Truth: the cable pulls at (60, 100, 420) mm of the flange, the gauges touch it at (-50, 120, 380) mm.
Stated below are points 150 mm and 80 mm off these, as happens; pulleys at (3400, -2200, 1600) and (2600, 2400, 3200) mm.
Poses: the flange in {{M}}, A, B, C as on a KUKA. Gauge 1 reads along the cable, gauge 2 across it.
Noise: normal, {noise:g} um a reading, seed {seed}."""


def at(robot: rm.Robot, x_M: np.ndarray) -> np.ndarray:
    """Joint coordinates of world poses, all of which must be reached."""
    solved = rm.inverse_kinematics(robot, rm.pose_from_world(x_M))
    assert solved.reached.all()
    return solved.theta


def grid(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """World coordinates of a grid with the tool vertical, X running fastest."""
    Z, Y, X = np.meshgrid(z, y, x, indexing="ij")
    return np.stack([X, Y, Z, 0 * X, 0 * X], axis=-1).reshape(-1, 5)


def remarks(what: str, springs: dict[str, float], noise: float, seed: int) -> str:
    """The head of a file: what it is, what is in it, how to make it again."""
    listed = ", ".join(f"{label} {value:.1e}" for label, value in springs.items())
    said = f"Springs besides the joints (m/N, rad/(N m)): {listed or 'none'}."
    spread = f"Noise: normal, {from_si(noise, 'um'):g} um a reading, seed {seed}; load {LOAD:g} N."
    return f"{WORDS}\n{said}\n{spread}\n{what}"


def world_poses(robot: rm.Robot, tests: LoadTests) -> LoadTests:
    """The same tests with their poses as X, Y, Z, A, B."""
    x_M = world_from_pose(tool_pose(robot, tests.theta))
    return LoadTests(tests.wrench, tests.displacement, x_M=x_M, provenance=tests.provenance)


def compliances_csv(tests: LoadTests, head: str) -> str:
    """Eq. (17): one row a pose, Cij = delta_i / F_j, from tests in the order X, Y, Z at each pose."""
    C = np.swapaxes(tests.displacement[:, :3].reshape(-1, 3, 3) / LOAD, 1, 2)
    where = tests.x_M[::3]
    names = [f"C{r}{c}_um_N" for r in "xyz" for c in "xyz"]
    lines = [f"# {line}" for line in ("provenance: synthetic", *head.splitlines())]
    lines += [",".join(["X_mm,Y_mm,Z_mm,A_deg,B_deg,load_N", *names])]
    for x, matrix in zip(where, C, strict=True):
        pose = [*(f"{round(v)}" for v in from_si(x[:3], "mm")), "0", "0", f"{LOAD:g}"]
        lines.append(",".join([*pose, *(f"{v:.4f}" for v in from_si(matrix.ravel(), "um/N"))]))
    return "\n".join(lines) + "\n"


def joint_by_joint_csv(robot: rm.Robot, seed: int) -> str:
    """The paper's first method: each joint loaded alone, at three torques and both signs."""
    rng = np.random.default_rng(seed)
    truth = robot.with_compliance_set("table_2").C_theta
    lines = [
        "# provenance: synthetic",
        "# Synthetic tests of single joints of the robot slavkovic_5r, the joints below blocked.",
        "# Truth: joint compliances of the paper's Table 2, 7.14 10.12 12.30 17.32 91.35 x 1e-7 rad/(N m).",
        f"# Noise: normal, 2 urad a reading, seed {seed}.",
        "joint,torque_Nm,angle_urad",
    ]
    for joint, c in enumerate(truth, 1):
        for torque in (-300, -200, -100, 100, 200, 300):
            angle = c * torque * (0.25 if joint == 5 else 1.0) + 2e-6 * rng.standard_normal()
            lines.append(f"{joint},{torque * (0.25 if joint == 5 else 1.0):g},{from_si(angle, 'urad'):.2f}")
    return "\n".join(lines) + "\n"


def postures(robot: rm.Robot, count: int, rng: np.random.Generator) -> np.ndarray:
    """Configurations in front of the foot whose poses leave shoulder and elbow no other way to stand."""
    kept: list[np.ndarray] = []
    while len(kept) < count:
        theta = rng.uniform(*(0.6 * robot.limits.T))
        theta[0] = rng.uniform(-0.9, 0.9)
        T = tool_pose(robot, theta)
        far = np.hypot(*T[:2, 3])
        if 1.2 < far < 2.6 and 0.4 < T[2, 3] < 2.4:
            found = [rm.inverse_kinematics(robot, T, spin="fixed", branch=side) for side in SIDES]
            kept += [theta] if sum(bool(each.reached) for each in found) == 1 else []
    return np.array(kept)


def cable_csv(seed: int = 44, count: int = 64, noise: float = 4e-6) -> str:
    """A cable over one of two pulleys at poses of a six-axis arm's flange, read by two dial gauges; points misstated."""
    robot, rng = rm.load_robot("kuka_kr270"), np.random.default_rng(seed)
    theta = postures(robot, count, rng)
    T = tool_pose(robot, theta) @ np.linalg.inv(robot.T_tool)
    R, hook = T[:, :3, :3], (T[:, :3, :3] @ to_si(LOAD_POINT, "mm")) + T[:, :3, 3]
    way = np.array(PULLEYS)[np.arange(count) % 2] - hook
    pull, u = rng.uniform(300.0, 700.0, count), way / np.linalg.norm(way, axis=1, keepdims=True)
    points = [(to_si(p, "mm") - robot.T_tool[:3, 3]) @ robot.T_tool[:3, :3] for p in (LOAD_POINT, GAUGE_POINT)]
    model = Model("joints+bending", (2,), turned=True)
    tests = LoadTests(pull[:, None] * u, u, theta=theta, force_point=points[0], measuring_point=points[1])
    moved = model.terms(robot, tests)[:, :3, 0] @ true_parameters(robot, model, BENDS)
    across = np.cross(u, rng.standard_normal((count, 3)))
    along = [u, across / np.linalg.norm(across, axis=1, keepdims=True)]
    angles = np.arctan2(R[:, 1, 0], R[:, 0, 0]), np.arcsin(-R[:, 2, 0]), np.arctan2(R[:, 2, 1], R[:, 2, 2])
    names = [f"{name}_mm" for name in "XYZ"] + ["A_deg", "B_deg", "C_deg", "load_N"]
    names += [f"cable_{a}" for a in "xyz"]
    names += [f"{name}_point_{a}_mm" for name in ("load", "gauge") for a in "xyz"]
    names += [f"gauge{k}_{a}" for k in (1, 2) for a in "xyz"] + ["reading1_mm", "reading2_mm"]
    stated = np.concatenate([LOAD_POINT + OFF_LOAD, GAUGE_POINT + OFF_GAUGE])
    listed = ", ".join(f"{label} {value:.1e}" for label, value in BENDS.items())
    lines = [f"# {line}" for line in CABLE_WORDS.format(bends=listed, noise=from_si(noise, "um"), seed=seed).splitlines()]
    lines.append(",".join(names))
    for k in range(count):
        read = [u_k @ moved[k] + noise * rng.standard_normal() for u_k in (along[0][k], along[1][k])]
        cells = [f"{v:.4f}" for v in from_si(T[k, :3, 3], "mm")] + [f"{from_si(a[k], 'deg'):.6f}" for a in angles]
        cells += [f"{pull[k]:.1f}"] + [f"{v:.6f}" for v in u[k]] + [f"{v:.0f}" for v in stated]
        cells += [f"{v:.6f}" for v in (*along[0][k], *along[1][k])] + [f"{v:.4f}" for v in from_si(np.array(read), "mm")]
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write every file of this folder."""
    robot = rm.load_robot("slavkovic_5r").with_compliance_set("table_3")
    with_tool, bent = Model("joints+tool"), Model("joints+bending+tool")
    nine = at(robot, grid(np.array([-0.6, 0.0, 0.6]), np.array([-1.6, -1.3, -1.0]), np.array([0.0])))
    options = {"noise": NOISE, "seed": 2013, "model": with_tool, "extra": STIFF_TOOL}
    tests = simulated_tests(robot, *three_directions(nine, LOAD), **options)
    what = "Nine poses at Z_M = 0, tool vertical, loaded along X, Y and Z: 81 equations, as in Sec. 5.1."
    head = remarks(what, STIFF_TOOL, NOISE, 2013)
    (HERE / "nine_points.csv").write_text(load_tests_to_csv(tests, head), encoding="utf-8")
    text = compliances_csv(world_poses(robot, tests), head + "\nThe same readings as compliances, eq. (17).")
    (HERE / "nine_points_compliances.csv").write_text(text, encoding="utf-8")

    x_M = grid(np.arange(-600, 601, 150) / 1e3, np.arange(-1600, -999, 150) / 1e3, np.arange(-400, 101, 100) / 1e3)
    tests = simulated_tests(robot, *three_directions(at(robot, x_M), LOAD), **{**options, "seed": 45})
    what = "The paper's grid: 45 points (9 x 5 at 150 mm) at 6 levels of Z_M, tool vertical, loaded along X, Y and Z."
    head = remarks(what, STIFF_TOOL, NOISE, 45)
    (HERE / "grid_45x6.csv").write_text(load_tests_to_csv(world_poses(robot, tests), head), encoding="utf-8")

    lower, upper = np.array([-0.6, -1.6, -0.4]), np.array([0.6, -1.0, 0.1])
    some = box_candidates(robot, lower, upper, poses=24, tilt=np.pi / 4, load=LOAD, seed=6)
    extra = {"noise": NOISE, "seed": 24, "model": bent, "extra": SOFT_TOOL}
    tests = simulated_tests(robot, some.theta, some.F, **extra)
    what = "Poses spread over the box with the tool tilted by up to 45 deg; links and tool give here as well as joints."
    head = remarks(what, SOFT_TOOL, NOISE, 24)
    (HERE / "tilted_bending_tool.csv").write_text(load_tests_to_csv(tests, head), encoding="utf-8")
    (HERE / "cable_six_axis.csv").write_text(cable_csv(), encoding="utf-8")
    (HERE / "one_joint_at_a_time.csv").write_text(joint_by_joint_csv(robot, 5), encoding="utf-8")


if __name__ == "__main__":
    main()
