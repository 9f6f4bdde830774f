"""How much of the cutter is in the material, step by step, from the stock as it stands before each step.

Angles count clockwise from the feed-normal +y (left of the feed), seen from above with x along the feed: 0 is the
left side, 90 degrees straight ahead, 180 the right side, as in the mean-force formulas. A step's engagement is
taken at its end, on curves in the middle of its chord. Where material begins and ends is found on the swept
bodies of the moves themselves, so it does not depend on the size of the cells.
"""

from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray, frozen
from robomill.cutting.edge import MOMENTS
from robomill.cutting.engaged import EngagedPart
from robomill.surface.contact.march import March


@dataclass(frozen=True, eq=False)
class Engagement:
    """Engagement of each step (m,); entry i belongs to the move p[i-1] -> p[i]; all zero in air, on rapids and where
    nothing moves.

    phi_st, phi_ex  rad  where the arc in contact begins and ends, in the half turn ahead
    a_p             m    height of the engaged part along the axis, the mean over that arc (gaps in it count as zero)
    a_e             m    radial width: the part of the cutter's width that meets material
    reach           m    highest engaged place above the tip, along the axis
    part                 the engaged part itself, for the force
    """

    phi_st: FloatArray
    phi_ex: FloatArray
    a_p: FloatArray
    a_e: FloatArray
    reach: FloatArray
    part: EngagedPart


def engage(march: March) -> Engagement:
    """March a path through its stock, from the first step to the last, and return the engagement of each step."""
    return engagement(march.exponents, *march.run())


def engagement(exponents: tuple[float, ...], rows: FloatArray, sectors: np.ndarray) -> Engagement:
    """Rows and sectors of what steps meet (see ``March``), by name."""
    count = len(exponents)
    moments = rows[:, : MOMENTS * count].reshape(len(rows), count, MOMENTS)
    phi_st, phi_ex, a_p, a_e, reach, _, lost = frozen(rows[:, MOMENTS * count :].T)
    known = np.asarray(lost == 0.0)  # a gap between layers of material that was closed may be met by any later step
    return Engagement(phi_st, phi_ex, a_p, a_e, reach, EngagedPart(exponents, moments, sectors, known))
