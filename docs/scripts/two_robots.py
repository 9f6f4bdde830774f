"""Two robots on one path, and which joint gives most"""

import numpy as np

import robomill as rm

path = rm.Toolpath.from_points(p_mm=[[-60, 0, -2], [60, 0, -2], [60, 40, -2]], feed_mm_min=1800, spindle_1_min=12000)
setup = rm.SimulationSetup(
    name="two legs",
    robot=rm.load_robot("kuka_kr270"),
    source=path,
    part_zero_mm=[1900, 200, 700],
    cutter=rm.Cutter("flat", diameter_mm=8, flutes=3),
    force=rm.PathForce(feed_normal=100.0, axial=-30.0),  # N
    tolerance_mm=0.2,
)
for name in ("kuka_kr270", "kuka_kr500"):
    run = rm.simulate(setup.replace(robot=rm.load_robot(name)))
    i = run.worst
    # each joint's share along the deviation at the worst place; the shares add up to 1
    along = run.delta_joint[i] @ run.delta[i] / run.deviation[i] ** 2
    print(f"{name}: {run.max_deviation * 1e3:.4f} mm, {run.path.s[i] * 1e3:.1f} mm from the start, {run.verdict.level}")
    print("   shares of joints 1 to 6:", " ".join(f"{share + 0.0:.1%}" for share in along.round(3)))
    print(f"   most by joint {np.argmax(along) + 1}")
