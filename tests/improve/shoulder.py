"""A cut whose deciding wall is made between two samples, for several tests."""

import robomill as rm


def shoulder() -> rm.SimulationSetup:
    """A shoulder along an edge, in steps so coarse that walls are made between two samples."""
    slot = rm.load_setup("paper_flute")
    path = rm.GCodeSource("S12000 M3\nG0 X-70 Y-32 Z5\nG0 Z-5\nG1 X70 F1500\nG0 Z20\nM2\n", "shoulder.nc")
    force = rm.process_force("al7075_t6_carbide_ref190", slot.cutter)
    return slot.replace(
        source=path,
        stock=rm.Stock(lower_mm=(-60, -30, -20), upper_mm=(60, 30, 0)),
        force=force,
        engagement=True,
        step_mm=2,
        cell_mm=0.2,
        tolerance_mm=0.042,
    )
