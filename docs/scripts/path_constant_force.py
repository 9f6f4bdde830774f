"""An ellipse from an array of points, under one constant force"""

import numpy as np

import robomill as rm

angle = np.linspace(0.0, 2.0 * np.pi, 121)
points = np.stack([40.0 * np.cos(angle), 25.0 * np.sin(angle), np.full_like(angle, -2.0)], axis=1)  # an ellipse, mm
path = rm.Toolpath.from_points(p_mm=points, feed_mm_min=1200, spindle_1_min=9000)

setup = rm.SimulationSetup(
    name="ellipse",
    robot=rm.load_robot("slavkovic_5r"),
    source=path,
    part_zero_mm=[150, -1350, 0],
    cutter=rm.Cutter("flat", diameter_mm=6, flutes=2),
    force=rm.ConstantForce([60.0, -80.0, -20.0]),  # N on the tool, in the robot's base frame
    tolerance_mm=0.25,
)
result = rm.simulate(setup)
i = result.worst
print(f"path: {result.path.s[-1] * 1e3:.2f} mm, {len(result.path)} samples, all reached: {bool(result.reached.all())}")
print(f"largest deviation: {result.max_deviation * 1e3:.4f} mm, {result.path.s[i] * 1e3:.1f} mm from the start")
print(f"there: {(result.delta[i] * 1e3).round(4)} mm, at {(result.path.p[i] * 1e3).round(2)} mm of the part")
print(f"root mean square: {result.rms_deviation * 1e3:.4f} mm")
print(result.verdict.level, "-", result.verdict.sentence)
