"""The paper's arm with its tool vertical, by plane geometry: no Denavit-Hartenberg table, no Jacobian, no solver.

With A = B = 0 the arm stays in the vertical plane through the tip. In it: shoulder at the origin, elbow a_2 from it,
wrist d_4 from the elbow, tip a_5 below the wrist. A joint that yields by one moves the tip by (axis) x (lever).
Directions: r outwards in the plane, t across it, z up.
"""

from __future__ import annotations

import numpy as np

A_2, D_4, A_5 = 1.22, 1.1, 0.3  # m, assumed


def columns(X, Y, Z):
    """(..., 6, 5) motion of the tip (r, t, z, then turns about r, t, z) as each joint yields by one."""
    X, Y, Z = np.broadcast_arrays(*(np.asarray(v, dtype=float) for v in (X, Y, Z)))
    r, wrist = np.hypot(X, Y), Z + A_5
    reach = np.hypot(r, wrist)
    rise = np.arctan2(wrist, r) + np.arccos((A_2**2 + reach**2 - D_4**2) / (2 * A_2 * reach))
    elbow_r, elbow_z = A_2 * np.cos(rise), A_2 * np.sin(rise)
    forearm_r, forearm_z = (r - elbow_r) / D_4, (wrist - elbow_z) / D_4
    one, nil = np.ones_like(r), np.zeros_like(r)
    each = [
        [nil, r, nil, nil, nil, one],  # about z, from the base
        [-Z, nil, r, nil, -one, nil],  # about -t, from the shoulder: r towards z
        [-(Z - elbow_z), nil, r - elbow_r, nil, -one, nil],  # the same, from the elbow
        [nil, A_5 * forearm_r, nil, forearm_r, nil, forearm_z],  # about the forearm, from the wrist
        [A_5 * one, nil, nil, nil, -one, nil],  # about -t, from the wrist: the tip below it goes outwards
    ]
    return np.stack([np.stack(parts, axis=-1) for parts in each], axis=-1)


def shares(X, Y, Z, C_theta):
    """(..., 5, 3, 3) m/N in {M}: what each joint adds to C."""
    X, Y, Z = np.broadcast_arrays(*(np.asarray(v, dtype=float) for v in (X, Y, Z)))
    length = np.hypot(X, Y)
    nil, one = np.zeros_like(length), np.ones_like(length)
    R = np.stack([X / length, Y / length, nil, -Y / length, X / length, nil, nil, nil, one], axis=-1)
    R = np.swapaxes(R.reshape(*length.shape, 3, 3), -1, -2)  # columns: r, t, z in {M}
    J_v = R @ columns(X, Y, Z)[..., :3, :]
    return np.einsum("...ik,k,...jk->...kij", J_v, C_theta, J_v)


def determinant(X, Y, Z):
    """|det J| (...) m^3 of the rows v_r, v_t, v_z and the turns across the vertical tool."""
    return np.abs(np.linalg.det(columns(X, Y, Z)[..., :5, :]))


def slot_force(Ktc, Kte, c=0.05e-3, a=2e-3, N=3):
    """Mean feed-normal force (N) on a slotting cutter, the edge summed up tooth position by tooth position."""
    phi = (np.arange(20000) + 0.5) * np.pi / 20000  # an immersed tooth; N/2 of them at any time
    return N / 2 * np.mean(a * (Ktc * c * np.sin(phi) + Kte) * np.sin(phi))  # radial forces cancel over the slot
