"""The way in to corrections: how it is called."""

import pytest

import robomill as rm
from robomill.io.samples import samples_dir

SLOT = rm.load_setup(samples_dir() / "paper_flute")


def test_components_are_a_text_or_a_list_and_bounds_m_or_micrometres() -> None:
    one, other = rm.compensate(SLOT, "axial,normal", 5e-6), rm.compensate(SLOT, ["normal", "axial"], bound_um=5)
    assert one.text == other.text
    assert one.components == ("normal", "axial")


def test_what_is_no_set_up_is_told() -> None:
    with pytest.raises(rm.RobomillError, match="set-up"):
        rm.compensate("paper_flute")  # type: ignore[arg-type]
    with pytest.raises(rm.RobomillError, match=r"compensate: setup is missing"):
        rm.compensate()  # type: ignore[call-arg]
