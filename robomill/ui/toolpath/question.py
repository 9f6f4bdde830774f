"""What is it cutting? Asked in one row of a program that somebody brought, until somebody has said it."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import streamlit as st

from robomill.cutting.force import ForceModel
from robomill.cutting.forces import FORCES
from robomill.cutting.materials import Material
from robomill.cutting.tool import Cutter
from robomill.cutting.tool_table import ASKED, TableTool, ToolTable
from robomill.errors import CuttingError, ToolpathError
from robomill.provenance import Provenance
from robomill.quantities import quantities
from robomill.simulation.origin.sources import changed_sources
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.tools import cutting_numbers
from robomill.toolpath.path import Toolpath
from robomill.toolpath.source import GCodeSource
from robomill.ui import pieces, session
from robomill.ui.entry import declared, inputs, typed
from robomill.ui.entry.box import NumberBox, box_of
from robomill.ui.entry.rows import force_of, rows, titles
from robomill.ui.entry.tools import missing
from robomill.units import format_many, format_si

KEY, MATERIAL = "toolpath.question", "material"
SIZE = ("diameter", "flutes")
BOXES = (*SIZE, "n_s", "tolerance")
MOST_TOOLS = 4  # are asked for one by one; more come by a table
SAID = Provenance("user", "said of the program when it was brought")


def panel(path: Toolpath | None, premise: str) -> bool:
    """The row, where nobody has said yet what the project's program cuts; ``premise`` is what its numbers rest on.

    Answers whether it asks for tools.
    """
    setup = session.project().setup
    if not setup.carried_from:
        return False
    lacking = _lacking(setup, path)
    with st.container(border=True, key="toolpath-question"):
        pieces.strong("What is it cutting?")
        hold = f"hold {premise}, and nothing is judged" if premise else "say nothing of this program"
        pieces.note(
            pieces.badge("assumed"), f"Until you say it, the numbers are those of {setup.carried_from}: they {hold}."
        )
        if path is not None and path.cutting.any():
            pieces.note(f"{_stock(setup)} Another one is given on the Milling page.")
        boxes = _boxes(setup, path)
        for number in lacking:
            _row_of(_of_tool(number))
        first, rest = pieces.split([1.0, 0.42 * len(boxes)], "question")
        with first:
            inputs.pick("Material", f"{KEY}.{MATERIAL}", titles(), _first(setup.force).name, inputs.LISTED)
        with rest:
            _row_of(boxes)
        with typed.said_below(), st.container(horizontal=True, gap="small"):
            inputs.button("This is what it cuts", f"{KEY}.answer", "check", _answer, path, type="primary")
            if premise:
                keep = f"Keep it: {premise.removeprefix('if ')}"
                inputs.button(keep, f"{KEY}.keep", "", _accept, setup, type="tertiary")
    return bool(lacking)


def _lacking(setup: SimulationSetup, path: Toolpath | None) -> list[int]:
    """Numbers of the tools that cut and that nobody has described, where they are few enough to be asked for here."""
    found = [] if path is None else missing(setup.tools, cutting_numbers(path).tolist())
    return found if len(found) <= MOST_TOOLS else []


def _of_tool(number: int) -> dict[str, tuple[NumberBox, float | None]]:
    """The boxes of a tool that the program calls by its ``number``, with what is in them."""
    said, shown = quantities(Cutter), {"optional": True, "placeholder": "needed"}
    return {
        f"{name}.{number}": (
            box_of(
                said[name],
                unit=declared.in_view(said[name].unit),
                label=f"{said[name].label} of tool {number}",
                **shown,
            ),
            session.kept(f"{KEY}.{name}.{number}"),
        )
        for name in SIZE
    }


def _tools(setup: SimulationSetup, lacking: Sequence[int]) -> ToolTable:
    """The table with the tools that were asked for. Raises the refusal of a box that is empty."""
    made = {tool.number: tool for tool in setup.tools.tools}
    for number in lacking:
        diameter, flutes = (value for _, value in _of_tool(number).values())
        if diameter is None or flutes is None:
            raise CuttingError(f"Tool {number}: it cuts, and its diameter or its flutes are not said; type both.")
        known = made.get(number, TableTool(number))
        new = Cutter("flat", diameter, flutes=int(flutes))
        made[number] = replace(known, cutter=new, assumed=tuple(name for name in ASKED if name != "flutes"))
    return ToolTable(tuple(made.values()))


def _stock(setup: SimulationSetup) -> str:
    """The block that is cut, with the height up to which it stands, and whose it is."""
    unit, block = session.project().view.length, setup.stock_block
    whose = "a block around the cuts, assumed" if setup.stock is None else "the one you gave"
    size = format_many(block.upper - block.lower, unit, 1, " × ")
    top = format_si(block.upper[2], unit, 1)
    return f"Stock: {whose}, {size}, its top at Z = {top}."


def _row_of(boxes: dict[str, tuple[NumberBox, float | None]]) -> None:
    declared.in_row(list(boxes), lambda name: _box(name, *boxes[name]))


def _box(name: str, box: NumberBox, value: float | None) -> None:
    key = f"{KEY}.{name}"
    inputs.value(key, box, value, partial(session.keep, key))


def forget() -> None:
    """Nothing of an answer that was begun for another program."""
    for name in (MATERIAL, *BOXES):
        session.drop(f"{KEY}.{name}")
    for key in [each for each in session.store().values if each.startswith(tuple(f"{KEY}.{name}." for name in SIZE))]:
        session.drop(key)


def _boxes(setup: SimulationSetup, path: Toolpath | None) -> dict[str, tuple[NumberBox, float | None]]:
    """The boxes beside the material with what is in them: the cutter's size where no tool table says it, the speed
    where the program does not."""
    said = {**quantities(SimulationSetup), **quantities(GCodeSource), **quantities(Cutter)}
    first = {name: getattr(setup.cutter, name) for name in SIZE} | {"n_s": None, "tolerance": setup.tolerance}
    names = [name for name in BOXES if not (name in SIZE and (setup.tools or _lacking(setup, path)))]
    if path is None or path.turns or setup.source.kind != "program":
        names.remove("n_s")
    shown: dict[str, dict[str, Any]] = {"n_s": {"optional": True, "placeholder": "needed"}}
    return {
        name: (
            box_of(said[name], unit=declared.in_view(said[name].unit), **shown.get(name, {})),
            session.kept(f"{KEY}.{name}", first[name]),
        )
        for name in names
    }


def _first(force: ForceModel) -> Material:
    """The row that is offered first: the one in force, or the example of the first model that takes rows."""
    held: Material | None = getattr(force, MATERIAL, None)
    return held or rows()[next(model.example for model in FORCES.values() if model.takes is not None)]


def _answer(path: Toolpath | None) -> None:
    """What was said into the set-up, as one step back. Raises the refusal of what cannot be."""
    setup = session.project().setup
    found: dict[str, Any] = {name: value for name, (_, value) in _boxes(setup, path).items()}
    if "n_s" in found and not found["n_s"]:
        raise ToolpathError("Spindle speed: the program names none; type how fast it turns at the machine.")
    row = rows()[session.kept(f"{KEY}.{MATERIAL}", _first(setup.force).name)]
    cutter = replace(setup.cutter, **{name: found[name] for name in SIZE if name in found})
    changed: dict[str, Any] = {"cutter": cutter, "force": force_of(row, cutter), "engagement": True}
    if lacking := _lacking(setup, path):
        changed["tools"] = _tools(setup, lacking)
    changed |= {"tolerance": found["tolerance"], "floor_tolerance": None, "feed_tolerance": None}
    if "n_s" in found and setup.source.kind == "program":
        changed["source"] = replace(setup.source, n_s=found["n_s"])
    _accept(setup, **changed)


def _accept(setup: SimulationSetup, **changed: Any) -> None:
    """``setup``, with what was ``changed``, and its numbers said by a person to be those of this program."""
    numbers = {name: value for name, value in changed.items() if name != "source"}
    said = {name: SAID if each.carried_from else each for name, each in setup.provenance.items()}
    said = changed_sources(setup, numbers, SAID) | {name: each for name, each in said.items() if each is SAID}
    session.replace(session.project().replace(setup=setup.replace(**{**changed, "provenance": said})))
    forget()
