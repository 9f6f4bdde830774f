"""What holds at one configuration: pose, Jacobian, determinant, compliance and the joints' shares of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asked, made_by
from robomill.arrays import FloatArray, as_floats, frozen
from robomill.compliance.cartesian import full_compliance, joint_contributions
from robomill.compliance.deflection import displacement, soft_direction
from robomill.errors import KinematicsError
from robomill.kinematics import dexterity
from robomill.kinematics.forward import joint_angles, joint_frames
from robomill.kinematics.jacobian import geometric_jacobian
from robomill.lazy import cached_property
from robomill.robot.model import Robot
from robomill.units import format_many, format_si
from robomill.values import Value


@made_by("rm.at_pose(robot, theta)")
@dataclass(frozen=True, eq=False, repr=False)
class PoseReport(Value):
    """The arm at the configuration theta (n,) rad (m where prismatic); every number NaN where theta is NaN.

    Examples
    --------
    >>> import robomill as rm
    >>> robot = rm.load_robot("slavkovic_5r")
    >>> rm.at_pose(robot, robot.home).C_joint.shape
    (5, 3, 3)
    """

    robot: Robot
    theta: FloatArray

    def _said(self) -> str:
        units = self.robot.joint_units
        theta = ", ".join(format_si(each, unit, 2) for each, unit in zip(self.theta, units, strict=True))
        return f"of {self.robot.name} at {theta}" if self.reached else f"of {self.robot.name}, not reached"

    def _facts(self) -> list[tuple[str, str]]:
        said = [("Robot", self.robot._said())]
        if not self.reached:
            return said
        said.append(("Tip in {M}", format_many(self.T_MT[:3, 3], "mm", 2)))
        return [*said, *((f"C_{c}{c}", format_si(self.C[i, i], "um/N", 3)) for i, c in enumerate("xyz"))]

    @property
    def reached(self) -> bool:
        """False for the NaN that inverse kinematics answers where a pose is not reached."""
        return not np.isnan(self.theta).any()

    @cached_property
    def frames(self) -> FloatArray:
        """(n + 1, 4, 4) in {M}: the frame each joint moves about, then {T}."""
        return self._known(joint_frames(self.robot, self.theta))

    @property
    def T_MT(self) -> FloatArray:
        """(4, 4) the pose of the tool."""
        return self.frames[-1]

    @cached_property
    def J(self) -> FloatArray:
        """(6, n) geometric Jacobian in {M}, m/rad and rad/rad. Eq. (9)."""
        return self._known(geometric_jacobian(self.robot, self.theta))

    @cached_property
    def C_joint(self) -> FloatArray:
        """(n, 3, 3) m/N: what each joint gives. Eqs. (13), (14)."""
        return joint_contributions(self.J[:3], self.robot.C_theta)

    @cached_property
    def C(self) -> FloatArray:
        """(3, 3) m/N: the tip's compliance, the sum of the joints' shares. Eqs. (11), (12)."""
        return self.C_joint.sum(axis=0)

    @cached_property
    def C_X(self) -> FloatArray:
        """(6, 6): rotations and moments too. Eq. (11)."""
        return self._known(full_compliance(self.robot, self.theta))

    @cached_property
    def det_J(self) -> float:
        """Determinant of the arm's task Jacobian (see ``dexterity.determinant``); ``det_J_unit`` is its unit."""
        return float(dexterity.determinant(self.robot, self.theta))

    @property
    def near_singular(self) -> bool:
        """Whether det(J) is so small that a singular configuration is near (see ``dexterity.near_singular``)."""
        return bool(dexterity.near_singular(self.robot, self.det_J))

    @property
    def has_det_J(self) -> bool:
        """Whether the task Jacobian is square; where it is not, ``det_J`` is its size only, no determinant."""
        return dexterity.has_determinant(self.robot)

    @property
    def det_J_unit(self) -> str:
        """A key of ``UNITS``."""
        return dexterity.determinant_unit(self.robot)

    @cached_property
    def manipulability(self) -> float:
        """sqrt(det(J J^T)) of the task Jacobian."""
        return float(dexterity.manipulability(self.robot, self.theta))

    @cached_property
    def limit_distance(self) -> float:
        """Room of the joint nearest to a limit, as a share of its half range."""
        return float(dexterity.limit_distance(self.robot, self.theta))

    @cached_property
    def principal(self) -> tuple[FloatArray, FloatArray]:
        """(values (3,) m/N rising, axes (3, 3) as columns): the compliance ellipsoid; the last axis gives most.

        Each axis points to the side of its largest component.
        """
        if not self.reached:
            return np.full(3, np.nan), np.full((3, 3), np.nan)
        values, axes = soft_direction(self.C)
        largest = np.take_along_axis(axes, np.abs(axes).argmax(axis=0)[None], axis=0)
        return values, axes * np.sign(largest)

    def component(self, name: str) -> float:
        """C_ab in m/N, ``name`` two of x, y, z: "yy", "xz", or as maps call it, "C_yy"."""
        return float(self.C[_indices(name)])

    def shares(self, name: str) -> FloatArray:
        """(n,) m/N: the joints' shares of C_ab, which add up to it."""
        return self.C_joint[(slice(None), *_indices(name))]

    def delta(self, F: ArrayLike) -> FloatArray:
        """(3,) m in {M}: the tip displacement under F (3,) N on the tool, C F. Eq. (16)."""
        return displacement(self.C, as_floats(F, "F (N)", (3,), error=KinematicsError))

    def _known(self, value: FloatArray) -> FloatArray:
        return value if self.reached else np.full(value.shape, np.nan)


@asked
def at_pose(robot: Robot, theta: ArrayLike) -> PoseReport:
    """All that holds of an arm at one configuration: pose, Jacobian, compliance and its shares.

    Parameters
    ----------
    robot : Robot
        The arm, with n free joints.
    theta : array_like, (n,)
        Joint coordinates, rad (m where a joint slides).

    Returns
    -------
    PoseReport
        In SI and in {M}, eqs. (4) to (14).

    Raises
    ------
    KinematicsError
        Where theta is not one entry a free joint.

    Examples
    --------
    >>> import robomill as rm
    >>> robot = rm.load_robot("slavkovic_5r")
    >>> rm.at_pose(robot, robot.home).C.shape
    (3, 3)
    """
    one = joint_angles(robot, theta)
    if one.ndim != 1:
        raise KinematicsError(f"theta of {robot.name!r}: expected one configuration, found shape {one.shape}.")
    return PoseReport(robot, frozen(one))


def _indices(name: str) -> tuple[int, int]:
    axes = str(name).removeprefix("C_")
    if len(axes) != 2 or not set(axes) <= set("xyz"):
        raise KinematicsError(f"Component {name!r:.40}: expected two of x, y, z, as in 'xy' or 'C_xy'.")
    return "xyz".index(axes[0]), "xyz".index(axes[1])
