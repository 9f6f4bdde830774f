"""How the tool meets the part, checked at the door: refusals, and what is said of a cut."""

import math

import numpy as np
import pytest

from robomill.cutting.conditions import STRAIGHT, CutConditions, cut_warnings
from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.cutting.tool import DISH, Cutter
from robomill.cutting.tooling import Tooling
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


def test_one_value_in_a_list_holds_for_every_sample_and_none_for_no_sample():
    said = {"n_s": 200.0, "phi_st": 0.0, "phi_ex": np.pi, "cutting": True, "s": 0.0, "t": 0.0, "block": 12}
    many = CutConditions(v_f=[0.03, 0.02, 0.01], a_p=[2e-3], **said)
    np.testing.assert_array_equal(many.a_p, [2e-3] * 3)
    with pytest.raises(CuttingError, match=r"a_p: expected 3 values, found shape \(0,\)"):
        CutConditions(v_f=[0.03, 0.02, 0.01], a_p=[], **said)


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


@pytest.mark.parametrize(
    ("change", "engaged"),
    [
        ({}, True),
        ({"a_p": 0.0}, False),
        ({"phi_st": 1.0, "phi_ex": 1.0}, False),
        ({"cutting": False}, False),
        ({"across": STRAIGHT}, False),
        ({"across": 2.0 * STRAIGHT}, True),
        ({"across": STRAIGHT, "along": -1.0}, True),
        ({"across": 0.0, "along": 1.0}, False),
    ],
)
def test_where_the_cutter_cuts(change, engaged):
    base = {"v_f": 0.03, "n_s": 200.0, "a_p": 2e-3, "phi_st": 0.0, "phi_ex": np.pi, "cutting": True, "s": 0.0, "t": 0.0}
    conditions = CutConditions(**{**base, **change})
    np.testing.assert_array_equal(conditions.engaged, [engaged])
    np.testing.assert_array_equal(conditions.f_z(3), [0.03 / 200.0 / 3 if engaged else 0.0])


def test_a_move_goes_mostly_along_the_tool_within_thirty_degrees_of_it():
    angle = np.radians([0.0, 29.9, 30.1, 90.0, 149.9, 150.1, 180.0])  # of the way to the tool's axis
    across, along = np.sin(angle), np.cos(angle)
    c = CutConditions.steady(0.03, 200.0, 2e-3, across=across, along=along)
    np.testing.assert_array_equal(c.mostly_axial, [True, True, False, False, False, True, True])
    np.testing.assert_array_equal(c.plunges, [False, False, False, False, False, True, True])


def test_the_first_step_that_cannot_be_is_named_by_its_line_or_its_number():
    for block, place in (([0, 1, 5], "Line 1"), ([0, 0, 0], "Step 1")):
        with pytest.raises(CuttingError, match=f"^{place}: a_p is negative"):
            CutConditions.steady(0.03, 200.0, [1e-3, -1e-3, -2e-3], block=block)
    arcs = {"arc": (np.array([0.0, 1.0, -0.5]), np.array([np.pi, 0.5, 1.0]))}
    with pytest.raises(CuttingError, match="^Step 1: arc of engagement from 57.30"):
        CutConditions.steady(0.03, 200.0, 2e-3, **arcs)
    with pytest.raises(CuttingError, match="^Step 2: the spindle stands still"):
        CutConditions.steady(0.03, [200.0, 200.0, 0.0, 0.0], 2e-3).f_z(3)


@pytest.mark.parametrize(("name", "value"), [("v_f", -1.0), ("n_s", -1.0), ("a_p", -1.0)])
def test_what_stands_on_rapids_is_nobodys_business(name, value):
    given = {"v_f": 0.03, "n_s": 200.0, "a_p": 2e-3, name: value}
    assert not CutConditions.steady(**given, cutting=False).engaged.any()


def test_arcs_may_be_out_by_rounding_and_no_more():
    for arc in ((-0.5e-9, np.pi), (0.0, np.pi + 0.5e-9), (1.0, 1.0 - 0.5e-9)):
        assert len(CutConditions.steady(0.03, 200.0, 2e-3, arc=arc)) == 1
    for arc in ((-2e-9, np.pi), (0.0, np.pi + 2e-9), (1.0, 1.0 - 2e-9)):
        with pytest.raises(CuttingError, match="expected 0° <= start <= end <= 180°"):
            CutConditions.steady(0.03, 200.0, 2e-3, arc=arc)
        assert len(CutConditions.steady(0.03, 200.0, 2e-3, arc=arc, cutting=False)) == 1


def test_each_cutter_is_warned_of_its_own_flutes_at_its_deepest_step():
    cutters = (MILL.replace(flute_length=2e-3), MILL, MILL.replace(flute_length=1e-3))
    depth = 1e-3 * np.array([2.0, 3.0, 2.5, 9.0, 1.5, 0.5])
    of_step = Tooling(cutters, [0, 0, 0, 1, 2, 2])
    block = np.array([1, 2, 3, 4, 5, 6])
    conditions = CutConditions.steady(0.03, 200.0, depth, block=block)
    many = CutConditions(**{**vars(conditions), "tooling": of_step})
    found = cut_warnings(MILL, many)
    assert [(each.line, each.code) for each in found] == [(2, "beyond-flutes"), (5, "beyond-flutes")]
    assert "depth 3.000 mm" in found[0].message
    assert "2 steps" in found[0].message
    rapid = CutConditions(**{**vars(many), "cutting": block != 2})
    assert [each.line for each in cut_warnings(MILL, rapid)] == [3, 5]
    # What is engaged higher up than it is deep counts by its highest place.
    reach = CutConditions(**{**vars(conditions), "reach": np.where(block == 6, 4e-3, 1e-3)})
    assert [each.line for each in cut_warnings(cutters[0], reach)] == [6]


@pytest.mark.parametrize(
    ("mill", "degrees", "codes"),
    [
        (MILL, -0.4, ["end-teeth-heel"]),
        (MILL, -0.001, []),  # the rounding of a program
        (MILL, 0.4, []),
        (MILL.replace(kind="ball"), -0.4, []),  # no end face
    ],
)
def test_slopes_on_which_only_the_heel_of_a_hollow_end_cuts_are_named(mill, degrees, codes):
    slope = math.radians(degrees)
    gentle = CutConditions.steady(0.03, 200.0, 2e-3, across=math.cos(slope), along=math.sin(slope), block=[3])
    assert [each.code for each in cut_warnings(mill, gentle)] == codes


def test_thrusts_of_mills_and_drills_are_said_once_each_where_they_are_computed():
    drill = Cutter("drill", 6e-3, tip_angle=math.radians(118.0))
    along = np.array([-DISH, -0.5, -0.6, -1.0, -1.0, -1.0])
    conditions = CutConditions.steady(0.03, 200.0, 2e-3, along=along, block=np.arange(1, 7))
    conditions = CutConditions(**{**vars(conditions), "tooling": Tooling((MILL, drill), [0, 0, 0, 0, 1, 1])})
    found = cut_warnings(MILL, conditions)
    heel = (1, "end-teeth-heel")  # as gentle as its end is hollow
    assert [(each.line, each.code) for each in found] == [(2, "thrust-end-teeth"), (5, "thrust-lips"), heel]
    assert ["3 steps" in found[0].message, "2 steps" in found[1].message] == [True, True]
    only = cut_warnings(MILL, conditions, np.array([True, False, False, True, False, False]))
    assert [(each.line, each.code) for each in only] == [(4, "thrust-end-teeth"), heel]
    assert cut_warnings(MILL, conditions, False) == ()


@pytest.mark.parametrize(
    ("n_s", "name", "asked"),
    [
        ([0.0, 0.0], "line", ["S and M3", "spindle_1_min"]),  # a program that nowhere says a speed may be given one
        ([200.0, 0.0], "line", ["S and M3"]),
        ([0.0, 0.0], "point", ["the path spindle_1_min"]),
        ([200.0, 0.0], "point", ["the path spindle_1_min"]),
    ],
)
def test_a_spindle_that_stands_is_asked_for_where_it_can_be_given(n_s, name, asked):
    conditions = CutConditions.steady(0.03, n_s, 2e-3, block=[7, 8], block_name=name)
    with pytest.raises(CuttingError) as refused:
        conditions.f_z(3)
    first = 7 if n_s[0] == 0.0 else 8
    assert str(refused.value).startswith(f"{name.capitalize()} {first}: ")
    assert refused.value.where == "n_s"
    for words in ("S and M3", "spindle_1_min", "the path spindle_1_min"):
        assert (words in str(refused.value)) == any(words in each for each in asked), words


def test_the_conditions_of_one_step_are_its_entries() -> None:
    rng = np.random.default_rng(3)
    every = {name: rng.uniform(0.1, 1.0, 5) for name in ("v_f", "n_s", "a_p", "s", "t", "across", "along", "steep")}
    whole = CutConditions(
        **every, phi_st=np.zeros(5), phi_ex=rng.uniform(1.0, 3.0, 5), cutting=rng.random(5) > 0.3, block=np.arange(5)
    )
    for i in range(5):
        one = whole.at(i)
        assert len(one) == 1
        assert all(getattr(one, name)[0] == getattr(whole, name)[i] for name in (*every, "phi_ex", "cutting", "block"))
        np.testing.assert_array_equal(one.engaged, whole.engaged[i : i + 1])
