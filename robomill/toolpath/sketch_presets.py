"""Ready-made sketches about the part zero: the paper's lines of Fig. 8 and what every shop knows. SI units, {W}."""

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import ToolpathError
from robomill.toolpath.sketch import Element, Sketch
from robomill.toolpath.stroke_font import strokes
from robomill.units import from_si

# Half the sides of the plane of the paper's Fig. 8: X_M from -600 to 600 mm, Y_M from -1600 to -1000 mm.
FIG_8_HALF = (0.6, 0.3)

PRESETS: dict[str, str] = {
    "slot": "Slot",
    "fig_8": "Paper's lines, Fig. 8",
    "circle": "Circle",
    "pocket": "Rectangular pocket",
    "face": "Zig-zag face",
    "spiral": "Spiral",
    "word": "A word of text",
}


def preset(name: str, sketch: Sketch, diameter: float, word: str = "ROBOMILL") -> Sketch:
    """``sketch`` with the shapes of preset ``name`` instead of its own; ``diameter`` (m) is that of the cutter."""
    if name == "fig_8":
        shapes = fig_8_lines()
    elif name == "slot":
        shapes = [("line", np.array([[-0.05, 0.0], [0.05, 0.0]]))]
    elif name == "circle":
        shapes = [("circle", np.array([[0.0, 0.0], [0.03, 0.0]]))]
    elif name == "pocket":
        shapes = [("polyline", pocket(0.06, 0.04, diameter))]
    elif name == "face":
        shapes = [("polyline", zigzag(0.08, 0.05, 0.6 * diameter))]
    elif name == "spiral":
        shapes = [("polyline", spiral(0.03, 0.6 * diameter))]
    elif name == "word":
        shapes = [("polyline", stroke) for stroke in centred_word(word, 0.018)]
    else:
        raise ToolpathError(f"Sketch: there is no preset {name!r}; known are {', '.join(PRESETS)}.")
    return sketch.replace(elements=tuple(Element(s, p, sketch.depth, sketch.v_f) for s, p in shapes))  # type: ignore[arg-type]


def fig_8_lines() -> list[tuple[str, FloatArray]]:
    """Three lines along X_M and three along Y_M, on the borders and through the middle of the plane of Fig. 8.

    They lie where the paper has them when the part zero is in the middle of that plane, at X_M = 0, Y_M = -1300 mm.
    """
    a, b = FIG_8_HALF
    along_x = [np.array([[-a, y], [a, y]]) for y in (-b, 0.0, b)]
    along_y = [np.array([[x, -b], [x, b]]) for x in (-a, 0.0, a)]
    return [("line", points) for points in along_x + along_y]


def pocket(length: float, width: float, diameter: float, stepover: float = 0.6) -> FloatArray:
    """(q, 2) m: rings from the middle outwards; the outermost leaves a pocket ``length`` by ``width`` (m).

    Raises ToolpathError for a cutter that does not fit.
    """
    a, b = (length - diameter) / 2.0, (width - diameter) / 2.0
    if min(a, b) <= 0:
        raise ToolpathError(f"Pocket: a cutter of {from_si(diameter, 'mm'):g} mm does not fit; take a smaller one.")
    rings = int(np.ceil(min(a, b) / (stepover * diameter)))
    step = min(a, b) / rings
    u, v = a - min(a, b), b - min(a, b)
    # The innermost ring has no width: a line, or a point in a square pocket.
    corners = [[-u, -v], [u, v]] if u + v > 0 else [[0.0, 0.0]]
    for ring in range(rings - 1, -1, -1):
        u, v = a - ring * step, b - ring * step
        corners += [[u, v], [-u, v], [-u, -v], [u, -v], [u, v]]
    return np.array(corners)


def zigzag(length: float, width: float, stepover: float) -> FloatArray:
    """(q, 2) m: rows along x, there and back, no farther than ``stepover`` (m) apart."""
    rows = int(np.ceil(width / stepover - 1e-9)) + 1
    y = np.linspace(-width / 2.0, width / 2.0, rows)
    half = length / 2.0
    return np.array([[side * half, v] for row, v in enumerate(y) for side in ((-1, 1) if row % 2 == 0 else (1, -1))])


def spiral(radius: float, pitch: float, chord: float = 5e-6) -> FloatArray:
    """(q, 2) m: an Archimedean spiral out to ``radius`` (m), then a full circle; chords within ``chord`` (m)."""
    step = 2.0 * np.arccos(1.0 - chord / radius)
    angle = 2.0 * np.pi * radius / pitch
    phi = np.linspace(0.0, angle, int(np.ceil(angle / step)) + 1)
    phi = np.append(phi, angle + np.linspace(0.0, 2.0 * np.pi, int(np.ceil(2.0 * np.pi / step)) + 1)[1:])
    r = np.minimum(pitch * phi / (2.0 * np.pi), radius)
    return np.column_stack([r * np.cos(phi), r * np.sin(phi)])


def centred_word(text: str, height: float) -> list[FloatArray]:
    """Strokes (r, 2) m of ``text`` with the part zero in its middle. Raises ToolpathError for an empty word."""
    if not text.strip():
        raise ToolpathError("Text: the word is empty; type at least one letter.")
    found, width = strokes(text.strip(), height)
    return [stroke - [width / 2.0, height / 2.0] for stroke in found]
