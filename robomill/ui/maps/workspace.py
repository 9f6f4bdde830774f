"""The workspace page: reach and dexterity as planes, two planes, or voxels; the largest machining box."""

import html
import re
from collections.abc import Callable
from functools import partial

import numpy as np
import streamlit as st

from robomill.arrays import BoolArray, FloatArray
from robomill.compliance.at_pose import at_pose
from robomill.kinematics.dexterity import singularity_among
from robomill.learn.worked import at_the_pose
from robomill.robot.model import Robot
from robomill.ui import pieces, session, shell
from robomill.ui.entry import declared, inputs
from robomill.ui.judged.worked import mathematics
from robomill.ui.maps import plane, sides
from robomill.ui.maps.board import Planes, beneath, board
from robomill.ui.maps.plane import Region
from robomill.ui.posed import fields
from robomill.ui.posed.cut import path_there
from robomill.ui.posed.point import in_hand, middle
from robomill.ui.project import MapView, Project
from robomill.ui.work import running
from robomill.units import (
    NOT_REACHED,
    UNITS,
    format_many,
    format_number,
    format_percent,
    format_si,
    format_significant,
    from_si,
    unit_label,
)
from robomill.viz.arm import ArmScene, arm_figure
from robomill.viz.chart import Chart
from robomill.viz.maps import Scale
from robomill.viz.planes import PlaneMap, extremes
from robomill.viz.theme import palette
from robomill.viz.voxels import voxel_trace, widen, wire_box
from robomill.workspace.fields import ComplianceMap
from robomill.workspace.grid import PAPER_BOX, Grid
from robomill.workspace.quantities import MapQuantity, map_quantities, map_quantity
from robomill.workspace.reach import ReachBox, against_paper, paper_box_in

FITS = {
    "inside": "which lies inside",
    "outside": "which stands partly outside",
    "turned": "which fits in turned by 90°",
    "larger": "which does not fit in",
}
SINGULARITY = {
    "passed": "passes a singularity",
    "near": "comes close to a singularity",
    "none": "meets no singularity",
}


def tiles(robot: Robot, view: MapView, box: ReachBox, known: ComplianceMap, unit: str) -> list[pieces.Tile]:
    """Share in reach, least determinant, nearest limit, largest box."""
    share = float(known.reached.mean())
    det = np.abs(known.det_J[known.reached])
    what = map_quantity(robot, "det_J")
    shown = session.project().view
    least = format_si(float(det.min()), shown.of(what.unit), 3) if len(det) else "not reached"
    limit = known.values("limit_distance")
    nearest = format_percent(np.nanmin(limit)) if np.isfinite(limit).any() else NOT_REACHED
    largest, looked = fields.box_there(robot, view.A, view.B)
    size, note = ("none", "nothing in reach at this tilt") if looked else ("…", "not computed yet")
    if largest is not None:
        still = not (largest.size > 1e-6).any()  # an arm of one joint stands still at a tilt
        size = "one point" if still else f"{box_size(largest.size, unit)} {unit_label(unit)}"
        note = _against(largest, robot)
    return [
        pieces.Tile(
            "Region in reach",
            format_percent(share),
            f"of {box_size(box.size, unit)} {unit_label(unit)}",
            tone="ok" if share > 0.999 else "tight" if share > 0 else "out",
        ),
        pieces.Tile(
            "Distance to singularity",
            least,
            f"least |det(J)|; the arm {_past_singularities(robot, known)}" if len(det) else "",
        ),
        pieces.Tile("Room to joint limits", nearest, "at the worst cell; 100 % is mid-range"),
        pieces.Tile("Largest box in reach", size, note, kind="computed"),
    ]


def tiles_of_b(project: Project) -> list[pieces.Tile]:
    """The same of the project that the one in force is held against. Raises its refusal, and ``Underway``."""
    robot, view = project.setup.robot, session.maps()
    box = fields.region(robot, view)
    fields.proposed(robot, "largest", view.A, view.B)
    known = fields.field(robot, fields.solid(robot, box), view.A, view.B)
    return tiles(robot, view, box, known, project.view.length)


def box_size(size: FloatArray, unit: str) -> str:
    """``1200 x 600 x 500`` without its unit; a flat box has two numbers."""
    sides = [v for v in size if v > 1e-6] or [0.0]
    return format_many(sides, unit, 0, " × ", with_unit=False)


def _against(box: ReachBox, robot: Robot) -> str:
    if fields.flat(robot) is not None:
        return "in the plane of the arm"
    ratio = against_paper(box)
    return f"{format_number(ratio['volume_ratio'], 1)} × the volume of the reference box, {FITS[paper_box_in(box)]}"


def sentence(robot: Robot, known: ComplianceMap | None) -> str:
    """What can be said of the region in one line."""
    if known is None:
        return "There is no map of this region yet."
    share = float(known.reached.mean())
    if share == 0:
        return f"The arm reaches nothing of this region: {_why(known)}"
    where = "all of this region" if share > 0.999 else f"{format_percent(share)} of this region"
    return f"The arm reaches {where} and {_past_singularities(robot, known)} there."


def _past_singularities(robot: Robot, known: ComplianceMap) -> str:
    """Whether the arm passes a singularity (det(J) has both signs), comes close to one or meets none."""
    return SINGULARITY[singularity_among(robot, known.det_J[known.reached])]


def _why(known: ComplianceMap) -> str:
    """Why the middle of the region is not reached."""
    x, y, z = (float(axis[len(axis) // 2]) for axis in (known.grid.x, known.grid.y, known.grid.z))
    reason = in_hand(known.robot, (x, y, z), known.A, known.B).reason
    return f"at its middle, {reason}." if reason else "choose another plane."


def controls(robot: Robot, view: MapView) -> None:
    """The left column: quantity, region, tilt, plane, the meaning of it all."""
    names = {name: what.title for name, what in map_quantities(robot, "geometry").items()}
    what = map_quantity(robot, declared.seen("maps.quantity", inputs.LISTED, names, "Quantity"))
    st.html(f'<p class="rm-note"><b>{formula_html(what.formula)}</b><br>{html.escape(what.meaning)}</p>')
    plane.controls(robot, view)
    pieces.note(pieces.subscripts(plane.tilt_note(robot)))


def formula_html(formula: str) -> str:
    """A formula with its indices set low and omega as a letter."""
    text = html.escape(formula, quote=False).replace("omega_", "ω_").replace("sigma_", "σ_")
    return re.sub(r"([A-Za-zσωθ])_(\w+)", r"\1<sub>\2</sub>", text)


def box_card(robot: Robot, view: MapView, unit: str) -> None:
    """The largest box beside the paper's, with its place."""
    st.markdown("**Machining boxes**")
    largest, _ = fields.box_there(robot, view.A, view.B)
    rows = []
    flat = fields.flat(robot) is not None
    for name, box, kind in (
        ("largest without a singularity", largest, "computed"),
        ("reference box", ReachBox(*PAPER_BOX), "paper"),
    ):
        if box is None or (flat and kind == "paper"):
            continue
        corner = format_many(box.lower, unit, 0, with_unit=False)
        mark = pieces.badge(kind) + (" place in Y " + pieces.badge("assumed") if kind == "paper" else "")
        rows.append((name, f"{box_size(box.size, unit)} {unit_label(unit)}", f"from ({corner}) " + mark))
    pieces.facts([*_cut(unit), *rows])
    if largest is not None and view.region != "largest":
        largest_box = partial(session.see, region="largest", at=None, point=None)
        inputs.button("Show the largest box", "maps.largest", "crop_free", largest_box)
    pieces.note("Sides along the axes of {M}, true to about one cell; reached in one posture, without a singularity.")


def _cut(unit: str) -> list[tuple[str, str, str]]:
    """The box around what the project cuts, and how much of it is reached as it is cut."""
    setup = session.project().setup
    path, result = path_there(setup), running.quiet(setup)
    if path is None or not path.cutting.any():
        return []
    ends = setup.in_base(path.p[path.cutting | np.append(path.cutting[1:], False)])
    low, high = ends.min(axis=0), ends.max(axis=0)
    said = f"from ({format_many(low, unit, 0, with_unit=False)})"
    if result is not None:
        share = float(result.reached[result.path.cutting].mean())
        said += ", all reached" if share == 1.0 else f", {format_percent(share)} reached"
    return [("this cut", f"{format_many(high - low, unit, 0, ' × ', with_unit=False)} {unit_label(unit)}", said)]


@st.fragment
def picture() -> None:
    """The picture with its own controls; a slider step redraws this part alone."""
    shown = {"plane": _plane, "pair": _pair, "solid": _solid}
    with st.container(key="maps-room"):
        plane.picture("picture", lambda region: shown[region.view.picture](region))


def _plane(region: Region) -> None:
    planes = Planes.of(region, 1)
    normal, at = region.at()
    _board(planes, [at], lambda moved: session.see(at=moved[0], normal=normal))


def _pair(region: Region) -> None:
    view, planes = region.view, Planes.of(region, 1)
    if len(planes.w) == 1:
        _board(planes, [float(planes.w[0])], lambda moved: None)
        pieces.note("The region has no depth: there is only one plane.")
        return
    low, high = float(planes.w[0]), float(planes.w[-1])
    known = view.pair is not None and low <= min(view.pair) and max(view.pair) <= high
    pair = view.pair.tolist() if view.pair is not None and known else [low, high]
    _board(planes, pair, lambda moved: session.see(pair=np.array(moved)))


def _board(planes: Planes, ats: list[float], settle: Callable[[list[float]], None]) -> None:
    """One or two planes of the quantity on a scale that stays while they move."""
    region = planes.region
    what = map_quantity(region.robot, region.view.quantity)
    which = sides.of_quantity(what, region.robot)
    unit = session.project().view.of(what.unit)
    codes = which.codes(planes, [what.name])[what.name]
    if not codes.reached:
        pieces.note("Nothing of this region is reached.")
        return
    scale = which.scale(what, planes, unit)
    notes = extremes(codes, unit, UNITS[unit].digits) if scale.kind != "reach" else ()
    row: list[PlaneMap | None] = [
        PlaneMap(what.title, codes, unit, notes=notes, slider=k, low=False) for k in range(len(ats))
    ]
    sheet = planes.sheet([row], {"main": scale}, 735, 460 if len(ats) == 1 else 400)
    point = region.view.point
    selected = None if point is None else (float(point[0]), float(point[1]), float(point[2]))
    file = which.file(f"workspace-{what.name}")
    board(planes, sheet, file + "-pair" * (len(ats) > 1), ats, settle, selected)
    dark = "Dark: far from a limit of the arm. Bright: near one. " if scale.kind == "able" else ""
    beneath(
        f"{which.about}{dark}The colours stay while the plane moves.",
        lambda: which.columns(planes, [what.name], ats[0]),
        file,
    )
    _selected(region, what)


def _selected(region: Region, what: MapQuantity) -> None:
    """What the quantity is at the point that was clicked, and where its compliance is shown."""
    point, view = region.view.point, region.view
    if point is None:
        return
    found = fields.field(region.robot, Grid(*point[:, None]), view.A, view.B)
    unit = session.project().view.of(what.unit)
    value = from_si(found.values(what.name).item(), unit)
    scale = Scale.of(what, np.array([value]), region.robot.joint_numbers, unit)
    where = f"({format_many(point, region.unit, 0, with_unit=False)}) {unit_label(region.unit)}"
    if what.colours == "reach":
        said = "reached" if value > 0.5 else "not reached"
    else:
        said = (
            f"{format_number(value, scale.digits)} {unit_label(unit)}".strip() if np.isfinite(value) else "not reached"
        )
    pieces.note(f"Selected point {where}: {what.title} {said}. The page Compliance shows what it gives there.")
    x, y, z = point.tolist()
    mathematics(lambda: at_the_pose(in_hand(region.robot, (x, y, z), view.A, view.B).pose), "workspace")


def _columns(known: ComplianceMap, what: MapQuantity) -> dict[str, FloatArray]:
    """The table twin of a plane."""
    from robomill.io.maps import map_columns

    return map_columns([known.field(what.name)])


def _solid(region: Region) -> None:
    robot = region.robot
    what = map_quantity(robot, region.view.quantity)
    grid = fields.solid(robot, region.box)
    known = fields.field(robot, grid, region.view.A, region.view.B)
    if not known.reached.any():
        pieces.note(sentence(robot, known))
        return
    shown = session.project().view.of(what.unit)
    values = None if what.colours == "reach" else from_si(known.values(what.name), shown)
    mask = known.reached
    caption = "Everything in reach at this tilt."
    if values is not None:
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
        share = _level(low, high, region.view, unit_label(shown))
        cut = low + share * (high - low)
        mask = mask & (np.nan_to_num(values, nan=-np.inf) >= cut)
        caption = (
            f"Cells where {what.title} is at least {format_significant(cut, 3)} {unit_label(shown)}".rstrip() + "."
        )
    pieces.figure(
        _solid_figure(
            region, grid, mask, None if values is None else (values, Scale.of(what, values, robot.joint_numbers, shown))
        ),
        "workspace-solid",
        name=f"workspace-{what.name}",
        caption=caption,
        alt="The arm with the cells of its workspace as voxels.",
        table=lambda: _columns(known, what),
    )


def _level(low: float, high: float, view: MapView, unit: str) -> float:
    key = "maps.level"
    lowest, highest = format_significant(low, 3), format_significant(high, 3)
    label = f"Cells from the lowest value, {lowest}, up to the highest, {highest} {unit}"
    inputs.slider(label, key, inputs.Span(0.0, 1.0, 0.02, "percent"), view.level, lambda v: session.see(level=v))
    return session.maps().level


def _solid_figure(region: Region, grid: Grid, mask: BoolArray, shown: tuple[FloatArray, Scale] | None) -> Chart:
    dark, robot, view = shell.dark(), region.robot, region.view
    p = palette(dark)
    fig = arm_figure(
        ArmScene(frames=_standing(region), joints=robot.joint_numbers, unit=session.project().view.of("m")),
        dark=dark,
        height=560,
        revision="workspace-solid",
    )
    if mask.any():
        fig.add_traces([voxel_trace(mask, (grid.x, grid.y, grid.z), shown, dark=dark)])
    low, high = np.array(region.box.lower), np.array(region.box.upper)
    largest, _ = fields.box_there(robot, view.A, view.B)
    if largest is not None and view.region != "paper":
        fig.add_traces(wire_box(largest.lower, largest.upper, p.accent, "largest box"))
    if view.region == "paper" or (robot.n >= 5 and view.region != "own"):
        fig.add_traces(wire_box(*PAPER_BOX, p.warm, "reference box"))
        low, high = np.minimum(low, PAPER_BOX[0]), np.maximum(high, PAPER_BOX[1])
    widen(fig, low, high)
    return fig


def _standing(region: Region) -> FloatArray:
    """Frames of the arm in the middle of the region, so that it is drawn where it works."""
    pose = in_hand(region.robot, middle(region.box), region.view.A, region.view.B).pose
    return pose.frames if pose.reached else at_pose(region.robot, region.robot.home).frames
