"""Mean and tooth: the arm is too heavy to follow a tooth and sees the mean force; tool and spindle follow each tooth.

A wall is made by teeth, so beside its mean stands how far the springs that follow them carry it.
"""

from dataclasses import dataclass

import numpy as np

from robomill.arrays import FloatArray
from robomill.simulation.origin.spread import peak_force
from robomill.simulation.result import SimulationResult

LEFT_OUT = (
    "run-out of the teeth",
    "ringing where the tool enters and leaves",
    "chatter",
)
"""What no number of a run holds; said beside its verdict."""


@dataclass(frozen=True, eq=False)
class Tooth:
    """Deviation along feed, feed-normal and axial, each (m, 3) m: by the mean force, and its extremes over a turn."""

    mean: FloatArray
    low: FloatArray
    high: FloatArray


def tooth(result: SimulationResult) -> Tooth | None:
    """Extremes over a turn of the deviation in the axes of the cut; None where no turn or no spring that follows it is
    known. They are static: what a spring and its mass do in time is left out.
    """
    follow = [k for k, spring in enumerate(result.setup.springs) if spring.follows_tooth]
    if not follow or result.setup.measured_map is not None:
        return None
    peak = peak_force(result)
    if peak is None:
        return None
    C = result.C_spring[:, follow].sum(axis=1)
    own = np.einsum("mji,mjk,mki->mi", result.R_MF, C, result.R_MF)  # across and along the tool: no cross terms
    mean = result.delta_in_cut
    ends = [mean + own * (force - result.force_components) for force in (peak.low, peak.high)]
    return Tooth(mean, np.minimum(*ends), np.maximum(*ends))
