"""Pictures of a report: their numbers are read back off the paper and held against the run."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest

import robomill as rm
from robomill.report.pictures import joint_parts, joints_picture, path_picture, section_picture
from robomill.report.simulation_record import simulation_record
from robomill.simulation.stations import section_at

Element = ElementTree.Element


@pytest.fixture(scope="module")
def result() -> rm.SimulationResult:
    return rm.simulate(rm.load_setup("paper_flute"))


def number(text: str | None) -> float:
    return float((text or "").replace("\u202f", "").replace("\u2212", "-").replace(" mm", ""))


def scales(picture: Element) -> tuple[tuple[float, float], tuple[float, float]]:
    """(place of zero, places per mm) across and up, off the ticks: numbers stand at their grid lines."""
    across = [(number(each.text), float(each.get("x") or "")) for each in with_look(picture, "text", "m")[:-1]]
    up = [
        (number(each.text), float(each.get("y") or "") - 3.5)
        for each in with_look(picture, "text", "e")
        if re.fullmatch(r"[\u2212-]?[\d.]+", each.text or "")
    ]
    found = []
    for marks in (across, up):
        value, place = np.array(marks).T
        slope, zero = np.polyfit(value, place, 1)
        np.testing.assert_allclose(zero + slope * value, place, atol=0.11)
        found.append((float(zero), float(slope)))
    return found[0], found[1]


def with_look(picture: Element, name: str, look: str) -> list[Element]:
    return [each for each in picture.iter(name) if each.get("class") == look]


def drawn(picture: Element, look: str) -> np.ndarray:
    """(q, 2) mm, of a line."""
    (path,) = with_look(picture, "path", look)
    places = np.array([(float(x), float(y)) for x, y in re.findall(r"[ML](\S+) (\S+)", path.get("d") or "")])
    (zero_x, per_x), (zero_y, per_y) = scales(picture)
    return (places - [zero_x, zero_y]) / [per_x, per_y]


def test_a_section_is_drawn_to_scale_where_it_lies(result: rm.SimulationResult) -> None:
    section = section_at(result, result.decided.sample)
    assert section is not None
    picture = ElementTree.fromstring(section_picture(section, result))
    (_, per_x), (_, per_y) = scales(picture)
    assert per_x < 0.0 > per_y, "seen along the feed, as on the screen: what is left of it stands to the left"
    assert per_y / per_x == pytest.approx(1.0, abs=0.02), "to scale"
    for look, truth in (("ideal", section.z_ideal), ("left", section.z_machined)):
        line = drawn(picture, look)
        at = np.interp(line[:, 0], 1e3 * section.w, 1e3 * truth)
        flat = np.abs(np.gradient(at)) < 1e-6  # a wall of a pixel's width is anywhere on its height
        np.testing.assert_allclose(line[flat, 1], at[flat], atol=0.15 / abs(per_y))
    (frame,) = with_look(picture, "rect", "f")
    top, tall = float(frame.get("y") or ""), float(frame.get("height") or "")
    seen = drawn(picture, "left")[:, 1]
    (_, _), (zero_y, per_y) = scales(picture)
    assert ((zero_y + per_y * seen > top) & (zero_y + per_y * seen < top + tall)).all(), "all of it is in the picture"


def test_what_is_allowed_is_as_thick_as_the_tolerances(result: rm.SimulationResult) -> None:
    section = section_at(result, result.decided.sample)
    assert section is not None
    setup = result.setup.replace(floor_tolerance=2.0 * result.setup.tolerance)
    other = rm.simulate(setup)
    picture = ElementTree.fromstring(section_picture(section, other))
    (_, per_x), (_, per_y) = scales(picture)
    (band,) = [each for each in picture.iter("g") if "scale(" in (each.get("transform") or "")]
    across, up = map(float, re.findall(r"[\d.]+", band.get("transform") or ""))
    assert across / abs(per_x) == pytest.approx(1e3 * setup.tolerance, rel=0.02)
    assert up / abs(per_y) == pytest.approx(2e3 * setup.tolerance, rel=0.02)
    (line,) = with_look(picture, "polyline", "allowed")
    places = np.array([[float(v) for v in pair.split(",")] for pair in (line.get("points") or "").split()])
    (path,) = with_look(picture, "path", "ideal")
    ideal = np.array([(float(x), float(y)) for x, y in re.findall(r"[ML](\S+) (\S+)", path.get("d") or "")])
    np.testing.assert_allclose(places * [across, up], ideal, atol=0.11)


@pytest.mark.parametrize("name", ["paper_flute", "heart"])
def test_the_way_along_the_path_is_that_of_the_run(name: str) -> None:
    run = rm.simulate(rm.load_setup(name))
    picture = ElementTree.fromstring(path_picture(run))
    (_, per_x), (zero_y, per_y) = scales(picture)
    cut = run.path.cutting
    allowed = 1e3 * run.setup.tolerance
    levels = [(float(each.get("y1") or "") - zero_y) / per_y for each in with_look(picture, "line", "limit")]
    assert sorted(levels)[0] == pytest.approx(-allowed, abs=0.2 / abs(per_y))
    assert sorted(levels)[-1] == pytest.approx(allowed, abs=0.2 / abs(per_y))
    for look, k in (("wall", 1), ("floor", 2)):
        line = drawn(picture, look)
        truth = 1e3 * run.delta_in_cut[cut & run.judged, k]
        assert line[:, 1].max() == pytest.approx(truth.max(), abs=0.2 / abs(per_y))
        assert line[:, 1].min() == pytest.approx(truth.min(), abs=0.2 / abs(per_y))
        s = 1e3 * run.path.s[cut]
        assert line[-1, 0] == pytest.approx(s[-1], abs=0.2 / per_x)
        middle = len(line) // 2
        near = np.abs(s - line[middle, 0]) < 0.5 + 0.1 / per_x
        beside = 1e3 * run.delta_in_cut[cut][near, k]
        assert beside.min() - 0.2 / abs(per_y) <= line[middle, 1] <= beside.max() + 0.2 / abs(per_y)


def test_bars_are_as_long_as_the_joints_parts_and_add_up(result: rm.SimulationResult) -> None:
    record = simulation_record(result)
    parts = joint_parts(record)
    i = result.worst
    along = result.delta[i] / np.linalg.norm(result.delta[i])
    np.testing.assert_allclose([value for _, value in parts], 1e3 * result.delta_joint[i] @ along, atol=1e-9)
    assert sum(value for _, value in parts) == pytest.approx(record["max_deviation_mm"], abs=1e-9)
    picture = ElementTree.fromstring(joints_picture(record) or "")
    bars = [*picture.iter("rect")]
    (axis,) = with_look(picture, "line", "z")
    zero = float(axis.get("x1") or "")
    largest = max(parts, key=lambda part: abs(part[1]))[1]
    whole = max(float(bar.get("width") or "") for bar in bars)
    assert len(bars) == len(parts)
    for bar, (_, value) in zip(bars, parts, strict=True):
        left, width = float(bar.get("x") or ""), float(bar.get("width") or "")
        assert width == pytest.approx(max(whole * abs(value / largest), 0.5), abs=0.11)
        assert (left if value >= 0.0 else left + width) == pytest.approx(zero, abs=0.11 if abs(value) > 1e-3 else 0.6)
        assert bar.get("class") == ("bar" if value >= 0.0 else "bar back")


def test_without_parts_there_is_no_picture_of_them(result: rm.SimulationResult) -> None:
    record = simulation_record(result)
    assert joints_picture({**record, "joint_shares_add_up": False}) is None
    assert joints_picture({**record, "worst_block": 0}) is None
