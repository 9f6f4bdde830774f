"""Material rows as TOML files with the unit in every key: read, write, list the samples."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from robomill.cutting.materials import COEFFICIENT_UNITS, KIENZLE, MECHANISTIC, Material
from robomill.errors import CuttingError, RobomillError
from robomill.io.samples import samples_dir
from robomill.provenance import Provenance
from robomill.units import from_si, to_si

SUFFIX = {"N/mm2": "_N_mm2", "N/mm": "_N_mm", "1": ""}
#: Key in the file -> (field of Material, unit).
KEYS = {f"{name}{SUFFIX[unit]}": (name, unit) for name, unit in COEFFICIENT_UNITS.items()}


def material_names() -> list[str]:
    """Names of the sample materials, sorted."""
    return sorted(path.stem for path in (samples_dir() / "materials").glob("*.toml"))


def sample_materials() -> list[Material]:
    """All sample materials, by name."""
    return [load_material(name) for name in material_names()]


def load_material(name_or_path: str | Path) -> Material:
    """A sample by name, or a TOML file. Raises CuttingError naming the file and the key."""
    path = Path(name_or_path)
    if path.suffix != ".toml":
        path = samples_dir() / "materials" / f"{name_or_path}.toml"
        if not path.is_file():
            known = ", ".join(material_names())
            raise CuttingError(f"Material {str(name_or_path)!r} is not known: give a .toml file or one of {known}.")
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as exc:
        raise CuttingError(f"{path.name}: the file cannot be read as text ({exc.__class__.__name__}).") from exc
    return material_from_toml(text, path.name)


def material_from_toml(text: str, where: str = "material") -> Material:
    """A row from TOML text: name, title, alloy, [coefficients], [provenance]. ``where`` starts every sentence."""
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as exc:
        raise CuttingError(f"{where}: not a TOML file ({exc}).", where=where) from exc
    _only(data, {"name", "title", "alloy", "coefficients", "provenance"}, where)
    words = {key: _text(data, key, where) for key in ("name", "title", "alloy")}
    coefficients, provenance = (_table(data, key, where) for key in ("coefficients", "provenance"))
    _only(coefficients, set(KEYS), f"{where} [coefficients]")
    _only(provenance, {"kind", "source"}, f"{where} [provenance]")
    values: dict[str, float] = {}
    for key, value in coefficients.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise CuttingError(f"{where} [coefficients] {key}: expected a number, found {value!r:.40}.", where=key)
        name, unit = KEYS[key]
        values[name] = to_si(float(value), unit)
    kind, source = (_text(provenance, key, f"{where} [provenance]") for key in ("kind", "source"))
    try:
        return Material(**words, provenance=Provenance(kind, source), **values)  # type: ignore[arg-type]
    except RobomillError as exc:
        raise CuttingError(f"{where}: {exc}", where=exc.where) from exc


def material_to_toml(material: Material) -> str:
    """TOML text that ``material_from_toml`` reads back to an equal row."""
    lines = [f"{key} = {_quoted(getattr(material, key))}" for key in ("name", "title", "alloy")]
    lines += ["", "[coefficients]"]
    keys = {name: (key, unit) for key, (name, unit) in KEYS.items()}
    for name in (*MECHANISTIC, *KIENZLE):
        value = getattr(material, name)
        if value is not None:
            key, unit = keys[name]
            lines.append(f"{key} = {_shortest(value, unit)!r}")
    lines += ["", "[provenance]"]
    lines += [f"{key} = {_quoted(getattr(material.provenance, key))}" for key in ("kind", "source")]
    return "\n".join(lines) + "\n"


def _shortest(value: float, unit: str) -> float:
    """The rounded number in ``unit`` if it leads back to the same SI value, else the full one."""
    shown = from_si(value, unit)
    short = float(f"{shown:.12g}")
    return short if to_si(short, unit) == value else shown


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in escaped) + '"'


def _only(table: dict[str, Any], known: set[str], where: str) -> None:
    for key in table:
        if key not in known:
            raise CuttingError(f"{where}: key {key!r} is not known; expected {', '.join(sorted(known))}.", where=key)


def _text(table: dict[str, Any], key: str, where: str) -> str:
    value = table.get(key)
    if not isinstance(value, str) or not value.strip():
        found = "nothing" if value is None else repr(value)[:40]
        raise CuttingError(f"{where}: {key} should be a text, found {found}.", where=key)
    return value


def _table(data: dict[str, Any], key: str, where: str) -> dict[str, Any]:
    value = data.get(key)
    if not isinstance(value, dict):
        raise CuttingError(f"{where}: the table [{key}] is missing.", where=key)
    return value
