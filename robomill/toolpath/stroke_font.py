"""Letters as single strokes, for engraving: drawn for robomill on a grid 4 wide and 6 high, so free of other licences.

A glyph is a list of strokes, a stroke a list of grid points written "xy"; "04 00" goes from (0, 4) to (0, 0).
"""

import numpy as np

from robomill.arrays import FloatArray
from robomill.errors import ToolpathError

HEIGHT = 6.0
GAP = 2.0

GLYPHS: dict[str, tuple[str, ...]] = {
    " ": (),
    "A": ("00 26 40", "12 32"),
    "B": ("00 06 36 45 44 33 42 41 30 00", "03 33"),
    "C": ("45 36 16 05 01 10 30 41",),
    "D": ("00 06 26 44 42 20 00",),
    "E": ("46 06 00 40", "03 33"),
    "F": ("46 06 00", "03 33"),
    "G": ("45 36 16 05 01 10 30 41 43 23",),
    "H": ("06 00", "46 40", "03 43"),
    "I": ("06 26", "26 20", "00 20"),
    "J": ("16 46", "36 31 20 10 01"),
    "K": ("06 00", "46 03 40"),
    "L": ("06 00 40",),
    "M": ("00 06 23 46 40",),
    "N": ("00 06 40 46",),
    "O": ("16 36 45 41 30 10 01 05 16",),
    "P": ("00 06 36 45 44 33 03",),
    "Q": ("16 36 45 41 30 10 01 05 16", "22 40"),
    "R": ("00 06 36 45 44 33 03", "23 40"),
    "S": ("45 36 16 05 04 13 33 42 41 30 10 01",),
    "T": ("06 46", "26 20"),
    "U": ("06 01 10 30 41 46",),
    "V": ("06 20 46",),
    "W": ("06 10 23 30 46",),
    "X": ("06 40", "46 00"),
    "Y": ("06 23 46", "23 20"),
    "Z": ("06 46 00 40",),
    "Ä": ("00 24 40", "12 32", "16 17", "36 37"),
    "Ö": ("14 34 43 41 30 10 01 03 14", "16 17", "36 37"),
    "Ü": ("05 01 10 30 41 45", "16 17", "36 37"),
    "0": ("16 36 45 41 30 10 01 05 16", "01 45"),
    "1": ("15 26 20", "10 30"),
    "2": ("05 16 36 45 44 00 40",),
    "3": ("05 16 36 45 44 33 42 41 30 10 01", "13 33"),
    "4": ("30 36 02 42",),
    "5": ("46 06 03 33 42 41 30 10 01",),
    "6": ("45 36 16 05 01 10 30 41 42 33 03",),
    "7": ("06 46 20",),
    "8": ("13 04 05 16 36 45 44 33 13 02 01 10 30 41 42 33",),
    "9": ("01 10 30 41 45 36 16 05 04 13 43",),
    "-": ("13 33",),
    "+": ("13 33", "24 22"),
    "=": ("14 34", "12 32"),
    "/": ("00 46",),
    ".": ("10 20",),
    ",": ("21 10",),
    ":": ("11 21", "14 24"),
    "!": ("26 22", "20 21"),
    "?": ("05 16 36 45 44 23 22", "20 21"),
    "'": ("26 25",),
    "_": ("00 40",),
    "(": ("36 25 21 30",),
    ")": ("16 25 21 10",),
    "*": ("15 31", "35 11", "03 43"),
    "°": ("16 26 25 15 16",),
}


def strokes(text: str, height: float) -> tuple[list[FloatArray], float]:
    """Strokes (r, 2) m of one line of ``text`` from (0, 0) to the right, letters ``height`` m high, and its width.

    Small letters are written as capitals. Raises ToolpathError naming a sign that has no strokes.
    """
    scale = height / HEIGHT
    found: list[FloatArray] = []
    x = right = 0.0
    for sign in text:
        glyph = GLYPHS.get(sign.upper() if sign.upper() in GLYPHS else sign)
        if glyph is None:
            raise ToolpathError(
                f"Text: there are no strokes for {sign!r}; letters, figures and {' '.join(_SIGNS)} can be cut."
            )
        reach = 2.0
        for stroke in glyph:
            corners = np.array([[float(node[0]), float(node[1])] for node in stroke.split()])
            reach = max(reach, float(corners[:, 0].max()))
            found.append((corners + np.array([x, 0.0])) * scale)
            right = max(right, x + float(corners[:, 0].max()))
        x += reach + GAP
    return found, right * scale


_SIGNS = [sign for sign in GLYPHS if not sign.isalnum() and sign != " "]
