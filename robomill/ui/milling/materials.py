"""Material rows: pick one, see its source, edit its coefficients, add a row of one's own."""

import re
from dataclasses import replace
from functools import partial
from typing import Any

import pandas as pd
import streamlit as st

from robomill.cutting.materials import PUBLISHED, Material
from robomill.errors import CuttingError
from robomill.files import MATERIAL
from robomill.io.materials import material_from_toml, material_to_toml
from robomill.io.texts import read_text
from robomill.provenance import Provenance
from robomill.quantities import quantities
from robomill.ui import pieces, session
from robomill.ui.entry import grid, inputs
from robomill.ui.entry.box import box_of
from robomill.ui.entry.rows import force_of, keep, others, rows, titles
from robomill.units import unit_label

NEW = "milling.material"


def _use(material: Material, from_editor: bool = False) -> None:
    """Put a row in force: in the present model, or in the one that takes rows of its kind."""
    setup = session.project().setup
    force: Any = setup.force
    if force.takes is type(material):
        force = replace(force, material=material, alternatives=others(material))
    else:
        force = force_of(material, setup.cutter)
    session.change(force=force, from_editor=from_editor)


def picker(force: Any) -> None:
    """The row in force with its source, its coefficients and the way to a new one."""
    material: Material = force.material
    found = rows(force.takes.kind)
    inputs.choice(
        "Material",
        f"force.material.{force.kind}",
        titles(force.takes.kind),
        material.name,
        lambda name: _use(found[name]),
        inputs.LISTED,
    )
    count = len(others(material))
    words = f" The band comes from {count} other rows of {material.alloy}." if count else " No other row: no band."
    source = material.provenance.source
    pieces.note(pieces.badge(material.provenance.kind), f"{source}.{words}")
    if lacking := [part for part in material.unknown if getattr(force, f"{part}_share") is None]:
        published = ", ".join(
            f"{part} {low:g} to {high:g}" for part, (low, high) in PUBLISHED.items() if part in lacking
        )
        text = (
            f"Its source gives no {' and no '.join(lacking)} force, so no cut that needs it is judged: assume a share "
            f"of the tangential force here (published for aluminium: {published}), or take another material."
        )
        pieces.said("warning", text, "help")
    for part in material.unknown:
        inputs.number(f"force.{part}_share")
    left, right = st.columns(2)
    with left, st.popover("Coefficients", icon=":material/tune:", width="stretch"):
        _coefficients(material)
    with right, st.popover("Add a row", icon=":material/add:", width="stretch"):
        _add(material)


def _coefficients(material: Material) -> None:
    pieces.strong(material.title)
    said = list(quantities(type(material)).values())
    grid.table(
        f"milling.coefficients.{material.name}",
        lambda: coefficient_frame(material),
        lambda frame: _keep(with_coefficients(material, frame), from_editor=True),
        grid.Sheet(
            {"value": [box_of(q, label="value") for q in said]},
            where=lambda row: said[row].name,
            locked=("coefficient", "unit"),
        ),
    )
    pieces.note("An edited row becomes a row of your own; the original stays in the list and in the band.")
    text = partial(material_to_toml, material)
    pieces.download("Row as TOML", text, f"{material.name}.toml", "milling.material.get")


def _add(material: Material) -> None:
    texts = {
        "name": ("Name of the new row", "", "7075 from my own tests"),
        "alloy": ("Alloy (rows of one alloy make the band)", material.alloy, ""),
        "source": ("Where the numbers come from", "", "our dynamometer, May"),
    }
    for name, (label, first, example) in texts.items():
        key = f"{NEW}.{name}"
        inputs.text(label, key, session.kept(key, first), partial(session.keep, key), placeholder=example)
    inputs.button("Add as a copy of this row", f"{NEW}.add", "add", _copy, material)
    inputs.upload("Or a row from a file (.toml)", f"{NEW}.file", _take, most_MB=1)


def _copy(material: Material) -> None:
    title, source = (session.kept(f"{NEW}.{name}", "").strip() for name in ("name", "source"))
    name = re.sub(r"[^a-z0-9]+", "_", title.lower()).strip("_")
    if not name or not source:
        raise CuttingError("A new row needs a name and where its numbers come from.")
    if name in rows(material.kind):
        raise CuttingError(f"There is a row named {name!r} already; choose another name.")
    alloy = session.kept(f"{NEW}.alloy", material.alloy).strip()
    _keep(material.replace(name=name, title=title, alloy=alloy, provenance=Provenance("user", source)))


def _take(data: bytes, name: str) -> None:
    _keep(material_from_toml(*read_text(data, CuttingError, MATERIAL, name)))


def _keep(material: Material, from_editor: bool = False) -> None:
    """Add or replace a row of this session and put it in force."""
    keep(material)
    _use(material, from_editor)


def coefficient_frame(material: Material) -> pd.DataFrame:
    """One row a coefficient in SI, beside the unit of the trade; empty where the source does not give it."""
    said = quantities(type(material)).values()
    return pd.DataFrame(
        {
            "coefficient": [q.name for q in said],
            "value": [getattr(material, q.name) for q in said],
            "unit": [unit_label(q.unit) for q in said],
        }
    )


def with_coefficients(material: Material, frame: pd.DataFrame) -> Material:
    """``material`` with the table's coefficients, as a row of one's own. Raises CuttingError naming the coefficient."""
    values: dict[str, Any] = {
        name: None if grid.empty(value) else float(value)
        for name, value in zip(frame["coefficient"], frame["value"], strict=True)
    }
    if material.provenance.kind == "user":
        return material.replace(**values, provenance=material.provenance)
    return material.replace(
        **values,
        name=f"{material.name}_edited",
        title=f"{material.title}, edited",
        provenance=Provenance("user", f"edited in the app, from: {material.provenance.source}"),
    )
