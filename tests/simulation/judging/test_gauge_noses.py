"""What a round nose leaves between wall and floor, against the distance between two arcs."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from tests.simulation.judging.test_gauge import R, pushed, run

NOSES = {"ball": R, "bull": 1.5e-3}


def furthest(rho: float, depth: float, left: float, up: float) -> float:
    """How far an arc of radius rho is from the same one moved by (left, up), anywhere between the floor and the end of
    the nose, or of the material, on either side: by Euclid, from its centre."""
    most = 0.0
    for side in (1.0, -1.0):
        turn = np.linspace(0.0, np.arccos(max(0.0, 1.0 - depth / rho)), 2001)
        at = np.column_stack([side * np.sin(turn), -np.cos(turn)]) * rho
        most = max(most, float(np.abs(np.hypot(*(at - [left, up]).T) - rho).max()))
    return most


@pytest.mark.parametrize("kind", NOSES)
@pytest.mark.parametrize("depth", [1.0e-3, 3.0e-3, 6.0e-3])
@pytest.mark.parametrize(("left", "up"), [(0.1e-3, 0.1e-3), (-0.1e-3, 0.1e-3), (0.06e-3, -0.12e-3), (0.12e-3, 0.03e-3)])
def test_a_nose_is_read_between_wall_and_floor(kind: str, depth: float, left: float, up: float) -> None:
    """It is off most where its surface faces the way that the tip is off; deep slots hid that behind their walls."""
    cutter = Cutter(kind, 2 * R, corner_radius=NOSES[kind])
    result = run("G0 X-40 Y0 Z5", f"G0 Z{-1e3 * depth}", "G1 X40 F1800", cutter=cutter)
    found = pushed(result, left=left, up=up).verdict
    assert max(abs(found.wall.value), abs(found.floor.value)) == pytest.approx(
        furthest(NOSES[kind], depth, left, up),
        rel=0.04,  # it is read up to 95 % of the depth
    )


def test_a_pass_beside_it_takes_the_nose_away() -> None:
    """A second pass, 3 mm to the left, leaves the nose of the first one on the right only."""
    cutter = Cutter("bull", 2 * R, corner_radius=1.5e-3)
    lines = ("G0 X-40 Y0 Z5", "G0 Z-3", "G1 X40 F1800", "G0 Z5", "G0 X-40 Y3", "G0 Z-3", "G1 X40")
    result = run(*lines, cutter=cutter)
    off = np.where(result.path.p[:, 1] > 1e-3, 0.0, 0.1e-3)
    # Up and to the right: further away than either from what stood on the left, which is gone.
    assert abs(pushed(result, left=-off, up=off).verdict.wall.value) == pytest.approx(0.1e-3, rel=0.01)
    assert pushed(result, left=off, up=off).verdict.wall.value == pytest.approx(np.sqrt(2.0) * 0.1e-3, rel=0.03)
