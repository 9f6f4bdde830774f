"""Fields over planes and boxes from the cache, by fingerprints of robot and grid."""

import dataclasses
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from robomill.arrays import FloatArray, digest
from robomill.compliance.posture import over_posture
from robomill.errors import WorkspaceError
from robomill.improve.sensitivity import scaled_shares, stiffened
from robomill.kinematics.decoupled import decoupled
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import pose_from_world
from robomill.paper import Point
from robomill.progress import slices
from robomill.quantities import quantities
from robomill.robot.model import Robot
from robomill.ui import session
from robomill.ui.posed.cut import middle_of_cut
from robomill.ui.project import MapView
from robomill.ui.work.cached import commons, name_of, shared
from robomill.ui.work.commons import NOTHING
from robomill.units import format_count, format_si, from_si, to_si
from robomill.viz.maps import Scale
from robomill.viz.planes import Codes, coded
from robomill.workspace.fields import ComplianceMap, compliance_map
from robomill.workspace.grid import PAPER_BOX, PAPER_BOX_SIZE, Grid, box_grid
from robomill.workspace.lines import LineDeviation, border_and_middle_lines
from robomill.workspace.quantities import map_quantity
from robomill.workspace.reach import ReachBox
from robomill.workspace.region import FLAT, coarse_grid, flat_axis, largest_region, reach_extent

STEPS = (0.001, 0.002, 0.005, 0.01, 0.02, 0.025, 0.04, 0.05, 0.075, 0.1, 0.15, 0.2, 0.25, 0.5)
PLANE_CELLS = 1900
DRAWN_CELLS = 60_000
PLANES, FEW_PLANES = 50, 25  # about so many go to the browser; few of an arm that is solved numerically
SENT_CODES = 1_500_000  # of all maps and planes of a picture: 4 MB on their way
BOX_CELLS = 400_000  # of a picture's planes
SOLVED_CELLS = 30_000  # solved at once: what is known of a cell takes half a kilobyte until it is coded
NORMALS = quantities(MapView)["normal"].options


def geometry_key(robot: Robot) -> str:
    """Fingerprint of everything but the compliances: reach depends on nothing else."""
    chain = robot.chain
    return digest((robot.name, chain.T_0, chain.E, chain.sign, chain.offset, chain.prismatic, robot.limits))


def region(robot: Robot, view: MapView) -> ReachBox:
    """The box the maps cover. Raises WorkspaceError where nothing is in reach or a corner is on the wrong side."""
    if view.region == "own":
        if (view.upper < view.lower).any():
            axis = "XYZ"[int(np.argmax(view.upper < view.lower))]
            raise WorkspaceError(f"Region: {axis} ends before it begins; type the smaller number first.")
        return ReachBox(view.lower, view.upper)
    if view.region == "paper":
        return ReachBox(*PAPER_BOX)
    if view.region == "cut":
        centre = cut_in_reach(robot, view)
        if centre is not None:
            half = 0.5 * PAPER_BOX_SIZE
            return ReachBox(np.array(centre) - half, np.array(centre) + half)
    found = proposed(robot, "reach" if view.region == "reach" else "largest", view.A, view.B)
    if found is None:
        tilt = f"A = {format_si(view.A, 'deg', 1)}, B = {format_si(view.B, 'deg', 1)}"
        raise WorkspaceError(
            f"{robot.title or robot.name} brings its tool nowhere at {tilt}: change the tilt, the tool frame or "
            f"the limits."
        )
    return found


def cut_in_reach(robot: Robot, view: MapView) -> Point | None:
    """The middle of the project's cut, m in {M}; None where there is none, or the arm does not get there."""
    centre = middle_of_cut(session.project().setup)
    if centre is None or not gets_to(robot, centre, view.A, view.B):
        return None
    return centre


@shared(lambda robot, point, A, B: (geometry_key(robot), point, A, B))
def gets_to(robot: Robot, point: Point, A: float, B: float) -> bool:
    """Whether the arm brings its tool to ``point`` at this tilt."""
    return bool(inverse_kinematics(robot, pose_from_world([*point, A, B])).reached)


@shared(geometry_key)
def flat(robot: Robot) -> int | None:
    """The axis a planar arm cannot move along, else None."""
    return flat_axis(robot)


def normals(robot: Robot) -> Mapping[str, str]:
    """Planes that make sense for this arm: normal -> name."""
    axis = flat(robot)
    return NORMALS if axis is None else {"xyz"[axis]: NORMALS["xyz"[axis]]}


def plane_at(robot: Robot, view: MapView, box: ReachBox) -> tuple[str, float]:
    """(normal, coordinate m) of the plane in force: as chosen, else Z_M = 0 where that is inside, else the middle."""
    known = normals(robot)
    normal = view.normal if view.normal in known else next(iter(known))
    i = "xyz".index(normal)
    low, high = float(box.lower[i]), float(box.upper[i])
    if view.at is not None and normal == view.normal:
        return normal, min(max(view.at, low), high)
    if normal == "z" and low <= 0.0 <= high:
        return normal, 0.0
    return normal, round(0.5 * (low + high), 3)


def plane_step(robot: Robot, view: MapView, box: ReachBox, normal: str, share: float = 1.0) -> float:
    """Spacing of the cells, m: as typed, or about 1900 cells (fewer for arms solved numerically), or a ``share``."""
    if view.step is not None:
        return view.step
    span = np.delete(box.size, "xyz".index(normal))
    wide = span[span > FLAT]
    cells = share * (PLANE_CELLS if decoupled(robot) is not None else 320)
    raw = float((np.prod(wide) / cells) ** (1.0 / len(wide))) if len(wide) else 0.1
    return next((s for s in STEPS if s >= 0.97 * raw), STEPS[-1])


def plane(robot: Robot, view: MapView, box: ReachBox, normal: str, at: float, share: float = 1.0) -> Grid:
    """The grid of the plane. Raises WorkspaceError where it has more cells than a picture takes."""
    step = plane_step(robot, view, box, normal, share)
    low, high = np.array(box.lower), np.array(box.upper)
    low["xyz".index(normal)] = high["xyz".index(normal)] = at
    grid = box_grid(low, high, step)
    if grid.cells > DRAWN_CELLS:
        fits = step * float(np.sqrt(grid.cells / DRAWN_CELLS))
        raise WorkspaceError(
            f"A plane of {format_count(grid.cells)} cells is more than a picture takes ({format_count(DRAWN_CELLS)}): "
            f"use a step of {format_si(np.ceil(fits * 1e3) / 1e3, 'mm', 0)} or more; the command line writes "
            f"finer maps."
        )
    return grid


def planes(robot: Robot, view: MapView, box: ReachBox, normal: str, unit: str, maps: int) -> Grid:
    """The cells of a picture of so many ``maps`` over the whole region: planes at round numbers of ``unit``, as many
    as the browser may hold. Raises WorkspaceError where a plane has more cells than a picture takes."""
    flat_grid = plane(robot, view, box, normal, 0.0, min(1.0, 6 / maps))
    i = "xyz".index(normal)
    low, high = (float(from_si(float(end), unit)) for end in (box.lower[i], box.upper[i]))
    most = PLANES if decoupled(robot) is not None else FEW_PLANES
    most = max(1, min(most, SENT_CODES // (flat_grid.cells * maps), BOX_CELLS // flat_grid.cells))
    at = np.array([0.5 * (low + high)])
    if high - low > 1e-9:
        step = float(f"{(high - low) / most:.1g}")
        found = step * np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1)
        at = np.round(found, 9) if len(found) else at
    return Grid(*(to_si(at, unit) if axis == normal else getattr(flat_grid, axis) for axis in "xyz"))


@shared(lambda robot, grid, normal, A, B, names: (robot.digest(), grid.x, grid.y, grid.z, normal, A, B, names), "Maps")
def coded_maps(
    robot: Robot, grid: Grid, normal: str, A: float, B: float, names: tuple[str, ...]
) -> Mapping[str, Codes]:
    """The quantities of these ``names`` over all planes of ``grid``, as the browser gets them, from the cache."""
    values = values_of(robot, grid, normal, A, B, names)
    return {name: coded(values.pop(name)) for name in names}


@shared(
    lambda one, other, grid, normal, tilt, names: (
        *(one.digest(), other.digest(), grid.x, grid.y, grid.z),
        *(normal, tilt, names),
    ),
    "Differences",
)
def coded_differences(
    one: Robot, other: Robot, grid: Grid, normal: str, tilt: tuple[float, float], names: tuple[str, ...]
) -> Mapping[str, Codes]:
    """By how much the quantities ``names`` of the ``other`` robot are larger than those of ``one``, over all planes;
    none where either does not reach."""
    first, second = (values_of(robot, grid, normal, *tilt, names) for robot in (one, other))
    return {name: coded(second.pop(name) - first.pop(name)) for name in names}


def values_of(
    robot: Robot, grid: Grid, normal: str, A: float, B: float, names: tuple[str, ...]
) -> dict[str, NDArray[np.float32]]:
    """Quantities (nw, nv, nu) in SI over the planes of ``grid``; numbers of joints as places among the robot's own."""
    i = "xyz".index(normal)
    axes = {axis: getattr(grid, axis) for axis in "xyz"}
    w, u, v = axes[normal], *(axes[axis] for axis in "xyz" if axis != normal)
    found = {name: np.empty((len(w), len(v), len(u)), np.float32) for name in names}
    for some in slices(len(w), "Maps", max(1, SOLVED_CELLS // (len(u) * len(v)))):
        known = compliance_map(robot, Grid(**{**axes, normal: w[some]}), A, B)
        for name in names:
            what = map_quantity(robot, name)
            values = what.law(known)
            if what.colours == "joints":
                values = Scale("", 0, 1, "joints", robot.joint_numbers).shade(values)
            found[name][some] = np.moveaxis(values, i, 0).transpose(0, 2, 1)
    return found


def solid(robot: Robot, box: ReachBox, cells: int | None = None) -> Grid:
    """A coarse grid over the whole region, for voxels, boxes and scales that stay while the plane moves."""
    return coarse_grid(robot, box.lower, box.upper, cells)


@shared(lambda robot, grid, A, B: (robot.digest(), grid.x, grid.y, grid.z, A, B), "Map")
def field(robot: Robot, grid: Grid, A: float, B: float) -> ComplianceMap:
    """Compliance, shares and determinant over ``grid``, from the cache."""
    return compliance_map(robot, grid, A, B)


def overview(robot: Robot, view: MapView, box: ReachBox) -> ComplianceMap:
    """A coarse field over the whole region, for scales that stay while the plane moves."""
    grid = solid(robot, box, 700 if decoupled(robot) is not None else 150)
    return field(robot, grid, view.A, view.B)


def stiffer(known: ComplianceMap, factors: FloatArray) -> ComplianceMap:
    """The same field with stiffer joints: exact, nothing is solved again."""
    if (factors == 1.0).all():
        return known
    robot = stiffened(known.robot, factors)
    return dataclasses.replace(known, robot=robot, shares=scaled_shares(known.shares, factors, axis=-2))


@shared(lambda robot, T_MT: (robot.digest(), T_MT), "Postures")
def postures(robot: Robot, T_MT: FloatArray) -> FloatArray:
    """C (k, 3, 3) m/N of the postures found that hold the tool at T_MT (4, 4); none for arms that have no choice."""
    return over_posture(robot, T_MT)


@shared(lambda robot, box, z: (robot.digest(), box.lower, box.upper, z), "Lines")
def lines(robot: Robot, box: ReachBox, z: float) -> list[LineDeviation]:
    """The six lines of Fig. 8 over the region's plane, from the cache."""
    points = 61 if decoupled(robot) is not None else 13
    return border_and_middle_lines(robot, box.lower[:2], box.upper[:2], z, points=points)


def box_there(robot: Robot, A: float, B: float) -> tuple[ReachBox | None, bool]:
    """The largest machining box, where it is known already, and whether it is."""
    found = commons.find(name_of(proposed, _by_tilt(robot, "largest", A, B)), NOTHING)
    return (None, False) if found is NOTHING else (found, True)


def _by_tilt(robot: Robot, kind: str, A: float, B: float) -> tuple[object, ...]:
    return geometry_key(robot), kind, A, B


@shared(_by_tilt, "Looking for the largest box in reach")
def proposed(robot: Robot, kind: str, A: float, B: float) -> ReachBox | None:
    """The largest machining box at this tilt, or with another ``kind`` the bounds of all that is reached."""
    return largest_region(robot, A, B) if kind == "largest" else reach_extent(robot, A, B)
