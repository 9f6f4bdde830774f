"""The softest place of a plane, by DataFrame and by xarray"""

import numpy as np

import robomill as rm

robot = rm.load_robot("slavkovic_5r")
grid = rm.plane_grid("z", 0.1, (-1.2, -2.2, 0.0), (1.2, -0.8, 0.0), 0.1)  # the plane Z = 100 mm, every 100 mm
cells = rm.compliance_map(robot, grid)
field = cells.field("C_yy")

table = field.to_dataframe()  # in the units that the columns name
reached = table.dropna()
worst = reached.nlargest(1, "C_yy_um/N").iloc[0]
print(f"{len(reached)} of {len(table)} places are reached")
print(f"worst: {worst['C_yy_um/N']:.4f} um/N at X {worst['X_mm']:.0f}, Y {worst['Y_mm']:.0f} mm")

array = field.to_xarray()  # SI
place = array.argmax(...)  # NaN is passed over
peak = array.isel(place)
print(f"the same: {float(peak) * 1e6:.4f} um/N at x {float(peak.x):.1f}, y {float(peak.y):.1f} m")
print(f"under 100 N there: {float(peak) * 100.0 * 1e3:.3f} mm")
print(f"mean of the rows in um/N: {(array.mean('x').values[:4, 0] * 1e6).round(3)}")
assert np.isclose(float(peak) * 1e6, worst["C_yy_um/N"])
