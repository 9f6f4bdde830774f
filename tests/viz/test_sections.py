"""A section across the cut as it is drawn."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.simulation.result import SimulationResult
from robomill.surface.sections.groove import groove_sections
from robomill.surface.stock import Stock
from robomill.surface.swept import CutPath
from robomill.viz.sections import section_figure
from robomill.viz.views import section_drawing

FLAT, BALL = Cutter("flat", 8e-3), Cutter("ball", 8e-3)
MOVED = np.array([0.0, 0.15e-3, -0.06e-3])


def drawn(ys, z, cutter=FLAT, number=0, unit="mm", high=30e-3):
    """What passes along x at ``ys`` (mm) leave, each moved by 0.15 mm aside and 0.06 mm down."""
    p = 1e-3 * np.array([[x, y, z] for y in ys for x in (-40.0, 40.0)])
    path = CutPath(p, p + MOVED, np.tile([False, True], len(ys)))
    section = groove_sections(Stock((-50e-3, -30e-3, -10e-3), (50e-3, high, 0.0)), cutter, path, [0.04 + 0.08 * number])
    return section_drawing(section[0], unit)


def words(drawing):
    return [each["text"] for each in section_figure(drawing, dark=False).layout["annotations"] if each["text"]]


def test_section_is_upright_at_the_measured_walls(result: SimulationResult) -> None:
    drawing = section_drawing(result.groove(0.05), "mm")
    steep = np.abs(np.diff(drawing.machined)) > 1.0
    assert steep.sum() == 2
    assert np.diff(drawing.u)[steep] == pytest.approx(0.0)
    walls = sorted(drawing.u[:-1][steep])
    assert walls == pytest.approx(sorted([drawing.wall_left, drawing.wall_right]))
    assert drawing.centre_offset == pytest.approx(0.2295, abs=5e-4)


def test_a_groove_is_dimensioned_by_width_depth_floor_and_centre():
    assert sorted(words(drawn([0.0], -2.0))) == ["centre +0.150", "depth 2.060", "floor −0.060", "width 8.000"]
    inch = sorted(words(drawn([0.0], -2.0, unit="in")))
    assert [each.split()[1] for each in inch] == ["+0.0059", "0.0811", "−0.0024", "0.3150"]


def test_a_step_is_dimensioned_by_its_one_wall():
    assert sorted(words(drawn([-28.0], -2.0))) == [
        "depth 2.060",
        "flat within 0.000",
        "floor −0.060",
        "left wall +0.150",
    ]


def test_a_pocket_without_a_wall_in_the_section_is_dimensioned_by_its_floor():
    assert words(drawn([-12.0, -6.0, 0.0, 6.0, 12.0], -2.0, number=2)) == ["floor −0.060", "flat within 0.000"]


def test_a_free_surface_tells_its_error_and_its_slope():
    found = words(drawn(np.arange(-15.0, 15.1, 1.5), -2.0, BALL, number=10))
    assert found[0].startswith("surface −0.060, at most −0.0")
    assert found[1] == "sloping by 0.0°"


def test_a_cut_through_the_stock_says_that_it_has_no_floor():
    assert sorted(words(drawn([0.0], -11.0))) == ["centre +0.150", "cut through: no floor", "width 8.000"]


def test_where_nothing_is_cut_the_stock_is_drawn_and_the_picture_says_so():
    drawing = drawn([0.0], 2.0)
    assert words(drawing) == ["nothing is cut here"]
    assert set(drawing.machined.tolist()) == {0.0}


def test_words_beside_the_edge_of_the_picture_are_anchored_inside_it():
    """The wall 2 mm from the side of the stock: its words end at the wall, they do not begin there."""
    fig = section_figure(drawn([-32.0], -2.0), dark=True)
    wall = next(each for each in fig.layout["annotations"] if each["text"].startswith("left wall"))
    assert wall["xanchor"] == "right"


def depth_of(drawing):
    """The words of the depth, and the ends (px beside the wall) of its dimension line."""
    fig = section_figure(drawing, dark=False)
    told = next(each for each in fig.layout["annotations"] if each["text"].startswith("depth"))
    lines = [each for each in fig.layout["shapes"] if each.get("xsizemode") == "pixel" and each["x0"] == each["x1"]]
    return told, [each["x0"] for each in lines], fig.layout["xaxis"]["range"]


def test_the_depth_beside_the_end_of_the_picture_stands_over_the_cut():
    """Px count to the right: the material is there beside a right wall (here at the end of the picture), the cut
    left."""
    near = drawn([-22.0, -16.0, -10.0], -2.0, number=0)
    assert near.near == "right"
    told, lines, (left, right) = depth_of(near)
    room = (near.wall_right - near.u.min()) / np.ptp(near.u)
    assert room < 0.2
    assert (told["xanchor"], told["xshift"]) == ("right", -4)
    assert told["x"] == max(near.wall_right, near.wall_right_ideal)
    assert lines == [20 if room > 0.12 else -20]
    assert left > near.u.max()
    assert right < near.u.min()


def test_the_depth_of_a_groove_stands_beside_it_and_no_line_crosses_it():
    groove = drawn([0.0], -2.0)
    told, lines, _ = depth_of(groove)
    assert (told["xanchor"], told["xshift"], lines) == ("left", 4, [20])
    assert told["x"] == min(groove.wall_right, groove.wall_right_ideal)
