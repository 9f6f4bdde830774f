"""The quantities of a map by name: unit, formula, and one sentence of meaning."""

from __future__ import annotations

from dataclasses import dataclass

from robomill.errors import WorkspaceError
from robomill.kinematics.dexterity import determinant_unit, square_rows
from robomill.robot.model import Robot

COMPONENTS = ("xx", "yy", "zz", "xy", "xz", "yz")


@dataclass(frozen=True)
class Quantity:
    """What a map shows; ``unit`` is a key of ``UNITS``, ``joint`` (0-based) and ``component`` where they apply."""

    name: str
    title: str
    unit: str
    formula: str
    meaning: str
    component: str = ""
    joint: int = -1


def quantity_names(robot: Robot) -> list[str]:
    """Every name ``compute_field`` takes for this robot."""
    names = ["reach", "det_J", "manipulability", "inverse_condition", "smallest_singular_value", "limit_distance"]
    names += [f"C_{c}" for c in COMPONENTS] + ["C_soft", "C_stiff", "dominant"]
    names += [f"dominant_C_{c}" for c in COMPONENTS]
    for c in COMPONENTS:
        names += [f"C_{c}_{j}" for j in range(1, robot.n + 1)]
        names += [f"share_C_{c}_{j}" for j in range(1, robot.n + 1)]
    return names


def quantity(robot: Robot, name: str) -> Quantity:
    """The quantity called ``name``; joints count from 1 over the free joints. Raises WorkspaceError."""
    key = name.replace("zy", "yz").replace("zx", "xz").replace("yx", "xy")
    plain = _plain(robot)
    if key in plain:
        return plain[key]
    parts = key.split("_")
    share, dominant = parts[0] == "share", parts[0] == "dominant"
    if share or dominant:
        parts = parts[1:]
    if len(parts) >= 2 and parts[0] == "C" and parts[1] in COMPONENTS:
        c = parts[1]
        if dominant and len(parts) == 2:
            formula = f"argmax_i |C_i,{c}|"
            return Quantity(key, f"joint that gives most in C_{c}", "1", formula, "Where to stiffen first.", c)
        if len(parts) == 2 and not share:
            return _component(key, c)
        if len(parts) == 3 and parts[2].isdigit() and 1 <= int(parts[2]) <= robot.n and not dominant:
            return _of_joint(robot, key, c, int(parts[2]) - 1, share)
    raise WorkspaceError(
        f"Quantity {name!r}: expected reach, det_J, manipulability, inverse_condition, smallest_singular_value, "
        f"limit_distance, C_xx ... C_yz, C_soft, C_stiff, dominant, dominant_C_xx, C_xx_1 ... C_yz_{robot.n} "
        "or share_C_xx_1 ..."
    )


def _component(key: str, c: str) -> Quantity:
    kind = "direct-compliance" if c[0] == c[1] else "cross-compliance"
    return Quantity(
        key,
        f"{kind} C_{c}",
        "um/N",
        f"C_{c} = Σ_i C_θi J_i,{c[0]} J_i,{c[1]}  (eqs. 13, 14)",
        f"How far the tip moves in {c[0].upper()} under 1 N in {c[1].upper()}.",
        c,
    )


def _of_joint(robot: Robot, key: str, c: str, joint: int, share: bool) -> Quantity:
    number = robot.joint_numbers[joint]
    if share:
        return Quantity(
            key,
            f"share of joint {number} in C_{c}",
            "%",
            f"C_{number},{c} / Σ_i |C_i,{c}|",
            f"The part of C_{c} that would vanish if joint {number} were rigid.",
            c,
            joint,
        )
    return Quantity(
        key,
        f"joint {number} in C_{c}",
        "um/N",
        f"C_{number},{c} = C_θ{number} J_{c[0]} J_{c[1]}  (eq. 14)",
        f"What joint {number} alone adds to C_{c}.",
        c,
        joint,
    )


def _plain(robot: Robot) -> dict[str, Quantity]:
    rows = ", ".join(square_rows(robot))
    unit = determinant_unit(robot)
    entries = (
        Quantity(
            "reach",
            "reach WS",
            "1",
            "WS = 1 where θ exists within the limits  (eq. 10)",
            "Where the tool can be brought at this tilt.",
        ),
        Quantity(
            "det_J",
            "det(J)",
            unit,
            f"det of the rows {rows}",
            "Zero is a singularity: a direction in which the tool cannot be moved.",
        ),
        Quantity(
            "manipulability",
            "manipulability",
            unit,
            f"√det(J Jᵀ), rows {rows}",
            "Yoshikawa's measure: the size of what unit joint speeds can do.",
        ),
        Quantity(
            "inverse_condition",
            "inverse condition",
            "1",
            f"σ_min / σ_max, rows {rows}",
            "1 is equally able in every direction, 0 is singular.",
        ),
        Quantity(
            "smallest_singular_value",
            "smallest singular value",
            "1",
            f"σ_min(J), rows {rows}",
            "How fast the tool moves in its worst direction at unit joint speed.",
        ),
        Quantity(
            "limit_distance",
            "distance to joint limits",
            "%",
            "min_i (distance to the nearer limit) / (half range)",
            "100 % is mid-range in every joint, 0 is at a limit.",
        ),
        Quantity(
            "C_soft",
            "softest direction",
            "um/N",
            "largest eigenvalue of C",
            "How far 1 N moves the tip in the direction in which it gives most.",
        ),
        Quantity(
            "C_stiff",
            "stiffest direction",
            "um/N",
            "smallest eigenvalue of C",
            "How far 1 N moves the tip in the direction in which it gives least.",
        ),
        Quantity(
            "dominant",
            "joint that gives most",
            "1",
            "argmax_i trace C_i",
            "The joint with the largest part of C_xx + C_yy + C_zz.",
        ),
    )
    return {entry.name: entry for entry in entries}
