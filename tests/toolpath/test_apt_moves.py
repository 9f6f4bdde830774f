"""Arcs of APT-CL files at their limits: how small they may be, and which have no size."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.apt import read_apt

HEAD = "UNITS/MM\nFEDRAT/100,MMPM\n"
FORMS = {
    "circle": "CIRCLE/0,0,5,0,0,1,{0:g}",
    "words": "MOVARC/CENTER,0,0,5,AXIS,0,0,1,RADIUS,{0:g}",
    "tangent": "INDIRV/0,1,0\nTLON,GOFWD/(CIRCLE/0,0,5,{0:g}),ON,(LINE/0,0,5,0,{0:g},5)",
}


@pytest.mark.parametrize("radius", [0.02, 1.0, 1.5])
@pytest.mark.parametrize("form", FORMS)
def test_a_quarter_of_a_circle_however_small(form: str, radius: float) -> None:
    end = "" if form == "tangent" else f"\nGOTO/0,{radius:g},5"
    path = read_apt(f"{HEAD}FROM/{radius:g},0,5\n{FORMS[form].format(radius)}{end}\nFINI\n")
    np.testing.assert_allclose(np.hypot(*path.p[:, :2].T) * 1e3, radius, atol=1e-9)
    np.testing.assert_allclose(path.p[-1] * 1e3, [0, radius, 5], atol=1e-9)
    assert path.s[-1] * 1e3 == pytest.approx(radius * np.pi / 2, abs=2e-3)


@pytest.mark.parametrize("radius", [0.0, -1.0])
@pytest.mark.parametrize("form", FORMS)
def test_a_circle_of_no_size_is_refused(form: str, radius: float) -> None:
    with pytest.raises(GCodeError, match="a radius above 0|CIRCLE/x,y,z,r"):
        read_apt(f"{HEAD}FROM/1,0,5\n{FORMS[form].format(radius)}\nGOTO/0,1,5\nFINI\n")
