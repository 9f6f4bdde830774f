"""What an edited table sends, against the table one sees."""

from __future__ import annotations

import pandas as pd
import pytest

from robomill.ui import inputs


def test_edits_of_the_screen_are_applied_in_order() -> None:
    base = pd.DataFrame({"a": [1.0, 2.0, 3.0], "b": [4.0, 5.0, 6.0]})
    changed = inputs.edited(
        base, {"edited_rows": {0: {"a": 9.0}, "2": {"b": 8.0}}, "deleted_rows": [1], "added_rows": [{"a": 7.0}]}
    )
    assert changed["a"].tolist() == [9.0, 3.0, 7.0]
    assert changed["b"].tolist()[:2] == [4.0, 8.0]
    assert base["a"].tolist() == [1.0, 2.0, 3.0]


@pytest.mark.parametrize("typed", [1e308, None, 2])
def test_a_whole_number_may_be_emptied_or_be_larger_than_any(typed: float | None) -> None:
    base = pd.DataFrame({"teeth": [2, 4]})
    changed = inputs.edited(base, {"edited_rows": {0: {"teeth": typed}}})
    assert changed["teeth"][0] == typed or (typed is None and inputs.empty(changed["teeth"][0]))
    assert changed["teeth"][1] == 4
