"""Every table and figure of the paper: reproduced, or the gap and its reason. The numbers are computed, not typed.

What the paper leaves out (three lengths, limits, raw measurements, the alloy) cannot be reproduced, only stated; such a
row says so and is never tuned to fit. ``report.paper`` holds what the paper says; here is one check for each statement.
"""

from collections.abc import Callable

import numpy as np

from robomill.arrays import FloatArray
from robomill.kinematics.forward import tool_pose
from robomill.kinematics.jacobian import geometric_jacobian
from robomill.paper import BOX_SIZE
from robomill.progress import checkpoint
from robomill.report import reproduction_experiments as experiments
from robomill.report.paper import STATEMENTS, TABLE_1, TABLES
from robomill.report.reproduction_row import STEP, Evidence, Found, Row
from robomill.units import format_many, format_percent, format_si, format_significant, format_value, from_si
from robomill.workspace.fields import compliance_map
from robomill.workspace.grid import PAPER_BOX, box_grid
from robomill.workspace.lines import border_and_middle_lines
from robomill.workspace.reach import ReachBox


def reproduction(evidence: Evidence) -> list[Row]:
    """All rows, in the paper's order."""
    rows = []
    for k, statement in enumerate(STATEMENTS):
        checkpoint(k / len(STATEMENTS), "Statements of the paper")
        found = CHECKS[statement.code](evidence)
        reason = statement.reading.format(**found.numbers)
        rows.append(Row(statement, found.text, found.holds, reason, found.numbers))
    return rows


def _table_1(evidence: Evidence) -> Found:
    robot = evidence.robot
    shown = tuple(np.round(from_si(values, "deg"), 9) for values in (robot.alpha, robot.theta_offset))
    holds = all(np.allclose(s, t) for s, t in zip(shown, TABLE_1[:2])) and np.allclose(robot.sign, TABLE_1[2])
    angles = ", ".join(format_significant(v) for v in shown[0])
    return Found(
        f"α = {angles}°; joint 4 counted backwards; all entries equal" if holds else "entries differ",
        holds,
    )


def _lengths(evidence: Evidence) -> Found:
    robot = evidence.robot
    a_2, d_4, a_5 = robot.a[1], robot.d[3], robot.a[4]
    tip = tool_pose(robot, np.zeros(5))[:3, 3]
    holds = bool(np.allclose(tip, [0.0, -d_4, a_2 - a_5], atol=1e-12))
    return Found(
        f"{_mm(a_2)}, {_mm(d_4)}, {_mm(a_5)}; at θ = 0 the tip stands at (0, {_mm(tip[1])}, {_mm(tip[2])})",
        holds,
        {"a_2": a_2, "d_4": d_4, "a_5": a_5, "x": tip[0], "y": tip[1], "z": tip[2]},
    )


def _jacobian(evidence: Evidence) -> Found:
    robot = evidence.robot
    theta = np.random.default_rng(5).uniform(0.8 * robot.limits[:, 0], 0.8 * robot.limits[:, 1], (40, 5))
    h = 1e-6
    step = h * np.eye(5)
    ahead, behind = (tool_pose(robot, theta[:, None] + sign * step)[..., :3, 3] for sign in (1, -1))
    numeric = np.swapaxes((ahead - behind) / (2 * h), -1, -2)
    error = float(np.abs(numeric - geometric_jacobian(robot, theta)[:, :3]).max())
    return Found(
        f"J equals the numeric derivative of the pose to {format_significant(error, 1)} m/rad at 40 configurations",
        error < 1e-8,
    )


def _workspace(evidence: Evidence) -> Found:
    field = compliance_map(evidence.robot, box_grid(*PAPER_BOX, STEP))
    share, size = float(field.reached.mean()), ReachBox(*PAPER_BOX).size
    return Found(
        f"{format_percent(share)} of the {format_many(size, 'mm', 0, ' × ')} box is in reach",
        share == 1.0 and np.allclose(size, BOX_SIZE),
        {"share": share, **dict(zip("xyz", size))},
    )


def _determinant(evidence: Evidence) -> Found:
    field = compliance_map(evidence.robot, box_grid(*PAPER_BOX, 0.05))
    det = field.det_J
    low, high = (np.abs(det[:, :, k]) for k in (0, -1))
    same = bool((np.sign(det) == np.sign(det.flat[0])).all())
    return Found(
        f"|det J| {_span(low)} m³ at −400, {_span(high)} at 100 mm; {'never' if same else 'somewhere'} zero in the box",
        same and bool(field.reached.all()),
        {"low_min": low.min(), "low_max": low.max(), "high_min": high.min(), "high_max": high.max()},
    )


def _table_2(evidence: Evidence) -> Found:
    C = evidence.robot.compliance_sets["table_2"]
    shown = from_si(C, "1e-7 rad/(N m)")
    worst = float(np.abs(evidence.single.C_theta / C - 1.0).max())
    return Found(
        f"{_joints(shown)}; loading one joint at a time gives them back to {format_percent(worst, 1)}",
        bool(np.allclose(shown, TABLES["table_2"])) and worst < 0.02,
        {"worst": worst},
    )


def _figure_5(evidence: Evidence) -> Found:
    plane = evidence.plane
    x, values = plane.grid.x, {c: plane.values(f"C_{c}")[:, :, 0] for c in ("xx", "yy", "zz")}
    right = x >= -1e-9
    falls = all(
        (np.diff(values[c], axis=1) < 0).all() and (np.diff(values[c][right], axis=0) > 0).all() for c in ("xx", "zz")
    )
    narrows = bool((np.diff(values["yy"][right], axis=0) < 0).all())
    grows = (np.diff(values["yy"], axis=1) > 0).all(axis=1)
    inner = float(np.abs(x[~grows]).min()) if not grows.all() else np.inf  # there C_yy no longer grows with Y
    reach = float(np.abs(x[np.abs(x) < inner]).max(initial=0.0))
    ranges = ", ".join(f"C_{c} {_span(from_si(v, 'um/N'))}" for c, v in values.items())
    if falls and narrows and grows.all():
        words = "all six trends hold"
    elif falls and narrows:
        words = f"five of six trends hold all over; C_yy grows with Y for |X| up to {_mm(reach)} only"
    else:
        words = "a trend fails"
    return Found(f"{ranges} µm/N; {words}", falls and narrows and reach > 0.0, {"reach": float(from_si(reach, "mm"))})


def _figure_6(evidence: Evidence) -> Found:
    plane = evidence.plane
    shares = plane.shares.mean(axis=(0, 1, 2))
    part = [float(shares[[0, 2, 4], k].sum() / shares[:, k].sum()) for k in (0, 1)]
    others = float(np.abs(plane.shares[..., [0, 3, 4], 2]).max() / plane.total[..., 2].max())
    return Found(
        f"joints 1, 3, 5 make {format_percent(part[0])} of C_xx and {format_percent(part[1])} of C_yy; others in C_zz: "
        f"{_nothing(others)}",
        min(part) >= 0.9 and others < 1e-12,
        {"xx": part[0], "yy": part[1]},
    )


def _figure_7(evidence: Evidence) -> Found:
    plane = evidence.plane
    sizes = np.abs(plane.shares).mean(axis=(0, 1, 2))
    part = float(sizes[[0, 2, 4], 3].sum() / sizes[:, 3].sum())
    rest = float(sizes[[0, 1, 3, 4]][:, [4, 5]].max() / sizes[2, [4, 5]].min())
    return Found(
        f"joints 1, 3, 5 make {format_percent(part)} of |C_xy|; others in C_xz, C_zy: {_nothing(rest)}",
        part >= 0.9 and rest < 1e-12,
    )


def _figure_8(evidence: Evidence) -> Found:
    lines = border_and_middle_lines(evidence.robot, points=31)
    most = [max(float(np.abs(line.along_normal().sum(axis=1)).max()) for line in lines[i : i + 3]) for i in (0, 3)]
    sums = max(float(np.abs(line.delta_joint.sum(axis=1) - line.delta).max()) for line in lines)
    return Found(
        f"largest {_mm(most[0], 3)} along X and {_mm(most[1], 3)} along Y; joints add up to the total",
        all(line.reached.all() for line in lines) and sums < 1e-15,
        {"along_x": most[0], "along_y": most[1]},
    )


def _photographs(_: Evidence) -> Found:
    return Found(
        "the page Identification plans such tests",
        True,
    )


def _nothing(share: float) -> str:
    return "nothing" if share < 1e-12 else f"{format_significant(share, 1)} of it"


def _span(values: FloatArray) -> str:
    return format_many((np.nanmin(values), np.nanmax(values)), "1", 2, " to ")


def _mm(value: float, digits: int = 0) -> str:
    return format_si(value, "mm", digits)


def _joints(values: FloatArray) -> str:
    return ", ".join(format_value(float(v), "1", 2) for v in values) + " × 10⁻⁷ rad/(N m)"


# One check for each statement, by its code.
CHECKS: dict[str, Callable[[Evidence], Found]] = {
    "table_1": _table_1,
    "lengths": _lengths,
    "jacobian": _jacobian,
    "workspace": _workspace,
    "determinant": _determinant,
    "table_2": _table_2,
    "figure_5": _figure_5,
    "figure_6": _figure_6,
    "figure_7": _figure_7,
    "figure_8": _figure_8,
    "photographs": _photographs,
    "measured_maps": experiments.measured_maps,
    "nine_points": experiments.nine_points,
    "table_3": experiments.table_3,
    "figure_13": experiments.figure_13,
    "force": experiments.force,
    "predicted": experiments.predicted,
    "from_map": experiments.from_map,
    "machined": experiments.machined,
}
