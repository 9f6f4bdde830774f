"""Arcs of APT-CL files at their limits: how small they may be, and which have no size."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.apt import read_apt
from robomill.toolpath.apt_moves import arc_of

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


@pytest.mark.parametrize("named", [True, False])
def test_what_an_arc_says(named: bool) -> None:
    """Centre and radius in inches, an axis of any length, the angle in degrees."""
    size = ["RADIUS", "0.5"] if named else ["0.5"]
    words = ["1", "2", "-3", "0", "-6", "8", *size, "ANGLE", "-90", "TIMES", "2"]
    arc = arc_of(["CENTER", *words[:3], "AXIS", *words[3:]] if named else words, "in", 1)
    np.testing.assert_allclose(arc.centre, [0.0254, 0.0508, -0.0762])
    np.testing.assert_allclose(arc.axis, [0, -0.6, 0.8])
    assert (arc.radius, arc.angle, arc.turns) == pytest.approx((0.0127, -np.pi / 2, 2))
    bare = arc_of(words[:6], "in", 1)
    assert (bare.radius, bare.angle, bare.turns) == (None, None, 1)


@pytest.mark.parametrize(("turns", "read"), [(0, False), (1, True), (10_000, True), (10_001, False)])
def test_an_arc_turns_once_to_ten_thousand_times(turns: int, read: bool) -> None:
    words = ["0", "0", "5", "0", "0", "1", "2", "TIMES", str(turns)]
    if read:
        assert arc_of(words, "mm", 7).turns == turns
    else:
        with pytest.raises(GCodeError, match=f"^Line 7: an arc turns {turns} times; expected 1 to 10000"):
            arc_of(words, "mm", 7)


@pytest.mark.parametrize("words", [["0", "0", "5", "0", "0"], ["0", "0", "5", "0", "0", "0", "2"]])
def test_an_arc_has_a_centre_and_an_axis_that_has_a_length(words: list[str]) -> None:
    with pytest.raises(GCodeError, match=r"^Line 7: an arc needs "):
        arc_of(words, "mm", 7)
