"""Compiled forward kinematics and Jacobian, LANES configurations at a time.

Every step is a loop over lanes of straight-line arithmetic on the rows of small buffers, updated in place, so that the
compiler can prove the rows apart and use vector instructions. The NumPy columns of ``forward`` and ``jacobian`` are the
same formulas, and a test holds the two together. Import only through ``compiled``.

numba's cache looks at the file a kernel stands in, not at those it takes helpers from: after a change here or in
``kernel_math``, clear the caches of the other kernel modules (``__pycache__/*.nb?``) too.
"""

# mypy: disable-error-code="no-untyped-def, attr-defined, call-overload"
# numba types these functions by their signatures; Python's annotations would say nothing more.
from __future__ import annotations

import numpy as np
from numba import njit
from numba.types import Array, boolean, float64, int64, void

from robomill.kinematics.kernel_math import INLINE, sin_cos

LANES = 64
OPTIONS = {"cache": True, "nogil": True, "error_model": "numpy", "fastmath": {"contract"}}

# Signatures are spelled out, so that importing this module compiles (or reads the cache) and calling never does.
IN1, IN2, IN3 = (Array(float64, dims, "C", readonly=True) for dims in (1, 2, 3))
OUT1, OUT2, OUT3 = (Array(float64, dims, "C") for dims in (1, 2, 3))
IN_FLAGS = Array(boolean, 1, "C", readonly=True)
INDEX = Array(int64, 1, "C")
FLAGS, FLAGS2 = Array(boolean, 1, "C"), Array(boolean, 2, "C")
CHAIN = (IN2, IN3, IN1, IN1, IN_FLAGS)

# Rows of the tool's buffer: R row-major 0-8, p 9-11, then sine, cosine and shift of the joint at hand.
TOOL_ROWS = 15


@njit(**INLINE)
def chain_block(tool, theta, first, axes, n, T_0, E, sign, offset, prismatic):
    """Run the chain over rows first .. first + n of theta: fills tool (15, LANES) and axes (6 n, LANES).

    axes holds, for each joint, its axis z (3 rows) and a point on it (3 rows), before the joint moves.
    """
    for r in range(3):
        for lane in range(LANES):
            tool[3 * r, lane] = T_0[r, 0]
            tool[3 * r + 1, lane] = T_0[r, 1]
            tool[3 * r + 2, lane] = T_0[r, 2]
            tool[9 + r, lane] = T_0[r, 3]
    for i in range(n):
        s_i, o_i = sign[i], offset[i]
        e00, e01, e02, e03 = E[i, 0, 0], E[i, 0, 1], E[i, 0, 2], E[i, 0, 3]
        e10, e11, e12, e13 = E[i, 1, 0], E[i, 1, 1], E[i, 1, 2], E[i, 1, 3]
        e20, e21, e22, e23 = E[i, 2, 0], E[i, 2, 1], E[i, 2, 2], E[i, 2, 3]
        slide = 1.0 if prismatic[i] else 0.0
        turn = 1.0 - slide
        for r in range(3):
            for lane in range(LANES):
                axes[6 * i + r, lane] = tool[3 * r + 2, lane]
                axes[6 * i + 3 + r, lane] = tool[9 + r, lane]
        for lane in range(LANES):
            q = s_i * theta[first + i, lane] + o_i
            s, c = sin_cos(turn * q)
            tool[12, lane] = s
            tool[13, lane] = c
            tool[14, lane] = e23 + slide * q
        for lane in range(LANES):
            s, c, c23 = tool[12, lane], tool[13, lane], tool[14, lane]
            c00, c01, c02, c03 = c * e00 - s * e10, c * e01 - s * e11, c * e02 - s * e12, c * e03 - s * e13
            c10, c11, c12, c13 = s * e00 + c * e10, s * e01 + c * e11, s * e02 + c * e12, s * e03 + c * e13
            x, y, z = tool[0, lane], tool[1, lane], tool[2, lane]
            tool[0, lane] = x * c00 + y * c10 + z * e20
            tool[1, lane] = x * c01 + y * c11 + z * e21
            tool[2, lane] = x * c02 + y * c12 + z * e22
            tool[9, lane] = x * c03 + y * c13 + z * c23 + tool[9, lane]
            x, y, z = tool[3, lane], tool[4, lane], tool[5, lane]
            tool[3, lane] = x * c00 + y * c10 + z * e20
            tool[4, lane] = x * c01 + y * c11 + z * e21
            tool[5, lane] = x * c02 + y * c12 + z * e22
            tool[10, lane] = x * c03 + y * c13 + z * c23 + tool[10, lane]
            x, y, z = tool[6, lane], tool[7, lane], tool[8, lane]
            tool[6, lane] = x * c00 + y * c10 + z * e20
            tool[7, lane] = x * c01 + y * c11 + z * e21
            tool[8, lane] = x * c02 + y * c12 + z * e22
            tool[11, lane] = x * c03 + y * c13 + z * c23 + tool[11, lane]


@njit(**INLINE)
def jacobian_block(tool, axes, n, sign, prismatic, J):
    """J (6 n, LANES), six rows a joint, from the buffers of ``chain_block``."""
    for i in range(n):
        k = 6 * i
        s = sign[i]
        slide = 1.0 if prismatic[i] else 0.0
        turn = 1.0 - slide
        for lane in range(LANES):
            zx, zy, zz = s * axes[k, lane], s * axes[k + 1, lane], s * axes[k + 2, lane]
            rx = tool[9, lane] - axes[k + 3, lane]
            ry = tool[10, lane] - axes[k + 4, lane]
            rz = tool[11, lane] - axes[k + 5, lane]
            J[k, lane] = slide * zx + turn * (zy * rz - zz * ry)
            J[k + 1, lane] = slide * zy + turn * (zz * rx - zx * rz)
            J[k + 2, lane] = slide * zz + turn * (zx * ry - zy * rx)
            J[k + 3, lane] = turn * zx
            J[k + 4, lane] = turn * zy
            J[k + 5, lane] = turn * zz


@njit(**INLINE)
def load_rows(theta, start, count, block):
    """Rows start .. start + count of theta (m, n) into block (n, LANES); spare lanes repeat the last row."""
    for lane in range(LANES):
        row = start + min(lane, count - 1)
        for i in range(theta.shape[1]):
            block[i, lane] = theta[row, i]


@njit(**INLINE)
def store_pose(tool, start, count, T_MT):
    """The tool buffer into T_MT[start : start + count]."""
    for lane in range(count):
        for r in range(3):
            T_MT[start + lane, r, 0] = tool[3 * r, lane]
            T_MT[start + lane, r, 1] = tool[3 * r + 1, lane]
            T_MT[start + lane, r, 2] = tool[3 * r + 2, lane]
            T_MT[start + lane, r, 3] = tool[9 + r, lane]
            T_MT[start + lane, 3, r] = 0.0
        T_MT[start + lane, 3, 3] = 1.0


@njit(void(IN2, *CHAIN, OUT3), **OPTIONS)
def forward(theta, T_0, E, sign, offset, prismatic, T_MT):
    """T_MT (m, 4, 4) of theta (m, n)."""
    m, n = theta.shape
    block, tool, axes = np.empty((n, LANES)), np.empty((TOOL_ROWS, LANES)), np.empty((6 * n, LANES))
    for start in range(0, m, LANES):
        count = min(LANES, m - start)
        load_rows(theta, start, count, block)
        chain_block(tool, block, 0, axes, n, T_0, E, sign, offset, prismatic)
        store_pose(tool, start, count, T_MT)


@njit(void(IN2, *CHAIN, IN1, OUT3, OUT3, OUT3), **OPTIONS)
def forward_jacobian(theta, T_0, E, sign, offset, prismatic, weight, T_MT, J_out, G_out):
    """T_MT (m, 4, 4), J (m, 6, n) and, where G (m, 3, 3) has rows, G = J_v diag(weight) J_v^T of theta (m, n)."""
    m, n = theta.shape
    block, tool, axes = np.empty((n, LANES)), np.empty((TOOL_ROWS, LANES)), np.empty((6 * n, LANES))
    J, G = np.empty((6 * n, LANES)), np.empty((6, LANES))
    for start in range(0, m, LANES):
        count = min(LANES, m - start)
        load_rows(theta, start, count, block)
        chain_block(tool, block, 0, axes, n, T_0, E, sign, offset, prismatic)
        jacobian_block(tool, axes, n, sign, prismatic, J)
        store_pose(tool, start, count, T_MT)
        for lane in range(count):
            for r in range(6):
                for i in range(n):
                    J_out[start + lane, r, i] = J[6 * i + r, lane]
        if G_out.shape[0] == 0:
            continue
        G[:] = 0.0
        for i in range(n):
            k, w = 6 * i, weight[i]
            for lane in range(LANES):
                a, b, c = J[k, lane], J[k + 1, lane], J[k + 2, lane]
                G[0, lane] += w * a * a
                G[1, lane] += w * b * b
                G[2, lane] += w * c * c
                G[3, lane] += w * a * b
                G[4, lane] += w * a * c
                G[5, lane] += w * b * c
        for lane in range(count):
            row = start + lane
            G_out[row, 0, 0] = G[0, lane]
            G_out[row, 0, 1] = G[3, lane]
            G_out[row, 0, 2] = G[4, lane]
            G_out[row, 1, 0] = G[3, lane]
            G_out[row, 1, 1] = G[1, lane]
            G_out[row, 1, 2] = G[5, lane]
            G_out[row, 2, 0] = G[4, lane]
            G_out[row, 2, 1] = G[5, lane]
            G_out[row, 2, 2] = G[2, lane]
