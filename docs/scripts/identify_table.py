"""Joint compliances from a DataFrame of load tests, with intervals"""

import numpy as np
import pandas as pd

import robomill as rm

robot = rm.load_robot("slavkovic_5r")
truth = np.array([8.0, 11.0, 15.0, 25.0, 95.0]) * 1e-7  # rad/(N m), stands for the real arm
noise = np.random.default_rng(26)
rows: list[dict[str, float]] = []
places = [(-400, -1500, 0, 0), (0, -1300, 20, 0), (400, -1100, 0, 25), (300, -1500, -20, 10), (-300, -1200, 10, -25)]
for X, Y, A, B in places:
    pose = rm.pose_from_world([X / 1e3, Y / 1e3, 0.1, np.radians(A), np.radians(B)])
    C = rm.cartesian_compliance(robot.replace(C_theta=truth), rm.inverse_kinematics(robot, pose).theta)
    for F in 200.0 * np.eye(3):
        d_mm = C @ F * 1e3 + noise.normal(0.0, 0.003, 3)  # a dial gauge with 3 um of noise
        row: dict[str, float] = {"X_mm": X, "Y_mm": Y, "Z_mm": 100, "A_deg": A, "B_deg": B}
        row |= dict(zip(("Fx_N", "Fy_N", "Fz_N"), F)) | dict(zip(("dx_mm", "dy_mm", "dz_mm"), d_mm))
        rows.append(row)
tests = pd.DataFrame(rows)

found = rm.identify(robot, tests)
print("joint  found  +-      95 % interval    true   in 1e-7 rad/(N m)")
table = np.column_stack([found.C_theta, found.stderr, found.ci95, truth]) * 1e7
for j, (value, error, low, high, true) in enumerate(table, 1):
    print(f"{j:5d} {value:6.2f}  {error:.2f}  {low:7.2f} .. {high:6.2f}  {true:6.2f}")
print(f"error at poses left out: {found.cv_relative_error:.2%}")
