"""The pictures of the compliance page: nine maps, joint shares, dominant joint, six lines, comparison."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.compliance.components import COMPONENTS, CROSS, DIRECT, symmetric
from robomill.ui import declared, fields, inputs, pieces, session, shell
from robomill.ui.maps import compare, lines, plane
from robomill.ui.maps.plane import Region
from robomill.ui.point import default_point
from robomill.units import NOT_REACHED, format_many, format_number, from_si, to_si, unit_label
from robomill.viz.maps import Map, MapSheet, Scale, picked_point, sheet_figure, symmetric_limit
from robomill.workspace.fields import ComplianceField
from robomill.workspace.quantities import map_quantities

MATRIX = symmetric(np.array(COMPONENTS)).tolist()
ROWS = {"direct": DIRECT, "cross": CROSS}
UM = "um/N"


@st.fragment
def picture() -> None:
    """The picture with its own controls; a slider step redraws this part alone, a click opens the point's report."""
    plane.picture("sheet", _show)


def _show(region: Region) -> None:
    sheet = region.view.sheet
    if sheet == "lines":
        lines.show(region)
        return
    plane.slider(region, *region.at())
    normal, at = region.at()
    known = region.field(region.grid(normal, at))
    if sheet != "compare" and not known.reached.any():
        st.info("No cell of this plane is reached: move the slider, change the tilt or the region.")
        return
    _SHEETS[sheet](Slice(region, normal, at, known))


@dataclass(frozen=True, eq=False)
class Slice:
    """The plane of a picture: where it cuts the region, and what is known over it with the joints as they are."""

    region: Region
    normal: str
    at: float
    known: ComplianceField

    def slab(self, values: FloatArray) -> FloatArray:
        """(nu, nv) from the plane's (nx, ny, nz)."""
        return values.squeeze(axis="xyz".index(self.normal))

    def stiffer(self) -> ComplianceField:
        """The same with the what-if factors in force."""
        return fields.stiffer(self.known, self.region.factors)

    def sheet(self, rows: list[list[Map | None]], scales: dict[str, Scale]) -> MapSheet:
        """Panels over the plane with the point in hand marked."""
        unit, grid = self.region.unit, self.known.grid
        u, v = (a for a in "xyz" if a != self.normal)
        point = dict(zip("xyz", default_point(self.region.view, self.region.box, self.known), strict=True))
        here = (float(from_si(point[u], unit)), float(from_si(point[v], unit)))
        on_plane = abs(point[self.normal] - self.at) < 1e-6
        return MapSheet.over(rows, grid, self.normal, unit, scales, point=here, on_plane=on_plane)


def draw(cut: Slice, drawn: MapSheet, key: str, caption: str, alt: str, table: Callable[[], Any]) -> None:
    """Show a sheet, ``key`` in its file's name; a click makes its cell the point in hand and runs the page again."""
    ratio = float(np.ptp(drawn.v) / max(np.ptp(drawn.u), 1e-9)) if len(drawn.u) > 1 and len(drawn.v) > 1 else 0.6
    most = {1: 400, 2: 240}.get(len(drawn.rows), 165)
    least = 88 if len(drawn.scales) == 1 else 130  # the title of a colour bar stands along it
    panel = int(min(max(700 / max(len(drawn.rows[0]), 2) * ratio, least), most))
    revision = f"{key}-{cut.normal}"
    fig = sheet_figure(drawn, dark=shell.dark(), panel_height=panel, revision=revision, gap_x=0.03, gap_y=34)
    widget = f"sheet-{key}"

    def take(point: Mapping[str, Any]) -> None:
        found = picked_point(drawn.u, drawn.v, float(point["x"]), float(point["y"]))
        session.keep("maps.clicked", (cut.normal, cut.at, found))

    pieces.figure(
        fig,
        widget,
        name=f"compliance-{key}",
        caption=caption,
        alt=alt,
        table=table,
        on_pick=take,
    )
    clicked = session.drop("maps.clicked")
    if clicked is not None:
        _open(clicked)


def _open(clicked: tuple[str, float, tuple[float, float]]) -> None:
    normal, at, (u, v) = clicked
    unit = session.project().view.length
    point = {normal: at}
    for name, shown in zip((a for a in "xyz" if a != normal), (u, v), strict=True):
        point[name] = float(to_si(shown, unit))
    session.see(point=(point["x"], point["y"], point["z"]))
    st.rerun(scope="app")


def _columns(known: ComplianceField, names: list[str]) -> Any:
    from robomill.io.maps import map_columns

    return map_columns([known.field(name) for name in names])


def _nine(cut: Slice) -> None:
    view, known, now = cut.region.view, cut.known, cut.stiffer()
    whole = from_si(cut.region.overview().total, UM)
    direct, cross = whole[..., :3], whole[..., 3:]
    if view.common:
        scales = dict.fromkeys(("main", "cross"), Scale.signed(f"C, {unit_label(UM)}", [whole]))
    else:
        low = float(np.nanmin(direct)) if np.isfinite(direct).any() else 0.0
        scales = {
            "main": Scale(f"direct, {unit_label(UM)}", low, symmetric_limit([direct])),
            "cross": Scale.signed(f"cross, {unit_label(UM)}", [cross]),
        }
    rows: list[list[Map | None]] = []
    for i, names in enumerate(MATRIX):
        row: list[Map | None] = []
        for j, c in enumerate(names):
            k = COMPONENTS.index(c)
            shown = cut.slab(from_si(now.total[..., k], UM))
            change = shown - cut.slab(from_si(known.total[..., k], UM))
            title = f"<b>C<sub>{'xyz'[i]}{'xyz'[j]}</sub></b><br>{extremes(shown)}" + _moved(change)
            row.append(Map(title, shown, "main" if view.common or i == j else "cross", unit_label(UM)))
        rows.append(row)
    about = (
        "One scale for all nine, centred on zero: the robot's own largest value over the region, so colours stay "
        "while the plane moves."
        if view.common
        else "Direct terms on a scale of sizes, cross terms on one centred on zero."
    )
    draw(
        cut,
        cut.sheet(rows, scales),
        "nine",
        f"{about} Click a cell for the report of that pose.",
        "The nine components of the compliance matrix over the plane.",
        lambda: _columns(now, [f"C_{c}" for c in COMPONENTS]),
    )


def extremes(values: FloatArray) -> str:
    """The range of a map in words."""
    if not np.isfinite(values).any():
        return NOT_REACHED
    return format_many((np.nanmin(values), np.nanmax(values)), "1", 2, " … ")


def _moved(change: FloatArray) -> str:
    if not np.isfinite(change).any() or np.nanmax(np.abs(change)) < 5e-4:
        return ""
    return f"  <i>({format_number(np.nanmean(change), 2, sign=True)} mean)</i>"


def _shares(cut: Slice) -> None:
    robot = cut.region.robot
    kind = declared.seen("maps.shares", inputs.HIDDEN)
    now = cut.stiffer()
    index = [COMPONENTS.index(c) for c in ROWS[kind]]
    whole = from_si(cut.region.overview().shares[..., index], UM)
    scale = Scale.signed(f"share, {unit_label(UM)}", [whole])
    if kind == "direct":
        scale = Scale(scale.title, 0.0, scale.high)
    rows: list[list[Map | None]] = []
    for c, k in zip(ROWS[kind], index, strict=True):
        values = from_si(now.shares[..., k], UM)
        rows.append(
            [
                Map(
                    f"C<sub>{c}</sub> joint {number}  {_mean(values[..., j])}",
                    cut.slab(values[..., j]),
                    unit=unit_label(UM),
                )
                for j, number in enumerate(robot.joint_numbers)
            ]
        )
    how = "sizes, from zero" if kind == "direct" else "signed, centred on zero"
    draw(
        cut,
        cut.sheet(rows, {"main": scale}),
        f"shares-{kind}",
        f"Each joint's summand of eq. (16), mean beside its name; one scale, {how}. Joints in a row add up to the map.",
        "Shares of each joint in the compliance over the plane.",
        lambda: _columns(now, [f"C_{c}_{j}" for c in ROWS[kind] for j in range(1, robot.n + 1)]),
    )


def _mean(values: FloatArray) -> str:
    return format_number(np.nanmean(values), 2) if np.isfinite(values).any() else "none"


def _dominant(cut: Slice) -> None:
    now = cut.stiffer()

    def panel(title: str, name: str) -> Map:
        return Map(title, cut.slab(now.values(name)))

    rows: list[list[Map | None]] = [
        [
            panel("<b>all three directions</b>", "dominant"),
            *(panel(f"C<sub>{c}</sub>", f"dominant_C_{c}") for c in ROWS["direct"]),
        ],
        [None, *(panel(f"C<sub>{c}</sub>", f"dominant_C_{c}") for c in ROWS["cross"])],
    ]
    scale = Scale("", 0, 1, "joints", joints=cut.region.robot.joint_numbers)
    draw(
        cut,
        cut.sheet(rows, {"main": scale}),
        "dominant",
        "The joint with the largest share: where to stiffen first. Parts of cross terms have two signs and cancel: "
        "there the largest by size is shown, and without it the term may grow.",
        "The joint that gives most, over the plane.",
        lambda: _columns(now, ["dominant", *(f"dominant_C_{c}" for c in COMPONENTS)]),
    )


def _one(cut: Slice) -> None:
    """Any quantity that rests on the joints' compliance, found by asking for them."""
    robot = cut.region.robot
    known = map_quantities(robot, "compliance")
    titles = {name: what.title for name, what in known.items()}
    chosen = declared.seen("maps.one", inputs.LISTED, titles, "Quantity")
    what, now = known[chosen], cut.stiffer()
    whole = from_si(cut.region.overview().values(chosen), what.unit)
    title = f"{what.title}, {plane.title(cut.normal, cut.at, cut.region.unit)}"
    shown = cut.slab(from_si(now.values(chosen), what.unit))
    draw(
        cut,
        cut.sheet(
            [[Map(title, shown, unit=unit_label(what.unit))]], {"main": Scale.of(what, whole, robot.joint_numbers)}
        ),
        "one",
        f"{what.meaning} One scale over the region.",
        f"{what.title} over the plane.",
        lambda: _columns(now, [chosen]),
    )


def _compare(cut: Slice) -> None:
    robot = cut.region.robot
    compare.controls(robot, cut.region.view)
    rows, scales, rows_of_text, columns = compare.panels(robot, session.maps(), cut.known, cut.normal)
    draw(
        cut,
        cut.sheet(rows, scales),
        "compare",
        "The compared ones on one scale; the difference to the first on its own, centred on zero.",
        "The same compliance of up to three robots or compliance sets, and the differences.",
        lambda: columns,
    )
    pieces.facts(rows_of_text)


_SHEETS = {"nine": _nine, "one": _one, "shares": _shares, "dominant": _dominant, "compare": _compare}
