"""Set-ups as TOML files: one versioned format for samples, the command line and the app's saved projects."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from robomill.arrays import FloatArray
from robomill.cutting.tool import Cutter
from robomill.errors import ProjectError, RobomillError
from robomill.io.force_models import force_from_table, force_to_table
from robomill.io.robots import load_robot, robot_from_toml, robot_names, robot_to_toml
from robomill.io.sketches import sketch_from_table, sketch_to_table
from robomill.io.springs import links_from_table, links_to_table, spring_from_table, spring_to_table
from robomill.io.tables import Table, parse_toml
from robomill.robot.model import Robot
from robomill.simulation.setup import SimulationSetup
from robomill.surface.stock import Stock
from robomill.toolpath.source import GCodeSource, LinesSource, PathSource, SketchSource
from robomill.units import from_si, to_si

FORMAT = "robomill-setup"
VERSION = 1
MAX_PROGRAM_BYTES = 100_000_000
BLOCKS = ("path", "part", "stock", "cutter", "force", "tolerance")


def load_setup(path: str | Path) -> SimulationSetup:
    """A set-up from its TOML file; files it names are looked for beside it.

    Raises ProjectError (or the error of the part that is wrong) with the file and the key.
    """
    file = Path(path)
    if file.is_dir():
        file = file / "setup.toml"
    try:
        text = file.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise ProjectError(f"{file}: there is no such file; give the path of a set-up (.toml).") from None
    except (OSError, UnicodeDecodeError) as exc:
        raise ProjectError(
            f"{file}: cannot be read as text ({exc.__class__.__name__}); expected a set-up (.toml)."
        ) from None
    return setup_from_toml(text, where=file.name, folder=file.parent)


def setup_from_toml(text: str, where: str = "set-up", folder: Path | None = None) -> SimulationSetup:
    """A set-up from TOML text. Without a ``folder`` everything must be in the text itself."""
    top = Table(parse_toml(text, where), where)
    found = top.text("format", "")
    if found != FORMAT:
        raise top.refuse("format", f"expected {FORMAT!r}, found {found!r}; this is not a robomill set-up.")
    version = top.whole("version")
    if version != VERSION:
        raise top.refuse("version", f"this file is version {version}; this robomill reads version {VERSION}.")
    cutter = _cutter(top.table("cutter"))
    setup = SimulationSetup(
        name=top.text("name"),
        description=top.text("description", ""),
        tolerance=top.number("tolerance_mm", "mm", 0.3e-3),
        robot=_robot(top.table("robot"), folder),
        source=_source(top.table("path"), folder),
        T_MW=_part(top.table("part", {})),
        cutter=cutter,
        stock=_stock(top.table("stock")) if top.has("stock") else None,
        force=force_from_table(top.table("force"), cutter, folder),
        provenance=_provenance(top.table("provenance", {})),
        springs=tuple(spring_from_table(entry) for entry in top.tables("springs")),
        links=links_from_table(top.table("links")) if top.has("links") else None,
        **_numerics(top.table("numerics", {})),
    )
    top.asked.update(("stock", "links"))
    top.finish()
    return setup


def _robot(table: Table, folder: Path | None) -> Robot:
    if table.has("definition"):
        robot = robot_from_toml(table.text("definition"), f"{table.where}, definition")
    else:
        name = table.text("name")
        beside = folder / name if folder else None
        robot = load_robot(beside if beside is not None and beside.is_file() else name)
    chosen = table.text("compliance_set", "")
    table.asked.update(("name", "definition"))
    table.finish()
    return robot.with_compliance_set(chosen) if chosen and chosen != robot.compliance_set else robot


def _source(table: Table, folder: Path | None) -> PathSource:
    kinds = [key for key in ("program", "program_text", "lines_mm", "sketch") if table.has(key)]
    if len(kinds) != 1:
        raise table.refuse(
            "program", f"expected one of program, program_text, lines_mm or sketch, found {kinds or 'none'}."
        )
    source: PathSource
    if kinds == ["lines_mm"]:
        rows = table.rows("lines_mm", 6, "mm")
        feeds = table.numbers("feed_mm_min", len(rows), "mm/min")
        source = LinesSource(rows[:, :3], rows[:, 3:], np.array(feeds), table.number("spindle_1_min", "1/min", 0.0))
    elif kinds == ["sketch"]:
        source = SketchSource(sketch_from_table(table.table("sketch")))
    elif kinds == ["program"]:
        name = table.text("program")
        source = read_program((folder or Path()) / name, table.text("dialect", "auto"))
    else:
        source = GCodeSource(
            table.text("program_text"), table.text("program_name", "program.nc"), table.text("dialect", "auto")
        )
    table.finish()
    return source


def read_program(path: str | Path, dialect: str = "auto") -> GCodeSource:
    """A program's file as a source; refused where it is missing, too large or not text."""
    file = Path(path)
    try:
        if file.stat().st_size > MAX_PROGRAM_BYTES:
            raise ProjectError(f"{file.name}: larger than {MAX_PROGRAM_BYTES // 10**6} MB; split the program.")
        return program_from_bytes(file.read_bytes(), file.name, dialect)
    except FileNotFoundError:
        raise ProjectError(f"{file}: there is no such program; check the name.") from None
    except OSError as exc:
        raise ProjectError(f"{file}: cannot be read ({exc.strerror}).") from None


def program_from_bytes(data: bytes, name: str, dialect: str = "auto") -> GCodeSource:
    """What a person dropped or named, as a source (UTF-8, UTF-16 with its mark, else Latin-1)."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return GCodeSource(data.decode("utf-16", errors="replace"), name, dialect)
    if b"\0" in data[:4096]:
        raise ProjectError(f"{name}: this is a binary file; expected a program in text (G-code).")
    if not data.strip():
        raise ProjectError(f"{name}: the file is empty; expected a program in text (G-code).")
    try:
        return GCodeSource(data.decode("utf-8-sig"), name, dialect)
    except UnicodeDecodeError:
        return GCodeSource(data.decode("latin-1"), name, dialect)


def _part(table: Table) -> FloatArray:
    if table.has("frame"):
        T_MW = np.eye(4)
        T_MW[:3] = np.array(table.rows("frame", 4, "1"))[:3]
        T_MW[:3, 3] = to_si(T_MW[:3, 3], "mm")
    else:
        T_MW = part_frame(table.numbers("zero_mm", 3, "mm", [0.0] * 3), table.number("rotation_z_deg", "deg", 0.0))
    table.finish()
    return T_MW


def part_frame(zero: Any, rotation_z: float = 0.0) -> FloatArray:
    """T_MW from the part zero (3,) m in {M} and the part's turn about z_M in rad."""
    c, s = np.cos(rotation_z), np.sin(rotation_z)
    T_MW = np.eye(4)
    T_MW[:2, :2] = [[c, -s], [s, c]]
    T_MW[:3, 3] = zero
    return T_MW


CUTTER_LENGTHS = ("diameter", "corner_radius", "flute_length", "stick_out", "tip_diameter")
CUTTER_ANGLES = ("helix_angle", "tip_angle")


def _cutter(table: Table) -> Cutter:
    given: dict[str, Any] = {"kind": table.text("kind"), "diameter": table.number("diameter_mm", "mm")}
    for names, unit in ((CUTTER_LENGTHS[1:], "mm"), (CUTTER_ANGLES, "deg")):
        for name in names:
            value = table.number(f"{name}_{unit}", unit, None)
            if value is not None:
                given[name] = value
    for name in ("helix", "hand"):
        if table.has(name):
            given[name] = table.text(name)
    given["flutes"] = table.whole("flutes", 2)
    table.finish()
    return Cutter(**given)


def _cutter_table(cutter: Cutter) -> dict[str, Any]:
    out: dict[str, Any] = {"kind": cutter.kind, "flutes": cutter.flutes, "helix": cutter.helix, "hand": cutter.hand}
    for names, unit in ((CUTTER_LENGTHS, "mm"), (CUTTER_ANGLES, "deg")):
        for name in names:
            value = getattr(cutter, name)
            if value is not None and (value != 0.0 or name == "diameter" or name == "helix_angle"):
                out[f"{name}_{unit}"] = _shown(value, unit)
    return out


def _stock(table: Table) -> Stock:
    lower, upper = table.numbers("lower_mm", 3, "mm"), table.numbers("upper_mm", 3, "mm")
    table.finish()
    return Stock(lower=np.array(lower), upper=np.array(upper))


def _numerics(table: Table) -> dict[str, Any]:
    values = {
        "step": table.number("step_mm", "mm", 1e-3),
        "cell": table.number("cell_mm", "mm", 1e-4),
        "engagement": table.flag("engagement", False),
        "coupling": table.flag("coupling", False),
        "add_sag": table.flag("add_sag", False),
    }
    table.finish()
    return values


def _provenance(table: Table) -> dict[str, Any]:
    entries = {key: table.provenance(key) for key in table.data}
    table.finish()
    return entries


def setup_to_toml(setup: SimulationSetup) -> str:
    """The set-up as one self-contained file that ``setup_from_toml`` reads back to the same digest."""
    T_MW = setup.T_MW
    data: dict[str, Any] = {
        "format": FORMAT, "version": VERSION, "name": setup.name, "description": setup.description,
        "tolerance_mm": _shown(setup.tolerance, "mm"),
        "robot": _robot_table(setup.robot),
        "path": _source_table(setup.source),
        "part": _part_table(T_MW),
        "cutter": _cutter_table(setup.cutter),
        "force": force_to_table(setup.force),
        "numerics": {
            "step_mm": _shown(setup.step, "mm"), "cell_mm": _shown(setup.cell, "mm"),
            "engagement": setup.engagement, "coupling": setup.coupling, "add_sag": setup.add_sag,
        },
        "provenance": {key: {"kind": p.kind, "source": p.source} for key, p in setup.provenance.items()},
    }  # fmt: skip
    if setup.stock is not None:
        data["stock"] = {
            "lower_mm": [_shown(v, "mm") for v in setup.stock.lower],
            "upper_mm": [_shown(v, "mm") for v in setup.stock.upper],
        }
    if setup.springs:
        data["springs"] = [spring_to_table(spring) for spring in setup.springs]
    if setup.links is not None:
        data["links"] = links_to_table(setup.links)
    # TOML reads the line ends of multi-line strings as plain ones, so a program with others is written escaped.
    plain = "\r" not in getattr(setup.source, "text", "")
    return tomli_w.dumps(data, multiline_strings=plain)


def _robot_table(robot: Robot) -> dict[str, Any]:
    if robot.name in robot_names():
        preset = load_robot(robot.name)
        if robot.compliance_set in preset.compliance_sets:
            preset = preset.with_compliance_set(robot.compliance_set)
        if preset.digest() == robot.digest():
            return {"name": robot.name, "compliance_set": robot.compliance_set}
    return {"definition": robot_to_toml(robot)}


def _source_table(source: PathSource) -> dict[str, Any]:
    if isinstance(source, GCodeSource):
        return {"program_text": source.text, "program_name": source.name, "dialect": source.dialect}
    if isinstance(source, SketchSource):
        return {"sketch": sketch_to_table(source.sketch, _shown)}
    rows = np.hstack([source.start, source.end])
    return {
        "lines_mm": [[_shown(v, "mm") for v in row] for row in rows],
        "feed_mm_min": [_shown(v, "mm/min") for v in source.v_f],
        "spindle_1_min": _shown(source.n_s, "1/min"),
    }


def _part_table(T_MW: FloatArray) -> dict[str, Any]:
    zero = [_shown(v, "mm") for v in T_MW[:3, 3]]
    angle = _shown(float(np.arctan2(T_MW[1, 0], T_MW[0, 0])), "deg")
    if np.array_equal(part_frame(to_si(np.array(zero), "mm"), to_si(angle, "deg")), T_MW):
        return {"zero_mm": zero, "rotation_z_deg": angle}
    rows = T_MW.copy()
    rows[:3, 3] = zero
    return {"frame": rows.tolist()}


def _shown(value: float, unit: str) -> float:
    """The value in ``unit`` with as few digits as read back to the very same SI number."""
    exact = float(from_si(float(value), unit))
    for digits in range(1, 18):
        short = float(f"{exact:.{digits}g}")
        if to_si(short, unit) == value:
            return short
    for near in (exact, np.nextafter(exact, -np.inf), np.nextafter(exact, np.inf)):
        if to_si(float(near), unit) == value:
            return float(near)
    return exact


def open_project(text: str, where: str) -> SimulationSetup:
    """Open a person's saved project: every refusal is a ProjectError that names the file."""
    try:
        return setup_from_toml(text, where)
    except ProjectError:
        raise
    except RobomillError as exc:
        raise ProjectError(f"{where}: {exc}", where=where) from None
