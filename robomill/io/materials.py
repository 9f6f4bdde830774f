"""Material rows as TOML files with the unit in every key: read, write, list the samples."""

from pathlib import Path
from typing import Any

from robomill.arguments import asked
from robomill.cutting.forces import FORCES
from robomill.cutting.materials import Material
from robomill.errors import CuttingError, RobomillError
from robomill.files import MATERIAL, check_place
from robomill.io.declared import read_quantity, write_quantity
from robomill.io.samples import sample_names, samples_dir
from robomill.io.tables import Table, parse_toml, toml_value
from robomill.io.texts import read_text
from robomill.quantities import quantities

WORDS = ("name", "title", "alloy")
LAWS = [model.takes for model in FORCES.values() if model.takes is not None]


def material_names() -> list[str]:
    """Names of the sample materials, as ``load_material`` and ``process_force`` take them.

    Returns
    -------
    list of str
        Sorted.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.material_names()[0]
    'al6061_t6_carbide_ref160'
    """
    return sample_names("material")


def sample_materials() -> list[Material]:
    """All sample materials, by name."""
    return [load_material(name) for name in material_names()]


@asked
def load_material(name_or_path: str | Path) -> Material:
    """A material's force coefficients, by the name of a sample or from a file.

    Parameters
    ----------
    name_or_path : str or Path
        One of ``material_names()``, or a ``.toml`` file.

    Returns
    -------
    Material
        Coefficients in SI, with the source that they come from.

    Raises
    ------
    CuttingError
        Naming the file and the key.

    Examples
    --------
    >>> import robomill as rm
    >>> rm.load_material("al7075_t6_carbide_ref190").name
    'al7075_t6_carbide_ref190'
    """
    check_place(name_or_path, f"{MATERIAL.expected}, or one of material_names()", CuttingError)
    path = Path(name_or_path)
    if path.suffix != ".toml":
        if str(name_or_path) not in material_names():
            known = ", ".join(material_names())
            raise CuttingError(f"Material {str(name_or_path)!r:.80} is not known: give a .toml file or one of {known}.")
        path = samples_dir() / "materials" / f"{name_or_path}.toml"
    return material_from_toml(*read_text(path, CuttingError, MATERIAL))


def material_from_toml(text: str, where: str = "material") -> Material:
    """A row from TOML text: name, title, alloy, [coefficients], [provenance]. ``where`` starts every sentence."""
    top = Table(parse_toml(text, where, CuttingError, exact=True), where, CuttingError)
    given: dict[str, Any] = {key: top.text(key) for key in WORDS}
    coefficients = top.table("coefficients")
    law = _law(coefficients)
    given |= {name: read_quantity(coefficients, declared) for name, declared in quantities(law).items()}
    given["provenance"] = top.provenance("provenance")
    top.finish()
    try:
        return law(**given)
    except RobomillError as exc:
        raise CuttingError(f"{where}: {exc}", where=exc.where) from exc


def _law(coefficients: Table) -> type[Material]:
    """The law whose coefficients a row gives: of one only."""
    keys = {law: [said.key for said in quantities(law).values()] for law in LAWS}
    given = {law: [key for key in every if coefficients.has(key)] for law, every in keys.items()}
    found = [law for law in LAWS if given[law]]
    if len(found) == 1:
        coefficients.asked.update(keys[found[0]])
        coefficients.finish()
        return found[0]
    if not found:
        known = ", or ".join(", ".join(every) for every in keys.values())
        raise CuttingError(f"{coefficients.where}: found no coefficient that is known; known are {known}.")
    words = " and ".join(", ".join(given[law]) for law in found)
    raise CuttingError(f"{coefficients.where}: found {words}; a row is of one law, so make {len(found)} rows of it.")


def material_to_toml(material: Material) -> str:
    """TOML text that ``material_from_toml`` reads back to an equal row."""
    lines = [f"{key} = {toml_value(getattr(material, key))}" for key in WORDS]
    lines += ["", "[coefficients]"]
    for name, declared in quantities(type(material)).items():
        value = write_quantity(declared, getattr(material, name))
        if value is not None:
            lines.append(f"{declared.key} = {toml_value(value)}")
    lines += ["", "[provenance]"]
    lines += [f"{key} = {toml_value(getattr(material.provenance, key))}" for key in ("kind", "source")]
    return "\n".join(lines) + "\n"
