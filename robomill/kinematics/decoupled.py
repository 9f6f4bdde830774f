"""Arms whose inverse kinematics is closed: a shoulder and elbow that place the wrist centre, a wrist that turns.

Recognised from the joint axes at theta = 0, so that convention, base, offsets and signs do not matter: axes 2 and 3
parallel, axis 1 square to them, axes 4, 5 (and 6) through one point, axes 4 and 5 square to each other. Shoulder and
elbow offsets are free. With five axes the tip must lie on the tool axis through the wrist centre, because only the tool
axis is commanded.

The solutions are found in ``inverse_kernels``, in the arm's own frame {S}: z along axis 1, y along axis 2, origin on
axis 1 at the height of axis 2.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from robomill.arrays import FloatArray, frozen
from robomill.compiled import In1, In2, InBool1, Out2, OutInt1
from robomill.kinematics.forward import joint_frames
from robomill.robot.model import Robot
from robomill.units import format_si, format_significant, from_si

SQUARE = 1e-9  # rad: how square or parallel axes must be
CROSSING = 1e-9  # m: how close axes must pass to count as crossing
ROUNDING = 1e-12  # how far below zero a square may come out and still be zero
RESIDUAL = 1e-9  # m and rad: an answer further off than this is not an answer
LIMIT_SLACK = 1e-10  # rad or m past a limit that is still rounding


Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]


class Decoupled(NamedTuple):
    """Constants of a decoupled arm, as the kernels take them. Lengths in m.

    S (3, 3) rows are the axes of {S} in {M}, origin (3,) its origin; a_1 shoulder offset, h lateral offset; l_2, l_3
    the two links as x - i z at theta = 0; W (3, 3) rows are the wrist's axes in {S} (y along axis 5, z along axis 4);
    u (3,) the direction the wrist must place, in wrist axes at theta = 0; in {T}: that direction c_u, its normal c_g
    (six axes), and the shift c_w from the wrist centre to the tip; g, gn (3,) the normal and u x g in wrist axes;
    direction (n,) turns the angles about S's and W's axes into theta.
    """

    S: Matrix
    origin: Vector
    a_1: float
    h: float
    l_2: complex
    l_3: complex
    W: Matrix
    u: Vector
    g: Vector
    gn: Vector
    c_u: Vector
    c_g: Vector
    c_w: Vector
    direction: In1

    @property
    def n(self) -> int:
        """Five or six axes."""
        return len(self.direction)

    @property
    def spindle_on_last_axis(self) -> bool:
        """True where the tool axis is axis 6 itself: the spin about the tool is joint 6 and moves nothing else."""
        along = abs(abs(self.c_u[2]) - 1.0) < SQUARE
        return self.n == 6 and along and bool(np.hypot(self.c_w[0], self.c_w[1]) < CROSSING)


class Rules(NamedTuple):
    """Which of the solutions to take: limits (n, 2), wanted (8,) branches, shoulder and elbow as at home before all
    motion, how many spins about the tool axis to try (0: the pose as given), whether axis 6 is held at its goal, and
    whether the residual is that of the whole rotation."""

    limits: In2
    wanted: InBool1
    arm_first: bool
    spins: int
    held: bool
    whole: bool


class Answer(NamedTuple):
    """theta (m, n), branch (m,), -1 where none is within limits, and fit (m, 3): spin rad, residuals m and rad."""

    theta: Out2
    branch: OutInt1
    fit: Out2


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
    return _constants(robot, frames, centre, c_u, c_w)


def _crossing(p: FloatArray, k: FloatArray, q: FloatArray, m: FloatArray) -> FloatArray | None:
    """The point where two lines through p and q that are square to each other cross, or None; k, m are unit."""
    if abs((q - p) @ np.cross(k, m)) > CROSSING:
        return None
    return p + k * (k @ (q - p))


def _constants(
    robot: Robot, frames: FloatArray, centre: FloatArray, c_u: FloatArray, c_w: FloatArray
) -> Decoupled | None:
    """From the joint frames (n + 1, 4, 4) at theta = 0, the wrist's centre, and c_u and c_w."""
    k, p, R = frames[:-1, :3, 2], frames[:-1, :3, 3], frames[-1, :3, :3]
    z = k[0] if k[0][np.argmax(np.abs(k[0]))] > 0 else -k[0]
    home = joint_frames(robot, robot.home)
    y_home = home[1, :3, 2]
    reach = home[-1, :3, 3] - home[-1, :3, :3] @ c_w - p[0]
    # Front is the side on which the wrist centre stands at the home configuration.
    y = k[1] if np.cross(y_home, z) @ reach >= 0 else -k[1]
    S = np.array([np.cross(y, z), y, z])
    origin = p[0] + z * (z @ (p[1] - p[0]))
    shoulder, elbow, wrist = S @ (p[1] - origin), S @ (p[2] - origin), S @ (centre - origin)
    l_2 = complex(elbow[0] - shoulder[0], -elbow[2])  # axis 2 is as high as the origin
    l_3 = complex(wrist[0] - elbow[0], -(wrist[2] - elbow[2]))
    if abs(l_2) < CROSSING or abs(l_3) < CROSSING:
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
    g = np.cross(u, across)  # of any length: it tells an angle
    sign = robot.chain.sign
    axis_sign = np.array([k[0] @ z, k[1] @ y, k[2] @ y, 1.0, flip, 1.0])[: robot.n]
    return Decoupled(
        S=_matrix(S),
        origin=_vector(origin),
        a_1=float(shoulder[0]),
        h=float(wrist[1]),
        l_2=l_2,
        l_3=l_3,
        W=_matrix(W),
        u=_vector(u),
        g=_vector(g),
        gn=_vector(np.cross(u, g)),
        c_u=_vector(c_u),
        c_g=_vector(R.T @ S.T @ W.T @ g),
        c_w=_vector(c_w),
        direction=frozen(np.sign(axis_sign) * sign),
    )


def _vector(v: FloatArray) -> Vector:
    x, y, z = map(float, v)
    return x, y, z


def _matrix(R: FloatArray) -> Matrix:
    x, y, z = map(_vector, R)
    return x, y, z


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
    p = np.array(arm.S) @ (T_MT[:3, 3] - R @ arm.c_w - arm.origin)
    rho = float(np.hypot(p[0], p[1]))
    if rho < abs(arm.h):
        return f"{_metres(abs(arm.h) - rho)} inside the arm's lateral offset, too close to axis 1"
    L_2, L_3 = abs(arm.l_2), abs(arm.l_3)
    x = np.sqrt(rho - abs(arm.h)) * np.sqrt(rho + abs(arm.h))
    reach = [float(np.hypot(side * x - arm.a_1, p[2])) for side in (1.0, -1.0)]
    beyond, inside = min(reach) - (L_2 + L_3), abs(L_2 - L_3) - max(reach)
    if beyond > 0:
        return f"{_metres(beyond)} beyond reach"
    if inside > 0:
        return f"{_metres(inside)} too close to the shoulder"
    return ""


def _metres(value: float) -> str:
    return format_si(value, "m", 2) if value >= 0.01 else f"{format_significant(from_si(value, 'mm'), 2)} mm"
