"""A table of cutter diameters: deviation and verdict"""

import numpy as np
import pandas as pd

import robomill as rm

slot = rm.Toolpath.from_points(p_mm=[[-40, 0, -1.5], [40, 0, -1.5]], feed_mm_min=1500, spindle_1_min=10000)
base = rm.SimulationSetup(
    name="slot",
    robot=rm.load_robot("slavkovic_5r"),
    source=slot,
    part_zero_mm=[0, -1300, 0],
    cutter=rm.Cutter("flat", diameter_mm=8, flutes=2),
    force=rm.PathForce(),  # takes its turn below
    stock=rm.Stock(lower_mm=[-60, -30, -10], upper_mm=[60, 30, 0]),
    tolerance_mm=0.2,
)
rows = []
for diameter_mm in (4, 6, 8, 10, 12):
    cutter = rm.Cutter("flat", diameter_mm=diameter_mm, flutes=2)
    force = rm.process_force("al7075_t6_carbide_ref190", cutter)
    bending = rm.ToolBending(diameter_mm=diameter_mm, stick_out_mm=35)
    run = rm.simulate(base.replace(cutter=cutter, force=force, springs=(bending,)))
    rows.append(
        {
            "diameter_mm": diameter_mm,
            "F_N": np.linalg.norm(run.F[run.worst]),
            "deviation_mm": run.max_deviation * 1e3,
            "of_the_cutter_mm": np.linalg.norm(run.delta_spring[run.worst, 0]) * 1e3,
            "tolerance_used": run.verdict.share,
            "verdict": run.verdict.level,
        }
    )
print(pd.DataFrame(rows).round(3).to_string(index=False))
