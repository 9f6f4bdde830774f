"""Numbers that many small steps give."""

from __future__ import annotations

import math

import numpy as np

import robomill as rm
from generators.validation.check import Check, Compute
from generators.validation.naive import configurations, frames, tip
from robomill.compliance.deflection import deflection
from robomill.compliance.gravity import LinkMasses, gravity_sag
from robomill.cutting.conditions import CutConditions
from robomill.cutting.forces import model_of
from robomill.cutting.tool import Cutter
from robomill.io.materials import load_material
from robomill.io.samples import samples_dir

PAPER_ARM = "slavkovic_5r"


def _rows_multiplied() -> list[Check]:
    robot = rm.load_robot(PAPER_ARM)
    theta = configurations(robot, 200)
    apart = np.linalg.norm(rm.tool_pose(robot, theta)[:, :3, 3] - [tip(robot, each) for each in theta], axis=1).max()
    return [
        Check(
            "tip, farthest of 200 configurations",
            "the rows of Table 1 multiplied out",
            0.0,
            float(apart),
            "m",
            1e-12,
            4,
            1.0,
        )
    ]


def _numeric_jacobian() -> list[Check]:
    robot = rm.load_robot(PAPER_ARM)
    theta, h = configurations(robot, 200), 1e-6
    numeric = [[(tip(robot, t + e) - tip(robot, t - e)) / (2 * h) for e in h * np.eye(5)] for t in theta]
    apart = float(np.abs(np.swapaxes(numeric, 1, 2) - rm.geometric_jacobian(robot, theta)[:, :3]).max())
    return [
        Check(
            "J_v, largest difference of 200 configurations",
            "differences of the pose, h = 10⁻⁶ rad",
            0.0,
            apart,
            "m",
            1e-8,
            4,
            1.0,
        )
    ]


def _twisted_joints() -> list[Check]:
    """Each joint turned by C_i times the torque that the force has about it; the tip then stands off by C F."""
    robot, F = rm.load_robot(PAPER_ARM), np.array([30.0, 100.0, -23.0])
    theta = rm.inverse_kinematics(robot, rm.pose_from_world([0.2, -1.3, -0.1, 0.0, 0.0])).theta
    h = 1e-6
    J = np.array([(tip(robot, theta + e) - tip(robot, theta - e)) / (2 * h) for e in h * np.eye(5)]).T
    moved = tip(robot, theta + robot.C_theta * (J.T @ F)) - tip(robot, theta)
    delta = rm.cartesian_compliance(robot, theta) @ F
    return [
        Check(
            f"δ_{axis} under (30, 100, −23) N",
            "joints twisted by C_i τ_i, the pose computed again",
            float(moved[i]),
            float(delta[i]),
            "mm",
            1e-3,
        )
        for i, axis in enumerate("xyz")
    ]


def _energy() -> list[Check]:
    robot, F = rm.load_robot("kuka_kr270"), np.array([-40.0, 60.0, 80.0])
    theta = np.array([0.2, -1.2, 1.3, 0.3, 0.9, -0.4])
    J = rm.geometric_jacobian(robot, theta)[:3]
    tau = J.T @ F
    stored = 0.5 * float((robot.C_theta * tau**2).sum())
    done = 0.5 * float(F @ deflection(rm.joint_contributions(J, robot.C_theta), F).sum(axis=0))
    return [
        Check(
            "energy of a KUKA KR270 under (−40, 60, 80) N",
            "½ Σ C_i τ_i², stored in its joints",
            stored,
            done,
            "N m",
            1e-9,
            6,
        )
    ]


def _revolution() -> list[Check]:
    """The mean over a revolution by adding up 36 000 instants, of a side cut."""
    row = load_material("al7075_t6_carbide_ref190")
    N, a, radius, c, width = 3, 2e-3, 4e-3, 0.05e-3, 2e-3
    start = math.pi - math.acos(1 - width / radius)  # down milling: the arc ends where the tooth runs along the feed
    phi = (np.arange(36_000) + 0.5) * 2 * math.pi / 36_000
    inside = phi >= start
    inside &= phi <= math.pi
    h = c * np.sin(phi)
    Ft, Fr = ((getattr(row, f"K{x}c") * h + getattr(row, f"K{x}e")) * a * inside for x in "tr")
    along = N * float(np.mean(-Ft * np.cos(phi) - Fr * np.sin(phi)))
    left = N * float(np.mean(Ft * np.sin(phi) - Fr * np.cos(phi)))
    conditions = CutConditions.steady(0.03, 200.0, a, arc=(start, math.pi), cutting=[False, True])
    force = model_of(row)(Cutter("flat", 2 * radius, flutes=N), row).components(conditions)[1]  # type: ignore[call-arg]
    way = "36 000 instants of a revolution added up"
    return [
        Check("feed force of a side cut, 2 mm wide", way, along, float(force[0]), "N", 1e-3, 2),
        Check("feed-normal force of the same", way, left, float(force[1]), "N", 1e-3, 2),
    ]


def _sag() -> list[Check]:
    """The derivative of the potential energy by differences, then the joints twisted by it."""
    robot = rm.load_robot(PAPER_ARM)
    mass, centre = np.array([120.0, 90.0, 60.0, 25.0, 30.0]), np.array([-0.2, 0.01, 0.03])
    theta = rm.inverse_kinematics(robot, rm.pose_from_world([0.2, -1.3, -0.1, 0.0, 0.0])).theta
    g, h = 9.80665, 1e-6

    def energy(t: np.ndarray) -> float:
        places = frames(robot, t)
        places[-1] = places[-1] @ robot.T_tool  # the last mass is told in {T}
        return g * sum(m * float((T @ [*centre, 1.0])[2]) for m, T in zip(mass, places))

    tau = np.array([-(energy(theta + e) - energy(theta - e)) / (2 * h) for e in h * np.eye(5)])
    moved = tip(robot, theta + robot.C_theta * tau) - tip(robot, theta)
    sag = gravity_sag(robot, theta, LinkMasses(mass, np.tile(centre, (5, 1)))).sum(axis=0)
    way = "derivative of the potential energy, joints twisted by it"
    return [Check("sag under 325 kg of links, in Z", way, float(moved[2]), float(sag[2]), "mm", 5e-3)]


def _strewn_points() -> list[Check]:
    """The volume of the sample heart's ideal cut by asking for points whether the cutter passes over them."""
    setup = rm.load_setup(samples_dir() / "heart")
    path, R, stock = setup.toolpath, setup.cutter.radius, setup.stock_block
    sides = [np.arange(low + 1e-4, high, 2e-4) for low, high in zip(stock.lower[:2], stock.upper[:2])]
    points = np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 2)
    points += np.random.default_rng(7).uniform(-1e-4, 1e-4, points.shape)  # one point somewhere in each cell
    deepest = np.full(len(points), float(stock.upper[2]))
    for i in range(1, len(path)):
        a, b = path.p[i - 1], path.p[i]
        low, high = np.minimum(a, b)[:2] - R, np.maximum(a, b)[:2] + R
        some = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1)) if path.cutting[i] else []
        way, from_a = b[:2] - a[:2], points[some] - a[:2]
        length = float(way @ way)
        t = np.clip(from_a @ way / length, 0, 1) if length > 0 else np.ones(len(from_a))
        over = np.linalg.norm(from_a - t[:, None] * way, axis=1) <= R
        z = np.where(over, a[2] + t * (b[2] - a[2]), np.inf)
        deepest[some] = np.minimum(deepest[some], z)
    volume = 4e-8 * float(np.sum(stock.upper[2] - deepest))
    way_of = f"{len(points):,} points asked whether the cutter passes over them".replace(",", " ")
    return [
        Check("volume of the sample heart", way_of, volume, rm.simulate(setup).ideal.removed_volume, "mm3", 2e-3, 1)
    ]


BRUTE_FORCE: tuple[Compute, ...] = (
    _rows_multiplied,
    _numeric_jacobian,
    _twisted_joints,
    _energy,
    _revolution,
    _sag,
    _strewn_points,
)
