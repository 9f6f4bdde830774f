"""The force on the tool: which model, its numbers, engagement and coupling."""

from __future__ import annotations

from typing import Any

import numpy as np
import streamlit as st

from robomill.cutting.force import ConstantForce, ForceModel, PathForce
from robomill.cutting.measured import PAPER_CUTOFF, MeasuredForce
from robomill.cutting.milling import ProcessForce
from robomill.errors import RobomillError
from robomill.io.forces import read_forces
from robomill.ui import boxes, cache, inputs, parts, state
from robomill.ui.milling import materials as material_panel
from robomill.units import format_count, format_si

KINDS = {
    "path": "Follows the path",
    "constant": "Fixed in {M} (the paper's)",
    "mechanistic": "From the material, mechanistic",
    "kienzle": "From the material, Kienzle",
    "measured": "Measured, from a CSV file",
}
DEFAULT_ROW = {"mechanistic": "al7075_t6_carbide_ref190", "kienzle": "al_wrought_cured_kienzle"}
PENDING = "milling.force.pending"
FILE = "milling.force.file"
MAX_FORCE_MB = 60


def kind_of(force: ForceModel) -> str:
    """A key of ``KINDS``."""
    if isinstance(force, ProcessForce):
        return force.kind
    if isinstance(force, MeasuredForce):
        return "measured"
    return "constant" if isinstance(force, ConstantForce) else "path"


def title(force: ForceModel) -> str:
    """The model in a few words, for the head of its panel."""
    if isinstance(force, ProcessForce):
        return force.material.title
    if isinstance(force, MeasuredForce):
        return force.record.source
    if isinstance(force, ConstantForce):
        return f"{format_si(np.linalg.norm(force.vector_M), 'N', 0)}, fixed in {{M}}"
    if isinstance(force, PathForce):
        return f"{format_si(np.linalg.norm([force.feed, force.feed_normal, force.axial]), 'N', 0)}, follows the path"
    return type(force).__name__


def inputs_panel() -> None:
    """Model, numbers, engagement, coupling."""
    setup = state.project().setup
    force = setup.force
    # Asked for, but no record yet; any change of the project makes an end of the wait.
    waits = st.session_state.get(PENDING) == setup.digest()
    current = "measured" if waits else kind_of(force)
    inputs.choice("Model", "force.kind", KINDS, current, _switch, horizontal=False)
    if current == "measured":
        _measured(force if isinstance(force, MeasuredForce) else None)
    elif isinstance(force, ProcessForce):
        material_panel.picker(force)
    elif isinstance(force, ConstantForce):
        _three([(f"F {a}", f"force.vector_M[{i}]") for i, a in enumerate("XYZ")])
    elif isinstance(force, PathForce):
        _three([("Feed", "force.feed"), ("Feed-normal", "force.feed_normal"), ("Axial", "force.axial")])
        parts.note("Feed-normal is to the left of the feed; axial is positive out of the part.")
    if current != "measured":
        provenance = (
            force.provenance if isinstance(force, ProcessForce) else setup.provenance.get("force", force.provenance)
        )
        source = "" if isinstance(force, ProcessForce) else provenance.source
        if source:
            parts.note(f"{parts.badge(provenance.kind)} {parts.subscripts(source)}")
    _process_switches(isinstance(force, ProcessForce) and current != "measured")


def _three(fields: list[tuple[str, str]]) -> None:
    for column, (label, path) in zip(st.columns(3), fields, strict=True):
        with column:
            inputs.number(label, path, "N", step=10.0, digits=1)


def _process_switches(process: bool) -> None:
    setup = state.project().setup
    boxes.switch(
        "Engagement from the part",
        "setup.engagement",
        setup.engagement,
        lambda on: state.change(engagement=on, coupling=setup.coupling and on),
        hint="The arc and depth of each step come from the stock as it stands: no force in air, less in a side cut. "
        "Off: a full slot everywhere. Models with fixed numbers push wherever the path is at feed.",
    )
    boxes.switch(
        "Deflection changes the cut",
        "setup.coupling",
        setup.coupling,
        lambda on: state.change(coupling=on),
        disabled=not (setup.engagement and process),
        hint="Force and deflection are iterated until they agree. Needs a force from the material and the engagement "
        "from the part.",
    )


def _switch(kind: str) -> None:
    st.session_state.pop(PENDING, None)
    if kind == "measured":
        if not isinstance(state.project().setup.force, MeasuredForce):
            st.session_state[PENDING] = state.project().setup.digest()
        return
    if kind in DEFAULT_ROW:
        row = material_panel.rows(kind)[DEFAULT_ROW[kind]]
        state.change(force=material_panel.model(row), engagement=True)
        return
    mean, feed_normal = _mean_force()
    if kind == "constant":
        state.change(force=ConstantForce(mean), coupling=False)
    else:
        feed, normal, axial = (float(v) for v in feed_normal)
        state.change(force=PathForce(feed, normal, axial), coupling=False)


def _mean_force() -> tuple[Any, Any]:
    """The force at the worst point in {M} and along the path, so that switching changes as little as can be."""
    try:
        result = cache.result(state.project().setup)
    except RobomillError:
        result = None
    if result is None or result.worst < 0:
        return np.array([0.0, 100.0, 0.0]), np.array([0.0, 100.0, 0.0])
    i = result.worst
    return np.round(result.F[i], 6) + 0.0, np.round(result.force_components[i], 6) + 0.0


def _measured(force: MeasuredForce | None) -> None:
    key = f"force:file:{state.store().revision if force is None else 'kept'}"
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
        if not state.store().refused.get("force:file"):
            parts.note("Until a record is given, the force stays as it was.")
        return
    record = force.record
    boxes.switch(
        "Low-pass, zero phase",
        "force:filter",
        force.cutoff is not None,
        lambda on: state.change(force=MeasuredForce(record, PAPER_CUTOFF if on else None, force.start)),
    )
    left, right = st.columns(2)
    with left:
        if force.cutoff is not None:
            inputs.number("Cut-off (Hz)", "force.cutoff", "1", step=10.0, digits=1)
    with right:
        boxes.number_box(
            "Path starts at",
            "force:start",
            force.start,
            "s" if record.axis == "time" else "mm",
            lambda v: state.change(force=MeasuredForce(record, force.cutoff, float(v or 0.0))),
            digits=3,
        )
    samples = format_count(len(record.x), "sample")
    parts.note(f"{parts.badge('measured')} {force.provenance.source}: {samples} against {record.axis}.")


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
        old = state.project().setup.force
        cutoff, start = (old.cutoff, old.start) if isinstance(old, MeasuredForce) else (PAPER_CUTOFF, 0.0)
        force = MeasuredForce(record, cutoff, start)
        # What cannot be laid on this path is refused here, with the file, and not on the page.
        force.components(cache.result(state.project().setup).conditions)
        state.change(force=force, coupling=False)
        st.session_state.pop(PENDING, None)

    inputs.attempt("force:file", None, read)
