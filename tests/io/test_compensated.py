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


@pytest.mark.parametrize(
    "given", [{"components": 3}, {"components": [None]}, {"bound_um": "2"}, {"bound": float("nan")}]
)
def test_what_is_no_component_and_no_bound_is_told(given: dict) -> None:
    with pytest.raises(rm.RobomillError, match="Components: found|Bound: found .* expected a number"):
        rm.compensate(SLOT, **given)
