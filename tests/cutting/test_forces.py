"""What force models say of themselves, and what a cutter of another shape or another kind of model starts from."""

import math
from dataclasses import replace

import numpy as np
import pytest

from robomill.cutting.conditions import CutConditions
from robomill.cutting.force import MeanForce
from robomill.cutting.forces import FORCES
from robomill.cutting.forces.along_path import PathForce
from robomill.cutting.forces.constant import ConstantForce
from robomill.cutting.forces.kienzle import KienzleForce, KienzleRow
from robomill.cutting.forces.measured import ForceRecord, MeasuredForce
from robomill.cutting.forces.mechanistic import MechanisticForce, MechanisticRow
from robomill.cutting.tool import FAMILIES, Cutter
from robomill.cutting.tooling import Tooling
from robomill.errors import CuttingError
from robomill.io.materials import load_material
from robomill.provenance import Provenance

MILL = Cutter("flat", 8e-3, flutes=3)
ROW = load_material("al7075_t6_carbide_ref190")
SLOT = CutConditions.steady(0.03, 200.0, [2e-3, 1e-3])


def test_models_are_found_in_the_order_of_their_ranks():
    ranks = [m.rank for m in FORCES.values()]
    assert ranks == sorted(ranks)


@pytest.mark.parametrize(
    ("name", "follows", "ends", "stated", "milling"),
    [
        ("path", False, True, True, True),
        ("constant", False, True, True, True),
        ("mechanistic", True, False, False, True),
        ("kienzle", True, False, False, True),
        ("measured", False, False, False, False),  # a dynamometer hears a tap, too
    ],
)
def test_models_say_what_they_follow(name, follows, ends, stated, milling):
    model = FORCES[name]
    said = (model.follows_cut, model.ends_with_material, model.stated, model.of_milling)
    assert said == (follows, ends, stated, milling)


@pytest.mark.parametrize("force", [PathForce(1.0, 2.0, 3.0), ConstantForce([1.0, 2.0, 3.0])], ids=lambda f: f.kind)
def test_a_force_that_is_stated_knows_no_clock_no_cutter_and_no_turn_of_the_part(force):
    """The same at every step, whoever cuts and however the part lies; nothing of it is assumed."""
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    assert not force.in_time
    assert not force.turns_with_part
    for same in (force.placed(quarter), force.cut_by(MILL)):
        np.testing.assert_array_equal(same.components(SLOT), [[1.0, 2.0, 3.0]] * 2)
    assert force.peak(SLOT) is None
    assert force.by_material(SLOT) == force.at_ends(SLOT) == []


def test_another_model_starts_from_the_force_that_pushed():
    mean = MeanForce(np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0]))
    np.testing.assert_array_equal(ConstantForce(**ConstantForce.first(mean)).components(SLOT), [[1, 2, 3]] * 2)
    np.testing.assert_array_equal(PathForce(**PathForce.first(mean)).components(SLOT), [[4, 5, 6]] * 2)
    assert MechanisticForce.first(mean) == {}


def test_words_for_the_report():
    assert PathForce(1.0, -110.5).numbers == "1 N along the feed, −110.5 N left of the feed"
    assert PathForce(feed_normal=100.0).numbers == "100 N left of the feed"
    assert PathForce(axial=-3.0).numbers == "−3 N axial"
    assert PathForce().numbers == "0 N"
    assert ConstantForce([0, 100, -3]).numbers == "F (0, 100, −3) N in {M}"
    assert MechanisticForce(MILL, ROW).numbers == ROW.title
    for force in (PathForce(feed_normal=100.0), ConstantForce([0, 100, -3]), MechanisticForce(MILL, ROW)):
        assert force.numbers.replace("\N{MINUS SIGN}", "-") in repr(force)
    assert MechanisticForce(MILL, ROW, axial=False).numbers == f"{ROW.title}, axial force left out"


def test_the_start_of_a_record_has_the_unit_of_its_axis():
    F = np.zeros((4, 3))
    time, path = (MeasuredForce(ForceRecord(np.arange(4.0), F, axis)) for axis in ("time", "path"))
    assert (time.start_unit, path.start_unit) == ("s", "mm")
    assert time.numbers == "measured force, low-pass 50 Hz, zero phase"


def test_only_a_process_force_changes_with_the_cutter_and_knows_peak_and_rows():
    other = MILL.replace(flutes=2)
    force = MechanisticForce(MILL, ROW, (load_material("al6061_t6_carbide_ref160"),))
    assert force.cut_by(MILL) is force
    assert force.cut_by(other).cutter == other
    np.testing.assert_allclose(force.cut_by(other).components(SLOT)[:, 1] < force.components(SLOT)[:, 1], True)
    assert [row.unknown for row, _ in force.by_material(SLOT)] == [(), ("axial",)]
    own, given = (F for _, F in force.by_material(SLOT))
    np.testing.assert_allclose(given[:, 2], own[:, 2])  # a row that gives no axial force has no part in its range
    assert (given[:, :2] != own[:, :2]).all()
    stated = PathForce(1.0)
    assert stated.at_ends(SLOT) == []
    assert stated.cut_by(other) is stated
    assert stated.peak(SLOT) is None
    assert stated.by_material(SLOT) == []


def test_the_axial_force_alone_is_left_out():
    whole, without = MechanisticForce(MILL, ROW), MechanisticForce(MILL, ROW, axial=False)
    np.testing.assert_array_equal(without.components(SLOT), whole.components(SLOT) * [1, 1, 0])
    np.testing.assert_array_equal(without.peak(SLOT).high, whole.peak(SLOT).high * [1, 1, 0])


@pytest.mark.parametrize("teeth", [1, 6, 9, 10**6])
def test_many_different_cuts_are_as_one_by_one(monkeypatch, teeth):
    """In whatever portions of steps and of teeth they are looked at; many alike count as one."""
    monkeypatch.setattr("robomill.cutting.process.CASES", 3)
    monkeypatch.setattr("robomill.cutting.process.TEETH", teeth)
    depths = 1e-3 + 0.2e-3 * np.array([0, 3, 1, 3, 3, 2, 3, 4, 5, 3, 7, 6])
    force = MechanisticForce(MILL, ROW)
    together = force.peak(CutConditions.steady(0.03, 200.0, depths))
    for i, depth in enumerate(depths):
        alone = force.peak(CutConditions.steady(0.03, 200.0, depth))
        for name in ("low", "high", "at_peak"):
            np.testing.assert_allclose(getattr(together, name)[i], getattr(alone, name)[0], rtol=1e-12)


@pytest.mark.parametrize("kind", FAMILIES)
def test_a_cutter_takes_another_shape_with_what_that_one_needs(kind):
    for start in FAMILIES:
        cutter = Cutter("flat", 8e-3, flutes=3, stick_out=30e-3).reshaped(start).reshaped(kind)
        assert (cutter.kind, cutter.diameter, cutter.flutes, cutter.stick_out) == (kind, 8e-3, 3, 30e-3)
        needs = FAMILIES[kind].needs
        assert cutter.corner_radius == pytest.approx(4e-3 if kind == "ball" else 1e-3 * ("corner_radius" in needs))
        assert cutter.conical == (cutter.half_angle > 0.0) == ("tip_angle" in needs)
    for cone, half in (("chamfer", 45.0), ("drill", 59.0)):
        assert Cutter("flat", 8e-3).reshaped(cone).half_angle == pytest.approx(math.radians(half))


def test_a_force_from_a_material_has_its_source():
    force = MechanisticForce(MILL, ROW)
    assert force.findings(SLOT) == ()
    assert force.provenance.kind == "computed"
    assert "10.1186/s10033-021-00536-9" in force.provenance.source


def test_refused_models():
    with pytest.raises(CuttingError, match="has kienzle coefficients; a mechanistic force needs"):
        MechanisticForce(MILL, load_material("al_wrought_cured_kienzle"))


def test_kienzle_without_exponent_is_a_mechanistic_row_without_edges():
    source = Provenance("user", "test")
    kienzle = KienzleRow("k", "k", "x", source, kc11=8e8, mc=0.0, radial_ratio=0.3, axial_ratio=0.1)
    mechanistic = MechanisticRow("m", "m", "x", source, Ktc=8e8, Kte=0.0, Krc=2.4e8, Kre=0.0, Kac=8e7, Kae=0.0)
    np.testing.assert_allclose(
        KienzleForce(MILL, kienzle).components(SLOT), MechanisticForce(MILL, mechanistic).components(SLOT), rtol=1e-12
    )


def test_each_step_has_the_range_of_its_own_cutter():
    cutters = (MILL, Cutter("ball", 6e-3, flutes=2), Cutter("flat", 12e-3, flutes=4, helix_angle=math.radians(20)))
    of_step = np.array([0, 1, 2, 1, 0, 2])
    depths = 1e-3 * (1 + np.arange(6))
    together = replace(CutConditions.steady(0.03, 200.0, depths), tooling=Tooling(cutters, of_step))
    force = MechanisticForce(MILL, ROW)
    spread = force.peak(together)
    for i, n in enumerate(of_step):
        alone = MechanisticForce(cutters[n], ROW)
        one = CutConditions.steady(0.03, 200.0, depths[i : i + 1])
        np.testing.assert_allclose(force.components(together)[i], alone.components(one)[0], rtol=1e-12)
        own = alone.peak(one)
        for name in ("low", "high", "at_peak"):
            np.testing.assert_allclose(getattr(spread, name)[i], getattr(own, name)[0], rtol=1e-9, atol=1e-9)
