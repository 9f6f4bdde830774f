"""Maps over all planes of a region, drawn by the browser: looking through them asks nothing of the server.

The planes go there once; back come the plane that was settled on and the cell that was clicked.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import streamlit as st

from robomill.arrays import FloatArray
from robomill.paper import Point
from robomill.robot.model import Robot
from robomill.ui import pieces, session, shell
from robomill.ui.component import component
from robomill.ui.maps import outlines
from robomill.ui.maps.plane import Region
from robomill.ui.posed import fields
from robomill.units import from_si
from robomill.viz.maps import Scale
from robomill.viz.planes import Codes, PlaneMap, PlaneSheet, sheet_data
from robomill.workspace.fields import ComplianceMap
from robomill.workspace.grid import Grid

_component = component("robomill_maps", __file__)
_codes = component(
    "robomill_codes", str(Path(__file__).with_name("codes.py")), html="<i></i>", css="i { display: none }"
)


@dataclass(frozen=True, eq=False)
class Planes:
    """The planes of a picture: those ``normal`` to an axis of {M}, over the cells of ``grid``."""

    region: Region
    normal: str
    grid: Grid

    @classmethod
    def of(cls, region: Region, maps: int) -> "Planes":
        """For a picture of so many maps."""
        normal, _ = region.at()
        grid = fields.planes(region.robot, region.view, region.box, normal, region.unit, maps)
        return cls(region, normal, grid)

    @property
    def w(self) -> FloatArray:
        """Where they are, (nw,) m."""
        return getattr(self.grid, self.normal)  # type: ignore[no-any-return]

    def nearest(self, at: float) -> int:
        """The plane next to ``at`` (m)."""
        return int(np.abs(self.w - at).argmin())

    def codes(self, names: Sequence[str], robot: Robot | None = None) -> Mapping[str, Codes]:
        """Quantities over all planes, of the region's robot or another."""
        view = self.region.view
        return fields.coded_maps(robot or self.region.robot, self.grid, self.normal, view.A, view.B, tuple(names))

    def known(self, robot: Robot | None = None, at: float | None = None) -> ComplianceMap:
        """All that is known over one plane: the one in force, or that next to ``at``."""
        view = self.region.view
        w = self.w[[self.nearest(self.region.at()[1] if at is None else at)]]
        grid = Grid(*(w if axis == self.normal else getattr(self.grid, axis) for axis in "xyz"))
        return fields.field(robot or self.region.robot, grid, view.A, view.B)

    def sheet(self, rows: list[list[PlaneMap | None]], scales: dict[str, Scale], width: int, most: int) -> PlaneSheet:
        """Panels over the planes, with what the project cuts."""
        unit = self.region.unit
        u, v = (axis for axis in "xyz" if axis != self.normal)
        across, upwards, through = (from_si(getattr(self.grid, axis), unit) for axis in (u, v, self.normal))
        letters = (u.upper(), v.upper(), self.normal.upper())
        cut = outlines.seen_along(session.project().setup, self.normal, unit)
        return PlaneSheet(rows, across, upwards, through, letters, unit, scales, cut, width, most)

    def point(self, cell: Sequence[int]) -> Point:
        """The point of a cell (i, j, plane) in {M}, m."""
        u, v = (axis for axis in "xyz" if axis != self.normal)
        found = {u: getattr(self.grid, u)[cell[0]], v: getattr(self.grid, v)[cell[1]], self.normal: self.w[cell[2]]}
        return float(found["x"]), float(found["y"]), float(found["z"])


def board(
    planes: Planes,
    sheet: PlaneSheet,
    key: str,
    at: Sequence[float],
    settle: Callable[[list[float]], None],
    point: Point | None = None,
) -> None:
    """The board ``key`` with a slider for each of the planes ``at`` (m), which ``settle`` gets once they were moved.

    A click makes its cell the selected point, which is marked, and has the page run again.
    """
    data = sheet_data(sheet, dark=shell.dark())
    place = None
    if point is not None:
        seen = dict(zip("XYZ", point, strict=True))
        place = [float(from_si(seen[letter], planes.region.unit)) for letter in sheet.axes]
    data |= {"at": [planes.nearest(each) for each in at], "point": place, "file": key}
    name = f"board-{key}"
    st.html(f"<style>@media (min-width: 1081px) {{ .st-key-{name} {{ min-height: {data['height']}px; }} }}</style>")
    # By themselves: they stay as they are while the plane and the point move, so that the browser keeps them.
    _codes(key=f"codes-{key}", data={"rev": data["rev"], "codes": data.pop("codes")})
    _component(
        key=name,
        data=data,
        on_plane_change=partial(_settled, name, data["rev"], planes, settle),
        on_cell_change=partial(_picked, name, data["rev"], planes, settle),
    )
    if session.drop("maps.clicked"):
        st.rerun(scope="app")


def _sent(name: str, event: str, rev: str) -> Any:
    # The component's own state: Streamlit puts there what the browser sends. Of other planes it means nothing here.
    sent = st.session_state[name].get(event)
    return sent if sent and sent.get("rev") == rev else None


def _settled(name: str, rev: str, planes: Planes, settle: Callable[[list[float]], None]) -> None:
    sent = _sent(name, "plane", rev)
    if sent:
        settle([float(planes.w[k]) for k in sent["at"]])


def _picked(name: str, rev: str, planes: Planes, settle: Callable[[list[float]], None]) -> None:
    sent = _sent(name, "cell", rev)
    if sent:
        settle([float(planes.w[k]) for k in sent["at"]])
        session.see(point=planes.point(sent["cell"]))
        session.keep("maps.clicked", True)


def beneath(caption: str, table: Callable[[], Mapping[str, Any]], name: str) -> None:
    """What stands under a board: what it shows in words, and the numbers of the plane in force."""
    with st.container(horizontal=True, vertical_alignment="center", horizontal_alignment="distribute", gap="small"):
        pieces.note(caption)
        pieces.table_twin(table, name)
