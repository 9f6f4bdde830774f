"""The paper, statement by statement."""

from __future__ import annotations

import robomill as rm
from generators.validation.check import ValidationError
from robomill.io.materials import sample_materials
from robomill.io.samples import samples_dir
from robomill.report.reproduction import reproduction
from robomill.report.reproduction_row import WORDS, Evidence, Row, summary

PAPER_ARM = "slavkovic_5r"


def rows() -> str:
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml")
    robot = rm.load_robot(PAPER_ARM)
    files = samples_dir() / "load_tests"
    nine, single = (
        rm.identify(robot, rm.read_load_tests(files / name)) for name in ("nine_points.csv", "one_joint_at_a_time.csv")
    )
    other = setup.replace(robot=setup.robot.with_compliance_set("table_3"))
    evidence = Evidence(robot, rm.simulate(setup), rm.simulate(other), nine, single, tuple(sample_materials()))
    found = reproduction(evidence)
    lost = [row.statement.where for row in found if not row.holds]
    if lost:
        raise ValidationError(f"Statements of the paper that do not hold: {lost}.")
    head = "| where | the paper | robomill | that is | why |\n|---|---|---|---|---|"
    return "\n".join([summary(found), "", head, *map(_paper_row, found)])


def _paper_row(row: Row) -> str:
    cells = (row.statement.where, row.statement.gives, row.found, WORDS[row.statement.status], row.reason)
    return "| " + " | ".join(cell.replace("|", "\\|").replace("$", "\\$") for cell in cells) + " |"
