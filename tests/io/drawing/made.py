"""DXF files made by ezdxf, and pages of SVG, for the tests."""

from __future__ import annotations

import io

import ezdxf

from robomill.io.drawing.dxf import Dxf
from robomill.io.drawing.svg import Svg


def data(doc) -> bytes:
    out = io.StringIO()
    doc.write(out)
    return out.getvalue().encode()


def drawn(draw, units=4):
    doc = ezdxf.new("R2000")
    doc.units = units
    draw(doc, doc.modelspace())
    return Dxf(data(doc), "part.dxf")


SPACES = (
    'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
    'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
)
PAGE = 'width="100mm" height="80mm" viewBox="0 0 100 80"'


def svg(body: str, head: str = PAGE, before: str = "") -> Svg:
    return Svg(f"{before}<svg {SPACES} {head}>{body}</svg>".encode(), "part.svg")
