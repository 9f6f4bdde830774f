"""Set-ups made in code: the same as their files, in other words, and what nobody has stated is said."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import robomill as rm
from robomill.errors import RobomillError, SetupError
from robomill.simulation.given import part_frame

FLUTE = rm.load_setup("samples/paper_flute")
CUTTER = rm.Cutter("flat", diameter_mm=8, flutes=3)
PATH = rm.Toolpath.from_points(p_mm=[[0, 0, -2], [100, 0, -2]], feed_mm_min=1800)


def made(**more) -> rm.SimulationSetup:
    given = {"robot": FLUTE.robot, "source": PATH, "cutter": CUTTER, "force": rm.PathForce(feed_normal=100)}
    return rm.SimulationSetup(**{**given, "part_zero_mm": (0, -1300, 0), **more})


def test_the_paper_s_set_up_made_in_code_is_its_file() -> None:
    """samples/paper_flute/setup.toml, number by number: the same digest, so the same run."""
    setup = rm.SimulationSetup(
        name="Reference groove (Slavkovic 2013)",
        robot=rm.load_robot("slavkovic_5r").with_compliance_set("table_2"),
        source=rm.read_program("samples/paper_flute/path.nc"),
        cutter=rm.Cutter("flat", diameter_mm=8, flutes=3),
        force=rm.PathForce(feed=0, feed_normal=100, axial=0),
        stock=rm.Stock(lower_mm=[-46, -20, -10], upper_mm=[64, 20, 0]),
        part_zero_mm=[0, -1300, 2],
        tolerance_mm=0.3,
        step_mm=1,
        cell_mm=0.1,
    )
    assert setup.digest() == FLUTE.digest()


def test_the_place_of_the_part_is_a_point_and_a_turn() -> None:
    T_MW = part_frame([0.1, -1.3, 0.02], np.radians(30))
    for given in (
        {"part_zero_mm": [100, -1300, 20], "part_rotation_z_deg": 30},
        {"part_zero": [0.1, -1.3, 0.02], "part_rotation_z": np.radians(30)},
        {"part_zero_mm": None, "T_MW": T_MW},
    ):
        np.testing.assert_allclose(
            made(**given, **({} if "part_zero_mm" in given else {"part_zero_mm": None})).T_MW, T_MW
        )


def test_a_copy_keeps_what_of_the_place_is_not_given() -> None:
    setup = made(part_rotation_z_deg=30)
    moved = setup.replace(part_zero_mm=(0, -1400, 0))
    assert np.array_equal(moved.T_MW[:3, :3], setup.T_MW[:3, :3])
    np.testing.assert_allclose(moved.T_MW[:3, 3], [0, -1.4, 0])
    turned = moved.replace(part_rotation_z_deg=0)
    np.testing.assert_allclose(turned.T_MW, part_frame([0, -1.4, 0]))


def test_a_path_is_taken_as_it_is() -> None:
    assert made().source == rm.PointsSource(PATH)
    assert made().toolpath is PATH
    assert made().source.block_texts()[1].startswith("(100, 0, −2)")
    assert made().replace(source=PATH).digest() == made().digest()


def test_what_nobody_has_stated_is_said() -> None:
    said = made().provenance
    assert {block: each.kind for block, each in said.items()} == {
        "tolerance": "assumed",
        "stock": "computed",
        "cutter": "assumed",
    }
    assert "helix angle 30°" in said["cutter"].source
    mine = rm.Provenance("paper", "section 5.2")
    all_said = made(tolerance_mm=0.1, cutter=FLUTE.cutter, stock=FLUTE.stock, provenance={"force": mine})
    assert dict(all_said.provenance) == {"force": mine}


def test_angles_of_spin_are_in_either_unit() -> None:
    assert made(spin_deg=90).spin == made(spin=np.pi / 2).spin == np.pi / 2
    assert made(spin="least_deviation").spin == "least_deviation"


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"part_zero_mm": None}, "give part_zero_mm=\\(X, Y, Z\\)"),
        ({"part_zero_mm": None, "part_zero": (0, -1300, 2)}, "found -1300 m, .*part_zero in m, or part_zero_mm"),
        ({"part_rotation_z": 90}, "part_rotation_z=1.5708 or part_rotation_z_deg=90"),
        ({"T_MW": np.eye(4)}, "T_MW and part_zero are both given"),
        ({"part_zero": (0, -1.3, 0)}, "give one of them"),
        ({"part_zero_mm": (0, -1300)}, "expected shape"),
        ({"tolerance": 0.3}, "tolerance=0.0003 or tolerance_mm=0.3"),
        ({"step": 1}, "step_mm=1"),
        ({"cell": 0.1}, "cell_mm=0.1"),
        ({"rapid_rate": 30_000}, "rapid_rate_mm_min=30000"),
        ({"spin": 90}, "spin=1.5708 or spin_deg=90"),
        ({"spin": "fast"}, "expected an angle or one of"),
        ({"tolerance": 1e-3, "tolerance_mm": 1}, "are the same number"),
    ],
)
def test_what_cannot_be_meant_is_refused(given, words: str) -> None:
    with pytest.raises(SetupError, match=words):
        made(**given)


@pytest.mark.parametrize(
    ("name", "value", "give"),
    [
        ("robot", "slavkovic_5r", "rm.load_robot"),
        ("source", "part.nc", "rm.read_program"),
        ("source", [[0, 0, 0], [1, 0, 0]], "rm.Toolpath.from_points"),
        ("cutter", 8, "rm.Cutter"),
        ("force", [0, 100, 0], "rm.ConstantForce"),
        ("force", 100, "rm.ConstantForce"),
        ("stock", ([0, 0, -10], [50, 50, 0]), "rm.Stock"),
        ("springs", ["tool"], "rm.ToolBending"),
    ],
)
def test_what_is_of_another_kind_is_refused_at_once_with_what_makes_it(name: str, value: object, give: str) -> None:
    setup = rm.load_setup("paper_flute")
    with pytest.raises(rm.RobomillError, match="expected a ") as refusal:
        setup.replace(**{name: value})
    assert str(refusal.value).startswith(f"{name}: ")
    assert give in str(refusal.value)


def test_one_spring_is_taken_as_well_as_several() -> None:
    setup = rm.load_setup("paper_flute")
    spring = rm.ToolBending(diameter_mm=8, stick_out_mm=40)
    assert setup.replace(springs=spring).digest() == setup.replace(springs=[spring]).digest()


@pytest.mark.parametrize(
    "ask",
    [
        lambda name: rm.tool_pose(name, [0] * 5),
        lambda name: rm.geometric_jacobian(name, [0] * 5),
        lambda name: rm.cartesian_compliance(name, [0] * 5),
        lambda name: rm.inverse_kinematics(name, np.eye(4)),
        lambda name: rm.at_pose(name, [0] * 5),
        lambda name: rm.compliance_map(name, rm.Grid(x_mm=0, y_mm=-1300, z_mm=0)),
        lambda name: rm.reach(name, rm.Grid(x_mm=0, y_mm=-1300, z_mm=0)),
        lambda name: rm.identify(name, "nine_points"),
    ],
)
def test_a_robots_name_is_no_robot_and_the_refusal_says_what_makes_one(ask: Any) -> None:
    with pytest.raises(rm.RobomillError, match=r"robot: expected a Robot, found 'slavkovic_5r'; give rm.load_robot"):
        ask("slavkovic_5r")


def test_what_is_no_set_up_is_not_simulated() -> None:
    with pytest.raises(rm.RobomillError, match=r"expected a SimulationSetup, found 'setup.toml'; give rm.load_setup"):
        rm.simulate("setup.toml")  # type: ignore[arg-type]


def test_a_misspelled_name_has_a_suggestion() -> None:
    with pytest.raises(AttributeError) as missing:
        rm.load_robots  # noqa: B018
    assert missing.value.name == "load_robots"
    assert missing.value.obj is rm


ARM = rm.load_robot("slavkovic_5r")
LINE = rm.Element("line", points_mm=[[0, 0], [50, 0]], depth_mm=2, feed_mm_min=1800)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: rm.plane_grid("z", "a", [0] * 3, [1] * 3, 0.1), "Plane, at .m.: expected numbers, found 'a'"),
        (lambda: rm.box_grid([0] * 3, [1] * 3, "a"), "Grid, step .m.: expected numbers, found 'a'"),
        (lambda: rm.compliance_map(ARM, rm.Grid([0], [-1.3], 0)).values(3), "Quantity: expected a text, found 3"),
        (lambda: rm.compliance_map(ARM, rm.Grid([0], [-1.3], 0), A="x"), "Tool tilt A, B .rad.: expected numbers"),
        (lambda: rm.at_pose(ARM, ARM.home).delta([0, 100]), "F .N.: expected shape"),
        (lambda: rm.at_pose(ARM, [10.5, -20.2, 30.1, 0, 5]), "numpy.deg2rad"),
        (lambda: rm.joint_contributions(ARM, ARM.home), "at_pose.robot, theta..C_joint"),
        (lambda: rm.MeasuredForce("a.csv"), "record: expected a ForceRecord, .*rm.read_forces"),
        (lambda: rm.process_force("al7075_t6_carbide_ref190", 8), "cutter: expected a Cutter, found 8"),
        (lambda: rm.Robot.from_dh(a_mm=[100, 200], limits_deg=170), "limits: expected .lower, upper. for each of 2"),
        (lambda: rm.Sketch([1]), "elements: expected an Element, found 1"),
        (lambda: rm.write_map("m.csv", 5), "Map: expected a Field, found 5"),
        (lambda: rm.write_map(5, []), "Expected the name of a file, found 5"),
        (lambda: rm.load_robot(5), "Expected the name of a file, found 5"),
        (lambda: rm.load_setup(5), "Expected the name of a file, found 5"),
        (lambda: rm.read_load_tests(5), "Expected the name of a file, found 5"),
        (lambda: rm.identify(ARM, np.zeros((3, 11))), "found ndarray; of an array or a mapping make a DataFrame"),
        (lambda: rm.load_setup("paper_flute").replace(links=[1]), "links: expected a LinkMasses"),
        (lambda: rm.load_setup("paper_flute").replace(provenance={"a": "b"}), "provenance: expected a Provenance"),
        (lambda: rm.load_setup("paper_flute").replace(name=5), "name: expected a text, found 5"),
    ],
)
def test_what_a_stranger_gives_by_mistake_is_refused_in_a_sentence(call, words: str) -> None:
    with pytest.raises(RobomillError, match=words):
        call()


def test_a_sketch_is_a_source_and_one_shape_a_sketch() -> None:
    drawn = rm.load_setup("paper_flute").replace(source=rm.Sketch(LINE))
    assert drawn.source.kind == "sketch"
    assert drawn.toolpath.block_name == "shape"


def test_an_angle_of_one_decimal_within_a_turn_of_its_limits_is_taken() -> None:
    most = float(ARM.limits[0, 1]) + 2.0 * np.pi
    assert np.isfinite(rm.tool_pose(ARM, [np.floor(10.0 * most) / 10.0, 0, 0, 0, 0])).all()
    with pytest.raises(RobomillError, match="deg2rad"):
        rm.tool_pose(ARM, [np.ceil(10.0 * most) / 10.0, 0, 0, 0, 0])


def test_what_an_identification_knows_goes_with_the_compliances_it_found() -> None:
    found = rm.identify(FLUTE.robot, "nine_points")
    arm = found.applied_to(FLUTE.robot)
    setup = made(robot=arm, knowledge=found)
    assert setup.known is setup.knowledge
    np.testing.assert_array_equal(setup.known.parameters, found.parameters)
    assert setup.digest() == made(robot=arm).digest()  # no run depends on it
    assert setup.replace(tolerance_mm=0.2).known is setup.known
    softer = setup.replace(robot=arm.replace(C_theta=arm.C_theta * 1.1))
    assert softer.known is None
    assert softer.knowledge is setup.knowledge
    assert softer.replace(robot=arm).known is setup.known
    assert made(robot=arm.replace(C_theta=arm.C_theta), knowledge=setup.known).known is setup.known


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (lambda: {"knowledge": rm.identify(FLUTE.robot, "nine_points")}, "give robot=found.applied_to"),
        (lambda: {"knowledge": 0.1}, "knowledge: expected a Knowledge, found 0.1"),
        (lambda: _bent() | {"springs": ()}, "give springs=found.springs"),
        (lambda: _bent() | {"robot": rm.load_robot("kuka_kr270")}, "an arm of 5 joints, and this one has 6"),
    ],
)
def test_what_is_known_of_other_compliances_is_refused(given, words: str) -> None:
    with pytest.raises(SetupError, match=words):
        made(**given())


def _bent() -> dict[str, Any]:
    found = rm.identify(FLUTE.robot, "tilted_bending_tool", model="joints+bending")
    return {"robot": found.applied_to(FLUTE.robot), "springs": found.springs(FLUTE.robot), "knowledge": found}
