"""Numbers in code: SI by their name, another unit by the name that ends in it, and slips of unit refused."""

from __future__ import annotations

import copy
import inspect
import math
import pickle
from collections.abc import Callable

import numpy as np
import pytest

import robomill as rm
from robomill.errors import CuttingError, RobomillError, SetupError, SurfaceError, WorkspaceError
from robomill.quantities import quantities
from robomill.spelled import converted, in_radians, made, spelled, units_beside

CLASSES = (rm.Cutter, rm.Stock, rm.Grid, rm.SimulationSetup)


def test_a_number_is_the_same_by_either_name() -> None:
    assert rm.Cutter("flat", diameter_mm=8, flutes=3) == rm.Cutter("flat", 0.008, flutes=3)
    assert rm.Cutter("drill", 0.006, tip_angle_deg=118).tip_angle == math.radians(118)
    assert np.array_equal(rm.Stock(lower_mm=[-1, -2, -3], upper_mm=(4, 5, 0)).upper, [0.004, 0.005, 0.0])
    np.testing.assert_allclose(rm.Grid(x_mm=range(0, 101, 50), y_mm=-1300, z_mm=[0]).x, [0, 0.05, 0.1])


def test_a_copy_takes_either_name() -> None:
    cutter = rm.Cutter("flat", 0.008, stick_out=0.05)
    assert cutter.replace(diameter_mm=10, stick_out_mm=None) == rm.Cutter("flat", 0.010)
    setup = rm.load_setup("samples/paper_flute")
    assert setup.replace(tolerance_mm=0.2).tolerance == 0.2e-3
    assert setup.replace(tolerance_mm={"wall": 0.2, "feed": 1.0}).feed_tolerance == 1e-3
    with pytest.raises(TypeError, match="no 'tolerence'; did you mean tolerance?"):
        setup.replace(tolerence=1e-4)


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: rm.Cutter("flat", diameter=8), CuttingError, "found 8 m, .* give diameter=0.008 or diameter_mm=8."),
        (lambda: rm.Cutter("flat", 8), CuttingError, "found 8 m"),
        (lambda: rm.Cutter("flat", 0.008, helix_angle=30), CuttingError, "helix_angle=0.5236 or helix_angle_deg=30"),
        (lambda: rm.Cutter("flat", 0.008).replace(stick_out=40), CuttingError, "stick_out_mm=40"),
        (lambda: rm.Stock([-50, -20, -10], [50, 20, 0]), SurfaceError, "found -50 m, .* give lower in m, or lower_mm"),
        (lambda: rm.Grid([-600, 600], [-1.3], 0), WorkspaceError, "x_mm"),
        (lambda: rm.load_setup("samples/paper_flute").replace(tolerance=0.3), SetupError, "tolerance_mm=0.3"),
        (lambda: rm.load_setup("samples/paper_flute").replace(cell=0.1), SetupError, "cell_mm=0.1"),
        (lambda: rm.Cutter("flat", 0.008, diameter_mm=8), CuttingError, "diameter and diameter_mm are the same"),
        (lambda: rm.Cutter("flat", diameter_mm="8 mm"), CuttingError, "diameter_mm: expected a number, found '8 mm'"),
    ],
)
def test_a_slip_is_refused_with_how_it_is_written(make, error: type[RobomillError], words: str) -> None:
    with pytest.raises(error, match=words):
        make()


def test_a_number_whose_unit_is_said_is_never_doubted() -> None:
    """A cutter of 0.7 m, a blade of 60 m: plainly refused, accepted by the name with the unit."""
    assert rm.Cutter("flat", diameter_mm=700).radius == pytest.approx(0.35)
    assert rm.Stock(lower_mm=[0, 0, -100], upper_mm=[60_000, 3000, 0]).size[0] == 60.0
    with pytest.raises(SurfaceError):
        rm.Stock([0, 0, -0.1], [60.0, 3.0, 0.0])
    assert made(rm.Stock, {"lower": [0, 0, -0.1], "upper": [60.0, 3.0, 0.0]}).size[0] == 60.0
    longer = rm.Cutter("flat", diameter_mm=700).replace(flutes=4)
    assert (longer.diameter, longer.flutes) == (pytest.approx(0.7), 4)


@pytest.mark.parametrize("cls", CLASSES, ids=lambda cls: cls.__name__)
def test_every_number_with_a_unit_has_the_key_of_files_as_its_other_name(cls: type) -> None:
    shown = inspect.signature(cls).parameters
    for key, declared in spelled(cls).items():
        assert key == quantities(cls)[declared.name].key
        assert shown[key].kind is inspect.Parameter.KEYWORD_ONLY
    assert {each.name for each in quantities(cls).values()} <= {*shown}


def test_what_is_no_argument_is_told_as_python_does() -> None:
    for wrong in ({"diametre_mm": 8}, {}):
        with pytest.raises(TypeError):
            rm.Cutter("flat", **wrong)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="multiple values"):
        rm.Cutter("flat", 0.008, diameter=0.008)  # type: ignore[misc]
    with pytest.raises(TypeError):
        rm.Stock([0, 0, 0], [1, 1, 1], None, 5)  # type: ignore[misc]


def test_what_nobody_has_stated_of_a_cutter_is_known() -> None:
    cutter = rm.Cutter("flat", diameter_mm=8)
    assert cutter.unstated == ("flutes", "helix_angle")
    assert cutter.replace(flutes=3).unstated == ("helix_angle",)
    assert rm.Cutter("flat", 0.008, flutes=2, helix_angle_deg=30).unstated == ()
    assert cutter == rm.Cutter("flat", 0.008, flutes=2)
    for again in (copy.copy(cutter), pickle.loads(pickle.dumps(cutter))):
        assert (again, again.unstated) == (cutter, cutter.unstated)


def test_numbers_are_converted_in_lists_arrays_and_tables() -> None:
    assert converted(None, "mm", RobomillError, "it") is None
    assert converted(8, "mm", RobomillError, "it") == 0.008
    assert converted({"wall": 1.0}, "mm", RobomillError, "it") == {"wall": 1e-3}
    assert converted([1, 2], "mm", RobomillError, "it").tolist() == [1e-3, 2e-3]


def test_springs_sketches_lines_and_forces_go_by_either_name() -> None:
    assert rm.ToolBending(diameter_mm=8, stick_out_mm=32) == rm.ToolBending(0.008, 0.032)
    assert rm.SpindleSpring(lateral_um_N=0.05) == rm.SpindleSpring(0.05 * 1e-6)
    assert rm.JointBending(2, C_x_1e_7_rad_per_Nm=3.0).C_x == 3.0 * 1e-7
    assert rm.PathForce(feed_normal_N=100) == rm.PathForce(feed_normal=100)
    shape = rm.Element("line", points_mm=[[0, 0], [50, 0]], depth_mm=2, feed_mm_min=1800)
    assert (shape.points[1, 0], shape.depth, shape.v_f) == pytest.approx((0.05, 0.002, 0.03))
    lines = rm.LinesSource(start_mm=[[0, 0, -2]], end_mm=[[50, 0, -2]], feed_mm_min=[1800])
    assert lines.read().p[-1].tolist() == [0.05, 0.0, -0.002]
    for slip in (
        lambda: rm.ToolBending(8, 32),
        lambda: rm.SpindleSpring(0.05),
        lambda: rm.Element("line", [[0, 0], [50, 0]], 0.002, 0.03),
        lambda: rm.LinesSource([[0, 0, -2]], [[50, 0, -2]], [0.03]),
    ):
        with pytest.raises(RobomillError, match="is meant, give"):
            slip()


SHORT_PATH = [[-0.02, 0.0, -0.002], [0.02, 0.0, -0.002]]


@pytest.mark.parametrize(
    ("make", "again", "words"),
    [
        (
            lambda: rm.Cutter("flat", diameter_mm=0.008),
            lambda: rm.Cutter("flat", diameter=8e-6),
            "found 0.008 mm, expected at least 0.05: .* diameter=0.008 or diameter_mm=8; .* give diameter=8e-06 in m",
        ),
        (
            lambda: rm.Cutter("drill", diameter_mm=8, tip_angle_deg=1.5708),
            lambda: rm.Cutter("drill", diameter_mm=8, tip_angle=math.radians(1.5708)),
            "found 1.5708°.*give tip_angle=1.5708 or tip_angle_deg=90;",
        ),
        (
            lambda: rm.ToolBending(diameter_mm=8, stick_out_mm=0.04),
            lambda: rm.ToolBending(diameter_mm=8, stick_out=4e-5),
            "stick_out_mm=40",
        ),
        (
            lambda: rm.SpindleSpring(lateral_um_N=5e-8),
            lambda: rm.SpindleSpring(lateral=5e-14),
            "lateral=5e-08 or lateral_um_N=0.05",
        ),
        (
            lambda: rm.Element("line", points_mm=[[0, 0], [50, 0]], depth_mm=0.002, feed_mm_min=1800),
            lambda: rm.Element("line", points_mm=[[0, 0], [50, 0]], depth=2e-6, feed_mm_min=1800),
            "depth_mm=2;",
        ),
        (
            lambda: rm.LinesSource(start_mm=[[0, 0, -2]], end_mm=[[50, 0, -2]], feed_mm_min=[0.03]),
            lambda: rm.LinesSource(start_mm=[[0, 0, -2]], end_mm=[[50, 0, -2]], v_f=[5e-7]),
            "feed_mm_min is in mm/min",
        ),
        (
            lambda: rm.Toolpath.from_points(p_mm=SHORT_PATH, feed_mm_min=1800),
            lambda: rm.Toolpath.from_points(p=1e-3 * np.array(SHORT_PATH), feed_mm_min=1800),
            "whole path lies within 0.04 mm",
        ),
        (
            lambda: rm.load_setup("paper_flute").replace(tolerance_mm=3e-4),
            lambda: rm.load_setup("paper_flute").replace(tolerance=3e-7),
            "tolerance=0.0003 or tolerance_mm=0.3",
        ),
        (
            lambda: rm.load_setup("paper_flute").replace(part_zero_mm=[0, -1.3, 0]),
            lambda: rm.load_setup("paper_flute").replace(part_zero=[0, -1.3e-3, 0]),
            "in the middle of the robot's foot",
        ),
        (
            lambda: rm.load_setup("paper_flute").replace(part_rotation_z_deg=1.5708),
            lambda: rm.load_setup("paper_flute").replace(part_rotation_z=math.radians(1.5708)),
            "part_rotation_z=1.5708 or part_rotation_z_deg=90",
        ),
    ],
)
def test_what_was_certainly_meant_in_si_is_refused_under_a_name_with_a_unit(make, again, words: str) -> None:
    """And whoever does mean it has the name in SI."""
    with pytest.raises(RobomillError, match=words):
        make()
    again()


@pytest.mark.parametrize("angle", [0.0, 1.5, 1.57, 3.14, 0.5, 0.0175, 15.0, 90.0, 1.2345, 89.98, 2.6182])
def test_degrees_that_somebody_may_mean_are_taken(angle: float) -> None:
    """Measured turns of a part, and whole ones; 2.6182 rad are 150.01 degrees."""
    assert not in_radians(angle)


@pytest.mark.parametrize("parts", [1, 2, 3, 4, 6, 8, 12, 18, 24])
def test_parts_of_pi_are_radians(parts: int) -> None:
    assert in_radians(round(parts * math.pi / 12, 4))
    assert in_radians(parts * math.pi / 12)


def test_of_numbers_in_lists_the_largest_counts() -> None:
    """A wall of 0 and one of nothing beside a good one; corners at zero."""
    setup = rm.load_setup("paper_flute")
    assert setup.replace(tolerance_mm=[0.3, None, None]).tolerance == pytest.approx(3e-4)
    assert setup.replace(part_zero_mm=[0, 0, 0]).T_MW[0, 3] == 0.0
    assert rm.Stock(lower_mm=[0, 0, -0.2], upper_mm=[60, 40, 0]).size[2] == pytest.approx(2e-4)


def test_who_types_beside_a_unit_is_told_the_bound_and_no_name_in_code() -> None:
    cutter = rm.Cutter("flat", 0.008)
    with units_beside():
        with pytest.raises(CuttingError, match=r"Helix angle: found 1220\.5°; expected 0° to less than 85°\.$"):
            cutter.replace(helix_angle=math.radians(1220.5))
        with pytest.raises(CuttingError, match=r"^Cutter, Diameter: found 8000 mm; expected at most 600 mm\.$"):
            cutter.replace(diameter=8.0)
    with pytest.raises(CuttingError, match="diameter_mm=8"):
        cutter.replace(diameter=8.0)


SLIPS = {
    "a tolerance in um as mm": (lambda: rm.load_setup("paper_flute").replace(tolerance_mm=300), "50 mm"),
    "a helix in rad as degrees": (lambda: rm.Cutter("flat", diameter_mm=8, helix_angle_deg=0.52), "helix_angle=0.52"),
    "a point in rad as degrees": (lambda: rm.Cutter("drill", diameter_mm=8, tip_angle_deg=2.06), "tip_angle=2.06"),
    "half turns of yaw in rad": (lambda: rm.place(rm.load_setup("paper_flute"), yaw_deg=(-1.57, 1.57)), "1.57 rad"),
    "a plane in m as mm": (lambda: rm.Grid(x_mm=[-0.6, 0.6], y_mm=-1300, z_mm=0), "0.6 m is meant"),
    "a place beyond all robots": (lambda: rm.Grid(x_mm=0, y_mm=1e9, z_mm=0), "200 m at most"),
    "a clearance in mm as m": (lambda: rm.Sketch(clearance=5), "clearance_mm=5"),
    "touched points in mm as m": (
        lambda: rm.frame_from_points([0, -1300, 0], [100, -1300, 0], [0, -1200, 0]),
        "in m. If -1300 mm",
    ),
    "a frame of the part in mm": (
        lambda: rm.load_setup("paper_flute").replace(T_MW=[[1, 0, 0, 0], [0, 1, 0, -1300], [0, 0, 1, 0], [0, 0, 0, 1]]),
        "give T_MW in m, or part_zero_mm",
    ),
    "a cut along a drawing in m": (lambda: rm.LayerCut("a", depth_mm=0.003, feed_mm_min=600), "depth=0.003"),
    "its feed in m/s": (lambda: rm.LayerCut("a", depth_mm=3, feed_mm_min=0.01), "v_f=0.01"),
}


@pytest.mark.parametrize("slip", SLIPS)
def test_what_a_stranger_gave_in_another_unit_is_refused(slip: str) -> None:
    make, words = SLIPS[slip]
    with pytest.raises(rm.RobomillError, match=words):
        make()


def test_a_height_of_a_map_may_be_half_a_millimetre() -> None:
    """One coordinate alone says nothing of its unit; several within two millimetres do."""
    assert rm.Grid(x_mm=[-100, 100], y_mm=-1300, z_mm=0.5).shape == (2, 1, 1)


def test_at_another_door_a_refusal_names_what_stands_there() -> None:
    with units_beside({"feed_mm_min": "--feed"}):
        with pytest.raises(rm.RobomillError) as caught:
            rm.read_points("X_mm,Y_mm,Z_mm\n0,0,0\n10,0,0\n")
        assert "or give --feed." in str(caught.value)
        with pytest.raises(rm.RobomillError) as caught:
            rm.load_setup("paper_flute").replace(tolerance_mm=0.0003)
    assert str(caught.value) == "Set-up, Tolerance: found 0.0003 mm; expected at least 0.001 mm."


HUGE = 10**400, 10**5000
"""Larger than any float, and longer than Python writes out."""


@pytest.mark.parametrize("huge", HUGE, ids=["400 digits", "5000 digits"])
def test_a_whole_number_beyond_all_floats_is_refused_in_a_sentence(huge: int) -> None:
    flat = {"a_mm": [huge] * 2}
    calls: list[Callable[[], object]] = [
        lambda: rm.Cutter("flat", diameter=huge),
        lambda: rm.Cutter("flat", diameter_mm=huge),
        lambda: rm.Robot.from_dh(**flat),
        lambda: rm.Robot.from_dh(a_mm=[500, 400], limits_deg=(-huge, huge)),
        lambda: rm.Toolpath.from_points([[0, 0, huge], [0, 0, 0]], 0.02),
        lambda: rm.PathForce(feed_normal=huge),
        lambda: rm.pose_from_world([0, 0, huge, 0, 0]),
        lambda: rm.Grid(x_mm=huge, y_mm=0, z_mm=0),
    ]
    for call in calls:
        with pytest.raises(RobomillError) as refused:
            call()
        assert len(str(refused.value)) < 300
        assert "\n" not in str(refused.value)


def test_what_was_found_is_said_on_one_line() -> None:
    pd = pytest.importorskip("pandas")
    with pytest.raises(RobomillError) as refused:
        rm.Cutter("flat", diameter=pd.Series([0.008]))
    assert "\n" not in str(refused.value)


def test_a_share_above_one_is_refused_without_words_of_units() -> None:
    with pytest.raises(RobomillError, match="^Spread, Compliance: found 10; expected 0 to 1, or left out.$"):
        rm.Spread(compliance=10)


def test_a_sign_is_not_lost_on_the_way_to_a_refusal() -> None:
    with pytest.raises(RobomillError, match="found -0.0001 mm"):
        rm.load_setup("paper_flute").replace(tolerance_mm=-0.0001)


def test_places_in_mm_under_a_name_of_m_are_refused() -> None:
    with pytest.raises(RobomillError, match="tool frame: found 0.16 mm.* If 0.16 m is meant, give tool_xyz"):
        rm.Robot.from_dh(a_mm=[500, 400], tool_xyz_mm=[0, 0, 0.16])
    assert rm.Robot.from_dh(a_mm=[500, 400], tool_xyz_mm=[0, 0, 1.6]).T_tool[2, 3] == 0.0016


@pytest.mark.parametrize(
    ("slip", "words"),
    [
        (lambda: rm.Stock(lower_mm=[-0.05, -0.02, -0.01], upper_mm=[0.05, 0.02, 0]), "was it meant in m"),
        (lambda: rm.Cutter("flat", diameter_mm=8000), "expected 0.001 mm to 2000 mm"),
        (lambda: rm.TableTool(1, length=80), "give length=0.08 or length_mm=80"),
        (lambda: rm.TableTool(1, 8), "Tool 1, cutter: expected a Cutter, found 8"),
        (lambda: rm.GCodeSource(1), "Program, text: expected a text, found 1"),
        (lambda: rm.GCodeSource("G1 X1", name=5), r"Program, name: expected a text, found 5\.$"),
        (lambda: rm.SketchSource([]), "sketch: expected a Sketch"),
        (lambda: rm.LayerCut("slots", depth_mm=2, feed_mm_min=1e9), "mm/min"),
        (lambda: rm.LinesSource([[0, 0, 0]], [[0.05, 0, 0]], feed_mm_min=[1e9]), "600.000 mm/min"),
        (lambda: rm.Sketch(spindle_1_min=0.2), "n_s=0.2 or spindle_1_min=12"),
    ],
)
def test_a_slip_of_unit_or_kind_is_told_where_it_is_given(slip, words: str) -> None:
    with pytest.raises(rm.RobomillError, match=words):
        slip()


def test_a_spindle_as_soft_as_its_stiffness_is_a_doubt_beside_the_result() -> None:
    """20 N/µm under um/N: a newton would move the tool by 20 µm."""
    setup = rm.load_setup("paper_flute").replace(step=20e-3)
    for value, doubts in ((20.0, 1), (0.05, 0)):
        run = rm.simulate(setup.replace(springs=[rm.SpindleSpring(lateral_um_N=value)]))
        assert sum("in N/µm" in note.sentence for note in run.notes) == doubts


def test_the_bending_of_another_tool_is_a_doubt_beside_the_result() -> None:
    setup = rm.load_setup("paper_flute").replace(step=20e-3, springs=[rm.ToolBending(diameter_mm=8, stick_out_mm=40)])
    for cutter, doubts in ((4, 1), (8, 0), (10, 0)):
        run = rm.simulate(setup.replace(cutter=rm.Cutter("flat", diameter_mm=cutter, flutes=3)))
        assert sum("is it of another" in note.sentence for note in run.notes) == doubts
        assert [each.value[:13] for each in run.assumed if each.what == "spring tool bending"] == ["Diameter 8 mm"]


@pytest.mark.parametrize(
    ("slip", "words"),
    [
        (lambda: rm.tool_pose(ARM, [0.1j] * 5), "expected numbers, found 0.1j"),
        (lambda: rm.cartesian_compliance(ARM, np.zeros(5) * 1j), "expected numbers, found"),
        (lambda: rm.Cutter("flat", diameter_mm=True), "expected a number, found True"),
        (lambda: rm.Stock(lower_mm=[0, 0, 1j], upper_mm=[1, 1, 1]), "expected a number, found 1j"),
        (lambda: rm.pose_from_world([0, -1.3, 0, 20, 0]), "Pose, A: found 20 rad, .* give A=0.34907"),
        (lambda: rm.pose_from_world([[0, -1.3, 0, 0, 0], [0, -1.3, 0, 0, -30]]), "Pose, B: found -30 rad"),
        (lambda: rm.compliance_map(ARM, rm.Grid(x_mm=0, y_mm=-1300, z_mm=0), 0, 20), "Pose, B: found 20 rad"),
    ],
)
def test_what_is_no_number_and_tilts_in_degrees_are_told(slip, words: str) -> None:
    with pytest.raises(rm.RobomillError, match=words):
        slip()


def test_tilts_of_half_and_quarter_turns_are_poses() -> None:
    assert rm.pose_from_world([0, -1.3, 0, np.pi, -np.pi / 2]).shape == (4, 4)
    assert rm.pose_from_world(np.empty((0, 5))).shape == (0, 4, 4)


ARM = rm.load_robot("slavkovic_5r")


def test_reports_of_one_pose_are_equal_and_show_themselves_in_a_notebook() -> None:
    one, two = rm.at_pose(ARM, np.zeros(5)), rm.at_pose(ARM, np.zeros(5))
    assert one == two == copy.deepcopy(one) == pickle.loads(pickle.dumps(one))
    assert one != rm.at_pose(ARM, np.full(5, 0.1))
    assert "C_yy" in one._repr_html_()
    assert "not reached" in rm.at_pose(ARM, np.full(5, np.nan))._repr_html_()


def test_the_base_that_is_assumed_stands_among_what_a_run_rests_on() -> None:
    setup = rm.load_setup("paper_flute").replace(robot=rm.load_robot("kuka_kr270"), part_zero_mm=[1700, 0, 800])
    assert "base frame" in [each.what for each in rm.simulate(setup.replace(step=20e-3)).assumed]


A, B = [0.0, 0.0, -2.0], [40.0, 0.0, -2.0]


@pytest.mark.parametrize(
    "made",
    [
        lambda v: rm.Toolpath.from_points(p_mm=[v(A), v(B)], feed_mm_min=1800),
        lambda v: rm.Toolpath.from_points(p_mm=(v(A), v(B)), feed_mm_min=1800),
        lambda v: rm.LinesSource(start_mm=[v(A)], end_mm=[v(B)], feed_mm_min=[1800]),
        lambda v: rm.Element("line", points_mm=[v(A[:2]), v(B[:2])], depth_mm=2, feed_mm_min=1200),
        lambda v: rm.LinkMasses(mass_kg=[1.0] * 5, centre_mm=[v(A)] * 5),
        lambda v: rm.Stock(lower_mm=[v(-9), v(-9), v(-5)], upper_mm=v([9, 9, 0])),
    ],
)
def test_numbers_may_stand_in_arrays_within_a_list(made) -> None:
    """Who builds a path point by point has a list of vectors."""
    assert made(np.array) == made(lambda value: value)
