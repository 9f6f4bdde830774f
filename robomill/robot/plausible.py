"""Joints that are far stiffer or softer than those of any arm: their numbers were meant in another unit."""

from collections.abc import Mapping
from typing import Any, TypeVar

import numpy as np

from robomill.errors import RobotError
from robomill.robot.arm import Arm
from robomill.units import format_short

# Of published arms that mill, no joint is stiffer than 7.6e6 N m/rad (KUKA KR 500), and the tip gives 1.1e-5 m/N and
# more with all links in a row. Gears turn by 1/100 to 1/1100 rad under the torque that they are made for (catalogues of
# harmonic and cycloidal drives): so 40 arms of 0.8 to 4.5 m, whose makers' descriptions state torques, give 1.4e-6 to
# 4.7e-4 m/N. Each of them a thousand times as stiff or as soft (N m taken for kN m) lies beyond a bound.
STIFFEST_SOFTEST = 1e7  # N m/rad: no arm's softest joint is as stiff
STIFFEST_TIP = 5e-7 / 6  # m/N for each joint that turns: no arm gives less
SOFTEST_TIP = 1e-3  # m/N: no arm that mills gives more
NAMES = {"k_theta_kNm_per_rad": ("kN m/rad", "N m/rad", "k_theta_Nm_per_rad")}
NAMES |= {"k_theta_Nm_per_rad": ("N m/rad", "kN m/rad", "k_theta_kNm_per_rad")}


A = TypeVar("A", bound=Arm)


def tip_compliance(robot: Arm) -> float:
    """m/N: at most so much gives the tip by the joints, all links in a row (a joint that slides by itself alone)."""
    length = np.linalg.norm(robot.chain.E[:, :3, 3], axis=1)
    lever = np.where(robot.chain.prismatic, 1.0, np.cumsum(length[::-1])[::-1])
    return float(robot.C_theta @ lever**2)


def hardly_an_arm(robot: Arm) -> str:
    """What to say of joints that are far stiffer, or softer, than those of any arm; "" of an arm that may be, and where
    joints are said to be rigid."""
    turns = ~robot.chain.prismatic
    C_theta, gives = robot.C_theta[turns], tip_compliance(robot)
    if not turns.any() or not (robot.C_theta > 0.0).all():
        return ""
    if gives < STIFFEST_TIP * turns.sum() or 1.0 / C_theta.max() > STIFFEST_SOFTEST:
        softest = format_short(1.0 / float(C_theta.max()), "kN m/rad")
        return f"no arm's joints are as stiff (its softest has {softest})"
    if gives > SOFTEST_TIP:
        return f"no arm that mills is as soft (1 N would move the tip by up to {format_short(gives, 'mm')})"
    return ""


def checked(robot: A, given: Mapping[str, Any]) -> A:
    """``robot``, made of what was ``given``. Raises RobotError where its stiffnesses were hardly meant in their unit;
    whoever does mean them gives ``C_theta``."""
    for name, (unit, other, key) in NAMES.items():
        doubt = hardly_an_arm(robot) if given.get(name) is not None else ""
        if doubt:
            raise RobotError(
                f"Robot {(robot.title or robot.name)!r}: {name}: {doubt}: {name} is in {unit}. If {other} are meant, "
                f"give {key}; if these stiffnesses are, give C_theta, one over each.",
                where=name,
            )
    return robot
