"""Pieces as the machine is told to make them."""

import numpy as np

from robomill.toolpath.fitting import Piece
from robomill.toolpath.gcode.legs import Leg
from robomill.toolpath.gcode.reading import interpret
from robomill.toolpath.tools import Tool


def test_turning_axes_go_with_their_share_of_the_move_and_the_lift_of_another_length_is_taken_off() -> None:
    tools = {1: Tool(1, offset=(0.0, 0.0, 0.08)), 2: Tool(2, offset=(0.0, 0.0, 0.05))}
    program = interpret("G21 G90\nT1 M6\nG43 H2\nG1 X10 A20 F100\nG2 X20 I5 J0\nM2\n", tools=tools)
    j = int(np.flatnonzero(program.kind == 1)[0])
    half = Leg(j, Piece(0.0, 0.5, np.array([5e-3, 0.0, 0.0]) + program.lift[j]), "G1", program)
    np.testing.assert_allclose(np.degrees(half.rotary), [10.0, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(half.end, [5e-3, 0.0, 0.0], atol=1e-15)
    arc = int(np.flatnonzero(program.kind == 2)[0])
    assert Leg(arc, Piece(0.0, 1.0, np.zeros(3)), "G2", program).plane == 17
