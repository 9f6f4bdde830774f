"""What the paper's statements are held against: its test and robot, and the (synthetic) load tests, computed."""

from robomill.identification.fit.estimate import identify
from robomill.io.materials import sample_materials
from robomill.io.measured.load_tests import read_load_tests
from robomill.io.robot.robots import load_robot
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.report.reproduction_row import Evidence
from robomill.simulation.run import Simulate, simulate

TESTS = ("nine_points.csv", "one_joint_at_a_time.csv")


def evidence(run: Simulate = simulate) -> Evidence:
    """The evidence for ``reproduction``; ``run`` is what simulates a set-up and may keep results."""
    robot, setup = load_robot("slavkovic_5r"), load_setup("paper_flute")
    nine, single = (identify(robot, read_load_tests(samples_dir() / "load_tests" / name)) for name in TESTS)
    other = setup.replace(robot=setup.robot.with_compliance_set("table_3"))
    return Evidence(robot, run(setup), run(other), nine, single, tuple(sample_materials()))
