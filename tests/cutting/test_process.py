"""What a material's source does not give: not judged where the force depends on it, and assumed aloud."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from robomill.cutting.conditions import CutConditions
from robomill.cutting.force import force_on_tool
from robomill.cutting.forces.kienzle import KienzleForce
from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.cutting.materials import PUBLISHED
from robomill.cutting.tool import DISH, Cutter
from robomill.io.materials import load_material
from tests.cutting.cutters import CUTTERS, MILL, SLOT

TURNED = load_material("al_wrought_cured_kienzle")
NO_AXIAL = load_material("al6061_t6_carbide_ref160")
DRILL = Cutter("drill", 6e-3, tip_angle=2.0, flutes=2)
WAYS = {"level": (1.0, 0.0), "ramp": (0.8, -0.6), "up": (0.8, 0.6), "down": (0.0, -1.0)}
WAYS["gentle"] = (np.sqrt(1.0 - (0.6 * DISH) ** 2), -0.6 * DISH)  # its heel alone cuts, ahead
TOOLS = [*CUTTERS, MILL.replace(helix_angle=0.0), DRILL]


@pytest.mark.parametrize("axial", [True, False])
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("cutter", TOOLS, ids=lambda c: f"{c.kind} {c.helix_angle:.1f} {c.hand}")
def test_judged_is_what_does_not_change_with_the_unknown(cutter, way, axial):
    """The force is computed with other values of what is unknown: where it changes it is not judged, and elsewhere it
    is, but for a plunge, whose sideways parts cancel over a full turn only."""
    across, along = WAYS[way]
    if cutter.kind == "drill" and across:
        return  # led sideways: a reason of its own
    conditions = CutConditions.steady(0.03, 200.0, 5e-3, across=across, along=along)
    for known in itertools.product((None, 0.3), repeat=2):
        row = TURNED.replace(radial_ratio=known[0], axial_ratio=known[1])
        found = KienzleForce(cutter, row, axial=axial)
        tried = [
            KienzleForce(
                cutter, row.replace(radial_ratio=known[0] or radial, axial_ratio=known[1] or lengthwise), axial=axial
            ).components(conditions)[0]
            for radial, lengthwise in itertools.product((0.1, 0.5), repeat=2)
        ]
        changes = np.ptp(tried, axis=0).max() > 1e-6
        reasons = found.unjudged(conditions)
        assert np.isnan(force_on_tool(found, conditions, np.eye(3)[None])).all() == bool(reasons)
        assert {each.code for each in reasons} <= {"coefficient"}
        if changes or way == "level":
            assert bool(reasons) == changes
        for each in reasons:
            assert ("radial_ratio" in each.names) == (known[0] is None)
            assert ("the radial" in each.why) == (known[0] is None)
        if way == "level":
            # What is asked for is what the force changes with by itself, and nothing else.
            named = {name for each in reasons for name in each.names if name.endswith("_ratio")}
            given = {"radial_ratio": known[0] or 0.2, "axial_ratio": known[1] or 0.2}
            for name, told in zip(given, known, strict=True):
                pushed = [
                    KienzleForce(cutter, row.replace(**{**given, name: ratio}), axial=axial).components(conditions)[0]
                    for ratio in (0.1, 0.5)
                ]
                assert (name in named) == (told is None and np.ptp(pushed, axis=0).max() > 1e-6)


def test_a_share_stands_for_what_the_source_does_not_give():
    """As if the row had it; a row that does give it keeps its own."""
    given = TURNED.replace(radial_ratio=0.4, axial_ratio=0.1)
    shared = KienzleForce(MILL, TURNED, radial_share=0.4, axial_share=0.1)
    assert shared.unjudged(SLOT) == ()
    np.testing.assert_allclose(shared.components(SLOT), KienzleForce(MILL, given).components(SLOT), rtol=1e-12)
    np.testing.assert_allclose(shared.peak(SLOT).high, KienzleForce(MILL, given).peak(SLOT).high, rtol=1e-12)
    own = KienzleForce(MILL, given, radial_share=0.9, axial_share=0.9)
    np.testing.assert_array_equal(own.components(SLOT), KienzleForce(MILL, given).components(SLOT))
    assert (own.findings(SLOT), own.provenance.kind) == ((), "computed")
    half = KienzleForce(MILL, TURNED, radial_share=0.4).unjudged(SLOT)
    assert [each.names for each in half] == [("axial_ratio", "axial_share")]
    assert half[0].why.startswith(f"the axial force of {TURNED.title} is not known")


@pytest.mark.parametrize("name", ["radial_ratio", "axial_ratio"])
def test_a_ratio_of_nothing_is_where_the_line_through_two_others_begins(name):
    """Kienzle's force is a straight line over each ratio: 0 is a value like any other, and no gap in the source."""
    whole = TURNED.replace(radial_ratio=0.3, axial_ratio=0.3)
    none, some, twice = (KienzleForce(MILL, whole.replace(**{name: ratio})) for ratio in (0.0, 0.2, 0.4))
    line = 2.0 * some.components(SLOT) - twice.components(SLOT)
    np.testing.assert_allclose(none.components(SLOT), line, rtol=1e-9, atol=1e-9)
    assert none.unjudged(SLOT) == ()


def test_a_mechanistic_row_without_axial_coefficients():
    force = MechanisticForce(MILL, NO_AXIAL)
    assert [each.code for each in force.unjudged(SLOT)] == ["coefficient"]
    (lacking,) = force.unjudged(SLOT)
    assert lacking.names == ("Kac", "Kae", "axial_share")
    assert f"the axial force of {NO_AXIAL.title} is not known" in lacking.why
    assert not any(name in lacking.why for name in lacking.names), "names of files are no words for a screen"
    assert replace(force, axial=False).unjudged(SLOT) == ()
    filled = NO_AXIAL.replace(Kac=0.1 * NO_AXIAL.Ktc, Kae=0.1 * NO_AXIAL.Kte)
    np.testing.assert_allclose(
        replace(force, axial_share=0.1).components(SLOT), MechanisticForce(MILL, filled).components(SLOT), rtol=1e-12
    )


def test_an_assumption_is_said_with_its_range():
    force = KienzleForce(MILL, TURNED, radial_share=0.4, axial_share=0.1)
    assert force.provenance.kind == "assumed"
    assert [each.code for each in force.findings(SLOT)] == ["assumed-radial-share", "assumed-axial-share"]
    assert force.findings(SLOT)[0].level == "warning"
    assert KienzleForce(DRILL, TURNED, radial_share=0.4).findings(SLOT) == ()  # its thrust asks for no such force
    ends = {
        tuple(KienzleForce(MILL, TURNED.replace(radial_ratio=r, axial_ratio=a)).components(SLOT)[0].round(9))
        for r, a in itertools.product(PUBLISHED["radial"], PUBLISHED["axial"])
    }
    rows = [tuple(F[0].round(9)) for _, F in force.by_material(SLOT)]
    assert len(rows) == 5
    assert set(rows[1:]) == ends
    assert len({row.title for row, _ in force.by_material(SLOT)}) == 5
    assert len(KienzleForce(MILL, TURNED, radial_share=0.4).by_material(SLOT)) == 3


@pytest.mark.parametrize("cutter", [MILL, DRILL], ids=["mill", "drill"])
@pytest.mark.parametrize(
    ("fed_mm", "said", "judged"),
    [
        (5e-4, True, False),
        (2e-3, True, True),
        (0.02, False, True),
        (0.3, False, True),
        (2.0, True, True),
        (12.0, True, False),
    ],
)
def test_a_feed_per_tooth_far_from_any_test_is_said_and_beyond_sense_not_judged(cutter, fed_mm, said, judged):
    """Half a micrometre is a tenth of an edge's rounding, 12 mm are more than the tool is wide; air counts nowhere."""
    row = load_material("al7075_t6_carbide_ref190")
    v_f, across = np.array([0.05, fed_mm, 50.0]) * 1e-3 * 100.0 * cutter.flutes, 0.0 if cutter.kind == "drill" else 1.0
    conditions = CutConditions.steady(v_f, 100.0, [2e-3, 2e-3, 0.0], across=across, along=across - 1.0, block=[4, 5, 6])
    force = MechanisticForce(cutter, row)
    assert [(each.code, each.line) for each in force.findings(conditions)] == [("feed-per-tooth", 5)] * said
    not_judged = [each.where.tolist() for each in force.unjudged(conditions)]
    assert not_judged == [[False, True, False]] * (not judged)


def test_the_ends_of_an_assumed_share_push_as_rows_that_give_them():
    found = KienzleForce(MILL, TURNED, radial_share=0.4, axial_share=0.2).at_ends(SLOT)
    ends = itertools.product(PUBLISHED["radial"], PUBLISHED["axial"])
    rows = [TURNED.replace(radial_ratio=radial, axial_ratio=axial) for radial, axial in ends]
    truth = [KienzleForce(MILL, row).components(SLOT) for row in rows]
    assert len(found) == len(truth)
    for each in truth:
        assert min(np.abs(each - other).max() for other in found) < 1e-9
