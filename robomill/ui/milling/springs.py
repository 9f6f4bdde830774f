"""What gives beside the joints: tool, spindle, bending of the joints, the arm's weight; each with its own line."""

from __future__ import annotations

import html
from dataclasses import replace as changed
from typing import Any, TypeVar

import numpy as np
import pandas as pd
import streamlit as st

from robomill.arrays import FloatArray
from robomill.compliance.gravity import LinkMasses
from robomill.compliance.springs import JointBending, SpindleSpring, Spring, ToolBending
from robomill.errors import RobotError
from robomill.io.springs import BENDING
from robomill.provenance import Provenance
from robomill.simulation.result import SimulationResult
from robomill.ui import boxes, parts, state
from robomill.ui.editors import table_editor
from robomill.units import format_si, from_si, to_si, unit_label

SPINDLE = SpindleSpring(
    to_si(0.05, "um/N"),
    to_si(0.02, "um/N"),
    provenance=Provenance("assumed", "20 N/µm across and 50 N/µm along, typical of a milling spindle with its holder"),
)
BENDING_ON, WEIGHT_ON = "milling.bending", "milling.weight"
TYPED = Provenance("user", "entered in the app")
Kind = TypeVar("Kind", bound=Spring)


def title() -> str:
    """What is switched on, in a few words."""
    setup = state.project().setup
    words = [spring.name for spring in setup.springs if not isinstance(spring, JointBending)]
    bent = sum(isinstance(spring, JointBending) for spring in setup.springs)
    words += [f"bending of {bent} joint{'s' if bent > 1 else ''}"] if bent else []
    words += ["weight"] if setup.links is not None else []
    return ", ".join(words) or "joints only"


def inputs_panel() -> None:
    """The four switches with their numbers."""
    _tool()
    _spindle()
    _bending()
    _weight()


def _find(kind: type[Kind]) -> Kind | None:
    return next((s for s in state.project().setup.springs if isinstance(s, kind)), None)


def _put(kind: type[Spring], *new: Spring, from_editor: bool = False) -> None:
    """Replace every spring of ``kind`` by ``new``."""
    kept = tuple(s for s in state.project().setup.springs if not isinstance(s, kind))
    state.change(springs=(*kept, *new), from_editor=from_editor)


def _tool() -> None:
    cutter, unit = state.project().setup.cutter, state.project().view.length
    spring = _find(ToolBending)
    length = cutter.stick_out or 4.0 * cutter.diameter
    boxes.switch(
        "Tool bending",
        "springs.tool",
        spring is not None,
        lambda on: _put(ToolBending, *([ToolBending(cutter.diameter, length)] if on else [])),
        hint="The cutter as a cantilever of solid carbide.",
    )
    if spring is None:
        return
    left, right = st.columns(2)
    with left:
        boxes.number_box(
            "Stick-out",
            f"springs.tool.length:{unit}",
            spring.stick_out,
            unit,
            lambda v: _put(ToolBending, changed(spring, stick_out=float(v or 0.0))),
            step=1.0 if unit == "mm" else 0.05,
            digits=1 if unit == "mm" else 3,
        )
    with right:
        boxes.number_box(
            "Bending Ø / Ø",
            "springs.tool.core",
            spring.core,
            "1",
            lambda v: _put(ToolBending, changed(spring, core=float(v or 0.0))),
            step=0.05,
            digits=2,
            hint="Flutes weaken the shank: its bending diameter over the cutter's.",
        )
    if spring.diameter != cutter.diameter:
        st.button(
            f"It bends as {format_si(spring.diameter, unit, 1)}: take the cutter's diameter",
            key="springs.tool.same",
            on_click=lambda: _put(ToolBending, changed(spring, diameter=cutter.diameter)),
            type="tertiary",
            icon=":material/sync:",
        )
    parts.note(f"{parts.badge(spring.provenance.kind)} {format_si(spring.lateral, 'um/N', 4)} across the axis")


def _spindle() -> None:
    spring = _find(SpindleSpring)
    boxes.switch(
        "Spindle and holder",
        "springs.spindle",
        spring is not None,
        lambda on: _put(SpindleSpring, *([SPINDLE] if on else [])),
    )
    if spring is None:
        return
    for column, (label, field) in zip(st.columns(2), (("Across", "lateral"), ("Along", "axial")), strict=True):
        with column:
            boxes.number_box(
                label,
                f"springs.spindle.{field}",
                getattr(spring, field),
                "um/N",
                _writer(spring, field),
                step=0.01,
                digits=4,
            )
    parts.note(f"{parts.badge(spring.provenance.kind)} {html.escape(spring.provenance.source)}")


def _writer(spring: SpindleSpring, field: str) -> Any:
    def write(value: float | None) -> None:
        new: dict[str, Any] = {field: float(value or 0.0)}
        _put(SpindleSpring, changed(spring, provenance=TYPED, **new))

    return write


def _bending() -> None:
    n = state.project().setup.robot.n
    springs = {s.joint: s for s in state.project().setup.springs if isinstance(s, JointBending)}
    boxes.switch(
        "Bending of joints",
        "springs.bending",
        bool(springs) or st.session_state.get(BENDING_ON, False),
        _switch_bending,
        hint="Tilting of a joint's bearing and link about the x and y axes of its frame.",
    )
    if not (springs or st.session_state.get(BENDING_ON)):
        return
    table_editor(
        "springs.bending",
        lambda: bending_frame(n, springs),
        lambda frame: _put(JointBending, *bending_from(frame), from_editor=True),
        locked=("joint",),
        columns={c: st.column_config.NumberColumn(c, format="%.4g", min_value=0.0) for c in ("about x", "about y")},
    )
    parts.note(f"{parts.badge('user')} {unit_label(BENDING)}; 0 is rigid, which is what the paper assumes.")


def _switch_bending(on: bool) -> None:
    st.session_state[BENDING_ON] = on
    if not on:
        _put(JointBending)
    state.store().revision += 1


def bending_frame(n: int, springs: dict[int, JointBending]) -> pd.DataFrame:
    """One row a joint: its bending compliances about x and y."""
    rows = [springs.get(joint, JointBending(joint)) for joint in range(1, n + 1)]
    values = {f"about {a}": [from_si(getattr(s, f"C_{a}"), BENDING) for s in rows] for a in "xy"}
    return pd.DataFrame({"joint": [str(s.joint) for s in rows], **values})


def bending_from(frame: pd.DataFrame) -> list[JointBending]:
    """The springs of a table; joints that do not bend are left out."""
    found = []
    for joint, about_x, about_y in zip(frame["joint"], frame["about x"], frame["about y"], strict=True):
        C_x, C_y = (to_si(0.0 if pd.isna(v) else float(v), BENDING) for v in (about_x, about_y))
        spring = JointBending(int(joint), C_x, C_y, provenance=TYPED)
        if C_x > 0 or C_y > 0:
            found.append(spring)
    return found


def _weight() -> None:
    setup = state.project().setup
    links = setup.links
    boxes.switch(
        "Weight of the arm",
        "springs.weight",
        links is not None or st.session_state.get(WEIGHT_ON, False),
        _switch_weight,
        hint="Sag under the masses of the links and the payload.",
    )
    if links is None and not st.session_state.get(WEIGHT_ON):
        return
    table_editor(
        "springs.weight",
        lambda: weight_frame(setup.robot.n, links),
        lambda frame: _take_weight(frame),
        locked=("joint",),
        columns={"joint": st.column_config.TextColumn("joint", width=44)}
        | {c: st.column_config.NumberColumn(c, format="%.6g", width=56) for c in WEIGHT_COLUMNS},
    )
    if links is None:
        parts.note("Type the mass that moves with each joint, and its centre in the frame after that joint.")
        return
    boxes.switch(
        "Add the sag to the deviation",
        "springs.add_sag",
        setup.add_sag,
        lambda on: state.change(add_sag=on),
        hint="Off: shown only. A part is zeroed with the arm already sagged.",
    )


WEIGHT_COLUMNS = ("kg", "x mm", "y mm", "z mm")


def _switch_weight(on: bool) -> None:
    st.session_state[WEIGHT_ON] = on
    if not on:
        state.change(links=None, add_sag=False)
    state.store().revision += 1


def _take_weight(frame: pd.DataFrame) -> None:
    links = weight_from(frame)
    add_sag = state.project().setup.add_sag and links is not None
    state.change(links=links, add_sag=add_sag, from_editor=True)


def weight_frame(n: int, links: LinkMasses | None) -> pd.DataFrame:
    """One row a joint: what moves with it, and where its centre of mass is."""
    mass, centre = (np.zeros(n), np.zeros((n, 3))) if links is None else (links.mass, from_si(links.centre, "mm"))
    columns = {c: centre[:, i] for i, c in enumerate(WEIGHT_COLUMNS[1:])}
    return pd.DataFrame({"joint": [str(i + 1) for i in range(n)], "kg": mass, **columns})


def weight_from(frame: pd.DataFrame) -> LinkMasses | None:
    """The masses of a table; None where every mass is 0. Raises RobotError for a cell that is empty or negative."""
    numbers = frame[list(WEIGHT_COLUMNS)].to_numpy(dtype=float, na_value=np.nan)
    if not np.isfinite(numbers).all():
        row, column = np.argwhere(~np.isfinite(numbers))[0]
        raise RobotError(f"Weight, joint {row + 1}: {WEIGHT_COLUMNS[column]} is empty; type a number, 0 for none.")
    if not numbers[:, 0].any():
        return None
    return LinkMasses(numbers[:, 0], to_si(numbers[:, 1:], "mm"), TYPED)


def lines(result: SimulationResult, i: int) -> list[tuple[str, FloatArray, str, bool]]:
    """Rows of the result at sample i: what gives, its share (3,) m, its provenance, whether it counts."""
    robot = result.setup.robot
    given = {**robot.provenance, **result.setup.provenance}
    known = given.get(f"compliance.{robot.compliance_set}")
    kind = known.kind if known is not None else "user"
    rows: list[tuple[str, FloatArray, str, bool]] = [
        (f"joint {number}", result.delta_joint[i, j], kind, True) for j, number in enumerate(robot.joint_numbers)
    ]
    rows += [
        (spring.name, result.delta_spring[i, k], spring.provenance.kind, True)
        for k, spring in enumerate(result.setup.springs)
    ]
    if result.sag is not None and result.setup.links is not None:
        rows.append(
            (
                "sag under the weight",
                result.sag[i].sum(axis=0),
                result.setup.links.provenance.kind,
                result.setup.add_sag,
            )
        )
    return rows


def lines_table(result: SimulationResult, i: int) -> None:
    """Who gives how much at the station, joint by joint and spring by spring."""
    unit = result_unit()
    body = ""
    for name, share, kind, counts in [*lines(result, i), ("together", result.delta[i], "computed", True)]:
        cells = "".join(f'<td class="n">{_number(float(v), unit)}</td>' for v in share)
        remark = "" if counts else " shown, not added"
        strong = ' style="font-weight:600"' if name == "together" else ""
        body += f"<tr{strong}><td>{html.escape(name)}</td>{cells}<td>{parts.badge(kind)}{remark}</td></tr>"
    head = "".join(f'<th class="n">δ<sub>{a}</sub>, {unit}</th>' for a in "XYZ")
    st.html(f'<table class="rm-facts"><tr><th></th>{head}<th></th></tr>{body}</table>')


def result_unit() -> str:
    """The unit of deviations."""
    return state.project().view.length


def _number(value: float, unit: str) -> str:
    return format_si(value, unit, 4, sign=True, with_unit=False, missing="–")
