"""The machined part as STL, and what was cut away"""

from pathlib import Path

import numpy as np

import robomill as rm

path = rm.Toolpath.from_points(p_mm=[[-20, 0, -2], [20, 0, -2], [20, 20, -2]], feed_mm_min=1200, spindle_1_min=9000)
setup = rm.SimulationSetup(
    name="corner",
    robot=rm.load_robot("slavkovic_5r"),
    source=path,
    part_zero_mm=[0, -1300, 0],
    cutter=rm.Cutter("flat", diameter_mm=6, flutes=2),
    force=rm.PathForce(feed_normal=120.0),  # N
    stock=rm.Stock(lower_mm=[-35, -15, -8], upper_mm=[35, 35, 0]),
    tolerance_mm=0.3,
)
result = rm.simulate(setup)
file = rm.write_stl("corner.stl", result.machined, max_faces=100_000)
count = int(np.fromfile(file, dtype="<u4", count=21)[20])  # behind the header of 80 bytes
print(f"{Path(file).name}: {count} triangles, {Path(file).stat().st_size / 1e6:.2f} MB, in mm")

part = result.machined
print(f"cut away: {part.removed_volume * 1e9:.1f} mm3")
print(f"the deepest place lies {-part.z.min() * 1e3:.4f} mm below the top")
error = result.error.error
print(f"surface against the ideal one: {np.nanmin(error) * 1e3:.3f} to {np.nanmax(error) * 1e3:.3f} mm")
