"""Sketches as the table ``[path.sketch]`` of a set-up file, by their declared fields."""

from typing import Any

from robomill.errors import ToolpathError
from robomill.io.declared import Around, Codec, from_table, to_table
from robomill.io.tables import Table
from robomill.toolpath.sketch import Element, Sketch


def sketch_from_table(table: Table) -> Sketch:
    """The sketch; raises ProjectError naming the key, or the shape that cannot be cut."""
    try:
        return from_table(table, Sketch, codecs=ELEMENTS)
    except ToolpathError as exc:
        raise table.refuse("elements", str(exc)) from None


def sketch_to_table(sketch: Sketch) -> dict[str, Any]:
    """What ``sketch_from_table`` reads back."""
    return to_table(sketch, ELEMENTS)


def _element(entry: Table) -> Element:
    try:
        return from_table(entry, Element)
    except ToolpathError as exc:
        raise entry.refuse("shape", str(exc)) from None


def _elements(table: Table, name: str, around: Around) -> tuple[Element, ...]:
    return tuple(_element(entry) for entry in table.tables(name))


ELEMENTS: dict[Any, Codec] = {
    tuple[Element, ...]: Codec(
        ("{name}",), _elements, lambda name, elements: {name: [to_table(element) for element in elements]}
    )
}
