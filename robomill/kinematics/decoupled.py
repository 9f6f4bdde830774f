"""Arms whose inverse kinematics is closed: a shoulder and elbow that place the wrist centre, a wrist that turns.

Recognised from the joint axes at theta = 0, so that convention, base, offsets and signs do not matter: axes 2 and 3
parallel, axis 1 square to them, axes 4, 5 (and 6) through one point, axes 4 and 5 square to each other. Shoulder and
elbow offsets are free. With five axes the tip must lie on the tool axis through the wrist centre, because only the tool
axis is commanded.

Every solution is found in the arm's own frame {S}: z along axis 1, y along axis 2, origin on axis 1 at the height of
axis 2. A rotation about y by phi turns the complex number x - i z by exp(i phi), which makes shoulder and elbow two
divisions.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from robomill.arrays import BoolArray, FloatArray, frozen
from robomill.kinematics.forward import joint_frames
from robomill.robot.model import Robot

SQUARE = 1e-9  # rad: how square or parallel axes must be
CROSSING = 1e-9  # m: how close axes must pass to count as crossing
ROUNDING = 1e-12  # how far below zero a square may come out and still be zero
SIDES = np.array([1.0, -1.0])


@dataclass(frozen=True, eq=False)
class Decoupled:
    """Constants of a decoupled arm. Lengths in m.

    S (3, 3) rows are the axes of {S} in {M}, origin (3,) its origin; a_1 shoulder offset, h lateral offset; l_2, l_3
    the two links as (re, im) of x - i z at theta = 0; W (3, 3) rows are the wrist's axes in {S} (y along axis 5, z
    along axis 4); u (3,) the direction the wrist must place, in wrist axes at theta = 0; in {T}: that direction c_u,
    its normal c_g (six axes), and the shift c_w from the wrist centre to the tip; g, gn (3,) the normal and u x g in
    wrist axes; direction (n,) turns the angles about S's and W's axes into theta.
    """

    n: int
    S: FloatArray
    origin: FloatArray
    a_1: float
    h: float
    l_2: FloatArray
    l_3: FloatArray
    W: FloatArray
    u: FloatArray
    g: FloatArray
    gn: FloatArray
    c_u: FloatArray
    c_g: FloatArray
    c_w: FloatArray
    direction: FloatArray

    @cached_property
    def packed(self) -> FloatArray:
        """All constants in one row, in the order the compiled kernel reads them."""
        parts = (
            self.S.ravel(),
            self.W.ravel(),
            self.origin,
            [self.a_1, self.h],
            self.l_2,
            self.l_3,
            self.u,
            self.g,
            self.gn,
            self.c_u,
            self.c_g,
            self.c_w,
            self.direction,
        )
        return frozen(np.concatenate(parts))

    @property
    def spindle_on_last_axis(self) -> bool:
        """True where the tool axis is axis 6 itself: the spin about the tool is joint 6 and moves nothing else."""
        along = abs(abs(self.c_u[2]) - 1.0) < SQUARE
        return self.n == 6 and along and bool(np.hypot(self.c_w[0], self.c_w[1]) < CROSSING)


@lru_cache(maxsize=64)
def decoupled(robot: Robot) -> Decoupled | None:
    """The closed-form structure of ``robot``, or None where it has none."""
    if robot.n not in (5, 6) or robot.chain.prismatic.any():
        return None
    frames = joint_frames(robot, np.zeros(robot.n))
    k, p = frames[:-1, :3, 2], frames[:-1, :3, 3]
    T_MT = frames[-1]
    if abs(k[0] @ k[1]) > SQUARE or np.linalg.norm(np.cross(k[1], k[2])) > SQUARE or abs(k[3] @ k[4]) > SQUARE:
        return None
    centre = _crossing(p[3], k[3], p[4], k[4])
    if centre is None:
        return None
    R, tip = T_MT[:3, :3], T_MT[:3, 3]
    c_w = R.T @ (tip - centre)
    if robot.n == 5:
        c_u = np.array([0.0, 0.0, 1.0])
        if np.hypot(c_w[0], c_w[1]) > CROSSING:
            return None
        c_w = np.array([0.0, 0.0, c_w[2]])
    else:
        if np.linalg.norm(np.cross(centre - p[5], k[5])) > CROSSING:
            return None
        c_u = R.T @ k[5]
    return _constants(robot, k, p, centre, R, c_u, c_w)


def _crossing(p: FloatArray, k: FloatArray, q: FloatArray, m: FloatArray) -> FloatArray | None:
    """The point where two lines cross, or None."""
    normal = np.cross(k, m)
    size = normal @ normal
    if size < SQUARE or abs((q - p) @ normal) > CROSSING * np.sqrt(size):
        return None
    return p + k * (np.cross(q - p, m) @ normal) / size


def _constants(
    robot: Robot, k: FloatArray, p: FloatArray, centre: FloatArray, R: FloatArray, c_u: FloatArray, c_w: FloatArray
) -> Decoupled | None:
    z = k[0] if k[0][np.argmax(np.abs(k[0]))] > 0 else -k[0]
    home = joint_frames(robot, robot.home)
    y_home = home[1, :3, 2]
    reach = home[-1, :3, 3] - home[-1, :3, :3] @ c_w - p[0]
    # Front is the side on which the wrist centre stands at the home configuration.
    y = k[1] if np.cross(y_home, z) @ reach >= 0 else -k[1]
    S = np.array([np.cross(y, z), y, z])
    origin = p[0] + z * (z @ (p[1] - p[0]))
    shoulder, elbow, wrist = S @ (p[1] - origin), S @ (p[2] - origin), S @ (centre - origin)
    l_2 = np.array([elbow[0] - shoulder[0], -(elbow[2] - shoulder[2])])
    l_3 = np.array([wrist[0] - elbow[0], -(wrist[2] - elbow[2])])
    if np.hypot(*l_2) < CROSSING or np.hypot(*l_3) < CROSSING:
        return None
    W = np.array([np.cross(k[4], k[3]), k[4], k[3]]) @ S.T
    u = W @ S @ R @ c_u
    # Wrist + is the one that stands at the home configuration (a little past it, where home is a singular wrist).
    bent = robot.chain.sign[4] * (robot.home[4] + 1e-3)
    flip = -1.0 if u[0] * np.cos(bent) + u[2] * np.sin(bent) < 0 else 1.0
    W, u = W * [[flip], [flip], [1.0]], u * [flip, flip, 1.0]
    if np.hypot(u[0], u[2]) < SQUARE:
        return None
    across = np.eye(3)[np.argmin(np.abs(u))]
    g = np.cross(u, across)
    g /= np.linalg.norm(g)
    sign = robot.chain.sign
    axis_sign = np.array([k[0] @ z, k[1] @ y, k[2] @ y, 1.0, flip, 1.0])[: robot.n]
    return Decoupled(
        n=robot.n,
        S=frozen(S),
        origin=frozen(origin),
        a_1=float(shoulder[0]),
        h=float(wrist[1]),
        l_2=frozen(l_2),
        l_3=frozen(l_3),
        W=frozen(W),
        u=frozen(u),
        g=frozen(g),
        gn=frozen(np.cross(u, g)),
        c_u=frozen(c_u),
        c_g=frozen(R.T @ S.T @ W.T @ g),
        c_w=frozen(c_w),
        direction=frozen(np.sign(axis_sign) * sign),
    )


# ---- the eight solutions, on columns -------------------------------------------------------------------------------


def unit(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(x, y) / hypot(x, y), and (1, 0) at the origin."""
    size = np.sqrt(x * x + y * y)
    some = size > 1e-150
    scale = 1.0 / np.where(some, size, 1.0)
    return np.where(some, x * scale, 1.0), y * scale


def solution_columns(arm: Decoupled, T_MT: FloatArray) -> tuple[FloatArray, BoolArray]:
    """(theta (m, 8, n), possible (m, 8)) of poses T_MT (m, 4, 4): shoulder x elbow x wrist, in (-pi, pi].

    Where the geometry has no solution the nearest attempt is given and ``possible`` is False; a check by forward
    kinematics has the last word.
    """
    R = T_MT[:, :3, :3]
    p_S = arm.S @ ((T_MT[:, :3, 3] - R @ arm.c_w) - arm.origin).T
    side = SIDES[:, None]
    # Shoulder (2, m): axis 1 turns the arm's plane through the wrist centre.
    rho2 = p_S[0] ** 2 + p_S[1] ** 2
    under = rho2 - arm.h**2
    x = side * np.sqrt(np.maximum(under, 0.0))
    c_1, s_1 = unit(p_S[0] * x + p_S[1] * arm.h, p_S[1] * x - p_S[0] * arm.h)
    # Elbow (2, 2, m): two links in the plane.
    L_2, L_3 = np.hypot(*arm.l_2), np.hypot(*arm.l_3)
    r_x, r_z = x - arm.a_1, p_S[2]
    cos_g = (r_x**2 + r_z**2 - L_2**2 - L_3**2) / (2 * L_2 * L_3)
    placed = (under >= -ROUNDING) & (np.abs(cos_g) <= 1.0 + ROUNDING)
    cos_g = np.clip(cos_g, -1.0, 1.0)
    sin_g = SIDES[None, :, None] * (side * np.sqrt((1.0 - cos_g) * (1.0 + cos_g)))[:, None]
    cos_g = cos_g[:, None]
    bend = complex(*arm.l_2) * complex(*arm.l_3).conjugate() / (L_2 * L_3)
    c_3, s_3 = bend.real * cos_g - bend.imag * sin_g, bend.real * sin_g + bend.imag * cos_g
    m_re = arm.l_2[0] + arm.l_3[0] * c_3 - arm.l_3[1] * s_3
    m_im = arm.l_2[1] + arm.l_3[0] * s_3 + arm.l_3[1] * c_3
    r_x = r_x[:, None]
    c_2, s_2 = unit(r_x * m_re - r_z * m_im, -r_z * m_re - r_x * m_im)
    # Wrist (2, 2, 2, m): the direction u must come to v.
    turn = (c_1[:, None], s_1[:, None], c_2 * c_3 - s_2 * s_3, s_2 * c_3 + c_2 * s_3)
    v = _into_wrist(arm, turn, arm.S @ (R @ arm.c_u).T)
    under = v[0] ** 2 + v[1] ** 2 - arm.u[1] ** 2
    possible = np.broadcast_to((placed[:, None] & (under >= -ROUNDING))[:, :, None], (2, 2, 2, len(T_MT)))
    x_w = SIDES[:, None] * np.sqrt(np.maximum(under, 0.0))[:, :, None]
    v = [component[:, :, None] for component in v]
    c_5, s_5 = unit(v[2] * arm.u[2] + x_w * arm.u[0], x_w * arm.u[2] - v[2] * arm.u[0])
    c_4, s_4 = unit(v[0] * x_w + v[1] * arm.u[1], v[1] * x_w - v[0] * arm.u[1])
    shape = c_5.shape
    theta = np.empty((*shape[:3], arm.n, shape[3]))
    theta[..., 0, :] = np.arctan2(s_1, c_1)[:, None, None]
    theta[..., 1, :] = np.arctan2(s_2, c_2)[:, :, None]
    theta[..., 2, :] = np.arctan2(s_3, c_3)[:, :, None]
    theta[..., 3, :] = np.arctan2(s_4, c_4)
    theta[..., 4, :] = np.arctan2(s_5, c_5)
    if arm.n == 6:
        g = [component[:, :, None] for component in _into_wrist(arm, turn, arm.S @ (R @ arm.c_g).T)]
        g_x, g_y = c_4 * g[0] + s_4 * g[1], c_4 * g[1] - s_4 * g[0]
        g_x, g_z = c_5 * g_x - s_5 * g[2], s_5 * g_x + c_5 * g[2]
        across = g_x * arm.gn[0] + g_y * arm.gn[1] + g_z * arm.gn[2]
        theta[..., 5, :] = np.arctan2(across, g_x * arm.g[0] + g_y * arm.g[1] + g_z * arm.g[2])
    theta *= arm.direction[:, None]
    return theta.reshape(8, arm.n, -1).transpose(2, 0, 1), possible.reshape(8, -1).T


def _into_wrist(arm: Decoupled, turn: tuple[FloatArray, ...], d: FloatArray) -> list[FloatArray]:
    """Directions d (3, m) in {S} seen from the wrist before it turns, three (2, 2, m)."""
    c_1, s_1, c, s = turn
    x, y = c_1 * d[0] + s_1 * d[1], c_1 * d[1] - s_1 * d[0]
    x, z = c * x - s * d[2], s * x + c * d[2]
    return [row[0] * x + row[1] * y + row[2] * z for row in arm.W]


def branch_names() -> tuple[str, ...]:
    """Names of the eight solutions in the order of ``solutions``.

    Front: the wrist centre on the side it has at the home configuration; elbow up: elbow above the line from shoulder
    to wrist centre (towards the positive sense of axis 1's direction).
    """
    return tuple(
        f"{shoulder}, elbow {elbow}, wrist {wrist}"
        for shoulder in ("front", "back")
        for elbow in ("up", "down")
        for wrist in ("+", "-")
    )


def shortfall(arm: Decoupled, T_MT: FloatArray) -> str:
    """Why no solution exists for one pose (4, 4) even without joint limits, in words; "" if that is not the reason."""
    R = T_MT[:3, :3]
    p = arm.S @ (T_MT[:3, 3] - R @ arm.c_w - arm.origin)
    rho = float(np.hypot(p[0], p[1]))
    if rho < abs(arm.h):
        return f"{abs(arm.h) - rho:.2g} m inside the arm's lateral offset, too close to axis 1"
    L_2, L_3 = float(np.hypot(*arm.l_2)), float(np.hypot(*arm.l_3))
    x = np.sqrt(max(rho**2 - arm.h**2, 0.0))
    reach = [float(np.hypot(side * x - arm.a_1, p[2])) for side in (1.0, -1.0)]
    beyond, inside = min(reach) - (L_2 + L_3), abs(L_2 - L_3) - max(reach)
    if beyond > 0:
        return f"{_metres(beyond)} beyond reach"
    if inside > 0:
        return f"{_metres(inside)} too close to the shoulder"
    return ""


def _metres(value: float) -> str:
    return f"{value:.2f} m" if value >= 0.01 else f"{value * 1e3:.2g} mm"
