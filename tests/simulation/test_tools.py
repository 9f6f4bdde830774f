"""Several tools: each block with its own, its tip as far out as it is long, its springs its own; none is guessed."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.compliance.springs.tool_bending import ToolBending
from robomill.cutting.tool_table import TableTool, ToolTable
from robomill.errors import CuttingError, RobomillError, SetupError
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import setup_from_toml, setup_to_toml
from robomill.kinematics.forward import tool_pose
from robomill.simulation.run import simulate
from robomill.simulation.tools import cutting_numbers, farther, feed_notes, held, tool_notes, tooling
from robomill.toolpath.source import GCodeSource

SETUP = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(cell=5e-4, step=4e-3)
PROGRAM = GCodeSource(
    "G21 G90 S12000 M3\nT1 M6\nG0 X-40 Y-8 Z5\nG0 Z-2\nG1 X40 F1800\nG0 Z50\n"
    "T2 M6\nG0 X-40 Y8\nG0 Z-1\nG1 X40 F1200\nG0 Z50\nM2\n"
)
SMALL, LARGE = SETUP.cutter, SETUP.cutter.replace(diameter=12e-3, flutes=4)
TABLE = ToolTable((TableTool(1, SMALL, 60e-3), TableTool(2, LARGE, 95e-3)))


def test_a_program_with_two_tools_asks_for_a_table_by_their_numbers():
    with pytest.raises(SetupError, match=r"T1, T2.*tool table"):
        simulate(SETUP.replace(source=PROGRAM))
    with pytest.raises(RobomillError, match="ool 2 .*is not in the tool table"):
        simulate(SETUP.replace(source=PROGRAM, tools=ToolTable((TableTool(1, SMALL),))))
    with pytest.raises(CuttingError, match="Tool 2 cuts, but the tool table does not say its diameter"):
        simulate(SETUP.replace(source=PROGRAM, tools=ToolTable((TableTool(1, SMALL), TableTool(2)))))


def test_one_tool_by_its_number_or_by_none_is_the_cutter():
    one = GCodeSource("G21 G90 S12000 M3\nT7 M6\nG0 X-40 Y0 Z5\nG0 Z-2\nG1 X40 F1800\nM2\n")
    assert simulate(SETUP.replace(source=one)).tooling.cutters == (SMALL,)
    tabled = simulate(SETUP.replace(source=one, tools=ToolTable((TableTool(7, LARGE, 0.2),))))
    assert tabled.tooling.cutters == (LARGE,)
    plain = simulate(SETUP.replace(source=one, cutter=LARGE))
    np.testing.assert_array_equal(tabled.delta, plain.delta)
    np.testing.assert_array_equal(tabled.machined.z, plain.machined.z)


def test_each_step_has_the_tool_of_its_block():
    path = SETUP.replace(source=PROGRAM).toolpath
    assert cutting_numbers(path).tolist() == [1, 2]
    made = tooling(SETUP.replace(source=PROGRAM, tools=TABLE), path)
    for n, cutting, index in zip(path.tool, path.cutting, made.of_step, strict=True):
        if cutting:
            assert made.cutters[index] == {1: SMALL, 2: LARGE}[int(n)]
    beyond = farther(SETUP.replace(source=PROGRAM, tools=TABLE), path)
    assert beyond[path.tool == 2] == pytest.approx(35e-3)
    assert not beyond[path.tool == 1].any()


def test_no_tool_is_farther_than_a_first_one_whose_length_is_not_told():
    first_by_hand = GCodeSource(PROGRAM.text.replace("T1 M6\n", ""))
    setup = SETUP.replace(source=first_by_hand, tools=TABLE)
    path = setup.toolpath
    assert cutting_numbers(path).tolist() == [0, 2]
    assert not farther(setup, path).any()


def test_a_set_up_with_tools_comes_back_from_its_file():
    setup = SETUP.replace(source=PROGRAM, tools=TABLE)
    again = setup_from_toml(setup_to_toml(setup))
    assert again.digest() == setup.digest()
    assert again.tools[2].cutter.diameter == pytest.approx(12e-3)
    text = setup_to_toml(setup)
    without = text[: text.index("[cutter]")] + text[text.index("[force]") :]
    assert setup_from_toml(without).cutter == SMALL


def test_a_longer_tool_bends_more_and_the_arm_holds_it_farther_back():
    long = ToolTable((TableTool(1, SMALL, 60e-3), TableTool(2, LARGE, 95e-3)))
    spring = ToolBending(SMALL.diameter, 30e-3)
    run = simulate(SETUP.replace(source=PROGRAM, tools=long, springs=(spring,)))
    first, second = (run.path.cutting & (run.path.tool == n) for n in (1, 2))
    robot = run.setup.robot
    told = run.setup.in_base(run.path.p)
    reached = tool_pose(robot, run.theta)[:, :3, 3]
    np.testing.assert_allclose(reached[first], told[first], atol=1e-9)
    np.testing.assert_allclose(reached[second], told[second] + [0, 0, 35e-3], atol=1e-9)
    # An arm whose own tool is 35 mm longer, at the same point: the truth of the second tool.
    T_tool = robot.T_tool.copy()
    T_tool[:3, 3] -= 35e-3 * T_tool[:3, 2]
    only = GCodeSource(PROGRAM.text.replace("G1 X40 F1800", "G0 X40"))
    bent = ToolBending(LARGE.diameter, 65e-3)
    alone = simulate(SETUP.replace(source=only, robot=robot.replace(T_tool=T_tool), cutter=LARGE, springs=(bent,)))
    np.testing.assert_allclose(run.delta[second], alone.delta[alone.path.cutting], rtol=1e-9)
    np.testing.assert_allclose(run.delta_spring[second], alone.delta_spring[alone.path.cutting], rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(run.delta_joint[second], alone.delta_joint[alone.path.cutting], rtol=1e-9, atol=1e-15)
    assert "tool-frame" in {note.code for note in run.notes}


def test_the_weight_at_the_last_joint_stays_where_it_is_with_a_longer_tool():
    """On a tilted part, by potential energy: the torque about a joint is what the height of all masses falls by as it
    turns, and the tip that it lowers is that of the tool in hand. The masses stand in the frames of the first tool."""
    mass, centre = np.array([300.0, 150.0, 80.0, 40.0, 60.0]), np.zeros((5, 3))
    centre[1, 0], centre[4, 2] = -0.6, 0.15
    T_MW = SETUP.T_MW @ rm.pose_from_world([0.0, 0.0, 0.0, 0.5, 0.2])
    setup = SETUP.replace(source=PROGRAM, tools=TABLE, T_MW=T_MW, links=rm.LinkMasses(mass, centre))
    run = simulate(setup)
    robot, step = setup.robot, 1e-5 * np.eye(5)

    def energy(theta):
        after = rm.joint_frames(robot, theta)[1:]
        return 9.80665 * sum(m * (T @ np.append(c, 1.0))[2] for m, c, T in zip(mass, centre, after, strict=True))

    for number, longer in ((1, 0.0), (2, 35e-3)):
        theta = run.theta[np.flatnonzero(run.path.cutting & (run.path.tool == number))[3]]
        tip = [[0.0, 0.0, -longer, 1.0] @ rm.tool_pose(robot, theta + k * e).T for e in step for k in (1, -1)]
        J = (np.array(tip[::2]) - np.array(tip[1::2]))[:, :3] / 2e-5
        tau = np.array([energy(theta - e) - energy(theta + e) for e in step]) / 2e-5
        truth = J * (robot.C_theta * tau)[:, None]
        sag = run.sag[np.flatnonzero((run.theta == theta).all(axis=1))[0]]
        np.testing.assert_allclose(sag, truth, atol=1e-6 * np.abs(truth).max())


CROSS = GCodeSource(
    "G21 G90 S12000 M3\nT1 M6\nG0 X-60 Y0 Z5\nG0 Z-2\nG1 X70 F1800\nG0 Z50\n"
    "T2 M6\nG0 X5 Y-40\nG0 Z-1\nG1 Y40 F1200\nG0 Z50\nM2\n"
)


def test_surfaces_are_cut_with_each_tool():
    """Two slots that cross, 8 mm wide and 2 mm deep, 12 mm wide and 1 mm deep: volumes, floors and walls by hand."""
    still = SETUP.robot.replace(C_theta=np.zeros(5))
    run = simulate(SETUP.replace(source=CROSS, tools=TABLE, robot=still, cell=1e-4))
    low, high = SETUP.stock.lower, SETUP.stock.upper
    length, width = high[0] - low[0], high[1] - low[1]
    volume = length * 8e-3 * 2e-3 + width * 12e-3 * 1e-3 - 8e-3 * 12e-3 * 1e-3
    assert run.machined.removed_volume == pytest.approx(volume, rel=1e-3)
    z, x, y = run.machined.z, run.machined.x, run.machined.y
    along, across = np.abs(y) < 3.9e-3, np.abs(x - 5e-3) < 5.9e-3
    np.testing.assert_allclose(z[:, along], -2e-3, atol=1e-12)
    np.testing.assert_allclose(z[np.ix_(across, np.abs(y) > 4.1e-3)], -1e-3, atol=1e-12)
    assert (z[np.ix_(np.abs(x - 5e-3) > 6.1e-3, np.abs(y) > 4.1e-3)] == 0.0).all()
    first, second = run.groove(20e-3), run.groove(float(run.path.s[-1]) - 30e-3)
    assert (first.width, second.width) == pytest.approx((8e-3, 12e-3), abs=1e-6)


def test_each_wall_is_judged_at_the_radius_of_its_tool():
    run = simulate(SETUP.replace(source=CROSS, tools=TABLE, step=1e-3))
    found = run.verdict
    assert found.wall.worst >= 0
    walls = run.gauge.walls
    second = run.path.tool[walls.sample] == 2
    assert second.any()
    assert not second.all()
    d = np.abs(run.delta_in_cut[walls.sample, 1])
    straight = np.abs(run.path.p[walls.sample, 0] - 5e-3) > 12e-3
    np.testing.assert_allclose(np.abs(walls.error)[straight & ~second], d[straight & ~second], atol=2e-6)


def test_every_step_is_made_by_one_tool():
    """Cutters and lengths may be shared: each step is held once, by an arm as much longer as its tool is."""
    text = "G21 G90 S12000 M3\n" + "".join(
        f"T{n} M6\nG0 X-40 Y{4 * n} Z5\nG0 Z-1\nG1 X40 F1800\nG0 Z50\n" for n in (1, 2, 3, 4)
    )
    lengths = {1: 60e-3, 2: 95e-3, 3: 60e-3, 4: 80e-3}
    table = ToolTable(tuple(TableTool(n, SMALL if n < 3 else LARGE, length) for n, length in lengths.items()))
    setup = SETUP.replace(source=GCodeSource(text + "M2\n"), tools=table)
    path = setup.toolpath
    made = list(held(setup, path))
    assert np.sum([each.steps for each in made], axis=0).tolist() == [1] * len(path)
    for n, length in lengths.items():
        (mine,) = (each for each in made if each.steps[path.cutting & (path.tool == n)].all())
        shift = SETUP.robot.T_tool[:3, 3] - mine.robot.T_tool[:3, 3]
        np.testing.assert_allclose(shift, (length - 60e-3) * SETUP.robot.T_tool[:3, 2], atol=1e-15)


def test_springs_are_those_of_the_first_tool_as_they_are_stated():
    """A stated shank may be slimmer than its cutter: the first tool keeps it, however many others the program has; the
    others have their own diameter, and stick out as much more as they are longer."""
    slim = ToolBending(0.6 * SMALL.diameter, 30e-3)
    setup = SETUP.replace(source=PROGRAM, tools=TABLE, springs=(slim,))
    first, second = (
        next(each for each in held(setup, setup.toolpath) if each.steps[setup.toolpath.cutting & mine].all())
        for mine in (setup.toolpath.tool == 1, setup.toolpath.tool == 2)
    )
    assert first.springs == (slim,)
    assert second.springs == (ToolBending(LARGE.diameter, 30e-3 + 35e-3),)
    assert first.robot is setup.robot


@pytest.mark.parametrize("length", [60e-3, 95e-3, 40e-3])
def test_what_is_stated_at_the_tip_is_not_known_at_the_tip_of_another_length(length):
    """A spindle's bearings turn the tool a little: how far its tip goes depends on how far out it is."""
    tools = ToolTable((TableTool(1, SMALL, 60e-3), TableTool(2, LARGE, length)))
    for spring, at_tip in ((rm.SpindleSpring(5e-8, 2e-8), True), (ToolBending(SMALL.diameter, 30e-3), False)):
        setup = SETUP.replace(source=PROGRAM, tools=tools, springs=(spring,))
        codes = {note.code for note in tool_notes(setup, setup.toolpath)}
        assert ("spring-at-tip" in codes) == (at_tip and length != 60e-3)


def test_no_tool_cuts_higher_than_it_sticks_out():
    """Where nobody states its flutes they end at its holder, which rubs on what stands higher; and a holder that goes
    under the top of the part is named though the cut itself is shallow."""
    short = SMALL.replace(stick_out=5e-3, flute_length=None)
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml").replace(cell=5e-4, step=4e-3)

    def run(cutter, *depths):
        lines = "".join(f"G0 X-80 Y0\nG0 Z{z}\nG1 X80 F1800\nG0 Z5\n" for z in depths)
        return simulate(setup.replace(source=GCodeSource(f"G21 G90 S12000 M3\nG0 Z5\n{lines}M2\n"), cutter=cutter))

    def codes(result):
        return {each.code for each in result.notes} & {"beyond-flutes", "holder"}

    deep = run(short, -6)
    assert deep.not_judged[deep.conditions.engaged].all()
    assert codes(deep) == {"beyond-flutes", "holder"}
    shallow = run(short, -3, -6)
    assert not shallow.not_judged.any()
    assert codes(shallow) == {"holder"}
    for fits in (run(short, -4), run(SMALL.replace(stick_out=7e-3), -6), run(SMALL.replace(stick_out=None), -6)):
        assert not fits.not_judged.any()
        assert codes(fits) == set()


def test_only_what_cuts_over_the_part_meets_it_with_its_holder():
    """6 mm deep with 5 mm out of the holder: beside the block at feed, and above it in a rapid, nothing is met."""
    short = SMALL.replace(stick_out=5e-3, flute_length=None)
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup_process.toml").replace(cell=5e-4, step=4e-3)
    beside = 1e3 * setup.stock_block.upper[1] + 30.0

    def warned(*lines):
        text = "\n".join(["G21 G90 S12000 M3 F1800", "G0 X-80 Y0 Z5", "G0 Z-2", "G1 X80", *lines, "G0 Z5", "M2", ""])
        given = setup.replace(source=GCodeSource(text), cutter=short)
        return [each.line for each in tool_notes(given, given.toolpath) if each.code == "holder"]

    assert warned("G0 Z5", f"G0 X-80 Y{beside}", "G0 Z-6", "G1 X0", "G1 X80") == []
    assert warned("G0 X0", "G0 Z-6", "G0 X10") == []
    assert warned("G0 Z5", "G0 X-80", "G0 Z-6", "G1 X0", "G1 X80") == [8]


@pytest.mark.parametrize(
    ("words", "line", "count", "said"),
    [
        ("S12000 M3\nG1 X0 F4500000\nG1 X20 F1800", 3, 1, "375.0 mm a revolution"),
        ("S12000 M3\nG1 X0 F144001\nG1 X20 F150000", 4, 2, "12.5 mm a revolution"),
        ("S12000 M3\nG1 X0 F143999", 0, 0, ""),
        ("\nG1 X0 F59000\nG1 X20 F61000", 4, 1, "check F"),
    ],
)
def test_a_feed_that_no_cutter_takes_is_a_warning_with_its_line(words, line, count, said):
    """Three teeth of 4 mm radius: 12 mm a revolution, 144 000 mm/min at 12 000 min^-1; without a speed 1 m/s."""
    setup = SETUP.replace(source=GCodeSource(f"G21 G90\n{words}\nM2\n".replace("G90\n", "G90 G0 X-20 Y0 Z-2 ")))
    found = feed_notes(setup, setup.toolpath)
    assert [(f.line, f.count, f.level) for f in found] == ([(line - 1, count, "warning")] if count else [])
    assert all(said in f.message for f in found)
