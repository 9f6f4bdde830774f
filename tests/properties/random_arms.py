"""Arms for tests: random ones, and the seven-axis arm that several rooms ask."""

from __future__ import annotations

import numpy as np

from robomill.robot.model import Robot
from tests.robot.written_otherwise import with_convention


def seven() -> Robot:
    """A redundant arm with seven joints, tool turned down, as lightweight arms are built."""
    return Robot(
        name="seven",
        convention="modified",
        alpha=np.radians([0, -90, 90, 90, -90, -90, 90]),
        a=np.zeros(7),
        d=np.array([0.36, 0, 0.42, 0, 0.4, 0, 0.226]),
        theta_offset=np.zeros(7),
        limits_all=np.radians([[-170, 170], [-120, 120]] * 3 + [[-175, 175]]),
        C_theta_all=np.full(7, 5e-6),
        T_tool=np.diag([1.0, -1.0, -1.0, 1.0]),
    )


def rotation(rng):
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return q * np.sign(np.linalg.det(q))


def frame(rng, reach=0.3):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation(rng), rng.uniform(-reach, reach, 3)
    return T


def any_arm(rng, n=None, prismatic=0.2):
    """A random table: any angles and lengths, signs, offsets, base and tool."""
    n = int(rng.integers(2, 8)) if n is None else n
    return Robot(
        name="any",
        convention=str(rng.choice(["standard", "modified"])),
        alpha=rng.uniform(-np.pi, np.pi, n),
        a=rng.uniform(-1, 1, n),
        d=rng.uniform(-1, 1, n),
        theta_offset=rng.uniform(-np.pi, np.pi, n),
        sign=rng.choice([-1.0, 1.0], n),
        prismatic=rng.random(n) < prismatic,
        limits_all=np.stack([-rng.uniform(0.5, 3, n), rng.uniform(0.5, 3, n)], axis=1),
        C_theta_all=rng.uniform(0.5, 20, n) * 1e-7,
        T_base=frame(rng),
        T_tool=frame(rng),
    )


def spherical_wrist_arm(rng, shoulder=True, lateral=True, elbow=True, convention="standard"):
    """A 6R arm with a spherical wrist and the offsets asked for, random tool, base, signs, offsets and limits."""
    half = np.pi / 2 * rng.choice([-1, 1], 6)
    arm = Robot(
        name="spherical wrist",
        convention="standard",
        alpha=half * [1, 0, 1, 1, 1, 0],
        a=[rng.uniform(0.05, 0.5) * shoulder, rng.uniform(0.5, 1.3), rng.uniform(-0.3, 0.3) * elbow, 0, 0, 0],
        d=[rng.uniform(0, 1), rng.uniform(-0.2, 0.2) * lateral, 0, rng.uniform(0.4, 1.2), 0, rng.uniform(0.1, 0.3)],
        theta_offset=rng.uniform(-np.pi, np.pi, 6),
        sign=rng.choice([-1.0, 1.0], 6),
        limits_all=np.stack([-rng.uniform(1.0, 3.1, 6), rng.uniform(1.0, 3.1, 6)], axis=1),
        C_theta_all=np.full(6, 1e-6),
        T_base=frame(rng),
        T_tool=frame(rng),
    )
    return with_convention(arm, convention)


def five_axis_arm(rng):
    """A decoupled 5R arm like the paper's, with random offsets, lengths, signs and base; the tip on its tool axis."""
    base = spherical_wrist_arm(rng, lateral=bool(rng.integers(2)), elbow=bool(rng.integers(2)))
    angle = rng.uniform(0.4, np.pi - 0.4)
    T_tool = np.eye(4)
    k = np.array([np.sin(angle), 0.0, np.cos(angle)])
    x = np.array([np.cos(angle), 0.0, -np.sin(angle)])
    T_tool[:3, :3] = np.column_stack([x, np.cross(k, x), k])
    T_tool[:3, 3] = k * rng.uniform(-0.4, 0.4)
    return base.replace(
        **{key: getattr(base, key)[:5] for key in ("alpha", "a", "d", "theta_offset", "sign", "prismatic", "blocked")},
        limits_all=base.limits_all[:5],
        C_theta_all=base.C_theta_all[:5],
        T_tool=T_tool,
        name="five axes",
    )


def configurations(rng, robot, count):
    """(count, n) within the limits."""
    return rng.uniform(robot.limits[:, 0], robot.limits[:, 1], (count, robot.n))
