"""How far a part may be off instead, at the ends of what is assumed of its force."""

import numpy as np

from robomill.compliance.deflection import displacement
from robomill.cutting.force import force_at_ends
from robomill.simulation.judging.gauge import Gauge, Readings
from robomill.simulation.judging.seen import Run


def far_share(result: Run, gauge: Gauge, tolerances: tuple[float, float, float]) -> float:
    """The largest share of a tolerance that is used at the ends of the assumed shares of the force, NaN where nothing
    is assumed; ``tolerances`` (m): wall, floor and along the feed, infinite where that is not judged.

    Every reading moves as the tip that made it does; the cut is not solved anew.
    """
    forces = force_at_ends(result.setup.force, result.conditions, result.R_MF)
    if not forces or not result.judged.any():
        return float("nan")
    far = 0.0
    for F in forces:
        moved = np.einsum("mij,mi->mj", result.R_MF, displacement(result.C, F - result.F))
        readings = ((gauge.walls, 1, tolerances[0]), (gauge.floors, 2, tolerances[1]), (gauge.ends, 0, tolerances[2]))
        far = max(far, *(_largest(found, moved[:, axis]) / allowed for found, axis, allowed in readings))
        along = result.delta_in_cut + moved
        far = max(far, float(np.abs(along[result.judged, 0]).max()) / tolerances[2])
        if not any(len(found.error) for found, _, _ in readings[:2]):  # the tip's own deviation decides
            far = max(far, float(np.linalg.norm(along[result.judged], axis=1).max()) / tolerances[0])
    return far


def _largest(found: Readings, moved: np.ndarray) -> float:
    """The largest size of readings, m, whose samples are moved by so much, (m,) m, along them."""
    return float(np.abs(found.error + np.nan_to_num(moved[found.sample])).max(initial=0.0))
