"""What is put beside each other: only what differs, by its name on the page and its value with its unit."""

from __future__ import annotations

import dataclasses

from robomill.ui.comparing.differences import differences, outcomes
from robomill.ui.project import DEFAULT_PRESET, preset_setup

SETUP = preset_setup(DEFAULT_PRESET)


def test_equal_set_ups_differ_in_nothing() -> None:
    assert differences([SETUP, SETUP.replace(name="another name", description="other words")]) == []


def test_a_number_is_named_as_on_the_page_and_has_its_unit() -> None:
    other = SETUP.replace(cutter=SETUP.cutter.replace(diameter=10e-3), cell=2e-4)
    assert differences([SETUP, other]) == [
        ["Cutter: Diameter", "8 mm", "10 mm"],
        ["Surface grid", "0.1 mm", "0.2 mm"],
    ]


def test_what_one_of_three_has_alone_is_a_dash_at_the_others() -> None:
    other = SETUP.replace(rapid_rate=0.1)
    ((name, *values),) = differences([SETUP, other, SETUP])
    assert name == "Rapid rate"
    assert values == ["–", "6000 mm/min", "–"]


def test_two_programs_of_one_length_are_told_apart() -> None:
    text = SETUP.source.text  # type: ignore[attr-defined]
    other = dataclasses.replace(SETUP.source, text=text.replace("X", "Y", 1))  # type: ignore[type-var]
    rows = differences([SETUP, SETUP.replace(source=other)])
    assert len(rows) == 1
    assert rows[0][1] != rows[0][2]


def test_outcomes_are_the_papers() -> None:
    rows = dict(outcomes([SETUP], "mm"))
    assert rows["Wall error"].startswith(("+0.229", "+0.230", "−0.229", "−0.230"))
    assert rows["Floor error"].startswith("−0.10")
    assert rows["Verdict"]
    assert "up to 1" in rows["Force"]
