"""Set-ups as TOML files: one versioned format for samples, the command line and the app's saved projects."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from robomill.arguments import asked
from robomill.compliance.gravity import LinkMasses
from robomill.compliance.springs import SPRINGS
from robomill.cutting.tool import ASKED, Cutter
from robomill.cutting.tool_table import ToolTable
from robomill.errors import ProjectError, RobomillError
from robomill.files import PROGRAM, ROBOT, SETUP
from robomill.identification.knowledge import Knowledge
from robomill.io.beside import ALONE, Beside
from robomill.io.declared import (
    from_table,
    kind_from_table,
    kind_to_table,
    read_quantity,
    to_table,
    write_quantity,
)
from robomill.io.measured.measured_maps import map_from_table, map_to_table
from robomill.io.programs import program_from_bytes
from robomill.io.robot.reader import ANGLE, robot_from_toml
from robomill.io.robot.robots import load_robot, read_robot, robot_names
from robomill.io.robot.writer import robot_to_toml
from robomill.io.samples import sample_or_file
from robomill.io.setups.force_models import force_from_table, force_to_table
from robomill.io.setups.knowledge import knowledge_from_table, knowledge_to_table
from robomill.io.setups.points import POINTS, points_from_table, points_to_table
from robomill.io.setups.sketches import sketch_from_table, sketch_to_table
from robomill.io.setups.tool_tables import tools_from_table, tools_to_tables
from robomill.io.setups.workpiece import (
    part_from_table,
    part_to_table,
    stock_from_table,
    stock_to_table,
)
from robomill.io.tables import Table, parse_toml, shown
from robomill.io.texts import read_text
from robomill.kinematics.spin import LEAST_MOTION, RULES
from robomill.provenance import Provenance
from robomill.quantities import quantities
from robomill.robot.model import Robot
from robomill.simulation.origin.sources import UNSTATED_TOLERANCE, unstated
from robomill.simulation.setup import ALLOWED, TOLERANCES, SimulationSetup
from robomill.spelled import made
from robomill.toolpath.path import TABLES
from robomill.toolpath.source import LEANS, GCodeSource, LinesSource, PathSource, SketchSource
from robomill.toolpath.text import SUFFIXES

FORMAT = "robomill-setup"
OF_THE_APP = ("view", "maps", "experiments")  # tables of a saved project that only the app reads
VERSION = 1
NUMBERS = quantities(SimulationSetup)
SOURCES = ("program", "program_text", "lines_mm", "sketch", *POINTS)
NUMERICS = tuple(name for name in NUMBERS if name not in ALLOWED)  # in [numerics]


@asked
def load_setup(path: str | Path, allow_outside: bool = False) -> SimulationSetup:
    """A set-up from its TOML file.

    Parameters
    ----------
    path : str or Path
        The file, the folder that holds it as ``setup.toml``, or the name of a sample ("heart",
        "paper_flute/setup_process").
    allow_outside : bool
        Whether it may name files elsewhere than beside it or below.

    Returns
    -------
    SimulationSetup
        In SI.

    Raises
    ------
    ProjectError
        With the file and the key; of a part that is wrong, that part's own error.

    Examples
    --------
    >>> import robomill as rm
    >>> setup = rm.load_setup("paper_flute")
    >>> setup.cutter, setup.tolerance
    (<Cutter 8.00 mm flat end mill, 3 flutes>, 0.0003)
    """
    file = sample_or_file("set-up", path, ProjectError)
    if file.is_dir():
        file = file / "setup.toml"
    if file.suffix.lower() in SUFFIXES and file.suffix.lower() != ".txt":  # which a set-up may end in, too
        raise ProjectError(
            f"{file}: this is a program, not a set-up; read it with 'robomill gcode', or cut it with "
            "'robomill simulate SETUP.toml --program'."
        )
    text, _ = read_text(file, ProjectError, SETUP)
    return setup_from_toml(text, file.name, Beside(file.parent, allow_outside))


def setup_from_toml(text: str, where: str = "set-up", beside: Beside = ALONE) -> SimulationSetup:
    """A set-up from TOML text; ``beside`` are the files it may name: none, unless told otherwise."""
    return setup_from_table(parse_toml(text, where, exact=True), where, beside)


def setup_from_table(data: dict[str, Any], where: str, beside: Beside = ALONE) -> SimulationSetup:
    """A set-up from what ``parse_toml`` made of its file."""
    top = Table(data, where)
    found = top.text("format", "")
    if found != FORMAT:
        raise top.refuse("format", f"expected {FORMAT!r}, found {found!r}; this is not a robomill set-up.")
    version = top.whole("version")
    if version != VERSION:
        raise top.refuse("version", f"this file is version {version}; this robomill reads version {VERSION}.")
    robot = _robot(top.table("robot"), beside)
    tools = tools_from_table(top, beside)
    cutter = _cutter(top, tools)
    known: dict[str, Any] = dict(
        name=top.text("name"),
        description=top.text("description", ""),
        **_tolerances(top),
        robot=robot,
        source=_source(top.table("path"), beside),
        T_MW=part_from_table(top.table("part", {})),
        cutter=cutter,
        tools=tools,
        spin=_spin(top),
        stock=stock_from_table(top.table("stock"), beside) if top.has("stock") else None,
        force=force_from_table(top.table("force"), cutter, beside),
        provenance=_provenance(top.table("provenance", {})),
        springs=tuple(kind_from_table(entry, SPRINGS) for entry in top.tables("springs")),
        measured_map=map_from_table(top.table("measured_map"), robot, beside) if top.has("measured_map") else None,
        links=from_table(top.table("links"), LinkMasses) if top.has("links") else None,
        **_numerics(top.table("numerics", {})),
    )
    known["provenance"] = _unstated(top, known) | known["provenance"]
    if top.has("uncertainty"):
        known["knowledge"] = knowledge_from_table(top.table("uncertainty"), robot, known["springs"])
    setup = made(SimulationSetup, known)
    top.asked.update(("stock", "links", "measured_map", "uncertainty", "tools", "tools_unit", *OF_THE_APP))
    top.finish()
    return setup


def _unstated(top: Table, known: dict[str, Any]) -> dict[str, Provenance]:
    """What is assumed as the file does not say it: the tolerance, and of a cutter what the force follows."""
    said = {} if top.has(NUMBERS["tolerance"].key) else {"tolerance": UNSTATED_TOLERANCE}
    if known["force"].follows_cut and top.has("cutter"):
        declared = quantities(Cutter)
        cutter = unstated(known["cutter"], [name for name in ASKED if declared[name].key not in top.data["cutter"]])
        said |= {} if cutter is None else {"cutter": cutter}
    return said


def _spin(top: Table) -> float | str:
    """``spin`` as a rule, or ``spin_deg`` as an angle."""
    angle = top.measure("spin", ANGLE, None)
    if angle is not None and top.has("spin"):
        raise top.refuse("spin", "it is given twice, as a rule and as an angle; keep one of them.")
    rule: float | str = top.choice("spin", RULES, LEAST_MOTION) if angle is None else float(angle)
    return rule


def _cutter(top: Table, tools: ToolTable) -> Cutter:
    """[cutter], or the first of [[tools]] that is one."""
    known = [tool.cutter for tool in tools.tools if tool.cutter is not None]
    if known and not top.has("cutter"):
        top.asked.add("cutter")
        return known[0]
    return from_table(top.table("cutter"), Cutter)


def _robot(table: Table, beside: Beside) -> Robot:
    table.asked.update(("name", "definition", "compliance_set"))
    if not table.has("name"):
        table.finish()  # another key may be meant, and says more than that one is missing
    if table.has("definition"):
        robot = robot_from_toml(table.text("definition"), f"{table.where}, definition")
    elif (name := table.text("name")) in robot_names():
        robot = load_robot(name)
    elif "." not in name:
        raise table.refuse("name", f"there is no robot {name!r:.80}; the presets are {', '.join(robot_names())}.")
    else:
        robot = read_robot(*beside.read(table, "name", ROBOT))
    chosen = table.text("compliance_set", "")
    table.finish()
    return robot.with_compliance_set(chosen) if chosen and chosen != robot.compliance_set else robot


def _source(table: Table, beside: Beside) -> PathSource:
    """[path]; beside a corrected program stands what was ``wanted``: the name of a program that is read as this one is,
    or a table as [path] itself."""
    kinds = [key for key in SOURCES if table.has(key)]
    if len(kinds) != 1:
        raise table.refuse("program", f"expected one of {', '.join(SOURCES)}; found {kinds or 'none'}.")
    source: PathSource
    if kinds[0] in POINTS:
        return points_from_table(table)
    if kinds == ["lines_mm"]:
        rows = table.rows("lines_mm", 6, "mm")
        feeds = table.numbers("feed_mm_min", len(rows), "mm/min")
        n_s = read_quantity(table, quantities(LinesSource)["n_s"])
        source = made(LinesSource, {"start": rows[:, :3], "end": rows[:, 3:], "v_f": np.array(feeds), "n_s": n_s})
    elif kinds == ["sketch"]:
        source = SketchSource(sketch_from_table(table.table("sketch")))
    else:
        if kinds == ["program"]:
            source = program_from_bytes(*beside.read(table, "program", PROGRAM), table.text("dialect", "auto"))
        else:
            source = GCodeSource(
                table.text("program_text"), table.text("program_name", "program.nc"), table.text("dialect", "auto")
            )
        rotary = table.choice("rotary_axis", (*TABLES, LEANS), "")
        source = replace(source, n_s=read_quantity(table, quantities(GCodeSource)["n_s"]), table=rotary)
        table.asked.add("wanted")
        if isinstance(table.data.get("wanted"), dict):
            source = replace(source, wanted=_source(table.table("wanted"), beside))
        elif table.has("wanted"):
            meant = program_from_bytes(*beside.read(table, "wanted", PROGRAM), source.dialect)
            source = replace(source, wanted=replace(meant, n_s=source.n_s, table=rotary))
    table.finish()
    return source


def _tolerances(top: Table) -> dict[str, Any]:
    """``tolerance_mm`` as one number, or as a table of wall, floor and feed (the last two may be left out)."""
    key = NUMBERS["tolerance"].key
    if not isinstance(top.data.get(key), dict):
        return {"tolerance": read_quantity(top, NUMBERS["tolerance"])}
    table = top.table(key)
    found = {field: table.number(name, "mm") for name, field in zip(TOLERANCES, ALLOWED) if table.has(name)}
    if "tolerance" not in found:
        raise table.refuse("wall", "it is missing; give one number, or wall and what else is judged: floor, feed.")
    table.asked.update(TOLERANCES)
    table.finish()
    return found


def _tolerance_table(setup: SimulationSetup) -> Any:
    given = {name: getattr(setup, field) for name, field in zip(TOLERANCES, ALLOWED)}
    written = {name: shown(value, "mm") for name, value in given.items() if value is not None}
    return written if len(written) > 1 else written["wall"]


def _numerics(table: Table) -> dict[str, Any]:
    values = {name: read_quantity(table, NUMBERS[name]) for name in NUMERICS}
    table.finish()
    return values


def _provenance(table: Table) -> dict[str, Any]:
    entries = {key: table.provenance(key) for key in table.data}
    table.finish()
    return entries


def setup_to_toml(setup: SimulationSetup, known: Knowledge | None = None) -> str:
    """The set-up as one self-contained file that ``setup_from_toml`` reads back to the same digest; ``known`` is what
    is known of its compliances where it is not the set-up's own."""
    T_MW = setup.T_MW
    data: dict[str, Any] = {
        "format": FORMAT,
        "version": VERSION,
        "name": setup.name,
        "description": setup.description,
        NUMBERS["tolerance"].key: _tolerance_table(setup),
        "robot": _robot_table(setup.robot),
        "path": _source_table(setup.source),
        "part": part_to_table(T_MW),
        "cutter": to_table(setup.cutter),
        "force": force_to_table(setup.force),
        "numerics": {
            NUMBERS[name].key: write_quantity(NUMBERS[name], getattr(setup, name))
            for name in NUMERICS
            if getattr(setup, name) is not None
        },
        "provenance": {key: said.record() for key, said in setup.provenance.items()},
    }
    if setup.stock is not None:
        data["stock"] = stock_to_table(setup.stock)
    if setup.tools:
        data["tools"] = tools_to_tables(setup.tools)
    if setup.spin != LEAST_MOTION:
        data["spin" if isinstance(setup.spin, str) else "spin_rad"] = setup.spin
    if setup.springs:
        data["springs"] = [kind_to_table(spring) for spring in setup.springs]
    if setup.measured_map is not None:
        data["measured_map"] = map_to_table(setup.measured_map)
    if setup.links is not None:
        data["links"] = to_table(setup.links)
    if (sure := known or setup.known) is not None:
        data["uncertainty"] = knowledge_to_table(sure)
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
    if source.kind == "program":
        told: dict[str, Any] = {"program_text": source.text, "program_name": source.name, "dialect": source.dialect}
        told |= {"rotary_axis": source.table} if source.table else {}
        told |= {"spindle_1_min": shown(source.n_s, "1/min")} if source.n_s else {}
        return told | ({} if source.wanted is None else {"wanted": _source_table(source.wanted)})
    if source.kind == "sketch":
        return {"sketch": sketch_to_table(source.sketch)}
    if source.kind == "points":
        return points_to_table(source)
    rows = np.hstack([source.start, source.end])
    return {
        "lines_mm": [[shown(v, "mm") for v in row] for row in rows],
        "feed_mm_min": [shown(v, "mm/min") for v in source.v_f],
        "spindle_1_min": shown(source.n_s, "1/min"),
    }


def open_project(data: dict[str, Any], where: str) -> SimulationSetup:
    """The set-up of a person's saved project: every refusal is a ProjectError that names the file."""
    try:
        return setup_from_table(data, where)
    except ProjectError:
        raise
    except RobomillError as exc:
        raise ProjectError(f"{where}: {exc}", where=where) from None
