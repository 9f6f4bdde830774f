"""Shapes of Sinumerik programs: holes, arcs by a point or a tangent, mirrored and scaled frames, CASE; by hand."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, interpret


def read(body: str) -> Program:
    return interpret(f"G71 G90 G17 F100 S60 M3\nG0 X0 Y0\n{body}M30\n", dialect="sinumerik")


def ends(body: str) -> list[list[float]]:
    return (np.round(read(body).end[1:, :2] * 1e3, 6) + 0.0).tolist()


def holes(body: str) -> list[list[float]]:
    program = read(f"G0 Z50\n{body}")
    return (np.round(program.end[program.end[:, 2] < -9.9e-3, :2] * 1e3, 6) + 0.0).tolist()


def test_an_arc_through_a_point() -> None:
    program = read("CIP X10 Y0 I1=5 J1=5\nX0 Y0 I1=IC(-5) J1=IC(-5)\nG91 CIP X20 Y0 I1=10 J1=-10\nG90 G1 X0\n")
    np.testing.assert_allclose(program.end[1:, :2] * 1e3, [[10, 0], [0, 0], [20, 0], [0, 0]], atol=1e-9)
    np.testing.assert_allclose(program.centre[1:4, :2] * 1e3, [[5, 0], [5, 0], [10, 0]], atol=1e-9)
    np.testing.assert_allclose(np.degrees(program.sweep[1:4]), [-180, -180, 180])


def test_arcs_that_go_on_along_a_tangent() -> None:
    program = read("G1 X10\nCT X20 Y10\nX10 Y20\nG1 X0\nCT X-5 Y25\n")
    np.testing.assert_allclose(program.centre[[2, 3, 5], :2] * 1e3, [[10, 10], [10, 10], [0, 25]], atol=1e-9)
    np.testing.assert_allclose(np.degrees(program.sweep[[2, 3, 5]]), [90, 90, -90])


def test_a_row_begins_at_the_end_that_is_nearer_and_a_circle_at_its_angle() -> None:
    drill = "MCALL CYCLE81(20,0,2,-10)\n"
    assert holes(f"{drill}HOLES1(100,0,90,5,10,3)\nMCALL\n") == [[100, 5], [100, 15], [100, 25]]
    assert holes(f"G0 Y99\n{drill}HOLES1(100,0,90,5,10,3)\nMCALL\n") == [[100, 25], [100, 15], [100, 5]]
    assert holes(f"{drill}HOLES1(7,8,33,0,10,1)\nMCALL\n") == [[7, 8]]
    assert holes(f"{drill}HOLES1(1,2,180,-5,-10,2)\nMCALL\n") == [[-4, 2], [-14, 2]]
    assert holes(f"{drill}HOLES2(1,2,10,90,0,1)\nMCALL\n") == [[1, 12]]
    assert holes(f"{drill}HOLES2(1,2,10,90,0,4)\nMCALL\n") == [[1, 12], [-9, 2], [1, -8], [11, 2]]
    assert holes(f"{drill}R1=2\nHOLES2(0,0,10,,30,R1)\nMCALL\n") == [[10, 0], [8.660254, 5]]
    assert holes(f"TRANS X100\n{drill}AMIRROR X0\nHOLES2(0,0,10,,30,2)\nMCALL\n") == [[90, 0], [91.339746, 5]]


def test_grids_frames_and_places() -> None:
    drill = "MCALL CYCLE81(20,0,2,-10)\n"
    grid = [[1, 2], [11, 2], [21, 2], [21, 7], [11, 7], [1, 7]]
    assert holes(f"{drill}CYCLE801(1,2,0,10,5,3,2,0,0,0,0,,0,1)\n") == grid
    assert holes(f"{drill}CYCLE801(0,0,90,10,5,2,2)\n") == [[0, 0], [0, 10], [-5, 10], [-5, 0]]
    around = [[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [0, 1]]
    assert holes(f"{drill}N5 CYCLE801(0,0,0,1,1,3,3,1)\n") == around
    assert holes(f"{drill}CYCLE801(0,0,0,1,0,3,1,1)\n") == [[0, 0], [1, 0], [2, 0]]
    assert holes(f"{drill}CYCLE801(0,0,0,0,4,1,3,1)\n") == [[0, 0], [0, 4], [0, 8]]
    assert holes(f"{drill}CYCLE802(111,111,1,2,3,4,5,6)\n") == [[1, 2], [3, 4], [5, 6]]
    assert holes(f"{drill}R1=7\nCYCLE802(111111111,111111111,R1,R1*2,,,)\n") == [[7, 14]]


def test_every_corner_of_a_contour_is_rounded_until_told_otherwise() -> None:
    program = read("RNDM=2\nG1 X20\nY20\nX0\nG0 Y0\nG1 X5\nZ-1\nRNDM=0\nX9\nY9\n")
    ends = [[18, 0], [20, 2], [20, 18], [18, 20], [0, 20], [0, 0], [5, 0], [5, 0], [9, 0], [9, 9]]
    np.testing.assert_allclose(program.end[1:, :2] * 1e3, ends, atol=1e-9)
    np.testing.assert_allclose(program.centre[[2, 4], :2] * 1e3, [[18, 2], [18, 18]], atol=1e-9)
    own = read("RNDM=2\nG1 X20 RND=5\nY20 CHR=1\nX0\nX-5\n")
    np.testing.assert_allclose(
        own.end[1:, :2] * 1e3, [[15, 0], [20, 5], [20, 19], [19, 20], [0, 20], [-5, 20]], atol=1e-9
    )
    smooth = read("RNDM=2\nG1 X10\nG3 X10 Y10 CR=5\nG1 X0\n")
    np.testing.assert_allclose(smooth.end[1:, :2] * 1e3, [[10, 0], [10, 10], [0, 10]], atol=1e-9)


@pytest.mark.parametrize(
    ("body", "places"),
    [
        ("MIRROR X0\nG1 X10 Y5\nX=IC(5)\nG91 Y1\nG90 MIRROR\n", None),
        ("MIRROR X0\nG1 X10 Y5\nX=IC(5)\nG91 Y1\nG90\nMIRROR\nG1 X1\n", [[-10, 5], [-15, 5], [-15, 6], [1, 6]]),
        ("TRANS X100 Y50\nAMIRROR X0\nG1 X10 Y5\nTRANS X100\nX10 Y5\n", [[90, 55], [110, 5]]),
        ("TRANS X100\nMIRROR X0\nG1 X10 Y5\n", [[-10, 5]]),
        ("SCALE X2 Y2\nG1 X10 Y5\nASCALE X2\nX10\nAMIRROR Y0\nY1\n", [[20, 10], [40, 10], [40, -2]]),
        ("AROT RPL=90\nAMIRROR X0\nG1 X10\n", [[0, -10]]),
    ],
)
def test_frames_that_mirror_and_scale(body: str, places: list[list[float]] | None) -> None:
    if places is None:
        with pytest.raises(GCodeError, match="Line 7: "):
            read(body)
    else:
        assert ends(body) == places


def test_arcs_turn_the_other_way_in_a_mirror() -> None:
    program = read("MIRROR X0\nG1 X20 Y0\nG3 X10 Y10 I-10 J0\nCIP X10 Y-10 I1=0 J1=0\nCT X20 Y0\n")
    np.testing.assert_allclose(program.end[2:, :2] * 1e3, [[-10, 10], [-10, -10], [-20, 0]], atol=1e-9)
    np.testing.assert_allclose(program.centre[2:, :2] * 1e3, [[-10, 0]] * 3, atol=1e-9)
    np.testing.assert_allclose(np.degrees(program.sweep[2:]), [-90, -180, -90])


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("turn", ["", "ROT RPL=40\n", "TRANS X3 Y-4\nAROT RPL=-75\n", "MIRROR Y0\n", "SCALE X2 Y2\n"])
@pytest.mark.parametrize("by", ["G90", "G91"])
def test_bent_moves_follow_their_circles_in_every_frame(seed: int, turn: str, by: str) -> None:
    """CIP through a point of a circle, then CT on to another place along the tangent, in complex numbers."""
    rng = np.random.default_rng(seed)
    centre, radius = complex(*rng.uniform(-9, 9, 2)), rng.uniform(3, 9)
    way = 1 if seed % 2 else -1
    start, middle, end = (centre + radius * np.exp(1j * way * (seed + t)) for t in (0.0, 0.9, 2.5))
    course = 1j * way * (end - centre)
    further = end + course * (0.8 + 0.9j)

    def words(z: complex, base: complex, x: str = "X", y: str = "Y") -> str:
        z -= base if by == "G91" else 0
        eq = "=" if x != "X" else ""
        return f"{x}{eq}{z.real:.9f} {y}{eq}{z.imag:.9f}"

    body = f"{turn}G0 X{start.real:.9f} Y{start.imag:.9f}\n{by}\n"
    body += f"CIP {words(end, start)} {words(middle, start, 'I1', 'J1')}\nCT {words(further, end)}\nG90\n"
    program = read(body)
    angle = {"ROT": 40, "TRA": -75}.get(turn[:3], 0)
    origin = 3 - 4j if "TRANS" in turn else 0

    def seen(z: complex) -> complex:
        z = np.conj(z) if "MIRROR" in turn else 2 * z if "SCALE" in turn else z
        return complex(origin + z * np.exp(1j * np.radians(angle)))

    found, about = (places[-2:] @ [1e3, 1e3j, 0] for places in (program.end, program.centre))
    np.testing.assert_allclose(found, [seen(end), seen(further)], atol=1e-6)
    assert about[0] == pytest.approx(seen(centre), abs=1e-5)
    flip = -1 if "MIRROR" in turn else 1
    assert program.sweep[-2] == pytest.approx(way * flip * 2.5, abs=1e-6)
    there = seen(end + 1e-3 * course) - seen(end)
    assert ((found[0] - about[1]) / there).real == pytest.approx(0, abs=1e-2 * abs(found[0] - about[1]) / abs(there))
    turned_on = about[1] + (found[0] - about[1]) * np.exp(1j * program.sweep[-1])
    assert turned_on == pytest.approx(found[1], abs=1e-5)
    assert (there / ((found[0] - about[1]) * 1j * np.sign(program.sweep[-1]))).real > 0


def test_arcs_of_a_tenth_of_a_millimetre_are_read() -> None:
    program = read("CIP X0.2 Y0 I1=0.1 J1=0.1\nG1 X0.3\nCT X0.4 Y0.1\n")
    np.testing.assert_allclose(program.centre[[1, 3], :2] * 1e3, [[0.1, 0], [0.3, 0.1]], atol=1e-9)
    np.testing.assert_allclose(np.degrees(program.sweep[[1, 3]]), [-180, 90])
    with pytest.raises(GCodeError, match="CIP that also climbs"):
        read("CIP X0.2 Y0 Z0.3 I1=0.1 J1=0.1\n")
    with pytest.raises(GCodeError, match="CIP needs I1 and J1"):
        read("CIP X0.2 Y0 I1=0.1 J1=0.1 K1=0.3\n")


@pytest.mark.parametrize(
    ("pattern", "most"),
    [
        ("HOLES1(0,0,0,5,10,{})", 6),
        ("HOLES2(0,0,10,0,0,{})", 6),
        ("CYCLE801(0,0,0,5,5,{},1)", 6),
        ("CYCLE801(0,0,0,5,5,3,{})", 2),
    ],
)
def test_a_pattern_has_one_hole_to_as_many_as_are_said(
    monkeypatch: pytest.MonkeyPatch, pattern: str, most: int
) -> None:
    """The last count that fits, the first that does not."""
    monkeypatch.setattr("robomill.toolpath.gcode.sinumerik.shapes.MOST_HOLES", 6)
    drill = "MCALL CYCLE81(20,0,2,-10)\n"
    assert len(holes(f"{drill}{pattern.format(1)}\nMCALL\n")) == 6 // most
    assert len(holes(f"{drill}{pattern.format(most)}\nMCALL\n")) == 6
    for count in (0, most + 1):
        with pytest.raises(GCodeError, match="expected 1 to 6"):
            holes(f"{drill}{pattern.format(count)}\nMCALL\n")


@pytest.mark.parametrize(("value", "places"), [(8, [[1, 0], [2, 0], [3, 0]]), (9, [[2, 0], [3, 0]]), (7, [[3, 0]])])
def test_case_chooses_its_label(value: int, places: list[list[float]]) -> None:
    lines = "CASE(R1-1) OF 8 GOTOF L_A 9 GOTOF L_B DEFAULT GOTOF L_C\nL_A: G0 X1\nL_B: G0 X2\nL_C: G0 X3\n"
    assert ends(f"R1={value + 1}\n{lines}") == places


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("HOLES1(0,0,0,5,10,3)\n", "HOLES1 has nothing to repeat; give MCALL"),
        ("MCALL CYCLE81(20,0,2,-10)\nHOLES2(0,0,10,0,0,0)\n", "HOLES2 has 0 holes; expected 1 to"),
        ('MCALL CYCLE81(20,0,2,-10)\nHOLES1(0,0,0,5,10,3,,,"2")\n', "HOLES1 leaves holes out"),
        ('MCALL CYCLE81(20,0,2,-10)\nHOLES2(0,0,10,0,0,3,,,"2")\n', "HOLES2 leaves holes out"),
        ("MCALL CYCLE81(20,0,2,-10)\nHOLES1(0,0,0,5,10,10001)\n", "HOLES1 has 10001 holes; expected 1 to 10000"),
        ("MCALL CYCLE81(20,0,2,-10)\nHOLES1(0,0,0,5,10,-1)\n", "HOLES1 has -1 holes"),
        ("MCALL CYCLE81(20,0,2,-10)\nHOLES2(0,0,0,0,0,3)\n", "HOLES2 has 3 holes; expected 1 to 10000, and a radius"),
        ("MCALL CYCLE81(20,0,2,-10)\nHOLES2(0,0,-5,0,0,3)\n", "HOLES2 has 3 holes"),
        ("MCALL CYCLE81(20,0,2,-10)\nCYCLE801(0,0,0,1,1,101,100)\n", "CYCLE801 has 101 by 100 holes"),
        ("MCALL CYCLE81(20,0,2,-10)\nCYCLE801(0,0,0,1,1,3,3,2)\n", "CYCLE801 has a slanting grid"),
        ("MIRROR X0 RPL=5\n", "MIRROR X0 RPL=5 is not read"),
        ("SCALE X2 3\n", "SCALE X2 3 is not read"),
        ("SCALE X1001\n", "SCALE X1001 is not read"),
        ("SCALE Z-2\n", "SCALE Z-2 is not read"),
        ("AMIRROR\n", "AMIRROR  is not read"),
        ("CYCLE801(0,0,0,1,1,2,2)\n", "CYCLE801 has nothing to repeat"),
        ("MCALL CYCLE81(20,0,2,-10)\nCYCLE801(0,0,0,1,1,0,2)\n", "CYCLE801 has 0 by 2 holes"),
        ("MCALL CYCLE81(20,0,2,-10)\nCYCLE801(0,0,0,1,1,2,2,0,0,5)\n", "CYCLE801 has a slanting grid"),
        ('MCALL CYCLE81(20,0,2,-10)\nCYCLE801(0,0,0,1,1,2,2,,,,,"2,3")\n', "CYCLE801 leaves holes out"),
        ("MCALL CYCLE81(20,0,2,-10)\nCYCLE802(112,111,1,2,3,4,5,6)\n", "CYCLE802 counts some of its places as steps"),
        ("MCALL CYCLE81(20,0,2,-10)\nCYCLE802(11,11,1,2,3)\n", "CYCLE802 needs X and Y of every place"),
        ("MCALL CYCLE81(20,0,2,-10)\nCYCLE802(1,1)\n", "CYCLE802 needs X and Y of every place"),
        (
            "POCKET3(50,0,1,-5,40,30,8,60,40,0,5,,,500,200,,2)\n",
            r"POCKET3 .Sinumerik. mills a rectangular pocket in passes that",
        ),
        ("N9 POCKET4(50,0,1,-5,20,0,0)\n", r"POCKET4 .Sinumerik. mills a circular pocket"),
        ("MCALL SLOT1(50,0,1,-5,,1,20,10,0,0)\n", r"SLOT1 .Sinumerik. mills slots"),
        ("LONGHOLE(50,0,1,-5,,4,30,40,45,20,45,90)\n", r"LONGHOLE .Sinumerik. mills slots"),
        ('CYCLE72("CONTOUR",50,0,1,-5)\n', r"CYCLE72 .Sinumerik. mills a contour"),
        ("CYCLE71(50,0,1,0,0,0,40,30)\n", r"CYCLE71 .Sinumerik. mills a face"),
        ("MCALL CYCLE840(50,0,1,-5)\n", r"CYCLE840 .Sinumerik. taps with a compensating chuck"),
        ("RNDM=30\nG1 X10\nG3 X20 Y0 CR=5\nG1 Y5\n", "a corner of radius 30.000 mm does not fit"),
        ("RNDM=2\nG1 X10\nX10 Y1\nX0\n", "a corner takes 2.000 mm of both cuts"),
        ("CIP X10 Y0 I1=5 J1=0\n", "CIP has three points on one line"),
        ("CIP X10 Y0\n", "CIP needs I1 and J1"),
        ("CIP X10 Y0 Z5 I1=5 J1=5\n", "CIP that also climbs is not read"),
        ("G1 Z-1\nCT X10 Y5\n", "the move before has no direction"),
        ("G1 X10\nCT X20 Y0\n", "CT ends straight ahead"),
        ("MIRROR Z0\n", "MIRROR Z0 is not read"),
        ("SCALE X0\n", "SCALE X0 is not read"),
        ("MIRROR X0\nATRANS X5\n", "ATRANS inside of MIRROR or SCALE is not read"),
        ("CASE(1) OF X GOTOF A\n", "CASE is not read as it stands"),
        ("CASE(1) OF 1 GOTOF L_A\n", "GOTOF L_A leads nowhere"),
    ],
)
def test_what_cannot_be_read_is_refused(body: str, says: str) -> None:
    with pytest.raises(GCodeError, match=rf"Line [3-6]: .*{says}"):
        read(body)
