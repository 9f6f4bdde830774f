"""Tilted working planes, by an independent library of rotations and by what their manuals say of their angles."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robomill.errors import GCodeError
from robomill.toolpath.gcode import gcode_report, interpret, read_gcode, write_moves_jsonl
from robomill.toolpath.gcode.chords import to_toolpath
from robomill.toolpath.path import Toolpath

FANUC = "%\nO0001\nG21 G90 G17 G54 S1000 M3\nG0 X0. Y0. Z50.\n"
SIEMENS = "G17 G90 G71 G54 S1000 M3\nG0 X0 Y0 Z50\n"
KLARTEXT = "BEGIN PGM A MM\nTOOL CALL 1 Z S1000 F500\nL X+0 Y+0 Z+50 R0 FMAX M3\n"
PLACES = np.array([[5, 6, 10], [5, 6, 0], [20, 6, 0], [20, -3, 0]])
MOVES = "G0 X5. Y6.\nZ10.\nG1 Z0. F100.\nX20.\nY-3.\n"
L_MOVES = "L X5 Y6 FMAX\nL Z10 FMAX\nL Z0 F100\nL X20\nL Y-3\n"


def cuts(path: Toolpath) -> tuple[np.ndarray, np.ndarray]:
    """The last places (mm) and the tool's axes there."""
    k = np.broadcast_to(path.k, path.p.shape)
    return path.p[-4:] * 1e3, k[-4:]


def fits(
    path: Toolpath, turn: Rotation, origin: tuple[float, ...] = (0, 0, 0), moved: tuple[float, ...] = (0, 0, 0)
) -> None:
    p, k = cuts(path)
    np.testing.assert_allclose(p, np.array(origin) + turn.apply(PLACES + np.array(moved)), atol=1e-9)
    np.testing.assert_allclose(k, np.tile(turn.apply([0, 0, 1]), (4, 1)), atol=1e-12)
    assert path.cutting[-3:].all()


@pytest.mark.parametrize("angles", [(90, 90, 0), (30, -40, 70), (0, 25, 0), (-120, 15, 200)])
def test_g68_2_turns_by_eulers_angles_about_its_origin(angles: tuple[float, ...]) -> None:
    """About Z, about X as that has left it, and about Z as both have: in capitals scipy's intrinsic sequence."""
    i, j, k = angles
    head = f"{FANUC}G68.2 X10. Y-20. Z3. I{i}. J{j}. K{k}.\nG53.1\n"
    fits(read_gcode(f"{head}{MOVES}M30\n%\n"), Rotation.from_euler("ZXZ", angles, degrees=True), (10, -20, 3))
    back = read_gcode(f"{head}{MOVES}G69\nG0 A0 X1. Y2. Z50.\nG1 Z7.\nM30\n%\n")
    np.testing.assert_allclose(back.p[-1] * 1e3, [1, 2, 7], atol=1e-9)
    np.testing.assert_allclose(back.k[-2:], [[0, 0, 1], [0, 0, 1]], atol=1e-12)


def test_cuts_with_a_leaning_tool_keep_their_lean_beside_a_tilted_plane() -> None:
    """A turns about X: at 30 degrees the tool leans to (0, -sin 30, cos 30), whatever planes come before or after."""
    lean = "G1 A30. X10. F90.\nX20.\nG0 Z50.\nA0\n"
    plane = "G68.2 I0 J-20. K0\nG53.1\nG0 X5. Y6.\nZ10.\nG1 Z0. F100.\nG69\nG0 A0 X0. Y0. Z50.\n"
    for body in (lean + plane, plane + lean, lean):
        path = read_gcode(f"{FANUC}{body}M30\n%\n", dialect="fanuc")
        line = FANUC.count("\n") + body[: body.index("X20.")].count("\n") + 1
        (row,) = np.flatnonzero(path.block == line)
        np.testing.assert_allclose(path.p[row] * 1e3, [20, 0, 50], atol=1e-9)
        np.testing.assert_allclose(path.k[row], [0, -0.5, 0.75**0.5], atol=1e-12)
        np.testing.assert_allclose(path.k[-1], [0, 0, 1], atol=1e-12)
        turns = np.degrees(np.arccos(np.clip((path.k[1:] * path.k[:-1]).sum(axis=1), -1.0, 1.0)))
        assert turns.max() < 2.001


HOME = "G91 G28 Z0\nG28 X0 Y0\nG90 G28 A0 C0\n"


@pytest.mark.parametrize("end", [HOME, "G0 A0. C0.\n", "M1\n"])
def test_axes_turned_before_g68_2_lean_no_tool(end: str) -> None:
    """Posts turn the axes to where G53.1 will, which changes no cut: the same path as without, plane after plane."""
    euler = [(-90, 15, 90), (-15, 90, 0)]
    first, second = (f"G68.2 X0 Y0 Z0 I{i}. J{j}. K{k}.\nG53.1\n{MOVES}Z20.\nG69\n" for i, j, k in euler)
    before = f"{FANUC}G0 A-15. C90.\n{first}{end}G0 A-90. C165.\n{second}{HOME}M30\n%\n"
    program = interpret(before, dialect="fanuc")
    assert not program.rotary.any()
    assert not program.rotary0.any()
    assert "rotary-asked" not in {finding.code for finding in program.findings}
    path = to_toolpath(program)
    for angles, line in zip(euler, ("X20.", "X20.")):
        turn = Rotation.from_euler("ZXZ", angles, degrees=True)
        at = [n for n, text in enumerate(before.split("\n"), 1) if text == line][euler.index(angles)]
        (row,) = np.flatnonzero(path.block == at)
        np.testing.assert_allclose(path.p[row] * 1e3, turn.apply([20, 6, 0]), atol=1e-9)
        np.testing.assert_allclose(path.k[row], turn.apply([0, 0, 1]), atol=1e-12)
    plain = read_gcode(f"{FANUC}{first}{HOME}{second}{HOME}M30\n%\n", dialect="fanuc")
    np.testing.assert_allclose(plain.p[plain.cutting.nonzero()], path.p[path.cutting.nonzero()], atol=1e-12)


def test_axes_stand_after_g69_where_they_stood_before_the_plane() -> None:
    """A stands at 30 degrees again: a cut that then says C alone leans by A."""
    body = "G0 A30.\nG68.2 I0 J30. K0\nG53.1\nG0 X5. Y6. Z9.\nG1 Z0 F9.\nG69\nG0 C0. X0 Y0 Z50.\nG1 X7.\n"
    program = interpret(f"{FANUC}{body}M30\n%\n", dialect="fanuc")
    np.testing.assert_allclose(np.degrees(program.rotary[-1]), [30, 0, 0], atol=1e-9)
    np.testing.assert_allclose(to_toolpath(program).k[-1], [0, -0.5, 0.75**0.5], atol=1e-12)


def test_axes_turned_before_cycle800_lean_no_tool() -> None:
    """As a post writes it: turned, swivelled to the same, and after CYCLE800() in five axes from there."""
    body = (
        'G0 A30 C=DC(0)\nCYCLE800(0,"",0,27,0,0,0,0,0,30,0,0,0,1,,0)\nG0 X5 Y6\nCYCLE800()\nTRAORI\n'
        "G0 X1 Y2 Z3 A30 C=DC(0)\nG1 X9 F100\nG0 A0 C0\nG1 X0\nM30\n"
    )
    program = interpret(f"{SIEMENS}{body}", dialect="sinumerik")
    leans = np.degrees(program.rotary)[:, 0]
    np.testing.assert_allclose(leans, [0, 0, 0, 30, 30, 0, 0], atol=1e-9)
    np.testing.assert_allclose(program.end[-4:] * 1e3, [[1, 2, 3], [9, 2, 3], [9, 2, 3], [0, 2, 3]], atol=1e-9)
    with pytest.raises(GCodeError, match="Line 7: the end of the plane leaves the tool as it was turned"):
        read_gcode(f"{SIEMENS}{body[: body.index('TRAORI')]}G1 X9 Y9 Z9 F100\nM30\n", dialect="sinumerik")


def test_an_upright_plane_leaves_the_tool_upright() -> None:
    body = "G68.2 I0 J0 K30.\nG53.1\nG0 X5. Y6. Z9.\nG69\nG0 X0 Y0 Z9.\nG1 Z0 F9.\n"
    path = read_gcode(f"{FANUC}{body}M30\n%\n", dialect="fanuc")
    np.testing.assert_allclose(path.p[-1], [0, 0, 0], atol=1e-12)


@pytest.mark.parametrize(("mode", "axes"), [(57, "XYZ"), (27, "ZYX"), (54, "YXZ"), (45, "XZY")])
def test_cycle800_turns_axis_by_axis(mode: int, axes: str) -> None:
    """_MODE has the axes by two bits each, X 1, Y 2, Z 3, the first one lowest."""
    assert mode == sum(("XYZ".index(axis) + 1) << 2 * place for place, axis in enumerate(axes))
    turn = Rotation.from_euler(axes, (30, -50, 70), degrees=True)
    for state in ("0", "200000"):
        cycle = f'N20 CYCLE800(1,"TC1",{state},{mode},10,20,-5,30,-50,70,1,2,3,-1,100,1)\n'
        path = read_gcode(f"{SIEMENS}{cycle}{MOVES}M30\n", dialect="sinumerik")
        fits(path, turn, (10, 20, -5), (1, 2, 3))
    back = f"{SIEMENS}{cycle}{MOVES}CYCLE800()\nG0 X1 Y2 Z50 A0\nG1 Z7\nM30\n"
    np.testing.assert_allclose(read_gcode(back, dialect="sinumerik").p[-1] * 1e3, [1, 2, 7], atol=1e-9)


@pytest.mark.parametrize("behaves", ["TURN FMAX", "MOVE DIST50 F2000 SEQ-", "TURN MB MAX FMAX SYM+ TABLE ROT"])
def test_plane_spatial_turns_about_the_upright_axes_x_y_z(behaves: str) -> None:
    """TNC 620, 10/2017: A-B-C in the non-tilted system, which is C-B-A by successive turns; scipy's small letters."""
    plane = f"PLANE SPATIAL SPA+30 SPB-50 SPC+70 {behaves}\n"
    path = read_gcode(f"{KLARTEXT}{plane}{L_MOVES}END PGM A MM\n")
    fits(path, Rotation.from_euler("xyz", (30, -50, 70), degrees=True))
    fits(path, Rotation.from_euler("ZYX", (70, -50, 30), degrees=True))


def test_cycle800_takes_angles_in_space_about_z_and_then_y() -> None:
    turn = Rotation.from_euler("ZY", (30, -50), degrees=True)
    for mode in (64, 121):
        cycle = f'CYCLE800(1,"TC1",0,{mode},10,20,-5,30,-50,0,1,2,3,-1,100,1)\n'
        path = read_gcode(f"{SIEMENS}{cycle}{MOVES}M30\n", dialect="sinumerik")
        fits(path, turn, (10, 20, -5), (1, 2, 3))


X_WAY, NORMAL = (0.6, 0.0, -0.8), (0.48, 0.8, 0.36)
"""Of length 1 and at right angles: 0.6 x 0.48 = 0.8 x 0.36."""
SAID = {
    "PLANE EULER EULPR30 EULNU-50 EULROT70": Rotation.from_euler("ZXZ", (30, -50, 70), degrees=True),
    "PLANE VECTOR BX+0.6 BY+0 BZ-0.8 NX+0.48 NY+0.8 NZ+0.36": Rotation.from_matrix(
        np.column_stack([X_WAY, np.cross(NORMAL, X_WAY), NORMAL])
    ),
    "PLANE VECTOR BX1.2 BY0.0003 BZ-1.6 NX4.8 NY8 NZ3.6": Rotation.from_matrix(
        np.column_stack([X_WAY, np.cross(NORMAL, X_WAY), NORMAL])
    ),
    "PLANE SPATIAL SPA+0 SPB+20 SPC+0 TURN\nPLANE RELATIV SPA-35": Rotation.from_euler("YX", (20, -35), degrees=True),
    "PLANE RELATIV SPC+35": Rotation.from_euler("z", 35, degrees=True),
}


@pytest.mark.parametrize("plane", SAID)
def test_planes_by_eulers_angles_vectors_and_steps(plane: str) -> None:
    """Euler's about Z, X and Z as each has left them; a plane by vectors has X along B and Z along N."""
    path = read_gcode(f"{KLARTEXT}{plane} TURN FMAX\n{L_MOVES}END PGM A MM\n")
    p, k = cuts(path)
    near = 1e-9 if "0003" not in plane else 0.01
    np.testing.assert_allclose(p, SAID[plane].apply(PLACES), atol=near)
    np.testing.assert_allclose(k, np.tile(SAID[plane].apply([0, 0, 1]), (4, 1)), atol=1e-9)


@pytest.mark.parametrize(
    ("plane", "turned"),
    [
        ("CYCL DEF 19.0 WORKING PLANE\nCYCL DEF 19.1 A+30 B-50 C+70\n", "L A+Q120 B+Q121 C+Q122 R0 FMAX\n"),
        ("CYCL DEF 19.0\nCYCL DEF 19.1 A+30 B-50 C+70 F5000 ABST50\n", ""),
    ],
)
def test_cycle_19_turns_as_plane_spatial_and_ends_by_zero(plane: str, turned: str) -> None:
    program = f"{KLARTEXT}{plane}{turned}{L_MOVES}"
    path = read_gcode(f"{program}END PGM A MM\n")
    fits(path, Rotation.from_euler("xyz", (30, -50, 70), degrees=True))
    assert "cycle-19" in {finding.code for finding in path.findings}
    for last in ("A+0 B+0 C+0", ""):
        back = f"CYCL DEF 19.0\nCYCL DEF 19.1 {last}\nL A0 B+Q121 C0 FMAX\nL X1 Y2 Z50 FMAX\nL Z7 F99\n"
        np.testing.assert_allclose(read_gcode(f"{program}{back}END PGM A MM\n").p[-1] * 1e3, [1, 2, 7], atol=1e-9)
    if turned:
        with pytest.raises(GCodeError, match=r"^Line 6: the plane leaves the tool"):
            read_gcode(f"{KLARTEXT}{plane}{L_MOVES}")


@pytest.mark.parametrize(
    "line",
    [
        "PLANE VECTOR BX1 BY0 BZ1 NX0 NY0 NZ1 STAY",
        "PLANE VECTOR BX0 BY0 BZ0 NX0 NY0 NZ1 STAY",
        "PLANE AXIAL B-45 TURN FMAX",
        "PLANE PROJECTED PROPR+24 PROMIN+24 ROT+0 TURN",
        "PLANE POINTS P1X+0 P1Y+0 P1Z+0",
        "CYCL DEF 19.1 A+Q1 X5",
        "PLANE EULER EULPR30",
    ],
)
def test_planes_that_only_a_machine_or_nobody_knows_are_refused(line: str) -> None:
    with pytest.raises(GCodeError, match=r"^Line 4: "):
        read_gcode(f"{KLARTEXT}{line}\nL X1 F9\nEND PGM A MM\n")


def test_a_face_at_the_side_of_a_part_is_drilled_along_its_own_axis() -> None:
    """SPA90 SPC90 on a shift by X186.5 faces along X: 4.75 deep below -1.5 is X 180.25, 10 along the face is Y 10."""
    plane = "CYCL DEF 7.0\nCYCL DEF 7.1 X186.5\nCYCL DEF 7.2 Z-25\nPLANE SPATIAL SPA90 SPB0 SPC90 STAY SEQ- TABLE ROT\n"
    turned = "L A+Q120 C+Q122 R0 FMAX M126\nL X10 Y-5 R0 F MAX M3\nL Z69 R0 FMAX\n"
    drilled = "CYCL DEF 200 Q200=3 Q201=-4.75 Q206=50 Q202=4.75 Q210=0 Q203=-1.5 Q204=70.5 Q211=0\nL X10 Y-5 FMAX M99\n"
    end = "CYCL DEF 7.0\nCYCL DEF 7.1 X0\nCYCL DEF 7.2 Z0\nPLANE RESET STAY\nL Z0 R0 FMAX M91\nL A0 C0 R0 FMAX\n"
    path = read_gcode(f"{KLARTEXT}{plane}{turned}{drilled}{end}L X0 Y0 Z50 FMAX\nL Z1 F100\nEND PGM A MM\n")
    deepest = int(np.flatnonzero(path.cutting)[0])
    np.testing.assert_allclose(path.p[deepest] * 1e3, [180.25, 10, -30], atol=1e-9)
    np.testing.assert_allclose(path.k[deepest], [1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(path.p[-1] * 1e3, [0, 0, 1], atol=1e-9)


def test_arcs_lie_in_the_plane_and_the_way_there_turns_the_tool_evenly() -> None:
    turn = Rotation.from_euler("ZXZ", (20, 60, 10), degrees=True)
    arc = "G0 X10. Y0.\nZ5.\nG1 Z0. F100.\nG3 X0. Y10. I-10. J0.\n"
    program = interpret(f"{FANUC}G68.2 I20. J60. K10.\nG53.1\n{arc}M30\n%\n")
    path = to_toolpath(program)
    upright = turn.inv().apply(path.p[path.cutting] * 1e3)
    np.testing.assert_allclose(upright[:, 2], 0, atol=1e-9)
    np.testing.assert_allclose(np.hypot(upright[:, 0], upright[:, 1]), 10, atol=1e-9)
    np.testing.assert_allclose(upright[-1], [0, 10, 0], atol=1e-9)
    angles = np.degrees(np.arccos(np.clip((path.k[1:] * path.k[:-1]).sum(axis=1), -1, 1)))
    assert angles.max() < 2.001
    assert angles.sum() == pytest.approx(60, abs=1e-6)
    lower, upper = np.array(gcode_report(program)["extents_mm"])
    swept = path.p[1:][path.cutting[1:] | np.append(path.cutting[2:], False)] * 1e3
    np.testing.assert_allclose(lower, swept.min(axis=0), atol=2e-3)
    np.testing.assert_allclose(upper, swept.max(axis=0), atol=2e-3)


@pytest.mark.parametrize("missing", ["", "X", "Y", "Z"])
def test_a_cut_behind_a_tilt_is_placed_once_x_y_and_z_have_been_said(missing: str) -> None:
    """How the machine swivels moves all three; whichever is not said again is where nobody knows."""
    words = " ".join(word for word in ("X5.", "Y6.", "Z9.") if not missing or missing not in word)
    cut = "Y1." if missing != "Y" else "X1."
    program = interpret(f"{FANUC}G68.2 I0 J30. K0\nG53.1\nG0 {words}\nG1 {cut} F100.\nM30\n%\n")
    assert ("cut-unplaced" in [each.code for each in program.findings]) == bool(missing)


@pytest.mark.parametrize("degrees", [0.0, 1.0, 90.0, 179.9, 180.0])
def test_the_tool_turns_by_the_least_angle_into_a_plane_however_far_that_lies(degrees: float) -> None:
    """A great circle: every axis is a unit vector, as far from both ends together as they are from each other."""
    body = f"G68.2 I20. J{degrees} K0\nG53.1\nG0 X10. Y5.\nZ5.\nG1 Z0. F100.\nX20.\nM30\n%\n"
    k = read_gcode(f"{FANUC}{body}").k
    np.testing.assert_allclose(np.linalg.norm(k, axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(
        k[-1], Rotation.from_euler("ZX", (20, degrees), degrees=True).apply([0, 0, 1]), atol=1e-9
    )
    to, on = (
        2.0 * np.degrees(np.arcsin(np.clip(np.linalg.norm(k - end, axis=1) / 2.0, 0, 1))) for end in (k[0], k[-1])
    )
    np.testing.assert_allclose(to + on, degrees, atol=1e-5)
    assert (np.diff(to) > -1e-9).all()


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("G68.2 I0 J30. K0\nG0 X1.\n", "Line 6: G68.2 is not followed by G53.1"),
        ("G68.2 P1 I0 J30. K0\n", "Line 5: G68.2 is read with Euler's angles"),
        ("G68.2 X1. Y2.\n", "Line 5: G68.2 is read with Euler's angles"),
        ("G53.1\n", "Line 5: G53.1 is not known"),
        ("G68 X0 Y0 R5.\nG68.2 I0 J30. K0\nG53.1\n", "Line 7: G68.2 while coordinates are turned"),
        ("G16\nG68.2 I0 J30. K0\nG53.1\n", "Line 7: G68.2 while coordinates are turned"),
        ("G92 C9.\nG0 A30.\nG68.2 I0 J30. K0\nG53.1\n", "Line 8: G68.2 while A, B or C stand elsewhere than at 0"),
        ("G10 L2 P1 B9.\nG0 A30.\nG68.2 I0 J30. K0\nG53.1\n", "Line 8: G68.2 while A, B or C stand elsewhere"),
        ("G68.2 I0 J30. K0\nG53.1\nG69\nG0 X1. Y1. Z9.\nG1 Z0 F9.\n", "Line 9: the end of the plane leaves the tool"),
        ("G68.2 I0 J30. K0\nG53.1\nG69\nG81 X1. Z0 R2. F9.\n", "Line 8: the end of the plane leaves the tool"),
        ("G68.2 I0 J30. K0\nG53.1\nG0 X0 Y0 Z9.\nG1 A3. F9.\n", "Line 8: A, B or C in a tilted plane is not read"),
        *(
            (f"G68.2 I0 J30. K0\nG53.1\n{line}\n", f"Line 7: {line.split(' ')[0]} in a tilted plane is not read")
            for line in ("G52 X1.", "G92 X1.", "G55 G0 X1.", "G68 X0 Y0 R5.", "G10 L2 P1 X1.", "G54.1 P2")
        ),
    ],
)
def test_what_is_not_read_of_a_fanuc_is_refused(body: str, says: str) -> None:
    with pytest.raises(GCodeError) as caught:
        read_gcode(f"{FANUC}{body}M30\n%\n", dialect="fanuc")
    assert says in str(caught.value)


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ('CYCLE800(1,"TC1",1,57,0,0,0,30,0,0,0,0,0,1)', "CYCLE800 is read as a new plane"),
        ('CYCLE800(1,"TC1",0,57,0,0,0,30,0,0,0,0,0,0)', "CYCLE800 is read as a new plane"),
        ('CYCLE800(1,"TC1",0,192,0,0,0,30,0,0,0,0,0,1)', "CYCLE800 is read axis by axis"),
        ('TRANS X5\nCYCLE800(1,"TC1",0,57,0,0,0,30,0,0,0,0,0,1)', "CYCLE800 inside of TRANS"),
        ('CYCLE800(1,"TC1",0,57,0,0,0,30,0,0,0,0,0,1)\nATRANS X5', "ATRANS in a swivelled plane"),
        ('CYCLE800(1,"TC1",0,57,0,0,0,30,0,0,0,0,0,1)\nMIRROR X0', "MIRROR in a swivelled plane"),
        ('CYCLE800(1,"TC1",0,57,0,0,0,R5,0,0,0,0,0,1)', "CYCLE800 is read with numbers alone"),
    ],
)
def test_what_is_not_read_of_a_sinumerik_is_refused(body: str, says: str) -> None:
    with pytest.raises(GCodeError, match=f"Line [34]: {says}"):
        read_gcode(f"{SIEMENS}{body}\nG0 X1\nM30\n", dialect="sinumerik")


PLANE = "PLANE SPATIAL SPA+30 SPB+0 SPC+0"


@pytest.mark.parametrize(
    ("body", "says"),
    [
        (f"{PLANE} STAY\nL X1 F9\n", "Line 5: the plane leaves the tool as it stands"),
        (f"{PLANE} TURN FMAX\nCYCL DEF 7.1 X5\n", "Line 5: a datum shift or rotation in a tilted plane"),
        (f"{PLANE} TURN FMAX\nCYCL DEF 8.1 X\n", "Line 5: a mirror image or scale in a tilted plane"),
        (f"CYCL DEF 7.1 X5\n{PLANE} TURN FMAX\nCYCL DEF 7.1 X0\nL Z3 F9\n", "Line 7: the datum shift has ended in"),
        (f"CYCL DEF 10.1 ROT5\n{PLANE} TURN FMAX\n", "Line 5: PLANE inside of a rotation"),
        (f"{PLANE} TURN FMAX\nPLANE RESET STAY\nL X0 Y0 Z1 F9\n", "Line 6: the tool still leans"),
        (f"{PLANE} JUMP\n", "Line 4: found 'JUMP' behind PLANE"),
        ("PLANE EULER EULPR1 EULNU2\n", "Line 4: PLANE EULER EULPR1 is of Heidenhain's"),
    ],
)
def test_what_is_not_read_of_a_heidenhain_is_refused(body: str, says: str) -> None:
    with pytest.raises(GCodeError) as caught:
        read_gcode(f"{KLARTEXT}{body}END PGM A MM\n")
    assert says in str(caught.value)


def test_a_table_and_a_file_of_moves_are_refused_for_tilted_planes(tmp_path: Path) -> None:
    text = f"{FANUC}G68.2 I0 J30. K0\nG53.1\n{MOVES}M30\n%\n"
    with pytest.raises(GCodeError, match="it tilts its plane, and a rotary table is stated"):
        read_gcode(text, table="A")
    with pytest.raises(GCodeError, match="its moves stand in that"):
        write_moves_jsonl(interpret(text), tmp_path / "moves.jsonl")


@pytest.mark.parametrize("number", [120, 121, 122])
def test_what_the_axes_need_for_a_plane_is_the_controls_secret_until_it_ends(number: int) -> None:
    """Q120 to Q122 are A, B and C of the machine: unknown in a tilted plane, 0 behind it."""
    plane = "PLANE SPATIAL SPA+0 SPB+30 SPC+0 TURN FMAX\n"
    place = f"L X+Q{number} Y+5 Z+50 FMAX\n"
    back = interpret(f"{KLARTEXT}Q{number} = 7\n{plane}PLANE RESET TURN FMAX\n{place}END PGM A MM\n")
    np.testing.assert_allclose(back.end[-1] * 1e3, [0, 5, 50], atol=1e-9)
    with pytest.raises(GCodeError, match=f"Q{number} is read before the program sets it"):
        interpret(f"{KLARTEXT}Q{number} = 7\n{plane}{place}END PGM A MM\n")


@pytest.mark.parametrize("away", ["G53 Z0", "G91 G28 Z0", "G91 G30 Z0"])
def test_behind_a_plane_ways_to_places_of_the_machine_are_no_cuts(away: str) -> None:
    """Also where G1 is in force: the tool still leans, and leads clear of the part."""
    body = f"G68.2 I0 J30. K0\nG53.1\nG0 X5. Y6. Z9.\nG1 Z0 F9.\nG69\n{away}\nG90 G0 A0 X0 Y0 Z50.\nG1 X7.\n"
    path = read_gcode(f"{FANUC}{body}M30\n%\n", dialect="fanuc")
    np.testing.assert_allclose(path.p[-1] * 1e3, [7, 0, 50], atol=1e-9)
