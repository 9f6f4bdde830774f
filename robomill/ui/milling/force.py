"""The force on the tool: which model, its numbers, engagement and coupling."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import streamlit as st

from robomill.cutting.force import ForceModel, MeanForce
from robomill.cutting.forces import FORCES
from robomill.cutting.forces.measured import PAPER_CUTOFF, ForceRecord, MeasuredForce
from robomill.cutting.materials import Material
from robomill.cutting.tool import Cutter
from robomill.errors import RobomillError
from robomill.io.measured.forces import read_forces
from robomill.paper import SLOT
from robomill.quantities import declared_types
from robomill.simulation.setup import SimulationSetup
from robomill.ui import pieces, session
from robomill.ui.entry import declared, inputs
from robomill.ui.entry.box import declared as declaration_box
from robomill.ui.entry.rows import others, rows
from robomill.ui.milling import materials as material_panel
from robomill.ui.project import read_field
from robomill.ui.work import cached, running
from robomill.ui.work.job import Underway
from robomill.units import format_count

PENDING = "milling.force.pending"
FILE, SIDE, TRUST = "milling.force.file", "milling.force.side", "milling.force.trust"
SIDES = {"tool": "tool", "part": "part"}
MAX_FORCE_MB = 60


def inputs_panel() -> None:
    """Model, numbers, engagement, coupling."""
    setup = session.project().setup
    force: ForceModel | None = setup.force
    current = setup.force.kind
    # Asked for, but what it needs is not there yet; any change of the project makes an end of the wait.
    digest, wanted = session.kept(PENDING, ("", ""))
    if digest == setup.digest() and wanted != current:
        force, current = None, wanted
    titles = {kind: model.title for kind, model in FORCES.items()}
    inputs.choice("Model", "force.kind", titles, current, _switch, inputs.LISTED)
    for kind in declared_types(FORCES[current]).values():
        if kind in EDITORS:
            EDITORS[kind](force)
    if force is not None:
        declared.fields(force, "force", _write)
        if force.hint:
            pieces.note(force.hint)
        if force.stated:
            pieces.note(pieces.sourced(setup.provenance.get("force", force.provenance)))
    if force is not None and force.follows_cut and _speed_unsaid(setup):
        _speed(setup)
    _process_switches(force is not None and force.follows_cut)


def _speed(setup: SimulationSetup) -> None:
    """How fast the spindle turns, empty until somebody says it."""
    name = "source.n_s"
    box = declaration_box(setup, name, optional=True, placeholder="needed")
    write = inputs.into_setup(name, name)
    inputs.value(name, box, read_field(setup, name) or None, lambda n_s: write(n_s or 0.0))


def _speed_unsaid(setup: SimulationSetup) -> bool:
    """Whether the program turns its spindle nowhere, or the set-up says how fast in its place."""
    source = setup.source
    if source.kind != "program" or source.n_s:
        return source.kind == "program"
    with suppress(RobomillError, Underway):
        return not running.path_of(setup).turns
    return False


def _write(name: str, value: Any) -> None:
    session.change(label=f"force.{name}", force=replace(session.project().setup.force, **{name: value}))  # type: ignore[type-var]


def _process_switches(process: bool) -> None:
    setup = session.project().setup
    declared.field("engagement", lambda on: session.change(engagement=on, coupling=setup.coupling and on))
    declared.field("coupling", look=inputs.Look(disabled=not (setup.engagement and process)))


def _switch(kind: str) -> None:
    """Another model, with what its fields start from; one that needs what is not there yet waits for it."""
    setup = session.project().setup
    session.drop(PENDING)
    if kind == setup.force.kind:
        return
    model = FORCES[kind]
    given: dict[str, Any] = {}
    for name, wanted in declared_types(model).items():
        if wanted is Cutter:
            given[name] = setup.cutter
        elif wanted is Material:
            given[name] = rows(model.kind)[model.example]
        elif wanted == tuple[Material, ...]:
            given[name] = others(given["material"])
        elif wanted is ForceRecord:
            session.keep(PENDING, (setup.digest(), kind))
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
        return MeanForce(np.array([0.0, SLOT.force, 0.0]), np.array([0.0, SLOT.force, 0.0]))
    i = result.worst
    return MeanForce(np.round(result.F[i], 6) + 0.0, np.round(result.force_components[i], 6) + 0.0)


def _record(force: Any) -> None:
    """The file of a measured force, how it is read, and how it is laid on the path."""
    inputs.upload(
        "Force record (.csv): t_s or s_mm, then F_feed_N, F_feed_normal_N, F_axial_N, or F_x_N, F_y_N, F_z_N",
        FILE,
        _take,
        most_MB=MAX_FORCE_MB,
        fresh=session.store().revision if force is None else "kept",
    )
    (left, right), again = st.columns(2), partial(inputs.reread, FILE, _take)
    with left:
        felt = session.kept(SIDE, "tool")
        inputs.choice("The sensor felt the force on the", SIDE, SIDES, felt, partial(again, SIDE))
    with right:
        look = inputs.Look(hint="Accept forces whose size looks like another unit (mN, kN).")
        inputs.switch("Trust the unit", TRUST, session.kept(TRUST, False), partial(again, TRUST), look)
    if force is not None:
        _filter(force)
        samples, provenance = format_count(len(force.record.x), "sample"), force.provenance
        pieces.note(pieces.badge(provenance.kind), f"{provenance.source}: {samples} against {force.record.axis}.")
    elif FILE not in session.store().refused:
        pieces.note("Until a record is given, the force stays as it was.")


def _filter(force: MeasuredForce) -> None:
    """The low-pass filter with its cut-off, and where the path starts in the record."""
    on = force.cutoff is not None
    inputs.switch("Low-pass, zero phase", "force.filter", on, lambda on: _write("cutoff", PAPER_CUTOFF if on else None))
    left, right = st.columns(2)
    if on:
        with left:
            inputs.number("force.cutoff", label="Cut-off", optional=False)
    with right:
        inputs.number("force.start", unit=declared.in_view(force.start_unit), digits=3)


def _take(data: bytes, name: str) -> None:
    """Read the file with the options as they stand; it is kept, to be read again with others."""
    session.keep(FILE, (data, name))
    record = read_forces(data, on=session.kept(SIDE, "tool"), source=name, trust_units=session.kept(TRUST, False))
    old = session.project().setup.force
    force = replace(old, record=record) if isinstance(old, MeasuredForce) else MeasuredForce(record)
    # What cannot be laid on this path is refused here, with the file, and not on the page.
    force.components(cached.result(session.project().setup).conditions)
    session.change(force=force, coupling=False)
    session.drop(PENDING)


#: What draws a field that is no number, by its type; it gets the model, or None while the field is waited for.
EDITORS: dict[Any, Callable[[Any], None]] = {Material: material_panel.picker, ForceRecord: _record}
