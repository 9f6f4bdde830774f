"""Tool, spindle and arm as solids in {W}, where they stand at a station of the cut; in mm, for the rendered picture."""

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.springs.tool_bending import ToolBending
from robomill.cutting.tool import Cutter
from robomill.kinematics.forward import joint_frames
from robomill.kinematics.transforms import invert
from robomill.simulation.result import SimulationResult
from robomill.units import from_si, to_si
from robomill.viz import solids
from robomill.viz.rendered.picture import Role, Solid

SIDES = 48


def tool_solids(cutter: Cutter, tip: FloatArray, k: FloatArray, reach: float) -> list[Solid]:
    """Cutter, shank and spindle nose at ``tip`` (3,) m along ``k``; lengths that are not given are drawn as usual ones.

    ``reach`` m: how tall the whole stack may be drawn.
    """
    R = cutter.radius
    flutes = cutter.flute_length or 2.5 * cutter.diameter
    out = max(ToolBending.first(cutter).stick_out, flutes)
    r = np.linspace(0.0, R, 25)
    below = cutter.profile(r)
    cutting = _turned(np.append(r, R), np.append(below, max(flutes, float(below[-1]))), tip, k)
    shank = _turned(np.array([0.92 * R, 0.92 * R]), np.array([flutes, out]), tip, k)
    top = max(out + 3.0 * cutter.diameter, min(reach, out + 12.0 * cutter.diameter))
    nose = _turned(
        np.array([1.25 * R, 1.9 * R, 2.4 * R, 2.4 * R]), np.array([out, out + 2.4 * R, out + 2.8 * R, top]), tip, k
    )
    return [_solid(cutting, "cutter"), _solid(shank, "shank"), _solid(nose, "spindle")]


def arm_solids(result: SimulationResult, index: int) -> list[Solid]:
    """The arm's links and joints at sample ``index``, in {W}."""
    frames = _frames(result, index)
    size, tip, k = solids.yardstick(frames), frames[-1, :3, 3], frames[-1, :3, 2]
    links, joints = solids.limbs(frames)
    spindle = solids.tube(tip + 0.045 * size * k, tip + 0.12 * size * k, 0.014 * size, 0.024 * size)
    return [_solid(spindle, "spindle"), *(_solid(m, "joint") for m in joints), *(_solid(m, "link") for m in links)]


def _frames(result: SimulationResult, index: int) -> FloatArray:
    """(n+1, 4, 4) in {W}: the frame before each joint and {T} at sample ``index``."""
    return invert(result.setup.T_MW) @ joint_frames(result.setup.robot, result.theta[index])


def posed(result: SimulationResult, index: int, tip: FloatArray, *, arm: bool) -> tuple[Solid, ...]:
    """The tool with its tip at ``tip`` (3,) m in {W} as at sample ``index``; with ``arm`` the arm that holds it."""
    reach = to_si(90.0, "mm") if not arm else 0.1 * solids.yardstick(_frames(result, index))
    found = tool_solids(result.tooling.at(index), tip, result.path.k[index], reach)
    return (*found, *(arm_solids(result, index) if arm else []))


def _solid(mesh: solids.Triangles, role: Role) -> Solid:
    return Solid(from_si(mesh[0], "mm"), mesh[1], role)


def _turned(radius: FloatArray, height: FloatArray, tip: FloatArray, k: FloatArray) -> solids.Triangles:
    return solids.revolution(radius, height, tip, k, SIDES)
