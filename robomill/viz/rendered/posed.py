"""Tool, spindle and arm as solids in {W}, where they stand at a station of the cut; in mm, for the rendered picture."""

from robomill.arrays import FloatArray
from robomill.cutting.tool import Cutter
from robomill.kinematics.forward import joint_frames
from robomill.kinematics.transforms import invert
from robomill.simulation.result import SimulationResult
from robomill.units import from_si, to_si
from robomill.viz import solids
from robomill.viz.rendered.picture import Role, Solid
from robomill.viz.tool_shape import tool_shape

SIDES = 48


def tool_solids(cutter: Cutter, tip: FloatArray, k: FloatArray, reach: float) -> list[Solid]:
    """Cutter, shank and spindle nose at ``tip`` (3,) m along ``k``; lengths that are not given are drawn as usual ones.

    ``reach`` m: how tall the whole stack may be drawn.
    """
    shape = tool_shape(cutter, rim=25, reach=reach)
    return [_solid(solids.revolution(*outline, tip, k, SIDES), role) for role, outline in shape.items()]


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
