"""What the map pages say about a pose: shares that sum to C, words that fit the numbers."""

from __future__ import annotations

import re

import numpy as np
import pytest

import robomill as rm
from robomill.compliance.at_pose import PoseReport
from robomill.frames import Columns
from robomill.ui.maps.point import headline, lead, share_columns
from robomill.ui.posed.point import in_hand, place
from robomill.ui.posed.push import Moved, Push
from robomill.workspace.quantities import COMPONENTS

POINT = (0.2, -1.2, -0.1)


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


def test_headline_words(found: PoseReport) -> None:
    push = Push.along("y")
    moved = Moved.at(found, push)
    said = headline(in_hand(found.robot, POINT, 0.0, 0.0), moved, "mm")
    assert said.startswith("100 N along Y moves the tip by ")
    numbers = [float(v.replace("−", "-")) for v in re.findall(r"([+−][\d.]+) mm along", said)]
    np.testing.assert_allclose(numbers, found.C[:, 1] * 100e3, atol=6e-4)
    far = in_hand(found.robot, (0.0, -9.0, 0.0), 0.0, 0.0)
    nowhere = Moved.at(far.pose, push)
    assert headline(far, nowhere, "mm").startswith("The tool does not get to (0, −9000, 0) mm: ")
    assert lead(far, nowhere, None, False, "mm") == "At the selected point (0, −9000, 0) mm."
    assert not far.pose.reached
    assert np.isnan(far.pose.C).all()


def test_place_in_inches() -> None:
    assert place((0.0254, 0.0, -0.254), "in") == "(1.00, 0.00, −10.00) in"
