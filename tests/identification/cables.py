"""Load tests with a cable over a pulley, simulated from scratch: matrices multiplied out, springs turned one by one.

Nothing of the product computes here; the arm is what its TOML file says. Written as people would write it:
joint angles, force components in {M}, gauge readings, and the load point that was *stated*.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import robomill as rm

SAMPLES = Path(__file__).resolve().parents[2] / "samples" / "robots"


def homogeneous(R, p):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, p
    return T


def about(axis, angle):
    """Rotation by Rodrigues' formula."""
    K = np.cross(np.eye(3), np.asarray(axis))
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


@dataclass(frozen=True, eq=False)
class Arm:
    """D-H rows (modified convention): alpha, a, d, offset, sign; the tool in the flange; joint compliances."""

    rows: np.ndarray
    sign: np.ndarray
    T_FT: np.ndarray
    C_theta: np.ndarray
    limits: np.ndarray

    @classmethod
    def of(cls, name):
        table = tomllib.loads((SAMPLES / f"{name}.toml").read_text(encoding="utf-8"))
        assert table["convention"] == "modified"
        rows = [
            (np.radians(j["alpha_deg"]), j["a_mm"] / 1e3, j["d_mm"] / 1e3, np.radians(j["theta_offset_deg"]))
            for j in table["joint"]
        ]
        tool = homogeneous(np.array(table["tool"]["rotation"], dtype=float), np.array(table["tool"]["xyz_mm"]) / 1e3)
        used = table["compliance"][table["compliance"]["use"]]
        return cls(
            np.array(rows),
            np.array([j.get("sign", 1) for j in table["joint"]], dtype=float),
            tool,
            1.0 / np.array(used["k_theta_Nm_per_rad"]),
            np.radians([j["limits_deg"] for j in table["joint"]]),
        )

    def frames(self, q):
        """The frame each joint turns about (before its turn), then the flange."""
        T, out = np.eye(4), []
        for (alpha, a, d, offset), sign, angle in zip(self.rows, self.sign, q, strict=True):
            T = T @ homogeneous(about([1, 0, 0], alpha), [0, 0, 0]) @ homogeneous(np.eye(3), [a, 0, 0])
            turned = T @ homogeneous(about([0, 0, 1], sign * angle + offset), [0, 0, 0])
            out.append(turned)
            T = turned @ homogeneous(np.eye(3), [0, 0, d])
        return [*out, T]

    def yields(self, q, load_point, gauge_point, F, bending):
        """Displacement of a point of the flange under a force at another: each spring turned by its own matrix.

        Points in the flange; bending: {joint: (c_x, c_y)} about the axes across the joint's, in its turned frame.
        """
        *joints, flange = self.frames(q)
        p, g = (flange[:3, :3] @ point + flange[:3, 3] for point in (load_point, gauge_point))
        moved = np.zeros(3)
        for i, frame in enumerate(joints):
            across = bending.get(i + 1, (0.0, 0.0))
            for axis, c in zip((2, 0, 1), (self.C_theta[i], *across), strict=True):
                u, o = frame[:3, axis], frame[:3, 3]
                angle = c * float(u @ np.cross(p - o, F))
                moved += about(u, angle) @ (g - o) + o - g
        return moved


class StandardArm(Arm):
    """The same with rows of the standard convention: a joint turns about the axis behind which its row stands."""

    def frames(self, q):
        T, out = np.eye(4), []
        for (alpha, a, d, offset), sign, angle in zip(self.rows, self.sign, q, strict=True):
            turned = T @ homogeneous(about([0, 0, 1], sign * angle + offset), [0, 0, 0])
            out.append(turned)
            T = turned @ homogeneous(about([1, 0, 0], 0.0), [a, 0, d]) @ homogeneous(about([1, 0, 0], alpha), [0, 0, 0])
        return [*out, T]


def ur_like():
    """Six joints with an offset wrist, lengths of a UR10, modified D-H."""
    a, d = [0, 0, -0.612, -0.5723, 0, 0], [0.1273, 0, 0, 0.163941, 0.1157, 0.0922]
    alpha = np.radians([0, 90, 0, 0, 90, -90])
    C_theta = np.array([1.2, 1.0, 1.5, 4.0, 4.0, 5.0]) * 1e-5
    limits = np.radians(np.tile([-180.0, 180.0], (6, 1)))
    return Arm(
        np.stack([alpha, a, d, np.zeros(6)], axis=-1), np.ones(6), homogeneous(np.eye(3), [0, 0, 0.15]), C_theta, limits
    )


def random_six(seed):
    """Six joints about axes that nobody would build."""
    rng = np.random.default_rng(seed)
    rows = np.stack(
        [rng.uniform(-1.5, 1.8, 6), rng.uniform(0.1, 0.8, 6), rng.uniform(-0.4, 0.6, 6), rng.uniform(-1, 1, 6)], axis=-1
    )
    rows[0, :2] = 0.0
    limits = np.radians(np.tile([-170.0, 170.0], (6, 1)))
    return Arm(rows, np.ones(6), homogeneous(np.eye(3), [0, 0, 0.2]), 10 ** rng.uniform(-6.7, -5.5, 6), limits)


def as_robot(arm, name):
    """The product's robot with the simulator's numbers."""
    return rm.Robot(
        name=name,
        convention="standard" if isinstance(arm, StandardArm) else "modified",
        alpha=arm.rows[:, 0],
        a=arm.rows[:, 1],
        d=arm.rows[:, 2],
        theta_offset=arm.rows[:, 3],
        sign=arm.sign,
        limits_all=arm.limits,
        C_theta_all=arm.C_theta,
        T_tool=arm.T_FT,
    )


@dataclass(frozen=True, eq=False)
class Rig:
    """How the tests are made: points in the flange (m), pulleys (m, {M}), size of the pull (N), noise (m), bending."""

    load_point: np.ndarray = field(default_factory=lambda: np.array([0.06, 0.10, 0.42]))
    gauge_point: np.ndarray = field(default_factory=lambda: np.array([-0.05, 0.12, 0.38]))
    pulleys: tuple = ((3.4, -2.2, 1.6),)
    pull: tuple = (200.0, 600.0)
    noise: float = 4e-6
    force_noise: float = 0.0
    bending: dict = field(default_factory=dict)
    dead_weight: bool = False
    along: np.ndarray | None = None  # pull along this direction of the flange, whatever the pose


@dataclass(frozen=True, eq=False)
class Made:
    """q (m, n) rad, F (m, 3) N, moved (m, 3) m with noise, truth (m, 3) m without, which pulley (m,)."""

    q: np.ndarray
    F: np.ndarray
    moved: np.ndarray
    truth: np.ndarray
    pulley: np.ndarray


def postures(arm, count, rng):
    """Configurations in front of the foot: the flange between 1.2 and 2.6 m out and above the floor."""
    out = []
    while len(out) < count:
        q = rng.uniform(arm.limits[:, 0] * 0.5, arm.limits[:, 1] * 0.5)
        q[0] = rng.uniform(-0.9, 0.9)
        place = arm.frames(q)[-1][:3, 3]
        if 1.2 < np.hypot(place[0], place[1]) < 2.6 and 0.4 < place[2] < 2.4:
            out.append(q)
    return np.array(out)


def make(arm, rig, count=43, seed=0, q=None):
    rng = np.random.default_rng(seed)
    q = postures(arm, count, rng) if q is None else q
    F, moved, which = [], [], []
    for k, angles in enumerate(q):
        flange = arm.frames(angles)[-1]
        p = flange[:3, :3] @ rig.load_point + flange[:3, 3]
        pulley = k % len(rig.pulleys)
        way = np.array([0, 0, -1.0]) if rig.dead_weight else np.array(rig.pulleys[pulley]) - p
        if rig.along is not None:
            way = flange[:3, :3] @ rig.along
        push = way / np.linalg.norm(way) * rng.uniform(*rig.pull)
        moved.append(arm.yields(angles, rig.load_point, rig.gauge_point, push, rig.bending))
        F.append(push + rig.force_noise * rng.standard_normal(3))
        which.append(pulley)
    truth = np.array(moved)
    return Made(q, np.array(F), truth + rig.noise * rng.standard_normal(truth.shape), truth, np.array(which))


def in_tool(arm, point):
    """A point of the flange as offset from the tip, in {T}: what a file states."""
    return arm.T_FT[:3, :3].T @ (np.asarray(point) - arm.T_FT[:3, 3])


def as_csv(arm, made, load_point, gauge_point):
    """The file a person would write, with the points (in the flange, m) that are stated in it."""
    n = made.q.shape[1]
    head = [f"theta{i + 1}_deg" for i in range(n)] + [f"F{a}_N" for a in "xyz"] + [f"d{a}_mm" for a in "xyz"]
    head += [f"{name}{a}_mm" for name in ("FP", "MP") for a in "xyz"]
    points = np.concatenate([in_tool(arm, load_point), in_tool(arm, gauge_point)]) * 1e3
    lines = [",".join(head)]
    for q, F, moved in zip(made.q, made.F, made.moved, strict=True):
        cells = [*np.degrees(q), *F, *(moved * 1e3), *points]
        lines.append(",".join("" if np.isnan(v) else f"{v:.9f}" for v in cells))
    return "\n".join(lines) + "\n"
