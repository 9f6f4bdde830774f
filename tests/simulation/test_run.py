"""One run end to end: the paper's numbers, the limits of the model, and paths that cannot be reached."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.compliance.cartesian import cartesian_compliance
from robomill.cutting.forces.along_path import PathForce
from robomill.cutting.forces.constant import ConstantForce
from robomill.errors import SurfaceError, ToolpathError
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.kinematics.forward import tool_pose
from robomill.simulation.given import part_frame
from robomill.simulation.run import simulate
from robomill.toolpath.source import GCodeSource, LinesSource


@pytest.fixture(scope="module")
def setup():
    return load_setup(samples_dir() / "paper_flute")


@pytest.fixture(scope="module")
def result(setup):
    return simulate(setup)


def middle(result) -> int:
    return int(np.argmin(np.abs(result.path.s - 0.5 * result.path.s[-1])))


@pytest.mark.parametrize(("table", "y", "z"), [("table_2", 0.2295e-3, -0.1024e-3), ("table_3", 0.2644e-3, -0.1227e-3)])
def test_the_papers_deviation_at_mid_slot(setup, table: str, y: float, z: float) -> None:
    run = simulate(setup.replace(robot=setup.robot.with_compliance_set(table)))
    delta = run.delta[middle(run)]
    assert delta[1] == pytest.approx(y, abs=0.5e-6)
    assert delta[2] == pytest.approx(z, abs=0.5e-6)
    section = run.groove(0.5 * run.path.s[-1])
    assert section.centre_offset == pytest.approx(delta[1], abs=5e-6)
    assert section.floor_error == pytest.approx(delta[2], abs=1e-6)


def test_joint_shares_sum_to_the_deflection(result) -> None:
    shares = result.delta_joint[middle(result)]
    assert shares[2, 1] == pytest.approx(0.1473e-3, abs=0.5e-7)
    assert shares[4, 1] == pytest.approx(0.0822e-3, abs=0.5e-7)
    assert np.abs(shares[[0, 1, 3], 1]).max() < 1e-6
    assert result.delta_joint.sum(axis=1) == pytest.approx(result.delta, abs=1e-15)


def test_deflection_is_compliance_times_force_at_the_joints_of_the_path(result) -> None:
    setup = result.setup
    C = cartesian_compliance(setup.robot, result.theta)
    assert np.einsum("mij,mj->mi", C, result.F) == pytest.approx(result.delta, abs=1e-15)
    p_M = result.path.p @ setup.T_MW[:3, :3].T + setup.T_MW[:3, 3]
    assert tool_pose(setup.robot, result.theta)[:, :3, 3] == pytest.approx(p_M, abs=1e-9)


def test_no_force_on_rapids(result) -> None:
    assert (result.F[~result.path.cutting] == 0).all()
    assert result.F[result.path.cutting] == pytest.approx(
        np.tile([0.0, 100.0, 0.0], (int(result.path.cutting.sum()), 1))
    )


def test_feed_normal_is_left_of_the_feed_in_every_direction(setup) -> None:
    rim = 0.02 * np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]])
    lines = LinesSource(np.zeros((4, 3)), rim, [0.03] * 4)
    run = simulate(setup.replace(source=lines, force=PathForce(feed_normal=100.0), T_MW=part_frame([0, -1.3, 0], 0.5)))
    for row, direction in enumerate(rim, start=1):
        F = run.F[run.path.cutting & (run.path.block == row)]
        left = run.setup.T_MW[:3, :3] @ np.cross([0, 0, 1], direction / 0.02)
        assert F == pytest.approx(np.tile(100 * left, (len(F), 1)), abs=1e-9)


def test_turning_part_and_base_together_turns_the_answer(setup) -> None:
    """The first joint's axis is z_M, so turning the part about it turns the deflection."""
    turned = setup.T_MW.copy()
    R = part_frame([0, 0, 0], 0.3)
    run = simulate(setup.replace(T_MW=R @ turned))
    assert run.delta == pytest.approx(simulate(setup).delta @ R[:3, :3].T, abs=1e-12)


def test_a_stiff_robot_leaves_the_ideal_surface_to_the_bit(setup) -> None:
    run = simulate(setup.replace(robot=setup.robot.replace(C_theta=np.zeros(5))))
    assert np.array_equal(run.ideal.z, run.machined.z)
    assert run.max_deviation == 0.0
    assert run.verdict.level == "ok"


def test_verdicts(setup) -> None:
    """The wall decides: C_yy times 100 N, 0.2295 mm (the tip itself is 0.25 mm off, of which 0.10 mm lie along z)."""
    levels = {tol: simulate(setup.replace(tolerance=tol)).verdict for tol in (0.2e-3, 0.25e-3, 0.3e-3)}
    assert [v.level for v in levels.values()] == ["out", "tight", "ok"]
    assert [v.red for v in levels.values()] == [True, False, False]
    assert levels[0.3e-3].sentence == (
        "The groove is 0.23 mm off in Y and 0.10 mm too deep: within tolerance (77 % of it used)."
    )


def test_what_cannot_be_reached_is_counted_and_the_rest_is_shown(setup) -> None:
    far = GCodeSource("G21 G90 S12000 M3\nG0 X0 Y0 Z-2\nG1 X50 F1800\nG1 Y-3000\nM2\n")
    run = simulate(setup.replace(source=far, step=10e-3))
    assert 0 < run.reached.sum() < len(run.reached)
    assert np.isnan(run.delta[~run.reached]).all()
    assert np.isfinite(run.delta[run.reached]).all()
    assert run.verdict.level == "unreached"
    assert "line 4" in run.verdict.sentence
    assert np.isfinite(run.machined.z).all()
    assert run.ik.reason(int(np.flatnonzero(~run.reached)[0]))


def test_nothing_reached_at_all(setup) -> None:
    run = simulate(setup.replace(T_MW=part_frame([9.0, 0, 0])))
    assert run.worst == -1
    assert np.isnan(run.max_deviation)
    assert run.verdict.level == "unreached"


def test_a_program_without_a_cut_is_refused(setup) -> None:
    with pytest.raises(ToolpathError):
        simulate(setup.replace(source=GCodeSource("G21 G90\nG0 X5\nM2\n")))


def test_a_stock_that_is_never_touched_is_said(setup) -> None:
    away = setup.replace(stock=type(setup.stock)(lower=[1.0, 1.0, -0.1], upper=[1.1, 1.1, 0.0]))
    with pytest.raises(SurfaceError, match="never"):
        _ = simulate(away).machined


def test_too_fine_a_cell_is_refused_with_one_that_fits(setup) -> None:
    with pytest.raises(SurfaceError, match="million cells"):
        _ = simulate(setup.replace(cell=1e-6)).machined


def test_a_constant_vector_pushes_the_same_way_on_every_cut(setup) -> None:
    run = simulate(setup.replace(force=ConstantForce(np.array([1.0, 2.0, 3.0]))))
    assert (run.F[run.path.cutting] == [1.0, 2.0, 3.0]).all()


def test_halving_the_step_moves_no_answer(setup) -> None:
    coarse, fine = simulate(setup), simulate(setup.replace(step=0.5e-3))
    assert fine.max_deviation == pytest.approx(coarse.max_deviation, rel=1e-6)
    assert fine.rms_deviation == pytest.approx(coarse.rms_deviation, rel=1e-4)


def test_a_measured_map_replaces_the_joint_model_and_says_where_it_ends(setup) -> None:
    mapped = load_setup(samples_dir() / "paper_flute" / "setup_measured_map.toml")
    run = simulate(mapped)
    p_M = run.path.p[run.judged] @ mapped.T_MW[:3, :3].T + mapped.T_MW[:3, 3]
    expected = np.einsum("mij,mj->mi", mapped.measured_map.compliance(p_M), run.F[run.judged])
    assert run.delta[run.judged] == pytest.approx(expected, abs=1e-15)
    outside = simulate(mapped.replace(T_MW=part_frame([0.58, -1.3, 0.002])))
    assert outside.reached.all()
    assert 0 < outside.judged.sum() < outside.path.cutting.sum()
    assert "lie outside the measured map" in outside.verdict.sentence
    assert np.isnan(outside.delta[outside.path.cutting & ~outside.answered]).all()


def test_a_rapid_through_the_part_is_said_with_its_line(setup, result) -> None:
    assert result.surface_notes == ()
    rash = setup.source.text.replace("N60 G0 Z20", "N60 G0 X0 Y15")
    run = simulate(setup.replace(source=GCodeSource(rash)))
    (note,) = run.surface_notes
    assert (note.code, note.line, note.level) == ("rapid-in-material", 8, "warning")


def test_cuts_in_air_do_not_win_the_verdict(setup) -> None:
    text = "G21 G90 S12000 M3\nG0 X-50 Y0 Z-2\nG1 X50 F1800\nG0 Z20\nG0 X60 Y400\nG0 Z-2\nG1 X-60\nM2\n"
    run = simulate(setup.replace(source=GCodeSource(text)))
    assert run.worst_block == 3
    assert not run.judged[run.path.block == 7].any()
    assert run.max_deviation == pytest.approx(simulate(setup).max_deviation, rel=1e-6)


def test_a_path_beside_the_stock_misses_it(setup) -> None:
    run = simulate(setup.replace(source=GCodeSource("G21 G90 S9000 M3\nG0 X0 Y90 Z-2\nG1 X50 F1800\nM2\n")))
    assert run.verdict.level == "missed"
    assert run.verdict.red
    assert "never touches the stock" in run.verdict.sentence


def test_a_plunge_is_not_pushed_by_a_force_stated_along_the_path(setup) -> None:
    """It says nothing of a way straight down: not known rather than 0."""
    text = "G21 G90 S12000 M3\nG0 X0 Y0 Z5\nG1 Z-2 F600\nG1 X40 F1800\nM2\n"
    force = PathForce(feed=-10.0, feed_normal=100.0, axial=-20.0)
    run = simulate(setup.replace(source=GCodeSource(text), force=force))
    plunge = run.path.cutting & (run.path.block == 3)
    inside = plunge & run.conditions.engaged
    assert inside.any()
    assert np.isnan(run.F[inside]).all()
    assert run.F[plunge & ~inside] == pytest.approx(np.tile([0.0, 0.0, -20.0], (int((plunge & ~inside).sum()), 1)))
    assert run.F[run.path.block == 4] == pytest.approx(
        np.tile([-10.0, 100.0, -20.0], (int((run.path.block == 4).sum()), 1)), abs=1e-9
    )


def test_with_engagement_a_stated_force_ends_with_the_material(setup) -> None:
    longer = GCodeSource(setup.source.text.replace("X-50", "X-60"))
    run = simulate(setup.replace(engagement=True, source=longer))
    in_air = run.path.cutting & (run.conditions.a_p == 0.0)
    assert in_air.any()
    assert (run.F[in_air] == 0.0).all()
    assert run.F[run.judged & (run.conditions.a_p > 0)][:, 1] == pytest.approx(100.0)
