"""What the clipping paths of an SVG page leave to see of its lines (CSS Masking 1, chapters 5 to 7).

Lines are not cut where they are clipped: what is hidden wholly is left out, and what is hidden in part is told.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import reduce
from typing import Any
from xml.etree import ElementTree

from robomill.arrays import FloatArray
from robomill.extras import needed
from robomill.io.drawing.svg_styles import held
from robomill.toolpath.sketch import Shape, outline

CLIP, REGION = "robomill-clip", "robomill-region"
UNKNOWN = "?"  # what hides, where that is a mask, or a shape of CSS
EDGE = 1e-5  # m, to which a line is drawn beside an edge
_URL = re.compile(r"\s*url\(\s*['\"]?#([^'\")]+)['\"]?\s*\)\s*")


def mark(element: ElementTree.Element) -> None:
    """Name at an element the clipping path that holds for it, by its id, before its attributes are thinned out."""
    clip = held(element, "clip-path")
    named = _URL.fullmatch(clip)
    if held(element, "mask") not in ("none", ""):
        element.set(CLIP, UNKNOWN)
    elif clip not in ("none", ""):
        element.set(CLIP, named[1] if named else UNKNOWN)


def clipper(element: ElementTree.Element, known: Mapping[str, ElementTree.Element]) -> ElementTree.Element | None:
    """The clipping path of an element, in the coordinates of the element; None where it is not one that is followed."""
    found = known.get(element.get(CLIP, ""))
    if found is None or not found.tag.endswith("clipPath"):
        return None
    moved = {element.get(key, "0").strip() for key in ("x", "y")} - {"0"} if element.tag.endswith("use") else None
    odd = any(CLIP in each.attrib or str(each.tag).endswith("text") for each in found.iter())
    by_page = found.get("clipPathUnits", "userSpaceOnUse") == "userSpaceOnUse"
    return found if by_page and not odd and not moved else None


class Clips:
    """The regions of a page that its clipping paths leave to see, by the number that ``Viewports`` gave them."""

    def __init__(self) -> None:
        self._parts: dict[str, list[Any]] = {}
        self._regions: dict[str, Any] = {}

    def open(self, number: str) -> None:
        """A region begins; with nothing in it nothing is seen."""
        self._parts[number] = []

    def add(self, number: str, rings: Iterable[FloatArray], evenodd: bool) -> None:
        """Add what the rings (r, 2) m of one shape have in them."""
        with needed("An SVG drawing"):
            from shapely import LinearRing, Polygon, make_valid, symmetric_difference, union_all

        ways: tuple[list[Any], list[Any]] = [], []
        for ring in rings:
            if len(ring) >= 4:
                ways[LinearRing(ring).is_ccw].append(make_valid(Polygon(ring)))
        if evenodd:
            self._parts[number].append(reduce(symmetric_difference, (*ways[0], *ways[1]), Polygon()))
        else:  # what is gone around once in each way is outside
            self._parts[number].append(symmetric_difference(*map(union_all, ways)))

    def seen(self, numbers: Sequence[str], shape: Shape, points: FloatArray) -> bool | None:
        """Whether a line, ``points`` (r, 2) m, is seen through all the regions of these numbers: all of it, nothing
        (False), or some of it, as far as is known (None)."""
        known = [self._region(number) for number in numbers if number in self._parts]
        if not known:
            return None if numbers else True
        from shapely import LineString

        line = LineString(outline(shape, points))
        if not all(region.intersects(line) for region in known):
            return False
        return (len(known) == len(numbers) and all(region.covers(line) for region in known)) or None

    def _region(self, number: str) -> Any:
        """The region of a number that has been opened, once it is whole."""
        with needed("An SVG drawing"):
            from shapely import prepare, union_all

        if number not in self._regions:
            self._regions[number] = union_all(self._parts[number]).buffer(EDGE)
            prepare(self._regions[number])
        return self._regions[number]
