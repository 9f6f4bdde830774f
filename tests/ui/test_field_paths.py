"""Fields of nested frozen values by a written path."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.errors import CuttingError
from robomill.io.projects import load_setup
from robomill.io.samples import samples_dir
from robomill.ui.project import read_field, with_field


def test_read_and_write() -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    assert read_field(setup, "cutter.diameter") == 0.008
    assert read_field(setup, "T_MW[1,3]") == -1.3
    changed = with_field(setup, "T_MW[1,3]", -1.25)
    assert changed.T_MW[1, 3] == -1.25
    assert setup.T_MW[1, 3] == -1.3
    assert with_field(setup, "cutter.flutes", 2).cutter.flutes == 2
    np.testing.assert_array_equal(with_field(setup, "stock.upper[2]", 0.001).stock.upper, [0.064, 0.02, 0.001])
    with pytest.raises(CuttingError):
        with_field(setup, "cutter.diameter", -1.0)
    with pytest.raises(KeyError):
        read_field(setup, "cutter.(diameter)")
