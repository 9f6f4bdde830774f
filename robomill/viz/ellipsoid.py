"""Compliance at a point as a body: where the tip goes under the same force in every direction."""

from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.deflection import soft_direction
from robomill.viz import solids
from robomill.viz.theme import palette


def ellipsoid_mesh(C: FloatArray, centre: FloatArray, times: float) -> solids.Triangles:
    """Points centre + times * C u for unit vectors u: the ellipsoid with the principal compliances as half axes.

    C (3, 3) m/N, centre (3,) m, ``times`` m per m/N.
    """
    v = np.linspace(0.0, np.pi, 28)
    sphere, faces = solids.revolution(np.sin(v), -np.cos(v), np.zeros(3), np.array([0.0, 0.0, 1.0]), sides=56)
    return np.asarray(centre) + times * sphere @ np.asarray(C).T, faces


def ellipsoid_scale(C: FloatArray, size: float) -> float:
    """m per m/N so that the longest half axis is ``size`` m."""
    top = float(soft_direction(C)[0][-1])
    return size / top if top > 0 else 0.0


def ellipsoid_traces(
    C: FloatArray,
    centre: FloatArray,
    times: float,
    *,
    dark: bool,
    width: float,
    away: FloatArray | None = None,
) -> tuple[list[Any], list[solids.Said]]:
    """The ellipsoid, half transparent, and its soft direction as a line through the tip; and the word beside that.

    The word stands at the end that points away from ``away`` (3,), so that it does not cover an arrow there.
    """
    p = palette(dark)
    values, axes = soft_direction(C)
    if values[-1] <= 0:
        return [], []
    soft = axes[:, -1] * times * values[-1]
    if away is not None and soft @ away > 0:
        soft = -soft
    traces = [
        solids.trace([ellipsoid_mesh(C, centre, times)], p.caution, "compliance ellipsoid", opacity=0.32),
        solids.trace(
            [solids.tube(centre - 1.12 * soft, centre + 1.12 * soft, 0.55 * width, sides=12)],
            p.caution,
            "soft direction",
        ),
    ]
    over = np.array([0.0, 0.0, 0.35 * float(np.hypot(soft[0], soft[1]))])  # of an arrow that points the same way
    return traces, [(centre + 1.25 * soft + over, "softest", p.caution)]
