"""A call that a function or class does not take is told in a sentence, by one kind of error, wherever it is public."""

from __future__ import annotations

import inspect
from dataclasses import dataclass

import numpy as np
import pytest

import robomill as rm
from robomill.arguments import asked, asking, named
from robomill.errors import ArgumentError

CALLED = [name for name in rm.__all__ if inspect.isfunction(getattr(rm, name))]
CALLED = [name for name in CALLED if name != "identify" and inspect.signature(getattr(rm, name)).parameters]
# Public classes that a person makes; the others are answers.
MADE = [
    "ConstantForce",
    "Cutter",
    "Element",
    "Finding",
    "ForceRecord",
    "GCodeSource",
    "Grid",
    "JointBending",
    "KienzleForce",
    "KienzleRow",
    "LinesSource",
    "LinkMasses",
    "LoadTests",
    "MeasuredForce",
    "MechanisticForce",
    "MechanisticRow",
    "PathForce",
    "PointsSource",
    "Provenance",
    "Robot",
    "SimulationSetup",
    "Sketch",
    "SketchSource",
    "SpindleSpring",
    "Stock",
    "TableTool",
    "ToolBending",
    "ToolTable",
    "Toolpath",
]


# Public classes that people get from a function, each with a word of who makes it.
GOT = {
    "Advice": "advise",
    "Compensation": "compensate",
    "ComplianceMap": "compliance_map",
    "BoxDesign": "design_box",
    "Design": "design",
    "Drawing": "read_drawing",
    "Field": "field",
    "GrooveSection": "groove",
    "IKResult": "inverse_kinematics",
    "IdentificationResult": "identify",
    "Knowledge": "identify",
    "Material": "load_material",
    "PathSensitivity": "sensitivity",
    "Place": "place",
    "Placement": "place",
    "PoseReport": "at_pose",
    "SimulationResult": "simulate",
    "Study": "load_study",
    "StudyResult": "run_study",
    "Tornado": "uncertainty",
    "Turning": "turn",
    "Uncertainty": "uncertainty",
    "Verdict": "simulate",
    "ZMap": "simulate",
}
BESIDE = {"JointTests", "LayerCut", "Spread", "ForceModel"}  # tried with their rooms, and a base


def test_every_public_class_is_one_that_is_made_or_one_that_is_got() -> None:
    classes = {name for name in rm.__all__ if inspect.isclass(getattr(rm, name))}
    assert {name for name in classes if not issubclass(getattr(rm, name), Exception)} == {*MADE, *GOT, *BESIDE}


@pytest.mark.parametrize("name", GOT)
def test_an_answer_made_by_hand_says_who_makes_it(name: str) -> None:
    for args, given in (((), {}), ((1,), {}), ((), {"qqqqqq": 1}), ((None,) * 60, {})):
        with pytest.raises(ArgumentError, match=rf"^{name}: rm\..*{GOT[name]}.* makes it") as caught:
            getattr(rm, name)(*args, **given)
        assert isinstance(caught.value, TypeError)


@pytest.mark.parametrize("name", [*CALLED, *MADE])
def test_a_name_that_nothing_has_is_told_everywhere_alike(name: str) -> None:
    """It is a refusal, and the TypeError that Python's users expect."""
    with pytest.raises(ArgumentError, match="there is no 'qqqqqq'") as caught:
        getattr(rm, name)(qqqqqq=1)
    assert isinstance(caught.value, rm.RobomillError)
    assert isinstance(caught.value, TypeError)
    assert caught.value.where == "qqqqqq"


@pytest.mark.parametrize(
    ("call", "meant"),
    [
        (lambda: rm.Cutter("flat", diameter_mm=8, teeth=3), "flutes"),
        (lambda: rm.Cutter("flat", diametre_mm=8), "diameter_mm"),
        (lambda: rm.Robot.from_dh(A_mm=[500, 400]), "a_mm"),
        (lambda: rm.PathForce(normal=100), "feed_normal"),
        (lambda: rm.Toolpath.from_points(pmm=[[0, 0, 0]]), "p_mm"),
        (lambda: rm.Toolpath.from_points(p_mm=[[0, 0, 0]], rpm=9000), "spindle_1_min"),
        (lambda: rm.identify(rm.load_robot("slavkovic_5r"), "one_joint_at_a_time", robus=True), "robust"),
        (lambda: rm.load_setup("paper_flute").replace(tolerence_mm=0.3), "tolerance_mm"),
        (lambda: rm.load_setup("paper_flute").replace(tolerance_mm={"walls": 0.3}), "wall"),
        (lambda: rm.load_robot("slavkovic_5r").replace(c_theta=[1e-7] * 5), "C_theta"),
        (lambda: rm.Cutter("flat", 0.008).replace(diametr=0.01), "diameter"),
        (lambda: rm.plane_grid("z", 0.0, [0, 0, 0], [1, 1, 1], stp=0.1), "step"),
        (lambda: rm.compliance_map(rm.load_robot("slavkovic_5r"), rm.Grid([0], [-1.3], 0), a=0.1), "A"),
    ],
)
def test_a_misspelled_name_has_a_suggestion(call, meant: str) -> None:
    with pytest.raises(ArgumentError, match=f"did you mean {meant}\\?"):
        call()


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: rm.Cutter("flat"), "Cutter: diameter is missing; give diameter or diameter_mm."),
        (lambda: rm.Cutter(), "Cutter: kind is missing."),  # type: ignore[call-arg]
        (lambda: rm.simulate(), "simulate: setup is missing."),  # type: ignore[call-arg]
        (lambda: rm.ForceRecord(), "ForceRecord: x and F are missing."),  # type: ignore[call-arg]
        (lambda: rm.Cutter("flat", 0.008, diameter=0.008), "got multiple values for diameter"),  # type: ignore[misc]
        (lambda: rm.load_robot("a", "b"), "found 2 values without a name, expected at most 1 .name_or_path."),  # type: ignore[misc]
        (lambda: rm.Stock([0] * 3, [1] * 3, None, 5), "found 4 values without a name, expected at most 3"),  # type: ignore[misc]
        (lambda: rm.Robot.from_dh([1, 2]), "found 1 value without a name, expected none; give everything by name"),  # type: ignore[misc]
        (lambda: rm.PathForce(foo=1), "it takes feed, feed_normal, axial, .*axial_N."),  # type: ignore[call-arg]
    ],
)
def test_what_is_missing_or_too_much_is_told(call, words: str) -> None:
    with pytest.raises(ArgumentError, match=words):
        call()


def test_what_a_function_raises_itself_stays() -> None:
    @asked
    def broken(a: int) -> int:
        return a + "b"  # type: ignore[operator]

    with pytest.raises(TypeError, match="unsupported operand") as caught:
        broken(1)
    assert not isinstance(caught.value, rm.RobomillError)
    with pytest.raises(ArgumentError, match="broken: a is missing"):
        broken()  # type: ignore[call-arg]


def test_functions_and_classes_look_as_before() -> None:
    @asking
    @dataclass(frozen=True)
    class Plain:
        a: int
        b: int = 2

    assert (Plain(1).b, Plain(b=3, a=1).b) == (2, 3)
    with pytest.raises(ArgumentError, match="Plain: there is no 'c'"):
        Plain(1, c=3)  # type: ignore[call-arg]
    assert rm.load_robot.__name__ == "load_robot"
    assert [*inspect.signature(rm.load_robot).parameters] == ["name_or_path", "tip"]


def test_arguments_by_their_names() -> None:
    signature = inspect.signature(lambda a, b, *, c=1: None)
    assert named(signature, "it", (1,), {"c": 3}) == {"a": 1, "c": 3}
    with pytest.raises(ArgumentError, match="it: b is missing"):
        named(signature, "it", (1,), {"c": 3}, whole=True)


def test_a_robot_takes_the_names_of_its_table_in_a_copy() -> None:
    """Two stiffnesses by hand: 1 / 2000 kN m/rad = 5e-7 rad/(N m)."""
    arm = rm.Robot.from_dh(a_mm=[500, 400], k_theta_kNm_per_rad=[1000, 500])
    np.testing.assert_allclose(arm.replace(k_theta_kNm_per_rad=[2000, 4000]).C_theta, [5e-7, 2.5e-7])
    np.testing.assert_allclose(arm.replace(C_theta_1e_7_rad_per_Nm=3).C_theta, [3e-7, 3e-7])
    np.testing.assert_allclose(arm.replace(C_theta=4e-7).C_theta, [4e-7, 4e-7])
    np.testing.assert_allclose(np.degrees(arm.replace(limits_deg=[None, (-30, 60)]).limits), [[-180, 180], [-30, 60]])
    np.testing.assert_allclose(arm.replace(tool_xyz_mm=[0, 0, 150]).T_tool[:3, 3], [0, 0, 0.15])
    held = rm.Robot.from_dh(a_mm=[500, 400, 300], C_theta=1e-6).replace(blocked=[np.nan, 0.0, np.nan])
    np.testing.assert_allclose(held.replace(k_theta_kNm_per_rad=[2000, 4000]).C_theta_all, [5e-7, 1e-6, 2.5e-7])
    with pytest.raises(rm.RobomillError, match="joint 2, compliance: found 91 .*C_theta_1e_7_rad_per_Nm=91"):
        arm.replace(C_theta=[1e-7, 91])
    with pytest.raises(rm.RobomillError, match="joint 2: k_theta_kNm_per_rad: found -3200"):
        arm.replace(k_theta_kNm_per_rad=[2500, -3200])
