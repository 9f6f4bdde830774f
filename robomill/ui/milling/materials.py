"""Material rows: pick one, see its source, edit its coefficients, add a row of one's own."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import streamlit as st

from robomill.cutting.forces import FORCES
from robomill.cutting.materials import Material
from robomill.cutting.materials import alternatives as others_of
from robomill.errors import CuttingError
from robomill.io.materials import material_from_toml, material_to_toml, sample_materials
from robomill.io.texts import read_text
from robomill.provenance import Provenance
from robomill.quantities import quantities
from robomill.ui import inputs, pieces, session
from robomill.units import from_si, to_si, unit_label

OWN = "milling.materials"


@st.cache_resource(show_spinner=False)
def _samples() -> tuple[Material, ...]:
    return tuple(sample_materials())


def rows(kind: str) -> dict[str, Material]:
    """Every row of a kind ("mechanistic", "kienzle"): the samples, those of this session, the one a project brings."""
    every = [*_samples(), *st.session_state.get(OWN, {}).values()]
    brought = getattr(session.project().setup.force, "material", None)
    return {m.name: m for m in (*every, *([brought] if brought is not None else [])) if m.kind == kind}


def others(material: Material) -> tuple[Material, ...]:
    """The other rows of its alloy: the band."""
    return others_of(material, rows(material.kind).values())


def _use(material: Material, from_editor: bool = False) -> None:
    """Put a row in force: in the present model, or in the one that takes rows of its kind."""
    setup = session.project().setup
    given = {"material": material, "alternatives": others(material)}
    force: Any = setup.force
    if force.takes == material.kind:
        force = replace(force, **given)
    else:
        model: Any = next(model for model in FORCES.values() if model.takes == material.kind)
        force = model(cutter=setup.cutter, **given)
    session.change(force=force, from_editor=from_editor)


def picker(force: Any) -> None:
    """The row in force with its source, its coefficients and the way to a new one."""
    material: Material = force.material
    found = rows(force.takes)
    inputs.choice(
        "Material",
        f"force.material.{force.kind}",
        {m.name: m.title for m in found.values()},
        material.name,
        lambda name: _use(found[name]),
        inputs.LISTED,
    )
    count = len(others(material))
    words = f" The band comes from {count} other rows of {material.alloy}." if count else " No other row: no band."
    source = material.provenance.source
    pieces.note(f"{pieces.badge(material.provenance.kind)} {source}.{words}")
    left, right = st.columns(2)
    with left, st.popover("Coefficients", icon=":material/tune:", width="stretch"):
        _coefficients(material)
    with right, st.popover("Add a row", icon=":material/add:", width="stretch"):
        _add(material)


def _coefficients(material: Material) -> None:
    st.markdown(f"**{material.title}**")
    inputs.table(
        f"material:{material.name}",
        lambda: coefficient_frame(material),
        lambda frame: _keep(with_coefficients(material, frame), from_editor=True),
        inputs.Sheet(
            columns={"value": st.column_config.NumberColumn("value", format="%.6g")}, locked=("coefficient", "unit")
        ),
    )
    pieces.note("An edited row becomes a row of your own; the original stays in the list and in the band.")
    pieces.download(
        "Row as TOML",
        lambda: material_to_toml(material),
        f"{material.name}.toml",
        "application/toml",
        key="get:material",
    )


def _add(material: Material) -> None:
    name = st.text_input("Name of the new row", key="material:name", placeholder="7075 from my own tests")
    alloy = st.text_input("Alloy (rows of one alloy make the band)", key="material:alloy", value=material.alloy)
    source = st.text_input("Where the numbers come from", key="material:source", placeholder="our dynamometer, May")
    st.button(
        "Add as a copy of this row",
        key="material:add",
        icon=":material/add:",
        on_click=_copy,
        args=(material, name, alloy, source),
    )
    st.file_uploader(
        "Or a row from a file (.toml)",
        key="material:file",
        type=["toml"],
        max_upload_size=1,
        on_change=lambda: _from_file(st.session_state.get("material:file")),
    )
    inputs.sentence("material:add")


def _copy(material: Material, name: str, alloy: str, source: str) -> None:
    def put() -> None:
        key = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")
        if not key or not source.strip():
            raise CuttingError("A new row needs a name and where its numbers come from.")
        if key in rows(material.kind):
            raise CuttingError(f"There is a row named {key!r} already; choose another name.")
        _keep(
            material.replace(
                name=key, title=name.strip(), alloy=alloy.strip(), provenance=Provenance("user", source.strip())
            )
        )

    inputs.submit("material:add", None, put)


def _from_file(file: Any) -> None:
    if file is None:
        return

    def put() -> None:
        _keep(material_from_toml(*read_text(file.getvalue(), CuttingError, "a material row (.toml)", file.name)))

    inputs.submit("material:add", None, put)


def _keep(material: Material, from_editor: bool = False) -> None:
    """Add or replace a row of this session and put it in force."""
    st.session_state[OWN] = {**st.session_state.get(OWN, {}), material.name: material}
    _use(material, from_editor)


def coefficient_frame(material: Material) -> pd.DataFrame:
    """One row a coefficient in the units of the trade; empty where the source does not give it."""
    said = [quantities(Material)[name] for name in material.coefficients]
    values = [getattr(material, q.name) for q in said]
    return pd.DataFrame(
        {
            "coefficient": [q.name for q in said],
            "value": [
                None if v is None else float(f"{from_si(v, q.unit):.10g}") for v, q in zip(values, said, strict=True)
            ],
            "unit": [unit_label(q.unit) for q in said],
        }
    )


def with_coefficients(material: Material, frame: pd.DataFrame) -> Material:
    """``material`` with the table's coefficients, as a row of one's own. Raises CuttingError naming the coefficient."""
    values: dict[str, float | None] = {}
    for name, value in zip(frame["coefficient"], frame["value"], strict=True):
        empty = value is None or value is pd.NA or (isinstance(value, float) and np.isnan(value))
        values[name] = None if empty else to_si(float(value), quantities(Material)[name].unit)
    if material.provenance.kind == "user":
        return material.replace(**values)
    return material.replace(
        **values,
        name=f"{material.name}_edited",
        title=f"{material.title}, edited",
        provenance=Provenance("user", f"edited in the app, from: {material.provenance.source}"),
    )
