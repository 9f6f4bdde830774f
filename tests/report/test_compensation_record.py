"""The record of a corrected program: its keys, and lines that a person reads."""

import pytest

import robomill as rm
from robomill.io.samples import samples_dir
from robomill.report.compensation_record import compensation_lines, compensation_record

RECORD = compensation_record(rm.compensate(rm.load_setup(samples_dir() / "paper_flute")))


def test_before_and_after_are_what_is_judged_with_its_parts_beside_it() -> None:
    before, after = RECORD["before_mm"], RECORD["after_mm"]
    assert before["max"] == max(before["wall_mm"], before["floor_mm"]) == pytest.approx(0.2295, abs=1e-4)
    assert before["max_deviation_mm"] == pytest.approx(0.2514, abs=1e-4)
    assert after["max"] < 0.01 * before["max"]
    assert after["rms"] <= after["max"]
    for name in ("compliance", "force"):
        assert RECORD[f"after_if_{name}_20_percent_wrong_mm"] == pytest.approx(0.2 * before["max"], rel=0.02)
    assert RECORD["iterations"] == len(RECORD["change_um"])
    assert (RECORD["lines_in"], RECORD["lines_out"]) == (10, 12)


def test_the_lines_say_what_was_what_is_left_and_what_if() -> None:
    lines = compensation_lines(RECORD)
    text = "\n".join(lines)
    assert "before    0.2295 mm at most" in text
    assert "0.0461 mm if the compliances are 20 % wrong" in text
    assert "lines     10 in, 12 out" in text
