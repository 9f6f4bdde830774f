"""What gives beside the joints: tool, spindle, bending of the joints, the arm's weight; each with its own line."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import streamlit as st

from robomill.arrays import FloatArray
from robomill.compliance.gravity import LinkMasses
from robomill.compliance.spring import TYPED, Spring
from robomill.compliance.springs import SPRINGS
from robomill.errors import RobotError
from robomill.quantities import Quantity, quantities
from robomill.robot.sources import block_in_force
from robomill.simulation.result import SimulationResult
from robomill.ui import pieces, session
from robomill.ui.entry import declared, grid, inputs
from robomill.ui.entry.box import box_of
from robomill.ui.entry.cells import Cells
from robomill.units import format_si, unit_label

WEIGHT = Cells(("kg", "x mm", "y mm", "z mm"), ["kg", "mm", "mm", "mm"], RobotError)


def inputs_panel() -> None:
    """A switch a kind of spring with its numbers, and the weight of the arm."""
    for kind in SPRINGS.values():
        if kind.each_joint:
            _each_joint(kind)
        else:
            _one(kind)
    _weight()


def _find(kind: type[Spring]) -> list[Any]:
    return [spring for spring in session.project().setup.springs if spring.kind == kind.kind]


def _put(kind: type[Spring], *new: Spring, from_editor: bool = False) -> None:
    """Replace every spring of ``kind`` by ``new``."""
    kept = tuple(spring for spring in session.project().setup.springs if spring.kind != kind.kind)
    session.change(springs=(*kept, *new), from_editor=from_editor)


def _one(kind: type[Spring]) -> None:
    """The switch of a spring at the tool, its numbers, and what it says of itself."""
    cutter, key = session.project().setup.cutter, f"springs.{kind.kind}"
    found = _find(kind)
    inputs.switch(
        kind.title,
        key,
        bool(found),
        lambda on: _put(kind, *([kind.first(cutter)] if on else [])),
        inputs.Look(hint=kind.hint),
    )
    if not found:
        return
    spring: Spring = found[0]
    declared.fields(spring, key, lambda name, v: _put(kind, spring.edited(**{name: v})))
    fitted = spring.fitted(cutter)
    if fitted != spring:
        inputs.button(_otherwise(spring, fitted), f"{key}.same", "sync", _put, kind, fitted, type="tertiary")
    pieces.note(pieces.badge(spring.provenance.kind), spring.facts)


def _otherwise(spring: Spring, fitted: Spring) -> str:
    """What is not as the cutter in the spindle has it, and that it can be taken from there."""
    apart = [q for q in quantities(type(spring)).values() if getattr(spring, q.name) != getattr(fitted, q.name)]
    found = ", ".join(format_si(getattr(spring, q.name), declared.in_view(q.unit), 1) for q in apart)
    return f"It bends as {found}: take the cutter's {', '.join(q.label.lower() for q in apart)}"


def _table_open(title: str, key: str, given: bool, clear: Callable[[], None], hint: str | None) -> bool:
    """The switch of a table; it can stand open before anything is typed into it, and is cleared when switched off."""

    def turn(on: bool) -> None:
        session.keep(key, on)
        if not on:
            clear()
        session.store().revision += 1

    on = given or session.kept(key, False)
    inputs.switch(title, key, on, turn, inputs.Look(hint=hint))
    return on


def _each_joint(kind: type[Spring]) -> None:
    """The switch of a spring that each joint can have, and their table."""
    n, key = session.project().setup.robot.n, f"springs.{kind.kind}"
    springs = {spring.joint: spring for spring in _find(kind)}
    if not _table_open(kind.title, key, bool(springs), lambda: _put(kind), kind.hint):
        return
    columns = joint_columns(kind)
    grid.table(
        f"{key}.table",
        lambda: joint_frame(kind, n, springs),
        lambda frame: _put(kind, *joint_springs(kind, frame), from_editor=True),
        grid.Sheet(
            {q.label: box_of(q) for q in columns if q.kind != "switch"},
            {q.label: st.column_config.CheckboxColumn(q.label) for q in columns if q.kind == "switch"},
            where=lambda row: f"{kind.title}, joint {row + 1}",
            locked=("joint",),
        ),
    )
    units = ", ".join(dict.fromkeys(unit_label(q.unit) for q in columns))
    pieces.note(pieces.badge("user"), f"{units}; 0 is rigid, which is what the paper assumes.")


def joint_columns(kind: type[Spring]) -> list[Quantity]:
    """The declared numbers and switches of a spring that each joint can have, beside the joint itself."""
    return [q for q in quantities(kind).values() if q.name != "joint"]


def joint_frame(kind: type[Any], n: int, springs: Mapping[int, Any]) -> pd.DataFrame:
    """One row a joint with its numbers; joints without the spring as it starts."""
    rows = [springs.get(joint, kind(joint)) for joint in range(1, n + 1)]
    values = {q.label: [getattr(s, q.name) for s in rows] for q in joint_columns(kind)}
    return pd.DataFrame({"joint": [str(s.joint) for s in rows], **values})


def _value(q: Quantity, cell: Any) -> Any:
    """What a cell says: an empty one is 0, or off."""
    if q.kind == "switch":
        return not grid.empty(cell) and bool(cell)
    return 0.0 if grid.empty(cell) else float(cell)


def joint_springs(kind: type[Any], frame: pd.DataFrame) -> list[Any]:
    """The springs of a table; joints whose numbers are all as at the start are left out."""
    found = []
    for i, joint in enumerate(frame["joint"]):
        values = {q.name: _value(q, frame[q.label].iloc[i]) for q in joint_columns(kind)}
        spring = kind(int(joint), **values, provenance=TYPED)
        if spring != kind(int(joint), provenance=TYPED):
            found.append(spring)
    return found


def _weight() -> None:
    setup = session.project().setup
    links = setup.links
    hint = "Sag under the masses of the links and the payload."
    nothing = partial(session.change, links=None, add_sag=False)
    if not _table_open("Weight of the arm", "springs.weight", links is not None, nothing, hint):
        return
    first = st.column_config.TextColumn("joint", width=44)
    sheet = grid.Sheet(WEIGHT.boxes(), {"joint": first}, width=56, where=_weight_of, locked=("joint",))
    grid.table("springs.weight.table", lambda: weight_frame(setup.robot.n, links), _take_weight, sheet)
    if links is None:
        pieces.note("Type the mass that moves with each joint, and its centre in the frame after that joint.")
        return
    declared.field("add_sag")


def _take_weight(frame: pd.DataFrame) -> None:
    links = weight_from(frame)
    add_sag = session.project().setup.add_sag and links is not None
    session.change(links=links, add_sag=add_sag, from_editor=True)


def weight_frame(n: int, links: LinkMasses | None) -> pd.DataFrame:
    """One row a joint: what moves with it, and where its centre of mass is."""
    values = np.zeros((n, 4)) if links is None else np.column_stack([links.mass, links.centre])
    return WEIGHT.frame(values, joint=[str(i + 1) for i in range(n)])


def weight_from(frame: pd.DataFrame) -> LinkMasses | None:
    """The masses of a table; None where every mass is 0. Raises RobotError for a cell that is empty or negative."""
    values = WEIGHT.read(frame, _weight_of)
    return LinkMasses(values[:, 0], values[:, 1:], TYPED) if values[:, 0].any() else None


def _weight_of(row: int) -> str:
    return f"Weight, joint {row + 1}"


def lines(result: SimulationResult, i: int) -> list[tuple[str, FloatArray, str, bool]]:
    """Rows of the result at sample i: what gives, its share (3,) m, its provenance, whether it counts."""
    setup = result.setup
    robot, links = setup.robot, setup.links
    known = {**robot.provenance, **setup.provenance}.get(block_in_force(robot))
    kind = known.kind if known is not None else "user"
    rows: list[tuple[str, FloatArray, str, bool]] = [
        (f"joint {number}", result.delta_joint[i, j], kind, True) for j, number in enumerate(robot.joint_numbers)
    ]
    rows += [
        (spring.name, result.delta_spring[i, k], spring.provenance.kind, True) for k, spring in enumerate(setup.springs)
    ]
    if result.ahead is not None:
        rows.append(("the corrected program", result.ahead[i], "computed", True))
    if result.sag is not None and links is not None:
        rows.append(("sag under the weight", result.sag[i].sum(axis=0), links.provenance.kind, setup.add_sag))
    return rows


def lines_table(result: SimulationResult, i: int) -> None:
    """Who gives how much at the station, joint by joint and spring by spring."""
    unit = session.project().view.length
    rows = [
        (
            name,
            *(_signed(v, unit) for v in share),
            pieces.badge(kind) + ("" if counts else " shown, not added"),
        )
        for name, share, kind, counts in [*lines(result, i), ("together", result.delta[i], "computed", True)]
    ]
    head = ("", *(pieces.subscripts(f"δ_{a}, {unit}") for a in "XYZ"), "")
    pieces.table(rows, " nnn ", head, strong=len(rows) - 1)


def _signed(value: float, unit: str) -> str:
    return format_si(value, unit, 4, sign=True, with_unit=False, missing="–")
