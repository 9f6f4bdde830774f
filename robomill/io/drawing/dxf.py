"""DXF drawings as lines by layer: read by ezdxf, blocks opened where they are inserted, no other file followed."""

import io
import logging
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import islice
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import ToolpathError
from robomill.extras import needed
from robomill.io.drawing.dxf_lines import MAKERS, Place
from robomill.io.drawing.reading import STUMBLES, Read, Reading, metres
from robomill.units import format_count

MOST_ENTITIES = 50_000  # looked at, with those of blocks each time that one is inserted
MOST_TAGS, MOST_RECORDS = 1_000_000, 200_000  # of the file: pairs of lines, and those of them that begin something
DEEPEST_BLOCK = 16
# What $INSUNITS says, by names of ``metres``. (Autodesk, DXF Reference.)
UNITS_OF_DXF = {
    **{1: "in", 2: "ft", 3: "mi", 4: "mm", 5: "cm", 6: "m", 7: "km", 8: "uin", 9: "thou", 10: "yd", 11: "angstrom"},
    **{12: "nm", 13: "um", 14: "dm", 15: "dam", 16: "hm", 21: "US ft", 22: "US in", 23: "US yd", 24: "US mi"},
}
OF_STARS = {17: "gigametres", 18: "astronomical units", 19: "light years", 20: "parsecs"}


class Dxf:
    """A DXF document; ``unit`` is what it says its numbers are in, "" where it is silent: then it ``unsaid``."""

    def __init__(self, data: bytes, name: str) -> None:
        with needed("A DXF drawing"):
            from ezdxf import DXFError
        self.name = name
        _look_over(data, name)
        try:
            self.doc = _document(data, name)
            code = int(self.doc.header.get("$INSUNITS", 0)) if b"$INSUNITS" in data else 0  # ezdxf supposes metres
            self.unit, self.unsaid = UNITS_OF_DXF.get(code, ""), _unsaid(code)
        except ToolpathError:
            raise
        except (DXFError, *STUMBLES):  # ezdxf names most of what is wrong with a file by an error of its own
            text = f"{name}: this is no DXF file, or one that is damaged or cut off; export the drawing again as DXF."
            raise ToolpathError(text) from None
        except RecursionError:
            raise ToolpathError(f"{name}: its parts are nested too deep; export the drawing again as DXF.") from None

    def scale(self, unit: str) -> float:
        """m: its unit of length, where that is a ``unit``."""
        return metres(unit)

    def read(self, scale: float) -> Read:
        """Its lines, with ``scale`` (m) for its unit of length."""
        return _DxfReading(self.name, self.doc, scale).read()


def _unsaid(code: int) -> str:
    """What a file says of its unit by an $INSUNITS that tells none of a part."""
    if code == 0:
        return "does not say its unit"
    named = f"is drawn in {OF_STARS[code]}" if code in OF_STARS else "is drawn in a unit that nobody knows"
    return f"says by $INSUNITS {code} that it {named}"


def _look_over(data: bytes, name: str) -> None:
    """Refuse a file that is too much for ezdxf, which takes a hundred times its bytes where they are short lines."""
    tags = data.count(b"\n") // 2
    begun = sum(code.strip() == b"0" for code in islice(io.BytesIO(data), 0, None, 2)) if tags > MOST_RECORDS else 0
    for found, most, what in ((tags, MOST_TAGS, "values"), (begun, MOST_RECORDS, "entities and other records")):
        if found > most:
            raise Reading(name).refuse(f"it holds {format_count(found)} {what}, at most {format_count(most)} are read")


def _document(data: bytes, name: str) -> Any:
    """As it should be read, which is quick; where that fails, with ezdxf's mending of old and odd files."""
    import ezdxf
    from ezdxf import recover
    from ezdxf.audit import AuditError

    logging.getLogger("ezdxf").setLevel(logging.ERROR)  # a word for each number that it mends
    try:
        return ezdxf.read(io.StringIO(data.decode("utf-8-sig").replace("\r\n", "\n")))
    except (UnicodeDecodeError, ezdxf.DXFError):
        doc, audit = recover.read(io.BytesIO(data))
    for found in (*audit.errors, *audit.fixes):  # "1,5" would be 1.0
        if found.code == AuditError.INVALID_FLOATING_POINT_VALUE:
            raise ToolpathError(f"{name}: {found.message[:120]}; export the drawing again as DXF.")
    return doc


@dataclass(frozen=True, eq=False)
class _Around:
    """What the inserts around an entity say: a layer ("" for none), and ``T`` (4, 4), which rows of points go through.

    ``frozen``: all that is inside is on that layer, which hides it whatever its own says.
    """

    layer: str = ""
    frozen: bool = False
    depth: int = 0
    T: FloatArray = field(default_factory=lambda: np.eye(4))


class _DxfReading(Reading):
    """One pass through the model space."""

    def __init__(self, name: str, doc: Any, scale: float) -> None:
        super().__init__(name)
        self.doc, self.scale, self.looked_at = doc, scale, 0
        self.held: dict[str, int] = {}  # entities of each block, blocks opened
        self.spelled = {str(layer.dxf.name).lower(): str(layer.dxf.name) for layer in doc.layers}  # in their table
        self.frozen = {str(layer.dxf.name).lower() for layer in doc.layers if layer.is_frozen()}

    def read(self) -> Read:
        for layer in self.doc.layers:
            if layer.is_off() or layer.is_frozen():
                self.found.hidden.add(str(layer.dxf.name))
        self._walk(self.doc.modelspace(), _Around())
        return self.found

    def _walk(self, entities: Iterable[Any], around: _Around) -> None:
        """Take every entity on its layer; what a block has on layer 0 is on the layer of its insert."""
        place = Place(around.T[:, :2].T * self.scale)
        for entity in entities:
            self.looked_at += 1
            self._check_count(self.looked_at)
            self.look()
            kind = entity.dxftype()
            own = str(_said(entity, "layer", "0"))
            own = self.spelled.get(own.lower(), own)
            layer = around.layer if around.frozen or (own == "0" and around.layer) else own
            if kind == "ATTDEF" and around.depth > 0:  # what a block asks for: its inserts hold the answer
                continue
            if _said(entity, "invisible", 0):
                self.found.unseen[kind] += 1
            elif kind == "INSERT":
                for one in self._each(entity):
                    self._open(one, layer, around)
            else:
                self._take(entity, layer, place)

    def _each(self, insert: Any) -> Iterator[Any]:
        """An insert, or those that an array of it stands for."""
        if insert.mcount > MOST_ENTITIES:
            raise self.refuse(f"a block is inserted {format_count(insert.mcount)} times in an array")
        return iter(insert.multi_insert()) if insert.mcount > 1 else iter([insert])

    def _open(self, insert: Any, layer: str, around: _Around) -> None:
        """Take what stands in a block, where its insert puts it."""
        block = insert.block()
        if block is None or block.block is None or block.block.is_xref or block.block.is_xref_overlay:
            self.found.left_out["reference to another drawing, or to a block that is not there"] += 1
            return
        depth = around.depth + 1
        if depth > DEEPEST_BLOCK:
            raise self.refuse(f"blocks are nested deeper than {DEEPEST_BLOCK}, or hold themselves")

        self._check_count(self.looked_at + self._held(block, depth))
        try:
            own = np.array(list(insert.matrix44()), dtype=float).reshape(4, 4)
        except STUMBLES:
            own = np.array([np.nan])
        if not np.isfinite(own).all():
            raise self.refuse(
                f"the block {insert.dxf.name:.40} is inserted with a place, a turn or a scale that is none"
            )
        frozen = around.frozen or layer.lower() in self.frozen
        self._walk(block, _Around(layer, frozen, depth, own @ around.T))

    def _held(self, block: Any, depth: int) -> int:
        """Entities of a block, with those of the blocks in it each time that one is inserted; known before any of them
        is made. What is nested too deep, or in itself, is refused where it is opened."""
        if block.name not in self.held:
            self.held[block.name] = 0
            for entity in block:
                inside = entity.block() if entity.dxftype() == "INSERT" and depth < DEEPEST_BLOCK else None
                more = 0 if inside is None else max(entity.mcount, 1) * self._held(inside, depth + 1)
                self.held[block.name] += 1 + more
        return self.held[block.name]

    def _check_count(self, count: int) -> None:
        if count > MOST_ENTITIES:
            raise self.refuse(f"it holds more than {format_count(MOST_ENTITIES)} entities, blocks opened")

    def _take(self, entity: Any, layer: str, place: Place) -> None:
        kind = entity.dxftype()
        make = MAKERS.get(kind)
        try:
            made = None if make is None else make(entity, place, self)
        except RecursionError:  # a curve with a number that is none, or too large, is halved without end
            raise self.refuse(f"the {kind} on layer {layer:.40} has a point that is no number, or far away") from None
        except ToolpathError:
            raise
        except STUMBLES:
            made = None  # ezdxf's words for a curve that cannot be: too few points, a degree that does not fit
        if made is None:
            self.found.left_out[kind] += 1
            return
        self.take(layer, *made)


def _said(entity: Any, key: str, default: Any) -> Any:
    """What an entity says of itself; what ezdxf does not know says nothing."""
    return entity.dxf.get(key, default) if entity.dxf.is_supported(key) else default
