"""A session's history: as deep as it may be, and no heavier."""

from __future__ import annotations

from robomill.toolpath.source import GCodeSource
from robomill.ui.project import DEFAULT_PRESET, Project, preset_setup
from robomill.ui.session import HEAVY, MAX_HISTORY, MAX_HISTORY_BYTES, remembered

START = Project(preset_setup(DEFAULT_PRESET))


def with_text(number: int, size: int) -> Project:
    text = f"({number}" + " " * size + ")\nG21 G1 X1 F100\nM2\n"
    return START.replace(setup=START.setup.replace(source=GCodeSource(text)))


def test_light_projects_are_remembered_as_many_as_may_be():
    past = [with_text(n, 10) for n in range(MAX_HISTORY + 5)]
    assert remembered(past) == past[5:]


def test_heavy_projects_are_remembered_as_long_as_there_is_room():
    size = MAX_HISTORY_BYTES // 4 - HEAVY // 4
    past: list[Project] = []
    for n in range(8):
        past = remembered([*past, with_text(n, size)])
        assert sum(len(each.setup.source.text) for each in past) <= MAX_HISTORY_BYTES
    assert [each.setup.source.text[:2] for each in past] == ["(4", "(5", "(6", "(7"]


def test_the_last_stays_however_heavy():
    last = with_text(1, MAX_HISTORY_BYTES)
    assert remembered([with_text(0, 10), last]) == [last]


def test_what_many_share_weighs_once():
    heavy = with_text(0, MAX_HISTORY_BYTES // 2)
    past = [heavy.replace(setup=heavy.setup.replace(tolerance=1e-4 * n)) for n in range(1, 30)]
    assert remembered(past) == past
