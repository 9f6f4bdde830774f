"""DXF files made by ezdxf for the tests."""

from __future__ import annotations

import io

import ezdxf

from robomill.io.drawing.dxf import Dxf


def data(doc) -> bytes:
    out = io.StringIO()
    doc.write(out)
    return out.getvalue().encode()


def drawn(draw, units=4):
    doc = ezdxf.new("R2000")
    doc.units = units
    draw(doc, doc.modelspace())
    return Dxf(data(doc), "part.dxf")
