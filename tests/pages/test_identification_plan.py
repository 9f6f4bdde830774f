"""What the identification page plans, and what its result does in the project: the next tests, bands, use and undo."""

from __future__ import annotations

import re

import numpy as np
import pytest
from conftest import number
from identification_page import click, opened, pick, typed
from streamlit.testing.v1 import AppTest

from robomill.compliance.springs.joint_bending import JointBending
from robomill.errors import LoadTestError, ProjectError
from robomill.identification.fit.estimate import identify
from robomill.identification.fit.models import Parameter
from robomill.identification.knowledge import Knowledge
from robomill.identification.load_test import LoadTests
from robomill.io.measured.load_test_sheets import load_test_template, load_tests_to_csv
from robomill.io.measured.load_tests import read_load_tests
from robomill.io.robot.robots import load_robot
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.provenance import Kind, Provenance
from robomill.simulation.run import simulate
from robomill.ui import session
from robomill.ui.bench import Bench, sample_text
from robomill.ui.identification import words
from robomill.ui.identification.inputs import adopted
from robomill.ui.judged import uncertainty
from robomill.ui.project import Project, project_from_toml, project_to_toml
from robomill.ui.session import KEY as PROJECT
from tests.identification.synthetic import simulated_tests


@pytest.fixture
def page() -> AppTest:
    """The identification page, opened first and run once."""
    return opened()


# ---- plan ----------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("goal", ["joint", "all", "path"])
def test_three_more_tests_shrink_joint_4_by_a_third(page: AppTest, goal: str) -> None:
    pick(page, "identification.view", "next")
    page.selectbox(key="identification.goal").set_value(goal).run()
    assert not page.exception
    said = next(m.value for m in page.markdown if "more tests should narrow" in m.value).replace("\u00a0", " ")
    if goal == "joint":
        assert "joint 4 by 83 %" in said
    if goal == "path":
        assert "the path's predicted deviation from" in said


def test_the_measuring_sheet_is_read_back_after_filling_in(page: AppTest) -> None:
    from robomill.identification.plan import box_candidates, next_best
    from robomill.io.measured.load_test_sheets import measuring_sheet

    robot = load_robot("slavkovic_5r")
    tests = read_load_tests(sample_text("nine_points"), robot)
    assert isinstance(tests, LoadTests)
    fit = identify(robot, tests)
    plan = next_best(robot, tests, fit, box_candidates(robot, np.array([-0.6, -1.6, 0]), np.array([0.6, -1, 0.1])))
    sheet = measuring_sheet(plan, "nine_points.csv")
    with pytest.raises(LoadTestError, match="the cell is empty"):
        read_load_tests(sheet, robot)
    filled = read_load_tests(sheet.replace(",,,", ",0.1,0.2,0.3\n").replace(",,", ",0.1,0.2,0.3"), robot)
    assert isinstance(filled, LoadTests)
    np.testing.assert_allclose(filled.theta, plan.theta, atol=1e-6)


def test_a_filled_sheet_joins_the_tests_and_narrows_joint_4(page: AppTest) -> None:
    """The loop closed: plan, measure (here: compute from Table 3), bring the sheet back."""
    from robomill.io.measured.load_test_sheets import measuring_sheet
    from robomill.ui.identification.bench import fit_of
    from robomill.ui.identification.plan import joined, plan_of

    robot = load_robot("slavkovic_5r")
    kept = Bench(goal="joint", goal_joint=4)
    before = fit_of(kept, robot)
    plan = plan_of(kept, robot, before)
    measured = simulated_tests(robot.with_compliance_set("table_3"), plan.theta, plan.F, noise=4e-6, seed=8)
    kept = kept.with_tests(*joined(kept, robot, load_tests_to_csv(measured), "sheet.csv"), robot.name)
    after = fit_of(kept, robot)
    widths = [float(np.ptp(fit.ci95[3])) for fit in (before, after)]
    assert widths[1] < 2 / 3 * widths[0], f"from {widths[0]:.3g} to {widths[1]:.3g} rad/(N m)"
    assert after.ci95[3, 0] <= 27.65e-7 <= after.ci95[3, 1]
    with pytest.raises(LoadTestError, match="the cell is empty"):
        joined(kept, robot, measuring_sheet(plan, "x"), "blank.csv")
    with pytest.raises(LoadTestError, match="bring both to the same columns"):
        joined(kept, robot, sample_text("grid_45x6"), "grid.csv")


@pytest.mark.parametrize("protocol", ["joints", "world", "joint by joint", "compliances"])
def test_every_template_says_what_is_missing_rather_than_breaking(page: AppTest, protocol: str) -> None:
    typed(page, load_test_template(protocol, 5))
    assert not page.exception


@pytest.mark.parametrize(
    ("key", "value"),
    [("identification.count", 0.0), ("identification.load:N", -5.0), ("identification.tilt:deg", 400.0)],
)
def test_a_refused_plan_number_stays_with_its_bounds(page: AppTest, key: str, value: float) -> None:
    pick(page, "identification.view", "next")
    number(page, key).set_value(value).run()
    assert not page.exception
    assert "expected" in page.error[0].value
    assert number(page, key).value == value


# ---- use in the project, and the band ------------------------------------------------------------------------------
def test_using_the_compliances_puts_them_and_their_band_in_force(page: AppTest) -> None:
    before = page.session_state[PROJECT].project.setup
    assert page.session_state[PROJECT].project.known is None
    click(page, "identification.use")
    assert not page.exception
    setup = page.session_state[PROJECT].project.setup
    fit = identify(load_robot("slavkovic_5r"), read_load_tests(sample_text("nine_points"), load_robot("slavkovic_5r")))
    np.testing.assert_allclose(setup.robot.C_theta, fit.C_theta, rtol=1e-12)
    assert setup.robot.compliance_set == "identified"
    assert setup.robot.provenance["compliance.identified"].kind == "synthetic"  # as the sample is
    assert "27 load tests (nine_points.csv)" in setup.robot.provenance["compliance.identified"].source
    known = page.session_state[PROJECT].project.known
    np.testing.assert_allclose(known.covariance, fit.covariance)
    assert page.button(key="identification.use").disabled
    page.button(key="undo").click().run()
    assert page.session_state[PROJECT].project.setup.digest() == before.digest()
    assert page.session_state[PROJECT].project.known is None, "undo takes the band along"
    assert not page.button(key="identification.use").disabled
    page.button(key="redo").click().run()
    again = page.session_state[PROJECT].project.known
    assert again is not None, "and redo brings it back"
    np.testing.assert_array_equal(again.covariance, known.covariance)


def test_springs_come_along_and_give_way_to_the_next_identification() -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    robot = setup.robot
    tests = read_load_tests(sample_text("tilted_bending_tool"), robot)
    rich = adopted(setup, robot, identify(robot, tests, "joints+bending+tool"), "a.csv")
    assert len(rich.springs) == 3
    again = adopted(rich, rich.robot, identify(robot, tests, "joints+bending+tool"), "b.csv")
    assert len(again.springs) == 3
    plain = adopted(rich, rich.robot, identify(robot, tests), "c.csv")
    assert plain.springs == ()


@pytest.mark.parametrize(
    ("kind", "before", "stays"), [("measured", False, True), ("measured", True, False), ("user", True, True)]
)
def test_a_spring_gives_way_only_where_an_earlier_identification_measured_it(
    kind: Kind, before: bool, stays: bool
) -> None:
    """One's own springs stay, and so does one that was measured before anything was identified here."""
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    robot = setup.robot
    fit = identify(robot, read_load_tests(sample_text("nine_points"), robot))
    spring = JointBending(3, 1e-7, 2e-7, provenance=Provenance(kind, "a source that says nothing"))
    start = (adopted(setup, robot, fit, "a.csv") if before else setup).replace(springs=(spring,))
    assert adopted(start, robot, fit, "b.csv").springs == ((spring,) if stays else ())


def test_bands_are_laid_into_the_path_plot_only_where_something_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    import streamlit as st

    from robomill.viz.theme import figure

    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    monkeypatch.setattr(st, "session_state", {PROJECT: session.Store(Project(setup))})
    fit = identify(setup.robot, read_load_tests(sample_text("nine_points"), setup.robot))
    used = adopted(setup, setup.robot, fit, "a.csv")
    result = simulate(used)
    fig = figure(dark=False, height=200)
    assert not uncertainty.banded(fig, result, "mm", dark=False)
    session.change(robot=used.robot, springs=used.springs)
    session.know(Knowledge.of(fit, setup.robot, "from 27 load tests"))
    assert uncertainty.banded(fig, result, "mm", dark=False)
    assert len(fig.traces) == 4
    assert uncertainty.band_caption(used) == "Shaded: 95 % band, from 27 load tests."
    assert session.known(used.replace(tolerance=1e-4)) is not None, "another tolerance changes no compliance"
    assert session.known(setup) is None


@pytest.mark.parametrize(("units", "joint_unit"), [("in", "kN m/rad"), ("in", "1e-7 rad/(N m)")])
def test_every_section_runs_in_every_unit(page: AppTest, units: str, joint_unit: str) -> None:
    pick(page, "view.units", units)
    page.selectbox(key="view.joint_unit").set_value(joint_unit).run()
    page.selectbox(key="identification.model").set_value("joints+bending+tool").run()
    for view in ("compliances", "residuals", "models", "next", "cut"):
        pick(page, "identification.view", view)
        assert not page.exception
    for section in ("map", "laboratory"):
        pick(page, "identification.section", section)
        assert not page.exception
        assert not page.error


def test_what_shifts_is_shown_in_the_pages_unit_and_joints_in_theirs() -> None:
    shift, joint = Parameter("entry", axis="xy"), Parameter("joint", 2)
    assert words.unit_of(shift, "kN m/rad", "mm") == "um/N"
    assert words.unit_of(shift, "kN m/rad", "in") == "uin/N"
    assert words.unit_of(joint, "kN m/rad", "in") == "kN m/rad"


def test_what_is_known_goes_through_the_project_file() -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    robot = setup.robot
    fit = identify(robot, read_load_tests(sample_text("tilted_bending_tool"), robot), "joints+bending")
    used = adopted(setup, robot, fit, "a.csv")
    known = Knowledge.of(fit, robot, "from 72 load tests").widened(robot, force=3.0, length=1e-3)
    project = Project(used, knowledge=known.held_by(used.robot, used.springs))
    text = project_to_toml(project)
    again = project_from_toml(text).known
    assert again is not None
    np.testing.assert_array_equal(again.covariance, known.covariance)
    np.testing.assert_array_equal(again.F, np.diag([9.0, 9.0, 9.0]))
    np.testing.assert_array_equal(again.lengths, np.full(2 * robot.rows, 1e-3))
    assert "[uncertainty]" not in project_to_toml(project.replace(setup=setup)), "known of other compliances"
    assert project_from_toml(project_to_toml(Project(used))).known is None
    for broken in ('model = "rubber"', "dof = []"):
        name = broken.partition(" ")[0]
        damaged = re.sub(rf"^{name} = .*$", broken, text[text.index("[uncertainty]") :], flags=re.M)
        with pytest.raises(ProjectError, match=r"\[uncertainty\]"):
            project_from_toml(text[: text.index("[uncertainty]")] + damaged)


@pytest.mark.parametrize(
    ("value", "half", "unit", "text"),
    [
        (2.3e-4, 2e-5, "mm", "0.23 ± 0.02 mm"),
        (2.916e-4, 1.3e-6, "mm", "0.292 ± 0.001 mm"),
        (2.9162e-4, 3e-7, "mm", "0.2916 ± 0.0003 mm"),
        (1.2e-3, 4e-4, "mm", "1.20 ± 0.40 mm"),
        (2.54e-4, 2.54e-5, "in", "0.0100 ± 0.0010 in"),
    ],
)
def test_digits_follow_the_half_width(value: float, half: float, unit: str, text: str) -> None:
    assert uncertainty.band_text(value, half, unit) == text


def test_without_an_identification_no_tile_has_a_band(page: AppTest) -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    assert uncertainty.tile_text(simulate(setup)) == ""
