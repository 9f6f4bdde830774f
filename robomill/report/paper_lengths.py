"""The lengths the paper does not print, and what a result becomes with others that its claims allow as well.

a_2, d_4 and a_5 are assumed; they are 191 of 14 112 tried that meet the paper's claims as well as ours do. The
search and its criteria stand in ``tests/paper/lengths.py``, which finds these lengths again by plane geometry.
"""

from dataclasses import dataclass, field
from functools import cache, lru_cache

import numpy as np

from robomill.arrays import FloatArray, frozen
from robomill.compliance.cartesian import joint_contributions
from robomill.kinematics.choice import nearest, rules
from robomill.kinematics.decoupled import Decoupled, branch_names, decoupled
from robomill.kinematics.jacobian import geometric_jacobian
from robomill.report.paper import TABLE_1
from robomill.robot.model import Robot
from robomill.simulation.result import SimulationResult
from robomill.units import from_si, to_si

OURS = (1220.0, 1100.0, 300.0)  # a_2, d_4, a_5, mm
TRIED = 14_112
ANY = np.tile([-2 * np.pi, 2 * np.pi], (5, 1))  # rad: limits are assumed too, for our lengths
# a_2: d_4/a_5[/a_5], mm.
AS_GOOD = """
    1000: 1160/356, 1200/356, 1240/356, 1320/340, 1360/340, 1400/340, 1440/340, 1480/340, 1520/340, 1560/340
    1040: 1080/356, 1120/356, 1200/340, 1240/340, 1280/340, 1320/340, 1360/324, 1400/324, 1440/324,
        1480/324, 1520/324, 1560/324, 1600/324
    1080: 880/372, 920/372, 1000/356, 1040/356, 1080/340, 1120/340, 1160/340, 1200/324, 1240/324, 1280/324,
        1320/324, 1360/308, 1400/308, 1440/308, 1480/308, 1520/308, 1560/308, 1600/308
    1120: 840/372, 880/372, 920/356, 960/356, 1040/340, 1080/340, 1120/324, 1160/324, 1200/324, 1240/308,
        1280/308, 1320/308, 1360/292, 1400/292, 1440/292, 1480/292, 1520/292, 1560/292, 1600/292
    1160: 800/372, 840/372, 880/356, 920/356, 960/340, 1000/340, 1040/324, 1080/324, 1160/308, 1200/308,
        1240/292, 1280/292, 1320/292, 1360/276, 1400/276, 1440/276, 1480/260/276, 1520/260/276, 1560/260,
        1600/260/276
    1200: 920/340, 960/340, 1000/324, 1040/324, 1080/308, 1120/308, 1160/292, 1200/292, 1240/276, 1280/276,
        1320/260/276, 1360/260, 1400/260, 1440/244/260, 1480/244, 1520/244, 1560/244, 1600/244
    1240: 960/324, 1000/308, 1040/308, 1080/292, 1120/292, 1160/276, 1200/276, 1240/260, 1280/260,
        1320/244/260, 1360/244, 1400/228/244, 1440/228, 1480/228, 1520/212/228, 1560/212, 1600/212
    1280: 1040/292, 1080/292, 1120/276, 1160/276, 1200/260, 1240/244, 1280/244, 1320/228, 1360/228,
        1400/212, 1440/212, 1480/196/212, 1520/196, 1560/180/196, 1600/180/196
    1320: 1120/260, 1160/260, 1200/244, 1240/228/244, 1280/228, 1320/212, 1360/196/212, 1400/196,
        1440/180/196, 1480/164/180, 1520/164, 1560/148/164, 1600/148/164
    1360: 1200/228, 1240/212/228, 1280/212, 1320/196, 1360/180, 1400/164/180, 1440/148/164, 1480/148,
        1520/132/148, 1560/116/132, 1600/100/116
    1400: 1320/180, 1360/164, 1400/148, 1440/132/148, 1480/116/132, 1520/100/116, 1560/100
    1440: 1400/132, 1440/100/116, 1480/100
"""


@cache
def lengths() -> FloatArray:
    """(g, 3) m: a_2, d_4, a_5 of all that the paper's claims allow as well as ours."""
    found = []
    for row in AS_GOOD.replace("\n        ", " ").split("\n"):
        a_2, _, rest = row.partition(":")
        for pair in rest.split(","):
            d_4, *shorter = pair.split("/")
            found += [(float(a_2), float(d_4), float(a_5)) for a_5 in shorter]
    return np.asarray(frozen(to_si(np.array(found), "mm")))


def are_assumed(robot: Robot) -> bool:
    """Whether the robot is the paper's with the lengths assumed here, neither edited nor measured."""
    said = robot.provenance.get("lengths")
    if said is None or said.kind != "assumed" or robot.rows != len(TABLE_1[0]):
        return False
    same = np.allclose(from_si(robot.alpha, "deg"), TABLE_1[0])
    return same and np.allclose(from_si(np.array([robot.a[1], robot.d[3], robot.a[4]]), "mm"), OURS)


def over_lengths(result: SimulationResult, i: int) -> FloatArray | None:
    """(g, 3) m: the deflection at sample i along feed, feed-normal and axial with each of ``lengths``.

    Same pose, force, joint compliances and springs; the assumed joint limits are left out. None where the lengths do
    not matter or are not the assumed ones: another arm, lengths that were edited, a measured map in force; nor where
    the arm has no closed form, as with a tool turned aside.
    """
    robot, setup = result.setup.robot, result.setup
    if not are_assumed(robot) or setup.measured_map is not None or not result.reached[i]:
        return None
    springs, T_MT, near = result.C_spring[i].sum(axis=0), result.ik.T_MT[i][None], result.theta[i][None]
    bare = robot.replace(C_theta_all=np.zeros(robot.rows), compliance_sets={}, provenance={}, limits=ANY)
    every_branch = np.ones(len(branch_names()), dtype=bool)
    found = []
    for other, arm in _arms(_Bare(bare.digest(), bare)):
        theta = nearest(other, arm, T_MT, near, rules(other, arm, every_branch, False, False)).theta[0]
        C_joint = joint_contributions(geometric_jacobian(other, theta)[:3], robot.C_theta)
        found.append((C_joint.sum(axis=0) + springs) @ result.F[i])
    return np.asarray(np.array(found) @ result.R_MF[i]) if found else None


@dataclass(frozen=True)
class _Bare:
    """A robot that is known again by its numbers."""

    digest: str
    robot: Robot = field(compare=False)


@lru_cache(maxsize=4)
def _arms(bare: _Bare) -> tuple[tuple[Robot, Decoupled], ...]:
    """The robot with each of ``lengths``, and what its closed form needs; none where it has no closed form."""
    robot, found = bare.robot, []
    for a_2, d_4, a_5 in lengths():
        a, d = np.array(robot.a), np.array(robot.d)
        a[1], d[3], a[4] = a_2, d_4, a_5
        other = robot.replace(a=a, d=d)
        arm = decoupled(other)
        if arm is not None:
            found.append((other, arm))
    return tuple(found)
