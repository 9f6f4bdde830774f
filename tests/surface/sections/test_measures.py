"""The measures of a section: each kind's are declared, and shown as they are meant in either unit of length."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from robomill.surface.sections.groove import GrooveSection
from robomill.surface.sections.measures import MEASURED
from robomill.surface.sections.section_law import MEASURES, TITLES


def test_what_a_kind_has_is_declared_and_a_number_of_the_section() -> None:
    every = [name for names in MEASURES.values() for name in names]
    named = {name.replace("_near_", f"_{side}_") for side in ("left", "right") for name in every}
    fields = {each.name for each in dataclasses.fields(GrooveSection)}
    assert named < set(MEASURED) < fields
    assert MEASURES.keys() == TITLES.keys()
    labels = [of.label for of in MEASURED.values()]
    assert len(set(labels)) == len(labels)
    assert {of.form for of in MEASURED.values() if of.form} == {"wall_left_straightness", "wall_right_straightness"}


@pytest.mark.parametrize(
    ("name", "value", "mm", "inch"),
    [
        ("width", 8e-3, "8.000 mm", "0.3150 in"),
        ("centre_offset", 0.254e-3, "+0.254 mm", "+0.0100 in"),
        ("wall_right_error", -0.127e-3, "−0.127 mm", "−0.0050 in"),
        ("error_rms", 0.127e-3, "0.127 mm", "0.0050 in"),
        ("wall_left_angle", np.pi / 2, "90.00°", "90.00°"),
        ("floor_tilt", np.radians(0.125), "+0.125°", "+0.125°"),
    ],
)
def test_a_measure_shows_its_side_and_its_unit(name: str, value: float, mm: str, inch: str) -> None:
    assert MEASURED[name].shown(value, "mm") == mm
    assert MEASURED[name].shown(value, "in") == inch
