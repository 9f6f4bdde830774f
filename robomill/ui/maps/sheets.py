"""The pictures of the compliance page: nine maps, joint shares, dominant joint, six lines, comparison."""

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.compliance.components import COMPONENTS, CROSS, DIRECT, symmetric
from robomill.paper import Point
from robomill.robot.model import Robot
from robomill.ui import pieces, session
from robomill.ui.entry import declared, inputs
from robomill.ui.maps import board, compare, lines, plane, sides
from robomill.ui.maps.board import Planes
from robomill.ui.maps.plane import Region
from robomill.ui.posed.point import InHand
from robomill.units import format_number, from_si, unit_label
from robomill.viz.maps import Scale
from robomill.viz.planes import PlaneMap, ends, extremes, means
from robomill.workspace.quantities import map_quantities

MATRIX = symmetric(np.array(COMPONENTS)).tolist()
NAMES = tuple(f"C_{c}" for c in COMPONENTS)
ROWS = {"direct": DIRECT, "cross": CROSS}
UM = "um/N"
WIDE = 730  # px of a picture where the window is wide


@st.fragment
def picture(found: InHand) -> None:
    """The picture with its own controls: a click selects another point, the planes are looked through in the
    browser."""
    with st.container(key="maps-room"):
        plane.picture("sheet", partial(_show, found.point))


def _show(selected: Point, region: Region) -> None:
    region = dataclasses.replace(region, selected=selected)
    sheet = region.view.sheet
    if sheet == "lines":
        lines.show(region)
        return
    if sheet != "compare" and not region.overview().reached.any():
        st.info("Nothing of this region is reached: change the tilt or the region.")
        return
    _SHEETS[sheet](region)


def um() -> str:
    """The unit of compliance in force."""
    return session.project().view.of(UM)


def stiffer(region: Region) -> Robot:
    """The robot with the what-if factors in force."""
    return sides.looked_at(region.robot, region.factors)


def draw(
    planes: Planes,
    rows: list[list[PlaneMap | None]],
    scales: dict[str, Scale],
    key: str,
    caption: str,
    table: Callable[[], Mapping[str, Any]],
) -> None:
    """Show a board, ``key`` in its file's name, with its caption and table."""
    region = planes.region
    normal = planes.normal
    most = {1: 420, 2: 250}.get(len(rows), 150)
    sheet = planes.sheet(rows, scales, WIDE, most)
    board.board(
        planes,
        sheet,
        f"compliance-{key}",
        [region.at()[1]],
        lambda at: session.see(at=at[0], normal=normal),
        region.selected,
    )
    board.beneath(caption, table, f"compliance-{key}")


def _columns(planes: Planes, robot: Robot, names: Sequence[str]) -> Mapping[str, Any]:
    from robomill.io.maps import map_columns

    known = planes.known(robot)
    return map_columns([known.field(name) for name in names])


def _nine(region: Region) -> None:
    view, planes, unit = region.view, Planes.of(region, len(NAMES)), um()
    which = sides.side(stiffer(region))
    now = which.codes(planes, NAMES)
    # What the factors change is said beside the maps of the project in force only.
    before = planes.codes(NAMES) if which.name == "a" and which.a is not region.robot else now
    rows: list[list[PlaneMap | None]] = []
    for i, names in enumerate(MATRIX):
        row: list[PlaneMap | None] = []
        for j, c in enumerate(names):
            codes = now[f"C_{c}"]
            notes = extremes(codes, unit)
            if before is not now:
                change = from_si(codes.mean - before[f"C_{c}"].mean, unit)
                notes = [note + _moved(by) for note, by in zip(notes, change, strict=True)]
            scale = "main" if view.common or i == j else "cross"
            row.append(PlaneMap(f"C_{'xyz'[i]}{'xyz'[j]}", codes, unit, scale, notes))
        rows.append(row)
    about = (
        "One scale, centred on zero."
        if view.common
        else "The middle of the colours is zero."
        if which.name == "apart"
        else "Direct terms: dark is stiff. Cross terms: the middle of the colours is zero."
    )
    draw(
        planes,
        rows,
        _scales_of_nine(which, planes, view.common, unit),
        which.file("nine"),
        f"{which.about}{about} Click a cell to select it.",
        lambda: which.columns(planes, NAMES),
    )


def _scales_of_nine(which: sides.Side, planes: Planes, common: bool, unit: str) -> dict[str, Scale]:
    """The scales of the direct and of the cross terms; one scale for both where it is ``common``."""
    label, drawn = unit_label(unit), which.both(planes, NAMES)
    direct, cross = (ends([each[f"C_{c}"] for each in drawn for c in ROWS[k]], unit) for k in ("direct", "cross"))
    if common:
        return {"main": Scale.signed(f"C, {label}", [direct, cross])}
    title = f"direct terms, {label}"
    main = Scale.signed(title, [direct]) if which.name == "apart" else Scale(title, *span(direct))
    return {"main": main, "cross": Scale.signed(f"cross terms, {label}", [cross])}


def span(values: FloatArray) -> tuple[float, float]:
    """The lowest and the highest of them; 0 to 1 where there are none."""
    return (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)


def _moved(change: float) -> str:
    if not abs(change) >= 5e-4:
        return ""
    return f"  ({format_number(change, 2, sign=True)} mean)"


def _shares(region: Region) -> None:
    kind = declared.seen("maps.shares", inputs.HIDDEN)
    robot, unit = region.robot, um()
    planes = Planes.of(region, len(ROWS[kind]) * robot.n)
    names = [f"C_{c}_{j + 1}" for c in ROWS[kind] for j in range(robot.n)]
    known, now = planes.codes(names), planes.codes(names, stiffer(region))
    scale = Scale.signed(f"share, {unit_label(unit)}", [ends(list(known.values()), unit)])
    if kind == "direct":
        scale = Scale(scale.title, 0.0, scale.high)
    rows: list[list[PlaneMap | None]] = []
    for c in ROWS[kind]:
        found = [now[f"C_{c}_{j + 1}"] for j in range(robot.n)]
        rows.append(
            [
                PlaneMap(f"C_{c}, joint {number}", codes, unit, notes=means(codes, unit, 2))
                for number, codes in zip(robot.joint_numbers, found, strict=True)
            ]
        )
    how = "from zero: dark is stiff" if kind == "direct" else "signed, zero in the middle of the colours"
    draw(
        planes,
        rows,
        {"main": scale},
        f"shares-{kind}",
        f"What each joint adds (eq. 16), mean beside its name; one scale, {how}. The joints of a row add up.",
        lambda: _columns(planes, stiffer(region), names),
    )


def _dominant(region: Region) -> None:
    robot = stiffer(region)
    names = ["dominant", *(f"dominant_C_{c}" for c in COMPONENTS)]
    planes = Planes.of(region, len(names))
    now = planes.codes(names, robot)

    def panel(title: str, name: str) -> PlaneMap:
        return PlaneMap(title, now[name], "1")

    rows: list[list[PlaneMap | None]] = [
        [panel("all three directions", "dominant"), *(panel(f"C_{c}", f"dominant_C_{c}") for c in ROWS["direct"])],
        [None, *(panel(f"C_{c}", f"dominant_C_{c}") for c in ROWS["cross"])],
    ]
    scale = Scale("", 0, 1, "joints", joints=region.robot.joint_numbers)
    draw(
        planes,
        rows,
        {"main": scale},
        "dominant",
        "The joint with the largest share: where to stiffen first. Parts of cross terms have two signs and cancel: "
        "there the largest by size is shown, and without it the term may grow.",
        lambda: _columns(planes, robot, names),
    )


def _one(region: Region) -> None:
    """Any quantity that rests on the joints' compliance, found by asking for them."""
    robot = region.robot
    known = map_quantities(robot, "compliance")
    titles = {name: what.title for name, what in known.items()}
    chosen = declared.seen("maps.one", inputs.LISTED, titles, "Quantity")
    what = known[chosen]
    which = sides.of_quantity(what, stiffer(region))
    planes = Planes.of(region, 1)
    unit = session.project().view.of(what.unit)
    scale = which.scale(what, planes, unit)
    codes = which.codes(planes, [chosen])[chosen]
    notes = extremes(codes, unit) if scale.kind not in ("joints", "reach") else ()
    draw(
        planes,
        [[PlaneMap(what.title, codes, unit, notes=notes)]],
        {"main": scale},
        which.file("one"),
        which.about + what.meaning,
        lambda: which.columns(planes, [chosen]),
    )


def _compare(region: Region) -> None:
    compare.controls(region.robot, region.view)
    region = dataclasses.replace(region, view=session.maps())
    planes = Planes.of(region, 2 * compare.MOST - 1)
    found = compare.panels(planes, um())
    draw(
        planes,
        found.rows,
        found.scales,
        "compare",
        "The compared ones on one scale; the difference to the first on its own: the middle of its colours is zero.",
        lambda: found.columns(planes),
    )
    pieces.facts(found.words(planes))


_SHEETS = {"nine": _nine, "one": _one, "shares": _shares, "dominant": _dominant, "compare": _compare}
