"""A robot of your own, and what each joint gives at a pose"""

import numpy as np

import robomill as rm

robot = rm.Robot.from_dh(
    name="cell_3",
    title="Arm of cell 3",
    # one entry a joint, from the base to the flange
    d_mm=[680, 0, 0, 1020, 0, 200],
    a_mm=[320, 1100, 200, 0, 0, 0],
    alpha_deg=[-90, 0, -90, 90, -90, 0],
    theta_offset_deg=[0, -90, 0, 0, 0, 180],
    limits_deg=[(-170, 170), (-60, 140), (-180, 70), (-300, 300), (-130, 130), (-360, 360)],
    k_theta_kNm_per_rad=[2500, 3200, 2100, 450, 400, 300],
    # 250 mm of spindle and cutter along axis 6, in m; z_T points back to the flange, out of the part
    T_tool=np.array([[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0.25], [0, 0, 0, 1]]),
)

theta = np.radians([20.0, 30.0, 10.0, 0.0, 50.0, 0.0])
tip = rm.tool_pose(robot, theta)[:3, 3]
C = rm.cartesian_compliance(robot, theta)  # (3, 3), m/N
shares = rm.at_pose(robot, theta).C_joint  # (6, 3, 3), m/N, one for each joint; they add up to C

print(f"tip: X {tip[0] * 1e3:.1f}, Y {tip[1] * 1e3:.1f}, Z {tip[2] * 1e3:.1f} mm")
print("compliance of the tip, um/N:")
print((C * 1e6).round(4) + 0.0)
delta = C @ [0.0, 150.0, 0.0]  # N
print(f"150 N in Y move the tip by {np.round(delta * 1e6, 1)} um")
ik = rm.inverse_kinematics(robot, rm.pose_from_world([1.5, 0.0, 0.7, 0.0, 0.0]))
print("upright at X 1500, Z 700 mm:", np.degrees(ik.theta).round(2) + 0.0, "degrees" if ik.reached else ik.reason())
for j, share in enumerate(shares, 1):
    print(f"joint {j} gives {share[1, 1] / C[1, 1]:6.1%} of C_yy")
