"""Files that are written are read back to what they were written of; what is given the wrong way round is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import robomill as rm
from robomill.errors import ProjectError, RobomillError, RobotError, SurfaceError, ToolpathError

SETUP = rm.load_setup("samples/paper_flute")


def test_a_robot_comes_back_equal_as_toml_and_with_its_poses_as_urdf(tmp_path: Path) -> None:
    robot = SETUP.robot
    assert rm.load_robot(rm.write_robot(tmp_path / "arm.toml", robot)) == robot
    again = rm.load_robot(rm.write_robot(str(tmp_path / "arm.urdf"), robot), tip="tool0")
    theta = np.random.default_rng(0).uniform(-1, 1, (5, robot.n))
    np.testing.assert_allclose(rm.tool_pose(again, theta), rm.tool_pose(robot, theta), atol=1e-12)


def test_a_shorter_arm_is_read_up_to_another_link(tmp_path: Path) -> None:
    path = rm.write_robot(tmp_path / "arm.urdf", SETUP.robot)
    assert rm.load_robot(path, tip="link_3").n == 3
    with pytest.raises(RobotError, match="has no link 'gripper'"):
        rm.load_robot(path, tip="gripper")
    with pytest.raises(RobotError, match="only a URDF has links"):
        rm.load_robot(rm.write_robot(tmp_path / "arm.toml", SETUP.robot), tip="link_3")


def test_a_setup_comes_back_to_the_same_digest(tmp_path: Path) -> None:
    assert rm.load_setup(rm.write_setup(tmp_path / "mine.toml", SETUP)).digest() == SETUP.digest()


def test_a_program_comes_back_as_the_same_path(tmp_path: Path) -> None:
    path = rm.Toolpath.from_points(p_mm=[[0, 0, 5], [0, 0, -2], [60, 0, -2]], feed_mm_min=[0, 300, 1800])
    for units in ("mm", "in"):
        text = rm.write_gcode(tmp_path / "path.nc", path, units=units, title="mine").read_text()
        assert text.startswith("(mine)")
        again = rm.read_gcode(text)
        np.testing.assert_allclose(again.p[-3:], path.p, atol=1e-9)
        np.testing.assert_allclose(again.v_f[-3:], path.v_f, atol=1e-7)


def test_a_material_comes_back_equal(tmp_path: Path) -> None:
    row = rm.load_material("al7075_t6_carbide_ref190")
    assert rm.load_material(rm.write_material(tmp_path / "mine.toml", row)) == row


def test_a_part_is_written_as_stl_in_mm_as_large_as_is_asked(tmp_path: Path) -> None:
    part = rm.simulate(SETUP.replace(cell_mm=1.0)).machined
    path = rm.write_stl(tmp_path / "part.stl", part, max_faces=5_000)
    assert path.stat().st_size < 84 + 50 * 5_000 * 1.5
    again = rm.read_stock(path)
    np.testing.assert_allclose(again.size, SETUP.stock.size, atol=1e-6)


@pytest.mark.parametrize(
    ("write", "error"),
    [
        (lambda to: rm.write_robot(SETUP.robot, to), RobotError),
        (lambda to: rm.write_setup(to, SETUP.robot), ProjectError),
        (lambda to: rm.write_gcode(to, SETUP), ToolpathError),
        (lambda to: rm.write_stl(to, SETUP), SurfaceError),
    ],
)
def test_the_wrong_way_round_is_refused(write, error, tmp_path: Path) -> None:
    with pytest.raises(error, match="expected a file's name and then a"):
        write(tmp_path / "file")
    assert not list(tmp_path.iterdir())


def test_what_cannot_be_written_is_said(tmp_path: Path) -> None:
    with pytest.raises(RobotError, match="cannot be written"):
        rm.write_robot(tmp_path / "nowhere" / "arm.toml", SETUP.robot)


def test_a_solid_is_written_under_its_own_ending_and_never_uncut(tmp_path) -> None:
    """A run that reaches nothing leaves the stock as it was: written, it would pass for the part."""
    far = rm.simulate(rm.load_setup("paper_flute").replace(part_zero_mm=[0, -5000, 0]))
    with pytest.raises(SurfaceError, match=r"part\.stl: nothing is cut from this surface"):
        rm.write_stl(tmp_path / "part.stl", far.machined)
    with pytest.raises(SurfaceError, match=r"part\.obj: this is written as STL; give it a name that ends in \.stl"):
        rm.write_stl(tmp_path / "part.obj", far.machined)
    assert not list(tmp_path.iterdir())


def test_a_name_that_would_not_be_read_back_is_refused(tmp_path: Path) -> None:
    setup = rm.load_setup("paper_flute")
    row = rm.load_material("al7075_t6_carbide_ref190")
    for write, value, ends in (
        (rm.write_robot, setup.robot, ".toml or .urdf"),
        (rm.write_setup, setup, ".toml"),
        (rm.write_material, row, ".toml"),
        (rm.write_report, setup, ".html"),
    ):
        with pytest.raises(RobomillError, match=f"a name that ends in {ends}"):
            write(tmp_path / "arm.txt", value)
    for name in ("arm.toml", "PART.STL", "p.csv"):
        with pytest.raises(ToolpathError, match="a program is written there; give a name that ends in .nc"):
            rm.write_gcode(tmp_path / name, setup.toolpath)
    assert not list(tmp_path.iterdir())


def test_what_is_to_be_written_is_named_with_where_it_is_found(tmp_path: Path) -> None:
    setup = rm.load_setup("paper_flute")
    with pytest.raises(RobomillError, match=r"a Toolpath \(of a set-up: setup.toolpath\)"):
        rm.write_gcode(tmp_path / "part.nc", setup)
    assert rm.write_gcode(tmp_path / "part.nc", setup.toolpath).is_file()
    with pytest.raises(RobomillError, match=r"a ZMap \(of a run: result.machined or result.ideal\)"):
        rm.write_stl(tmp_path / "part.stl", setup)
