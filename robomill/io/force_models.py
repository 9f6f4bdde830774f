"""Force models to and from the [force] table of a set-up."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from robomill.cutting.force import ConstantForce, ForceModel, PathForce
from robomill.cutting.materials import Material, alternatives
from robomill.cutting.measured import PAPER_CUTOFF, ForceRecord, MeasuredForce
from robomill.cutting.milling import KienzleForce, MechanisticForce, ProcessForce
from robomill.cutting.tool import Cutter
from robomill.io.forces import read_forces
from robomill.io.materials import load_material, material_from_toml, material_names, material_to_toml, sample_materials
from robomill.io.tables import Table

PROCESS: dict[str, type[ProcessForce]] = {"mechanistic": MechanisticForce, "kienzle": KienzleForce}


def force_from_table(table: Table, cutter: Cutter, folder: Path | None = None) -> ForceModel:
    """The model that [force] names by ``kind``; files are looked for in ``folder``."""
    kind = table.text("kind")
    if kind not in _READERS:
        raise table.refuse("kind", f"expected one of {', '.join(_READERS)}, found {kind!r:.40}.")
    model = _READERS[kind](table, cutter, folder)
    table.finish()
    return model


def _constant(table: Table, cutter: Cutter, folder: Path | None) -> ForceModel:
    return ConstantForce(np.array(table.numbers("vector_N", 3, "N")))


def _path(table: Table, cutter: Cutter, folder: Path | None) -> ForceModel:
    return PathForce(
        feed=table.number("feed_N", "N", 0.0),
        feed_normal=table.number("feed_normal_N", "N", 0.0),
        axial=table.number("axial_N", "N", 0.0),
    )


def _process(table: Table, cutter: Cutter, folder: Path | None) -> ForceModel:
    if table.has("material_definition"):
        material = material_from_toml(table.text("material_definition"), f"{table.where}, material_definition")
    else:
        name = table.text("material")
        beside = folder / name if folder is not None else None
        material = load_material(beside if beside is not None and beside.is_file() else name)
    table.asked.update(("material", "material_definition"))
    return process_force(cutter, material, axial=table.flag("axial", True))


def process_force(cutter: Cutter, material: Material, *, axial: bool = True) -> ProcessForce:
    """The model that fits the row's coefficients, with the other rows of its alloy as the band."""
    return PROCESS[material.kind](cutter, material, alternatives(material, sample_materials()), axial)


def _measured(table: Table, cutter: Cutter, folder: Path | None) -> ForceModel:
    if table.has("file"):
        name = table.text("file")
        record = read_forces((folder or Path()) / name, on=_side(table), source=name)
    else:
        inner = table.table("record")
        record = ForceRecord(
            x=np.array(inner.rows("x", 1, "1"))[:, 0],
            F=inner.rows("F_N", 3, "N"),
            axis=inner.text("axis"),  # type: ignore[arg-type]
            frame=inner.text("frame"),  # type: ignore[arg-type]
            source=inner.text("source"),
            notes=tuple(inner.words("notes")),
        )
        inner.finish()
    table.asked.update(("file", "record", "force_on"))
    cutoff = table.number("cutoff_Hz", "1", PAPER_CUTOFF)
    return MeasuredForce(record, cutoff if cutoff > 0 else None, table.number("start", "1", 0.0))


def _side(table: Table) -> Any:
    side = table.text("force_on", "tool")
    if side not in ("tool", "part"):
        raise table.refuse("force_on", f"expected tool or part, found {side!r:.40}.")
    return side


_READERS: dict[str, Callable[[Table, Cutter, Path | None], ForceModel]] = {
    "constant": _constant,
    "path": _path,
    "mechanistic": _process,
    "kienzle": _process,
    "measured": _measured,
}


def force_to_table(force: ForceModel) -> dict[str, Any]:
    """The model as a table that ``force_from_table`` reads back to an equal one."""
    if isinstance(force, ConstantForce):
        return {"kind": "constant", "vector_N": force.vector_M.tolist()}
    if isinstance(force, PathForce):
        return {"kind": "path", "feed_N": force.feed, "feed_normal_N": force.feed_normal, "axial_N": force.axial}
    if isinstance(force, ProcessForce):
        name = force.material.name
        known = name in material_names() and load_material(name) == force.material
        row = {"material": name} if known else {"material_definition": material_to_toml(force.material)}
        return {"kind": force.kind, **row, "axial": force.axial}
    if isinstance(force, MeasuredForce):
        record = force.record
        return {
            "kind": "measured",
            "cutoff_Hz": force.cutoff or 0.0,
            "start": force.start,
            "record": {
                "axis": record.axis,
                "frame": record.frame,
                "source": record.source,
                "notes": list(record.notes),
                "x": record.x[:, None].tolist(),
                "F_N": record.F.tolist(),
            },
        }
    raise TypeError(f"no table for a force of type {type(force).__name__}")
