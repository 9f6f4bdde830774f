"""One run, end to end: path -> poses -> joints -> compliance -> force -> deflection -> surfaces."""

from __future__ import annotations

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.cartesian import joint_contributions
from robomill.compliance.deflection import deflection
from robomill.cutting.force import feed_frame, force_on_tool
from robomill.errors import ToolpathError
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.jacobian import geometric_jacobian
from robomill.kinematics.transforms import pose_from_world
from robomill.simulation.cut import cut_conditions
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath
from robomill.toolpath.sampling import resample


def simulate(setup: SimulationSetup) -> SimulationResult:
    """Deflection of the tool tip along the path under the cutting force, eqs. (11)-(16).

    Points that cannot be reached are NaN in theta, C and delta, and counted in ``reached``.
    Raises RobomillError children naming what cannot be run.
    """
    path = resample(setup.toolpath, setup.step)
    if not path.cutting.any():
        raise ToolpathError("The path has no feed move, so nothing is cut: add a G1 move or a line.")
    ik = inverse_kinematics(setup.robot, setup.T_MW @ tool_frames(path))
    J = geometric_jacobian(setup.robot, ik.theta)
    C_joint = joint_contributions(J[..., :3, :], setup.robot.C_theta)
    C_spring = {spring.name: spring.compliance(setup.robot, ik.theta) for spring in setup.springs}
    conditions, notes = cut_conditions(setup, path, ik.reached)
    F = force_on_tool(setup.force, conditions, feed_directions(setup, path))
    delta_joint = deflection(C_joint, F)
    delta_spring = {name: np.einsum("...ij,...j->...i", C, F) for name, C in C_spring.items()}
    delta = delta_joint.sum(axis=-2) + sum(delta_spring.values(), start=np.zeros(3))
    return SimulationResult(
        setup=setup, path=path, ik=ik, C_joint=C_joint, C_spring=C_spring, conditions=conditions, F=F,
        delta_joint=delta_joint, delta_spring=delta_spring, delta=delta, notes=notes,
    )  # fmt: skip


def tool_frames(path: Toolpath) -> FloatArray:
    """(m, 4, 4) T_WT: tip at p, z_T = k, spin about z_T as R_x(A) R_y(B) gives it."""
    A = np.arctan2(-path.k[:, 1], path.k[:, 2])
    B = np.arcsin(np.clip(path.k[:, 0], -1.0, 1.0))
    return pose_from_world(np.column_stack([path.p, A, B]))


def feed_directions(setup: SimulationSetup, path: Toolpath) -> FloatArray:
    """(m, 3, 3) R_MF, columns feed, feed-normal, axial in {M}; a step of no length takes the next one's."""
    points = path.p.copy()
    still = np.flatnonzero(path.cutting & (path.step_length == 0.0))
    R_MW = setup.T_MW[:3, :3]
    frames = R_MW @ feed_frame(points, path.k)
    frames[still[still + 1 < len(path)]] = frames[still[still + 1 < len(path)] + 1]
    return np.asarray(frames)
