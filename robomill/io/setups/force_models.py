"""Force models to and from the [force] table of a set-up: each by its declared fields, a field's type by its codec."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from robomill.arguments import asked
from robomill.arrays import of_kind
from robomill.cutting.force import ForceModel
from robomill.cutting.forces import FORCES, model_of
from robomill.cutting.forces.measured import ForceRecord
from robomill.cutting.materials import Material, alternatives
from robomill.cutting.process import ProcessForce
from robomill.cutting.tool import Cutter
from robomill.errors import CuttingError
from robomill.files import MATERIAL, TABLE
from robomill.io.beside import ALONE, Beside
from robomill.io.declared import CODECS, Around, Codec, from_table, kind_to_table
from robomill.io.materials import load_material, material_from_toml, material_names, material_to_toml, sample_materials
from robomill.io.measured.forces import read_forces
from robomill.io.tables import Table
from robomill.io.texts import read_text
from robomill.provenance import KINDS
from robomill.quantities import declared_types


def force_from_table(table: Table, cutter: Cutter, beside: Beside = ALONE) -> ForceModel:
    """The model that [force] names by ``kind``; ``beside`` holds the files it may name."""
    model = FORCES[table.choice("kind", tuple(FORCES))]
    given = {name: cutter for name, kind in declared_types(model).items() if kind is Cutter}
    return from_table(table, model, given=given, codecs=FORCE_CODECS, beside=beside)


def force_to_table(force: ForceModel) -> dict[str, Any]:
    """The model as a table that ``force_from_table`` reads back to an equal one."""
    return kind_to_table(force, FORCE_CODECS)


@asked
def process_force(
    material: str | Path | Material,
    cutter: Cutter,
    *,
    axial: bool = True,
    radial_share: float | None = None,
    axial_share: float | None = None,
) -> ProcessForce:
    """The cutting force of a cutter in a material, following the cut.

    Parameters
    ----------
    material : str, Path or Material
        A sample's name (``material_names``), a ``.toml`` file, or a row itself.
    cutter : Cutter
        What cuts.
    axial : bool
        Whether the force along the axis is computed, too.
    radial_share, axial_share : float, optional
        Of the tangential force, where the row does not hold the others; as in ``ProcessForce``.

    Returns
    -------
    ProcessForce
        By the law whose coefficients the row holds; other rows of its alloy come along for the range of the result.

    Raises
    ------
    CuttingError
        For a material that is not known.

    Examples
    --------
    >>> import robomill as rm
    >>> force = rm.process_force("al7075_t6_carbide_ref190", rm.Cutter("flat", diameter_mm=8, flutes=3))
    >>> force.material.name
    'al7075_t6_carbide_ref190'
    """
    of_kind(cutter, Cutter, "cutter", 'rm.Cutter("flat", diameter_mm=8)', CuttingError)
    row = material if isinstance(material, Material) else load_material(material)
    others = alternatives(row, sample_materials())
    model: type[ProcessForce] = model_of(row)  # type: ignore[assignment]
    return model(cutter, row, others, axial, radial_share, axial_share)


def _read_material(table: Table, name: str, around: Around) -> Material:
    """A sample, a file beside the set-up, or the row itself as text."""
    if table.has("material_definition"):
        return material_from_toml(table.text("material_definition"), f"{table.where}, material_definition")
    if table.text("material") in material_names():
        return load_material(table.text("material"))
    if not table.text("material").endswith(".toml"):
        known = ", ".join(material_names())
        raise table.refuse("material", f"{table.text('material')!r:.80} is not known; known are {known}.")
    data, file = around.beside.read(table, "material", MATERIAL)
    return material_from_toml(*read_text(data, table.error, MATERIAL, file))


def _write_material(name: str, material: Material) -> dict[str, Any]:
    if material.name in material_names() and load_material(material.name) == material:
        return {"material": material.name}
    return {"material_definition": material_to_toml(material)}


def _read_record(table: Table, name: str, around: Around) -> ForceRecord:
    """A CSV file beside the set-up, or the record itself."""
    if table.has("file"):
        side: Any = table.choice("force_on", ("tool", "part"), "tool")
        turns: Any = table.choice("force_axes", ("robot", "part"), "robot")
        data, file = around.beside.read(table, "file", TABLE)
        return read_forces(data, on=side, turns_with=turns, source=file)
    inner = table.table("record")
    axis: Any = inner.text("axis")
    frame: Any = inner.text("frame")
    record = ForceRecord(
        x=np.array(inner.rows("x", 1, "1"))[:, 0],
        F=inner.rows("F_N", 3, "N"),
        axis=axis,
        frame=frame,
        source=inner.text("source"),
        notes=tuple(inner.words("notes")),
    )
    kind: Any = inner.choice("kind", KINDS, "measured")
    inner.finish()
    return replace(record, kind=kind)


def _write_record(name: str, record: ForceRecord) -> dict[str, Any]:
    words: dict[str, Any] = {name: getattr(record, name) for name in ("axis", "frame", "source")}
    words |= {"notes": list(record.notes)} | ({"kind": record.kind} if record.kind != "measured" else {})
    return {"record": {**words, "x": record.x[:, None].tolist(), "F_N": record.F.tolist()}}


def _others_of_its_alloy(table: Table, name: str, around: Around) -> tuple[Material, ...]:
    return alternatives(around.known["material"], sample_materials())


FORCE_CODECS: dict[Any, Codec] = CODECS | {
    Material: Codec(("material", "material_definition"), _read_material, _write_material),
    tuple[Material, ...]: Codec((), _others_of_its_alloy, lambda name, rows: {}),
    ForceRecord: Codec(("file", "record", "force_on", "force_axes"), _read_record, _write_record),
}
