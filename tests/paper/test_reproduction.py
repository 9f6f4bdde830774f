"""The reproduction table: every row's check holds, and its numbers are those of independent formulas."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest

import robomill as rm
from robomill.io.materials import sample_materials
from robomill.io.samples import samples_dir
from robomill.report.reproduction import Evidence, reproduction
from robomill.report.reproduction_row import WORDS, Row, columns, summary
from robomill.units import to_si


@pytest.fixture(scope="module")
def evidence() -> Evidence:
    setup = rm.load_setup(samples_dir() / "paper_flute" / "setup.toml")
    robot = rm.load_robot("slavkovic_5r")
    folder = samples_dir() / "load_tests"
    nine, single = (
        rm.identify(robot, rm.read_load_tests(folder / name)) for name in ("nine_points.csv", "one_joint_at_a_time.csv")
    )
    other = setup.replace(robot=setup.robot.with_compliance_set("table_3"))
    return Evidence(robot, rm.simulate(setup), rm.simulate(other), nine, single, tuple(sample_materials()))


@pytest.fixture(scope="module")
def rows(evidence: Evidence) -> dict[str, Row]:
    return {row.item: row for row in reproduction(evidence)}


def numbers(text: str) -> list[float]:
    return [float(n.replace("−", "-")) for n in re.findall(r"−?\d+\.?\d*", text)]


def test_every_check_holds(rows: dict[str, Row]) -> None:
    assert [item for item, row in rows.items() if not row.holds] == []


@pytest.mark.parametrize("number", [*range(1, 4)])
def test_every_table_is_there(rows: dict[str, Row], number: int) -> None:
    assert any(re.search(rf"Table {number}\b", item) for item in rows)


@pytest.mark.parametrize("number", [*range(1, 17)])
def test_every_figure_is_there(rows: dict[str, Row], number: int) -> None:
    named = " ".join(rows)
    figures = {int(n) for group in re.findall(r"Figs?\. ([\d, ]+)", named) for n in re.findall(r"\d+", group)}
    assert number in figures


def test_a_gap_gives_its_reason(rows: dict[str, Row]) -> None:
    for row in rows.values():
        assert row.reason.endswith(".")
        if row.status == "gap":
            assert re.search(r"not printed|measured", row.reason), row.item


def test_predicted_deviation_is_the_closed_form(rows: dict[str, Row]) -> None:
    """C_yy = C_3 h^2 + C_5 a_5^2 at X = 0 with the tool vertical, times 100 N."""
    a_2, d_4, a_5 = 1.22, 1.1, 0.3
    r = np.hypot(1.3, a_5)
    h = a_2 * np.sin(np.arctan2(a_5, 1.3) + np.arccos((a_2**2 + r**2 - d_4**2) / (2 * a_2 * r)))
    for item, C_3, C_5 in (("Sec. 5.2, Table 2 (claim 5)", 12.30, 91.35), ("Sec. 5.2, measured map", 14.74, 97.58)):
        expected = to_si(C_3 * h**2 + C_5 * a_5**2, "1e-7 rad/(N m)") * 100.0
        assert numbers(rows[item].found)[0] == pytest.approx(expected * 1e3, abs=6e-5)


def test_table_3_cannot_give_029(rows: dict[str, Row]) -> None:
    """Only joints 3 and 5 act there, so the ratio lies between theirs: 0.23 mm becomes 0.246 to 0.276."""
    row = rows["Sec. 5.2, measured map"]
    assert 0.23 * 97.58 / 91.35 == pytest.approx(0.246, abs=5e-4)
    assert 0.23 * 14.74 / 12.30 == pytest.approx(0.276, abs=5e-4)
    assert 0.246 < numbers(row.found)[0] < 0.276
    assert row.status == "gap"


def test_the_force_row_spans_the_closed_form(rows: dict[str, Row]) -> None:
    """F_y = N a (Ktc c / 4 + Kte / pi), 3 teeth, 2 mm deep, 0.05 mm a tooth."""
    forces = [3 * 2.0 * (m.Ktc * 1e-6 * 0.05 / 4 + m.Kte * 1e-3 / np.pi) for m in sample_materials() if m.Ktc]
    _, count, low, high = numbers(rows["Fig. 15"].found)
    assert (count, low, high) == (len(forces), round(min(forces)), round(max(forces)))


def test_the_range_of_the_determinant(rows: dict[str, Row]) -> None:
    found = numbers(rows["Fig. 4"].found)
    assert min(found[0:2]) == pytest.approx(0.25, abs=0.01)
    assert max(v for v in found if v < 10) == pytest.approx(1.96, abs=0.01)


def test_the_lines_of_fig_8_from_c_yy(rows: dict[str, Row]) -> None:
    """Along X at the nearest border the normal is Y: 100 N times the largest C_yy of the plane, at (0, -1000, 0)."""
    robot = rm.load_robot("slavkovic_5r")
    theta = rm.inverse_kinematics(robot, rm.pose_from_world([0, -1.0, 0, 0, 0])).theta
    expected = 100.0 * rm.cartesian_compliance(robot, theta)[1, 1]
    assert numbers(rows["Fig. 8"].found)[0] == pytest.approx(expected * 1e3, abs=1e-3)


def test_a_changed_robot_is_found_out(evidence: Evidence) -> None:
    """The checks are checks: other lengths, another table or a swapped sign turn rows red."""
    other = evidence.robot.replace(a=[0.0, 0.6, 0.0, 0.0, 0.3])
    bad = {row.item for row in reproduction(dataclasses.replace(evidence, robot=other)) if not row.holds}
    assert "Fig. 3, eq. (10)" in bad
    swapped = evidence.robot.replace(sign=np.ones(5))
    bad = {row.item for row in reproduction(dataclasses.replace(evidence, robot=swapped)) if not row.holds}
    assert "Table 1, eq. (4)" in bad


def test_table_and_sentence(rows: dict[str, Row]) -> None:
    listed = list(rows.values())
    table = columns(listed)
    assert {len(column) for column in table.values()} == {len(listed)}
    assert set(table["status"]) <= set(WORDS.values())
    assert summary(listed).startswith(f"{len(listed)} tables, figures and claims: ")
