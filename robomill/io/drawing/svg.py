"""SVG drawings as lines by layer: read by svgelements, after a look of our own at what an untrusted file may hold.

Layers are those of Inkscape, else the groups of the page. Y points up from the lower edge of the page, X from its left.
"""

import io
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from xml.etree import ElementTree

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import ToolpathError
from robomill.extras import needed
from robomill.io.drawing.reading import PER_INCH, STUMBLES, Read, Reading, metres
from robomill.io.drawing.svg_clips import CLIP, REGION, Clips, clipper, mark
from robomill.io.drawing.svg_styles import STYLED, held, write_in
from robomill.io.drawing.svg_viewports import (
    ABSOLUTE,
    NOT_DRAWN,
    NUMBER,
    SIZE,
    SVG,
    XLINK,
    Viewports,
    box_of,
    kind_of,
    pixels,
    target_of,
)
from robomill.toolpath.sketch import Shape, outline
from robomill.units import format_count

DEEPEST = 200  # elements in elements, twice as many where some are used by others
MOST_TAGS = 100_000  # beginnings, ends and comments of elements
MOST_ELEMENTS, OF_ONE = 20_000, 50  # drawn, each time they are used; so many characters of a path count as one,
STRETCHES = 5  # and so many lines and curves of it
MOST_PLACED, MOST_TRANSFORM = 20_000_000, 1_000  # characters: of all transforms, one in another; of any attribute
INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
LAYER, NO_LAYER = "robomill-layer", "drawing"
PLACED = 60  # characters of the transform that a viewport or a use comes to
WORDS = ("text", "image", "foreignObject")
KEPT = STYLED | {"style", "class", "id", "href", XLINK, LAYER, CLIP, "clipPathUnits"}
LONG = {"d", "points", "style"}  # attributes that may be
COMMANDS = "MLTHVCSQAZmlthvcsqaz"
NO_PATH = re.compile(rf"[^{COMMANDS}eE\d\s,.+-]")


class Svg:
    """An SVG document; ``unit`` is that of the size of its page, "" where that is in pixels, or nowhere."""

    unsaid = "does not say its unit"

    def __init__(self, data: bytes, name: str) -> None:
        with needed("An SVG drawing"):
            import svgelements  # noqa: F401 (before anything is read)
        self.name, self.left_out, self.unseen = name, Counter[str](), Counter[str]()
        self.root = self._parsed(_text_of(data, name))
        self._look()
        self.unit = self._sized()

    def _parsed(self, text: str) -> ElementTree.Element:
        if re.search(r"<!\s*ENTITY", text):
            raise ToolpathError(
                f"{self.name}: it declares entities (<!ENTITY), which no plain drawing needs; save it as plain SVG."
            )
        if text.count("<") > MOST_TAGS:
            raise self._too_many()
        try:
            root = ElementTree.fromstring(text)
        except ElementTree.ParseError as exc:
            raise ToolpathError(
                f"{self.name}: this is no SVG file, or one that is damaged or cut off ({exc}); export it again as SVG."
            ) from None
        level, self.depth = [root], 0
        while level:
            if self.depth == DEEPEST:
                raise self._refuse(f"its elements are nested deeper than {DEEPEST}")
            level = [child for element in level for child in element]
            self.depth += 1
        if root.tag not in ("svg", f"{SVG}svg"):
            raise ToolpathError(f"{self.name}: the file holds <{root.tag:.60}>, expected <svg>; export it as SVG.")
        return root

    def _refuse(self, why: str) -> ToolpathError:
        return Reading(self.name).refuse(why)

    def _too_many(self) -> ToolpathError:
        return self._refuse(f"it holds more than {format_count(MOST_ELEMENTS)} elements, each as often as it is used")

    # ---- a look at everything before it is drawn -------------------------------------------------------------------
    def _look(self) -> None:
        """Names layers, puts away what is drawn only where it is used, and counts what all uses come to."""
        write_in(self.root, self.depth, self._refuse)
        self.known = known = {e.attrib["id"]: e for e in self.root.iter() if "id" in e.attrib}
        for parent in list(self.root.iter()):
            drawn = _switched(parent) if kind_of(parent) == "switch" else None
            for place, child in enumerate(parent):
                if drawn not in (None, place):
                    _put_away(parent, place)
                    continue
                self._look_at(parent, place, child)
        for element in self.root.iter():
            mark(element)
            for key in [key for key in element.attrib if key not in KEPT]:
                del element.attrib[key]
            for key in element.attrib.keys() - LONG:
                if len(element.attrib[key]) > MOST_TRANSFORM:
                    raise self._refuse(
                        f"the {key:.20} of an element has more than {format_count(MOST_TRANSFORM)} characters"
                    )
            if "href" in element.attrib:  # of two it is the one that holds
                element.attrib.pop(XLINK, None)
            self._reduce(element)
            if kind_of(element) != "symbol" and held(element, "display") == "none":
                self.unseen[kind_of(element)] += 1
        _, turned = self._count_of(self.root, known, {}, set())
        if turned > MOST_PLACED:
            raise self._refuse("its transforms, one in another, are too long")

    def _reduce(self, element: ElementTree.Element) -> None:
        """Leave of words and attributes what says where a line is, and whether it is drawn."""
        element.text = None
        if element.get("visibility") == "inherit":
            del element.attrib["visibility"]
        odd = NO_PATH.search(element.get("d", "")) if kind_of(element) == "path" else None
        if odd and element.attrib["d"].strip() != "none":
            raise ToolpathError(
                f'{self.name}: the path d="{element.attrib["d"]:.40}" has {odd[0]!r}, which is no command of a path; '
                "export it again as SVG."
            )
        if "class" in element.attrib:
            element.set("class", " ".join(dict.fromkeys(element.attrib["class"].split())))

    def _look_at(self, parent: ElementTree.Element, place: int, child: ElementTree.Element) -> None:
        kind = kind_of(child)
        if kind == "g" and (parent is self.root or child.get(f"{INKSCAPE}groupmode") == "layer"):
            label = child.get(f"{INKSCAPE}label") or child.get("id")
            if label:
                child.set(LAYER, label[:200])
        if kind in NOT_DRAWN and kind_of(parent) != "defs":
            _put_away(parent, place)
        if kind in WORDS:
            self.left_out[kind] += 1

    def _count_of(
        self,
        element: ElementTree.Element,
        known: dict[str, ElementTree.Element],
        counted: dict[ElementTree.Element, tuple[int, int]],
        around: set[ElementTree.Element],
    ) -> tuple[int, int]:
        """Elements that it comes to with all that it uses, and characters of the transforms around all of them.

        Raises ToolpathError for too many, and for a circle.
        """
        if element in around or len(around) > 2 * DEEPEST:
            raise self._refuse("an element uses itself (<use>), or others do deeper than can be followed")
        if element not in counted:
            around.add(element)
            inside = list(element)
            kind = kind_of(element)
            if kind == "use" and (target := target_of(element, known)) is not None:
                inside.append(target)
            if (clip := clipper(element, known)) is not None:
                inside.append(clip)
            if kind == "use" and not element.get("href", element.get(XLINK, "")).strip().startswith("#"):
                self.left_out["use of another file"] += 1
            count, turned = 1 + _weight(element), 0
            for each in inside:
                of_each = self._count_of(each, known, counted, around)
                count, turned = count + of_each[0], turned + of_each[1]
            if count > MOST_ELEMENTS:
                raise self._too_many()
            placed = PLACED if kind in ("use", "symbol", "svg") else 0
            counted[element] = count, turned + count * (placed + len(element.get("transform", "")))
            around.discard(element)
        return counted[element]

    def _sized(self) -> str:
        """Whether the page has a size in a unit of length; one of the two follows from the other by the view box."""
        sizes = {key: SIZE.fullmatch(self.root.get(key, "")) for key in ("width", "height")}
        box = box_of(self.root)
        good = {key: m for key, m in sizes.items() if m and m[2] != "%" and float(m[1]) > 0.0}
        if box and len(good) == 1:
            (key, m), ratio = *good.items(), box[3] / box[2]
            other, times = ("height", ratio) if key == "width" else ("width", 1.0 / ratio)
            self.root.set(other, f"{float(m[1]) * times!r}{m[2]}")
        elif len(good) < 2:
            for key in sizes:
                self.root.attrib.pop(key, None)
        said = [unit for m in good.values() if (unit := m[2].lower()) in ABSOLUTE]
        for key in sizes:  # in pixels, to the last digit
            read = SIZE.fullmatch(self.root.get(key, ""))
            if read and (unit := read[2].lower()) in ABSOLUTE:
                self.root.set(key, repr(float(read[1]) * pixels(unit)))
        return ABSOLUTE[said[0]] if said else ""  # one that says it fixes the other, whose pixels are 1/96 in

    def scale(self, unit: str) -> float:
        """m: a pixel, which is a ``unit`` where the page does not say how large it is. Raises ToolpathError."""
        if self.unit and unit != self.unit:
            raise ToolpathError(
                f"{self.name}: the page says its size in {self.unit}, which fixes every length; leave the unit out.",
                where="unit",
            )
        return metres("px" if self.unit else unit)

    # ---- the lines -------------------------------------------------------------------------------------------------
    def read(self, scale: float) -> Read:
        """Its lines, with ``scale`` (m) for a pixel."""
        import svgelements

        from robomill.io.drawing.svg_paths import broken_in, lines_of

        reading = Reading(self.name)
        reading.found.left_out.update(self.left_out)
        reading.found.unseen.update(self.unseen)
        try:
            written = ElementTree.tostring(Viewports(self.name, self.known).written_out(self.root), encoding="unicode")
            page = svgelements.SVG.parse(io.StringIO(written), ppi=PER_INCH["px"], on_error="raise")
            if page is None:  # all of it is not displayed
                return reading.found
            height = float(page.height) if page.viewbox is not None or "height" in self.root.attrib else 0.0
            clips, zero = Clips(), np.array([0.0, height * scale])
            for element in page.elements():
                if REGION in getattr(element, "values", {}).get("attributes", {}):
                    clips.open(element.values[REGION])
                if isinstance(element, svgelements.Shape):
                    found = lines_of(abs(svgelements.Path(element)), scale, reading)
                    lines = ((shape, line * [1.0, -1.0] + zero) for shape, line in found)
                    _take(lines, _named(element), element.values, clips, reading)
        except ToolpathError:
            raise
        except (*STUMBLES, RecursionError) as exc:
            # svgelements has no error of its own: what a broken path or transform makes it stumble over.
            said = (
                broken_in(self.root)
                or f"a path or a transform in it cannot be read ({type(exc).__name__}: {exc!s:.80})"
            )
            raise ToolpathError(f"{self.name}: {said}; export it again as SVG.") from None
        return reading.found


def _named(shape: object) -> str:
    return type(shape).__name__.lower().removeprefix("simple")


def _take(
    lines: Iterator[tuple[Shape, FloatArray]], kind: str, said: Mapping[str, object], clips: Clips, reading: Reading
) -> None:
    """Take the lines (m) of one element of that ``kind``, of which so much is ``said``, as far as it is seen; or what
    they leave to see of others."""
    visible = str(said.get("visibility", "")).strip() not in ("hidden", "collapse")
    if REGION in said:
        if visible:
            evenodd = said.get("clip-rule") == "evenodd"
            clips.add(str(said[REGION]), [outline(*line) for line in lines], evenodd)
        return
    if not visible:
        reading.found.unseen[kind] += 1
        return
    numbers = [key.removeprefix(f"{CLIP}-") for key in said if key.startswith(f"{CLIP}-")]
    for shape, points in lines:
        seen = clips.seen(numbers, shape, points)
        if seen is False:
            reading.found.unseen["clipped line"] += 1
            continue
        if seen is None:
            reading.found.partly[kind] += 1
        reading.take(str(said.get(LAYER, NO_LAYER)), shape, points)


def _put_away(parent: ElementTree.Element, place: int) -> None:
    """Draw a child only where something uses it."""
    put_away = ElementTree.Element(f"{SVG}defs")
    put_away.append(parent[place])
    parent[place] = put_away


def _switched(switch: ElementTree.Element) -> int:
    """Which child of a ``<switch>`` is drawn: the first that asks for nothing that is not here."""
    for place, child in enumerate(switch):
        languages = child.get("systemLanguage", "en").replace(",", " ").split()
        plain = isinstance(child.tag, str) and child.get("requiredExtensions") is None
        if plain and kind_of(child) != "foreignObject" and any(each.lower()[:2] == "en" for each in languages):
            return place
    return 0


def _weight(element: ElementTree.Element) -> int:
    """How many elements more one counts as, of whose path or style there is much."""
    d, points = element.get("d", ""), element.get("points", "")
    weight = (len(d) + len(points) + len(element.get("style", ""))) // OF_ONE
    if weight > MOST_ELEMENTS:
        return weight
    stretches = max(sum(map(d.count, COMMANDS)), len(NUMBER.findall(d + points)) // 2)
    return max(weight, stretches // STRETCHES)


def _text_of(data: bytes, name: str) -> str:
    """The text without its declaration: what is looked at is what is parsed, whatever encoding it names."""
    try:
        text = data.decode("utf-16" if data.startswith((b"\xff\xfe", b"\xfe\xff")) else "utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    if "\0" in text:
        raise ToolpathError(f"{name}: this is a binary file; expected an SVG drawing in text.")
    return re.sub(r"^\s*<\?xml[^>]*\?>", "", text)
