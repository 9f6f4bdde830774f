"""Draws the bracket of this folder as DXF and as SVG. Run from the project's folder: ``python samples/drawings/generate.py``.

A plate of 120 x 80 mm with corners of 10 mm, two slots of 50 x 10 mm (a polyline with bulges; two lines and two arcs),
and two holes of 12 mm. The part zero is its lower left corner.
"""

from __future__ import annotations

import io
from pathlib import Path

import ezdxf
from ezdxf import units

HERE = Path(__file__).parent
ezdxf.options.write_fixed_meta_data_for_testing = True  # the same file every time
LENGTH, WIDTH, CORNER = 120.0, 80.0, 10.0
SLOT, HALF = 50.0, 5.0  # from end to end, and half the width
SLOTS = ((35.0, 25.0), (35.0, 55.0))  # left ends of the straight sides are HALF from here
HOLES, RADIUS = ((15.0, 40.0), (105.0, 40.0)), 6.0
QUARTER = 0.41421356237309503  # tan(90 deg / 4)


def dxf() -> str:
    doc = ezdxf.new("R2000")
    doc.units = units.MM
    space = doc.modelspace()
    for name in ("outline", "slots", "holes", "notes"):
        doc.layers.add(name)
    a, b, r = LENGTH, WIDTH, CORNER
    corners = [(r, 0, 0), (a - r, 0, QUARTER), (a, r, 0), (a, b - r, QUARTER), (a - r, b, 0), (r, b, QUARTER)]
    corners += [(0, b - r, 0), (0, r, QUARTER)]
    space.add_lwpolyline(corners, format="xyb", close=True, dxfattribs={"layer": "outline"})
    (x, y), (u, v) = SLOTS
    x0, x1 = x + HALF, x + SLOT - HALF
    one = [(x0, y - HALF, 0), (x1, y - HALF, 1), (x1, y + HALF, 0), (x0, y + HALF, 1)]
    space.add_lwpolyline(one, format="xyb", close=True, dxfattribs={"layer": "slots"})
    u0, u1, at = u + HALF, u + SLOT - HALF, {"layer": "slots"}
    space.add_line((u0, v - HALF), (u1, v - HALF), dxfattribs=at)
    space.add_arc((u1, v), HALF, -90.0, 90.0, dxfattribs=at)
    space.add_line((u0, v + HALF), (u1, v + HALF), dxfattribs=at)
    space.add_arc((u0, v), HALF, 90.0, 270.0, dxfattribs=at)
    hole = doc.blocks.new("HOLE")
    hole.add_circle((0.0, 0.0), RADIUS)
    for centre in HOLES:
        space.add_blockref("HOLE", centre, dxfattribs={"layer": "holes"})
    space.add_text("bracket, 10 mm", height=4.0, dxfattribs={"layer": "notes"}).set_placement((40.0, 38.0))
    out = io.StringIO()
    doc.write(out)
    return out.getvalue()


def svg() -> str:
    def slot(at: tuple[float, float]) -> str:
        x, y = at
        return f'    <rect x="{x:g}" y="{WIDTH - y - HALF:g}" width="{SLOT:g}" height="{2 * HALF:g}" rx="{HALF:g}"/>'

    def hole(at: tuple[float, float]) -> str:
        return f'    <circle cx="{at[0]:g}" cy="{WIDTH - at[1]:g}" r="{RADIUS:g}"/>'

    layer = '  <g inkscape:groupmode="layer" inkscape:label="{}" fill="none" stroke="black" stroke-width="0.2">'
    lines = [
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"',
        f'     width="{LENGTH:g}mm" height="{WIDTH:g}mm" viewBox="0 0 {LENGTH:g} {WIDTH:g}">',
        layer.format("outline"),
        f'    <rect width="{LENGTH:g}" height="{WIDTH:g}" rx="{CORNER:g}"/>',
        "  </g>",
        layer.format("slots"),
        *map(slot, SLOTS),
        "  </g>",
        layer.format("holes"),
        *map(hole, HOLES),
        "  </g>",
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    (HERE / "bracket.dxf").write_text(dxf(), encoding="utf-8")
    (HERE / "bracket.svg").write_text(svg(), encoding="utf-8")
