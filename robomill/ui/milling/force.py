"""The force on the tool: which model, its numbers, engagement and coupling."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import streamlit as st

from robomill.cutting.force import ForceModel, MeanForce
from robomill.cutting.forces import FORCES
from robomill.cutting.forces.measured import ForceRecord, MeasuredForce
from robomill.cutting.materials import Material
from robomill.cutting.tool import Cutter
from robomill.errors import RobomillError
from robomill.io.forces import read_forces
from robomill.quantities import declared_types, quantities
from robomill.ui import cached, inputs, pieces, session
from robomill.ui.milling import materials as material_panel
from robomill.ui.milling.numbers import boxes_of, draw
from robomill.units import format_count

PENDING = "milling.force.pending"
FILE = "milling.force.file"
MAX_FORCE_MB = 60


def inputs_panel() -> None:
    """Model, numbers, engagement, coupling."""
    setup = session.project().setup
    force: ForceModel | None = setup.force
    current = setup.force.kind
    # Asked for, but what it needs is not there yet; any change of the project makes an end of the wait.
    digest, wanted = st.session_state.get(PENDING, ("", ""))
    if digest == setup.digest() and wanted != current:
        force, current = None, wanted
    titles = {kind: model.title for kind, model in FORCES.items()}
    inputs.choice("Model", "force.kind", titles, current, _switch, inputs.LISTED)
    for kind in declared_types(FORCES[current]).values():
        if kind in EDITORS:
            EDITORS[kind](force)
    if force is not None:
        boxes_of(force, "force", _write, force.unit_of)
        if force.hint:
            pieces.note(force.hint)
        if force.stated:
            provenance = setup.provenance.get("force", force.provenance)
            pieces.note(f"{pieces.badge(provenance.kind)} {pieces.subscripts(provenance.source)}")
    _process_switches(force is not None and force.follows_cut)


def _write(name: str, value: Any) -> None:
    session.change(label=f"force.{name}", force=replace(session.project().setup.force, **{name: value}))  # type: ignore[type-var]


def _process_switches(process: bool) -> None:
    setup = session.project().setup
    said = quantities(type(setup))
    draw(
        said["engagement"],
        "setup.engagement",
        setup.engagement,
        lambda on: session.change(engagement=on, coupling=setup.coupling and on),
    )
    draw(
        said["coupling"],
        "setup.coupling",
        setup.coupling,
        lambda on: session.change(coupling=on),
        disabled=not (setup.engagement and process),
    )


def _switch(kind: str) -> None:
    """Another model, with what its fields start from; one that needs what is not there yet waits for it."""
    setup = session.project().setup
    st.session_state.pop(PENDING, None)
    if kind == setup.force.kind:
        return
    model = FORCES[kind]
    given: dict[str, Any] = {}
    for name, wanted in declared_types(model).items():
        if wanted is Cutter:
            given[name] = setup.cutter
        elif wanted is Material:
            given[name] = material_panel.rows(model.takes)[model.example]
        elif wanted == tuple[Material, ...]:
            given[name] = material_panel.others(given["material"])
        elif wanted is ForceRecord:
            st.session_state[PENDING] = (setup.digest(), kind)
            return
    follows = model.follows_cut
    session.change(
        force=model(**model.first(_mean_force()), **given),
        engagement=setup.engagement or follows,
        coupling=setup.coupling and follows,
    )


def _mean_force() -> MeanForce:
    """The force at the worst point in {M} and along the path, so that switching changes as little as can be."""
    try:
        result = cached.result(session.project().setup)
    except RobomillError:
        result = None
    if result is None or result.worst < 0:
        return MeanForce(np.array([0.0, 100.0, 0.0]), np.array([0.0, 100.0, 0.0]))
    i = result.worst
    return MeanForce(np.round(result.F[i], 6) + 0.0, np.round(result.force_components[i], 6) + 0.0)


def _record(force: Any) -> None:
    """The file of a measured force, and what was read from it."""
    key = f"force:file:{session.store().revision if force is None else 'kept'}"
    st.file_uploader(
        "Force record (.csv): t_s or s_mm, then F_feed_N, F_feed_normal_N, F_axial_N, or F_x_N, F_y_N, F_z_N",
        key=key,
        max_upload_size=MAX_FORCE_MB,
        on_change=lambda: _take(st.session_state.get(key)),
    )
    left, right = st.columns(2)
    left.segmented_control(
        "The sensor felt the force on the",
        ["tool", "part"],
        default="tool",
        required=True,
        key="force:on",
        on_change=_again,
        width="stretch",
    )
    right.checkbox(
        "Trust the unit",
        key="force:trust",
        on_change=_again,
        help="Accept forces whose size looks like another unit (mN, kN).",
    )
    inputs.sentence("force:file")
    if force is None:
        if not session.store().refused.get("force:file"):
            pieces.note("Until a record is given, the force stays as it was.")
        return
    samples, provenance = format_count(len(force.record.x), "sample"), force.provenance
    pieces.note(f"{pieces.badge(provenance.kind)} {provenance.source}: {samples} against {force.record.axis}.")


def _take(file: Any) -> None:
    if file is None:
        inputs.accept("force:file")
        return
    st.session_state[FILE] = (file.name, file.getvalue())
    _again()


def _again() -> None:
    """Read the file that was given, with the options as they stand."""
    if FILE not in st.session_state:
        return
    name, data = st.session_state[FILE]

    def read() -> None:
        on = st.session_state.get("force:on", "tool")
        record = read_forces(data, on=on, source=name, trust_units=bool(st.session_state.get("force:trust")))
        old = session.project().setup.force
        given = {name: getattr(old, name) for name in ("cutoff", "start")} if old.kind == MeasuredForce.kind else {}
        force = MeasuredForce(record, **given)
        # What cannot be laid on this path is refused here, with the file, and not on the page.
        force.components(cached.result(session.project().setup).conditions)
        session.change(force=force, coupling=False)
        st.session_state.pop(PENDING, None)

    inputs.submit("force:file", None, read)


#: What draws a field that is no number, by its type; it gets the model, or None while the field is waited for.
EDITORS: dict[Any, Callable[[Any], None]] = {Material: material_panel.picker, ForceRecord: _record}
