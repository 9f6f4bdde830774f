"""From contours to the shapes of a sketch: depths, passes, ways, sides."""

from __future__ import annotations

import numpy as np
import pytest

import robomill as rm
from robomill.errors import ToolpathError
from robomill.toolpath.contour import Contour
from robomill.toolpath.drawing import Drawing, LayerCut
from robomill.toolpath.sketch import Sketch

SQUARE = Contour("slots", "polygon", np.array([[10, 10], [50, 10], [50, 30], [10, 30]]) * 1e-3)
LINE = Contour("marks", "line", np.array([[0, 0], [30, 0]]) * 1e-3)
DRAWING = Drawing("part.dxf", (SQUARE, LINE))


def cut(layer="slots", **more):
    return LayerCut(layer, **{"depth_mm": 3, "feed_mm_min": 600, **more})


def test_passes_are_alike_and_none_is_deeper_than_said() -> None:
    np.testing.assert_allclose(cut(step_down_mm=1.3).depths(), [1e-3, 2e-3, 3e-3])
    np.testing.assert_allclose(cut(step_down_mm=1.5).depths(), [1.5e-3, 3e-3])
    np.testing.assert_allclose(cut().depths(), [3e-3])


def test_a_closed_line_is_followed_pass_by_pass_without_lifting() -> None:
    path = DRAWING.sketch([cut(step_down_mm=1)]).toolpath()
    assert (~path.cutting).sum() == 3, "start, approach, and the last retract"
    level = path.cutting & (np.abs(np.diff(path.p[:, 2], prepend=path.p[0, 2])) < 1e-12)
    assert path.step_length[level].sum() == pytest.approx(3 * 0.12)
    plunges = path.cutting & ~level
    np.testing.assert_allclose(path.p[plunges, 2], [-1e-3, -2e-3, -3e-3])
    np.testing.assert_allclose(path.p[plunges, :2], [[0.01, 0.01]] * 3)


def test_an_open_line_is_cut_there_and_back() -> None:
    path = DRAWING.sketch([cut("marks", step_down_mm=1.5)]).toolpath()
    assert (~path.cutting).sum() == 3
    np.testing.assert_allclose(path.p[-2], [0.0, 0.0, -3e-3], atol=1e-15)


def test_layers_are_cut_in_the_order_in_which_they_are_asked_for() -> None:
    sketch = DRAWING.sketch([cut("marks", depth_mm=1), cut(side="inside")], diameter_mm=8)
    assert [each.shape for each in sketch.elements] == ["line", "polygon"]
    inside = sketch.elements[1]
    np.testing.assert_allclose([inside.points.min(axis=0), inside.points.max(axis=0)], [[0.014, 0.014], [0.046, 0.026]])


def test_the_origin_goes_to_the_corner_or_the_middle() -> None:
    np.testing.assert_allclose(DRAWING.moved("corner").extents, [[0, 0], [0.05, 0.03]])
    np.testing.assert_allclose(DRAWING.moved("centre").extents, [[-0.025, -0.015], [0.025, 0.015]])
    assert DRAWING.moved("drawing") is DRAWING


def test_the_simulated_groove_beside_a_line_is_where_the_offset_says() -> None:
    """A stiff arm: what is left of the walls is the drawn line, whichever side the tool is on."""
    cutter = rm.Cutter("flat", diameter_mm=8, flutes=3)
    setup = rm.load_setup("paper_flute")
    sketch = DRAWING.sketch([cut(side="inside", depth_mm=2)], cutter.diameter)
    stock = rm.Stock(lower_mm=(0, 0, -10), upper_mm=(60, 40, 0))
    setup = setup.replace(source=rm.SketchSource(sketch), cutter=cutter, stock=stock, step_mm=5, cell_mm=0.25)
    ideal = rm.simulate(setup).ideal
    deep = ideal.z < -1.9e-3
    x, y = np.meshgrid(ideal.x, ideal.y, indexing="ij")
    assert x[deep].min() == pytest.approx(0.010, abs=2.6e-4)
    assert x[deep].max() == pytest.approx(0.050, abs=2.6e-4)
    assert y[deep].min() == pytest.approx(0.010, abs=2.6e-4)
    assert y[deep].max() == pytest.approx(0.030, abs=2.6e-4)
    # 40 x 20 less the four corners that a radius of 4 leaves, less the island of (32 - 8) x (12 - 8) in the middle
    area = (40 * 20 - (4 - np.pi) * 16 - 24 * 4) * 1e-6
    assert deep.sum() * ideal.dx * ideal.dy == pytest.approx(area, rel=5e-3)


@pytest.mark.parametrize(
    ("cuts", "more", "said"),
    [
        ([cut("nothing")], {}, "part.dxf: there is no layer 'nothing' with lines; it has slots, marks."),
        ([cut(side="inside")], {}, "Diameter of the cutter"),
        ([cut(side="inside")], {"diameter": 8}, "If 8 mm is meant, give diameter=0.008 or diameter_mm=8."),
        ([cut(step_down_mm=1e-4)], {}, "makes 30.000 passes"),
    ],
)
def test_refusals_say_what_to_do(cuts, more, said) -> None:
    with pytest.raises(ToolpathError, match=said.replace("(", r"\(")):
        DRAWING.sketch(cuts, **more)


@pytest.mark.parametrize(
    ("step", "passes"),
    [(5, [3]), (3, [3]), (2.9999, [1.5, 3]), (1, [1, 2, 3]), (0.75, [0.75, 1.5, 2.25, 3]), (None, [3])],
)
def test_a_step_down_is_the_most_of_a_pass(step: float | None, passes: list[float]) -> None:
    np.testing.assert_allclose(cut(step_down_mm=step).depths() * 1e3, passes)


def test_every_other_pass_of_an_open_line_goes_back_and_closed_ones_all_go_on() -> None:
    found = DRAWING.sketch([cut("marks", step_down_mm=1), cut(step_down_mm=1.5)]).elements
    ways = [each.points[0].tolist() for each in found[:3]]
    assert ways == [LINE.points[0].tolist(), LINE.points[1].tolist(), LINE.points[0].tolist()]
    np.testing.assert_allclose([each.depth for each in found], [1e-3, 2e-3, 3e-3, 1.5e-3, 3e-3])
    for each in found[3:]:
        np.testing.assert_array_equal(each.points, SQUARE.points)
    assert {each.v_f for each in found} == {0.01}


def test_a_drawing_says_what_it_holds_and_knows_no_other_origin_or_layer() -> None:
    assert repr(DRAWING) == "<Drawing part.dxf: 2 contours on slots, marks, 50.00 x 30.00 mm>"
    assert DRAWING.layers == ("slots", "marks")
    assert DRAWING.of_layer("marks") == (LINE,)
    with pytest.raises(ToolpathError, match="Origin: found 'middle', expected one of drawing, corner, centre"):
        DRAWING.moved("middle")
    said = "<LayerCut slots, inside: depth 3 mm, feed 600 mm/min, step down 1 mm>"
    assert repr(cut(side="inside", step_down_mm=1)) == said


def test_a_sketch_that_is_given_keeps_its_settings() -> None:
    kept = Sketch(v_plunge=4e-3, clearance=7e-3, n_s=120.0)
    found = DRAWING.sketch([cut("marks")], sketch=kept)
    assert (found.v_plunge, found.clearance, found.n_s) == (4e-3, 7e-3, 120.0)
    assert len(found.elements) == 1
