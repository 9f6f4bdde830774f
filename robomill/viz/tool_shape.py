"""A tool as pictures show it: cutter, shank and spindle nose as outlines that are turned about its axis."""

from __future__ import annotations

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.springs.tool_bending import ToolBending
from robomill.cutting.tool import Cutter
from robomill.viz.rendered.picture import Role


def tool_shape(cutter: Cutter, *, rim: int, reach: float | None = None) -> dict[Role, tuple[FloatArray, FloatArray]]:
    """Radii and heights over the tip (q,), m, of each part; the cutter's end by ``rim`` points. Lengths that are not
    given are drawn as usual ones. The nose is as tall as the whole may be, ``reach`` m, within bounds."""
    R = cutter.radius
    flutes = cutter.flute_length or 2.5 * cutter.diameter
    out = max(ToolBending.first(cutter).stick_out, flutes)
    r = np.linspace(0.0, R, rim)
    below = cutter.profile(r)
    top = out + 4.0 * R if reach is None else max(out + 6.0 * R, min(reach, out + 24.0 * R))
    return {
        "cutter": (np.append(r, R), np.append(below, max(flutes, float(below[-1])))),
        "shank": (np.array([0.92 * R, 0.92 * R]), np.array([flutes, out])),
        "spindle": (R * np.array([1.25, 1.9, 2.4, 2.4]), np.array([out, out + 2.4 * R, out + 2.8 * R, top])),
    }
