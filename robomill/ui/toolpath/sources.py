"""Where the path comes from: switching between program, table of lines and sketch without losing the path."""

from contextlib import suppress
from dataclasses import replace
from pathlib import PurePath
from typing import Any

from robomill.arrays import digest
from robomill.cutting.tool_table import ToolTable
from robomill.errors import GCodeError, RobomillError
from robomill.provenance import UNSTATED, Provenance
from robomill.simulation.setup import SimulationSetup
from robomill.toolpath.path import Toolpath
from robomill.toolpath.rewritten import lines_of_path, sketch_of_path
from robomill.toolpath.sketch import Sketch
from robomill.toolpath.sketch_presets import preset
from robomill.toolpath.source import GCodeSource, PathSource, SketchSource
from robomill.ui import pieces, session
from robomill.ui.entry import inputs
from robomill.ui.toolpath import program_view, question
from robomill.ui.work import running
from robomill.units import format_count

KINDS = {"program": "Program", "lines": "Table of lines", "sketch": "Sketch"}
WHAT = {"program": "program", "points": "points", "sketch": "drawing", "lines": "table"}  # that somebody brought
POINTS = {"points": "Points"}  # what a file brings and nobody can choose: it can be made one of the others
LEFT = "toolpath.left"  # set-ups whose path was turned into another kind, each with what it became, last ones last
STATED = ("force", "cutter", "tolerance")  # blocks of a set-up that are of one cut


def kind_switch() -> None:
    """The choice between the three; points that a file has brought stand before them."""
    source = session.project().setup.source
    kinds = POINTS | KINDS if source.kind == "points" else KINDS
    inputs.choice("Path from", "toolpath.kind", kinds, source.kind, _convert)
    if source.kind == "points":
        count = format_count(len(source.path), "point")
        pieces.note(f"{count} from a file. To edit the path, turn it into a program, a table of lines or a sketch.")


def put(source: PathSource, words: str, from_editor: bool = False, **more: Any) -> None:
    """Make ``source`` the project's path; ``words`` say where it comes from. Raises its refusal."""
    provenance = {"path": Provenance("user", words), **more.pop("provenance", {})}
    named = source.kind in ("program", "points") or source.name != "sketch"
    more.setdefault("name", PurePath(source.name).stem if named and source.kind != "lines" else "Drawn here")
    session.change(source=source, provenance=provenance, from_editor=from_editor, **more)
    program_view.select_line(0)


def put_dropped(source: PathSource) -> None:
    """Make a program, points or a drawing that somebody brought the project's path. What was not stated by a person
    stands open until somebody says that it holds for this path, too; a stock that no person has given is that of
    another part, and goes. Raises its refusal."""
    setup = session.project().setup
    others = {name: said for name, said in setup.provenance.items() if name in STATED and said.kind != "user"}
    carried = {name: said.carried(setup.name) for name, said in others.items()}
    more: dict[str, Any] = {"engagement": True} if "force" in carried else {}
    stated = setup.provenance.get("stock")
    given = stated is None or stated.kind == "user"
    if not given:
        more["stock"] = None
        words = f"a block around what {source.name} cuts: nobody has said from which stock"
        carried["stock"] = Provenance("assumed", words)
    question.forget()
    put(source, f"{WHAT[source.kind]} {source.name}", provenance=carried, **more)


def read_with(source: PathSource, tools: ToolTable) -> Toolpath:
    """With the tool table; a tool that it lacks is asked for once the program is there."""
    try:
        return source.read(tools)
    except GCodeError as exc:
        if not tools:
            raise
        with suppress(GCodeError):
            return source.read()
        raise exc


def _convert(kind: str) -> None:
    """The same path by other means, as far as that goes. Undo leads back, and so does the way back as long as nothing
    was done to what it became: who only looks loses nothing."""
    setup = session.project().setup
    if kind in (setup.source.kind, *POINTS):
        return
    turned = _turned(setup)
    earlier = next((before for before, _ in reversed(turned) if before.source.kind == kind), None)
    if earlier is not None:
        _put_back(earlier, turned[-1][1])
        session.keep(LEFT, turned[: [before for before, _ in turned].index(earlier)])
        return
    _turn(kind, setup)
    session.keep(LEFT, (*turned, (setup, session.project().setup)))


def _turned(setup: SimulationSetup) -> tuple[tuple[SimulationSetup, SimulationSetup], ...]:
    """The turns that led to the path of ``setup``, none of which was touched in between."""
    turned: tuple[tuple[SimulationSetup, SimulationSetup], ...] = session.kept(LEFT, ())
    now = setup.source
    for before, became in reversed(turned):
        if digest(became.source) != digest(now):
            return ()
        now = before.source
    return turned


def _put_back(earlier: SimulationSetup, became: SimulationSetup) -> None:
    """The path of ``earlier``, with what went with it where that is still as ``became`` had it."""
    setup = session.project().setup
    blocks = ["path", *(name for name in ("force", "stock") if _same(name, setup, became))]
    said = {name: earlier.provenance.get(name, UNSTATED) for name in blocks}
    stock: dict[str, Any] = {"stock": earlier.stock} if "stock" in blocks else {}
    session.change(source=earlier.source, name=earlier.name, provenance=said, **stock)
    program_view.select_line(0)


def _same(block: str, one: SimulationSetup, other: SimulationSetup) -> bool:
    return digest(getattr(one, block)) == digest(getattr(other, block))


def _turn(kind: str, setup: SimulationSetup) -> None:
    running.wait_for_path(setup)
    if kind == "lines":
        put(lines_of_path(setup.toolpath), "converted to a table of lines")
    elif kind == "program":
        from robomill.io.gcode_out import toolpath_to_gcode

        name = f"{setup.source.kind}.nc"
        put(GCodeSource(toolpath_to_gcode(setup.toolpath), name), f"written from a {setup.source.name}")
    else:
        try:
            traced = sketch_of_path(setup.toolpath)
        except RobomillError:
            traced = None
        # A stated block rarely fits what will be drawn: the stock becomes the bounds of the path.
        put(SketchSource(traced or preset("slot", Sketch(), setup.cutter.diameter)), "sketched by hand", stock=None)


def sketch_source() -> SketchSource:
    """The project's sketch; only where the path is sketched."""
    source = session.project().setup.source
    assert source.kind == "sketch"
    return source


def put_sketch(sketch: Sketch, words: str = "sketched by hand", from_editor: bool = False) -> None:
    """Replace the sketch; what only concerns drawing (snap, next feed and depth) is no step to undo."""
    held, source = session.store(), sketch_source()
    changed = replace(source, sketch=sketch)
    setup = held.project.setup
    if setup.replace(source=changed).digest() == setup.digest():
        held.project = replace(held.project, setup=setup.replace(source=changed))
    else:
        put(changed, words, from_editor=from_editor)
