"""Which keys a file may have: the readers themselves are asked, since they refuse every key that they do not know.

Files of every kind are read, and each table that is finished says which keys it knew. Nothing is listed by hand.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from robomill.compliance.gravity import LinkMasses
from robomill.compliance.springs import SPRINGS
from robomill.cutting.forces import FORCES
from robomill.cutting.forces.measured import ForceRecord, MeasuredForce
from robomill.identification.knowledge import Knowledge
from robomill.io.beside import Beside
from robomill.io.materials import material_from_toml, material_to_toml, sample_materials
from robomill.io.measured.identified import identify
from robomill.io.robot.reader import robot_from_toml
from robomill.io.robot.robots import load_robot
from robomill.io.robot.writer import robot_to_toml
from robomill.io.samples import samples_dir
from robomill.io.setups import points
from robomill.io.setups.projects import load_setup, setup_from_toml, setup_to_toml
from robomill.io.tables import Table
from robomill.robot.joints import with_new_joint
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.sketch import Element, Sketch
from robomill.toolpath.source import LinesSource, SketchSource

Keys = Mapping[tuple[str, str], set[str]]
OWN = "file"  # what a table of the file itself is called here

FRAMED = """
[part]
frame = [[0, -1, 0, 0], [1, 0, 0, -1300], [0, 0, 1, 2]]
"""
_FACETS = ("0 0 0 0 9 0 9 0 0", "0 0 0 9 0 0 0 0 9", "0 0 0 0 0 9 0 9 0", "9 0 0 0 9 0 0 0 9")


@contextmanager
def recorded(file: str) -> Iterator[dict[tuple[str, str], set[str]]]:
    """Keys by (table, kind) of the tables of ``file`` that are finished meanwhile; the kind is that of forces and
    springs."""
    found: dict[tuple[str, str], set[str]] = defaultdict(set)
    finish = Table.finish

    def finished(self: Table) -> None:
        if self.where.partition(", ")[0] == file:
            table = _name(self.where)
            found[table, str(self.data["kind"]) if table in ("force", "springs") else ""] |= self.asked
        finish(self)

    Table.finish = finished  # type: ignore[method-assign]
    try:
        yield found
    finally:
        Table.finish = finish  # type: ignore[method-assign]


def _name(where: str) -> str:
    """A table without its file and its number: "x, [part]" -> part, "x, springs 2, [source]" -> springs.source."""
    name = re.sub(r"[\[\]]| \d+(?=$|,)", "", where.partition(", ")[2])
    return name.replace(", ", ".") or OWN


def setup_keys() -> Keys:
    """Every table of a set-up."""
    with recorded("setup") as found, TemporaryDirectory() as folder:
        for text, beside in _setups(Path(folder)):
            setup_from_toml(text, "setup", beside)
    return found


def robot_keys() -> Keys:
    """Every table of a robot's file: presets, one with a joint that slides, one with numbers of its own."""
    robot = load_robot("slavkovic_5r")
    sliding = with_new_joint(robot, 0, slides=True).replace(C_theta=np.full(6, 1e-6))
    held = robot.replace(blocked=[np.nan, np.nan, np.nan, 0.0, np.nan])
    with recorded("robot") as found:
        for each in (robot, sliding, held, load_robot("kuka_kr270")):
            robot_from_toml(robot_to_toml(each), "robot")
    return found


def material_keys() -> Keys:
    """A material row, by its law."""
    with recorded("material") as found:
        for row in sample_materials():
            material_from_toml(material_to_toml(row), "material")
    return found


def _stl() -> str:
    """A small solid as an STL file."""
    facets = []
    for numbers in (facet.split() for facet in _FACETS):
        corners = "\n".join(f"vertex {' '.join(numbers[i : i + 3])}" for i in (0, 3, 6))
        facets.append(f"facet normal 0 0 0\nouter loop\n{corners}\nendloop\nendfacet")
    return "\n".join(["solid blank", *facets, "endsolid blank", ""])


def _setups(folder: Path) -> Iterator[tuple[str, Beside]]:
    """Texts of set-ups that together hold every table: the samples, and one for each force, spring and source."""
    samples = samples_dir()
    base = load_setup(samples / "paper_flute" / "setup.toml")
    for file in sorted(samples.glob("*/setup*.toml")):
        yield file.read_text(encoding="utf-8"), Beside(file.parent)
    for path in _point_tables():
        yield re.sub(r"\[path\]\n(?:[\w#].*\n)+", f"[path]\n{path}\n", _text_of(samples)), Beside()
    for changed in _variants(base, load_setup(samples / "paper_flute" / "setup_process.toml")):
        yield setup_to_toml(changed), Beside()
    plain = _text_of(samples)
    (folder / "path.nc").write_bytes((samples / "paper_flute" / "path.nc").read_bytes())
    yield re.sub(r"\[part\]\n(?:[\w#].*\n)+", FRAMED, plain), Beside(folder)
    (folder / "blank.stl").write_text(_stl(), encoding="utf-8")
    (folder / "force.csv").write_text("t_s,F_feed_normal_N\n0,90\n1,100\n2,100\n3,100\n", encoding="utf-8")
    yield re.sub(r"\[stock\]\n(?:[\w#].*\n)+", '[stock]\nstl = "blank.stl"\nunit = "mm"\n', plain), Beside(folder)
    yield (
        re.sub(r"\[force\]\n(?:[\w#].*\n)+", '[force]\nkind = "measured"\nfile = "force.csv"\n', plain),
        Beside(folder),
    )


def _text_of(samples: Path) -> str:
    return (samples / "paper_flute" / "setup.toml").read_text(encoding="utf-8")


def _point_tables() -> Iterator[str]:
    """A path of two points under every key that its reader has, in each of the units."""
    for k in (0, 1):
        lengths = [*points.POINTS][k]
        rows = [f"{lengths} = [[0.0, 0.0, -0.002], [0.05, 0.0, -0.002]]", "axis = [[0, 0, 1], [0, 0, 1]]"]
        rows += [f"{[*keys][min(k, len(keys) - 1)]} = [0.0, 0.5]" for keys in points.NUMBERS.values()]
        rows += [f"{key} = [1, 1]" for key in points.WHOLES]
        rows += [f"{key} = [false, {str(key == 'cutting').lower()}]" for key in points.FLAGS]
        yield "\n".join(rows)


def _variants(base: SimulationSetup, process: SimulationSetup) -> Iterator[SimulationSetup]:
    start, end = np.array([[0.0, 0.0, -0.002]]), np.array([[0.05, 0.0, -0.002]])
    yield base.replace(source=LinesSource(start, end, np.array([0.03]), 200.0))
    yield base.replace(source=SketchSource(Sketch((Element("line", [[0, 0], [0.05, 0]], 0.002, 0.03),))))
    yield base.replace(links=LinkMasses(np.ones(5), np.zeros((5, 3))))
    yield base.replace(spin=0.1)
    yield load_setup(samples_dir() / "paper_flute" / "setup_measured_map.toml")  # written with the map in it
    yield base.replace(
        springs=(*(cls(joint=1) if cls.each_joint else cls.first(base.cutter) for cls in SPRINGS.values()),)
    )
    found = identify(base.robot, "tilted_bending_tool", model="joints+bending")
    sure = Knowledge.of(found, base.robot, "from load tests").widened(base.robot, force=1.0, length=1e-4)
    arm, springs = found.applied_to(base.robot), found.springs(base.robot)
    yield base.replace(robot=arm, springs=springs, knowledge=sure.held_by(arm, springs))
    record = ForceRecord(np.arange(6.0), np.full((6, 3), 50.0))
    yield base.replace(force=MeasuredForce(record))
    rows = {type(row): row for row in sample_materials()}
    for model in FORCES.values():
        if model.takes is not None:
            yield process.replace(force=model(process.cutter, rows[model.takes]))  # type: ignore[call-arg]
        elif model is not MeasuredForce:
            numbers = {"vector_M": [0.0, 100.0, 0.0]} if model.kind == "constant" else {}
            yield base.replace(force=model(**numbers))
