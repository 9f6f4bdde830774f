"""The lesson: where the tip went, and the column of C that says so."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.ui.learn.lesson import compliance_table, went


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
