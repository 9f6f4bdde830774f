"""A robot from a URDF with two end links and a joint that slides"""

from pathlib import Path

import numpy as np

import robomill as rm

URDF = """<robot name="gantry_arm">
  <link name="floor"/> <link name="column"/> <link name="boom"/> <link name="fore"/>
  <link name="probe"/> <link name="cutter"/>
  <joint name="swing" type="revolute">
    <parent link="floor"/> <child link="column"/> <origin xyz="0 0 0.4"/> <axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="100" velocity="1"/>
  </joint>
  <joint name="lift" type="revolute">
    <parent link="column"/> <child link="boom"/> <origin xyz="0.2 0 0.1"/> <axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="1.5" effort="100" velocity="1"/>
  </joint>
  <joint name="reach" type="prismatic">
    <parent link="boom"/> <child link="fore"/> <origin xyz="0.6 0 0" rpy="0 0.5 0"/> <axis xyz="1 0 0"/>
    <limit lower="0" upper="0.5" effort="100" velocity="1"/>
  </joint>
  <joint name="probe_mount" type="fixed">
    <parent link="fore"/> <child link="probe"/> <origin xyz="0.1 0 0.05"/>
  </joint>
  <joint name="spindle" type="fixed">
    <parent link="fore"/> <child link="cutter"/> <origin xyz="0.1 0 -0.2"/>
  </joint>
</robot>"""

Path("gantry_arm.urdf").write_text(URDF)
robot = rm.load_robot("gantry_arm.urdf", tip="cutter")
robot = robot.replace(C_theta=[4e-7, 6e-7, 2e-8])  # rad/(N m), rad/(N m), and m/N for the joint that slides

theta = np.array([np.radians(30.0), np.radians(-20.0), 0.25])  # rad, rad, m
T = rm.tool_pose(robot, theta)
print(f"{robot.title}: {robot.n} joints")
print("tip in mm:", (T[:3, 3] * 1e3).round(3))
print("z_T:", T[:3, 2].round(4))
print("C in um/N:")
print((rm.cartesian_compliance(robot, theta) * 1e6).round(4))
