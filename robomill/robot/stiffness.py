"""How much a joint gives, said as a compliance or as a stiffness: each is one over the other, a rigid joint 0 or ∞."""

from typing import Any

import numpy as np

from robomill.quantities import quantities
from robomill.robot.model import Robot
from robomill.units import from_si, to_si

COMPLIANCE = quantities(Robot)["C_theta_all"]
JOINT_UNITS = {COMPLIANCE.unit: str(COMPLIANCE.sliding), "kN m/rad": "N/um"}  # as said of joints that turn, that slide
_STIFFNESSES = ("kN m/rad", "N/um")


def is_stiffness(unit: str) -> bool:
    """Whether a joint is described by its stiffness rather than its compliance."""
    return unit in _STIFFNESSES


def of_joint(unit: str, slides: bool) -> str:
    """The unit that goes with ``unit``, one of ``JOINT_UNITS``, for a joint that turns or slides."""
    return JOINT_UNITS[unit] if slides else unit


def turned_over(value: Any) -> Any:
    """One over the value, element by element: stiffness from compliance and back, 0 from ∞ and back."""
    with np.errstate(divide="ignore"):
        return 1.0 / np.asarray(value, dtype=np.float64)


def shown(compliance: Any, unit: str) -> Any:
    """A compliance (SI) as ``unit`` says it."""
    return from_si(turned_over(compliance) if is_stiffness(unit) else compliance, unit)


def meant(value: float, unit: str) -> float:
    """The compliance (SI) that a value in ``unit`` says."""
    found = to_si(float(value), unit)
    return float(turned_over(found)) if is_stiffness(unit) else found
