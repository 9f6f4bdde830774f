"""``robomill simulate``: run a set-up, say the verdict, and write the result to a folder from which it runs again."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from robomill.cli import given
from robomill.cli.saying import Written, say
from robomill.errors import ProjectError, RobomillError, SetupError, SurfaceError

SETUP, RECORD, SOLID = "setup.toml", "result.json", "machined.stl"
TABLES = ("deviation.csv", "sections.csv")
PICTURES = ("deviation.png", "section.png")
NAMES = (SETUP, RECORD, *TABLES, SOLID, *PICTURES)


def run_simulate(arguments: Any) -> int:
    """Run; 1 where the verdict is red or nothing can be judged."""
    from robomill.report.plain import simulation_lines
    from robomill.report.simulation_record import simulation_record
    from robomill.simulation.run import simulate

    if arguments.out:
        _check_folder(Path(arguments.out), arguments)
    result = simulate(asked_setup(arguments))
    record = simulation_record(result)
    lines, files = simulation_lines(record), []
    if arguments.out:
        shapes, lost = _shapes(result, arguments.full_stl)
        files = _write(Path(arguments.out), {**_contents(result, record), **shapes})
        record["not_written"] = [{"name": name, "why": why} for name, why in lost.items()]
        for why in dict.fromkeys(lost.values()):
            lines.append(f"not written: {', '.join(name for name in lost if lost[name] == why)}. {why}")
    return say(arguments, record, lines, 1 if result.verdict.red else 0, files)


def asked_setup(arguments: Any) -> Any:
    """The set-up with what the options say in its stead, and who said so."""
    from robomill.provenance import Provenance

    given.check_tip(arguments)
    setup = given.setup(arguments.setup, arguments.allow_outside)
    changes: dict[str, Any] = {}
    said = {}
    if arguments.program:
        changes["source"] = given.source(arguments.program, arguments.unit, arguments.feed)
        said["path"] = Provenance("user", f"{changes['source'].kind} {changes['source'].name}")
    else:
        given.check_points_options("", arguments.unit, arguments.feed)
    if arguments.wanted:
        changes["source"] = _corrected_for(changes.get("source", setup.source), arguments.wanted)
    if arguments.robot:
        changes["robot"] = given.another_robot(arguments, setup)
    if arguments.tol is not None:
        changes |= {"tolerance_mm": arguments.tol, "floor_tolerance": None}
        said["tolerance"] = Provenance("user", "--tol")
    robot = changes.get("robot", setup.robot)
    if arguments.compliance_set:
        changes["robot"] = robot.with_compliance_set(arguments.compliance_set)
    return setup.replace(**changes, provenance=said)


def _corrected_for(source: Any, wanted: str) -> Any:
    """The program with the path that was meant."""
    if source.kind != "program":
        raise SetupError(f"--wanted: it goes with a corrected program, and the path of this set-up is {source.name}.")
    meant = given.source(wanted)
    if meant.kind == "program":
        meant = replace(meant, dialect=source.dialect, n_s=source.n_s, table=source.table)
    return replace(source, wanted=meant)


def _check_folder(folder: Path, arguments: Any) -> None:
    """Refuse, before anything is computed, a folder that is none, and one in which other work would be replaced."""
    if folder.exists() and not folder.is_dir():
        raise ProjectError(f"--out {folder}: this is a file; give a folder.")
    given_as = (arguments.setup, arguments.program, arguments.wanted, arguments.robot)
    read = {Path(name).resolve() for name in (*given_as, str(Path(arguments.setup) / SETUP)) if name}
    if {folder / name for name in NAMES} & read or {(folder / name).resolve() for name in NAMES} & read:
        raise ProjectError(f"--out {folder}: what this run reads stands there and would be replaced; give another.")
    if (folder / SETUP).exists() and not (folder / RECORD).exists():
        raise ProjectError(
            f"--out {folder}: a set-up stands there that no earlier run wrote ({SETUP}); give another folder."
        )


def _contents(result: Any, record: Mapping[str, Any]) -> dict[str, str | bytes]:
    """What there always is, by name."""
    from robomill.csv_text import csv_text
    from robomill.io.results import json_text
    from robomill.io.setups.projects import setup_to_toml
    from robomill.report.records import jsonable

    return {
        SETUP: setup_to_toml(result.setup),
        RECORD: json_text(jsonable(record)),
        TABLES[0]: csv_text(result.columns()),
        TABLES[1]: csv_text(result.sections.columns()),
    }


def _shapes(result: Any, every_cell: bool) -> tuple[dict[str, str | bytes], dict[str, str]]:
    """The solid and the pictures by name, and of those that cannot be made why."""
    made: dict[str, str | bytes] = {}
    lost = {}
    makers: tuple[Callable[[Any], bytes], ...] = (partial(_solid, every_cell=every_cell), _deviation, _section)
    for name, make in zip((SOLID, *PICTURES), makers, strict=True):
        try:
            made[name] = make(result)
        except RobomillError as exc:
            lost[name] = str(exc)
    return made, lost


def _solid(result: Any, every_cell: bool) -> bytes:
    from robomill.io.meshes import FEW_TRIANGLES, MOST_TRIANGLES, mesh_bytes

    if not result.removes.any():
        raise SurfaceError("Nothing is cut: the part would be the stock as it was.")
    return mesh_bytes(result.machined, "stl", max_faces=MOST_TRIANGLES if every_cell else FEW_TRIANGLES)


def _deviation(result: Any) -> bytes:
    from robomill.viz.deviation import components_figure
    from robomill.viz.plotted import png

    return png(components_figure(result, "mm", dark=False), [result.setup.name, result.verdict.sentence])


def _section(result: Any) -> bytes:
    """The section at the largest deviation, or the first that there is."""
    from robomill.simulation.stations import section_at
    from robomill.units import format_si
    from robomill.viz.plotted import png
    from robomill.viz.sections import section_figure
    from robomill.viz.views import section_drawing

    found = section_at(result, result.worst)
    if found is None:
        raise SurfaceError(f"No section can be drawn: {result.sections[0].note}.")
    worst = result.worst >= 0 and found.station == float(result.path.s[result.worst])
    words = f"Through the finished part, at {format_si(found.station, 'mm', 1)} of cut"
    words += f"{', at the largest deviation' * worst}; looking along the feed"
    return png(section_figure(section_drawing(found, "mm"), dark=False), [result.setup.name, words])


def _write(folder: Path, contents: Mapping[str, str | bytes]) -> list[Written]:
    from robomill.io.results import write_files

    files = Written.before([folder / name for name in contents])
    write_files(folder, contents)
    return files
