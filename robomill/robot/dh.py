"""Denavit-Hartenberg tables as a chain of constant transforms between joints.

Both conventions become the same chain (standard: eq. (4) of Slavkovic et al. 2013; modified: Craig):

    T_MT = T_0 @ prod_i [ M_i(q_i) @ E_i ],    q_i = sign_i * theta_i + offset_i

where ``M_i`` turns about (revolute) or slides along (prismatic) the z axis of its frame. Blocked joints and the
tool frame are folded into the constants, so a chain has one entry a *free* joint.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from robomill.arrays import FloatArray, frozen
from robomill.compiled import In1, In2, In3, InBool1


class Chain(NamedTuple):
    """A serial arm as constants: what forward kinematics and the Jacobian need, and nothing else.

    T_0 (4, 4); E (n, 4, 4), the last one includes the tool frame; sign (n,) of +-1; offset (n,) rad (m where
    prismatic); prismatic (n,) bool. n counts the free joints.
    """

    T_0: In2
    E: In3
    sign: In1
    offset: In1
    prismatic: InBool1

    @property
    def n(self) -> int:
        return len(self.sign)


def exact_cos_sin(angle: float) -> tuple[float, float]:
    """cos and sin, exact at multiples of a right angle (cos of 90 degrees is 0, not 6e-17)."""
    quarter = angle / (np.pi / 2)
    if abs(quarter - round(quarter)) < 1e-15 * max(1.0, abs(quarter)):
        k = round(quarter) % 4
        return (1.0, 0.0, -1.0, 0.0)[k], (0.0, 1.0, 0.0, -1.0)[k]
    return float(np.cos(angle)), float(np.sin(angle))


def screw_x(alpha: float, a: float) -> FloatArray:
    """Rot(x, alpha) Trans(a, 0, 0), (4, 4)."""
    c, s = exact_cos_sin(alpha)
    return np.array([[1.0, 0.0, 0.0, a], [0.0, c, -s, 0.0], [0.0, s, c, 0.0], [0.0, 0.0, 0.0, 1.0]])


def screw_z(theta: float, d: float) -> FloatArray:
    """Rot(z, theta) Trans(0, 0, d), (4, 4)."""
    c, s = exact_cos_sin(theta)
    return np.array([[c, -s, 0.0, 0.0], [s, c, 0.0, 0.0], [0.0, 0.0, 1.0, d], [0.0, 0.0, 0.0, 1.0]])


class Row(NamedTuple):
    """A joint's row of the table; ``blocked`` is NaN where it is free, else the coordinate it is held at."""

    alpha: float
    a: float
    d: float
    theta_offset: float
    sign: float
    prismatic: bool
    blocked: float

    @property
    def offset(self) -> float:
        """What its own coordinate begins at: d of a prismatic, the angle of a revolute."""
        return self.d if self.prismatic else self.theta_offset

    @property
    def still(self) -> FloatArray:
        """The part of the joint's own screw that does not move: d of a revolute, the angle of a prismatic."""
        return screw_z(self.theta_offset, 0.0) if self.prismatic else screw_z(0.0, self.d)

    @property
    def held(self) -> FloatArray:
        """The part that would move, where it is held."""
        q = self.sign * self.blocked + self.offset
        return screw_z(0.0, q) if self.prismatic else screw_z(q, 0.0)


def build_chain(convention: str, rows: Sequence[Row], T_base: FloatArray, T_tool: FloatArray) -> Chain:
    """The chain of a D-H table."""
    links = [screw_x(row.alpha, row.a) for row in rows]
    standard = convention == "standard"
    T_0 = np.array(T_base) if standard else T_base @ links[0]
    between: list[FloatArray] = []
    free: list[Row] = []
    for i, row in enumerate(rows):
        E = row.still
        if standard:
            E = E @ links[i]
        elif i + 1 < len(rows):
            E = E @ links[i + 1]
        if i == len(rows) - 1:
            E = E @ T_tool
        if np.isnan(row.blocked):
            free.append(row)
            between.append(E)
        elif between:
            between[-1] = between[-1] @ (row.held @ E)
        else:
            T_0 = T_0 @ (row.held @ E)
    sign, offset = (frozen([getattr(row, name) for row in free]) for name in ("sign", "offset"))
    return Chain(frozen(T_0), frozen(np.array(between)), sign, offset, frozen([row.prismatic for row in free], bool))
