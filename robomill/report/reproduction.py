"""Every table and figure of the paper: reproduced, or the gap and its reason. The numbers are computed, not typed.

Source: Slavkovic et al., FME Transactions 41 (2013) 83-95. What the paper leaves out (three lengths, limits, raw
measurements, the alloy) cannot be reproduced, only stated; such a row says so and is never tuned to fit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray
from robomill.cutting.materials import Material
from robomill.identification.result import IdentificationResult
from robomill.kinematics.forward import tool_pose
from robomill.kinematics.jacobian import geometric_jacobian
from robomill.report import reproduction_tests
from robomill.report.reproduction_row import Row
from robomill.robot.model import Robot
from robomill.simulation.result import SimulationResult
from robomill.units import format_si, format_value, from_si
from robomill.workspace.fields import ComplianceField, compliance_field
from robomill.workspace.grid import PAPER_BOX, box_grid, plane_grid
from robomill.workspace.lines import border_and_middle_lines
from robomill.workspace.reach import Box

STEP = 0.1  # m: grid of the checks
TABLE_1 = ((90, 0, 90, -90, 0), (-90, 90, 0, 0, 180), (1, 1, 1, -1, 1))  # alpha deg, offset deg, sign
TABLES = {"table_2": (7.14, 10.12, 12.30, 17.32, 91.35), "table_3": (9.03, 11.17, 14.74, 27.65, 97.58)}


@dataclass(frozen=True, eq=False)
class Evidence:
    """What the rows are computed from: the paper's robot, its milling test with both tables, and identifications.

    nine: from the (synthetic) nine points; single: from the (synthetic) tests of one joint at a time.
    """

    robot: Robot
    flute: SimulationResult
    flute_3: SimulationResult
    nine: IdentificationResult
    single: IdentificationResult
    materials: Sequence[Material]


def reproduction(evidence: Evidence) -> list[Row]:
    """All rows, in the paper's order."""
    robot = evidence.robot.with_compliance_set("table_2")
    plane = compliance_field(robot, plane_grid("z", 0.0, *PAPER_BOX, STEP))
    makers: list[Callable[[], Row]] = [
        lambda: _table_1(robot),
        lambda: _lengths(robot),
        lambda: _jacobian(robot),
        lambda: _workspace(robot),
        lambda: _determinant(robot),
        lambda: _table_of(robot, "table_2", evidence.single),
        lambda: _figure_5(plane),
        lambda: _figure_6(plane),
        lambda: _figure_7(plane),
        lambda: _figure_8(robot),
        _photographs,
        lambda: reproduction_tests.measured_maps(),
        lambda: reproduction_tests.nine_points(evidence.nine),
        lambda: reproduction_tests.table_3(robot, evidence.nine),
        lambda: reproduction_tests.figure_13(robot, plane),
        lambda: reproduction_tests.force(evidence.flute, evidence.materials),
        lambda: reproduction_tests.predicted(evidence.flute),
        lambda: reproduction_tests.from_map(evidence.flute_3),
        lambda: reproduction_tests.machined(evidence.flute, evidence.flute_3),
    ]
    return [make() for make in makers]


def _table_1(robot: Robot) -> Row:
    shown = tuple(np.round(from_si(values, "deg"), 9) for values in (robot.alpha, robot.theta_offset))
    holds = all(np.allclose(s, t) for s, t in zip(shown, TABLE_1[:2])) and np.allclose(robot.sign, TABLE_1[2])
    angles = ", ".join(f"{v:g}" for v in shown[0]).replace("-", "−")
    return Row(
        "Table 1, eq. (4)",
        "D-H angles, offsets and signs of five links",
        f"α = {angles}°; joint 4 counted backwards; all entries equal" if holds else "entries differ",
        "reproduced",
        "Typed from the table.",
        holds,
    )


def _lengths(robot: Robot) -> Row:
    a_2, d_4, a_5 = robot.a[1], robot.d[3], robot.a[4]
    tip = tool_pose(robot, np.zeros(5))[:3, 3]
    holds = bool(np.allclose(tip, [0.0, -d_4, a_2 - a_5], atol=1e-12))
    return Row(
        "Table 1, a₂, d₄, a₅; Figs. 1, 2",
        "symbols without numbers",
        f"{_mm(a_2)}, {_mm(d_4)}, {_mm(a_5)}; at θ = 0 the tip stands at (0, {_mm(tip[1])}, {_mm(tip[2])})",
        "gap",
        "The lengths are not printed. These reach the whole box and give the paper's 0.23 mm; they are assumed "
        "and editable.",
        holds,
    )


def _jacobian(robot: Robot) -> Row:
    theta = np.random.default_rng(5).uniform(0.8 * robot.limits[:, 0], 0.8 * robot.limits[:, 1], (40, 5))
    h = 1e-6
    step = h * np.eye(5)
    ahead, behind = (tool_pose(robot, theta[:, None] + sign * step)[..., :3, 3] for sign in (1, -1))
    numeric = np.swapaxes((ahead - behind) / (2 * h), -1, -2)
    error = float(np.abs(numeric - geometric_jacobian(robot, theta)[:, :3]).max())
    return Row(
        "Eqs. (5) to (9)",
        "tool pose and geometric Jacobian",
        f"J equals the numeric derivative of the pose to {error:.0e} m/rad at 40 configurations",
        "reproduced",
        "Closed form against differences.",
        error < 1e-8,
    )


def _workspace(robot: Robot) -> Row:
    field = compliance_field(robot, box_grid(*PAPER_BOX, STEP))
    share = float(field.reached.mean())
    size = " × ".join(f"{from_si(float(v), 'mm'):.0f}" for v in Box(*PAPER_BOX).size)
    return Row(
        "Fig. 3, eq. (10)",
        "A = B = 0: the adopted part of the workspace is 1200 × 600 × 500 mm",
        f"{100 * share:.0f} % of the {size} mm box is in reach",
        "assumed",
        "Joint limits and the place of the box in Y are not printed; plausible ones are assumed.",
        share == 1.0,
    )


def _determinant(robot: Robot) -> Row:
    field = compliance_field(robot, box_grid(*PAPER_BOX, 0.05))
    det = field.det_J
    low, high = (np.abs(det[:, :, k]) for k in (0, -1))
    same = bool((np.sign(det) == np.sign(det.flat[0])).all())
    return Row(
        "Fig. 4",
        "det(J) at Z = −400 and 100 mm: good throughout, no singularity",
        f"|det J| {_span(low)} m³ at −400, {_span(high)} at 100 mm; {'never' if same else 'somewhere'} zero in the box",
        "assumed",
        "Rows v_x, v_y, v_z, ω_x', ω_y'. The figure's own numbers cannot be read from its text.",
        same and bool(field.reached.all()),
    )


def _table_of(robot: Robot, name: str, single: IdentificationResult) -> Row:
    C = from_si(robot.compliance_sets[name], "1e-7 rad/(N m)")
    holds = bool(np.allclose(C, TABLES[name]))
    worst = float(np.abs(single.C_theta / robot.compliance_sets[name] - 1.0).max())
    return Row(
        "Table 2",
        _joints(TABLES["table_2"]),
        f"{_joints(C)}; loading one joint at a time gives them back to {100 * worst:.1f} %",
        "reproduced",
        "The values are the paper's; the load tests are synthetic, since its readings are not printed.",
        holds and worst < 0.02,
    )


def _figure_5(plane: ComplianceField) -> Row:
    x, values = plane.grid.x, {c: plane.values(f"C_{c}")[:, :, 0] for c in ("xx", "yy", "zz")}
    right, inner = x >= -1e-9, np.abs(x) <= 0.4 + 1e-9
    falls = all(
        (np.diff(values[c], axis=1) < 0).all() and (np.diff(values[c][right], axis=0) > 0).all() for c in ("xx", "zz")
    )
    yy = bool((np.diff(values["yy"][inner], axis=1) > 0).all() and (np.diff(values["yy"][right], axis=0) < 0).all())
    ranges = ", ".join(f"C_{c} {_span(from_si(v, 'um/N'))}" for c, v in values.items())
    return Row(
        "Fig. 5 (claim 1)",
        "C_xx, C_zz fall with Y and grow with |X|; C_yy grows with Y and falls with |X|",
        f"{ranges} µm/N; {'all trends hold' if falls and yy else 'a trend fails'}",
        "assumed",
        "C_yy grows with Y for |X| up to 400 mm with these lengths.",
        falls and yy,
    )


def _figure_6(plane: ComplianceField) -> Row:
    shares = plane.shares.mean(axis=(0, 1, 2))
    part = [float(shares[[0, 2, 4], k].sum() / shares[:, k].sum()) for k in (0, 1)]
    others = float(np.abs(plane.shares[..., [0, 3, 4], 2]).max() / plane.total[..., 2].max())
    return Row(
        "Fig. 6 (claim 2)",
        "C_xx, C_yy from joints 1, 3, 5; C_zz from joints 2 and 3 only",
        f"joints 1, 3, 5 make {100 * part[0]:.0f} % of C_xx and {100 * part[1]:.0f} % of C_yy; others in C_zz: "
        f"{_nothing(others)}",
        "assumed",
        "Mean over the plane Z = 0.",
        min(part) >= 0.9 and others < 1e-12,
    )


def _figure_7(plane: ComplianceField) -> Row:
    sizes = np.abs(plane.shares).mean(axis=(0, 1, 2))
    part = float(sizes[[0, 2, 4], 3].sum() / sizes[:, 3].sum())
    rest = float(sizes[[0, 1, 3, 4]][:, [4, 5]].max() / sizes[2, [4, 5]].min())
    return Row(
        "Fig. 7 (claim 3)",
        "C_xy from joints 1, 3, 5; C_xz and C_zy from joint 3 only",
        f"joints 1, 3, 5 make {100 * part:.0f} % of |C_xy|; others in C_xz, C_zy: {_nothing(rest)}",
        "assumed",
        "At Z = 0 joints 2 and 3 alone move the tip vertically.",
        part >= 0.9 and rest < 1e-12,
    )


def _figure_8(robot: Robot) -> Row:
    lines = border_and_middle_lines(robot, points=31)
    most = [max(float(np.abs(line.along_normal().sum(axis=1)).max()) for line in lines[i : i + 3]) for i in (0, 3)]
    sums = max(float(np.abs(line.delta_joint.sum(axis=1) - line.delta).max()) for line in lines)
    return Row(
        "Fig. 8",
        "deviation along six lines, 100 N normal to the feed, total and by joint",
        f"largest {_mm(most[0], 3)} along X and {_mm(most[1], 3)} along Y; joints add up to the total",
        "assumed",
        "The curves are printed without numbers; their shape follows from Figs. 5 and 6.",
        all(line.reached.all() for line in lines) and sums < 1e-15,
    )


def _photographs() -> Row:
    return Row(
        "Figs. 9, 10, 14",
        "the test rig, the measuring arm, the milling test",
        "the page Identification plans such tests",
        "not computed",
        "Drawings and photographs.",
        True,
    )


def _nothing(share: float) -> str:
    return "nothing" if share < 1e-12 else f"{share:.0e} of it"


def _span(values: FloatArray) -> str:
    return f"{np.nanmin(values):.2f} to {np.nanmax(values):.2f}".replace("-", "−")


def _mm(value: float, digits: int = 0) -> str:
    return format_si(value, "mm", digits)


def _joints(values: Sequence[float] | FloatArray) -> str:
    return ", ".join(format_value(float(v), "1", 2) for v in values) + " × 10⁻⁷ rad/(N m)"
