"""Mirror images and scales of Heidenhain's dialogue, against places that are multiplied out here.

As its manual for cycles says it: 11 enlarges all three axes about the datum, 26 each about its own centre, and a factor
of 1 ends either; a datum that was shifted is where they are counted from.
"""

from __future__ import annotations

import random

import numpy as np
import pytest

from robomill.errors import GCodeError
from robomill.toolpath.gcode import Program, interpret
from robomill.toolpath.tools import Tool

HEAD = "BEGIN PGM Q MM\nTOOL CALL 1 Z S1000 F99\nL X+0 Y+0 Z+10 FMAX M3\n"


def read(body: str) -> Program:
    return interpret(f"{HEAD}{body}END PGM Q MM\n", tools={1: Tool(1, 0.002)})


def ends(body: str) -> np.ndarray:
    return read(body).end[1:] * 1e3


@pytest.mark.parametrize("seed", range(12))
def test_places_of_a_contour_are_enlarged_about_the_datum(seed: int) -> None:
    """A random shift, turn and factor: a place is the shift and the turned, enlarged one."""
    r = random.Random(seed)
    shift, angle, factor = (
        [r.uniform(-50, 50) for _ in range(3)],
        r.choice([0.0, r.uniform(-180, 180)]),
        r.uniform(0.2, 3),
    )
    said = [[r.uniform(-9, 9) for _ in range(3)] for _ in range(6)]
    parts = [f"CYCL DEF 10.1 ROT{angle:+.9f}\n", f"CYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL {factor:.9f}\n"]
    r.shuffle(parts)
    body = "CYCL DEF 7.0 DATUM SHIFT\n" + "".join(
        f"CYCL DEF 7.{k + 1} {'XYZ'[k]}{v:+.9f}\n" for k, v in enumerate(shift)
    )
    body += "".join(parts) + "".join("L " + " ".join(f"{c}{v:+.9f}" for c, v in zip("XYZ", p)) + "\n" for p in said)
    t = np.radians(angle)
    turn = np.array([[np.cos(t), -np.sin(t), 0], [np.sin(t), np.cos(t), 0], [0, 0, 1]])
    np.testing.assert_allclose(ends(body), np.array(said) * factor @ turn.T + shift, atol=1e-6)


def test_arcs_steps_and_corners_are_enlarged_but_feeds_are_not() -> None:
    """Half as large: an arc of 10 mm is one of 5, a step of 8 is 4, a rounding of 2 is 1; 300 mm/min stay."""
    program = read("CYCL DEF 11.1 SCL 0.5\nL X+10 F300\nCC X+10 Y+10\nC X+20 Y+10 DR+\nL IY+8\nRND R2\nL IX+8\n")
    arcs = np.flatnonzero(program.kind == 2)
    np.testing.assert_allclose(program.end[arcs] * 1e3, [[10, 5, 10], [11, 9, 10]], atol=1e-9)
    np.testing.assert_allclose(program.centre[arcs, :2] * 1e3, [[5, 5], [11, 8]], atol=1e-9)
    np.testing.assert_allclose(program.end[-1] * 1e3, [14, 9, 10], atol=1e-9)
    assert program.v_f[1:] * 6e4 == pytest.approx(300)


def test_the_tool_of_a_scaled_contour_keeps_its_size() -> None:
    """A 2 mm cutter beside a line at Y 3, three times as large: 1 mm beside Y 9."""
    assert ends("CYCL DEF 11.1 SCL 3\nL X+0 Y+3 RL F99\nL X+10\nL X+12\n")[1] == pytest.approx([30, 10, 10])


@pytest.mark.parametrize("factors", [(1.4, 0.6, 1.0), (2.0, 2.0, 0.5)])
def test_axes_by_their_own_factors_about_a_centre(factors: tuple[float, float, float]) -> None:
    centre, said = np.array([15.0, 20.0, 1.0]), np.array([[3.0, 4.0, 5.0], [-7.0, 30.0, -2.0]])
    body = f"CYCL DEF 26.0 SCALING\nCYCL DEF 26.1 X{factors[0]} Y{factors[1]} Z{factors[2]} CCX+15 CCY+20 CCZ+1\n"
    body += "".join("L " + " ".join(f"{c}{v:+}" for c, v in zip("XYZ", p)) + "\n" for p in said)
    np.testing.assert_allclose(ends(body), centre + np.array(factors) * (said - centre), atol=1e-9)
    back = ends(f"{body}CYCL DEF 26.0\nCYCL DEF 26.1 X1 Y1 Z1\nL X+1 Y+2 Z+3\n")[-1]
    assert back == pytest.approx([1, 2, 3])


def test_a_factor_of_one_a_preset_and_a_datum_that_ends_are_taken_in_any_order() -> None:
    for end in (
        "CYCL DEF 7.1 X+0\nCYCL DEF 11.1 SCL 1\n",
        "CYCL DEF 11.1 SCL1\nCYCL DEF 7.1 X+0\n",
        "CYCL DEF 247 PRESET Q339=1\n",
    ):
        assert ends(f"CYCL DEF 7.1 X+100\nCYCL DEF 11.1 SCL 2\nL X+1\n{end}L X+1\n")[:, 0] == pytest.approx([102, 1])


@pytest.mark.parametrize(
    ("said", "cycle", "ends"),
    [
        ("TRANS MIRROR AXIS X", "CYCL DEF 8.1 X", "TRANS MIRROR RESET"),
        ("TRANS ROTATION ROT+30", "CYCL DEF 10.1 ROT+30", "TRANS ROTATION RESET"),
        ("TRANS SCALE SCL1.5", "CYCL DEF 11.1 SCL 1.5", "TRANS SCALE RESET"),
    ],
)
def test_trans_says_what_the_cycles_say(said: str, cycle: str, ends: str) -> None:
    body = "L X+3 Y+4 Z+5\n"
    np.testing.assert_array_equal(read(f"{said}\n{body}").end, read(f"{cycle}\n{body}").end)
    assert read(f"{said}\n{body}{ends}\n{body}").end[-1] * 1e3 == pytest.approx([3, 4, 5])


def test_in_din_iso() -> None:
    """G72 F is cycle 11, G73 H is 10."""
    program = interpret(
        "%Q G71 *\nN1 T1 G17 S99*\nN2 G72 F0.5*\nN3 G73 G90 H+90*\nN4 G01 G90 X+10 Y+4 F99*\nN9 %Q G71 *\n"
    )
    assert program.end[-1] * 1e3 == pytest.approx([-2, 5, 0])


def test_a_datum_ends_within_a_rotation_axis_by_axis() -> None:
    """Shifts of X and Y that both end behind ROT, as programs end; along Z a shift and a turn are alike either way."""
    body = "CYCL DEF 7.1 X+100\nCYCL DEF 7.2 Y+10\nCYCL DEF 10.1 ROT+90\nL X+10 Y+0\nCYCL DEF 7.0\nCYCL DEF 7.1 X+0\n"
    assert ends(f"{body}CYCL DEF 7.2 Y+0\nL X+5 Y+1\nCYCL DEF 10.1 ROT+0\nL X+5 Y+1\n")[
        :, :2
    ].tolist() == pytest.approx(np.array([[100, 20], [-1, 5], [5, 1]]))
    assert ends("CYCL DEF 10.1 ROT+90\nCYCL DEF 7.1 Z-5\nL X+10 Y+0 Z+0\n")[-1] == pytest.approx([0, 10, -5])
    with pytest.raises(GCodeError, match="^Line 10: a datum shift inside of a rotation is not read"):
        read(f"{body}L X+5\n")


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("TRANS MIRROR AXIS Z\n", "CYCL DEF 8.1 Z is not read; expected X, Y or both"),
        ("CYCL DEF 11.1 SCL\n", "CYCL DEF 11.1 SCL is not read; expected SCL and a factor"),
        ("CYCL DEF 11.1 SCL 0\n", "CYCL DEF 11 has a factor of 0; expected 0.000001 to 99.999999"),
        ("CYCL DEF 26.1 CCX+5\n", "CYCL DEF 26.1 CCX.5 is not read; expected factors"),
        ("CYCL DEF 26.1 X2 U3\n", "CYCL DEF 26.1 X2 U3 is not read; expected factors"),
        ("CYCL DEF 26.1 X2\nCYCL DEF 11.1 SCL 2\n", "CYCL DEF 26 beside a mirror image or CYCL DEF 11 is not read"),
        ("CYCL DEF 8.1 X\nCYCL DEF 26.1 X2\n", "CYCL DEF 26 beside a mirror image or CYCL DEF 11 is not read"),
        ("CYCL DEF 26.1 X2\nL X+1\nRND R1\nL Y+1\n", "RND or CHF while X and Y are scaled unlike is none"),
        ("CYCL DEF 26.1 X2\nCC X+0 Y+5\nC X+0 Y+0 DR+\n", "an arc scaled unlike along its two axes is none"),
        ("CYCL DEF 11.1 SCL 2\nCYCL DEF 7.1 X+3\n", "a datum shift or rotation inside of a mirror image or scale"),
        ("CYCL DEF 11.1 SCL 2\nCYCL DEF 8.1 X\nCYCL DEF 10.1 ROT+3\n", "a datum shift or rotation inside of a mirror"),
        (
            "CYCL DEF 11.1 SCL 2\nCYCL DEF 200 Q200=2 Q201=-5 Q206=9\nL X+1 FMAX M99\n",
            "a drilling cycle while Z is scaled",
        ),
        ("L X+1 RL F99\nCYCL DEF 11.1 SCL 2\n", "CYCL DEF 8, 11 or 26 cannot be used with cutter compensation on"),
    ],
)
def test_what_is_not_read_is_named(body: str, says: str) -> None:
    with pytest.raises(GCodeError, match=says):
        read(body)
