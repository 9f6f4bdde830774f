"""Equations with numbers in them: what is printed adds up."""

from __future__ import annotations

import re

import numpy as np
import pytest

from robomill.compliance.at_pose import PoseReport
from robomill.ui.learn.mathematics import component, product


def test_the_equation_s_terms_add_up(found: PoseReport) -> None:
    """The numbers printed under the braces, multiplied and added, are the number after the equals sign."""
    tex = component(found, 1, 1)
    terms = re.findall(r"\{(-?[\d.]+)\\cdot \((-?[\d.]+)\)\^2\}", tex)
    total = float(tex.rpartition("=")[2])
    assert sum(float(c) * float(j) ** 2 for c, j in terms) == pytest.approx(total, abs=0.01)
    assert total == pytest.approx(found.C[1, 1] * 1e6, abs=1e-3)


def test_the_product_is_c_times_f(found: PoseReport) -> None:
    moved = re.findall(r"bmatrix\} (-?[\d.]+) \\\\ (-?[\d.]+) \\\\ (-?[\d.]+) \\end", product(found.C))[-1]
    np.testing.assert_allclose([float(v) for v in moved], found.C[:, 1] * 100e6, atol=0.06)
