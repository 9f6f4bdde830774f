"""Path deviations of Fig. 8: six straight lines on the borders and through the middle of the region's plane."""

from typing import Any

import numpy as np
import streamlit as st

from robomill.errors import WorkspaceError
from robomill.improve.sensitivity import scaled_shares
from robomill.learn.push import FORCE
from robomill.robot.model import Robot
from robomill.ui import pieces, shell
from robomill.ui.maps import plane
from robomill.ui.maps.plane import Region
from robomill.ui.posed import fields
from robomill.units import format_si, format_significant, from_si, unit_label
from robomill.viz.shares import LinePanel, line_panels


def show(region: Region) -> None:
    """The six lines with their own slider; the total before the what-if factors stays as ghost."""
    robot, box, unit = region.robot, region.box, region.unit
    if fields.flat(robot) not in (None, 2):
        raise WorkspaceError("The six lines lie in a plane of constant Z_M; this arm moves in another plane.")
    across = region.view.normal == "z"
    at = region.at()[1] if across else min(max(0.0, float(box.lower[2])), float(box.upper[2]))
    plane.slider(region, at)
    found = fields.lines(robot, box, region.at()[1] if across else at)
    scale = region.factors
    changed = bool((scale != 1.0).any())
    panels = []
    for line in found:
        by_joint = from_si(line.along_normal(), unit)
        now = scaled_shares(by_joint, scale, -1)
        axis = 0 if abs(line.feed[0]) > 0.5 else 1
        fixed = "YX"[axis]
        panels.append(
            LinePanel(
                f"along {'XY'[axis]}<sub>M</sub>, {fixed}<sub>M</sub> = "
                f"{format_significant(from_si(float(line.p[0, 1 - axis]), unit), 5)}",
                from_si(line.p[:, axis], unit),
                now.sum(axis=1),
                now,
                by_joint.sum(axis=1) if changed else None,
            )
        )
    if not any(np.isfinite(q.total).any() for q in panels):
        st.info("None of the six lines is reached in this plane: move the slider or change the region.")
        return
    titles = [f"{'X' if abs(line.feed[0]) > 0.5 else 'Y'}<sub>M</sub>, {unit_label(unit)}" for line in found]
    pieces.figure(
        line_panels(panels, robot.joint_numbers, titles, unit_label(unit), dark=shell.dark()),
        "lines",
        name="path-lines",
        table=lambda: _line_columns(panels, robot),
        alt="Deviation along six straight lines, total and by joint.",
        caption=f"Fig. 8: borders and middle of the region's plane, {format_si(FORCE, 'N', 0)} normal to the feed "
        "(left of it), deviation along that normal, deflected minus commanded; tool vertical. "
        "Total in black, joints in colour.",
    )
    for words in [words for line in found for words in line.notes()]:
        pieces.note(words)


def _line_columns(panels: list[LinePanel], robot: Robot) -> dict[str, Any]:
    columns: dict[str, Any] = {
        "line": np.repeat([p.title.replace("<sub>M</sub>", "_M") for p in panels], [len(p.s) for p in panels]),
        "s": np.concatenate([p.s for p in panels]),
        "total": np.concatenate([p.total for p in panels]),
    }
    for j, number in enumerate(robot.joint_numbers):
        columns[f"joint {number}"] = np.concatenate([p.by_joint[:, j] for p in panels])
    return columns
