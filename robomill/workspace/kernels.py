"""What a map holds at each configuration, compiled: Jacobian, joint shares of the compliance, determinant."""

# mypy: disable-error-code="no-untyped-def"
# Parts are typed by whoever calls them.
from __future__ import annotations

import numpy as np

from robomill.compiled import In1, In2, kernel, part
from robomill.compliance.components import COLUMN, ROW
from robomill.kinematics.kernels import determinant, forward, jacobian, share
from robomill.robot.dh import Chain
from robomill.workspace.laws import Laws


@part
def parts_of_compliance(J, C_theta, shares):
    """shares (n, 6): each joint's part C_theta,i J_i J_i^T of C_xx, C_yy, C_zz, C_xy, C_xz, C_yz. Eqs. (13), (14)."""
    for i in range(len(C_theta)):
        for e in range(6):
            shares[i, e] = share(C_theta[i], J, i, ROW[e], COLUMN[e])


@kernel
def evaluate(theta: In2, chain: Chain, C_theta: In1, task: In2, laws: Laws) -> None:
    """The laws at theta (m, n), NaN where theta is; task (k, 6) takes the task Jacobian's rows out of the six of J."""
    k, n = len(task), len(chain.sign)
    turns = np.empty((n, 3))
    frames, A, AAt = np.empty((n + 1, 4, 4)), np.empty((k, n)), np.empty((k, k))
    for i in range(len(theta)):
        if np.isnan(theta[i, 0]):  # the first axes stand still whatever theta is
            laws.J[i] = laws.shares[i] = laws.det_J[i] = np.nan
            continue
        J = laws.J[i]
        forward(theta[i], chain, turns, frames)
        jacobian(frames, chain, J)
        parts_of_compliance(J, C_theta, laws.shares[i])
        for r in range(k):
            for j in range(n):
                A[r, j] = 0.0
                for c in range(6):
                    A[r, j] += task[r, c] * J[c, j]
        laws.det_J[i] = determinant(A, AAt)
