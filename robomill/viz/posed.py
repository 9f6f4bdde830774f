"""Tool, spindle and arm as solids in {W}, where they stand at a station of the cut; in mm, for the rendered picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from robomill.arrays import FloatArray
from robomill.cutting.tool import Cutter
from robomill.kinematics.forward import joint_frames
from robomill.simulation.result import SimulationResult
from robomill.units import from_si, to_si
from robomill.viz import solids

SIDES = 48


@dataclass(frozen=True, eq=False)
class Solid:
    """points (v, 3) mm in {W}, faces (f, 3); ``role`` picks its colour."""

    points: FloatArray
    faces: FloatArray
    role: Literal["cutter", "shank", "spindle", "link", "joint"]
    opacity: float = 1.0


def turned(radius: FloatArray, height: FloatArray, tip: FloatArray, k: FloatArray) -> solids.Mesh:
    """A solid of revolution about ``k`` (3,) from its outline (q,) radius over (q,) height above ``tip`` (3,)."""
    helper = np.array([1.0, 0.0, 0.0]) if abs(k[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    u = np.cross(k, helper)
    u /= np.linalg.norm(u)
    v = np.cross(k, u)
    angle = np.linspace(0.0, 2.0 * np.pi, SIDES, endpoint=False)
    ring = np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v
    points = tip + radius[:, None, None] * ring + height[:, None, None] * k
    q = len(radius)
    number = np.arange(q * SIDES).reshape(q, SIDES)
    a, b = number[:-1], np.roll(number, -1, axis=1)[:-1]
    c, d = number[1:], np.roll(number, -1, axis=1)[1:]
    sides = np.concatenate([np.stack([a, b, d], -1).reshape(-1, 3), np.stack([a, d, c], -1).reshape(-1, 3)])
    ends = []
    for row, turn in ((number[0], -1), (number[-1], 1)):
        fan = np.stack([np.full(SIDES - 2, row[0]), row[1:-1], row[2:]], -1)
        ends.append(fan[:, ::turn])
    return points.reshape(-1, 3), np.concatenate([sides, *ends]).astype(float)


def tool_solids(cutter: Cutter, tip: FloatArray, k: FloatArray, reach: float) -> list[Solid]:
    """Cutter, shank and spindle nose at ``tip`` (3,) m along ``k``; lengths that are not given are drawn as usual ones.

    ``reach`` m: how tall the whole stack may be drawn.
    """
    R = cutter.radius
    flutes = cutter.flute_length or 2.5 * cutter.diameter
    out = max(cutter.stick_out or 4.0 * cutter.diameter, flutes)
    r = np.linspace(0.0, R, 25)
    below = cutter.profile(r)
    cutting = turned(np.append(r, R), np.append(below, max(flutes, float(below[-1]))), tip, k)
    shank = turned(np.array([0.92 * R, 0.92 * R]), np.array([flutes, out]), tip, k)
    top = max(out + 3.0 * cutter.diameter, min(reach, out + 12.0 * cutter.diameter))
    nose = turned(
        np.array([1.25 * R, 1.9 * R, 2.4 * R, 2.4 * R]), np.array([out, out + 2.4 * R, out + 2.8 * R, top]), tip, k
    )
    return [_solid(cutting, "cutter"), _solid(shank, "shank"), _solid(nose, "spindle")]


def arm_solids(result: SimulationResult, index: int) -> list[Solid]:
    """The arm's links and joints at sample ``index``, in {W}."""
    setup = result.setup
    frames = joint_frames(setup.robot, result.theta[index])
    R, t = setup.T_MW[:3, :3], setup.T_MW[:3, 3]
    origin = (frames[:, :3, 3] - t) @ R
    axis = frames[:, :3, 2] @ R
    n = len(frames) - 1
    size = _size(result, index)
    tip, k = origin[-1], axis[-1]
    spindle = solids.tube(tip + 0.045 * size * k, tip + 0.12 * size * k, 0.014 * size, 0.024 * size)
    found = [_solid(spindle, "spindle")]
    for i in range(n):
        radius = 0.034 * size * (1.0 - 0.45 * i / max(n - 1, 1))
        end = origin[i + 1] + (0.09 * size * axis[-1] if i == n - 1 else 0.0)
        joint = solids.tube(origin[i] - 1.5 * radius * axis[i], origin[i] + 1.5 * radius * axis[i], 1.3 * radius)
        found.append(_solid(joint, "joint"))
        corner = origin[i] + axis[i] * float((end - origin[i]) @ axis[i])
        for a, b in ((origin[i], corner), (corner, end)):
            if np.linalg.norm(b - a) > 0.2 * radius:
                found.append(_solid(solids.tube(a, b, 0.92 * radius, 0.78 * radius), "link"))
    return found


def _size(result: SimulationResult, index: int) -> float:
    """Sum of the link lengths, m: the yardstick of the drawn arm."""
    origin = joint_frames(result.setup.robot, result.theta[index])[:, :3, 3]
    return max(float(np.linalg.norm(np.diff(origin, axis=0), axis=1).sum()), 1e-3)


def posed(result: SimulationResult, index: int, tip: FloatArray, *, arm: bool) -> tuple[Solid, ...]:
    """The tool with its tip at ``tip`` (3,) m in {W} as at sample ``index``; with ``arm`` the arm that holds it."""
    reach = to_si(90.0, "mm") if not arm else 0.1 * _size(result, index)
    found = tool_solids(result.setup.cutter, tip, result.path.k[index], reach)
    return (*found, *(arm_solids(result, index) if arm else []))


def _solid(mesh: solids.Mesh, role: Literal["cutter", "shank", "spindle", "link", "joint"]) -> Solid:
    return Solid(from_si(mesh[0], "mm"), mesh[1], role)
