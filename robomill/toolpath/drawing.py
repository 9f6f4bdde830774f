"""A drawing as its lines, layer by layer, in {W}; and the cuts along them: on a line or beside it, in passes.

Lines that meet at their ends are one contour. A closed one runs counter-clockwise, so that left of it is inside; an
open one runs as it was drawn. Cuts become the shapes of a ``Sketch``: each pass is a shape of its own, a closed contour
is followed pass by pass without lifting, an open one there and back. The tool enters straight down at the plunge feed.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from robomill.arguments import asked, made_by
from robomill.arrays import FloatArray
from robomill.errors import ToolpathError
from robomill.provenance import Finding
from robomill.quantities import Quantity, choice, quantity, settle, told
from robomill.spelled import Replaceable, in_units, one_of
from robomill.toolpath.contour import Contour
from robomill.toolpath.parallel import beside_line
from robomill.toolpath.path import MOST_FEED, SLOWEST
from robomill.toolpath.sketch import DEEPEST, FASTEST, MAX_ELEMENTS, SHALLOWEST, Element, Sketch
from robomill.units import format_count, format_many, format_si
from robomill.values import Said, Value

SIDES = {
    "on": "on the line",
    "left": "left of the line",
    "right": "right of the line",
    "inside": "inside",
    "outside": "outside",
}
ORIGINS = {"drawing": "as drawn", "corner": "lower left corner", "centre": "middle"}
THINNEST = 0.05e-3  # m: no robot mills with less: was it meant in m?
DIAMETER = Quantity(
    "Diameter of the cutter", "mm", name="diameter", key="diameter_mm", above=0.0, slip=0.6, tiny=THINNEST
)


@in_units(ToolpathError, "Cut along a drawing")
@dataclass(frozen=True, repr=False)
class LayerCut(Replaceable, Said):
    """How the lines of a layer are cut.

    side        "on" the line, or beside it by the radius of the cutter: "left" or "right" as the line runs; of closed
                lines "inside" or "outside", with the line on the right of the tool (climb milling, spindle clockwise)
    depth       m below the top face
    step_down   m, the deepest pass; the passes are alike (None: one pass)
    v_f         m/s

    Examples
    --------
    >>> import robomill as rm
    >>> rm.LayerCut("slots", depth_mm=3, feed_mm_min=600, side="inside", step_down_mm=1).depths().round(6).tolist()
    [0.001, 0.002, 0.003]
    """

    layer: str
    depth: float = quantity("Depth", "mm", above=0.0, digits=2, slip=DEEPEST, tiny=SHALLOWEST)
    v_f: float = quantity("Feed", "mm/min", above=0.0, most=MOST_FEED, key="feed_mm_min", slip=FASTEST, tiny=SLOWEST)
    side: str = choice("Side", SIDES, default="on")
    step_down: float | None = quantity("Step down", "mm", optional=True, above=0.0, digits=2, slip=DEEPEST)

    if TYPE_CHECKING:

        def __init__(
            self,
            layer: str,
            depth: float = ...,
            v_f: float = ...,
            side: str = ...,
            step_down: float | None = ...,
            *,
            depth_mm: float = ...,
            feed_mm_min: float = ...,
            step_down_mm: float | None = ...,
        ) -> None: ...

    def _said(self) -> str:
        words = ", ".join(f"{name.lower()} {said}" for name, said in told(self) if name != "Side")
        return f"{self.layer}, {self.side}: {words}"

    def __post_init__(self) -> None:
        settle(self, ToolpathError, f"Layer {self.layer}")

    def depths(self) -> FloatArray:
        """(passes,) m below the top face, the last one ``depth``."""
        passes = 1 if self.step_down is None else max(1, math.ceil(self.depth / self.step_down - 1e-9))
        if passes > MAX_ELEMENTS:
            raise ToolpathError(
                f"Layer {self.layer}: a step of {format_si(self.step_down or 0.0, 'mm')} makes "
                f"{format_count(passes)} passes; "
                f"at most {format_count(MAX_ELEMENTS)} are cut, so step down farther."
            )
        return self.depth * np.arange(1, passes + 1) / passes


@made_by('rm.read_drawing("part.dxf")')
@dataclass(frozen=True, eq=False, repr=False)
class Drawing(Value):
    """The contours of a file, in {W}; ``read_drawing`` makes one.

    unit      in which the file's numbers were taken
    hidden    layers that the file has switched off
    findings  what was left out or supposed while it was read

    Examples
    --------
    >>> import robomill as rm
    >>> drawing = rm.read_drawing("bracket")
    >>> drawing.layers
    ('outline', 'slots', 'holes')
    """

    name: str
    contours: tuple[Contour, ...]
    unit: str = "mm"
    hidden: frozenset[str] = frozenset()
    findings: tuple[Finding, ...] = field(default=(), compare=False)

    @property
    def layers(self) -> tuple[str, ...]:
        """Names of the layers that hold a line, in the order of the file."""
        return tuple(dict.fromkeys(contour.layer for contour in self.contours))

    @property
    def extents(self) -> tuple[FloatArray, FloatArray]:
        """Lower left and upper right corner (2,) m of what a person sees: without hidden layers, unless all are."""
        shown = [contour for contour in self.contours if contour.layer not in self.hidden] or self.contours
        corners = np.vstack([contour.outline() for contour in shown])
        return corners.min(axis=0), corners.max(axis=0)

    @asked
    def of_layer(self, layer: str) -> tuple[Contour, ...]:
        """Its lines on a layer. Raises ToolpathError where there is no such layer."""
        found = tuple(contour for contour in self.contours if contour.layer == layer)
        if not found:
            known = ", ".join(self.layers)
            raise ToolpathError(f"{self.name}: there is no layer {layer!r:.60} with lines; it has {known:.200}.")
        return found

    @asked
    def moved(self, origin: Literal["drawing", "corner", "centre"] | str) -> "Drawing":
        """With the part zero where the drawing has it, in the lower left corner of its extents, or in their middle."""
        if origin not in ORIGINS:
            raise ToolpathError(f"Origin: found {origin!r:.40}, expected one of {', '.join(ORIGINS)}.", where="origin")
        if origin == "drawing":
            return self
        low, high = self.extents
        zero = low if origin == "corner" else 0.5 * (low + high)
        return replace(self, contours=tuple(replace(each, points=each.points - zero) for each in self.contours))

    @asked
    def sketch(
        self,
        cuts: Iterable[LayerCut],
        diameter: float | None = None,
        *,
        diameter_mm: float | None = None,
        sketch: Sketch | None = None,
    ) -> Sketch:
        """The cuts as the shapes of a sketch.

        Parameters
        ----------
        cuts : LayerCut
            Layer by layer, in the order in which they are cut.
        diameter, diameter_mm : float
            Of the cutter, in m or in mm; only cuts beside their line need it.
        sketch : Sketch
            Whose plunge feed, clearance and spindle speed are taken; those of a new one unless given.

        Raises
        ------
        ToolpathError
            For a layer that is not there, a line that crosses itself or has no inside, and a cutter that does not fit.

        Examples
        --------
        >>> import robomill as rm
        >>> cut = rm.LayerCut("slots", depth_mm=2, feed_mm_min=600, side="inside")
        >>> len(rm.read_drawing("bracket").sketch([cut], diameter_mm=6).elements)
        2
        """
        cuts = tuple(cuts)
        beside = any(cut.side != "on" for cut in cuts)
        given = one_of(DIAMETER, diameter, diameter_mm, ToolpathError, "Drawing", None if beside else 1e-3)
        across = float(DIAMETER.settled(given, ToolpathError, "Drawing"))
        elements = [each for cut in cuts for each in _passes(self.of_layer(cut.layer), cut, 0.5 * across)]
        return (sketch or Sketch()).replace(elements=tuple(elements))

    def _said(self) -> str:
        low, high = self.extents
        size = format_many(high - low, "mm", 2, between=" x ")
        return f"{self.name}: {format_count(len(self.contours), 'contour')} on {', '.join(self.layers):.100}, {size}"


def _passes(contours: Sequence[Contour], cut: LayerCut, radius: float) -> list[Element]:
    found, depths = [], cut.depths()
    for contour in contours:
        for line in (contour,) if cut.side == "on" else beside_line(contour, cut.side, radius):
            back = line if line.closed else _backwards(line)
            for k, depth in enumerate(depths):
                each = back if k % 2 else line
                found.append(Element(each.shape, each.points, float(depth), cut.v_f))
    return found


def _backwards(contour: Contour) -> Contour:
    """An open contour from its end to its start."""
    return replace(contour, points=contour.points[::-1])
