"""The paper's experiments (section 5), checked: identification and the milling test."""

import numpy as np

from robomill.cutting.conditions import CutConditions
from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.cutting.tool import Cutter
from robomill.paper import SLOT
from robomill.report.paper import EQUATIONS, TABLES
from robomill.report.reproduction_row import Evidence, Found
from robomill.simulation.result import SimulationResult
from robomill.simulation.stations import nearest_feed
from robomill.units import format_many, format_number, format_si, from_si
from robomill.workspace.fields import compliance_map


def measured_maps(_: Evidence) -> Found:
    """Fig. 11."""
    return Found("eq. (17) is in Identification; sample tests are synthetic and say so", True)


def nine_points(evidence: Evidence) -> Found:
    """Fig. 12: T1 to T9."""
    count = evidence.nine.equations
    return Found(f"{count} equations from nine poses, three loads each", count == EQUATIONS, {"equations": count})


def table_3(evidence: Evidence) -> Found:
    """Table 3, refitted from synthetic tests that hide it."""
    nine, truth = evidence.nine, evidence.robot.compliance_sets["table_3"]
    printed = np.allclose(from_si(truth, "1e-7 rad/(N m)"), TABLES["table_3"])
    inside = bool(((nine.ci95[:, 0] <= truth) & (truth <= nine.ci95[:, 1])).all())
    shown = ", ".join(format_number(v, 2) for v in from_si(nine.C_theta, "1e-7 rad/(N m)"))
    text = f"{shown}; the paper's values {'lie' if inside else 'do not lie'} in all intervals"
    return Found(text, inside and printed, {f"joint_{j}": C for j, C in enumerate(nine.C_theta, 1)})


def figure_13(evidence: Evidence) -> Found:
    """Fig. 13 and claim 6: maps from Table 3 are a little higher."""
    other = compliance_map(evidence.robot.with_compliance_set("table_3"), evidence.plane.grid)
    ratio = (other.total[..., :3] / evidence.plane.total[..., :3]).reshape(-1, 3)
    text = f"direct compliances {format_many((ratio.min(), ratio.max()), '1', 2, ' to ')} times those of Table 2"
    holds = bool((ratio > 1.0).all() and (ratio < 1.4).all())
    return Found(text, holds, {"low": ratio.min(), "high": ratio.max()})


def force(evidence: Evidence) -> Found:
    """Fig. 15: the static feed-normal force."""
    conditions = CutConditions.steady(SLOT.v_f, SLOT.n_s, SLOT.a_p, cutting=[False, True])
    cutter = Cutter("flat", SLOT.diameter, flutes=SLOT.flutes)
    rows = [m for m in evidence.materials if m.kind == "mechanistic"]
    sizes = np.array([MechanisticForce(cutter, m).components(conditions)[1, 1] for m in rows])
    used = float(np.nanmax(evidence.flute.force_size))
    text = (
        f"{format_si(used, 'N', 0)} is used as measured; {len(rows)} aluminium rows predict "
        f"{format_many((sizes.min(), sizes.max()), 'N', 0, ' to ')}"
    )
    holds = bool(sizes.min() < SLOT.force < sizes.max() and abs(used - SLOT.force) < 0.5)
    return Found(text, holds, {"used": used, "rows": len(rows), "low": sizes.min(), "high": sizes.max()})


def predicted(evidence: Evidence) -> Found:
    """Section 5.2: the prediction from Table 2."""
    aside, down = _offsets(evidence.flute)
    text = (
        f"{format_si(aside, 'mm', 4)} in Y; and {format_si(abs(down), 'mm', 3)} {'down' if down < 0 else 'up'}; "
        "the paper gives no number for that"
    )
    return Found(text, abs(aside - SLOT.from_table_2) < 0.005e-3, {"aside": aside, "up": down})


def from_map(evidence: Evidence) -> Found:
    """Section 5.2: what the paper reads off its measured map, and why Table 3 cannot give that."""
    aside, _ = _offsets(evidence.flute_3)
    softer = np.divide(TABLES["table_3"], TABLES["table_2"])
    low, high = (SLOT.from_table_2 * float(softer[i]) for i in (4, 2))  # joints 5 and 3
    numbers = {"soft_3": softer[2], "soft_5": softer[4], "low": from_si(low, "mm"), "high": from_si(high, "mm")}
    numbers["aside"] = aside
    return Found(f"{format_si(aside, 'mm', 4)} from Table 3", low <= aside <= high < SLOT.from_map, numbers)


def machined(evidence: Evidence) -> Found:
    """Fig. 16: the machined flute."""
    grooves = [result.groove(0.5 * float(result.path.s[-1])) for result in (evidence.flute, evidence.flute_3)]
    first, second = (abs(groove.centre_offset) for groove in grooves)
    text = (
        f"groove {format_si(first, 'mm', 2)} off with Table 2, {format_si(second, 'mm', 2)} with Table 3, "
        f"and {format_si(abs(grooves[0].floor_error), 'mm', 2)} too deep"
    )
    numbers = {
        "low": 100 * first / SLOT.measured,
        "high": 100 * second / SLOT.measured,
        "first": first,
        "second": second,
        "too_deep": -grooves[0].floor_error,
    }
    return Found(text, 0.22e-3 < first < second < SLOT.measured, numbers)


def _offsets(result: SimulationResult) -> tuple[float, float]:
    """Deviation in Y (size) and Z (signed) at mid-cut, m."""
    i = nearest_feed(result, 0.5 * float(result.path.s[-1]))
    return abs(float(result.delta[i, 1])), float(result.delta[i, 2])
