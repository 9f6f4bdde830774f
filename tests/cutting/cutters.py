"""The cutters, the slot and the material that tests of the milling force share."""

import math

from robomill.cutting.conditions import CutConditions
from robomill.cutting.tool import Cutter
from robomill.io.materials import load_material

MILL = Cutter("flat", 8e-3, flutes=3)
#: The paper's slot: 12 000 1/min, 30 mm/s, 2 mm deep.
SLOT = CutConditions.steady(0.03, 200.0, 2e-3)
CHIP = 0.05e-3
REF190 = load_material("al7075_t6_carbide_ref190")
CUTTERS = [
    MILL,
    Cutter("ball", 8e-3),
    Cutter("bull", 8e-3, corner_radius=1e-3, flutes=4),
    Cutter("chamfer", 8e-3, tip_angle=math.radians(80), tip_diameter=1e-3),
]
