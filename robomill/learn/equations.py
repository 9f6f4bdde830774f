"""Equations (13) to (16) with the numbers of now, as TeX."""

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.at_pose import PoseReport
from robomill.compliance.deflection import displacement
from robomill.units import from_si

SMALL = 5e-4


def component(pose: PoseReport, row: int, column: int) -> str:
    """C_ab as the sum of its joints with numbers, one below another as TeX; joints that add nothing are left out."""
    name = "xyz"[row] + "xyz"[column]
    shares = from_si(pose.shares(name), "um/N")
    top = float(np.abs(shares).max())
    terms = []
    for i, number in enumerate(pose.robot.joint_numbers):
        if abs(shares[i]) <= max(SMALL, 1e-3 * top):
            continue
        C = float(from_si(pose.robot.C_theta[i], "urad/(N m)"))
        a, b = (float(pose.J[k, i]) for k in (row, column))
        factors = rf"({a:.3f})^2" if row == column else rf"({a:.3f})({b:.3f})"
        terms.append(rf"{C:.3f}\cdot {factors} && \small\text{{joint {number}}}")
    sum_ = r" \\ &+ ".join(terms) if terms else "0"
    return rf"\begin{{aligned}} C_{{{name}}} = {{}} & {sum_} \\ = {{}} & {shares.sum():.3f} \end{{aligned}}"


def product(C: FloatArray, F: FloatArray) -> str:
    """C F = delta with numbers in um/N, N and um, as TeX."""
    rows = from_si(C, "um/N")
    matrix = r" \\ ".join(" & ".join(_number(v, 3) for v in row) for row in rows)
    moved = r" \\ ".join(_number(v, 1) for v in from_si(displacement(C, F), "um"))
    whole = np.allclose(F, np.round(F), atol=1e-9)
    force = r" \\ ".join(_number(v, 0 if whole else 1) for v in F)
    return (
        rf"\begin{{bmatrix}} {matrix} \end{{bmatrix}} \begin{{bmatrix}} {force} \end{{bmatrix}}"
        rf" = \begin{{bmatrix}} {moved} \end{{bmatrix}}"
    )


def _number(value: float, digits: int) -> str:
    text = f"{value:.{digits}f}"
    return text.lstrip("-") if float(text) == 0 else text
