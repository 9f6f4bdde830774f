"""Equations (9) to (16) with the numbers of now, as TeX: what is printed multiplies out to what is printed.

Every number is rounded, so a product of printed numbers may miss the printed result. Each equation therefore gets as
many decimals as it takes until the printed numbers give the printed result.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.at_pose import PoseReport
from robomill.compliance.deflection import displacement
from robomill.units import from_si

SMALL = 5e-4
MORE = 12  # decimals beyond the first, at most
Law = Callable[..., Any]


def settled(law: Law, shown: int, *given: tuple[Any, int]) -> tuple[list[str], ...]:
    """Of each of ``given`` (numbers, least decimals) the numbers as text, then what ``law`` makes of them with so many
    decimals ``shown``: with as many decimals as make the law of what is printed read as the law of the numbers."""
    exact = texts(law(*(np.asarray(numbers, dtype=np.float64) for numbers, _ in given)), shown)
    printed: list[list[str]] = []
    for more in range(MORE):
        printed = [texts(numbers, digits + more) for numbers, digits in given]
        read = [np.array([*map(float, p)]).reshape(np.shape(n)) for p, (n, _) in zip(printed, given, strict=True)]
        if texts(law(*read), shown) == exact:
            break
    return (*printed, exact)


def texts(numbers: Any, digits: int) -> list[str]:
    """Numbers with so many decimals; no negative zero."""
    return [number(float(each), digits) for each in np.ravel(numbers)]


def number(value: float, digits: int) -> str:
    """One number with so many decimals; no negative zero."""
    text = f"{value:.{digits}f}"
    return text.lstrip("-") if float(text) == 0 else text


def column(cells: Sequence[str]) -> str:
    """A column vector as TeX."""
    return matrix(cells, 1)


def matrix(cells: Sequence[str], columns: int) -> str:
    """A matrix of so many columns as TeX, its cells row by row."""
    rows = r" \\ ".join(" & ".join(cells[k : k + columns]) for k in range(0, len(cells), columns))
    return rf"\begin{{bmatrix}} {rows} \end{{bmatrix}}"


def component(pose: PoseReport, row: int, column: int) -> str:
    """C_ab as the sum of its joints with numbers, one below another as TeX; joints that add nothing are left out."""
    name = "xyz"[row] + "xyz"[column]
    shares = from_si(pose.shares(name), "um/N")
    top = float(np.abs(shares).max())
    seen = np.abs(shares) > max(SMALL, 1e-3 * top)
    if number(float(shares[seen].sum()), 3) != number(float(shares.sum()), 3):
        seen = shares != 0.0  # what is left out would be missed in the sum
    C = from_si(pose.robot.C_theta[seen], "urad/(N m)")
    a, b = (pose.J[k, seen] for k in (row, column))
    C_text, a_text, b_text, (total,) = settled(lambda C, a, b: (C * a * b).sum(), 3, (C, 3), (a, 3), (b, 3))
    factors = [rf"({p})^2" if row == column else rf"({p})({q})" for p, q in zip(a_text, b_text, strict=True)]
    numbers = np.array(pose.robot.joint_numbers)[seen].tolist()
    terms = [
        rf"{c}\cdot {each} && \small\text{{joint {joint}}}"
        for c, each, joint in zip(C_text, factors, numbers, strict=True)
    ]
    sum_ = r" \\ &+ ".join(terms) if terms else "0"
    return rf"\begin{{aligned}} C_{{{name}}} = {{}} & {sum_} \\ = {{}} & {total} \end{{aligned}}"


def product(C: FloatArray, F: FloatArray) -> str:
    """C F = delta with numbers in um/N, N and um, as TeX."""
    whole = np.allclose(F, np.round(F), atol=1e-9)
    C_text, F_text, moved = settled(displacement, 1, (from_si(C, "um/N"), 3), (F, 0 if whole else 1))
    return rf"{matrix(C_text, 3)} {column(F_text)} = {column(moved)}"
