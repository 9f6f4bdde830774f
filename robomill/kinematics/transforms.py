"""Rigid transforms (..., 4, 4) and the world coordinates x_M = (X, Y, Z, A, B) of a tool pose.

R = R_x(A) R_y(B), so the tool axis is k_T = (sin B, -sin A cos B, cos A cos B); it points out of the part, towards the
spindle. The paper's eq. (3) leaves A and B undefined; this is robomill's reading.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robomill import rigid
from robomill.arguments import asked
from robomill.arrays import FloatArray, as_floats
from robomill.errors import KinematicsError
from robomill.quantities import Quantity
from robomill.rigid import axis_from_tilt as axis_from_tilt
from robomill.spelled import beside, refuse_slip
from robomill.units import format_si
from robomill.vectors import angle_between

QUARTER = 0.5 * np.pi
UNIT = 1e-6  # to which the axes of a pose are unit and square, as files and controllers round them
TILT_A, TILT_B = (Quantity(name, "deg", name=name, key="", slip=2.0 * np.pi) for name in "AB")


def _rotation(angle: ArrayLike, i: int, j: int) -> FloatArray:
    angle = np.asarray(angle, dtype=np.float64)
    R = np.zeros((*angle.shape, 3, 3))
    c, s = np.cos(angle), np.sin(angle)
    k = 3 - i - j
    R[..., k, k] = 1.0
    R[..., i, i] = R[..., j, j] = c
    R[..., i, j] = -s
    R[..., j, i] = s
    return R


def rotation_x(angle: ArrayLike) -> FloatArray:
    """Rotation about x by ``angle`` (...,) rad, (..., 3, 3)."""
    return _rotation(angle, 1, 2)


def rotation_y(angle: ArrayLike) -> FloatArray:
    """Rotation about y by ``angle`` (...,) rad, (..., 3, 3)."""
    return _rotation(angle, 2, 0)


def rotation_z(angle: ArrayLike) -> FloatArray:
    """Rotation about z by ``angle`` (...,) rad, (..., 3, 3)."""
    return _rotation(angle, 0, 1)


def rotation_about(vector: ArrayLike) -> FloatArray:
    """Rotations (..., 3, 3) about vectors (..., 3) by their lengths in rad (Rodrigues' formula)."""
    v = np.asarray(vector, dtype=np.float64)
    angle = np.linalg.norm(v, axis=-1)[..., None, None]
    K = np.cross(v[..., None, :], np.eye(3))  # rows v x e_i: the transpose of the cross product's matrix
    K = np.swapaxes(K, -1, -2)
    half = np.sinc(angle / (2 * np.pi))  # sin(angle / 2) / (angle / 2), 1 at zero
    return np.asarray(np.eye(3) + np.sinc(angle / np.pi) * K + 0.5 * half**2 * (K @ K))


def transform(R: ArrayLike, p: ArrayLike) -> FloatArray:
    """(..., 4, 4) from rotations R (..., 3, 3) and points p (..., 3) in m; leading axes broadcast."""
    R, p = as_floats(R, "R", (3, 3), error=KinematicsError), as_floats(p, "p", (3,), error=KinematicsError)
    return rigid.transform(R, p)


def translation(p: ArrayLike) -> FloatArray:
    """(..., 4, 4) shift by p (..., 3) m."""
    return transform(np.eye(3), p)


def invert(T: ArrayLike) -> FloatArray:
    """Inverse of rigid transforms (..., 4, 4)."""
    T = as_floats(T, "T", (4, 4), error=KinematicsError)
    R = np.swapaxes(T[..., :3, :3], -1, -2)
    return transform(R, -np.einsum("...ij,...j->...i", R, T[..., :3, 3]))


def turn_between(R: FloatArray, Q: FloatArray, whole: bool) -> FloatArray:
    """(...,) rad by which R and Q (..., 3, 3) are turned against each other: their z axes, or as ``whole`` rotations.

    By the chord 2 sin(angle / 2), which is exact for small angles, where the cosine is not.
    """
    if not whole:
        return angle_between(R[..., 2], Q[..., 2])
    chord = np.sqrt(0.5 * ((R - Q) ** 2).sum(axis=(-1, -2)))
    return np.asarray(2.0 * np.arcsin(np.minimum(0.5 * chord, 1.0)))


@asked
def pose_from_world(x_M: ArrayLike) -> FloatArray:
    """The pose of the tool from world coordinates: R = R_x(A) R_y(B) at X, Y, Z.

    Parameters
    ----------
    x_M : array_like, (..., 5)
        X, Y, Z in m and A, B in rad, in {M}.

    Returns
    -------
    ndarray, (..., 4, 4)
        T_MT; its third column is the tool axis z_T = (sin B, -sin A cos B, cos A cos B), out of the part.

    Raises
    ------
    KinematicsError
        Where x_M is not finite or has not 5 entries, for B beyond a quarter turn, and for tilts in degrees.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.pose_from_world([0.1, -1.2, 0.05, 0.0, 0.0])[:3, 3].tolist()
    [0.1, -1.2, 0.05]
    """
    x_M = as_floats(x_M, "x_M", (5,), error=KinematicsError)
    for declared, angle in ((TILT_A, x_M[..., 3]), (TILT_B, x_M[..., 4])):
        worst = float(angle.flat[np.argmax(np.abs(angle))]) if angle.size else 0.0
        refuse_slip(declared, worst, KinematicsError, "Pose")
        _refuse_degrees(declared, worst)
    return transform(rotation_x(x_M[..., 3]) @ rotation_y(x_M[..., 4]), x_M[..., :3])


def _refuse_degrees(declared: Quantity, angle: float) -> None:
    """Refuse a tilt (rad) that was certainly meant in degrees: B ends at a quarter turn, and beyond one nobody states A
    in whole or half radians."""
    ends = declared is TILT_B and abs(angle) > QUARTER + 1e-9
    if not ends and (abs(angle) <= QUARTER or 2.0 * angle != round(2.0 * angle)):
        return
    said = format_si(angle, "deg", 1)
    if beside():
        raise KinematicsError(
            f"Pose, {declared.name}: found {said}; expected -90° to 90°: where it leans further, A turns by 180°.",
            where=declared.name,
        )
    least = "B runs from -pi/2 to pi/2" if ends else f"which is {said}"
    raise KinematicsError(
        f"Pose, {declared.name}: found {angle:g} rad; {least}. If {angle:g}° is meant, give np.radians({angle:g}); "
        f"if {said} is, give {'A turned by pi, and B as pi less that' if ends else 'it from degrees, by np.radians'}.",
        where=declared.name,
    )


@asked
def world_from_pose(T_MT: ArrayLike) -> FloatArray:
    """World coordinates of poses, the inverse of ``pose_from_world``; the spin about the tool axis is not part of them.

    Parameters
    ----------
    T_MT : array_like, (..., 4, 4)
        Poses of {T} in {M}, m.

    Returns
    -------
    ndarray, (..., 5)
        X, Y, Z in m and A, B in rad. B is in [-pi/2, pi/2]; where the tool axis lies along X_M (B = +-pi/2) any A will
        do and A = 0 is given.

    Raises
    ------
    KinematicsError
        Where T_MT is not finite, not of that shape, or no pose: a rotation and a shift.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.world_from_pose(rm.pose_from_world([0.1, -1.2, 0.05, 0.0, 0.25])).tolist()
    [0.1, -1.2, 0.05, -0.0, 0.25]
    """
    T_MT = poses(T_MT)
    return np.concatenate([T_MT[..., :3, 3], tilt_from_axis(T_MT[..., :3, 2])], axis=-1)


def poses(T_MT: ArrayLike) -> FloatArray:
    """Poses (..., 4, 4) as a person gives them. Raises KinematicsError for what is none: no rotation, or no shift."""
    from robomill.kinematics import kernels

    T = as_floats(T_MT, "T_MT", (4, 4), error=KinematicsError)
    flat = np.ascontiguousarray(T.reshape(-1, 4, 4))
    off = np.empty(len(flat))
    kernels.off_rigid_of(flat, off)
    if off.max(initial=0.0) > UNIT:
        raise KinematicsError(
            "T_MT: this is no pose; expected three unit axes that are square and right-handed, beside them the place, "
            "and 0 0 0 1 as the last row."
        )
    return T


def tilt_from_axis(k: ArrayLike) -> FloatArray:
    """(A, B) rad, (..., 2), of unit tool axes k (..., 3)."""
    k = as_floats(k, "k", (3,), error=KinematicsError)
    across = np.hypot(k[..., 1], k[..., 2])
    A = np.where(across > 1e-12, np.arctan2(-k[..., 1], k[..., 2]), 0.0)
    return np.stack([A, np.arctan2(k[..., 0], across)], axis=-1)


def rotation_from_turns(turns: ArrayLike) -> FloatArray:
    """R_x(A) R_y(B) R_z(C) (..., 3, 3) of angles (A, B, C) (..., 3) rad: about x, the new y, the new z."""
    A, B, C = np.moveaxis(as_floats(turns, "turns", (3,), error=KinematicsError), -1, 0)
    R = rotation_x(A) @ rotation_y(B) @ rotation_z(C)
    return np.where(np.abs(R) < 1e-16, 0.0, R)


def turns_from_rotation(R: ArrayLike) -> FloatArray:
    """(A, B, C) rad (..., 3) that ``rotation_from_turns`` leads back to R (..., 3, 3).

    B is in [-pi/2, pi/2]; at its ends any A will do and A = 0 is given.
    """
    R = as_floats(R, "R", (3, 3), error=KinematicsError)
    tilt = tilt_from_axis(R[..., 2])
    Q = rotation_x(-tilt[..., 0]) @ R
    C = np.arctan2(Q[..., 1, 0], Q[..., 1, 1])
    return np.concatenate([tilt, C[..., None]], axis=-1)
