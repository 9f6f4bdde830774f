"""Width, depth and offsets of a slot"""

import robomill as rm

slot = rm.Toolpath.from_points(p_mm=[[-50, 0, -2], [50, 0, -2], [50, 30, -2]], feed_mm_min=1800, spindle_1_min=12000)
setup = rm.SimulationSetup(
    name="two legs",
    robot=rm.load_robot("slavkovic_5r"),
    source=slot,
    part_zero_mm=[0, -1300, 0],
    cutter=rm.Cutter("flat", diameter_mm=8, flutes=3),
    force=rm.PathForce(feed_normal=100.0, axial=-20.0),  # N
    stock=rm.Stock(lower_mm=[-60, -20, -10], upper_mm=[70, 50, 0]),
    tolerance_mm=0.3,
)
result = rm.simulate(setup)
for section in result.grooves([0.025, 0.050, 0.075, 0.115]):  # m of path cut
    if section.kind != "groove":
        print(f"{section.station * 1e3:6.1f} mm: {section.kind}, {section.note}")
        continue
    print(
        f"{section.station * 1e3:6.1f} mm: width {section.width * 1e3:.3f}, depth {section.depth * 1e3:.3f}, "
        f"to the left {section.centre_offset * 1e3:+.4f}, floor {section.floor_error * 1e3:+.4f} mm"
    )
table = result.sections.to_dataframe()
columns = ["width_mm", "depth_mm", "centre_offset_mm", "floor_error_mm"]
print(table[columns].agg(["min", "max"]).round(4).T)
