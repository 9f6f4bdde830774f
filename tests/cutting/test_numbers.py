"""What a force is computed from: each number is found and changed by itself, whatever the model."""

from dataclasses import replace

import pytest

import robomill as rm
from robomill.cutting.force import ForceModel

CUTTER = rm.Cutter("flat", diameter_mm=8, flutes=3)
MECHANISTIC = rm.process_force("al7075_t6_carbide_ref190", CUTTER)
COEFFICIENTS = ("Ktc", "Kte", "Krc", "Kre", "Kac", "Kae")
KEYS = [
    (rm.PathForce(feed=3.0, axial=-20.0), {"feed": 3.0, "axial": -20.0}),
    (rm.ConstantForce((0.0, 100.0, 7.0)), {"vector_M_1": 100.0, "vector_M_2": 7.0}),
    (
        replace(MECHANISTIC, axial_share=0.2),
        {name: getattr(MECHANISTIC.material, name) for name in COEFFICIENTS} | {"axial_share": 0.2},
    ),
]


@pytest.mark.parametrize(("force", "numbers"), KEYS, ids=lambda each: getattr(each, "kind", ""))
def test_each_number_is_changed_by_itself(force: ForceModel, numbers: dict[str, float]) -> None:
    assert {each.key: each.value for each in force.uncertain} == numbers
    for key, value in numbers.items():
        changed = {each.key: each.value for each in force.changed(key, 0.5).uncertain}
        assert changed == {**numbers, key: value + 0.5}
    assert force.changed("another", 0.5) is force


def test_entries_of_a_vector_are_called_by_its_axes() -> None:
    force = rm.ConstantForce((5.0, 100.0, 7.0))
    assert [each.label for each in force.uncertain] == ["F_X", "F_Y", "F_Z"]
