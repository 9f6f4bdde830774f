"""Numbers that a formula gives."""

from __future__ import annotations

import math

import numpy as np

import robomill as rm
from generators.validation.check import Check, Compute
from robomill.compliance.springs.tool_bending import ToolBending
from robomill.cutting.conditions import CutConditions
from robomill.cutting.forces import model_of
from robomill.cutting.tool import Cutter
from robomill.io.materials import sample_materials
from robomill.surface.stock import Stock
from robomill.surface.zmap import cut
from robomill.toolpath.gcode import read_gcode

PAPER_ARM = "slavkovic_5r"


def _plane_geometry() -> list[Check]:
    """The paper's arm with the tool vertical at X = 0, Z = 0: two links and a wrist in a plane."""
    robot = rm.load_robot(PAPER_ARM)
    upper, fore, wrist = float(robot.a[1]), float(robot.d[3]), float(robot.a[4])
    reach, height = 1.3, wrist  # of the wrist's centre, from the shoulder
    far = math.hypot(reach, height)
    elbow = math.atan2(height, reach) + math.acos((upper**2 + far**2 - fore**2) / (2 * upper * far))
    h = upper * math.sin(elbow)  # of the elbow above the tip
    along = reach - upper * math.cos(elbow)  # of the tip beyond the elbow
    C_theta = robot.compliance_sets["table_2"]
    by_hand = {
        "yy": C_theta[2] * h**2 + C_theta[4] * wrist**2,
        "yz": -C_theta[2] * h * along,
        "zz": C_theta[1] * reach**2 + C_theta[2] * along**2,
    }
    theta = rm.inverse_kinematics(robot, rm.pose_from_world([0.0, -reach, 0.0, 0.0, 0.0])).theta
    C = rm.cartesian_compliance(robot, theta)
    found = {"yy": C[1, 1], "yz": C[1, 2], "zz": C[2, 2]}
    words = {
        "yy": "C₃ h² + C₅ a₅², with the elbow h above the tip",
        "yz": "−C₃ h l, with the tip l beyond the elbow",
        "zz": "C₂ Y² + C₃ l²",
    }
    return [
        Check(f"C_{name} at (0, −1300, 0) mm, Table 2", words[name], by_hand[name], float(found[name]), "um/N", 1e-9)
        for name in by_hand
    ]


def _planar_arm() -> list[Check]:
    """Two links in a plane: the textbook's Jacobian."""
    robot = rm.load_robot("planar_2r")
    one, two = robot.a
    theta = np.array([0.4, 0.9])
    s1, s12 = math.sin(theta[0]), math.sin(theta.sum())
    C_xx = robot.C_theta[0] * (one * s1 + two * s12) ** 2 + robot.C_theta[1] * (two * s12) ** 2
    words = "C₁ (l₁ s₁ + l₂ s₁₂)² + C₂ (l₂ s₁₂)²"
    det = rm.geometric_jacobian(robot, theta)[:2]
    return [
        Check("C_xx of a planar arm", words, C_xx, float(rm.cartesian_compliance(robot, theta)[0, 0]), "um/N", 1e-9),
        Check(
            "det(J) of a planar arm",
            "l₁ l₂ sin θ₂",
            one * two * math.sin(theta[1]),
            float(np.linalg.det(det)),
            "m2",
            1e-9,
        ),
    ]


def _slot_forces() -> list[Check]:
    """Altintas' mean force of a full slot, for each aluminium row and the paper's cut."""
    N, a, c = 3, 2e-3, 0.05e-3
    cutter = Cutter("flat", 8e-3, flutes=N)
    conditions = CutConditions.steady(0.03, 200.0, a, cutting=[False, True])
    checks = []
    for row in sample_materials():
        if row.kind != "mechanistic":
            continue
        force = model_of(row)(cutter, row).components(conditions)[1]  # type: ignore[call-arg]
        by_hand = N * a * (row.Ktc * c / 4 + row.Kte / math.pi)  # type: ignore[attr-defined]
        checks.append(
            Check(
                f"F_y of the paper's slot, {row.title}",
                "N a (K_tc c/4 + K_te/π)",
                by_hand,
                float(force[1]),
                "N",
                1e-9,
                1,
            )
        )
    return checks


def _volumes() -> list[Check]:
    """What a straight cut takes away: a strip and two half bodies of revolution."""
    R, depth, length = 4e-3, 2e-3, 40e-3
    stock = Stock([-10e-3, -10e-3, -10e-3], [50e-3, 10e-3, 0.0])
    p = np.array([[0.0, 0.0, -depth], [length, 0.0, -depth]])
    flat = 2 * R * depth * length + math.pi * R**2 * depth
    half = math.acos((R - depth) / R)
    segment = R**2 * (half - math.sin(half) * math.cos(half))
    cap = math.pi * depth**2 * (R - depth / 3)
    ball = segment * length + cap
    words = ("2 R a l + π R² a", "segment of the circle · l + cap of the ball")
    return [
        Check(
            f"volume of a slot, {kind} end",
            way,
            exact,
            float(cut(stock, 1e-4, Cutter(kind, 2 * R), p).removed_volume),
            "mm3",
            2e-3,
            2,
        )
        for kind, way, exact in (("flat", words[0], flat), ("ball", words[1], ball))
    ]


def _cantilever() -> list[Check]:
    d, L, E = 0.8 * 8e-3, 32e-3, 600e9
    by_hand = L**3 / (3 * E * math.pi * d**4 / 64)
    return [
        Check("bending of an 8 mm carbide cutter", "L³ / (3 E I)", by_hand, ToolBending(8e-3, L).lateral, "um/N", 1e-9)
    ]


def _arcs() -> list[Check]:
    """The length of a full circle in the chords that stand for it."""
    path = read_gcode("G21 G17 G90\nG0 X20 Y0 Z5\nG1 Z-1 F300\nG2 X20 Y0 I-20 J0\nM30\n")
    flat = path.p[path.p[:, 2] < -0.5e-3]
    length = float(np.linalg.norm(np.diff(flat, axis=0), axis=1).sum())
    return [Check("length of a circle of 20 mm from G2", "2 π r", 2 * math.pi * 20e-3, length, "mm", 1e-4, 3)]


CLOSED_FORMS: tuple[Compute, ...] = (_plane_geometry, _planar_arm, _slot_forces, _volumes, _cantilever, _arcs)
