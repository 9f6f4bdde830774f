"""What the map pages say about a pose, without a screen: shares that sum to C, words that fit the numbers."""

from __future__ import annotations

import re

import numpy as np
import pytest

import robomill as rm
from robomill.compliance.at_pose import PoseReport
from robomill.improve.sensitivity import stiffened
from robomill.report.tables import Columns
from robomill.ui import fields
from robomill.ui.learn.edge import _ray
from robomill.ui.learn.lesson import compliance_table, went
from robomill.ui.learn.mathematics import component, product
from robomill.ui.maps.point import headline, place, share_columns
from robomill.ui.point import in_hand
from robomill.ui.project import MapView
from robomill.workspace.fields import compliance_field
from robomill.workspace.grid import PAPER_BOX, box_grid
from robomill.workspace.quantities import COMPONENTS

POINT = (0.2, -1.2, -0.1)


@pytest.fixture(scope="module")
def found() -> PoseReport:
    return in_hand(rm.load_robot("slavkovic_5r"), POINT, 0.0, 0.0).pose


def test_shares_sum_to_c(found: PoseReport) -> None:
    C = rm.cartesian_compliance(found.robot, found.theta)
    for c in COMPONENTS:
        total = found.shares(c).sum()
        assert total == pytest.approx(C["xyz".index(c[0]), "xyz".index(c[1])], rel=1e-12, abs=1e-20)
        assert found.component(c) == pytest.approx(total, rel=1e-12, abs=1e-20)


def test_the_table_of_shares_ends_with_the_sum(found: PoseReport) -> None:
    columns: Columns = share_columns(found)  # type: ignore[assignment]
    for c in COMPONENTS:
        values = np.array(columns[f"C_{c}_um/N"])
        assert values[-1] == pytest.approx(values[:-1].sum())


def test_the_report_is_the_field_at_its_cell(found: PoseReport) -> None:
    """Click and map agree: one pose solved alone gives what the plane shows."""
    field = compliance_field(found.robot, box_grid(POINT, POINT, 1.0))
    np.testing.assert_allclose(found.C, field.C()[0, 0, 0], rtol=1e-12)


def test_headline_words(found: PoseReport) -> None:
    said = headline(in_hand(found.robot, POINT, 0.0, 0.0), "mm")
    assert said.startswith("At (200, −1200, −100) mm, 100 N along Y move the tip ")
    numbers = [float(v) for v in re.findall(r"([\d.]+) mm (?:in|down|up)", said)]
    np.testing.assert_allclose(sorted(numbers), sorted(np.abs(found.C[:, 1] * 100e3)), atol=6e-4)
    far = in_hand(found.robot, (0.0, -9.0, 0.0), 0.0, 0.0)
    assert headline(far, "mm").startswith("The tool does not get to (0, −9000, 0) mm: ")
    assert not far.pose.reached
    assert np.isnan(far.pose.C).all()


def test_place_in_inches() -> None:
    assert place((0.0254, 0.0, -0.254), "in") == "(1.0, 0.0, −10.0) in"


@pytest.mark.parametrize(
    ("delta", "answer"),
    [((0, 1, 0), "y"), ((0, 1, -0.4), "down"), ((0, 1, 0.4), "up"), ((0.5, 1, 0.1), "x"), ((0.01, 1, 0.01), "y")],
)
def test_the_right_answer_of_the_lesson(delta: tuple[float, ...], answer: str) -> None:
    assert went(np.array(delta)) == answer


def test_only_the_column_of_the_push_is_lit() -> None:
    C = np.array([[1.0, 0, 0.3], [0, 2, -1], [0.3, -1, 3]]) * 1e-6
    table = compliance_table(C)
    assert table.count('class="on"') == 1
    assert table.count('class="off"') == 1


def test_the_equation_s_terms_add_up(found: PoseReport) -> None:
    """The numbers printed under the braces, multiplied and added, are the number after the equals sign."""
    tex = component(found, 1, 1)
    terms = re.findall(r"\{(-?[\d.]+)\\cdot \((-?[\d.]+)\)\^2\}", tex)
    total = float(tex.rpartition("=")[2])
    assert sum(float(c) * float(j) ** 2 for c, j in terms) == pytest.approx(total, abs=0.01)
    assert total == pytest.approx(found.C[1, 1] * 1e6, abs=1e-3)


def test_the_product_is_c_times_f(found: PoseReport) -> None:
    moved = re.findall(r"bmatrix\} (-?[\d.]+) \\\\ (-?[\d.]+) \\\\ (-?[\d.]+) \\end", product(found.C))[-1]
    np.testing.assert_allclose([float(v) for v in moved], found.C[:, 1] * 100e6, atol=0.06)


def test_stiffer_fields_are_those_of_the_stiffer_robot(found: PoseReport) -> None:
    factors = np.array([1.0, 2.0, 0.5, 1.0, 3.0])
    grid = box_grid(*PAPER_BOX, 0.3)
    quick = fields.stiffer(compliance_field(found.robot, grid), factors)
    slow = compliance_field(stiffened(found.robot, factors), grid)
    np.testing.assert_allclose(quick.total, slow.total, rtol=1e-12, atol=1e-22)


def test_the_ray_ends_at_a_singularity(found: PoseReport) -> None:
    way = _ray.__wrapped__("key", found.robot, np.array([0.0, -1.3, 0.0]))
    assert way.radius[way.start] == pytest.approx(1.3)
    assert (np.diff(way.radius) > 0).all()
    assert way.det[-1] < 1e-3 * way.det.max()
    stretched = np.sqrt((1.22 + 1.1) ** 2 - 0.3**2)  # the arm straight, the tool hanging a_5 below the wrist
    assert way.radius[-1] == pytest.approx(stretched, abs=1e-6)


def test_the_step_of_a_plane_is_a_round_number() -> None:
    robot = rm.load_robot("slavkovic_5r")
    view = MapView("r", "paper")
    box = fields.region(robot, view)
    assert fields.plane_step(robot, view, box, "z") == 0.02
    assert fields.plane(robot, view, box, "z", 0.0).shape == (61, 31, 1)
