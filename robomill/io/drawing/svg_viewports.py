"""Viewports inside of an SVG page: ``<use>``, ``<symbol>`` and nested ``<svg>`` written out as groups with a transform.

As SVG 2 has it in 5.5 (use), 5.6 (symbol) and 8.2 (the view box). What says where a shape is holds for that shape
alone: none of it is handed down to what is inside of a group, and what is not given is 0.
"""

import math
import re
from collections.abc import Mapping
from xml.etree import ElementTree

from robomill.errors import ToolpathError
from robomill.io.drawing.reading import metres
from robomill.io.drawing.svg_clips import CLIP, REGION, clipper

SVG, XLINK = "{http://www.w3.org/2000/svg}", "{http://www.w3.org/1999/xlink}href"
ABSOLUTE = {"mm": "mm", "cm": "cm", "in": "in", "pt": "pt", "pc": "pt", "q": "mm"}  # and what of it people know
TIMES = {"pc": 12.0, "q": 0.25}
NOT_DRAWN = ("symbol", "marker", "mask", "clipPath", "pattern")  # unless something uses them
NUMBER = re.compile(r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?")
SIZE = re.compile(rf"\s*({NUMBER.pattern})\s*([A-Za-z%]*)\s*")
_SHAPES = {
    "rect": ("x", "y", "width", "height"),
    "circle": ("cx", "cy", "r"),
    "ellipse": ("cx", "cy"),
    "line": ("x1", "y1", "x2", "y2"),
    "polyline": (),
    "polygon": (),
    "path": (),
}
_ACROSS, _DOWN = ("x", "cx", "x1", "x2", "width", "rx"), ("y", "cy", "y1", "y2", "height", "ry")
_PLACES = frozenset((*_ACROSS, *_DOWN, "r"))
_VIEW = ("viewBox", "preserveAspectRatio")
View = tuple[float, float]
"""Width and height that 100 % is of."""


def kind_of(element: ElementTree.Element) -> str:
    """The name of an element; "" for one that is not of SVG."""
    return element.tag.removeprefix(SVG) if isinstance(element.tag, str) else ""


def target_of(use: ElementTree.Element, known: Mapping[str, ElementTree.Element]) -> ElementTree.Element | None:
    """The element of the same file that a ``<use>`` names."""
    named = use.get("href", use.get(XLINK, "")).strip()
    return known.get(named[1:]) if named.startswith("#") else None


def box_of(element: ElementTree.Element) -> tuple[float, ...]:
    """x, y, width and height of the view box; () where there is none to go by."""
    box = tuple(float(each) for each in NUMBER.findall(element.get("viewBox", "")))
    return box if len(box) == 4 and min(box[2:]) > 0.0 and all(map(math.isfinite, box)) else ()


class Viewports:
    """Writes out the viewports of a page called ``name``, whose elements ``known`` are found by their id."""

    def __init__(self, name: str, known: Mapping[str, ElementTree.Element]) -> None:
        self.name, self.known, self.clips = name, known, 0

    def written_out(self, root: ElementTree.Element) -> ElementTree.Element:
        """The page without ``<use>``, ``<symbol>`` and ``<svg>`` inside of it; raises ToolpathError."""
        kept = {"width", "height", *_VIEW}
        page = ElementTree.Element(root.tag, {k: v for k, v in root.attrib.items() if k in kept or k not in _PLACES})
        box = box_of(root)
        whole = box[2:] or [self._length(root.get(key, "1000"), 1000.0) for key in ("width", "height")]
        page.extend([self._written(child, (whole[0], whole[1])) for child in root])
        return page

    def _written(self, element: ElementTree.Element, view: View) -> ElementTree.Element:
        written = self._unclipped(element, view)
        if written.attrib.pop(CLIP, None) is None:
            return written
        self.clips += 1
        group = ElementTree.Element(f"{SVG}g")
        if (clip := clipper(element, self.known)) is not None:
            placed = ElementTree.SubElement(group, f"{SVG}g", {"transform": element.get("transform", "")})
            region = ElementTree.SubElement(placed, f"{SVG}g", {**clip.attrib, REGION: str(self.clips)})
            region.extend([self._written(child, view) for child in clip])
        written.set(f"{CLIP}-{self.clips}", "")
        group.append(written)
        return group

    def _unclipped(self, element: ElementTree.Element, view: View) -> ElementTree.Element:
        kind = kind_of(element)
        if kind in ("defs", *NOT_DRAWN):
            put_away = ElementTree.Element(f"{SVG}defs")
            put_away.extend([each for each in element.iter() if kind_of(each) == "style"])
            return put_away
        if kind == "use":
            return self._used(element, view)
        if kind == "svg":
            return self._viewport(element, view, element.attrib)
        written = ElementTree.Element(element.tag, self._own(element, kind, view))
        written.text = element.text
        written.extend([self._written(child, view) for child in element])
        return written

    def _own(self, element: ElementTree.Element, kind: str, view: View) -> dict[str, str]:
        """The attributes that an element has a use for, percentages reckoned out."""
        own = dict.fromkeys(_SHAPES.get(kind, ()), "0")
        own.update({"path": {"d": ""}, "polyline": {"points": ""}, "polygon": {"points": ""}}.get(kind, {}))
        for key, value in element.attrib.items():
            if key not in _PLACES:
                own[key] = value
            elif kind in _SHAPES and value.strip() != "auto":
                own[key] = self._share(key, value, view)
        if kind == "ellipse" and "r" not in own:
            own["rx"], own["ry"] = own.get("rx", own.get("ry", "0")), own.get("ry", own.get("rx", "0"))
        if "%" in own.get("style", ""):
            parts = (each.partition(":") for each in own["style"].split(";"))
            own["style"] = ";".join(f"{key}:{self._share(key.strip(), value, view)}" for key, _, value in parts if key)
        return own

    def _share(self, key: str, value: str, view: View) -> str:
        """A length as it is, or what its percentage is of the viewport."""
        if key not in _PLACES or not value.strip().endswith("%"):
            return value
        across, down = view
        whole = across if key in _ACROSS else down if key in _DOWN else math.sqrt(0.5 * (across**2 + down**2))
        return repr(self._length(value, whole))

    def _used(self, element: ElementTree.Element, view: View) -> ElementTree.Element:
        group = ElementTree.Element(f"{SVG}use", self._own(element, "use", view))
        for key in ("href", XLINK, *_VIEW):
            group.attrib.pop(key, None)
        x, y = self._length(element.get("x", "0"), view[0]), self._length(element.get("y", "0"), view[1])
        group.set("transform", f"{element.get('transform', '')} translate({x!r} {y!r})".strip())
        target = target_of(element, self.known)
        if target is not None and kind_of(target) in ("symbol", "svg"):
            group.append(self._viewport(target, view, {**target.attrib, **element.attrib}))
        elif target is not None:
            group.append(self._written(target, view))
        return group

    def _viewport(self, element: ElementTree.Element, view: View, sizes: Mapping[str, str]) -> ElementTree.Element:
        """A nested ``<svg>``, or a ``<symbol>`` that is used, with the width and height of ``sizes``."""
        own = self._own(element, "svg", view)
        for key in _VIEW:
            own.pop(key, None)
        if kind_of(element) == "symbol":  # drawn whatever it says of itself, as SVG 2 has it
            own.pop("display", None)
            own["style"] = ";".join(
                s for s in own.get("style", "").split(";") if s.partition(":")[0].strip() != "display"
            )
        x, y = self._length(element.get("x", "0"), view[0]), self._length(element.get("y", "0"), view[1])
        width, height = (
            self._length("100%" if (size := sizes.get(key, "auto")).strip() == "auto" else size, whole)
            for key, whole in zip(("width", "height"), view)
        )
        box = box_of(element)
        placed = _matrix((x, y, width, height), box, element.get("preserveAspectRatio", "")) if box else ""
        own["transform"] = f"{own.get('transform', '')} {placed or f'translate({x!r} {y!r})'}".strip()
        group = ElementTree.Element(f"{SVG}symbol", own)
        if width > 0.0 and height > 0.0:
            inside = (box[2], box[3]) if box else (width, height)
            group.extend([self._written(child, inside) for child in element])
        return group

    def _length(self, text: str, whole: float) -> float:
        """A length in pixels; ``whole`` is 100 %."""
        read = SIZE.fullmatch(text)
        unit = read[2].lower() if read else "?"
        if read is None or unit not in ("", "px", "%", *ABSOLUTE):
            raise ToolpathError(
                f"{self.name}: found {text[:20]!r} where a length should be; expected a number, px, mm, in or %: "
                "save it with lengths in one of these."
            )
        return float(read[1]) * (whole / 100.0 if unit == "%" else pixels(unit))


def pixels(unit: str) -> float:
    """A unit of length in pixels; 1 for one that is none."""
    return TIMES.get(unit, 1.0) * metres(ABSOLUTE[unit]) / metres("px") if unit in ABSOLUTE else 1.0


def _matrix(port: tuple[float, float, float, float], box: tuple[float, ...], aspect: str) -> str:
    """The transform that shows the view box in the viewport ``port`` (x, y, width, height), both in pixels."""
    words = [word for word in aspect.split() if word != "defer"]
    align = words[0] if words else "xMidYMid"
    scales = [port[2] / box[2], port[3] / box[3]]
    if align != "none":
        scales = [max(scales) if "slice" in words else min(scales)] * 2
    where = {"Min": 0.0, "Max": 1.0}
    shares = [0.0, 0.0] if align == "none" else [where.get(align[1:4], 0.5), where.get(align[5:8], 0.5)]
    shift = [port[k] + (port[2 + k] - box[2 + k] * scales[k]) * shares[k] - box[k] * scales[k] for k in (0, 1)]
    return f"matrix({scales[0]!r} 0 0 {scales[1]!r} {shift[0]!r} {shift[1]!r})"
