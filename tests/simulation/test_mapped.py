"""A measured map under a tool that leans otherwise: never used in silence. The truth is its own joint model's."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.compliance.cartesian import cartesian_compliance
from robomill.identification.measured_field import MeasuredField
from robomill.io.samples import samples_dir
from robomill.kinematics.inverse import inverse_kinematics
from robomill.kinematics.transforms import pose_from_world
from robomill.simulation.mapped import map_notes
from robomill.toolpath.source import GCodeSource

SETUP = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml").replace(cell=5e-4, step=5e-3)


def model_map(B: float = 0.0) -> MeasuredField:
    """C of the arm's own joints on a grid over the slot, with the tool tilted by B."""
    x, y, z = np.meshgrid([-0.06, 0.0, 0.06], [-1.32, -1.28], [-0.01, 0.02], indexing="ij")
    p = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    AB = np.tile([0.0, B], (len(p), 1))
    ik = inverse_kinematics(SETUP.robot, pose_from_world(np.hstack([p, AB])))
    assert ik.reached.all()
    return MeasuredField(p, cartesian_compliance(SETUP.robot, ik.theta), AB)


def leaning(degrees: float, field: MeasuredField | None):
    text = f"G21 G90 S12000 M3\nG0 X-40 Y0 Z5 B{degrees}\nG0 Z-2\nG1 X40 F1800\nM2\n"
    return rm.simulate(SETUP.replace(source=GCodeSource(text), measured_map=field))


def test_the_map_says_something_else_under_a_leaning_tool():
    """What goes wrong without the limit, so that the limit is known to matter."""
    truth = leaning(28.6, None)
    mid = len(truth.path) // 2
    upright = np.einsum("ij,j->i", model_map().compliance(SETUP.in_base(truth.path.p))[mid], truth.F[mid])
    assert abs(truth.delta[mid, 2] - upright[2]) > 15e-6


@pytest.mark.parametrize("degrees", [2.5, 28.6])
def test_beyond_the_limit_nothing_is_judged_and_it_is_said(degrees):
    run = leaning(degrees, model_map())
    cutting = run.path.cutting
    assert np.isnan(run.delta[cutting]).all()
    assert run.not_judged[cutting].all()
    assert run.verdict.level == "unjudged"
    assert run.verdict.red
    assert [reason.code for reason in run.unjudged] == ["map-axis"]


@pytest.mark.parametrize("B", [0.0, np.radians(28.6)])
def test_a_map_measured_at_this_axis_is_used(B):
    degrees = float(np.degrees(B))
    run, truth = leaning(degrees, model_map(B)), leaning(degrees, None)
    assert not run.unjudged
    cutting = run.path.cutting
    np.testing.assert_allclose(run.delta[cutting], truth.delta[cutting], rtol=0.03, atol=2e-6)


def test_a_little_off_is_used_and_said():
    run = leaning(1.0, model_map())
    truth = leaning(1.0, None)
    assert not run.not_judged.any()
    assert np.abs(run.delta - truth.delta)[run.judged].max() < 0.05 * truth.max_deviation
    assert any(note.code == "map-axis" and "1.0°" in note.message for note in run.notes)


TWO_TOOLS = GCodeSource(
    "G21 G90 S12000 M3\nT1 M6\nG0 X-40 Y-8 Z5\nG0 Z-2\nG1 X40 F1800\nG0 Z50\n"
    "T2 M6\nG0 X-40 Y8\nG0 Z-2\nG1 X40 F1200\nG0 Z50\nM2\n"
)


@pytest.mark.parametrize(("longer", "judged"), [(4e-3, True), (35e-3, False), (-35e-3, False)])
def test_a_map_does_not_hold_for_a_tool_of_another_length(longer, judged):
    """Tool 2 is longer than the one the map was taken with: what the arm then gives is its joints' give, turned one by
    one, at the tip that stands farther out. At 35 mm that is a tenth beside the map."""
    cutter = SETUP.cutter
    tools = rm.ToolTable((rm.TableTool(1, cutter, 60e-3), rm.TableTool(2, cutter, 60e-3 + longer)))
    run = rm.simulate(SETUP.replace(source=TWO_TOOLS, tools=tools, measured_map=model_map()))
    second = run.path.cutting & (run.path.tool == 2)
    i = int(np.flatnonzero(second)[np.argmin(np.abs(run.path.p[second, 0]))])
    out = np.eye(4)
    out[2, 3] = -longer
    arm = SETUP.robot.replace(T_tool=SETUP.robot.T_tool @ out)
    truth = by_turning_springs(arm, run.theta[i]) @ run.F[i]
    by_map = model_map().compliance(SETUP.in_base(run.path.p[i])) @ run.F[i]
    apart = np.linalg.norm(truth - by_map) / np.linalg.norm(truth)
    assert apart < 0.015 if judged else apart > 0.08
    assert run.not_judged[second].all() != judged
    assert not run.not_judged[run.path.cutting & (run.path.tool == 1)].any()
    if judged:
        assert run.delta[i] == pytest.approx(by_map, abs=1e-12)
        assert "map-tool" in [note.code for note in run.notes]
    else:
        assert [reason.code for reason in run.unjudged] == ["map-tool"]
        assert run.verdict.level == "unjudged"


@pytest.mark.parametrize(("height", "said"), [(5e-3, False), (40e-3, True)])
def test_a_map_of_one_plane_says_how_far_beside_it_the_cut_lies(height, said):
    whole = model_map()
    flat = whole.p[:, 2] < 0.0
    field = MeasuredField(whole.p[flat], whole.C[flat], whole.AB[flat])
    place = SETUP.T_MW.copy()
    place[2, 3] = field.p[0, 2] + 2e-3 + height  # the slot is 2 mm deep
    run = rm.simulate(SETUP.replace(T_MW=place, measured_map=field))
    notes = [note.message for note in run.notes if note.code == "map-plane"]
    assert bool(notes) == said
    assert not said or "40 mm" in notes[0]


def test_with_a_map_the_sag_is_still_that_of_the_joints_and_said_to_be():
    """A map twice as soft as the joints doubles what the force does and leaves the sag as it is."""
    links = rm.LinkMasses(np.full(5, 50.0), np.zeros((5, 3)))
    field = model_map()
    soft = MeasuredField(field.p, 2.0 * field.C, field.AB)
    setups = [SETUP.replace(measured_map=each, links=links, add_sag=True) for each in (field, soft)]
    stiff, other = (rm.simulate(setup) for setup in setups)
    cut = stiff.path.cutting
    sag = 2.0 * stiff.delta[cut] - other.delta[cut]
    np.testing.assert_allclose(sag, stiff.sag[cut].sum(axis=1), atol=1e-12)
    assert np.abs(sag).max() > 1e-4
    for setup, said in ((setups[0], True), (setups[0].replace(add_sag=False), False)):
        assert ("sag-by-joints" in [note.code for note in map_notes(setup, stiff.path)]) == said


def by_turning_springs(robot, theta):
    """(3, 3) m/N: each joint twisted in turn, by forward kinematics alone."""
    J = np.stack([(tip(robot, theta + 1e-6 * e) - tip(robot, theta - 1e-6 * e)) / 2e-6 for e in np.eye(robot.n)], -1)
    return (J * robot.C_theta) @ J.T


def tip(robot, theta):
    return rm.tool_pose(robot, theta)[:3, 3]


@pytest.mark.parametrize(("name", "matters"), [("fanuc_r2000ic", True), ("kuka_kr270", False)])
def test_a_map_says_that_it_holds_for_one_turn_about_the_tool_where_that_matters(name, matters):
    robot = rm.load_robot(name)
    x_M = np.array([1.8, 0.0, 0.9, 0.0, 0.0])
    ways = [inverse_kinematics(robot, pose_from_world(x_M), spin=turn).theta for turn in (0.0, np.pi * 1.5)]
    C = [by_turning_springs(robot, theta) for theta in ways]
    assert (np.abs(C[0] - C[1]).max() > 0.2 * np.abs(C[0]).max()) == matters
    field = MeasuredField(x_M[None, :3], C[0][None], np.zeros((1, 2)))
    setup = SETUP.replace(robot=robot, measured_map=field)
    assert ("map-spin" in [note.code for note in map_notes(setup, leaning(0.0, None).path)]) == matters


def test_a_map_of_the_upright_tool_is_a_third_of_the_deflection_under_a_tool_tilted_by_half_a_radian():
    """The reconstructed arm with the paper's Table 3, tip at (0, -1300, 0) mm, 100 N across the feed
    and the tool: 76 um along Z by each joint's own give, 24 um by what was measured upright there."""
    C_theta = np.array([9.03, 11.17, 14.74, 27.65, 97.58]) * 1e-7
    tilt, p = 0.5, np.array([0.0, -1.3, 0.0])
    F = 100.0 * np.array([0.0, np.cos(tilt), np.sin(tilt)])

    def z_by_turning_joints(A: float) -> float:
        """Every joint turned by what the force's moment about it gives, one after the other, through the arm itself."""
        theta = inverse_kinematics(SETUP.robot, pose_from_world(np.append(p, [A, 0.0]))).theta
        step, joints = 1e-6, np.eye(5)
        J = np.stack([(tip(theta + step * e) - tip(theta - step * e)) / (2 * step) for e in joints], axis=1)
        return float((tip(theta + C_theta * (J.T @ F) * 1e-3) - tip(theta))[2] * 1e3)

    def tip(theta):
        return rm.tool_pose(SETUP.robot, theta)[:3, 3]

    assert z_by_turning_joints(tilt) == pytest.approx(76e-6, abs=0.5e-6)
    assert z_by_turning_joints(0.0) == pytest.approx(24e-6, abs=0.5e-6)
    arm = SETUP.replace(robot=SETUP.robot.replace(C_theta=C_theta))
    text = f"G21 G90 S12000 M3\nG0 X-40 Y0 Z5 A{np.degrees(tilt)}\nG0 Z-2\nG1 X40 F1800\nM2\n"
    run = rm.simulate(arm.replace(source=GCodeSource(text)))
    middle = int(np.argmin(np.abs(run.path.p[:, 0]) + 1.0 * ~run.path.cutting))
    assert run.F[middle] == pytest.approx(F, abs=1e-9)
    assert run.delta[middle, 2] == pytest.approx(z_by_turning_joints(tilt), abs=0.2e-6)
