"""Where the tip goes, and the column of C that says so."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.ui.learn.lesson import compliance_table


@pytest.mark.parametrize("along", range(3))
def test_only_the_pushed_column_is_lit_and_only_what_is_not_nothing(along: int) -> None:
    C = np.array([[1e-6, 2e-9, 3e-6], [2e-9, 5e-6, -4e-6], [3e-6, -4e-6, 6e-6]])
    cells = [row.split('<td class="')[1:] for row in compliance_table(C, along).split("<tr>")[2:]]
    lit = np.array([[cell.split('"')[0] for cell in row] for row in cells])
    assert (np.delete(lit, along, axis=1) == "").all()
    assert lit[along, along] == "on"
    for i in set(range(3)) - {along}:
        assert lit[i, along] == ("off" if abs(C[i, along]) > 5e-9 else "")
