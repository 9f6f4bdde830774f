"""Declared values as tables: every kind of force and spring is read back, keys are today's, refusals name the key."""

from __future__ import annotations

import math
import tomllib

import numpy as np
import pytest
import tomli_w

from robomill.compliance.gravity import LinkMasses
from robomill.compliance.springs import SPRINGS
from robomill.compliance.springs.joint_bending import JointBending
from robomill.compliance.springs.spindle import SpindleSpring
from robomill.compliance.springs.tool_bending import ToolBending
from robomill.cutting.force import MeanForce
from robomill.cutting.forces import FORCES
from robomill.cutting.forces.along_path import PathForce
from robomill.cutting.forces.constant import ConstantForce
from robomill.cutting.forces.measured import ForceRecord, MeasuredForce
from robomill.cutting.tool import Cutter
from robomill.errors import ProjectError
from robomill.io.declared import from_table, kind_from_table, kind_to_table, to_table
from robomill.io.materials import load_material
from robomill.io.setups.force_models import force_from_table, force_to_table
from robomill.io.tables import Table
from robomill.provenance import Provenance
from robomill.surface.stock import Stock

MILL = Cutter("flat", 8e-3, flutes=3, stick_out=33.3e-3)
MINE = Provenance("measured", "my bench")
ROW = load_material("al7075_t6_carbide_ref190")
RECORD = ForceRecord([0.0, 1.0, 2.0, 3.0], np.arange(12.0).reshape(4, 3), frame="M", notes=("a", "b"))


def through_toml(data: dict) -> Table:
    return Table(tomllib.loads(tomli_w.dumps(data)), "a.toml, [x]")


@pytest.mark.parametrize(
    "force",
    [
        ConstantForce([1 / 3, -2.0, 0.0], MINE, ("noted",)),
        PathForce(-63.1, 110.0, provenance=MINE),
        FORCES["mechanistic"](MILL, ROW, axial=False),
        FORCES["mechanistic"](MILL, ROW.replace(name="mine", Ktc=7.77e8, provenance=MINE)),
        FORCES["kienzle"](MILL, load_material("al_wrought_cured_kienzle")),
        MeasuredForce(RECORD, None, 0.25),
        MeasuredForce(RECORD, 33.3),
    ],
    ids=lambda f: f.kind,
)
def test_forces_are_read_back(force) -> None:
    again = force_from_table(through_toml(force_to_table(force)), MILL)
    assert type(again) is type(force)
    assert to_table(again) == to_table(force)
    for name in ("provenance", "notes", "axial", "material", "cutoff", "start", "cutter"):
        assert getattr(again, name, None) == getattr(force, name, None)
    if force.kind == "measured":
        np.testing.assert_array_equal(again.record.F, RECORD.F)
        np.testing.assert_array_equal(again.record.x, RECORD.x)
        assert (again.record.axis, again.record.frame, again.record.notes) == ("time", "M", ("a", "b"))


def test_a_material_brings_the_other_rows_of_its_alloy() -> None:
    force = force_from_table(through_toml({"kind": "mechanistic", "material": ROW.name}), MILL)
    assert {row.alloy for row in force.alternatives} == {ROW.alloy}
    assert len(force.alternatives) == 3


@pytest.mark.parametrize(
    "spring",
    [
        ToolBending(8e-3, 40e-3),
        ToolBending(8e-3, 40e-3 / 3, E=210e9, core=0.7, name="long one", provenance=MINE),
        SpindleSpring(5e-8, 2e-8 / 3, provenance=MINE),
        JointBending(3, 1e-7 / 3, 0.0, MINE),
    ],
)
def test_springs_are_read_back(spring) -> None:
    assert kind_from_table(through_toml(kind_to_table(spring)), SPRINGS) == spring


def test_keys_and_units_are_those_of_files_written_before() -> None:
    tool = {"kind": "tool_bending", "diameter_mm": 8.0, "stick_out_mm": 40.0, "E_N_mm2": 600000.0, "core": 0.8}
    assert kind_to_table(ToolBending(8e-3, 40e-3)) == tool
    joint = {"kind": "joint_bending", "joint": 2, "C_x_1e-7_rad_per_Nm": 1.0, "C_y_1e-7_rad_per_Nm": 3.0}
    assert kind_from_table(Table(joint, "x"), SPRINGS) == JointBending(2, 1e-7, to_si_7(3.0))
    assert kind_from_table(Table({"kind": "spindle", "lateral_um_N": 0.05}, "x"), SPRINGS) == SpindleSpring(0.05e-6)
    old = {"kind": "path", "feed_N": 1.0, "feed_normal_N": 2.0, "axial_N": 3.0}
    assert force_from_table(Table(old, "x"), MILL) == PathForce(1.0, 2.0, 3.0)
    assert force_to_table(PathForce(1.0, 2.0, 3.0)) == old
    constant = {"kind": "constant", "vector_N": [1.0, 2.0, 3.0]}
    assert force_to_table(force_from_table(Table(constant, "x"), MILL)) == constant
    chamfer = {"kind": "chamfer", "diameter_mm": 10.0, "tip_angle_deg": 90.0, "flutes": 1, "helix_angle_deg": 0.0}
    cutter = from_table(Table(chamfer, "x"), Cutter)
    assert cutter == Cutter("chamfer", 0.01, flutes=1, tip_angle=math.pi / 2, helix_angle=0.0)
    links = LinkMasses([1.0, 2.0], np.arange(6.0).reshape(2, 3) * 1e-3, MINE)
    table = to_table(links)
    assert table["mass_kg"] == [1.0, 2.0]
    assert table["centre_mm"] == [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]
    again = from_table(through_toml(table), LinkMasses)
    np.testing.assert_array_equal(again.centre, links.centre)
    assert again.provenance == MINE
    block = Stock([0, 0, 0], [0.1, 0.2, 0.3])
    assert to_table(block) == {"lower_mm": [0.0, 0.0, 0.0], "upper_mm": [100.0, 200.0, 300.0]}


def to_si_7(value: float) -> float:
    return value * 1e-7


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        ({"kind": "spindle", "lateral_um_N": 0.1, "slip": 1}, "slip: this key is not known here"),
        ({"kind": "spindle"}, "lateral_um_N: missing; add it"),
        ({"kind": "rubber"}, f"kind: expected one of {', '.join(SPRINGS)}, found 'rubber'"),
        ({"kind": "joint_bending", "joint": 1.5}, "joint: expected a whole number, found 1.5"),
    ],
)
def test_refusals_name_the_key(data: dict, sentence: str) -> None:
    with pytest.raises(ProjectError, match=r"^a.toml, \[x\], ") as refused:
        kind_from_table(through_toml(data), SPRINGS)
    assert sentence in str(refused.value)


def test_every_model_and_spring_can_start() -> None:
    mean = MeanForce(np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0]))
    np.testing.assert_array_equal(ConstantForce(**ConstantForce.first(mean)).vector_M, [1, 2, 3])
    assert PathForce(**PathForce.first(mean)) == PathForce(4.0, 5.0, 6.0)
    for kind, model in FORCES.items():
        assert model.kind == kind
        assert model.takes is None or isinstance(load_material(model.example), model.takes)
    for kind, spring in SPRINGS.items():
        assert spring.kind == kind
        assert (spring(1) if spring.each_joint else spring.first(MILL)).kind == kind
    assert ToolBending.first(MILL).stick_out == 33.3e-3
    assert ToolBending.first(Cutter("flat", 8e-3)).stick_out == pytest.approx(32e-3)
