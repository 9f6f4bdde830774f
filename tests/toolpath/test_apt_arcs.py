"""Arcs of APT: round their axis, along the tangent they start on, with the radius that they have or are given."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.apt import read_apt

HEAD = "PARTNO/X\nUNITS/MM\nFEDRAT/600\n"


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize("size", [1.0, 0.02])
def test_an_arc_of_catia_is_the_circle_through_its_start_along_its_tangent(seed: int, turn: int, size: float) -> None:
    """In complex numbers; every chord within a hundredth of a millimetre of the circle, and the whole as long as it."""
    rng = np.random.default_rng(seed)
    centre, radius = complex(*rng.uniform(-40, 40, 2)), size * rng.uniform(5, 30)
    begin, sweep = rng.uniform(-3, 3), rng.uniform(0.3, 6.0)
    start, end = (centre + radius * np.exp(1j * (begin + turn * t)) for t in (0.0, sweep))
    along = 1j * turn * np.exp(1j * begin)
    text = (
        f"UNITS/MM\nFEDRAT/100,MMPM\nFROM/{start.real:.9f},{start.imag:.9f},5\n"
        f"INDIRV/{along.real:.9f},{along.imag:.9f},0\n"
        f"TLON,GOFWD/(CIRCLE/{centre.real:.9f},{centre.imag:.9f},5,{radius:.9f}),ON,"
        f"(LINE/{centre.real:.9f},{centre.imag:.9f},5,{end.real:.9f},{end.imag:.9f},5)\nFINI\n"
    )
    points = read_apt(text).p @ [1e3, 1e3j, 0]
    np.testing.assert_allclose(points[[0, -1]], [start, end], atol=1e-6)
    np.testing.assert_allclose(abs(points - centre), radius, atol=1e-6)
    turned = np.angle((points[1:] - centre) / (points[:-1] - centre))
    assert (turned * turn > 0).all()
    assert abs(turned).sum() == pytest.approx(sweep, abs=1e-6)
    assert (radius * (1 - np.cos(turned / 2))).max() < 0.01


@pytest.mark.parametrize(
    ("arc", "turn"),
    [
        ("CIRCLE/0,0,5,0,0,1,10", 90),
        ("CIRCLE/0,0,5,0,0,-1,10,0.01,0.5,8,0", -270),
        ("MOVARC/0,0,5,0,0,1,10,ANGLE,90", 90),
        ("MOVARC/0,0,5,0,0,1,10,ANGLE,270", -270),
        ("MOVARC/0,0,5,0,0,1,10,ANGLE,450", 450),
        ("MOVARC/0,0,5,0,0,1,10,ANGLE,630", -630),
        ("MOVARC/CENTER,0,0,5,AXIS,0,0,1,RADIUS,10", 90),
        ("CIRCLE/0,0,5,0,0,2,10,TIMES,3", 810),
    ],
)
def test_arcs_lead_round_their_axis_to_the_next_point(arc: str, turn: float) -> None:
    """From (10, 0) to (0, 10), climbing by 6: every point lies on the helix, as long as sqrt((r a)^2 + h^2)."""
    path = read_apt(f"{HEAD}FROM/10,0,5\n{arc}\nGOTO/0,10,11\nFINI\n")
    p = path.p * 1e3
    angle = np.unwrap(np.arctan2(p[:, 1], p[:, 0]))
    assert np.degrees(angle[-1]) == pytest.approx(turn)
    np.testing.assert_allclose(np.hypot(p[:, 0], p[:, 1]), 10.0, atol=1e-9)
    np.testing.assert_allclose(p[:, 2], 5 + 6 * angle / angle[-1], atol=1e-9)
    assert path.s[-1] * 1e3 == pytest.approx(np.hypot(10 * np.radians(turn), 6), rel=1e-3)
    assert 10 * (1 - np.cos(np.abs(np.diff(angle)).max() / 2)) <= 1e-3 + 1e-9  # mm: how far chords are within the arc
    assert path.cutting.tolist() == [False] + [True] * (len(p) - 1)


def test_an_arc_that_ends_where_it_starts_is_a_full_one() -> None:
    path = read_apt(f"{HEAD}FROM/10,0,5\nCIRCLE/0,0,5,0,0,1,10\nGOTO/10,0,5\nFINI\n")
    assert path.s[-1] * 1e3 == pytest.approx(20 * np.pi, rel=1e-3)


def test_arcs_without_a_radius_have_that_of_their_start() -> None:
    """As SolidWorks CAM and Creo write them: centre and axis, and the circle goes through the point before."""
    arc = "UNITS/MM\nFEDRAT/600\nFROM/10,0,0\nCIRCLE/0,0,0,0,0,-1\nGOTO/{}\nFINI\n"
    path = read_apt(arc.format("0,10,0"))
    np.testing.assert_allclose(np.hypot(*path.p[:, :2].T), 10e-3, atol=1e-8)
    assert path.p[1, 1] < 0.0  # clockwise, three quarters round
    np.testing.assert_allclose(path.p[-1] * 1e3, [0, 10, 0], atol=1e-9)
    with pytest.raises(
        GCodeError, match="Line 5: the arc's ends lie 10.0000 mm and 9.0000 mm from its centre; expected one radius"
    ):
        read_apt(arc.format("0,9,0"))


CATIA = """UNITS/MM
FEDRAT/600,MMPM
P1     =POINT/ 10.0, 0.0, 5.0
L1=LINE/ 0,0,0,1,0,0
GOTO/P1
GOTO/ 10.0, 0.0, 0.0
AUTOPS
INDIRV/ 0.00000, 1.00000, 0.00000
TLON,GOFWD/ (CIRCLE/ 0.00000, 0.00000, 0.00000,$
10.00000),ON,(LINE/ 0.00000, 0.00000, 0.00000,$
0.00000, 10.00000, 0.00000)
INDIRV/ -1,0,0
TLON,GOFWD/ (CIRCLE/ 0,0,0,10),ON,2,INTOF,(LINE/ 0,0,0,10,0,0)
GODLTA/ 5,0,0
FINI
"""


def test_arcs_of_catia_leave_along_their_tangent_and_end_where_their_line_does() -> None:
    """A quarter to the left of +Y about (0, 0): 5 pi mm; then from (0, 10) along -X, three quarters: 15 pi mm."""
    path = read_apt(CATIA)
    length = {
        line: 1e3 * float(np.linalg.norm(np.diff(path.p, axis=0), axis=1)[path.block[1:] == line].sum())
        for line in (9, 13)
    }
    assert length == {9: pytest.approx(5 * np.pi, rel=2e-4), 13: pytest.approx(15 * np.pi, rel=2e-4)}
    quarter, rest = path.p[path.block == 9], path.p[path.block == 13]
    assert quarter[-1] * 1e3 == pytest.approx((0, 10, 0))
    assert (quarter[:, :2] >= -1e-12).all()
    assert rest[:, 0].min() * 1e3 == pytest.approx(-10, abs=2e-3)
    assert rest[-1] * 1e3 == pytest.approx((10, 0, 0))
    assert path.p[0] * 1e3 == pytest.approx((10, 0, 5))
    assert path.p[-1] * 1e3 == pytest.approx((15, 0, 0))
    assert [(f.code, f.line) for f in path.findings if f.level == "ignored"] == [("definition", 4)]


def test_an_arc_of_catia_may_stand_upright() -> None:
    """About (0, 0, 10) in the plane XZ, from its lowest point along +X to (10, 0, 10)."""
    lines = "GOTO/0,0,0\nINDIRV/1,0,0\nTLON,GOFWD/ (CIRCLE/0,0,10,10),ON,(LINE/0,0,10,10,0,10)\n"
    path = read_apt(f"UNITS/MM\nFEDRAT/60,MMPM\nFROM/0,0,9\n{lines}FINI\n")
    arc = path.p[path.block == 6] * 1e3
    assert np.hypot(arc[:, 0], arc[:, 2] - 10) == pytest.approx(10.0)
    assert arc[-1] == pytest.approx((10, 0, 10))
    assert arc[:, 1] == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("lines", "says"),
    [
        ("GOTO/P9", "GOTO has 'P9', which no POINT/ before it has named"),
        ("P1=POINT/1", "POINT has 1 numbers"),
        ("M1=MACRO/A,B", "MACRO moves the tool in a way that is not read"),
        ("TLON,GOFWD/ (CIRCLE/0,0,0,10),ON,(LINE/0,0,0,0,10,0)", "TLON,GOFWD needs INDIRV"),
        ("INDIRV/0,1,0\nTLON,GOFWD/ (CYLNDR/0,0,0,0,0,1,10),ON,(LINE/0,0,0,0,10,0)", "TLON,GOFWD has '(CYLNDR"),
        ("INDIRV/1,0,0\nTLON,GOFWD/ (CIRCLE/0,0,0,10),ON,(LINE/0,0,0,0,10,0)", "INDIRV is not along the circle"),
        ("INDIRV/0,1,0\nTLON,GOFWD/ (CIRCLE/0,0,0,10),ON,(LINE/0,0,0,0,11,0)", "the arc's ends lie 10.0000 mm and 11"),
        *(
            (f"INDIRV/0,1,0\nTLON,GOFWD/ (CIRCLE/{circle}),ON,(LINE/{ray})", "an arc of TLON needs CIRCLE/x,y,z,r")
            for circle, ray in (
                ("0,0,0", "0,0,0,0,10,0"),
                ("0,0,0,10,1", "0,0,0,0,10,0"),
                ("0,0,0,10", "0,0,0,0,10"),
                ("0,0,0,10", "0,0,0,0,10,0,1"),
                ("0,0,0,0", "0,0,0,0,10,0"),
                ("0,0,0,-10", "0,0,0,0,10,0"),
            )
        ),
        (
            "INDIRV/0,0,0\nTLON,GOFWD/ (CIRCLE/0,0,0,10),ON,(LINE/0,0,0,0,10,0)",
            "Line 4: the direction of INDIRV i,j,k is 0",
        ),
        # from its own centre no tangent leads along a circle
        ("INDIRV/0,1,0\nTLON,GOFWD/ (CIRCLE/10,0,0,10),ON,(LINE/10,0,0,10,10,0)", "INDIRV is not along the circle"),
        ("INDIRV/0,1,0\nTLON,GOFWD/ (CIRCLE/6,0,0,10),ON,(LINE/6,0,0,6,10,0)", "INDIRV is not along the circle"),
        ("INDIRV/0,1,0\nTLON,GOFWD/ (CIRCLE/4,0,0,10),ON,(LINE/4,0,0,4,10,0)", "the arc's ends lie 6.0000 mm and 10"),
        ("TLLFT,GOLFT/L1", "TLLFT,GOLFT moves the tool"),
    ],
)
def test_what_catia_writes_otherwise_is_refused_by_name(lines: str, says: str) -> None:
    with pytest.raises(GCodeError) as caught:
        read_apt(f"UNITS/MM\nFEDRAT/60\nFROM/10,0,0\n{lines}\nGOTO/1,0,0\nFINI\n")
    assert says in str(caught.value)
