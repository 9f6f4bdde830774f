"""How the tool meets the part, checked at the door: refusals, and what is said of a cut."""

import math

import numpy as np
import pytest

from robomill.cutting.conditions import CutConditions, cut_warnings
from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.cutting.tool import Cutter
from robomill.errors import CuttingError
from robomill.io.materials import load_material

MILL = Cutter("flat", 8e-3, flutes=3)
#: The paper's slot: 12 000 1/min, 30 mm/s, 2 mm deep.
SLOT = CutConditions.steady(0.03, 200.0, 2e-3)
CHIP = 0.05e-3
REF190 = load_material("al7075_t6_carbide_ref190")


def test_drawn_out_or_standing_a_tool_does_not_cut_and_a_plunge_is_said():
    force = MechanisticForce(MILL, REF190)
    out = CutConditions.steady(0.03, 200.0, 2e-3, across=0.0, along=1.0)
    np.testing.assert_array_equal(force.components(out), 0.0)
    assert not out.engaged.any()
    plunge = CutConditions.steady(0.03, 200.0, 2e-3, across=0.0, along=-1.0, block=[7])
    # the whole end face advances by f_z: N R (Krc f_z + Kre)
    assert force.components(plunge)[0] == pytest.approx([0, 0, 3 * 4e-3 * (REF190.Krc * CHIP + REF190.Kre)], rel=1e-9)
    assert [(each.code, each.line) for each in cut_warnings(MILL, plunge)] == [("thrust-end-teeth", 7)]


def test_depth_beyond_the_flutes_is_warned_of():
    mill = MILL.replace(flute_length=1.5e-3)
    (found,) = cut_warnings(mill, SLOT)
    assert found.code == "beyond-flutes"
    assert "depth 2.000 mm is beyond the flute length 1.500 mm" in found.message
    assert cut_warnings(MILL, SLOT) == ()


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (
            {"n_s": 0.0},
            "Line 12: the spindle stands still while the tool is in the material; give S and M3",
        ),
        ({"v_f": 0.0}, "Line 12: the feed rate is 0"),
        ({"v_f": -0.01}, "Line 12: v_f is negative"),
        ({"a_p": -1e-3}, "Line 12: a_p is negative"),
        ({"phi_ex": 4.0}, "to 229.18°; expected 0° <= start <= end <= 180°"),
        ({"phi_st": 2.0, "phi_ex": 1.0}, "arc of engagement from 114.59° to 57.30°"),
        ({"v_f": math.nan}, "expected finite numbers"),
        ({"v_f": [1.0, 1.0, 1.0], "t": [0.0, 1.0]}, "t: expected 3 values, found shape (2,)"),
    ],
)
def test_refused_conditions(change, sentence):
    base = {"v_f": 0.03, "n_s": 200.0, "a_p": 2e-3, "phi_st": 0.0, "phi_ex": np.pi, "cutting": True, "s": 0.0, "t": 0.0}
    with pytest.raises(CuttingError) as refusal:
        MechanisticForce(MILL, REF190).components(CutConditions(**{**base, "block": 12, **change}))
    assert sentence in str(refusal.value)


def test_the_feed_of_a_tooth_is_that_of_a_turn_shared_by_the_teeth() -> None:
    c = CutConditions.steady(0.03, 200.0, 2e-3)
    assert c.chip(0, 3) == pytest.approx(30.0 / 200.0 / 3 * 1e-3)
